//! A scene as nodes: one per body, with a visible mesh for each shape and, if asked for, both physics
//! extensions.
//!
//! The extensions have no density (a body whose shapes have another than 1000 kg/m³ gets a mass), no groups
//! of filters, no locked axes and no gravity; these are not written. Joints are in `joints.rs`. Other
//! properties without names are in the object `backstop` of `extras`, see `gltf_in`.

use super::document::Document;
use super::visual;
use crate::files::gltf_in::extension::{MaterialExtras, OWN, RIGID_BODIES, SHAPES};
use crate::{Scene, SceneBody};
use backstop::{BodyDesc, BodyKind};
use backstop::{Combine, Filter, Geometry, GeometryKey, MassProperties, Material, ShapeDesc};
use glam::{DVec3, Quat, Vec3};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Adds bodies to a document.
pub(super) struct Builder<'a> {
    pub(super) document: &'a mut Document,
    physics: bool,
    /// Meshes by geometry and colour, so that equal shapes share one.
    /// By geometry and colour.
    meshes: BTreeMap<(GeometryKey, [u32; 3]), Option<usize>>,
    shapes: Vec<Value>,
    materials: Vec<Value>,
    filters: Vec<Value>,
    pub(super) joints: Vec<Value>,
    pub(super) couplings: Vec<Value>,
}

/// A document of the whole scene; body `i` is node `nodes[i]`.
pub(super) fn scene(scene: &Scene, physics: bool) -> (Document, Vec<usize>) {
    let mut document = Document::new();
    let mut builder = Builder::new(&mut document, physics);
    let nodes: Vec<usize> = scene.bodies.iter().map(|b| builder.body(b)).collect();
    if physics {
        let joints: Vec<_> =
            scene.joints.iter().map(|joint| builder.joint(joint, &scene.bodies, &nodes)).collect();
        scene.couplings.iter().for_each(|coupling| builder.coupling(coupling, &joints));
    }
    builder.finish();
    document.push("scenes", json!({ "name": scene.name, "nodes": nodes }));
    document.json.insert("scene".into(), json!(0));
    (document, nodes)
}

impl<'a> Builder<'a> {
    pub(super) fn new(document: &'a mut Document, physics: bool) -> Self {
        let [shapes, materials, filters, joints, couplings] = [const { Vec::new() }; 5];
        Builder { document, physics, meshes: BTreeMap::new(), shapes, materials, filters, joints, couplings }
    }

    /// Adds a body; returns its node.
    pub(super) fn body(&mut self, body: &SceneBody) -> usize {
        let desc = &body.desc;
        let mut node = json!({ "name": body.name });
        place(&mut node, desc.position, desc.rotation);
        let index = self.document.push("nodes", node);
        let moves = desc.kind != BodyKind::Static;
        let mut children = Vec::new();
        let mut collider = None;
        match &desc.shapes[..] {
            [shape] if alone(shape) => {
                let mesh = self.mesh(&shape.geometry, moves);
                self.set(index, "mesh", mesh);
                collider = Some((role(shape), self.collider(shape, index)));
            }
            shapes => {
                for shape in shapes {
                    let mut node = json!({});
                    place(&mut node, shape.position.as_dvec3(), shape.rotation);
                    let child = self.document.push("nodes", node);
                    let mesh = self.mesh(&shape.geometry, moves);
                    self.set(child, "mesh", mesh);
                    if self.physics {
                        let collider = self.collider(shape, child);
                        self.set(
                            child,
                            "extensions",
                            Some(json!({ RIGID_BODIES: { role(shape): collider } })),
                        );
                    }
                    children.push(child);
                }
            }
        }
        if !children.is_empty() {
            self.set(index, "children", Some(json!(children)));
        }
        if self.physics {
            let mut physics = json!({});
            if moves {
                physics["motion"] = motion(desc);
            }
            if let Some((role, collider)) = collider {
                physics[role] = collider;
            }
            if physics != json!({}) {
                self.set(index, "extensions", Some(json!({ RIGID_BODIES: physics })));
            }
        }
        index
    }

    /// Writes the root objects of the extensions.
    pub(super) fn finish(self) {
        if !self.physics {
            return;
        }
        let mut root = json!({ RIGID_BODIES: {} });
        let lists = [
            ("physicsMaterials", self.materials),
            ("collisionFilters", self.filters),
            ("physicsJoints", self.joints),
        ];
        for (name, list) in lists {
            if !list.is_empty() {
                root[RIGID_BODIES][name] = json!(list);
            }
        }
        if !self.couplings.is_empty() {
            root[RIGID_BODIES]["extras"] = json!({ OWN: { "couplings": self.couplings } });
        }
        if !self.shapes.is_empty() {
            root[SHAPES] = json!({ "shapes": self.shapes });
        }
        self.document.json.insert("extensions".into(), root);
        self.document.json.insert("extensionsUsed".into(), json!([SHAPES, RIGID_BODIES]));
    }

    fn set(&mut self, node: usize, key: &str, value: Option<Value>) {
        if let Some(value) = value {
            self.document.list("nodes")[node][key] = value;
        }
    }

    fn mesh(&mut self, geometry: &Geometry, moves: bool) -> Option<Value> {
        let colour = visual::colour(geometry, moves);
        let key = (geometry.key(), colour.map(f32::to_bits));
        if let Some(mesh) = self.meshes.get(&key) {
            return mesh.map(|m| json!(m));
        }
        let (vertices, triangles) = visual::triangles(geometry);
        let mesh = (!triangles.is_empty()).then(|| {
            let positions = self.document.positions(&vertices);
            let indices = self.document.triangles(&triangles, vertices.len());
            let [r, g, b] = colour;
            let material = self.document.intern(
                "materials",
                json!({ "doubleSided": true, "pbrMetallicRoughness":
                    { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.7 } }),
            );
            self.document.push(
                "meshes",
                json!({
                    "primitives": [{
                        "attributes": { "POSITION": positions },
                        "indices": indices,
                        "material": material,
                    }],
                }),
            )
        });
        self.meshes.insert(key, mesh);
        mesh.map(|m| json!(m))
    }

    fn collider(&mut self, shape: &ShapeDesc, node: usize) -> Value {
        let geometry = match implicit(&shape.geometry) {
            Some(shape) => json!({ "shape": intern(&mut self.shapes, shape) }),
            None if matches!(shape.geometry, Geometry::Hull(_)) => {
                json!({ "node": node, "convexHull": true })
            }
            None => json!({ "node": node }),
        };
        let mut collider = json!({ "geometry": geometry });
        if shape.material != Material::default() && !shape.sensor {
            collider["physicsMaterial"] = json!(intern(&mut self.materials, material(&shape.material)));
        }
        if shape.filter != Filter::default() {
            collider["collisionFilter"] = json!(intern(&mut self.filters, filter(&shape.filter)));
        }
        collider
    }
}

/// The geometry of a shape at its node.
fn role(shape: &ShapeDesc) -> &'static str {
    if shape.sensor { "trigger" } else { "collider" }
}

/// One shape at the origin needs no node of its own.
pub(super) fn alone(shape: &ShapeDesc) -> bool {
    shape.position == Vec3::ZERO && shape.rotation == Quat::IDENTITY
}

pub(super) fn intern(list: &mut Vec<Value>, value: Value) -> usize {
    list.iter().position(|v| *v == value).unwrap_or_else(|| {
        list.push(value);
        list.len() - 1
    })
}

pub(super) fn place(node: &mut Value, position: DVec3, rotation: Quat) {
    if position != DVec3::ZERO {
        node["translation"] = json!(position.as_vec3().to_array());
    }
    if rotation != Quat::IDENTITY {
        node["rotation"] = json!(rotation.to_array());
    }
}

fn motion(desc: &BodyDesc) -> Value {
    let mut motion = json!({});
    let back = desc.rotation.inverse();
    if desc.kind == BodyKind::Kinematic {
        motion["isKinematic"] = json!(true);
    }
    for (name, v) in [("linearVelocity", desc.linear_velocity), ("angularVelocity", desc.angular_velocity)] {
        if v != Vec3::ZERO {
            motion[name] = json!((back * v).to_array());
        }
    }
    if desc.gravity_scale != 1.0 {
        motion["gravityFactor"] = json!(desc.gravity_scale);
    }
    let mut extras = json!({});
    for (name, cap) in
        [("maxLinearSpeed", desc.max_linear_speed), ("maxAngularSpeed", desc.max_angular_speed)]
    {
        if let Some(cap) = cap {
            extras[name] = json!(cap);
        }
    }
    for (name, damping) in [("linearDamping", desc.linear_damping), ("angularDamping", desc.angular_damping)]
    {
        if damping != 0.0 {
            extras[name] = json!(damping);
        }
    }
    add_extras(&mut motion, extras);
    let dense =
        |s: &ShapeDesc| MassProperties::of(&s.geometry, s.density).transformed(s.position, s.rotation);
    let mass = match desc.mass {
        None if desc.shapes.iter().any(|s| s.density != 1000.0) && desc.kind == BodyKind::Dynamic => {
            Some(MassProperties::combine(&desc.shapes.iter().map(dense).collect::<Vec<_>>()))
        }
        given => given,
    };
    if let Some(mass) = mass {
        let (moments, axes) = mass.principal();
        motion["mass"] = json!(mass.mass);
        motion["centerOfMass"] = json!(mass.centre_of_mass.to_array());
        motion["inertiaDiagonal"] = json!(moments.to_array());
        motion["inertiaOrientation"] = json!(axes.to_array());
    }
    motion
}

/// The implicit shape for a geometry that has one.
fn implicit(geometry: &Geometry) -> Option<Value> {
    let round = |kind: &str, half_height: f32, bottom: f32, top: f32| {
        json!({
            "type": kind,
            kind: { "height": 2.0 * half_height, "radiusBottom": bottom, "radiusTop": top },
        })
    };
    Some(match geometry {
        Geometry::Sphere { radius } => json!({ "type": "sphere", "sphere": { "radius": radius } }),
        // A capsule without height is not allowed in a file.
        Geometry::Capsule { half_height: 0.0, radius_bottom: b, radius_top: t } => {
            json!({ "type": "sphere", "sphere": { "radius": b.max(*t) } })
        }
        Geometry::Capsule { half_height, radius_bottom, radius_top } => {
            round("capsule", *half_height, *radius_bottom, *radius_top)
        }
        Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
            round("cylinder", *half_height, *radius_bottom, *radius_top)
        }
        Geometry::Box { half_extents } => {
            json!({ "type": "box", "box": { "size": (2.0 * *half_extents).to_array() } })
        }
        Geometry::Plane => json!({ "type": "plane", "plane": {} }),
        // Hulls, meshes and height fields.
        _ => return None,
    })
}

fn material(m: &Material) -> Value {
    let combine = |c: Combine| match c {
        Combine::Minimum => "minimum",
        Combine::Maximum => "maximum",
        Combine::Multiply => "multiply",
        _ => "average",
    };
    let mut out = json!({
        "staticFriction": m.static_friction,
        "dynamicFriction": m.dynamic_friction,
        "restitution": m.restitution,
        "frictionCombine": combine(m.friction_combine),
        "restitutionCombine": combine(m.restitution_combine),
    });
    let [mut extras, plain] = [m, &Material::default()].map(|m| json!(MaterialExtras::of(m)));
    if let Some(fields) = extras.as_object_mut() {
        fields.retain(|name, value| plain[name.as_str()] != *value);
    }
    add_extras(&mut out, extras);
    out
}

/// Adds properties for which the extensions have no names, if there are any.
fn add_extras(to: &mut Value, extras: Value) {
    if extras != json!({}) {
        to["extras"] = json!({ OWN: extras });
    }
}

fn filter(f: &Filter) -> Value {
    let names = |bits: u64| -> Vec<String> {
        (0..64).filter(|i| bits >> i & 1 == 1).map(|i| format!("system {i}")).collect()
    };
    let mut out = json!({});
    if f.category != u64::MAX {
        out["collisionSystems"] = json!(names(f.category));
    }
    // The shorter of both lists, so that "all but one" stays readable and names no other systems.
    if f.mask.count_ones() > 32 {
        if f.mask != u64::MAX {
            out["notCollideWithSystems"] = json!(names(!f.mask));
        }
    } else {
        out["collideWithSystems"] = json!(names(f.mask));
    }
    out
}
