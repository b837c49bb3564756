//! What is solved last is obeyed best: a motor that is far too strong pulls the joint apart, not the door through the wall.

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, Drive, Error, Frame, Geometry, JointDesc, Limit, Motion, Order, RowGroup, Settings,
    ShapeDesc, Skeleton, TriangleMesh, World,
};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};
use std::sync::Arc;

/// A door of 2 cm, 1 m wide, that turns about the y axis, driven at 5 rad/s by a motor against a mesh without thickness
/// that stands in its way at 45 degrees. How far its outer edge gets beyond the mesh, and the widest gap in the hinge [m].
fn driven(order: Order, (substeps, iterations): (u32, u32), torque: f32) -> (f32, f64) {
    let settings = Settings { order, substeps, iterations, ..Settings::default() };
    let mut world = World::new(settings).unwrap();
    let frame = world.add_body(&BodyDesc::fixed()).unwrap();
    let along = Quat::from_rotation_y(FRAC_PI_4) * Vec3::X;
    let corner = |r: f32, y: f32| along * r + Vec3::Y * y;
    let corners = vec![corner(0.4, -3.0), corner(4.0, -3.0), corner(4.0, 3.0), corner(0.4, 3.0)];
    let wall = TriangleMesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let wall = ShapeDesc::new(Geometry::Mesh(Arc::new(wall)));
    world.add_body(&BodyDesc::fixed().with_shape(wall)).unwrap();
    let door = ShapeDesc::new(Geometry::cuboid(0.5, 1.0, 0.01));
    let door = BodyDesc::dynamic().at(DVec3::X * 0.5).with_shape(door);
    let door = world.add_body(&door).unwrap();
    // The frames' x is the world's y.
    let turn = Quat::from_rotation_z(FRAC_PI_2);
    let frames = [Vec3::ZERO, Vec3::X * -0.5].map(|position| Frame { position, rotation: turn });
    let hinge = JointDesc::hinge([frame, door], frames);
    let motor = Drive::motor(Motion::Angular, Axis::X, 5.0, torque);
    let joint = world.add_joint(&hinge.with_drive(motor)).unwrap();
    // Towards the side from which the door comes.
    let normal = along.cross(Vec3::Y);
    let (mut beyond, mut widest) = (0.0_f32, 0.0_f64);
    for _ in 0..180 {
        world.step(1.0 / 60.0).unwrap();
        let (at, turn) = (world.position(door).unwrap().as_vec3(), world.rotation(door).unwrap());
        for y in [-1.0, 1.0] {
            beyond = beyond.max(-normal.dot(at + turn * Vec3::new(0.5, y, 0.0)));
        }
        let [(a, _), (b, _)] = world.joint_frames(joint).unwrap();
        widest = widest.max((b - a).length());
    }
    (beyond, widest)
}

#[test]
fn a_motor_that_is_too_strong_drives_no_door_through_a_wall_unless_joints_come_last() {
    for solver in [(4, 1), (1, 8)] {
        // The door's weight, hung on its edge, makes two hundred newton metres.
        let (beyond, gap) = driven(Order::default(), solver, 5e4);
        println!("{solver:?}: {beyond:.4} m beyond, hinge open by {gap:.4}");
        assert!(beyond < 0.001, "{solver:?}: {beyond}");
        let (beyond, gap) = driven(Order::default().reversed(), solver, 5e4);
        println!("{solver:?} reversed: {beyond:.4} m beyond, hinge open by {gap:.4}");
        // The near face of its edge too, 1 cm from its middle.
        assert!(beyond > 0.01, "{solver:?}: {beyond}");
    }
}

/// A figure pressed by its hips against a wall whose face is the plane x = 0, for five seconds: how deep anything of it gets
/// [m].
fn pressed(force: f32) -> f64 {
    let mut world = World::new(Settings { substeps: 1, iterations: 8, ..Settings::default() }).unwrap();
    let wall = ShapeDesc::new(Geometry::cuboid(1.0, 5.0, 5.0));
    let wall = world.add_body(&BodyDesc::fixed().at(DVec3::X).with_shape(wall)).unwrap();
    let skeleton = Skeleton::humanoid();
    let figure = skeleton.add_to(&mut world, DVec3::NEG_X, Quat::IDENTITY, Vec3::ZERO).unwrap();
    let hips = figure.bodies[0];
    let frames = world.frames_at([wall, hips], world.position(hips).unwrap(), Quat::IDENTITY).unwrap();
    let joint = JointDesc::new([wall, hips], frames)
        .with_drive(Drive::motor(Motion::Linear, Axis::X, 1.0, force))
        .with_limit(Limit::lock(Motion::Linear, Axes::Around(Axis::X)))
        .colliding(true);
    world.add_joint(&joint).unwrap();
    let mut deepest = 0.0_f64;
    for _ in 0..300 {
        world.step(1.0 / 60.0).unwrap();
        for (bone, &body) in skeleton.bones.iter().zip(&figure.bodies) {
            let half = 0.5 * (bone.to - bone.from).length() - bone.radius;
            let along = f64::from((world.rotation(body).unwrap() * Vec3::Y * half).x);
            deepest = deepest.max(world.position(body).unwrap().x + along.abs() + f64::from(bone.radius));
        }
    }
    deepest
}

/// The predicted paths of limbs, which know of no joint, missed the wall that they were next to, so that there was no contact
/// when the joints led them into it: 45 mm deep.
#[test]
fn a_figure_that_is_pressed_against_a_wall_stays_out_of_it() {
    for force in (0..30).map(|i| 1000.0 + 610.0 * i as f32) {
        let depth = pressed(force);
        println!("{force} N: {:.1} mm", 1e3 * depth);
        // A contact is a plane for a step: what rolls on its end gets in by millimetres.
        assert!(depth < 0.005, "{force} N: {depth}");
    }
}

#[test]
fn an_order_has_every_group_once() {
    let mut groups = Order::default().0;
    groups[0] = RowGroup::Joints;
    let mut world = World::new(Settings::default()).unwrap();
    let settings = Settings { order: Order(groups), ..Settings::default() };
    assert!(matches!(world.set_settings(settings), Err(Error::Incomplete { .. })));
    assert_eq!(world.settings().order, Order::default());
}
