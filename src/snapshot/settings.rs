//! Settings: all that results depend on are kept. Threads and the budget belong to the machine and stay as
//! they are.

use crate::config::Order;
use crate::config::{Continuous, ContinuousMethod, FrictionCone, FrictionModel, Settings};
use crate::error::Error;
use crate::joint::{group_code, group_of};
use crate::words::{Reader, broken};
use glam::Vec3;

fn flag(bits: u32, i: u32) -> bool {
    bits >> i & 1 != 0
}

const FLAGS: usize = 7;

/// Writes settings.
pub(super) fn save(s: &Settings, out: &mut Vec<u32>) {
    let flags: [bool; FLAGS] = [
        s.friction_cone == FrictionCone::Box,
        s.friction_model == FrictionModel::Point,
        s.warm_starting,
        s.recycling,
        s.sleeping,
        !s.joint_trees,
        !s.guard,
    ];
    // Mode and method share a word.
    out.extend([s.substeps, s.iterations, s.continuous as u32 | (s.method as u32) << 8]);
    out.push(flags.iter().rev().fold(0, |bits, &set| bits << 1 | u32::from(set)));
    let numbers = [
        s.gravity.x,
        s.gravity.y,
        s.gravity.z,
        s.length_unit,
        s.restitution_threshold,
        s.slop,
        s.contact_hertz,
        s.contact_damping,
        s.push_speed,
        s.sleep_speed,
        s.sleep_time,
        s.hit_speed,
    ];
    out.extend(numbers.map(f32::to_bits));
    out.push(s.event_capacity);
    out.push(s.order.0.iter().rev().fold(0, |all, &group| all << 4 | group_code(Some(group))));
}

/// Reads settings; threads and budget are those of `own`.
pub(super) fn read(from: &mut Reader<'_>, own: &Settings) -> Result<Settings, Error> {
    let [substeps, iterations, mode, flags]: [u32; 4] = from.record::<_, 4>()?;
    let n: [f32; 12] = from.record::<_, 12>()?;
    let [event_capacity, order]: [u32; 2] = from.record::<_, 2>()?;
    if flags >> FLAGS != 0 || order >> (4 * Order::default().0.len()) != 0 {
        return Err(broken("a flag of settings"));
    }
    let (continuous, method) = (mode_of(mode & 0xFF)?, method_of(mode >> 8)?);
    let mut groups = Order::default().0;
    for (i, group) in groups.iter_mut().enumerate() {
        *group = group_of(order >> (4 * i) & 15)?.ok_or_else(|| broken("the order of rows"))?;
    }
    let settings = Settings {
        gravity: Vec3::new(n[0], n[1], n[2]),
        substeps,
        iterations,
        threads: own.threads,
        continuous,
        method,
        friction_cone: if flag(flags, 0) { FrictionCone::Box } else { FrictionCone::Cone },
        friction_model: if flag(flags, 1) { FrictionModel::Point } else { FrictionModel::Patch },
        length_unit: n[3],
        restitution_threshold: n[4],
        slop: n[5],
        contact_hertz: n[6],
        contact_damping: n[7],
        push_speed: n[8],
        warm_starting: flag(flags, 2),
        recycling: flag(flags, 3),
        joint_trees: !flag(flags, 5),
        guard: !flag(flags, 6),
        order: Order(groups),
        sleeping: flag(flags, 4),
        sleep_speed: n[9],
        sleep_time: n[10],
        hit_speed: n[11],
        event_capacity,
        budget: own.budget,
    };
    settings.validate()?;
    Ok(settings)
}

/// A mode by its number.
pub(super) fn mode_of(code: u32) -> Result<Continuous, Error> {
    let all = [Continuous::Discrete, Continuous::Segment, Continuous::Volume];
    all.into_iter().find(|&mode| mode as u32 == code).ok_or_else(|| broken("a mode"))
}

fn method_of(code: u32) -> Result<ContinuousMethod, Error> {
    use ContinuousMethod::{ConservativeAdvancement, LinearCast, OnePass, Speculative, Talk};
    let all = [OnePass, Speculative, LinearCast, ConservativeAdvancement, Talk];
    all.into_iter().find(|&method| method as u32 == code).ok_or_else(|| broken("a method"))
}
