//! The fewest calls of a sequence that still go wrong in the same way.

use super::call::{Call, Sequence, Ways};
use super::judge::{Finding, judge};
use backstop::{Budget, ContinuousMethod, ContinuousMode, FrictionCone, FrictionModel, Settings};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Each sets a part of the settings to what is usual.
const USUAL: [fn(&mut Settings); 14] = [
    |s| (s.substeps, s.iterations) = (4, 1),
    |s| s.iterations = 1,
    |s| s.budget = Budget::NONE,
    |s| s.sleeping = false,
    |s| s.sleep_time = 0.5,
    |s| s.joint_trees = true,
    |s| (s.warm_starting, s.recycling, s.guard) = (true, true, true),
    |s| s.continuous = ContinuousMode::Segment,
    |s| s.continuous_method = ContinuousMethod::OnePass,
    |s| (s.friction_cone, s.friction_model) = (FrictionCone::Cone, FrictionModel::Patch),
    |s| s.gravity = Settings::default().gravity,
    |s| s.order = Settings::default().order,
    |s| (s.length_unit, s.hit_speed, s.event_capacity) = (1.0, 1.0, 4096),
    |s| {
        let usual = Settings::default();
        (s.restitution_threshold, s.slop, s.push_speed) =
            (usual.restitution_threshold, usual.slop, usual.push_speed);
        (s.contact_hertz, s.contact_damping) = (usual.contact_hertz, usual.contact_damping);
    },
];

/// Judges a sequence; a panic is a finding too, of the kind that `last_panic` says.
pub fn outcome(sequence: &Sequence, last_panic: &dyn Fn() -> String) -> Option<Finding> {
    match catch_unwind(AssertUnwindSafe(|| judge(sequence))) {
        Ok(outcome) => outcome.err(),
        Err(payload) => {
            let text = payload.downcast_ref::<String>().cloned();
            let text = text.or_else(|| payload.downcast_ref::<&str>().map(|&text| text.to_owned()));
            Some(Finding { kind: format!("panic {}", last_panic()), text: text.unwrap_or_default() })
        }
    }
}

/// Leaves out and shortens calls as long as the finding is of the same kind.
pub fn shrink(sequence: &Sequence, kind: &str, last_panic: &dyn Fn() -> String) -> Sequence {
    let fails =
        |sequence: &Sequence| outcome(sequence, last_panic).is_some_and(|finding| finding.kind == kind);
    let mut least = sequence.clone();
    loop {
        let before = format!("{least:?}").len();
        leave_out(&mut least, &fails);
        simplify(&mut least, &fails);
        if format!("{least:?}").len() >= before {
            return least;
        }
    }
}

fn leave_out(least: &mut Sequence, fails: &dyn Fn(&Sequence) -> bool) {
    let mut many = least.calls.len().div_ceil(2);
    while many > 0 {
        let mut from = 0;
        while from < least.calls.len() {
            let mut less = least.clone();
            less.calls.drain(from..(from + many).min(less.calls.len()));
            if fails(&less) { *least = less } else { from += many }
        }
        many /= 2;
    }
}

fn simplify(least: &mut Sequence, fails: &dyn Fn(&Sequence) -> bool) {
    let mut attempt = |change: &dyn Fn(&mut Sequence)| {
        let mut other = least.clone();
        change(&mut other);
        if fails(&other) {
            *least = other;
        }
        least.clone()
    };
    attempt(&|s| s.settings = Settings::default());
    USUAL.iter().for_each(|usual| drop(attempt(&|s| usual(&mut s.settings))));
    let now = attempt(&|s| s.strict = false);
    for i in 0..now.calls.len() {
        match now.calls[i].1.clone() {
            Call::Step { dt, times, hooks } => {
                for fewer in [times / 2, times.saturating_sub(1)].into_iter().filter(|&n| n > 0 && n < times)
                {
                    attempt(&|s| s.calls[i].1 = Call::Step { dt, times: fewer, hooks });
                }
                attempt(&|s| {
                    if let Call::Step { dt, hooks, .. } = &mut s.calls[i].1 {
                        (*dt, *hooks) = (1.0 / 60.0, None);
                    }
                });
            }
            Call::Save(Ways { same, fresh, other })
                if u8::from(same) + u8::from(fresh) + u8::from(other) > 1 =>
            {
                for only in 0..3 {
                    let ways = Ways { same: only == 0, fresh: only == 1, other: only == 2 };
                    attempt(&|s| s.calls[i].1 = Call::Save(ways));
                }
            }
            Call::Twice(steps) if steps > 1 => drop(attempt(&|s| s.calls[i].1 = Call::Twice(steps - 1))),
            Call::AddBody(id, body) => {
                for kept in 0..body.shapes.len() {
                    let mut less = body.clone();
                    less.shapes.remove(kept);
                    attempt(&|s| s.calls[i].1 = Call::AddBody(id, less.clone()));
                }
            }
            Call::AddJoint(id, joint) => {
                let mut less = joint.clone();
                less.desc.motors.clear();
                attempt(&|s| s.calls[i].1 = Call::AddJoint(id, less.clone()));
            }
            _ => {}
        }
    }
}
