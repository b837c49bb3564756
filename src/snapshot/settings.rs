//! Settings: all that results depend on are kept. Threads and the budget belong to the machine and stay as
//! they are.

use crate::config::{ContinuousMethod, ContinuousMode, FrictionCone, FrictionModel, Settings};
use crate::error::Error;
use crate::joint::{group_code, group_of};
use crate::words::{Reader, broken};
use glam::Vec3;

/// Numbers and flags, each at its place in the format.
type Numbers = [fn(&mut Settings) -> &mut f32; 9];
const NUMBERS: Numbers = [
    |s| &mut s.length_unit,
    |s| &mut s.restitution_threshold,
    |s| &mut s.slop,
    |s| &mut s.contact_hertz,
    |s| &mut s.contact_damping,
    |s| &mut s.push_speed,
    |s| &mut s.sleep_speed,
    |s| &mut s.sleep_time,
    |s| &mut s.hit_speed,
];
/// A flag, and whether its bit is set where it is not.
type Flag = (fn(&mut Settings) -> &mut bool, bool);
const FLAGS: [Flag; 5] = [
    (|s| &mut s.warm_starting, false),
    (|s| &mut s.recycling, false),
    (|s| &mut s.sleeping, false),
    (|s| &mut s.joint_trees, true),
    (|s| &mut s.guard, true),
];
/// Flags come after friction cone and model.
const FIRST: usize = 2;

/// Writes settings.
pub(super) fn save(settings: &Settings, out: &mut Vec<u32>) {
    let s = &mut settings.clone();
    // Mode and method share a word.
    out.extend([s.substeps, s.iterations, s.continuous as u32 | (s.continuous_method as u32) << 8]);
    let friction = s.friction_cone as u32 | (s.friction_model as u32) << 1;
    let flag = |(i, (of, inverse)): (usize, Flag)| u32::from(*of(s) != inverse) << (FIRST + i);
    out.push(FLAGS.into_iter().enumerate().map(flag).fold(friction, |bits, bit| bits | bit));
    out.extend(s.gravity.to_array().map(f32::to_bits));
    out.extend(NUMBERS.map(|of| of(s).to_bits()));
    out.push(s.event_capacity);
    out.push(s.order.0.iter().rev().fold(0, |all, &group| all << 4 | group_code(Some(group))));
}

/// Reads settings; threads and budget are those of `own`.
pub(super) fn read(from: &mut Reader<'_>, own: &Settings) -> Result<Settings, Error> {
    let [substeps, iterations, mode, flags]: [u32; 4] = from.record::<_, 4>()?;
    let gravity = from.record::<Vec3, 3>()?;
    let numbers: [f32; NUMBERS.len()] = from.record::<_, 9>()?;
    let [event_capacity, order]: [u32; 2] = from.record::<_, 2>()?;
    let mut s = Settings { gravity, substeps, iterations, event_capacity, ..own.clone() };
    if flags >> (FIRST + FLAGS.len()) != 0 || order >> (4 * s.order.0.len()) != 0 {
        return Err(broken("a flag of settings"));
    }
    (s.continuous, s.continuous_method) = (mode_of(mode & 0xFF)?, method_of(mode >> 8)?);
    let set = |i: usize| flags >> i & 1 != 0;
    s.friction_cone = if set(0) { FrictionCone::Box } else { FrictionCone::Cone };
    s.friction_model = if set(1) { FrictionModel::Point } else { FrictionModel::Patch };
    NUMBERS.iter().zip(numbers).for_each(|(of, number)| *of(&mut s) = number);
    FLAGS.iter().enumerate().for_each(|(i, (of, inverse))| *of(&mut s) = set(FIRST + i) != *inverse);
    for (i, group) in s.order.0.iter_mut().enumerate() {
        *group = group_of(order >> (4 * i) & 15)?.ok_or_else(|| broken("the order of rows"))?;
    }
    s.validate()?;
    Ok(s)
}

/// A mode by its number.
pub(super) fn mode_of(code: u32) -> Result<ContinuousMode, Error> {
    let all = [ContinuousMode::Discrete, ContinuousMode::Segment, ContinuousMode::Volume];
    all.into_iter().find(|&mode| mode as u32 == code).ok_or_else(|| broken("a mode"))
}

fn method_of(code: u32) -> Result<ContinuousMethod, Error> {
    use ContinuousMethod::{ConservativeAdvancement, LinearCast, OnePass, Speculative, Talk};
    let all = [OnePass, Speculative, LinearCast, ConservativeAdvancement, Talk];
    all.into_iter().find(|&method| method as u32 == code).ok_or_else(|| broken("a method"))
}
