//! Changes to joints and to the bodies they join.

use super::*;

/// Contacts that a step found.
fn contacts(world: &mut World) -> u32 {
    world.step(DT).unwrap().manifolds
}

#[test]
fn joined_bodies_collide_only_if_asked_to() {
    for first_is in ["dynamic", "fixed", "kinematic"] {
        let pair = |world: &mut World| {
            let first = match first_is {
                "dynamic" => cube(DVec3::ZERO),
                kind => {
                    let kind = if kind == "fixed" { BodyDesc::fixed() } else { BodyDesc::kinematic() };
                    kind.with_shape(ShapeDesc::new(Geometry::cuboid(0.25, 0.25, 0.25)))
                }
            };
            [world.add_body(&first).unwrap(), world.add_body(&cube(DVec3::Y * 0.499)).unwrap()]
        };
        for flip in [false, true] {
            let mut world = world(0.0);
            let [a, b] = pair(&mut world);
            let bodies = if flip { [b, a] } else { [a, b] };
            let frames = world.frames_at(bodies, DVec3::Y * 0.25, Quat::IDENTITY).unwrap();
            let desc = JointDesc::ball(bodies, frames);
            let what = format!("{first_is} {flip}");
            assert_eq!(contacts(&mut world), 1, "{what}: they touch");
            let joint = world.add_joint(&desc).unwrap();
            assert_eq!(contacts(&mut world), 0, "{what}: joined, what touched lets go");
            let second = world.add_joint(&desc.clone().with_collide(true)).unwrap();
            assert_eq!(contacts(&mut world), 0, "{what}: one that collides does not overrule the other");
            world.remove_joint(joint).unwrap();
            assert_eq!(contacts(&mut world), 1, "{what}: only the one that collides is left");
            world.remove_joint(second).unwrap();
            assert_eq!(contacts(&mut world), 1, "{what}: no joint");
            let joint = world.add_joint(&desc.clone().with_break_force(0.0, f32::INFINITY)).unwrap();
            world.set_velocity(b, Vec3::X * 0.1, Vec3::ZERO).unwrap();
            assert_eq!(contacts(&mut world), 0, "{what}: joined again");
            assert!(!world.contains_joint(joint), "{what}");
            assert_eq!(contacts(&mut world), 1, "{what}: broken");
            // One body's joint to a third says nothing about these two.
            let third = world.add_body(&ball(DVec3::X * 5.0)).unwrap();
            world.add_joint(&JointDesc::new([b, third], [Frame::default(); 2])).unwrap();
            assert_eq!(contacts(&mut world), 1, "{what}: joined to another");
        }
    }
}

#[test]
fn a_change_of_mass_leaves_joints_where_they_are() {
    let mut world = world(0.0);
    let turn = Quat::from_euler(backstop::glam::EulerRot::XYZ, 0.3, -0.8, 1.1);
    let [a, b] = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.5, 2.5, 3.0)]
        .map(|at| world.add_body(&cube(at).with_rotation(turn)).unwrap());
    let frames = world.frames_at([a, b], DVec3::new(1.2, 2.2, 3.1), turn.inverse()).unwrap();
    let joint = world.add_joint(&JointDesc::fixed([a, b], frames)).unwrap();
    let before = world.joint_frames(joint).unwrap();
    let same = |world: &World, what: &str| {
        for (now, before) in world.joint_frames(joint).unwrap().iter().zip(&before) {
            assert!((now.0 - before.0).length() < 1e-6, "{what}: {} {}", now.0, before.0);
            assert!(now.1.dot(before.1).abs() > 1.0 - 1e-6, "{what}: {} {}", now.1, before.1);
        }
    };
    same(&world, "as it is");
    // Off the centre and askew: the principal axes turn.
    let mut more = ShapeDesc::new(Geometry::capsule(0.5, 0.1));
    (more.position, more.rotation) = (Vec3::new(0.4, -0.3, 0.2), common::turned(Vec3::X, 30.0));
    let shape = world.add_shape(b, &more).unwrap();
    same(&world, "a shape more");
    world.remove_shape(shape).unwrap();
    same(&world, "a shape less");
    let inertia = Mat3::from_diagonal(Vec3::new(1.0, 2.0, 2.5));
    world
        .set_mass(a, MassProperties { mass: 7.0, centre_of_mass: Vec3::new(0.1, 0.2, -0.3), inertia })
        .unwrap();
    same(&world, "another mass");
    // And nothing pulls, as nothing moved.
    world.step(DT).unwrap();
    let speed = [a, b].map(|body| world.linear_velocity(body).unwrap().length());
    assert!(speed.iter().all(|v| *v < 1e-4), "{speed:?}");
}

#[test]
fn frames_at_a_point_coincide_there() {
    let mut world = world(0.0);
    let turn = common::turned(Vec3::new(1.0, 2.0, -1.0).normalize(), 70.0);
    let mut off = ShapeDesc::new(Geometry::cuboid(0.1, 0.2, 0.3));
    off.position = Vec3::new(0.5, 0.1, 0.0);
    // Far from the world's origin, where single precision has steps of 60 mm.
    let far = DVec3::new(1e6, 0.0, -1e6);
    let a =
        world.add_body(&BodyDesc::dynamic().with_position(far).with_rotation(turn).with_shape(off)).unwrap();
    let b = world.add_body(&cube(far + DVec3::Y)).unwrap();
    let (point, axes) = (far + DVec3::new(0.1, 0.7, 0.2), common::turned(Vec3::Z, 20.0));
    let frames = world.frames_at([a, b], point, axes).unwrap();
    let joint = world.add_joint(&JointDesc::fixed([a, b], frames)).unwrap();
    for (at, rotation) in world.joint_frames(joint).unwrap() {
        assert!((at - point).length() < 1e-6, "{}", at - point);
        assert!(rotation.dot(axes).abs() > 1.0 - 1e-6);
    }
}

#[test]
fn calls_change_what_is_driven_and_limited() {
    let mut world = world(0.0);
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let wheel = world.add_body(&ball(DVec3::ZERO)).unwrap();
    let hinge = JointDesc::hinge([ground, wheel], [Frame::default(); 2]);
    let motor = |speed| Motor::velocity(Motion::Angular, Axis::X, speed, 1e3);
    let joint = world.add_joint(&hinge.clone().with_motor(motor(2.0))).unwrap();
    for speed in [2.0, -5.0, 0.0, 3.0] {
        world.set_joint_motor(joint, motor(speed)).unwrap();
        common::steps(&mut world, 3, DT);
        let spin = world.angular_velocity(wheel).unwrap();
        assert!((spin - Vec3::X * speed).length() < 1e-4, "{spin} for {speed}");
    }
    // Without a motor it coasts; without a limit it flies off.
    assert_eq!(world.remove_joint_motor(joint, Motion::Angular, Axis::X), Ok(true));
    common::steps(&mut world, 30, DT);
    assert!((world.angular_velocity(wheel).unwrap() - Vec3::X * 3.0).length() < 1e-4);
    world.set_joint_limits(joint, &[]).unwrap();
    world.set_velocity(wheel, Vec3::Y, Vec3::ZERO).unwrap();
    common::steps(&mut world, 60, DT);
    assert!((world.position(wheel).unwrap() - DVec3::Y).length() < 1e-4);
    assert_eq!(world.joint_count(), 1);
}

/// A joint without limits and motors bears nothing, also if it bore something before.
#[test]
fn a_joint_that_was_emptied_bears_nothing() {
    let mut world = world(G);
    let (_, _, joint) = hanging(&mut world);
    common::steps(&mut world, 10, DT);
    assert!(world.joint_force(joint).unwrap().0.y > 1.0);
    world.set_joint_limits(joint, &[]).unwrap();
    common::steps(&mut world, 2, DT);
    assert_eq!(world.joint_force(joint), Ok((Vec3::ZERO, Vec3::ZERO)));
}
