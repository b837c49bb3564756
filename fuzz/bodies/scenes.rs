//! glTF and OBJ files: raw bytes, and documents whose fields are of any sort.

use super::check;
use super::input::Input;
use backstop::{LoadLimits, Settings, World};
use backstop_scene::{Resolver, Scene, from_bytes};
use base64::Engine;
use serde_json::{Value, json};

pub fn run(bytes: &[u8]) {
    let Some((&sort, rest)) = bytes.split_first() else { return };
    match sort % 4 {
        0 => load("raw.glb", rest),
        1 => load("raw.obj", rest),
        2 => load("raw.obj", &obj(&mut Input::new(rest))),
        _ => load("built.gltf", document(&mut Input::new(rest)).to_string().as_bytes()),
    }
}

fn load(name: &str, bytes: &[u8]) {
    let none: &Resolver<'_> = &|_, _| Err("no files".into());
    let mut limits = LoadLimits::default();
    (limits.vertices, limits.triangles, limits.nodes) = (20_000, 20_000, 20_000);
    let Ok(scene) = from_bytes(name, bytes, none, &limits) else { return };
    play(&scene);
}

fn play(scene: &Scene) {
    if scene.bodies.len() > 40 {
        return;
    }
    let mut world = World::new(Settings::default()).expect("usual settings");
    if scene.add_to(&mut world).is_ok() {
        for _ in 0..3 {
            world.step(1.0 / 60.0).expect("a usual step");
            check(&world);
        }
    }
}

/// Lines that an OBJ file may have.
fn obj(input: &mut Input<'_>) -> Vec<u8> {
    let mut text = String::new();
    for _ in 0..input.below(60) {
        text += &match input.below(8) {
            0..=3 => format!("v {} {} {}\n", input.number(), input.number(), input.number()),
            4..=5 => {
                let corner = |input: &mut Input<'_>| input.below(24) as i32 - 4;
                format!("f {} {} {}//1 {}\n", corner(input), corner(input), corner(input), corner(input))
            }
            6 => format!("o {}\n", input.byte()),
            _ => input.pick(&["l 1 2\n", "g a\n", "vt 0 1\n", "f 1\n", "usemtl x\n", "v 1 2\n"]).into(),
        };
    }
    text.into_bytes()
}

/// A number as a file has one: none is NaN or infinite, or it would be no JSON.
fn number(input: &mut Input<'_>) -> Value {
    let x = input.number();
    if x.is_finite() { json!(x) } else { json!(1e300) }
}

fn numbers(input: &mut Input<'_>, count: usize) -> Value {
    (0..count).map(|_| number(input)).collect()
}

fn document(input: &mut Input<'_>) -> Value {
    let mut data = Vec::new();
    for _ in 0..12 {
        data.extend(input.vector().to_array().into_iter().flat_map(f32::to_le_bytes));
    }
    data.extend((0..48).map(|_| input.below(13) as u8));
    let text = base64::engine::general_purpose::STANDARD.encode(&data);
    let indices = if input.bool() { json!({ "indices": 1 }) } else { json!({}) };
    let mut primitive = indices;
    primitive["attributes"] = json!({ "POSITION": 0 });
    primitive["mode"] = json!(input.pick(&[4, 4, 4, 5, 6, 1, 0]));
    let sparse = json!({ "count": 1 + input.below(3), "indices": { "bufferView": 1, "componentType": 5121 },
        "values": { "bufferView": 0 } });
    let mut positions = json!({ "componentType": 5126, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1],
        "count": if input.byte() < 16 { input.below(100_000) } else { 12 } });
    if input.byte() < 224 {
        positions["bufferView"] = json!(0);
    }
    if input.byte() < 64 {
        positions["sparse"] = sparse;
    }
    let nodes: Vec<Value> = (0..1 + input.below(6)).map(|i| node(input, i)).collect();
    let roots: Vec<usize> = (0..nodes.len()).filter(|_| input.byte() < 230).collect();
    json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": data.len(), "uri": format!("data:application/octet-stream;base64,{text}") }],
        "bufferViews": [{ "buffer": 0, "byteLength": 144 }, { "buffer": 0, "byteOffset": 144, "byteLength": 48 }],
        "accessors": [positions,
            { "bufferView": 1, "componentType": 5121, "type": "SCALAR", "count": input.below(50) }],
        "meshes": [{ "primitives": [primitive] }],
        "scenes": [{ "nodes": roots }],
        "nodes": nodes,
        "extensions": {
            "KHR_implicit_shapes": { "shapes": (0..3).map(|_| shape(input)).collect::<Vec<_>>() },
            "KHR_physics_rigid_bodies": { "physicsJoints": [joint(input)],
                "physicsMaterials": [{ "staticFriction": number(input), "restitution": number(input) }],
                "collisionFilters": [{ "collisionSystems": ["a"], "collideWithSystems": ["a", "b"] }] }
        }
    })
}

fn shape(input: &mut Input<'_>) -> Value {
    match input.below(6) {
        0 => json!({ "type": "sphere", "sphere": { "radius": number(input) } }),
        1 => json!({ "type": "box", "box": { "size": numbers(input, 3) } }),
        2 => json!({ "type": "capsule", "capsule": { "height": number(input), "radiusTop": number(input) } }),
        3 => {
            json!({ "type": "cylinder", "cylinder": { "height": number(input), "radiusTop": number(input) } })
        }
        4 => json!({ "type": "plane", "plane": { "sizeX": number(input) } }),
        _ => json!({ "type": "box" }),
    }
}

fn joint(input: &mut Input<'_>) -> Value {
    let limit = |input: &mut Input<'_>| {
        let mut limit = json!({ "min": number(input), "max": number(input) });
        if input.bool() {
            limit = json!({ "min": 0.0, "max": 0.0 });
        }
        limit[input.pick(&["linearAxes", "angularAxes"])] =
            input.pick(&[&[0, 1, 2][..], &[0], &[1, 2]]).into();
        limit
    };
    let drive =
        json!({ "type": "angular", "mode": "force", "axis": input.below(4), "damping": number(input) });
    json!({ "limits": [limit(input), limit(input)], "drives": if input.bool() { vec![drive] } else { vec![] } })
}

fn node(input: &mut Input<'_>, index: usize) -> Value {
    let mut node = json!({});
    if input.byte() < 96 {
        node["mesh"] = json!(0);
    }
    if input.bool() {
        node["translation"] = numbers(input, 3);
    }
    if input.byte() < 64 {
        node["rotation"] = json!(input.rotation().to_array());
        node["scale"] = numbers(input, 3);
    }
    if input.byte() < 64 {
        node["children"] = json!([index + 1 + input.below(2)]);
    }
    let mut physics = json!({});
    let geometry = match input.below(4) {
        0 => json!({ "node": input.below(6), "convexHull": input.bool() }),
        _ => json!({ "shape": input.below(4) }),
    };
    match input.below(6) {
        0 => {}
        1 => physics["trigger"] = json!({ "geometry": geometry }),
        _ => {
            physics["collider"] =
                json!({ "geometry": geometry, "physicsMaterial": input.below(2), "collisionFilter": 0 })
        }
    }
    if input.bool() {
        physics["motion"] = json!({ "isKinematic": input.byte() < 32, "linearVelocity": numbers(input, 3) });
        if input.byte() < 64 {
            physics["motion"]["mass"] = number(input);
            physics["motion"]["inertiaDiagonal"] = numbers(input, 3);
        }
    }
    if input.byte() < 64 {
        physics["joint"] = json!({ "connectedNode": input.below(6), "joint": input.below(2) });
    }
    node["extensions"] = json!({ "KHR_physics_rigid_bodies": physics });
    node
}
