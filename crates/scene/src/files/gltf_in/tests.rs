//! Scenes written by hand, the conformance scenes if they are at hand, and broken files.

use crate::files::testing::{data, scratch};
use crate::random::Random;
use crate::{Scene, SceneError, SceneJoint, load};
use backstop::BodyKind;
use backstop::LoadLimits;
use backstop::{Axes, Axis, Frame, Motion, Motor, Spring};
use backstop::{Combine, Geometry, TriangleMesh};
use glam::{DVec3, Quat, Vec3};
use serde_json::{Value, json};
use std::f32::consts::FRAC_1_SQRT_2;

fn load_json(test: &str, json: &Value) -> Result<Scene, SceneError> {
    let path = scratch(test).join("scene.gltf");
    std::fs::write(&path, json.to_string()).unwrap();
    load(&path)
}

/// A file with the given nodes, shapes and root object of the physics extension.
fn file(nodes: Value, shapes: Value, physics: Value) -> Value {
    let mut is_child = Vec::new();
    for node in nodes.as_array().unwrap() {
        is_child.extend(node["children"].as_array().into_iter().flatten().filter_map(Value::as_u64));
    }
    let roots: Vec<u64> =
        (0..nodes.as_array().unwrap().len() as u64).filter(|n| !is_child.contains(n)).collect();
    json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_implicit_shapes", "KHR_physics_rigid_bodies"],
        "extensionsRequired": ["KHR_physics_rigid_bodies"],
        "scenes": [{ "nodes": roots }],
        "nodes": nodes,
        "extensions": { "KHR_implicit_shapes": { "shapes": shapes }, "KHR_physics_rigid_bodies": physics }
    })
}

fn physics(value: Value) -> Value {
    json!({ "KHR_physics_rigid_bodies": value })
}

fn one_shape(test: &str, shape: Value, scale: [f32; 3]) -> Geometry {
    let collider = physics(json!({ "collider": { "geometry": { "shape": 0 } } }));
    let nodes = json!([{ "scale": scale, "extensions": collider }]);
    let scene = load_json(test, &file(nodes, json!([shape]), json!({}))).unwrap();
    scene.bodies[0].desc.shapes[0].geometry.clone()
}

#[test]
fn implicit_shapes_have_the_defaults_of_the_specification() {
    // KHR_implicit_shapes, schemas: radius 0.5, size 1 1 1, height 0.5 and radii 0.25.
    let shape = |s: Value| one_shape("defaults", s, [1.0; 3]);
    assert!(matches!(shape(json!({ "type": "sphere" })), Geometry::Sphere { radius: 0.5 }));
    let Geometry::Box { half_extents } = shape(json!({ "type": "box", "box": {} })) else { panic!() };
    assert_eq!(half_extents, Vec3::splat(0.5));
    let capsule = shape(json!({ "type": "capsule", "capsule": { "height": 1.0, "radiusTop": 0.125 } }));
    let Geometry::Capsule { half_height, radius_bottom, radius_top } = capsule else { panic!() };
    assert_eq!((half_height, radius_bottom, radius_top), (0.5, 0.25, 0.125));
    let cylinder = shape(json!({ "type": "cylinder", "cylinder": { "radiusTop": 0.0 } }));
    let Geometry::Cylinder { half_height, radius_bottom, radius_top } = cylinder else { panic!() };
    assert_eq!((half_height, radius_bottom, radius_top), (0.25, 0.25, 0.0));
    assert!(matches!(shape(json!({ "type": "plane" })), Geometry::Plane));
}

#[test]
fn scale_is_baked_by_its_absolute_value() {
    // The example of KHR_physics_rigid_bodies, "Geometry": a unit box under [1, -2, 3] is a box of size [1,
    // 2, 3].
    let Geometry::Box { half_extents } = one_shape("scale", json!({ "type": "box" }), [1.0, -2.0, 3.0])
    else {
        panic!()
    };
    assert_eq!(half_extents, Vec3::new(0.5, 1.0, 1.5));
    let sphere = one_shape("scale", json!({ "type": "sphere" }), [3.0; 3]);
    assert!(matches!(sphere, Geometry::Sphere { radius: 1.5 }));
    let cylinder = one_shape("scale", json!({ "type": "cylinder" }), [2.0, 4.0, 2.0]);
    let Geometry::Cylinder { half_height: 1.0, radius_bottom: 0.5, radius_top: 0.5 } = cylinder else {
        panic!()
    };
    let Geometry::Hull(egg) = one_shape("scale", json!({ "type": "sphere" }), [1.0, 2.0, 4.0]) else {
        panic!()
    };
    for v in egg.vertices() {
        assert!(((*v / Vec3::new(0.5, 1.0, 2.0)).length() - 1.0).abs() < 1e-5, "on the ellipsoid");
    }
}

#[test]
fn colliders_below_a_motion_are_one_body_and_others_are_static() {
    let collider = physics(json!({ "collider": { "geometry": { "shape": 0 } } }));
    let nodes = json!([
        { "name": "car", "translation": [10, 0, 0], "rotation": [0, FRAC_1_SQRT_2, 0, FRAC_1_SQRT_2],
          "scale": [2, 2, 2], "children": [1, 2],
          "extensions": physics(json!({ "motion": { "linearVelocity": [0, 0, 3] } })) },
        { "translation": [1, 0, 0], "extensions": collider },
        { "name": "wheel", "translation": [0, 0, 1], "children": [3],
          "extensions": physics(json!({ "motion": { "isKinematic": true } })) },
        { "extensions": collider },
        { "translation": [0, -1, 0], "extensions": collider }
    ]);
    let scene = load_json("compound", &file(nodes, json!([{ "type": "sphere" }]), json!({}))).unwrap();
    let [car, wheel, ground] = &scene.bodies[..] else { panic!("{} bodies", scene.bodies.len()) };
    assert_eq!((car.name.as_str(), car.node, car.desc.kind), ("car", Some(0), BodyKind::Dynamic));
    // A quarter turn about y takes z to x.
    assert!((car.desc.linear_velocity - Vec3::new(3.0, 0.0, 0.0)).length() < 1e-6);
    let shape = &car.desc.shapes[0];
    assert!((shape.position - Vec3::new(2.0, 0.0, 0.0)).length() < 1e-6, "{}", shape.position);
    assert!(matches!(shape.geometry, Geometry::Sphere { radius: 1.0 }));
    assert_eq!(wheel.desc.kind, BodyKind::Kinematic);
    assert!((wheel.desc.position - DVec3::new(12.0, 0.0, 0.0)).length() < 1e-6, "{}", wheel.desc.position);
    assert_eq!((ground.desc.kind, ground.desc.shapes.len()), (BodyKind::Static, 1));
    assert_eq!(ground.desc.position, DVec3::new(0.0, -1.0, 0.0));
}

#[test]
fn mass_comes_from_the_file_or_from_the_shapes() {
    let body = |motion: Value| {
        let e = physics(json!({ "motion": motion, "collider": { "geometry": { "shape": 0 } } }));
        let scene =
            load_json("mass", &file(json!([{ "extensions": e }]), json!([{ "type": "box" }]), json!({})));
        scene.unwrap().bodies.remove(0).desc
    };
    assert_eq!(body(json!({})).mass, None);
    let given = body(json!({ "mass": 6.0, "gravityFactor": 0.5 }));
    assert_eq!(given.gravity_scale, 0.5);
    // A cube of side 1: m/6 about each axis.
    let mass = given.mass.unwrap();
    assert_eq!(mass.mass, 6.0);
    assert!((mass.inertia - glam::Mat3::IDENTITY).to_cols_array().iter().all(|v| v.abs() < 1e-5));
    let moved = body(json!({ "mass": 6.0, "centerOfMass": [0, 0.25, 0], "inertiaDiagonal": [1, 2, 2] }));
    let mass = moved.mass.unwrap();
    assert_eq!((mass.centre_of_mass, mass.inertia.y_axis.y), (Vec3::new(0.0, 0.25, 0.0), 2.0));
}

#[test]
fn zero_mass_and_inertia_mean_infinite() {
    let body = |motion: Value| {
        let e = physics(json!({ "motion": motion, "collider": { "geometry": { "shape": 0 } } }));
        let scene =
            load_json("zero", &file(json!([{ "extensions": e }]), json!([{ "type": "box" }]), json!({})));
        scene.unwrap().bodies.remove(0).desc
    };
    assert_eq!(body(json!({ "mass": 0 })).kind, BodyKind::Kinematic);
    assert_eq!(body(json!({ "mass": 0, "inertiaDiagonal": [1, 1, 1] })).lock_translation, [true; 3]);
    assert_eq!(body(json!({ "inertiaDiagonal": [0, 0, 0] })).lock_rotation, [true; 3]);
    assert_eq!(body(json!({ "inertiaDiagonal": [1, 0, 1] })).lock_rotation, [false, true, false]);
    assert_eq!(body(json!({ "mass": 0, "inertiaDiagonal": [0, 0, 0] })).kind, BodyKind::Kinematic);
}

#[test]
fn a_trigger_is_a_sensor_without_mass() {
    let trigger = physics(json!({ "trigger": { "geometry": { "shape": 0 } } }));
    let both = physics(json!({
        "motion": {}, "collider": { "geometry": { "shape": 0 } }, "trigger": { "geometry": { "shape": 0 } }
    }));
    let nodes = json!([{ "extensions": trigger }, { "extensions": both }]);
    let scene = load_json("trigger", &file(nodes, json!([{ "type": "box" }]), json!({}))).unwrap();
    assert_eq!((scene.bodies.len(), scene.notes.len()), (2, 0));
    let [one, two] = [0, 1].map(|i| &scene.bodies[i].desc);
    assert!(one.kind == BodyKind::Static && one.shapes[0].sensor && one.shapes[0].density == 0.0);
    let sensors: Vec<bool> = two.shapes.iter().map(|shape| shape.sensor).collect();
    assert_eq!((two.kind, sensors), (BodyKind::Dynamic, vec![true, false]));
    // Written and read again they are the same.
    let path = std::env::temp_dir().join(format!("backstop-trigger-{}.glb", std::process::id()));
    crate::write_scene(&scene, &path).unwrap();
    let again = crate::load(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    let sensors = |scene: &crate::Scene| -> Vec<Vec<bool>> {
        scene.bodies.iter().map(|body| body.desc.shapes.iter().map(|shape| shape.sensor).collect()).collect()
    };
    assert_eq!(sensors(&again), sensors(&scene));
}

#[test]
fn what_is_not_supported_is_refused_or_noted() {
    for (collider, says) in [
        (json!({ "geometry": { "shape": 7 } }), "shape 7 does not exist"),
        (json!({ "geometry": { "node": 7 } }), "node 7, does not exist"),
        (json!({ "geometry": {} }), "either a shape or a node"),
        (json!({ "geometry": { "shape": 0 }, "physicsMaterial": 3 }), "physics material 3"),
        (json!({ "geometry": { "shape": 1 } }), "\"torus\" are not known"),
        (json!({}), "missing field"),
    ] {
        let nodes = json!([{ "name": "n", "extensions": physics(json!({ "collider": collider })) }]);
        let json = file(nodes, json!([{ "type": "box" }, { "type": "torus" }]), json!({}));
        let error = load_json("refused", &json).unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    }
}

#[test]
fn a_cycle_of_nodes_is_refused() {
    let json = json!({ "asset": { "version": "2.0" }, "scenes": [{ "nodes": [0] }],
        "nodes": [{ "children": [1] }, { "children": [0] }] });
    assert!(load_json("cycle", &json).unwrap_err().to_string().contains("its own ancestor"));
}

#[test]
fn a_deep_chain_of_nodes_is_walked() {
    let mut nodes: Vec<Value> =
        (1..20_000).map(|i| json!({ "translation": [0, 1, 0], "children": [i] })).collect();
    nodes.push(json!({ "extensions": physics(json!({ "collider": { "geometry": { "shape": 0 } } })) }));
    let path = scratch("deep").join("scene.gltf");
    std::fs::write(&path, file(json!(nodes), json!([{ "type": "box" }]), json!({})).to_string()).unwrap();
    let mut limits = LoadLimits::default();
    limits.depth = 20_000;
    let scene = crate::load_limited(&path, &limits).unwrap();
    assert_eq!(scene.bodies[0].desc.position.y, 19_999.0);
}

fn count(mesh: &TriangleMesh) -> usize {
    super::super::assets::mesh_triangles(mesh).1.len()
}

#[test]
fn a_file_without_physics_is_one_static_mesh() {
    // Two triangles as a data URI: (0,0,0) (1,0,0) (0,1,0), under two nodes.
    let mut bytes = Vec::new();
    for v in [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
        v.iter().for_each(|c| bytes.extend(c.to_le_bytes()));
    }
    let text = base64::Engine::encode(&base64::engine::general_purpose::STANDARD, &bytes);
    let json = json!({ "asset": { "version": "2.0" },
        "nodes": [{ "mesh": 0 }, { "mesh": 0, "translation": [0, 0, 5] }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
            "min": [0, 0, 0], "max": [1, 1, 0] }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
        "buffers": [{ "byteLength": 36, "uri": format!("data:application/octet-stream;base64,{text}") }] });
    let scene = load_json("plain", &json).unwrap();
    let Geometry::Mesh(mesh) = &scene.bodies[0].desc.shapes[0].geometry else { panic!() };
    assert_eq!((scene.bodies.len(), count(mesh)), (1, 2));

    let mut short = json;
    short["accessors"][0]["count"] = json!(4);
    assert!(load_json("plain", &short).unwrap_err().to_string().contains("beyond its buffer"));
    short["accessors"][0]["count"] = json!(u64::MAX);
    assert!(load_json("plain", &short).is_err());
}

/// Expected: two tetrahedra that are apart are two hulls, as `extras` ask for; one hull without.
#[test]
fn a_mesh_on_a_dynamic_body_is_decomposed_on_demand() {
    let mut bytes = Vec::new();
    for x in [0.0f32, 5.0] {
        let [o, a, b, c] = [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0], [x, 0.0, 1.0]];
        [o, b, a, o, a, c, o, c, b, a, b, c]
            .as_flattened()
            .iter()
            .for_each(|x| bytes.extend(x.to_le_bytes()));
    }
    let text = base64::Engine::encode(&base64::engine::general_purpose::STANDARD, &bytes);
    let load = |extras: Value| {
        let geometry = json!({ "node": 0, "extras": extras });
        let body = physics(json!({ "motion": {}, "collider": { "geometry": geometry } }));
        let mut json = file(json!([{ "mesh": 0, "extensions": body }]), json!([]), json!({}));
        json["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": 0 } }] }]);
        json["accessors"] = json!([{ "bufferView": 0, "componentType": 5126, "count": 24, "type": "VEC3",
            "min": [0, 0, 0], "max": [6, 1, 1] }]);
        json["bufferViews"] = json!([{ "buffer": 0, "byteLength": 288 }]);
        let uri = format!("data:application/octet-stream;base64,{text}");
        json["buffers"] = json!([{ "byteLength": 288, "uri": uri }]);
        load_json("decomposed", &json)
    };
    let hulls = |extras: Value| load(extras).unwrap().bodies[0].desc.shapes.len();
    assert_eq!(hulls(json!({})), 1);
    assert_eq!(hulls(json!({ "backstop": { "decomposition": {} } })), 2);
    assert_eq!(hulls(json!({ "backstop": { "decomposition": { "maxHulls": 1 } } })), 1);
    let refused = load(json!({ "backstop": { "decomposition": { "concavity": -1 } } })).unwrap_err();
    assert!(refused.to_string().contains("concavity must be in 0..=10"), "{refused}");
}

fn conformance(name: &str) -> Option<Result<Scene, SceneError>> {
    Some(load(data("gltf")?.join(name)))
}

#[test]
fn conformance_velocities_are_in_node_space() {
    // 02 spins about the world's x; 04 says the same below a parent that is turned by 90° about y.
    for file in ["tests/RigidBodies_MotionProperties_02.gltf", "tests/RigidBodies_MotionProperties_04.gltf"] {
        let Some(scene) = conformance(file) else { return };
        let scene = scene.unwrap();
        assert!((scene.bodies[0].desc.angular_velocity - Vec3::X).length() < 1e-5, "{file}");
        assert_eq!(scene.bodies[0].desc.gravity_scale, 0.0);
    }
}

#[test]
fn conformance_filters_and_materials_are_those_of_the_file() {
    let Some(scene) = conformance("tests/RigidBodies_CollisionFilter_00.gltf") else { return };
    let scene = scene.unwrap();
    let filter = |i: usize| scene.bodies[i].desc.shapes[0].filter;
    assert!(filter(0).allows(&filter(2)), "this ball is held");
    assert!(!filter(1).allows(&filter(2)), "this one falls through");
    let scene = conformance("samples/Filtering.glb").unwrap().unwrap();
    let by_name = |name: &str| scene.bodies.iter().find(|b| b.name == name).unwrap().desc.shapes[0].filter;
    assert!(by_name("DynamicBlue").allows(&by_name("Ground")));
    assert!(!by_name("DynamicBlue").allows(&by_name("StaticGreen")));

    let scene = conformance("tests/RigidBodies_Materials_00.gltf").unwrap().unwrap();
    let material = |i: usize| scene.bodies[i].desc.shapes[0].material;
    assert_eq!((material(0).restitution, material(0).restitution_combine), (0.0, Combine::Maximum));
    assert_eq!((material(2).restitution, material(2).restitution_combine), (0.5, Combine::Average));
}

#[test]
fn conformance_scenes_load() {
    let Some(root) = data("gltf") else { return };
    let (mut loaded, mut joints) = (0, 0);
    for folder in ["tests", "samples"] {
        let mut files: Vec<_> =
            std::fs::read_dir(root.join(folder)).unwrap().map(|f| f.unwrap().path()).collect();
        files.sort();
        for path in files.iter().filter(|p| p.extension().is_some_and(|e| e == "gltf" || e == "glb")) {
            let has_joints = path.to_string_lossy().contains("Joint");
            let scene = load(path).unwrap();
            assert!(!scene.bodies.is_empty() && scene.bodies.iter().all(|b| !b.desc.shapes.is_empty()));
            assert_eq!(!scene.joints.is_empty(), has_joints, "{}", path.display());
            (loaded, joints) = (loaded + 1, joints + scene.joints.len());
        }
    }
    assert!(loaded > 30 && joints == 6 + 11, "{loaded} {joints}");
}

fn limits(joint: &SceneJoint) -> Vec<(Motion, Axes, f32, f32)> {
    joint.limits.iter().map(|l| (l.motion, l.axes, l.min, l.max)).collect()
}

/// Two balls with a joint between nodes below them, and a root object with the joint's description.
fn joined(test: &str, description: Value) -> Result<Scene, SceneError> {
    let ball = json!({ "geometry": { "shape": 0 } });
    let nodes = json!([
        { "name": "a", "extensions": physics(json!({ "motion": {}, "collider": ball })), "children": [1] },
        { "name": "pin", "extensions": physics(json!({ "joint": { "connectedNode": 2, "joint": 0 } })) },
        { "name": "b", "translation": [2, 0, 0], "extensions": physics(json!({ "motion": {}, "collider": ball })) }
    ]);
    load_json(test, &file(nodes, json!([{ "type": "sphere" }]), json!({ "physicsJoints": [description] })))
}

#[test]
fn limits_and_drives_are_those_of_the_file() {
    let description = json!({
        "limits": [
            { "linearAxes": [2, 0, 1], "max": 0.5 },
            { "linearAxes": [2, 0], "min": 0, "max": 0 },
            { "angularAxes": [2], "min": -0.5 },
            { "angularAxes": [2, 1], "max": 1, "stiffness": 3 },
            { "angularAxes": [0], "stiffness": 3, "damping": 4, "min": -1, "max": -1 },
            { "angularAxes": [0, 1, 2], "damping": 4 }
        ],
        "drives": [
            { "type": "linear", "mode": "force", "axis": 1, "maxForce": 7, "positionTarget": 1, "stiffness": 2 },
            { "type": "angular", "mode": "acceleration", "axis": 2, "velocityTarget": -1, "damping": 1e30 }
        ]
    });
    let scene = joined("limits", description).unwrap();
    assert_eq!(scene.notes, [""; 0]);
    let joint = &scene.joints[0];
    assert_eq!((&joint.name[..], joint.bodies, joint.collide), ("pin", [0, 1], false));
    assert_eq!(joint.frames[1], Frame::default());
    let none = f32::INFINITY;
    let expected = [
        (Motion::Linear, Axes::All, -none, 0.5),
        (Motion::Linear, Axes::Perpendicular(Axis::Y), 0.0, 0.0),
        (Motion::Angular, Axes::One(Axis::Z), -0.5, none),
        (Motion::Angular, Axes::Perpendicular(Axis::X), -none, 1.0),
        (Motion::Angular, Axes::One(Axis::X), -1.0, -1.0),
        (Motion::Angular, Axes::All, -none, none),
    ];
    assert_eq!(limits(joint), expected);
    let springs: Vec<_> = joint.limits.iter().map(|l| l.spring).collect();
    let soft = |damping| Some(Spring::Coefficients { stiffness: 3.0, damping });
    // Damping alone does not make a limit soft.
    assert_eq!(springs, [None, None, None, soft(0.0), soft(4.0), None]);
    let [pull, turn] = [
        Motor {
            motion: Motion::Linear,
            axis: Axis::Y,
            position: 1.0,
            velocity: 0.0,
            spring: Spring::Coefficients { stiffness: 2.0, damping: 0.0 },
            max_force: 7.0,
        },
        Motor {
            motion: Motion::Angular,
            axis: Axis::Z,
            position: 0.0,
            velocity: -1.0,
            spring: Spring::Acceleration { stiffness: 0.0, damping: f32::INFINITY },
            max_force: f32::INFINITY,
        },
    ];
    assert_eq!(joint.motors, [pull, turn]);
}

#[test]
fn joints_that_break_the_rules_are_refused() {
    let limit = |limit: Value| json!({ "limits": [{ "linearAxes": [0] }, limit] });
    let drive = |kind: &str, mode: &str, more: Value| {
        let mut drive = json!({ "type": kind, "mode": mode, "axis": 0 });
        more.as_object().unwrap().iter().for_each(|(k, v)| drive[k] = v.clone());
        json!({ "drives": [drive] })
    };
    for (description, says) in [
        (limit(json!({ "linearAxes": [0], "min": 2, "max": 1 })), "joint 0, limit 1: joint limit max"),
        (limit(json!({ "linearAxes": [0, 1], "max": -1 })), "at least zero"),
        (limit(json!({ "min": 2, "max": 1 })), "either linearAxes or angularAxes"),
        (limit(json!({ "linearAxes": [0], "angularAxes": [0] })), "either linearAxes or angularAxes"),
        (limit(json!({ "linearAxes": [0, 3] })), "no axis 3"),
        (limit(json!({ "linearAxes": [1, 1] })), "axis 1 is there twice"),
        (limit(json!({ "linearAxes": [0, 1, 2, 0] })), "axis 0 is there twice"),
        (limit(json!({ "linearAxes": [] })), "no axes"),
        (limit(json!({ "linearAxes": [-1] })), "invalid value"),
        (limit(json!({ "linearAxes": [0], "stiffness": -1 })), "spring stiffness"),
        (limit(json!({ "linearAxes": [0], "stiffness": 1, "damping": -1 })), "spring damping"),
        (drive("cubic", "force", json!({})), "joint 0, drive 0: drives of type \"cubic\""),
        (drive("linear", "impulse", json!({})), "the mode \"impulse\""),
        (drive("linear", "force", json!({ "axis": 3 })), "no axis 3"),
        (drive("linear", "force", json!({ "stiffness": -3 })), "spring stiffness"),
        (drive("linear", "force", json!({ "maxForce": -3 })), "motor force"),
        (drive("linear", "force", json!({ "positionTarget": 1e39 })), "motor position"),
        (json!({ "drives": [{ "type": "linear", "mode": "force" }] }), "missing field `axis`"),
    ] {
        let error = joined("joint_rules", description).unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    }
    for (joint, says) in [
        (json!({ "connectedNode": 1, "joint": 4 }), "\"n\" (0): joint 4 does not exist"),
        (json!({ "connectedNode": 4, "joint": 0 }), "\"n\" (0): connected node 4 does not exist"),
        (json!({ "joint": 0 }), "missing field `connectedNode`"),
    ] {
        let e = physics(json!({ "joint": joint, "motion": {} }));
        let json =
            file(json!([{ "name": "n", "extensions": e }, {}]), json!([]), json!({ "physicsJoints": [{}] }));
        let error = load_json("joint_of", &json).unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    }
}

/// Frames are relative to the body, in metres at any scale of the nodes; a node without motion stands on its
/// static body, and one with neither on the world.
#[test]
fn a_joint_sits_where_its_nodes_are() {
    let turn = [0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2];
    let ball = json!({ "geometry": { "shape": 0 } });
    let joint = |to: usize| json!({ "connectedNode": to, "joint": 0, "enableCollision": to == 6 });
    let nodes = json!([
        { "translation": [10, 0, 0], "rotation": turn, "scale": [2, 3, 2],
          "extensions": physics(json!({ "motion": {}, "collider": ball })), "children": [1] },
        { "translation": [1, 1, 0], "rotation": turn, "extensions": physics(json!({ "joint": joint(3) })) },
        { "translation": [0, 5, 0], "extensions": physics(json!({ "collider": ball })), "children": [3] },
        { "translation": [0, 0, 1], "rotation": turn },
        { "translation": [0, 9, 0], "extensions": physics(json!({ "motion": {}, "collider": ball, "joint": joint(5) })) },
        { "translation": [0, 0, 2], "rotation": turn, "extensions": physics(json!({ "joint": joint(6) })) },
        { "translation": [0, 1, 0],
          "extensions": physics(json!({ "motion": { "isKinematic": true }, "joint": joint(4) })), "children": [] },
        { "extensions": physics(json!({ "joint": joint(0) })) }
    ]);
    let json = file(nodes, json!([{ "type": "sphere" }]), json!({ "physicsJoints": [{}] }));
    let scene = load_json("frames", &json).unwrap();
    let kinds: Vec<_> = scene.bodies.iter().map(|b| (&b.name[..], b.desc.kind)).collect();
    let expected = [
        ("node 0", BodyKind::Dynamic),
        ("node 2", BodyKind::Static),
        ("node 4", BodyKind::Dynamic),
        ("node 6", BodyKind::Kinematic),
        ("world", BodyKind::Static),
    ];
    assert_eq!(kinds, expected);
    // The joint of node 5 is between the world and a kinematic body.
    let bodies: Vec<_> = scene.joints.iter().map(|j| (&j.name[..], j.bodies)).collect();
    assert_eq!(bodies, [("node 1", [0, 1]), ("node 4", [2, 4]), ("node 6", [3, 2]), ("node 7", [4, 0])]);
    // The other one is about the ball that its scale makes an egg.
    let notes: Vec<_> = scene.notes.iter().filter(|n| n.contains("joint")).collect();
    assert!(notes.len() == 1 && notes[0].contains("node 5: its joint is left out: neither"), "{notes:?}");

    let quarter = Quat::from_array(turn);
    let near = |frame: Frame, position: Vec3, rotation: Quat| {
        assert!((frame.position - position).length() < 1e-6, "{frame:?}, {position}");
        assert!(frame.rotation.dot(rotation).abs() > 1.0 - 1e-6, "{frame:?}, {rotation}");
    };
    let frames: Vec<_> = scene.joints.iter().map(|j| j.frames).collect();
    near(frames[0][0], Vec3::new(2.0, 3.0, 0.0), quarter);
    near(frames[0][1], Vec3::Z, quarter);
    near(frames[1][0], Vec3::ZERO, Quat::IDENTITY);
    near(frames[1][1], Vec3::Z * 2.0, quarter);
    near(frames[3][1], Vec3::ZERO, Quat::IDENTITY);
    // A joint of its own body, and one with a node outside the scene.
    let mut own = json.clone();
    own["nodes"][1]["extensions"] = physics(json!({ "joint": joint(0) }));
    let notes = load_json("frames", &own).unwrap().notes.join("\n");
    assert!(notes.contains("both its nodes are on the same body"), "{notes:?}");
    own["scenes"] = json!([{ "nodes": [0, 2, 4, 6] }]);
    let notes = load_json("frames", &own).unwrap().notes.join("\n");
    assert!(notes.contains("node 4: its joint is left out: the connected node"), "{notes:?}");
}

/// Every cut and many changed bytes of a valid file: an answer or an error, never a panic.
#[test]
fn broken_files_never_panic() {
    let path = scratch("broken").join("scene.glb");
    let mut bytes = Vec::new();
    for v in [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
        v.iter().for_each(|c| bytes.extend(c.to_le_bytes()));
    }
    for i in [0u16, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2] {
        bytes.extend(i.to_le_bytes());
    }
    let collider =
        |g: Value| json!({ "collider": { "geometry": g, "physicsMaterial": 0, "collisionFilter": 0 } });
    let mut moving = collider(json!({ "node": 0, "convexHull": true }));
    moving["motion"] = json!({ "mass": 2.0, "inertiaDiagonal": [1, 1, 1], "linearVelocity": [1, 2, 3] });
    let mut hinged = collider(json!({ "shape": 0 }));
    hinged["joint"] = json!({ "connectedNode": 0, "joint": 0 });
    let mut file = file(
        json!([
            { "mesh": 0, "extensions": physics(collider(json!({ "node": 0 }))) },
            { "rotation": [0, 0, 0, 1], "scale": [1, 2, 1], "extensions": physics(moving), "children": [2] },
            { "translation": [1, 0, 0], "extensions": physics(hinged) }
        ]),
        json!([{ "type": "capsule", "capsule": { "height": 1.0 } }]),
        json!({ "physicsJoints": [{
            "limits": [{ "linearAxes": [0, 1, 2], "min": 0.0, "max": 1.0, "stiffness": 9.0 }, { "angularAxes": [1, 2] }],
            "drives": [{ "type": "angular", "mode": "force", "axis": 0, "damping": 1.0, "maxForce": 5.0 }] }],
            "physicsMaterials": [{ "restitution": 0.5 }], "collisionFilters": [{ "collisionSystems": ["a"] }] }),
    );
    file["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }]);
    file["accessors"] = json!([
        { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1] },
        { "bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR" }
    ]);
    file["bufferViews"] =
        json!([{ "buffer": 0, "byteLength": 48 }, { "buffer": 0, "byteOffset": 48, "byteLength": 24 }]);
    file["buffers"] = json!([{ "byteLength": 72 }]);
    let mut text = file.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut glb = Vec::new();
    glb.extend(b"glTF\x02\0\0\0");
    glb.extend((28 + text.len() as u32 + bytes.len() as u32).to_le_bytes());
    glb.extend((text.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(&text);
    glb.extend((bytes.len() as u32).to_le_bytes());
    glb.extend(b"BIN\0");
    glb.extend(&bytes);

    let try_load = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        load(&path)
    };
    let scene = try_load(&glb).unwrap();
    assert_eq!((scene.bodies.len(), scene.bodies[1].desc.shapes.len(), scene.joints.len()), (2, 2, 1));
    assert!(scene.bodies[1].desc.rotation == Quat::IDENTITY);
    for cut in (0..glb.len()).step_by(11) {
        assert!(try_load(&glb[..cut]).is_err(), "cut to {cut} bytes");
    }
    let mut random = Random(3);
    let mut refused = 0;
    for _ in 0..1000 {
        let mut broken = glb.clone();
        for _ in 0..1 + random.below(3) {
            let at = random.below(broken.len());
            // Digits for digits get past the JSON parser and reach the checks behind it.
            broken[at] = match broken[at] {
                b'0'..=b'9' => b'0' + random.below(10) as u8,
                _ => random.bits() as u8,
            };
        }
        refused += usize::from(try_load(&broken).is_err());
    }
    assert!(refused > 300);
}

/// Error texts had bytes of any file, and the uri as it was, escape codes included.
#[test]
fn a_refused_uri_is_named_with_its_reason_and_escaped() {
    let json = json!({ "asset": { "version": "2.0" }, "buffers": [{ "byteLength": 4, "uri": "../a\u{1b}[2J.bin" }] });
    let text = load_json("uri", &json).unwrap_err().to_string();
    assert!(text.contains(r"uri ../a\u{1b}[2J.bin: it leads out of the scene's folder"), "{text}");
    // The embedder's resolver decides, even about files that the default would allow; the limit is the
    // buffer's length.
    let path = super::super::testing::scratch("uri_hook").join("hook.gltf");
    let mut json = json;
    json["buffers"][0]["uri"] = json!("near.bin");
    std::fs::write(&path, json.to_string()).unwrap();
    let refuse = |_: &str, _: u64| Err("no files here".into());
    let text = crate::load_with(&path, &refuse, &LoadLimits::default()).unwrap_err().to_string();
    assert!(text.ends_with("uri near.bin: no files here"), "{text}");
    let asked = std::cell::RefCell::new(Vec::new());
    let give = |uri: &str, most: u64| {
        asked.borrow_mut().push((uri.to_owned(), most));
        Ok(vec![0; 3])
    };
    let text = crate::load_with(&path, &give, &LoadLimits::default()).unwrap_err().to_string();
    assert!(text.contains("buffer 0 has 3 bytes instead of 4"), "{text}");
    assert_eq!(asked.into_inner(), [("near.bin".to_owned(), 4)]);
}
