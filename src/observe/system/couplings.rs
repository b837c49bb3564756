//! Rows of couplings, measured where the bodies are.

use super::joints::{Joined, JointRow, Source};
use super::*;
use crate::joint::{Coupling, Motion};
use std::f64::consts::TAU;

/// Calls `f` with the rows of a coupling: one if it keeps a value, else one for each end of its range.
/// Factors are divided by the greater of them, as the engine has them.
pub(super) fn each_end(slot: usize, coupling: &Coupling, joints: [&Joined; 2], f: &mut dyn FnMut(&JointRow)) {
    let scale = coupling.scale();
    let mut row = SystemRow {
        // A joint's error is an angle where the greater factor is on one.
        angle: (0..2)
            .any(|i| coupling.terms[i].motion == Motion::Angular && coupling.factors[i].abs() == scale),
        ..SystemRow::of_two([None; 2], [DVec3::ZERO; 2], [DVec3::ZERO; 2])
    };
    let (mut sum, mut coupled) = (0.0, [None; 2]);
    for (i, joint) in joints.into_iter().enumerate() {
        let term = &coupling.terms[i];
        let (direction, mut value) = joint.measure(term.motion, term.axes);
        let near = coupling.displacements[i];
        if term.motion == Motion::Angular && near.is_finite() {
            value += TAU * ((near - value) / TAU).round();
        }
        sum += coupling.factors[i] * value;
        let factor = coupling.factors[i] / scale;
        let direction = direction.map(|d| d * factor);
        coupled[i] = Some((joint.joint, direction));
        let at = &joint.at;
        let arms = [at.arm[0] + at.apart, at.arm[1]];
        add(&mut row, &joint.rigid(Source::Coupling(slot, 2), direction, arms).row);
    }
    let whole = JointRow {
        coupled,
        row,
        ..joints[0].rigid(Source::Coupling(slot, 2), [DVec3::ZERO; 2], [DVec3::ZERO; 2])
    };
    let [min, max] = coupling.range;
    if coupling.is_equality() {
        f(&JointRow { error: (sum - min) / scale, ..whole });
        return;
    }
    for (end, limit, sign) in [(0, min, 1.0), (1, max, -1.0)] {
        if !limit.is_finite() {
            continue;
        }
        let gap = sign * (sum - limit) / scale;
        let mut one = JointRow { source: Source::Coupling(slot, end), law: Law::AT_LEAST_ZERO, ..whole };
        one.row = one.row.times(sign);
        (one.gap, one.error) = (Some(gap), (-gap).max(0.0));
        f(&one);
    }
}

/// Adds a row of a joint to one of several bodies. A body that is in both has the sum.
fn add(to: &mut SystemRow, of: &SystemRow) {
    for (side, body) in of.bodies.iter().enumerate() {
        if body.is_none() {
            continue;
        }
        let own = to.bodies.iter().position(|known| known == body);
        let Some(place) = own.or_else(|| to.bodies.iter().position(Option::is_none)) else { continue };
        to.bodies[place] = *body;
        to.linear[place] += of.linear[side];
        to.angular[place] += of.angular[side];
    }
}
