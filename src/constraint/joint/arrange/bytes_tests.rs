//! A kind of joint that a scene does not have takes no bytes.

use super::{AnyTable, JointRows, bytes_of_trees};
use crate::{
    Axis, BodyDesc, BodyHandle, Frame, Geometry, JointDesc, MassProperties, Motion, Motor, Settings,
    ShapeDesc, World,
};
use glam::{Mat3, Vec3};

/// Purpose of a table, and its live and reserved bytes.
fn tables(rows: &JointRows) -> [(&'static str, (usize, usize)); 12] {
    [
        ("points", rows.tables.points.bytes()),
        ("welds", rows.tables.welds.bytes()),
        ("hinges", rows.tables.hinges.bytes()),
        ("lines", rows.tables.lines.bytes()),
        ("slides", rows.tables.slides.bytes()),
        ("distances", rows.tables.distances.bytes()),
        ("twists", rows.tables.twists.bytes()),
        ("tilts", rows.tables.tilts.bytes()),
        ("turns", rows.tables.turns.bytes()),
        ("tree slots", rows.tree_slots.bytes()),
        ("trees", bytes_of_trees(&rows.trees)),
        ("single trees", bytes_of_trees(&rows.single_trees)),
    ]
}

type Make = fn([BodyHandle; 2], [Frame; 2]) -> JointDesc;
type Pairs = &'static [[usize; 2]];
/// The joint, the pairs of five balls that it joins, and the tables that take bytes then.
type Case = (Make, Pairs, &'static [&'static str]);

/// The tables that take bytes after a step of five balls joined in pairs: to make a chain, a ring, which is a
/// tree with a joint that is cut, or a net of more loops than are cut.
fn taken(make: Make, pairs: Pairs) -> Vec<&'static str> {
    let mut world = World::new(Settings::default()).unwrap();
    let mut ball = BodyDesc::dynamic().with_shape(ShapeDesc::new(Geometry::Sphere { radius: 0.1 }));
    ball.mass = Some(MassProperties { mass: 1.0, centre_of_mass: Vec3::ZERO, inertia: Mat3::IDENTITY });
    let bodies: Vec<BodyHandle> =
        (0..5).map(|i| world.add_body(&ball.clone().with_position(Vec3::X * i as f32)).unwrap()).collect();
    for &[a, b] in pairs {
        let frames = [Frame::at(Vec3::X * 0.5), Frame::at(Vec3::X * -0.5)];
        world.add_joint(&make([bodies[a], bodies[b]], frames)).unwrap();
    }
    world.step(1.0 / 60.0).unwrap();
    let tables = tables(&world.buffers.joints);
    assert!(tables.iter().all(|(_, (live, reserved))| (*live == 0) == (*reserved == 0)), "{tables:?}");
    tables.iter().filter(|table| table.1.1 > 0).map(|table| table.0).collect()
}

#[test]
fn a_kind_of_joint_that_is_not_there_takes_no_bytes() {
    let drive: Make = |bodies, frames| {
        JointDesc::new(bodies, frames).with_motor(Motor::velocity(Motion::Angular, Axis::X, 1.0, 1.0))
    };
    let rod: Make = |bodies, frames| JointDesc::distance(bodies, frames, 1.0, 1.0);
    let chain: Pairs = &[[0, 1], [1, 2]];
    let ring: Pairs = &[[0, 1], [1, 2], [2, 0]];
    let net: Pairs = &[[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [1, 3], [1, 4], [2, 3], [2, 4], [3, 4]];
    let cases: [Case; 11] = [
        (JointDesc::ball, &[], &[]),
        (JointDesc::ball, &[[0, 1]], &["tree slots", "single trees"]),
        (JointDesc::ball, chain, &["tree slots", "single trees"]),
        (JointDesc::ball, ring, &["single trees"]),
        (JointDesc::ball, net, &["points"]),
        (JointDesc::hinge, chain, &["tree slots", "single trees"]),
        (JointDesc::hinge, net, &["points", "hinges"]),
        (JointDesc::fixed, net, &["points", "welds"]),
        (JointDesc::slider, chain, &["welds", "lines"]),
        (drive, chain, &["twists"]),
        (rod, chain, &["distances"]),
    ];
    for (i, (make, pairs, expected)) in cases.into_iter().enumerate() {
        assert_eq!(taken(make, pairs), expected, "case {i}");
    }
}

/// A scene that has no joints any more is like one that never had any, except for memory kept for new joints.
#[test]
fn joints_that_are_gone_are_not_live() {
    let mut world = World::new(Settings::default()).unwrap();
    let ball = BodyDesc::dynamic().with_shape(ShapeDesc::new(Geometry::Sphere { radius: 0.1 }));
    let [a, b] = [0.0, 1.0].map(|x| world.add_body(&ball.clone().with_position(Vec3::X * x)).unwrap());
    let joint = world.add_joint(&JointDesc::slider([a, b], [Frame::default(); 2])).unwrap();
    world.step(1.0 / 60.0).unwrap();
    assert!(tables(&world.buffers.joints).iter().any(|table| table.1.0 > 0));
    world.remove_joint(joint).unwrap();
    world.step(1.0 / 60.0).unwrap();
    let left = tables(&world.buffers.joints);
    assert!(left.iter().all(|table| table.1.0 == 0), "{left:?}");
}
