//! Scenes written by hand, the conformance scenes if they are at hand, and broken files.

use super::super::testing::{data, scratch};
use super::super::{LoadOptions, Scene, SceneError, load, rng::Rng};
use crate::body::BodyKind;
use crate::shape::{Combine, Geometry, TriangleMesh};
use glam::{DVec3, Quat, Vec3};
use serde_json::{Value, json};
use std::f32::consts::FRAC_1_SQRT_2;

fn load_json(test: &str, json: &Value) -> Result<Scene, SceneError> {
    let path = scratch(test).join("scene.gltf");
    std::fs::write(&path, json.to_string()).unwrap();
    load(&path, &LoadOptions::default())
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
    // The example of KHR_physics_rigid_bodies, "Geometry": a unit box under [1, -2, 3] is a box of size [1, 2, 3].
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
    assert_eq!((mass.center, mass.inertia.y_axis.y), (Vec3::new(0.0, 0.25, 0.0), 2.0));
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
fn what_is_not_supported_is_refused_or_noted() {
    let joint = physics(json!({ "joint": { "connectedNode": 1, "joint": 0 } }));
    let nodes = json!([{ "name": "hinge", "extensions": joint }, {}]);
    let json = file(nodes, json!([]), json!({ "physicsJoints": [{}] }));
    let error = load_json("joint", &json).unwrap_err();
    assert!(error.to_string().contains("\"hinge\" (0): joints are not supported yet"), "{error}");
    let path = scratch("joint").join("scene.gltf");
    let scene = load(&path, &LoadOptions { skip_joints: true }).unwrap();
    assert_eq!(scene.notes.len(), 1);

    let trigger = physics(json!({ "trigger": { "geometry": { "shape": 0 } } }));
    let nodes = json!([{ "extensions": trigger }]);
    let scene = load_json("trigger", &file(nodes, json!([{ "type": "box" }]), json!({}))).unwrap();
    assert_eq!((scene.bodies.len(), scene.notes.len()), (0, 1));

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
    let scene = load_json("deep", &file(json!(nodes), json!([{ "type": "box" }]), json!({}))).unwrap();
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

fn conformance(name: &str) -> Option<Result<Scene, SceneError>> {
    Some(load(data("gltf")?.join(name), &LoadOptions::default()))
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
fn conformance_scenes_load_unless_they_have_joints() {
    let Some(root) = data("gltf") else { return };
    let mut loaded = 0;
    for folder in ["tests", "samples"] {
        let mut files: Vec<_> =
            std::fs::read_dir(root.join(folder)).unwrap().map(|f| f.unwrap().path()).collect();
        files.sort();
        for path in files.iter().filter(|p| p.extension().is_some_and(|e| e == "gltf" || e == "glb")) {
            let has_joints = path.to_string_lossy().contains("Joint");
            let result = load(path, &LoadOptions::default());
            assert_eq!(matches!(result, Err(SceneError::Joint { .. })), has_joints, "{}", path.display());
            let scene = load(path, &LoadOptions { skip_joints: true }).unwrap();
            assert!(!scene.bodies.is_empty() && scene.bodies.iter().all(|b| !b.desc.shapes.is_empty()));
            loaded += 1;
        }
    }
    assert!(loaded > 30);
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
    let mut file = file(
        json!([
            { "mesh": 0, "extensions": physics(collider(json!({ "node": 0 }))) },
            { "rotation": [0, 0, 0, 1], "scale": [1, 2, 1], "extensions": physics(moving), "children": [2] },
            { "translation": [1, 0, 0], "extensions": physics(collider(json!({ "shape": 0 }))) }
        ]),
        json!([{ "type": "capsule", "capsule": { "height": 1.0 } }]),
        json!({ "physicsMaterials": [{ "restitution": 0.5 }], "collisionFilters": [{ "collisionSystems": ["a"] }] }),
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
        load(&path, &LoadOptions::default())
    };
    let scene = try_load(&glb).unwrap();
    assert_eq!((scene.bodies.len(), scene.bodies[1].desc.shapes.len()), (2, 2));
    assert!(scene.bodies[1].desc.rotation == Quat::IDENTITY);
    for cut in (0..glb.len()).step_by(11) {
        assert!(try_load(&glb[..cut]).is_err(), "cut to {cut} bytes");
    }
    let mut rng = Rng::new(3);
    let mut refused = 0;
    for _ in 0..1000 {
        let mut broken = glb.clone();
        for _ in 0..1 + rng.next() % 3 {
            let at = rng.next() as usize % broken.len();
            // Digits for digits get past the JSON parser and reach the checks behind it.
            broken[at] = match broken[at] {
                b'0'..=b'9' => b'0' + (rng.next() % 10) as u8,
                _ => rng.next() as u8,
            };
        }
        refused += usize::from(try_load(&broken).is_err());
    }
    assert!(refused > 300);
}
