//! Joints as their caller sees them: refused calls, valid handles, reports.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

mod changes;
mod extremes;
mod handles;
mod loads;
mod many;
mod readings;
mod refused;
mod targets;

use crate::common::random::Random;
use crate::common::{self, G};
use backstop::glam::{DVec3, Mat3, Quat, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, BodyHandle, Budget, Category, Error, Frame, Geometry, JointDesc, JointHandle,
    Limit, MassProperties, Material, Motion, Motor, Settings, ShapeDesc, Spring, World,
};

const DT: f32 = 1.0 / 60.0;

fn world(gravity: f64) -> World {
    World::new(Settings::default().with_gravity(Vec3::Y * -gravity as f32)).unwrap()
}

fn ball(at: DVec3) -> BodyDesc {
    BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(Geometry::Sphere { radius: 0.1 }))
}

fn cube(at: DVec3) -> BodyDesc {
    BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(Geometry::cuboid(0.25, 0.25, 0.25)))
}

/// A ball on a rod of 1 m, hanging at rest; its joint to the ground.
fn hanging(world: &mut World) -> (BodyHandle, BodyHandle, JointHandle) {
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let body = world.add_body(&ball(DVec3::NEG_Y)).unwrap();
    let joint = world.add_joint(&JointDesc::ball([ground, body], [Frame::default(), Frame::at(Vec3::Y)]));
    (ground, body, joint.unwrap())
}

/// Some joint of many kinds.
fn any(bodies: [BodyHandle; 2], random: &mut Random) -> JointDesc {
    let frames = [Frame::default(); 2];
    let spring = Spring::Frequency { hertz: 3.0, ratio: 0.7 };
    match random.below(9) {
        0 => JointDesc::fixed(bodies, frames),
        1 => JointDesc::ball(bodies, frames).with_limit(Limit::new(
            Motion::Angular,
            Axes::Perpendicular(Axis::X),
            0.0,
            0.8,
        )),
        2 => JointDesc::hinge(bodies, frames).with_limit(Limit::new(
            Motion::Angular,
            Axes::One(Axis::X),
            -0.5,
            0.7,
        )),
        3 => JointDesc::slider(bodies, frames).with_limit(Limit::new(
            Motion::Linear,
            Axes::One(Axis::X),
            -0.5,
            0.7,
        )),
        4 => JointDesc::distance(bodies, frames, 0.0, 0.5),
        5 => JointDesc::wheel(bodies, frames, 0.3, spring),
        6 => JointDesc::hinge(bodies, frames).with_motor(Motor::velocity(Motion::Angular, Axis::X, 3.0, 5.0)),
        7 => JointDesc::new(bodies, frames)
            .with_limit(Limit::new(Motion::Linear, Axes::All, 0.0, 0.2).with_spring(spring))
            .with_motor(Motor::friction(Motion::Angular, Axis::Y, 0.1)),
        _ => JointDesc::new(bodies, frames),
    }
}
