//! Bodies and shapes out of the nodes of a file.

use super::extension::{self, NodePhysics, Physics, RIGID_BODIES, SHAPES, Shapes};
use super::file::Parts;
use super::problem::{Problem, problem};
use super::shapes::{self, Form, Placed};
use super::tree::{self, Tree};
use super::{filter, joints, motion};
use crate::{Scene, SceneBody, SceneError};
use backstop::Error;
use backstop::Tally;
use backstop::{BodyDesc, BodyKind};
use backstop::{Combine, Filter, Geometry, Material, ShapeDesc};
use glam::{DMat3, DQuat, DVec3};
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, BTreeSet};

/// The source of a geometry.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Source {
    /// An implicit shape.
    Shape(usize),
    /// Meshes at and below a node, and the one moving node below it that is included all the same.
    Mesh(usize, Option<usize>),
}

/// All that a geometry depends on.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Build {
    of: Source,
    /// Bits of f32.
    scale: [u32; 9],
    hull: bool,
    /// The numbers of its decomposition.
    pieces: Option<[u32; 3]>,
}

/// The parts of a file that have been read, and the scene that they become.
pub(super) struct Loader<'a> {
    pub(super) parts: &'a Parts,
    pub(super) tree: &'a Tree,
    pub(super) physics: Vec<Option<NodePhysics>>,
    shapes: Vec<extension::Shape>,
    materials: Vec<Material>,
    filters: Vec<Filter>,
    unfiltered: Filter,
    pub(super) joints: Vec<joints::Rows>,
    pub(super) couplings: Vec<extension::Coupling>,
    /// By the node of each joint: its index in the scene, or nothing if it is left out.
    pub(super) joint_at: BTreeMap<usize, Option<usize>>,
    pub(super) scene: Scene,
    pub(super) tally: Tally,
    /// Built geometry, shared by all nodes that use it at the same scale.
    built: BTreeMap<Build, Placed>,
    /// Per node: the body with `motion` that it belongs to.
    pub(super) body: Vec<Option<usize>>,
    /// Per node: the static body at it, or else nearest above it.
    pub(super) ground: Vec<Option<usize>>,
}

impl<'a> Loader<'a> {
    pub(super) fn new(
        parts: &'a Parts,
        tree: &'a Tree,
        physics: Vec<Option<NodePhysics>>,
        mut scene: Scene,
        tally: Tally,
    ) -> Result<Self, SceneError> {
        let shapes: Shapes =
            parts.document.extension_value(SHAPES).map(|v| parse(parts, v)).transpose()?.unwrap_or_default();
        let root: Physics = parts
            .document
            .extension_value(RIGID_BODIES)
            .map(|v| parse(parts, v))
            .transpose()?
            .unwrap_or_default();
        let filters = filter::filters(&root.collision_filters).map_err(|_| SceneError::Malformed {
            file: parts.path.clone(),
            what: "more than 64 collision systems: no more can be told apart".into(),
        })?;
        let materials = root.physics_materials.iter().map(|m| material(m, &mut scene.notes)).collect();
        let joints = joints::rows(parts, &root.physics_joints)?;
        let unfiltered = if filters.is_empty() { Filter::default() } else { filter::unfiltered() };
        let nobody = vec![None; tree.parent.len()];
        Ok(Loader {
            parts,
            tree,
            physics,
            shapes: shapes.shapes,
            materials,
            filters,
            unfiltered,
            joints,
            couplings: root.extras.couplings,
            joint_at: BTreeMap::new(),
            scene,
            tally,
            built: BTreeMap::new(),
            body: nobody.clone(),
            ground: nobody,
        })
    }

    /// Counts all meshes that will be built, each once, before the first is.
    pub(super) fn charge(&mut self) -> Result<(), SceneError> {
        let mut home = vec![None; self.tree.parent.len()];
        let mut seen = BTreeSet::new();
        for &node in &self.tree.order {
            home[node] = self.tree.parent[node].and_then(|parent| home[parent]);
            let Some(physics) = &self.physics[node] else { continue };
            let mut dynamic = false;
            if physics.motion.is_some() {
                home[node] = Some(node);
            }
            if let Some(motion) = home[node].and_then(|home| self.physics[home].as_ref()?.motion.as_ref()) {
                dynamic = !motion.is_kinematic;
            }
            let of_trigger = physics.trigger.as_ref().and_then(|trigger| trigger.geometry.as_ref());
            let of_collider = physics.collider.as_ref().map(|collider| &collider.geometry);
            for geometry in of_trigger.into_iter().chain(of_collider) {
                let scale = self.scale(node);
                // Its error is reported when it is built.
                let Ok(build) = self.build_of(node, geometry, scale, (home[node], dynamic)) else { continue };
                if let Source::Mesh(mesh, own) = build.of
                    && scale != DMat3::ZERO
                    && seen.insert(build)
                {
                    let moves = |n: usize| Some(n) != own && moves(&self.physics, n);
                    shapes::charge_mesh(self.parts, mesh, &moves, &mut self.tally)
                        .map_err(|p| problem(self.parts, node, p))?;
                }
            }
        }
        Ok(())
    }

    /// Bodies first: parents come before children, so a collider's body is there when it is reached.
    pub(super) fn visit(&mut self, node: usize) -> Result<(), SceneError> {
        if let Some(parent) = self.tree.parent[node] {
            self.body[node] = self.body[parent];
            self.ground[node] = self.ground[parent];
        }
        let Some(physics) = self.physics[node].take() else { return Ok(()) };
        if let Some(motion) = &physics.motion {
            let kind = if motion.is_kinematic { BodyKind::Kinematic } else { BodyKind::Dynamic };
            self.body[node] = Some(self.add_body(node, kind)?);
        }
        // A trigger without a shape is one of the shapes of other nodes, which are triggers themselves.
        if let Some(extension::Trigger { geometry: Some(geometry), collision_filter }) = &physics.trigger {
            self.add_shape(node, geometry, (None, *collision_filter), true)?;
        }
        if let Some(extension::Collider { geometry, physics_material, collision_filter }) = &physics.collider
        {
            self.add_shape(node, geometry, (*physics_material, *collision_filter), false)?;
        }
        self.physics[node] = Some(physics);
        Ok(())
    }

    fn add_body(&mut self, node: usize, kind: BodyKind) -> Result<usize, SceneError> {
        self.tally.bodies.take(1).map_err(|e| problem(self.parts, node, e.into()))?;
        let rotation = self.tree.rotation[node].as_quat();
        let desc =
            BodyDesc::new(kind).with_position(self.tree.global[node].translation).with_rotation(rotation);
        self.scene.bodies.push(SceneBody { name: self.name(node), node: Some(node), desc });
        Ok(self.scene.bodies.len() - 1)
    }

    fn add_shape(
        &mut self,
        node: usize,
        geometry: &extension::Geometry,
        (material, filter): (Option<usize>, Option<usize>),
        sensor: bool,
    ) -> Result<(), SceneError> {
        let scale = self.scale(node);
        if scale == DMat3::ZERO {
            self.note(node, "its shape is off: the scale is zero");
            return Ok(());
        }
        let body = match self.body[node] {
            Some(body) => body,
            None => {
                let body = self.add_body(node, BodyKind::Static)?;
                self.ground[node] = Some(body);
                body
            }
        };
        let kind = self.scene.bodies[body].desc.kind;
        let placed = self.geometry(node, geometry, scale, kind).map_err(|p| problem(self.parts, node, p))?;
        if let Some(note) = placed.note {
            self.note(node, note);
        }
        let missing = |what: &str, index: usize| {
            problem(self.parts, node, Problem::Text(format!("{what} {index} does not exist")))
        };
        let material = match material {
            Some(i) => *self.materials.get(i).ok_or_else(|| missing("physics material", i))?,
            None => Material::default(),
        };
        let filter = match filter {
            Some(i) => *self.filters.get(i).ok_or_else(|| missing("collision filter", i))?,
            None => self.unfiltered,
        };
        if sensor && !placed.geometry.is_convex() {
            self.note(node, "its trigger is left out: it is not convex");
            return Ok(());
        }
        let mut shape =
            ShapeDesc::new(placed.geometry).with_material(material).with_filter(filter).with_sensor(sensor);
        if sensor {
            shape.density = 0.0;
        }
        let home = self.scene.bodies[body].node.unwrap_or(node);
        shape.position = placed.offset;
        if home != node {
            let (apart, turn) = self.relative(home, node);
            shape.rotation = turn.as_quat();
            shape.position = (apart + turn * placed.offset.as_dvec3()).as_vec3();
        }
        shape.validate().map_err(|e| problem(self.parts, node, Problem::Engine(e)))?;
        let more = placed.more.into_iter().map(|geometry| shape.clone().with_geometry(geometry));
        let more: Vec<_> = more.collect();
        self.scene.bodies[body].desc.shapes.extend([shape].into_iter().chain(more));
        Ok(())
    }

    /// The geometry of a collider, built once for all that are alike.
    fn geometry(
        &mut self,
        node: usize,
        geometry: &extension::Geometry,
        scale: DMat3,
        kind: BodyKind,
    ) -> Result<Placed, Problem> {
        let dynamic = kind == BodyKind::Dynamic;
        let home = self.body[node].and_then(|body| self.scene.bodies[body].node);
        let key = self.build_of(node, geometry, scale, (home, dynamic))?;
        let (hull, decomposition) = (key.hull, geometry.extras.decomposition);
        let mut placed = match self.built.get(&key) {
            Some(placed) => placed.clone(),
            None => {
                let form = match decomposition {
                    Some(pieces) => Form::Pieces(pieces.settings()),
                    None if hull => Form::Hull,
                    None => Form::Mesh,
                };
                let placed = self.build(key.of, scale, form)?;
                self.built.insert(key, placed.clone());
                placed
            }
        };
        if dynamic && matches!(placed.geometry, Geometry::Plane | Geometry::Mesh(_)) {
            return Err(Error::StaticOnly { shape: "plane" }.into());
        }
        if hull && !geometry.convex_hull {
            placed.note = Some("a mesh on a dynamic body is its convex hull");
        }
        Ok(placed)
    }

    /// The geometry built for a collider. `home`: the node of its body, and whether that is dynamic.
    fn build_of(
        &self,
        node: usize,
        geometry: &extension::Geometry,
        scale: DMat3,
        (home, dynamic): (Option<usize>, bool),
    ) -> Result<Build, Problem> {
        let pieces = geometry.extras.decomposition.map(|pieces| pieces.key());
        if pieces.is_some() && geometry.node.is_none() {
            return Err(Problem::Text("decomposition needs a geometry with a node".into()));
        }
        let hull = geometry.node.is_some() && pieces.is_none() && (geometry.convex_hull || dynamic);
        let of = match (geometry.shape, geometry.node) {
            (Some(shape), None) => Source::Shape(shape),
            (None, Some(mesh)) => {
                // Geometry stops at other nodes with motion, but not at the collider's own node.
                let within =
                    self.tree.is_below(node, mesh) || !self.tree.in_scene.get(mesh).is_some_and(|&i| i);
                let own = (node != mesh && within && home == Some(node)).then_some(node);
                Source::Mesh(mesh, own)
            }
            _ => return Err(Problem::Text("its geometry must have either a shape or a node".into())),
        };
        // As f32, as files have it: under a rotation it has the noise of f64, zeros of both signs among it.
        let scale = scale.to_cols_array().map(|x| (x as f32 + 0.0).to_bits());
        Ok(Build { of, scale, hull, pieces })
    }

    fn build(&mut self, of: Source, scale: DMat3, form: Form) -> Result<Placed, Problem> {
        match of {
            Source::Shape(shape) => match self.shapes.get(shape) {
                Some(shape) => shapes::implicit(shape, scale, &mut self.tally),
                None => Err(Problem::Text(format!("shape {shape} does not exist"))),
            },
            Source::Mesh(mesh, own) => {
                let moves = |n: usize| Some(n) != own && moves(&self.physics, n);
                shapes::of_mesh(self.parts, mesh, &moves, form, scale)
            }
        }
    }

    /// Where a node is in the frame of another, without scales: position [m] and rotation.
    pub(super) fn relative(&self, home: usize, node: usize) -> (DVec3, DQuat) {
        let back = self.tree.rotation[home].inverse();
        let apart = self.tree.global[node].translation - self.tree.global[home].translation;
        (back * apart, back * self.tree.rotation[node])
    }

    /// Mass and velocity, once all shapes are there; then joints, once the moving bodies are known.
    pub(super) fn finish(mut self) -> Result<Scene, SceneError> {
        for index in 0..self.scene.bodies.len() {
            let Some(node) = self.scene.bodies[index].node else { continue };
            let scale = self.scale(node);
            let failed = |e: Error| problem(self.parts, node, Problem::Engine(e));
            let desc = &mut self.scene.bodies[index].desc;
            let mut notes = Vec::new();
            if let Some(motion) = self.physics[node].as_ref().and_then(|p| p.motion.as_ref()) {
                notes = motion::apply(motion, scale, desc).map_err(failed)?;
            }
            desc.validate().map_err(failed)?;
            notes.into_iter().for_each(|n| self.note(node, n));
        }
        self.add_joints()?;
        self.add_couplings()?;
        Ok(self.scene)
    }

    /// The rest of a node's transform without its pose.
    fn scale(&self, node: usize) -> DMat3 {
        let linear = self.tree.global[node].matrix3;
        let rotation = self.tree.rotation[node];
        match rotation == DQuat::IDENTITY {
            true => linear,
            false => tidy(DMat3::from_quat(rotation.normalize()).transpose() * linear),
        }
    }

    fn node(&self, node: usize) -> Option<gltf::Node<'a>> {
        self.parts.document.nodes().nth(node)
    }

    pub(super) fn name(&self, node: usize) -> String {
        let name = self.node(node).and_then(|n| n.name().map(str::to_owned));
        name.unwrap_or_else(|| format!("node {node}"))
    }

    fn label(&self, node: usize) -> String {
        self.node(node).map_or_else(|| node.to_string(), |n| tree::label(&n))
    }

    pub(super) fn note(&mut self, node: usize, what: &str) {
        let note = format!("node {}: {what}", self.label(node));
        self.scene.notes.push(note);
    }
}

fn moves(physics: &[Option<NodePhysics>], node: usize) -> bool {
    physics.get(node).and_then(Option::as_ref).is_some_and(|p| p.motion.is_some())
}

/// Rounds numbers that are nearly whole: a scale of 1 under a rotation must not become 0.9999999.
fn tidy(m: DMat3) -> DMat3 {
    let near = |v: f64| if (v - v.round()).abs() < 1e-7 { v.round() } else { v };
    DMat3::from_cols_array(&m.to_cols_array().map(near))
}

fn material(m: &extension::Material, notes: &mut Vec<String>) -> Material {
    let combine = |c: Option<extension::Combine>| match c {
        None | Some(extension::Combine::Average) => Combine::Average,
        Some(extension::Combine::Minimum) => Combine::Minimum,
        Some(extension::Combine::Maximum) => Combine::Maximum,
        Some(extension::Combine::Multiply) => Combine::Multiply,
    };
    if m.restitution > 1.0 {
        notes.push(format!("a restitution of {} is taken as 1", m.restitution));
    }
    let material = Material::default()
        .with_static_friction(m.static_friction)
        .with_dynamic_friction(m.dynamic_friction)
        .with_restitution(m.restitution.min(1.0))
        .with_friction_combine(combine(m.friction_combine))
        .with_restitution_combine(combine(m.restitution_combine));
    m.extras.on(material)
}

/// One of our extensions' objects.
pub(super) fn parse<T: DeserializeOwned>(parts: &Parts, value: &serde_json::Value) -> Result<T, SceneError> {
    T::deserialize(value).map_err(|e| SceneError::Malformed {
        file: parts.path.clone(),
        what: format!("physics extension: {e}"),
    })
}
