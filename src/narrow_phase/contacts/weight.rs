//! The cost of leaving a contact out: if memory is short, the cheapest are shed first.
//!
//! Without a contact its bodies sink into each other. So the weight of a contact is the overlap at the end of
//! the step if it had no rows: by the predicted motions, by the load that it bore in the last step, and by a
//! part of the present overlap. All are lengths, so the load of a light body counts as much as that of a
//! heavy one, and the weight does not depend on when in the order of pairs a contact is found. Contacts that
//! nothing approaches cost nothing. Contacts that keep a body from entering something static by more than a
//! little weigh more than all others.

use super::contact::ContactRef;
use crate::body::Mass;
use crate::config::tuning::{LASTING_LOAD_WEIGHT, OVERLAP_WEIGHT, STATIC_WEIGHT};
use crate::lanes::Record;
use crate::shape::{ColliderSummary, Kind};
use glam::Vec3;

/// The weight of a contact, in steps of a sixteenth of an octave.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Weight(u16);

/// Weights of a class.
const STEPS: u16 = 256;
/// Bits of a float that a step of weight omits, and the first step: that of 2^-16 length units.
const BITS: u32 = 19;
const FIRST: u32 = (127 - 16) << 4;

impl Weight {
    /// Number of weights.
    pub(crate) const COUNT: usize = 6 * STEPS as usize;
    /// The least weight of contacts that keep approaching bodies apart, or bear a load.
    pub(crate) const NEEDED: Weight = Weight(2 * STEPS);

    /// The weight of an overlap, or a gap, at the end of the step [length units].
    fn new(is_static: bool, overlap: f32) -> Weight {
        let steps = (overlap.abs().to_bits() >> BITS).saturating_sub(FIRST).min(u32::from(STEPS) - 1) as u16;
        let class =
            u16::from(is_static) + 2 * (u16::from(overlap > 0.0) + u16::from(overlap > STATIC_WEIGHT));
        Weight(class * STEPS + if overlap > 0.0 { steps } else { STEPS - 1 - steps })
    }

    #[cfg(test)]
    pub(crate) fn nth(index: u16) -> Weight {
        Weight(index)
    }

    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// Input of weights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale<'a> {
    pub(crate) summaries: &'a [ColliderSummary],
    /// Predicted displacement and rotation vector of each body that can move.
    pub(crate) motion: &'a [Record],
    /// The masses of all bodies; those before `dynamic` can be pushed.
    pub(crate) mass: &'a [Mass],
    pub(crate) dynamic: usize,
    /// The length of a step times the number of its substeps: displacement of a unit of mass by a unit
    /// impulse of a substep [s].
    pub(crate) gain: f32,
    /// The length unit [m].
    pub(crate) unit: f32,
}

impl Scale<'_> {
    /// The weight for two colliders, given the normal in the world, the least separation [m] and the load of
    /// a substep [N s].
    pub(crate) fn weigh(&self, [a, b]: [u32; 2], normal: Vec3, separation: f32, load: f32) -> Weight {
        let body = |c: u32| self.summaries[c as usize].body as usize;
        let motion = |c: u32| self.motion.get(body(c)).copied().unwrap_or_default();
        let pushed = |c: u32| body(c) < self.dynamic;
        let inverse = |c: u32| if pushed(c) { self.mass[body(c)].inverse } else { 0.0 };
        let spin = |c: u32, turn: f32| {
            let c = &self.summaries[c as usize];
            let reach = if c.kind == Kind::Sphere { c.lever } else { c.lever + c.radius };
            if turn > 0.0 { turn * reach } else { 0.0 }
        };
        let (of_a, of_b) = (motion(a), motion(b));
        let closing =
            normal.dot(of_a.linear - of_b.linear) + spin(a, of_a.turn_angle) + spin(b, of_b.turn_angle);
        let both = pushed(a) && pushed(b);
        let apart = if both && separation < 0.0 { OVERLAP_WEIGHT * separation } else { separation };
        let held = LASTING_LOAD_WEIGHT * load * self.gain * (inverse(a) + inverse(b));
        Weight::new(!both, (closing - apart + held) / self.unit)
    }

    /// The weight of an existing contact.
    pub(crate) fn of(&self, contact: ContactRef<'_>) -> Weight {
        let nearest = contact.points().iter().map(|p| p.separation).fold(f32::INFINITY, f32::min);
        self.weigh([contact.a, contact.b], contact.frame * contact.normal, nearest, contact.bears())
    }
}

/// The lightest contacts that stay.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Threshold {
    weight: Weight,
    /// How many of exactly this weight stay, the first ones: the order of pairs lasts.
    left: u32,
}

impl Threshold {
    /// Everything stays.
    pub(crate) const ALL: Threshold = Threshold { weight: Weight(0), left: u32::MAX };

    pub(crate) fn new(index: usize, left: u32) -> Threshold {
        Threshold { weight: Weight(index as u16), left }
    }

    /// So many, the heaviest of some weights.
    pub(crate) fn of_heaviest(most: usize, weights: impl Iterator<Item = Weight>) -> Threshold {
        let mut counts = [0; Weight::COUNT];
        weights.for_each(|weight| counts[weight.index()] += 1);
        let mut left = most as u32;
        for (index, &count) in counts.iter().enumerate().rev() {
            if count > left {
                return Threshold::new(index, left);
            }
            left -= count;
        }
        Threshold::ALL
    }

    /// Whether the next contact, of this weight, stays. To be called for each in the same order.
    pub(crate) fn keeps(&mut self, weight: Weight) -> bool {
        if weight == self.weight {
            let stays = self.left > 0;
            self.left = self.left.saturating_sub(1);
            return stays;
        }
        weight > self.weight
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_grow_with_what_leaving_out_costs() {
        let overlaps = [-1.0, -0.01, -0.001, 0.001, 0.002, 0.05, 0.5];
        let weights: Vec<Weight> =
            [false, true].iter().flat_map(|&s| overlaps.map(|o| Weight::new(s, o))).collect();
        let order = |range: std::ops::Range<usize>| weights[range].is_sorted_by(|a, b| a < b);
        assert!(order(0..7) && order(7..14));
        // Contacts with static geometry that cost much weigh more than all others, and needed ones more than
        // those that are not.
        assert!(
            weights[12] > weights[6]
                && weights[6] > weights[10]
                && weights[10] > weights[3]
                && weights[3] > weights[9]
        );
        assert!(weights[9] < Weight::NEEDED && weights[3] >= Weight::NEEDED);
    }

    #[test]
    fn of_equal_weights_the_first_stay() {
        let all = [5u16, 7, 7, 5, 7, 600].map(Weight);
        let keeps = |mut floor: Threshold| all.map(|weight| floor.keeps(weight));
        assert_eq!(keeps(Threshold::new(7, 2)), [false, true, true, false, false, true]);
        assert_eq!(keeps(Threshold::new(5, 1)), [true, true, true, false, true, true]);
        assert_eq!((keeps(Threshold::ALL), keeps(Threshold::new(Weight::COUNT, 0))), ([true; 6], [false; 6]));
    }
}
