//! Joints: frames, the range of each limit, and the gap between the frames.

use super::shapes::draw_axes;
use super::{DebugDraw, DrawOptions, Element, Ink};
use crate::body::Pose;
use crate::joint::{Axes, Axis, Joint, Motion, Row, RowKind};
use crate::shape::outline::arc;
use crate::world::World;
use glam::{DVec3, Vec3};
use std::f32::consts::{PI, TAU};

pub(super) fn draw(world: &World, options: &DrawOptions, out: &mut dyn DebugDraw) {
    let gap = Ink { element: Element::JointGap, colour: options.palette.joint_gap };
    for joint in world.joints.all.iter().filter(|joint| joint.is_there()) {
        let frames = frames(world, joint);
        let [from, to] = frames.each_ref().map(|frame| frame.position);
        if !wanted(options, &frames) {
            continue;
        }
        for frame in &frames {
            draw_axes(frame.position, frame.rotation, Element::JointFrame, options, out);
        }
        if from != to {
            out.line(from, to, gap);
        }
    }
    draw_couplings(world, options, out);
    for row in &world.joints.rows {
        let joint = &world.joints.all[row.joint as usize];
        if joint.is_there() {
            let frames = frames(world, joint);
            if wanted(options, &frames) {
                draw_limit(row, &frames, options, out);
            }
        }
    }
}

/// Lines between the joints of couplings; of distances, along the measured distance.
fn draw_couplings(world: &World, options: &DrawOptions, out: &mut dyn DebugDraw) {
    let ink = Ink { element: Element::Coupling, colour: options.palette.coupling };
    for (_, coupling) in world.joints.couplings.live() {
        let [one, other] = coupling.joints().map(|joint| frames(world, &world.joints.all[joint as usize]));
        if !wanted(options, &one) && !wanted(options, &other) {
            continue;
        }
        for (term, [from, to]) in coupling.terms.iter().zip([&one, &other]) {
            if (term.motion, term.axes) == (Motion::Linear, Axes::All) && from.position != to.position {
                out.line(from.position, to.position, ink);
            }
        }
        // From pulley to pulley too; the two motions of a screw are at one place.
        if one[0].position != other[0].position {
            out.line(one[0].position, other[0].position, ink);
        }
    }
}

fn wanted(options: &DrawOptions, frames: &[Pose; 2]) -> bool {
    options.region.is_none_or(|region| frames.iter().any(|frame| region.holds(frame.position)))
}

/// The two frames of a joint in the world.
fn frames(world: &World, joint: &Joint) -> [Pose; 2] {
    [0, 1].map(|side| {
        let pose = &world.bodies.pose[world.bodies.slots.dense(joint.bodies[side]) as usize];
        let frame = &joint.frames[side];
        pose.of_part(frame.position, frame.rotation)
    })
}

/// The range of a limit, at the first frame: a path, a circle or ball around it, an arc, a cone.
fn draw_limit(row: &Row, frames: &[Pose; 2], options: &DrawOptions, out: &mut dyn DebugDraw) {
    let (min, max) = match row.kind {
        RowKind::Limit { min, max } | RowKind::Yielding { min, max, .. } => (min, max),
        RowKind::Motor { .. } => return,
    };
    let ink = Ink { element: Element::JointLimit, colour: options.palette.joint_limit };
    let (frame, length) = (&frames[0], options.length);
    let place = |p: Vec3| -> DVec3 { frame.position + (frame.rotation * p).as_dvec3() };
    let line = &mut |from: Vec3, to: Vec3| out.line(place(from), place(to), ink);
    match (row.motion, row.axes) {
        (Motion::Linear, Axes::One(axis)) => {
            // Without an end, beyond where the joint is now.
            let apart = frame.rotation.conjugate() * (frames[1].position - frame.position).as_vec3();
            let (along, across) = (unit(axis), unit(after(axis)) * (0.25 * length));
            let beyond = apart.dot(along).abs() + length;
            let end = |end: f32| if end.is_finite() { end } else { beyond.copysign(end) };
            line(along * end(min), along * end(max));
            for end in [min, max].into_iter().filter(|end| end.is_finite()) {
                line(along * end - across, along * end + across);
            }
        }
        (Motion::Linear, Axes::Perpendicular(axis)) => {
            distances(min, max).for_each(|radius| circle(axis, radius, line));
        }
        (Motion::Linear, Axes::All) => {
            for radius in distances(min, max) {
                Axis::ALL.into_iter().for_each(|axis| circle(axis, radius, line));
            }
        }
        (Motion::Angular, Axes::One(axis)) => sector(axis, (min, max), length, line),
        (Motion::Angular, Axes::Perpendicular(axis)) => {
            let along = unit(axis);
            let (u, v) = (unit(after(axis)), along.cross(unit(after(axis))));
            // An angle of two directions is at most half a turn.
            for angle in distances(min, max).filter(|angle| *angle < PI) {
                let (height, radius) = (length * libm::cosf(angle), length * libm::sinf(angle));
                arc(along * height, u * radius, v * radius, (0.0, TAU), line);
                for side in [u, v, -u, -v] {
                    line(Vec3::ZERO, along * height + side * radius);
                }
            }
        }
        // A turn of so much about any axis.
        (Motion::Angular, Axes::All) => {
            Axis::ALL.into_iter().for_each(|axis| sector(axis, (-max, max), length, line));
        }
    }
}

fn unit(axis: Axis) -> Vec3 {
    [Vec3::X, Vec3::Y, Vec3::Z][axis as usize]
}

fn after(axis: Axis) -> Axis {
    Axis::ALL[(axis as usize + 1) % 3]
}

/// The ends of a range of distances or of angles without a sign that limit anything.
fn distances(min: f32, max: f32) -> impl Iterator<Item = f32> {
    [min, max].into_iter().filter(|end| *end > 0.0 && end.is_finite())
}

fn circle(axis: Axis, radius: f32, line: &mut dyn FnMut(Vec3, Vec3)) {
    let (u, along) = (unit(after(axis)), unit(axis));
    arc(Vec3::ZERO, u * radius, along.cross(u) * radius, (0.0, TAU), line);
}

/// The angles about an axis to which the next axis of the second frame may be turned.
fn sector(axis: Axis, (min, max): (f32, f32), radius: f32, line: &mut dyn FnMut(Vec3, Vec3)) {
    let u = unit(after(axis)) * radius;
    let v = unit(axis).cross(u);
    // A turn is known within half a turn to either side.
    let (from, to) = (min.max(-PI), max.min(PI));
    arc(Vec3::ZERO, u, v, (from, to), line);
    for end in [from, to].into_iter().filter(|end| end.abs() < PI) {
        line(Vec3::ZERO, u * libm::cosf(end) + v * libm::sinf(end));
    }
}
