use super::*;
use crate::handle::BodyHandle;
use crate::joint::{Axes, Axis, Frame, Motion};
use crate::math::Quat;

const HERE: [JointFrame; 2] = [JointFrame { position: Vec3::ZERO, rotation: Quat::IDENTITY }; 2];

fn desc(a: u32, b: u32) -> JointDesc {
    let bodies = [a, b].map(|slot| BodyHandle { slot, generation: 1 });
    let frames = [Frame::default(); 2];
    // Locks and rows in different numbers.
    match (a + b) % 3 {
        0 => JointDesc::hinge(bodies, frames).with_motor(Motor::friction(Motion::Angular, Axis::X, 1.0)),
        1 => JointDesc::distance(bodies, frames, 0.0, 1.0),
        _ => JointDesc::slider(bodies, frames).with_collide(true),
    }
}

#[test]
fn lists_of_bodies_are_those_of_their_joints() {
    let mut joints = Joints::default();
    let mut model: Vec<(u32, [u32; 2], bool)> = Vec::new();
    let mut x = 1u32;
    let mut below = |n: usize| {
        x = x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (x >> 8) as usize % n
    };
    for call in 0..4000 {
        if below(5) < 3 {
            let (a, b) = (below(12) as u32, below(12) as u32);
            if a != b {
                let desc = desc(a, b);
                let joint = joints.add(&desc, HERE);
                assert!(model.iter().all(|m| m.0 != joint.slot), "{call}: the slot is taken");
                model.push((joint.slot, [a, b], desc.collide));
            }
        } else if !model.is_empty() {
            let gone = model.swap_remove(below(model.len()));
            joints.remove(gone.0);
        }
        if below(20) == 0 {
            joints.compact();
            assert!(!joints.changed);
        }
        assert_eq!(joints.count, model.len());
        for body in 0..13 {
            let mut own: Vec<u32> = joints.of_body(body).collect();
            let mut expected: Vec<u32> = model.iter().filter(|m| m.1.contains(&body)).map(|m| m.0).collect();
            own.sort_unstable();
            expected.sort_unstable();
            assert_eq!(own, expected, "{call}: body {body}");
            let other = (body + 5) % 12;
            let apart = model.iter().any(|m| m.1.contains(&body) && m.1.contains(&other) && !m.2);
            assert_eq!(joints.keep_apart(body, other), body != other && apart, "{call}: {body} {other}");
        }
    }
    // Each joint has its rows once, however often its slot was used.
    joints.compact();
    for &(slot, [a, b], _) in &model {
        let of = |d: JointDesc| (d.limits.len(), d.motors.len());
        let (limits, drives) = of(desc(a, b));
        let locks = joints.locks.iter().filter(|l| l.joint == slot).count();
        let rows = joints.rows.iter().filter(|r| r.joint == slot).count();
        assert_eq!(locks + rows, limits + drives, "{slot}");
    }
    let all = joints.locks.len() + joints.rows.len();
    let expected: usize =
        model.iter().map(|m| desc(m.1[0], m.1[1])).map(|d| d.limits.len() + d.motors.len()).sum();
    assert_eq!(all, expected);
}

#[test]
fn what_limits_nothing_has_no_row() {
    let mut joints = Joints::default();
    let (low, high) = (f32::NEG_INFINITY, f32::INFINITY);
    let mut one = desc(0, 1);
    one.limits = vec![Limit::new(Motion::Linear, Axes::One(Axis::X), low, high)];
    one.motors.clear();
    joints.add(&one, HERE);
    assert_eq!((joints.locks.len(), joints.rows.len(), joints.count), (0, 0, 1));
}

#[test]
fn place_that_was_made_is_enough() {
    let mut joints = Joints::default();
    assert_eq!(joints.bytes(), (0, 0));
    for i in 0..100 {
        let desc = desc(i, i + 1).with_break_force(1.0, 1.0);
        let more = JointAdditions::of_joint(&desc);
        assert!(joints.missing(more, 1) > 0, "batches at least");
        joints.reserve_total(more);
        let reserved = joints.bytes().1;
        joints.add(&desc, HERE);
        assert_eq!(joints.bytes().1, reserved, "{i}");
    }
}
