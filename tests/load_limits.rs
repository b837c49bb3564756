//! Files of a few bytes that ask for gigabytes. A scene of 810 KB took 6.2 GB, one of 931 KB 2.1 GB and a
//! minute, one of 597 bytes half a gigabyte. Here they are built, and the bytes that loading them takes are
//! counted: equal geometry is built once, and a file beyond a limit is refused by the name of the limit.

#[path = "common/counting.rs"]
mod counting;
#[path = "../src/random.rs"]
mod random;

use backstop::glam::DVec3;
use backstop::{BodyDesc, Geometry, LimitExceeded, LoadLimits, Settings, ShapeDesc, World};
use backstop_scene::{Resolver, Scene, SceneError, load, load_with};
use base64::Engine;
use counting::most_bytes;
use random::Random;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("load_limits");
    std::fs::create_dir_all(&folder).expect("a folder for tests");
    folder.join(name)
}

fn data(bytes: &[u8]) -> Value {
    let text = base64::engine::general_purpose::STANDARD.encode(bytes);
    json!({ "byteLength": bytes.len(), "uri": format!("data:application/octet-stream;base64,{text}") })
}

/// Points in a cube from a simple generator, as a file has them.
fn points(count: usize) -> Vec<u8> {
    let mut random = Random(1);
    (0..3 * count).flat_map(|_| random.unit().to_le_bytes()).collect()
}

/// A file with a mesh of so many triangles of random corners, and nodes.
fn file(triangles: usize, nodes: Vec<Value>) -> Value {
    let bytes = points(3 * triangles);
    json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_physics_rigid_bodies", "KHR_implicit_shapes"],
        "buffers": [data(&bytes)],
        "bufferViews": [{ "buffer": 0, "byteLength": bytes.len() }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3 * triangles,
            "min": [0, 0, 0], "max": [1, 1, 1] }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "scenes": [{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }],
        "nodes": nodes,
    })
}

fn physics(value: Value) -> Value {
    json!({ "KHR_physics_rigid_bodies": value })
}

/// Loads a file; also says how long it is, and the most bytes that took.
fn try_load(name: &str, json: &Value, limits: &LoadLimits) -> (Result<Scene, SceneError>, usize, usize) {
    let (path, text) = (scratch(name), json.to_string());
    std::fs::write(&path, &text).expect("a file");
    let none: &Resolver<'_> = &|_, _| Err("no files".into());
    let (scene, most) = most_bytes(|| load_with(&path, none, limits));
    (scene, text.len(), most)
}

fn refused(name: &str, json: &Value, limits: &LoadLimits) -> (LimitExceeded, usize, usize) {
    match try_load(name, json, limits) {
        (Err(SceneError::Limit { source, .. }), length, most) => (source, length, most),
        (other, ..) => panic!("{name}: {:?}", other.map(|scene| scene.bodies.len())),
    }
}

/// How many geometries there are, however many shapes use them.
fn geometries(scene: &Scene) -> usize {
    let shapes = scene.bodies.iter().flat_map(|body| &body.desc.shapes);
    let address = |shape: &ShapeDesc| match &shape.geometry {
        Geometry::Hull(hull) => Some(Arc::as_ptr(hull) as usize),
        Geometry::Mesh(mesh) => Some(Arc::as_ptr(mesh) as usize),
        _ => None,
    };
    shapes.filter_map(address).collect::<BTreeSet<_>>().len()
}

/// Each instance was a mesh of its own. Expected: two of 500, one for each scale, under any rotation.
#[test]
fn colliders_of_one_mesh_and_scale_share_it() {
    let collider = physics(json!({ "collider": { "geometry": { "node": 0 } } }));
    let (c, s) = (0.25f64.cos(), 0.25f64.sin());
    let instance = |i: usize| {
        let scale = if i.is_multiple_of(2) { 1.0 } else { 0.35 };
        let rotation = if i.is_multiple_of(3) { [0.0, s, 0.0, c] } else { [0.0, 0.0, 0.0, 1.0] };
        json!({ "translation": [2 * i, 0, 0], "rotation": rotation, "scale": [scale, scale, scale],
            "extensions": collider })
    };
    let nodes = std::iter::once(json!({ "mesh": 0 })).chain((0..500).map(instance)).collect();
    let (scene, length, most) = try_load("colliders.gltf", &file(1000, nodes), &LoadLimits::default());
    let scene = scene.unwrap();
    assert_eq!((scene.bodies.len(), geometries(&scene)), (500, 2));
    println!("{length} bytes of file, {most} to load");
    // Text, the two trees that it is parsed into, and built geometry: not 500 meshes of 60 KB.
    assert!(most < 40 * length, "{most} of {length}");
}

/// A hull was built anew for each body. Expected: one, also where the mesh is the body's own because it
/// moves.
#[test]
fn bodies_of_one_hull_share_it() {
    for geometry in [json!({ "node": 0, "convexHull": true }), json!({ "node": 0 })] {
        let body = physics(json!({ "collider": { "geometry": geometry }, "motion": {} }));
        let instance = |i: usize| json!({ "translation": [2 * i, 0, 0], "extensions": body });
        let nodes = std::iter::once(json!({ "mesh": 0 })).chain((0..300).map(instance)).collect();
        let (scene, ..) = try_load("hulls.gltf", &file(1000, nodes), &LoadLimits::default());
        let scene = scene.unwrap();
        assert_eq!((scene.bodies.len(), geometries(&scene)), (300, 1));
        let note = if geometry["convexHull"] == true { 0 } else { 300 };
        assert_eq!(scene.notes.len(), note, "what is approximated is said of each");
    }
}

/// Moving nodes below a geometry's node are left out, unless they are the collider's own node. So nodes that
/// look alike may differ.
#[test]
fn a_geometry_depends_on_who_asks_only_where_he_is_below() {
    let body = physics(json!({ "collider": { "geometry": { "node": 0 } }, "motion": {} }));
    let nodes = vec![
        json!({ "children": [1, 2] }),
        json!({ "mesh": 0, "translation": [0, 0, 5], "extensions": body }),
        json!({ "mesh": 0, "translation": [0, 9, 0], "extensions": body }),
    ];
    let mut json = file(50, nodes);
    json["scenes"][0]["nodes"] = json!([0]);
    let (scene, ..) = try_load("below.gltf", &json, &LoadLimits::default());
    let scene = scene.unwrap();
    let low = |body: usize| match &scene.bodies[body].desc.shapes[0].geometry {
        Geometry::Hull(hull) => hull.vertices().iter().fold(backstop::glam::Vec3::MAX, |m, v| m.min(*v)),
        _ => panic!("not a hull"),
    };
    assert!(low(0).z >= 5.0 && low(0).y < 1.0 && low(1).y >= 9.0 && low(1).z < 1.0, "{} {}", low(0), low(1));
}

/// All instances of a file without physics are one mesh. Expected: with more than the limit allows none of it
/// is made.
#[test]
fn instances_are_counted_before_they_are_made() {
    let nodes = (0..500).map(|i| json!({ "mesh": 0, "translation": [2 * i, 0, 0] })).collect::<Vec<_>>();
    let json = file(1000, nodes);
    let mut limits = LoadLimits::default();
    limits.triangles = 499_999;
    let (error, length, most) = refused("instances.gltf", &json, &limits);
    assert_eq!((error.limit, error.most), ("triangles", 499_999));
    assert!(most < 20 * length, "{most} of {length}");
    assert!(error.to_string().contains("`triangles`") && error.to_string().contains("499999"));
    limits.triangles = 500_000;
    assert!(try_load("instances.gltf", &json, &limits).0.is_ok());
    limits.vertices = 1_499_999;
    assert_eq!(refused("instances.gltf", &json, &limits).0.limit, "vertices");
    // The default: 10,000 triangles 1,001 times.
    let nodes = (0..1001).map(|i| json!({ "mesh": 0, "translation": [2 * i, 0, 0] })).collect();
    let (error, length, most) = refused("instances.gltf", &file(10_000, nodes), &LoadLimits::default());
    assert_eq!(error.limit, "vertices");
    assert!(most < 20 * length, "{most} of {length}");
}

/// Each scale makes a mesh or hull of its own, and the limit was met after a gigabyte of them, by a file of
/// 322 KB. Expected: refused before the first is made; one less is fine.
#[test]
fn meshes_of_many_scales_are_counted_before_one_is_made() {
    for geometry in [json!({ "node": 0 }), json!({ "node": 0, "convexHull": true })] {
        let collider = physics(json!({ "collider": { "geometry": geometry } }));
        let instance = |i: usize| json!({ "scale": [i + 1, 1, 1], "extensions": collider });
        let nodes = |count| std::iter::once(json!({ "mesh": 0 })).chain((0..count).map(instance)).collect();
        let mut limits = LoadLimits::default();
        limits.triangles = 50_000;
        let (error, length, most) = refused("scales.gltf", &file(1000, nodes(51)), &limits);
        assert_eq!(error.limit, "triangles");
        assert!(most < 20 * length, "{most} of {length}");
        assert_eq!(geometries(&try_load("scales.gltf", &file(1000, nodes(50)), &limits).0.unwrap()), 50);
        // The default, by a file of less than 300 KB.
        let (error, length, most) = refused("scales.gltf", &file(2000, nodes(5001)), &LoadLimits::default());
        assert_eq!(error.limit, "vertices");
        // Text, the trees that it is parsed into, and the extension of each of 5,001 nodes.
        assert!(length < 1_000_000 && most < 64 << 20, "{most} of {length}");
    }
}

/// Faces and nodes take many times their bytes of a file. Expected: those beyond the limit are not even
/// parsed.
#[test]
fn faces_and_nodes_are_counted_before_they_are_parsed() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned() + &"f 1 2 3 2 3 1\n".repeat(20_000);
    let path = scratch("faces.obj");
    std::fs::write(&path, &text).unwrap();
    let none: &Resolver<'_> = &|_, _| Err("no files".into());
    let mut limits = LoadLimits::default();
    limits.triangles = 79_999;
    let (found, most) = most_bytes(|| load_with(&path, none, &limits));
    assert!(matches!(found, Err(SceneError::Limit { source, .. }) if source.limit == "triangles"));
    assert!(most < 3 * text.len(), "{most} of {}", text.len());
    limits.triangles = 80_000;
    assert!(load_with(&path, none, &limits).is_ok());

    let nodes: Vec<Value> = (0..100_000).map(|_| json!({})).collect();
    let json = json!({ "asset": { "version": "2.0" }, "nodes": nodes });
    let mut limits = LoadLimits::default();
    limits.nodes = 99_999;
    let (error, length, most) = refused("nodes.gltf", &json, &limits);
    assert_eq!(error.limit, "nodes");
    println!("{most} of {length}");
    assert!(most < 40 * length, "{most} of {length}");
}

/// Zeros that are not in the file took 545 MB for 597 bytes. Expected: absent bytes take no memory, and more
/// than the limit is refused.
#[test]
fn a_sparse_accessor_takes_what_is_in_the_file() {
    let mut bytes: Vec<u8> = [0u32, 1, 2].iter().flat_map(|i| i.to_le_bytes()).collect();
    bytes.extend([0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()));
    let sparse = |count: u32| {
        let sparse = json!({ "count": 3, "indices": { "bufferView": 0, "componentType": 5125 },
            "values": { "bufferView": 1 } });
        json!({
            "asset": { "version": "2.0" },
            "buffers": [data(&bytes)],
            "bufferViews": [{ "buffer": 0, "byteLength": 12 }, { "buffer": 0, "byteOffset": 12, "byteLength": 36 }],
            "accessors": [{ "componentType": 5126, "type": "VEC3", "count": count, "min": [0, 0, 0],
                "max": [1, 1, 1], "sparse": sparse }],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
            "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        })
    };
    let (scene, _, most) = try_load("sparse.gltf", &sparse(3_000_000), &LoadLimits::default());
    let scene = scene.unwrap();
    let Geometry::Mesh(mesh) = &scene.bodies[0].desc.shapes[0].geometry else { panic!("not a mesh") };
    assert_eq!(mesh.triangle_count(), 1);
    assert!(most < 200_000, "{most} bytes");
    let (error, _, most) = refused("sparse.gltf", &sparse((1 << 24) - 1), &LoadLimits::default());
    assert_eq!(error.limit, "vertices");
    assert!(most < 200_000, "{most} bytes");
}

/// Every buffer without a uri was a copy of the whole binary chunk. Expected: by glTF 2.0, 3.6.1.2, only the
/// first is in it.
#[test]
fn the_binary_chunk_is_taken_once() {
    let mut text = json!({ "asset": { "version": "2.0" },
        "buffers": (0..1000).map(|_| json!({ "byteLength": 1 })).collect::<Vec<_>>() })
    .to_string()
    .into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let chunk = vec![0u8; 1 << 20];
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    for (kind, bytes) in [(b"JSON", &text), (b"BIN\0", &chunk)] {
        if kind == b"JSON" {
            glb.extend((28 + text.len() as u32 + chunk.len() as u32).to_le_bytes());
        }
        glb.extend((bytes.len() as u32).to_le_bytes());
        glb.extend(kind);
        glb.extend(bytes);
    }
    let path = scratch("chunk.glb");
    std::fs::write(&path, &glb).unwrap();
    let (scene, most) = most_bytes(|| load(&path));
    assert!(scene.is_err() && most < 4 << 20, "{most} bytes");
}

/// Expected: each limit is refused by its name and value, one below what the file takes, and not at that.
#[test]
fn each_limit_has_its_name() {
    let shape = |shape: u32| json!({ "collider": { "geometry": { "shape": shape } }, "motion": {} });
    let mut jointed = shape(0);
    jointed["joint"] = json!({ "connectedNode": 0, "joint": 0 });
    let nodes = vec![
        json!({ "extensions": physics(shape(0)), "children": [1] }),
        json!({ "extensions": physics(jointed), "translation": [1, 0, 0] }),
    ];
    let mut json = file(10, nodes);
    json["scenes"][0]["nodes"] = json!([0]);
    json["extensions"] = json!({ "KHR_implicit_shapes": { "shapes": [{ "type": "box" }] },
        "KHR_physics_rigid_bodies": { "physicsJoints": [{
            "limits": [{ "linearAxes": [0, 1, 2], "min": 0.0, "max": 0.0 }], "drives": [] }] } });
    let length = json.to_string().len() as u64;
    type Field = fn(&mut LoadLimits) -> &mut u64;
    let fields: [(&str, Field, u64); 5] = [
        ("bytes", |l| &mut l.bytes, length),
        ("nodes", |l| &mut l.nodes, 2),
        ("depth", |l| &mut l.depth, 2),
        ("bodies", |l| &mut l.bodies, 2),
        ("joints", |l| &mut l.joints, 2),
    ];
    for (name, field, takes) in fields {
        let mut limits = LoadLimits::default();
        *field(&mut limits) = takes;
        assert!(try_load("each.gltf", &json, &limits).0.is_ok(), "{name}");
        *field(&mut limits) = takes - 1;
        let error = refused("each.gltf", &json, &limits).0;
        assert_eq!((error.limit, error.most), (name, takes - 1));
    }
    // A joint's description may be long, and many nodes may use it.
    let drives: Vec<Value> =
        (0..5000).map(|_| json!({ "type": "linear", "mode": "force", "axis": 0 })).collect();
    json["extensions"]["KHR_physics_rigid_bodies"]["physicsJoints"][0]["drives"] = json!(drives);
    let mut limits = LoadLimits::default();
    limits.joints = 5001;
    assert_eq!(refused("each.gltf", &json, &limits).0.limit, "joints");
    // OBJ.
    let path = scratch("each.obj");
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n").unwrap();
    let none: &Resolver<'_> = &|_, _| Err("no files".into());
    for (name, field, takes) in [
        ("bytes", (|l| &mut l.bytes) as Field, 48),
        ("vertices", |l| &mut l.vertices, 4),
        ("triangles", |l| &mut l.triangles, 2),
    ] {
        let mut limits = LoadLimits::default();
        *field(&mut limits) = takes;
        assert!(load_with(&path, none, &limits).is_ok(), "{name}");
        *field(&mut limits) = takes - 1;
        match load_with(&path, none, &limits) {
            Err(SceneError::Limit { source, .. }) => {
                assert_eq!((source.limit, source.most), (name, takes - 1))
            }
            other => panic!("{name}: {other:?}"),
        }
    }
}

/// Buffers are charged though the same file is named again and again.
#[test]
fn files_beside_a_scene_count_as_often_as_they_are_named() {
    let buffers: Vec<Value> = (0..100).map(|_| json!({ "byteLength": 1000, "uri": "near.bin" })).collect();
    let json = json!({ "asset": { "version": "2.0" }, "buffers": buffers }).to_string();
    let path = scratch("named.gltf");
    std::fs::write(&path, &json).unwrap();
    let give: &Resolver<'_> = &|_, most| Ok(vec![0; most as usize]);
    let mut limits = LoadLimits::default();
    limits.bytes = json.len() as u64 + 99_999;
    match load_with(&path, give, &limits) {
        Err(SceneError::Limit { source, .. }) => assert_eq!(source.limit, "bytes"),
        other => panic!("{other:?}"),
    }
    limits.bytes += 1;
    // Then it is only empty.
    assert!(matches!(load_with(&path, give, &limits), Err(SceneError::Malformed { .. })));
}

/// A mesh of an extent of 1e-45 m kept `run` and `plan` busy for ever, through a file of 1.6 KB. Expected: an
/// answer.
#[test]
fn a_file_with_a_mesh_of_hardly_any_extent_is_loaded() {
    for tiny in [1e-45f32, 1e-43, 1e-40] {
        let corners = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, tiny, 1.0]];
        let bytes: Vec<u8> = corners.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let floor =
            json!({ "mesh": 0, "extensions": physics(json!({ "collider": { "geometry": { "node": 0 } } })) });
        let mut json = file(1, vec![floor]);
        json["buffers"] = json!([data(&bytes)]);
        json["bufferViews"] = json!([{ "buffer": 0, "byteLength": bytes.len() }]);
        let (scene, ..) = try_load("flat.gltf", &json, &LoadLimits::default());
        let mut world = World::new(Settings::default()).unwrap();
        scene.unwrap().add_to(&mut world).unwrap();
        let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.1 });
        let ball = BodyDesc::dynamic().with_position(DVec3::new(0.25, 0.3, 0.25)).with_shape(ball);
        let ball = world.add_body(&ball).unwrap();
        for _ in 0..60 {
            world.step(1.0 / 60.0).unwrap();
        }
        assert!((world.position(ball).unwrap().y - 0.1).abs() < 0.01, "it lies on the triangle");
    }
}
