//! Two shapes along many directions at once: where a deep overlap may be left by a way that is far from all
//! faces.

use super::axis::{Body, Both};
use crate::config::tuning::THROUGH_SINE;
use crate::lanes::{Lanes, Vec3 as LaneVec3, f32x8};
use crate::narrow_phase::convex::sat::offer;
use glam::Vec3;

type Eight = LaneVec3<f32x8>;

/// All directions from the middle of a grid of 5 x 5 x 5 to its outer points, a quarter of a right angle and
/// less from each other; filled up with the first.
const DIRECTIONS: [[[f32; 8]; 3]; 13] = {
    let mut all = [[[2.0; 8]; 3]; 13];
    let (mut i, mut cell) = (0, 0);
    while cell < 125 {
        let at = [cell / 25, cell / 5 % 5, cell % 5];
        let outer = at[0] % 4 == 0 || at[1] % 4 == 0 || at[2] % 4 == 0;
        if outer {
            let mut axis = 0;
            while axis < 3 {
                all[i / 8][axis][i % 8] = at[axis] as f32 - 2.0;
                axis += 1;
            }
            i += 1;
        }
        cell += 1;
    }
    all
};

/// The direction, of those more than a right angle's 0.4 away from `known`, along which the two are furthest
/// apart, and how far.
pub(super) fn best_of_many(both: &Both, known: Vec3) -> (Vec3, f32) {
    let (pose, against, known) = (&both.pose, LaneVec3::splat(both.against), LaneVec3::splat(known));
    let [x, y, z] = [pose.axes.x_axis, pose.axes.y_axis, pose.axes.z_axis].map(Eight::splat);
    let (mut best, mut at) = ((f32::MIN, 0), Vec3::Y);
    for [nx, ny, nz] in &DIRECTIONS {
        let n = LaneVec3::new(f32x8::new(*nx), f32x8::new(*ny), f32x8::new(*nz));
        let n = n * (f32x8::one() / n.length());
        let back = LaneVec3::new(x.dot(n), y.dot(n), z.dot(n)) * f32x8::splat(-1.0);
        let separation = n.dot(LaneVec3::splat(pose.position))
            - extents(&both.bodies[0], n)
            - extents(&both.bodies[1], back);
        let wrong = n.dot(against).gt(f32x8::splat(THROUGH_SINE)) | n.dot(known).gt(f32x8::splat(0.8));
        let separation = Lanes::select(wrong, f32x8::splat(f32::MIN), separation);
        if offer(&mut best, separation, 0) {
            at = n.lane(best.1);
        }
    }
    (at, best.0)
}

/// The furthest of a body along eight directions [m].
fn extents(body: &Body, d: Eight) -> f32x8 {
    match body {
        Body::Round(f) => f.extent(d),
        Body::Flat(p) => p
            .vertices
            .iter()
            .fold(f32x8::splat(f32::MIN), |most, v| Lanes::max(d.dot(LaneVec3::splat(*v)), most)),
    }
}
