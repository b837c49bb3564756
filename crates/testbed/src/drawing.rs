//! What the page draws of a world: meshes, each once, and where they are.

use backstop::debug::{self, DebugDraw, DrawOptions, DrawnShape};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyHandle, BodyKind, CharacterHandle, Geometry, GeometryKey, JointHandle, ShapeHandle, World,
};
use std::collections::HashMap;

/// Numbers of a pose: position [m], rotation, 1 if the body is asleep.
pub(crate) const POSE: usize = 8;

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Drawn {
    Shape(ShapeHandle),
    Character(CharacterHandle),
}

/// Mesh and tone of what is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Look {
    key: GeometryKey,
    tone: u32,
}

/// The shapes of a world, in an order that stays while it is stepped.
#[derive(Default)]
pub(crate) struct Drawing {
    /// Corners of triangles, three numbers each. The page keeps them, so they stay when shapes go.
    pub(crate) meshes: Vec<Vec<f32>>,
    /// Mesh and tone of each shape.
    pub(crate) instances: Vec<[u32; 2]>,
    /// Pairs of shapes whose bodies are joined.
    pub(crate) links: Vec<[u32; 2]>,
    /// The joints of these pairs.
    linked: Vec<JointHandle>,
    places: HashMap<Drawn, (usize, Look)>,
    /// The mesh of each geometry, which is kept so that its key stays its own.
    made: HashMap<GeometryKey, (u32, Geometry)>,
    joints: usize,
}

impl Drawing {
    /// Brings it up to date with what there is; whether that has changed.
    pub(crate) fn renew(&mut self, world: &World) -> bool {
        let mut seen = Seen::default();
        visit(world, |drawn, look, _, _| {
            seen.count += 1;
            seen.changed |= self.places.get(&drawn).is_none_or(|(_, known)| *known != look);
        });
        let same = !seen.changed && seen.count == self.places.len() && self.joints == world.joint_count();
        if same {
            return false;
        }
        self.places.clear();
        self.instances.clear();
        self.joints = world.joint_count();
        visit(world, |drawn, look, geometry, _| {
            let mesh = self.mesh(look.key, geometry);
            self.places.insert(drawn, (self.instances.len(), look));
            self.instances.push([mesh, look.tone]);
        });
        (self.links, self.linked) = self.links_of(world).into_iter().unzip();
        true
    }

    fn mesh(&mut self, key: GeometryKey, geometry: &Geometry) -> u32 {
        let meshes = &mut self.meshes;
        let made = self.made.entry(key).or_insert_with(|| {
            let mut corners = Vec::new();
            debug::triangles(geometry, None, &mut |triangle| {
                corners.extend(triangle.iter().flat_map(Vec3::to_array));
            });
            meshes.push(corners);
            (meshes.len() as u32 - 1, geometry.clone())
        });
        made.0
    }

    fn links_of(&self, world: &World) -> Vec<([u32; 2], JointHandle)> {
        let place = |body: BodyHandle| {
            let shape = world.shapes(body).ok()?.next()?;
            self.place(shape).map(|place| place as u32)
        };
        let mut links = Vec::with_capacity(self.joints);
        for body in world.bodies() {
            for joint in world.joints_of(body).into_iter().flatten() {
                // Each joint is met at both of its bodies.
                if let Ok([a, b]) = world.joint_bodies(joint)
                    && a == body
                    && let (Some(a), Some(b)) = (place(a), place(b))
                {
                    links.push(([a, b], joint));
                }
            }
        }
        links
    }

    /// Where each pair is joined, relative to the world's origin: a point of either body. Not a number where
    /// the joint is gone.
    pub(crate) fn anchors(&self, world: &World, into: &mut Vec<f32>) {
        let origin = world.origin();
        for &joint in &self.linked {
            let ends = world.joint_frames(joint).map(|frames| frames.map(|(at, _)| (at - origin).as_vec3()));
            into.extend(ends.unwrap_or([Vec3::NAN; 2]).iter().flat_map(Vec3::to_array));
        }
    }

    /// The place of a shape among the instances.
    pub(crate) fn place(&self, shape: ShapeHandle) -> Option<usize> {
        self.places.get(&Drawn::Shape(shape)).map(|(place, _)| *place)
    }

    /// Where all shapes are, relative to the world's origin.
    pub(crate) fn poses(&self, world: &World, into: &mut Vec<f32>) {
        let start = into.len();
        into.resize(start + POSE * self.instances.len(), 0.0);
        let origin = world.origin();
        visit(world, |drawn, _, _, pose| {
            let Some((place, _)) = self.places.get(&drawn) else { return };
            let (at, turn) = ((pose.position - origin).as_vec3(), pose.rotation);
            let asleep = f32::from(u8::from(pose.asleep));
            let pose = [at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w, asleep];
            into[start + POSE * place..][..POSE].copy_from_slice(&pose);
        });
    }
}

#[derive(Default)]
struct Seen {
    count: usize,
    changed: bool,
}

struct Pose {
    position: DVec3,
    rotation: Quat,
    asleep: bool,
}

/// Calls `with` for all shapes, then for all characters.
fn visit(world: &World, with: impl FnMut(Drawn, Look, &Geometry, Pose)) {
    let mut visitor = Visitor { world, with };
    world.draw(&DrawOptions { shapes: true, ..DrawOptions::nothing() }, &mut visitor);
    for handle in world.characters() {
        let Ok(character) = world.character(handle) else { continue };
        let (geometry, rotation) = character.shape();
        let look = Look { key: geometry.key(), tone: KINEMATIC };
        let pose = Pose { position: character.position(), rotation, asleep: false };
        (visitor.with)(Drawn::Character(handle), look, &geometry, pose);
    }
}

struct Visitor<'a, F> {
    world: &'a World,
    with: F,
}

impl<F: FnMut(Drawn, Look, &Geometry, Pose)> DebugDraw for Visitor<'_, F> {
    fn shape(&mut self, shape: &DrawnShape<'_>) {
        let look = Look { key: shape.geometry.key(), tone: tone(shape.kind, shape.geometry) };
        let asleep = self.world.is_sleeping(shape.body).unwrap_or(false);
        let pose = Pose { position: shape.position, rotation: shape.rotation, asleep };
        (self.with)(Drawn::Shape(shape.shape), look, shape.geometry, pose);
    }
}

const KINEMATIC: u32 = 5;

/// The colour of a shape, as an index into the renderer's list.
fn tone(kind: BodyKind, geometry: &Geometry) -> u32 {
    match (kind, geometry) {
        (_, Geometry::Plane) => 8,
        _ if !geometry.is_convex() => 7,
        (BodyKind::Static, _) => 6,
        (BodyKind::Kinematic, _) => KINEMATIC,
        (_, Geometry::Sphere { .. }) => 0,
        (_, Geometry::Capsule { .. }) => 1,
        (_, Geometry::Box { .. }) => 2,
        (_, Geometry::Cylinder { .. }) => 3,
        _ => 4,
    }
}
