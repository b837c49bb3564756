//! Couplings, and other properties without names in glTF, in scenes: written, read back, and refused.

use backstop::glam::{DVec3, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, CouplingDesc, Error, Frame, Geometry, JointDesc, LoadLimits, Material, Motion,
    Motor, Settings, ShapeDesc, World,
};
use backstop_scene::{Scene, SceneCoupling, SceneError, SceneJoint, from_bytes, load, write_scene};
use std::f64::consts::PI;

fn block() -> ShapeDesc {
    ShapeDesc::new(Geometry::cuboid(0.25, 0.25, 0.25))
}

/// Joins two bodies of a scene; returns the joint's index.
fn join(
    scene: &mut Scene,
    bodies: [usize; 2],
    frames: [Frame; 2],
    describe: fn([backstop::BodyHandle; 2], [Frame; 2]) -> JointDesc,
) -> usize {
    let nobody = backstop::BodyHandle::from_bits(0);
    let JointDesc { limits, motors, collide, .. } = describe([nobody; 2], frames);
    let name = format!("joint {}", scene.joints.len());
    scene.joints.push(SceneJoint { name, bodies, frames, limits, motors, collide });
    scene.joints.len() - 1
}

/// All four kinds of couplings on a post, a driven gear, and on a plane a belt, balls with rolling and
/// spinning friction, and a body with caps and damping.
fn machine() -> Scene {
    let mut scene = Scene::new("machine");
    let post = scene.add("post", BodyDesc::fixed().with_position(DVec3::Y * 4.0).with_shape(block()));
    let mut wheels = Vec::new();
    for i in 0..3_u8 {
        let at = Vec3::new(1.5 + f32::from(i), 0.0, 0.0);
        let wheel = BodyDesc::dynamic().with_position(DVec3::Y * 4.0 + at.as_dvec3()).with_shape(block());
        let wheel = scene.add(format!("wheel {i}"), wheel);
        wheels.push(join(&mut scene, [post, wheel], [Frame::at(at), Frame::default()], JointDesc::hinge));
    }
    scene.joints[wheels[0]].motors.push(Motor::velocity(Motion::Angular, Axis::X, 3.0, 50.0));
    let at = Vec3::new(0.0, 1.5, 0.0);
    let rack = scene.add("rack", BodyDesc::dynamic().with_position(DVec3::Y * 5.5).with_shape(block()));
    let slider = join(&mut scene, [post, rack], [Frame::at(at), Frame::default()], JointDesc::slider);
    let nut = scene.add("nut", BodyDesc::dynamic().with_position(DVec3::Y * 7.0).with_shape(block()));
    let screw = join(&mut scene, [rack, nut], [Frame::at(at), Frame::default()], |bodies, frames| {
        let mut screw = JointDesc::slider(bodies, frames);
        screw.limits.retain(|limit| limit.motion == Motion::Linear || limit.axes != Axes::All);
        screw
    });
    let ropes = [-3.0, -4.0].map(|x| {
        let at = Vec3::new(x, 0.0, 0.0);
        let load = BodyDesc::dynamic().with_position(DVec3::new(f64::from(x), 3.0, 0.0)).with_shape(block());
        let load = scene.add("load", load);
        join(&mut scene, [post, load], [Frame::at(at), Frame::default()], JointDesc::new)
    });
    let couple = |joints, describe: &dyn Fn([backstop::JointHandle; 2]) -> CouplingDesc| {
        SceneCoupling::new(joints, describe)
    };
    scene.couplings = vec![
        couple([wheels[0], wheels[1]], &|hinges| CouplingDesc::gear(hinges, [20.0, 31.0])),
        couple([wheels[1], wheels[2]], &|hinges| {
            let range = Some([f64::NEG_INFINITY, PI / 7.0]);
            CouplingDesc::gear(hinges, [7.0, -PI / 31.0]).with_range(range).with_user_data(u64::MAX)
        }),
        couple([wheels[2], slider], &|[hinge, slider]| {
            CouplingDesc::rack(hinge, slider, 0.3).with_break_force([1e5, f32::INFINITY])
        }),
        couple([screw, screw], &|[joint, _]| CouplingDesc::screw(joint, 0.7)),
        couple(ropes, &|ropes| CouplingDesc::pulley(ropes, 0.5, 1.75)),
    ];
    let belt = Material::default().with_surface_velocity(Vec3::new(0.5, 0.0, -0.25));
    let floor = ShapeDesc::new(Geometry::cuboid(50.0, 0.5, 50.0)).with_material(belt);
    scene.add("belt", BodyDesc::fixed().with_position(DVec3::Y * -0.5).with_shape(floor));
    let rough = Material::default()
        .with_rolling_friction(0.01)
        .with_spinning_friction(0.003)
        .with_contact_hertz(25.0)
        .with_contact_damping(0.5);
    let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.5 }).with_material(rough);
    let spun = BodyDesc::dynamic().with_position(DVec3::new(0.0, 0.5, 5.0)).with_shape(ball.clone());
    scene.add("ball", spun.with_velocity(Vec3::X * 3.0, Vec3::Y * 5.0));
    let capped = BodyDesc::dynamic().with_position(DVec3::new(5.0, 30.0, 5.0)).with_shape(ball);
    let capped = capped.with_max_linear_speed(4.0).with_max_angular_speed(2.5);
    scene.add("capped", capped.with_linear_damping(0.125).with_angular_damping(0.5));
    scene
}

fn written(name: &str, scene: &Scene) -> Scene {
    let folder = std::env::temp_dir().join(format!("backstop-couplings-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    write_scene(scene, &path).unwrap();
    load(&path).unwrap()
}

/// Expected: each field as it was, and the same bits after ten seconds as the scene that was never a file.
#[test]
fn a_scene_with_couplings_runs_from_a_file_as_from_code() {
    let scene = machine();
    for name in ["machine.gltf", "machine.glb"] {
        let read = written(name, &scene);
        assert_eq!(read.notes, [""; 0]);
        assert_eq!(read.couplings, scene.couplings);
        assert_eq!(read.bodies.len(), scene.bodies.len());
        for (a, b) in read.bodies.iter().zip(&scene.bodies) {
            let (a, b) = (&a.desc, &b.desc);
            assert_eq!(a.shapes[0].material, b.shapes[0].material);
            assert_eq!(a.max_linear_speed, b.max_linear_speed);
            assert_eq!(a.max_angular_speed, b.max_angular_speed);
            assert_eq!([a.linear_damping, a.angular_damping], [b.linear_damping, b.angular_damping]);
        }
        let mut hashes = [&scene, &read].map(|scene| {
            let mut world = World::new(Settings::default()).unwrap();
            let added = scene.add_to(&mut world).unwrap();
            assert_eq!((added.couplings.len(), world.coupling_count()), (5, 5));
            super::run(&mut world, 600);
            let gear = added.couplings[0];
            assert!(world.coupling_positions(gear).unwrap()[0] > 20.0, "the motor turns");
            assert!(world.coupling_sum(gear).unwrap().abs() < 0.01);
            world.state_hash()
        });
        let [code, file] = &mut hashes;
        assert_eq!(code, file, "{name}");
    }
}

/// Expected: an error that says which coupling and why, and a world without anything of the scene.
#[test]
fn couplings_of_joints_that_are_not_there_are_refused() {
    let mut scene = machine();
    scene.couplings[3].joints[1] = 99;
    let mut world = World::new(Settings::default()).unwrap();
    let refused = Error::Index { what: "index of a coupled joint", index: 99, count: scene.joints.len() };
    assert_eq!(scene.add_to(&mut world).unwrap_err(), refused);
    assert_eq!((world.bodies().count(), world.joint_count(), world.coupling_count()), (0, 0, 0));
    // A file has no place for it.
    assert_eq!(written("beyond.gltf", &scene).couplings.len(), 4);
}

/// A file with two hinges at nodes 1 and 3, with extras of the root, of a material and of the motion of node
/// 2.
fn file(root: &str, material: &str, motion: &str) -> Result<Scene, SceneError> {
    let text = format!(
        r#"{{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0, 4]}}],
        "extensionsUsed": ["KHR_implicit_shapes", "KHR_physics_rigid_bodies"],
        "nodes": [
            {{"children": [1, 3], "extensions": {{"KHR_physics_rigid_bodies":
                {{"collider": {{"geometry": {{"shape": 0}}, "physicsMaterial": 0}}}}}}}},
            {{"extensions": {{"KHR_physics_rigid_bodies": {{"joint": {{"connectedNode": 2, "joint": 0}}}}}},
              "children": [2]}},
            {{"extensions": {{"KHR_physics_rigid_bodies": {{"motion": {{"extras": {motion}}},
                "collider": {{"geometry": {{"shape": 0}}}}}}}}}},
            {{"extensions": {{"KHR_physics_rigid_bodies": {{"joint": {{"connectedNode": 2, "joint": 0}}}}}}}},
            {{"extensions": {{"KHR_physics_rigid_bodies": {{"joint": {{"connectedNode": 0, "joint": 0}}}}}}}},
            {{"extensions": {{"KHR_physics_rigid_bodies":
                {{"joint": {{"connectedNode": 2, "joint": 0}}}}}}}}],
        "extensions": {{"KHR_implicit_shapes": {{"shapes": [{{"type": "sphere"}}]}},
            "KHR_physics_rigid_bodies": {{"extras": {root}, "physicsJoints": [{{}}],
                "physicsMaterials": [{{"extras": {material}}}]}}}}}}"#
    );
    from_bytes("some.gltf", text.as_bytes(), &|_, _| unreachable!(), &LoadLimits::default())
}

/// Extras of other programs are ignored; ours are checked, and each error says where and why.
#[test]
fn what_a_file_says_wrongly_is_refused() {
    let motions = |motions: &str| format!(r#"{{"backstop": {{"couplings": [{{"motions": [{motions}]}}]}}}}"#);
    let turn = |node: u32| format!(r#"{{"node": {node}, "angularAxes": [0], "factor": 2}}"#);
    let gear = motions(&format!("{}, {}", turn(1), turn(3)));
    let none = r#"{"somebody": "else's"}"#;
    let scene = file(&gear, r#"{"backstop": {"rollingFriction": 0.5}}"#, "[1, 2]").unwrap();
    assert_eq!(scene.couplings.len(), 1);
    assert_eq!((scene.couplings[0].joints, scene.couplings[0].factors), ([0, 1], [2.0; 2]));
    assert_eq!(scene.bodies[0].desc.shapes[0].material.rolling_friction, 0.5);
    // Node 4's joint is between static bodies, node 5 is in no scene: no joints, and so no couplings.
    for node in [4, 5] {
        let scene = file(&motions(&format!("{}, {}", turn(1), turn(node))), none, none).unwrap();
        assert_eq!(scene.couplings, []);
        assert!(scene.notes.last().unwrap().contains("coupling 0 is left out"), "{:?}", scene.notes);
    }
    let slide = r#"{"node": 3, "linearAxes": [0, 1, 2], "factor": 0}"#;
    let both = r#"{"node": 3, "linearAxes": [0], "angularAxes": [0], "factor": 1}"#;
    let around = r#"{"node": 3, "angularAxes": [0, 1], "factor": 1}"#;
    for (root, material, motion, why) in [
        (motions(&turn(1)), none, none, "invalid length 1"),
        (motions(&format!("{}, {}", turn(1), turn(1))), none, none, "coupling 0: "),
        (motions(&format!("{}, {}", turn(1), turn(2))), none, none, "coupling 0: node 2 has no joint"),
        (motions(&format!("{}, {}", turn(1), turn(9))), none, none, "coupling 0: node 9 does not exist"),
        (motions(&format!("{}, {slide}", turn(1))), none, none, "coupling factor"),
        (motions(&format!("{}, {both}", turn(1))), none, none, "either linearAxes or angularAxes"),
        (motions(&format!("{}, {around}", turn(1))), none, none, "about one axis"),
        (r#"{"backstop": {"coupling": []}}"#.into(), none, none, "unknown field `coupling`"),
        (none.into(), r#"{"backstop": {"rollingFriction": -1}}"#, none, "rolling friction"),
        (
            none.into(),
            r#"{"backstop": {"surfaceVelocity": [1, 2]}}"#,
            none,
            "extras, backstop: invalid length",
        ),
        (none.into(), r#"{"backstop": {"rolingFriction": 1}}"#, none, "unknown field `rolingFriction`"),
        (none.into(), none, r#"{"backstop": {"maxLinearSpeed": -3}}"#, "maximum linear speed"),
        (none.into(), none, r#"{"backstop": {"linearDamping": -3}}"#, "linear damping"),
    ] {
        let error = file(&root, material, motion).expect_err(why).to_string();
        assert!(error.contains(why) && error.starts_with("some.gltf"), "{error}");
    }
}
