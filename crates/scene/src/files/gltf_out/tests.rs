//! Written scenes are read back, by our loader and by the `gltf` crate.

use super::super::resolve::scene_folder;
use super::super::testing::scratch;
use crate::files::assets;
use crate::{Recorder, SHIPPED, Scene, SceneJoint, load, shipped, write_animation, write_scene};
use backstop::BodyHandle;
use backstop::{Axes, Axis, Frame, JointDesc, Limit, Motion, Motor, Spring};
use backstop::{BodyDesc, BodyKind};
use backstop::{Geometry, ShapeDesc};
use backstop::{LoadLimits, Tally};
use backstop::{Settings, World};
use glam::{DQuat, DVec3, Mat4, Quat, Vec3};
use serde_json::json;
use std::path::Path;

/// Vertices and triangles, or the numbers of an implicit shape.
fn geometry_text(g: &Geometry) -> String {
    match g {
        Geometry::Hull(_) => format!("hull {:?}", backstop::debug::convex(g)),
        Geometry::Mesh(mesh) => {
            // The order of triangles is the mesh's own business.
            let (v, t) = assets::mesh_triangles(mesh);
            let mut corners: Vec<String> =
                t.iter().map(|t| format!("{:?}", t.map(|i| v[i as usize]))).collect();
            corners.sort();
            format!("mesh {corners:?}")
        }
        other => format!("{other:?}"),
    }
}

fn assert_same(a: &Scene, b: &Scene) {
    assert_eq!(a.name, b.name);
    assert_eq!(a.bodies.len(), b.bodies.len());
    for (a, b) in a.bodies.iter().zip(&b.bodies) {
        let what = &a.name;
        assert_eq!(a.name, b.name);
        let (a, b) = (&a.desc, &b.desc);
        assert_eq!((a.kind, a.position, a.gravity_scale), (b.kind, b.position, b.gravity_scale), "{what}");
        assert_eq!(a.mass, b.mass, "{what}");
        assert!((a.rotation - b.rotation).length() < 1e-6, "{what}");
        // Turned into the node's frame and back.
        let near = |a: Vec3, b: Vec3| (a - b).length() <= 1e-6 * a.length();
        assert!(near(a.linear_velocity, b.linear_velocity), "{what}");
        assert!(near(a.angular_velocity, b.angular_velocity), "{what}");
        assert_eq!(a.shapes.len(), b.shapes.len(), "{what}");
        for (a, b) in a.shapes.iter().zip(&b.shapes) {
            assert_eq!(geometry_text(&a.geometry), geometry_text(&b.geometry), "{what}");
            assert!((a.position - b.position).length() < 1e-6 && (a.rotation - b.rotation).length() < 1e-6);
            assert_eq!((a.material, a.filter, a.density), (b.material, b.filter, b.density), "{what}");
        }
    }
}

fn assert_same_joints(a: &Scene, b: &Scene) {
    assert_eq!(a.joints.len(), b.joints.len());
    for (a, b) in a.joints.iter().zip(&b.joints) {
        for (a, b) in a.frames.iter().zip(&b.frames) {
            assert!((a.position - b.position).length() < 1e-6 * (1.0 + a.position.length()), "{a:?} {b:?}");
            assert!(a.rotation.dot(b.rotation).abs() > 1.0 - 1e-6, "{a:?} {b:?}");
        }
        assert_eq!(*a, SceneJoint { frames: a.frames, ..b.clone() });
    }
}

#[test]
fn joints_load_back_as_they_were() {
    let mut scene = Scene::new("in");
    let block =
        || BodyDesc::new(BodyKind::Dynamic).with_shape(ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5)));
    let turn = |angle| Quat::from_rotation_y(angle) * Quat::from_rotation_x(2.0 * angle);
    scene.add(
        "frame",
        BodyDesc::fixed().with_position(DVec3::new(3.0, 1.0, 0.0)).with_rotation(turn(0.3)).with_shape(
            ShapeDesc::new(Geometry::cuboid(0.1, 2.0, 0.1))
                .with_position(Vec3::new(0.0, 0.5, 0.0))
                .with_rotation(turn(0.7)),
        ),
    );
    for i in 0..3 {
        let at = DVec3::new(0.0, 2.0 + f64::from(i), 100.0);
        scene.add(format!("block {i}"), block().with_position(at).with_rotation(turn(i as f32)));
    }
    scene.add("world", BodyDesc::fixed());
    let frames = [Frame { position: Vec3::new(0.1, 0.2, 0.3), rotation: turn(0.4) }, Frame::at(Vec3::NEG_Y)];
    let handles: Vec<_> = {
        let mut world = World::new(Settings::default()).unwrap();
        world.add_bodies(&scene.descs()).unwrap()
    };
    let mut join = |a: usize, b: usize, desc: fn([BodyHandle; 2], [Frame; 2]) -> JointDesc| {
        let JointDesc { limits, motors, .. } = desc([handles[a], handles[b]], frames);
        let name = format!("joint {a} {b}");
        scene.joints.push(SceneJoint { name, bodies: [a, b], frames, limits, motors, collide: b == 2 });
    };
    // In no order of bodies, and the first description twice.
    join(3, 4, JointDesc::hinge);
    join(1, 2, JointDesc::slider);
    join(4, 1, JointDesc::hinge);
    join(2, 3, |bodies, frames| {
        let spring = Spring::Coefficients { stiffness: 20.0, damping: f32::INFINITY };
        JointDesc::new(bodies, frames)
            .with_limit(
                Limit::new(Motion::Angular, Axes::One(Axis::Z), f32::NEG_INFINITY, 0.3).with_spring(spring),
            )
            .with_limit(Limit::new(Motion::Linear, Axes::All, 0.1, f32::INFINITY))
            .with_motor(Motor::velocity(Motion::Angular, Axis::Y, -2.0, 5.0))
            .with_motor(Motor::position(
                Motion::Linear,
                Axis::Z,
                0.2,
                Spring::Acceleration { stiffness: 5.0, damping: 0.1 },
            ))
    });
    let path = scratch("joints_back").join("in.glb");
    write_scene(&scene, &path).unwrap();
    let loaded = load(&path).unwrap();
    assert_eq!(loaded.notes, [""; 0]);
    assert_same_joints(&scene, &loaded);
    let names = |s: &Scene| s.bodies[1..].iter().map(|b| b.name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&scene), names(&loaded));
    let written = gltf::Gltf::open(&path).unwrap();
    let physics = written.extension_value("KHR_physics_rigid_bodies").unwrap();
    assert_eq!(physics["physicsJoints"].as_array().unwrap().len(), 3);

    // One that holds on to a part of a static body is on that part.
    let mut on_part = scene.clone();
    on_part.joints.truncate(1);
    on_part.joints[0].bodies = [0, 1];
    write_scene(&on_part, &path).unwrap();
    let loaded = load(&path).unwrap();
    let world_frame = |scene: &Scene| {
        let (joint, body) = (&scene.joints[0], &scene.bodies[scene.joints[0].bodies[0]].desc);
        body.position + (body.rotation * joint.frames[0].position).as_dvec3()
    };
    assert_eq!((loaded.bodies.len(), loaded.joints[0].bodies), (4, [0, 1]));
    assert!((world_frame(&on_part) - world_frame(&loaded)).length() < 1e-5);
    // What is out of range is nobody's.
    on_part.joints[0].bodies = [0, 9];
    write_scene(&on_part, &path).unwrap();
    assert_eq!(load(&path).unwrap().joints.len(), 0);
}

#[test]
fn a_scene_is_added_as_a_whole_or_not_at_all() {
    let mut scene = Scene::new("pair");
    let ball = || BodyDesc::dynamic().with_shape(ShapeDesc::new(Geometry::Sphere { radius: 0.1 }));
    scene.add("a", ball());
    scene.add("b", ball().with_position(DVec3::X));
    let frames = [Frame::default(); 2];
    let joint = |bodies| SceneJoint {
        name: String::new(),
        bodies,
        frames,
        limits: vec![],
        motors: vec![],
        collide: true,
    };
    scene.joints = vec![joint([0, 1])];
    let mut world = World::new(Settings::default()).unwrap();
    let added = scene.add_to(&mut world).unwrap();
    assert_eq!(world.joint_bodies(added.joints[0]).unwrap(), [added.bodies[0], added.bodies[1]]);
    for wrong in [[0, 0], [1, 2]] {
        scene.joints.push(joint(wrong));
        assert!(scene.add_to(&mut world).is_err(), "{wrong:?}");
        assert_eq!((world.bodies().count(), world.joint_count()), (2, 1));
        scene.joints.pop();
    }
}

#[test]
fn shipped_scenes_load_back_as_they_were() {
    let dir = scratch("shipped");
    for file in SHIPPED {
        let scene = shipped(file).unwrap();
        write_scene(&scene, dir.join(file)).unwrap();
        let loaded = load(dir.join(file)).unwrap();
        assert_eq!(loaded.notes, [""; 0], "{file}");
        assert_same(&scene, &loaded);
    }
}

#[test]
fn committed_scenes_are_what_the_generator_writes() {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let fresh = scratch("committed");
    let mut total = 0;
    for file in SHIPPED {
        write_scene(&shipped(file).unwrap(), fresh.join(file)).unwrap();
        let (a, b) = (std::fs::read(dir.join(file)).unwrap(), std::fs::read(fresh.join(file)).unwrap());
        assert!(a == b, "{file}: run the generator again");
        total += a.len();
    }
    assert!(total < 500_000, "{total} bytes");
}

/// Made-up motion: body `i` at time `t`.
fn pose(i: usize, t: f32) -> (DVec3, Quat) {
    let t = f64::from(t) + i as f64;
    let position = DVec3::new(libm::sin(t), 2.0 + t, libm::cos(3.0 * t));
    let axis = DVec3::new(1.0, i as f64, libm::sin(t)).normalize();
    let (s, c) = (libm::sin(2.0 * t), libm::cos(2.0 * t));
    (position, DQuat::from_xyzw(axis.x * s, axis.y * s, axis.z * s, c).as_quat())
}

fn record(scene: &Scene) -> Recorder {
    let mut recorder = Recorder::new(scene);
    for frame in 0..40 {
        let t = frame as f32 / 20.0;
        recorder.record(t, |i| pose(i, t));
    }
    recorder
}

/// World matrix of every node in every frame of the first animation.
fn play(path: &Path) -> Vec<Vec<Mat4>> {
    // The crate's validation refuses what a source may require, such as lights; other tests use it.
    let file = gltf::Gltf::from_slice_without_validation(&std::fs::read(path).unwrap()).unwrap();
    let blob = file.blob.clone();
    let animation = file.animations().next().unwrap();
    let nodes: Vec<gltf::Node> = file.nodes().collect();
    let mut local: Vec<(Vec<Vec3>, Vec<Quat>)> = vec![Default::default(); nodes.len()];
    let mut frames = 0;
    for channel in animation.channels() {
        assert_eq!(channel.sampler().interpolation(), gltf::animation::Interpolation::Linear);
        let reader = channel.reader(|_| blob.as_deref());
        let times: Vec<f32> = reader.read_inputs().unwrap().collect();
        assert!(times.windows(2).all(|w| w[0] < w[1]));
        frames = times.len();
        let track = &mut local[channel.target().node().index()];
        match reader.read_outputs().unwrap() {
            gltf::animation::util::ReadOutputs::Translations(t) => track.0 = t.map(Vec3::from).collect(),
            gltf::animation::util::ReadOutputs::Rotations(r) => {
                track.1 = r.into_f32().map(Quat::from_array).collect()
            }
            _ => panic!("neither translation nor rotation"),
        }
    }
    let mut parents = vec![None; nodes.len()];
    nodes.iter().for_each(|n| n.children().for_each(|c| parents[c.index()] = Some(n.index())));
    let world = |frame: usize, node: usize| {
        let mut total = Mat4::IDENTITY;
        let mut next = Some(node);
        while let Some(n) = next {
            let (t, r, s) = nodes[n].transform().decomposed();
            let t = local[n].0.get(frame).copied().unwrap_or(t.into());
            let r = local[n].1.get(frame).copied().unwrap_or(Quat::from_array(r));
            total = Mat4::from_scale_rotation_translation(s.into(), r, t) * total;
            next = parents[n];
        }
        total
    };
    (0..frames).map(|f| (0..nodes.len()).map(|n| world(f, n)).collect()).collect()
}

fn assert_played(frames: &[Vec<Mat4>], recorder: &Recorder, body: usize, node: usize) {
    assert_eq!(frames.len(), recorder.times().len());
    for (frame, &t) in frames.iter().zip(recorder.times()) {
        let (position, rotation) = pose(body, t);
        let m = frame[node];
        assert!((m.w_axis.truncate().as_dvec3() - position).length() < 2e-5, "body {body} at {t}");
        let axis = (m.x_axis.truncate().normalize() - rotation * Vec3::X).length();
        assert!(axis < 2e-5, "body {body} at {t}: {axis}");
    }
}

#[test]
fn a_film_of_a_scene_from_code_shows_the_recorded_poses() {
    let scene = shipped("playground.gltf").unwrap();
    let recorder = record(&scene);
    let path = scratch("film").join("film.glb");
    write_animation(&scene, &recorder, &path).unwrap();
    let frames = play(&path);
    let file = gltf::Gltf::open(&path).unwrap();
    assert_eq!(file.views().filter(|v| v.offset() % 4 != 0).count(), 0);
    let roots: Vec<usize> = file.scenes().next().unwrap().nodes().map(|n| n.index()).collect();
    for &body in recorder.bodies() {
        assert_played(&frames, &recorder, body, roots[body]);
    }
}

#[test]
fn a_film_over_a_file_moves_its_nodes_in_their_parents_frames() {
    let physics = |motion| json!({ "KHR_physics_rigid_bodies": motion });
    let ball = json!({ "geometry": { "shape": 0 } });
    let file = json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_implicit_shapes", "KHR_physics_rigid_bodies"],
        "extensionsRequired": ["KHR_implicit_shapes", "KHR_physics_rigid_bodies"],
        "scenes": [{ "nodes": [0] }],
        "extensions": { "KHR_implicit_shapes": { "shapes": [{ "type": "sphere" }] } },
        "nodes": [
            { "translation": [1, 2, 3], "rotation": [0.6, 0, 0, 0.8], "scale": [2, 2, 2], "children": [1] },
            { "name": "carrier", "extensions": physics(json!({ "motion": {}, "collider": ball })), "children": [2],
              "matrix": [0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 5, 0, 0, 1] },
            { "translation": [0, 1, 0], "rotation": [0, 0, 0.6, 0.8], "children": [3] },
            { "name": "rider", "scale": [1, 3, 1],
              "extensions": physics(json!({ "motion": {}, "collider": ball })) }
        ]
    });
    let dir = scratch("film_over");
    std::fs::write(dir.join("in.gltf"), file.to_string()).unwrap();
    let mut scene = load(dir.join("in.gltf")).unwrap();
    let drop = BodyDesc::dynamic().with_shape(ShapeDesc::new(Geometry::Sphere { radius: 0.2 }));
    let added = scene.add("drop", drop);
    let recorder = record(&scene);
    write_animation(&scene, &recorder, dir.join("out.glb")).unwrap();
    let frames = play(&dir.join("out.glb"));
    assert_played(&frames, &recorder, 0, 1);
    assert_played(&frames, &recorder, 1, 3);
    assert_played(&frames, &recorder, added, 4);
    // The scales of the file are still there: 2 from the root, 3 along y of the rider.
    let scale = frames[7][3].to_scale_rotation_translation().0;
    assert!((scale - Vec3::new(2.0, 6.0, 2.0)).length() < 1e-4, "{scale}");
}

#[test]
fn a_film_keeps_meshes_materials_and_older_animations() {
    let dir = scratch("film_keeps");
    let mut scene = shipped("tower.gltf").unwrap();
    write_scene(&scene, dir.join("in.gltf")).unwrap();
    scene = load(dir.join("in.gltf")).unwrap();
    write_animation(&scene, &record(&scene), dir.join("one.glb")).unwrap();
    scene.source = Some(dir.join("one.glb"));
    write_animation(&scene, &record(&scene), dir.join("two.glb")).unwrap();
    let (before, after) =
        (gltf::Gltf::open(dir.join("in.gltf")).unwrap(), gltf::Gltf::open(dir.join("two.glb")).unwrap());
    assert_eq!(before.meshes().len(), after.meshes().len());
    assert_eq!(before.materials().len(), after.materials().len());
    assert_eq!(after.animations().len(), 2);
    let positions = |file: &gltf::Gltf, path: &str| -> Vec<Vec<[f32; 3]>> {
        let buffers = gltf_buffers(file, &dir.join(path));
        let primitives = file.meshes().flat_map(|m| m.primitives().collect::<Vec<_>>());
        primitives
            .map(|p| {
                p.reader(|b| buffers.get(b.index()).map(Vec::as_slice)).read_positions().unwrap().collect()
            })
            .collect()
    };
    assert_eq!(positions(&before, "in.gltf"), positions(&after, "two.glb"));
    let recorder = record(&scene);
    for &body in recorder.bodies() {
        assert_played(&play(&dir.join("two.glb")), &recorder, body, scene.bodies[body].node.unwrap());
    }
}

fn gltf_buffers(file: &gltf::Gltf, path: &Path) -> Vec<Vec<u8>> {
    let read = |b: gltf::Buffer| match b.source() {
        gltf::buffer::Source::Bin => file.blob.clone().unwrap(),
        gltf::buffer::Source::Uri(uri) => {
            let mut tally = Tally::new(&LoadLimits::NONE);
            super::super::gltf_in::file::read_uri(path, uri, u64::MAX, &scene_folder(path), &mut tally)
                .unwrap()
        }
    };
    file.buffers().map(read).collect()
}

#[test]
fn density_becomes_mass_and_kinematic_stays() {
    let mut scene = Scene::new("in");
    let mut heavy = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    heavy.density = 7000.0;
    scene.add("heavy", BodyDesc::dynamic().with_shape(heavy));
    scene.add("turning", BodyDesc::kinematic().with_shape(ShapeDesc::new(Geometry::capsule(0.0, 0.5))));
    let path = scratch("density").join("in.glb");
    write_scene(&scene, &path).unwrap();
    let loaded = load(&path).unwrap();
    let mass = loaded.bodies[0].desc.mass.unwrap();
    assert_eq!(mass.mass, 7000.0);
    assert!((mass.inertia.x_axis.x - 7000.0 / 6.0).abs() < 0.01);
    assert_eq!(loaded.bodies[1].desc.kind, BodyKind::Kinematic);
    assert!(matches!(loaded.bodies[1].desc.shapes[0].geometry, Geometry::Sphere { radius: 0.5 }));
}

#[test]
fn films_over_the_sample_scenes_show_the_recorded_poses() {
    let Some(data) = super::super::testing::data("gltf/samples") else { return };
    for file in ["Filtering.glb", "ShapeTypes.glb", "Materials_Restitution.gltf"] {
        let scene = load(data.join(file)).unwrap();
        let recorder = record(&scene);
        let path = scratch("film_samples").join("out.glb");
        write_animation(&scene, &recorder, &path).unwrap();
        let frames = play(&path);
        for &body in recorder.bodies() {
            assert_played(&frames, &recorder, body, scene.bodies[body].node.unwrap());
        }
        println!("{file}: {} bodies move, notes {:#?}", recorder.bodies().len(), scene.notes);
    }
}
