//! How far colliders have moved, by which the narrow phase passes over pairs that can't have met.

use super::Pose;

/// Odometer of a collider, in ticks, modulo 2^32.
///
/// If two shapes were apart by more than a contact needs, they still are as long as both odometers together
/// have gone up by less than that. Pairs keep 16 of the 32 bits ([`reading`]), so compared readings have to
/// be less than 32 length units apart: greater differences count as [`MOST`], and such a pair is tested in
/// each step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Odometer {
    /// At the start of the step.
    now: u32,
    /// The most that it may be at its end.
    ahead: u32,
}

// Rounding: finer than a pair's readings, which have 64 units in 16 bits.
/// Ticks a length unit.
const UNIT: f32 = 262_144.0;
// Guard: an eighth of the range of readings.
/// The most that counts as known [length units].
const MOST: f32 = 4.0;
/// More than any known motion: for bodies that were put elsewhere, if the step does not move them.
const JUMP: u32 = 8 << 18;
/// Bits that a [`reading`] leaves out.
const FINE: u32 = 8;
// Rounding: of distances.
/// Share of a distance, and length units, that count as not there.
const ROUNDING: (f32, f32) = (1e-3, 1e-4);

/// Ticks of a length, rounded up. `length`: in length units.
#[inline(always)]
fn ticks(length: f32) -> u32 {
    // NaN counts as the greatest distance.
    let ticks = if length < MOST { length * UNIT } else { MOST * UNIT };
    let whole = ticks as u32;
    whole + u32::from((whole as f32) < ticks)
}

impl Odometer {
    /// Begins a step, at whose start the collider has come from one pose to another, and in which it may move
    /// so far [m]. `per_metre`: length units a metre.
    #[inline(always)]
    pub(crate) fn advance(&mut self, [old, new]: [&Pose; 2], radius: f32, motion: f32, per_metre: f32) {
        let travel = (new.position - old.position).as_vec3().length();
        // The chord of a point is twice the sine of half the angle; twice the distance of two unit
        // quaternions is more than that, and costs no product.
        let [x, y, z, w] = new.rotation.to_array();
        let [i, j, k, l] = old.rotation.to_array();
        let apart = [x - i, y - j, z - k, w - l].map(|d| d * d);
        let chord = 2.0 * ((apart[0] + apart[1]) + (apart[2] + apart[3])).sqrt();
        let travel = if chord > 0.0 { travel + chord * radius } else { travel };
        let jumped = self.ahead.wrapping_sub(self.now) == JUMP;
        self.now = self.now.wrapping_add(if jumped { ticks(MOST) } else { ticks(travel * per_metre) });
        self.ahead = self.now.wrapping_add(ticks(motion * per_metre));
    }

    /// Says that the collider was put elsewhere.
    pub(crate) fn jump(&mut self) {
        self.ahead = self.now.wrapping_add(JUMP);
    }
}

/// The reading of two odometers up to which their shapes are out of reach of each other, if they are further
/// apart than that by `spare` at the start of the step [length units]. Zero if that is next to nothing.
#[inline(always)]
pub(crate) fn reading(a: Odometer, b: Odometer, spare: f32) -> u16 {
    let spare = spare * (1.0 - ROUNDING.0) - ROUNDING.1;
    if spare.is_nan() || spare <= 0.0 {
        return 0;
    }
    let spare = (spare.min(MOST) * UNIT) as u32;
    let limit = (a.now.wrapping_add(b.now).wrapping_add(spare) >> FINE) as u16;
    // Zero has a meaning of its own.
    if limit == 0 { u16::MAX } else { limit }
}

/// Whether two shapes are out of reach of each other up to the end of the step.
#[inline(always)]
pub(crate) fn out_of_reach(a: Odometer, b: Odometer, reading: u16) -> bool {
    let end = (a.ahead.wrapping_add(b.ahead) >> FINE) as u16;
    reading != 0 && (reading.wrapping_sub(end) as i16) > 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Quat;
    use crate::random::Random;
    use glam::{DVec3, Vec3};

    /// Two points on a line. Whenever a step passes over them, they have to be further apart than the reach
    /// of their motion, after any earlier motion: slow, fast, or a jump.
    #[test]
    fn what_is_passed_over_is_out_of_reach() {
        let mut random = Random(5);
        let (mut passed, mut looks) = (0, 0);
        for _ in 0..400 {
            let mut odometers = [Odometer::default(); 2];
            let mut at = [0.0f64, f64::from(random.range(0.5, 40.0))];
            let mut limit = 0;
            let speed = [1e-6, 1e-4, 1e-2, 0.1, 1.0, 10.0][random.below(6)];
            for step in 0..500 {
                let motion = [0, 1].map(|_| random.range(-speed, speed));
                for i in 0..2 {
                    let pose = |x: f64| Pose { position: DVec3::X * x, rotation: Quat::IDENTITY };
                    // The predicted motion, and a small error.
                    let to = at[i] + f64::from(motion[i] * random.range(0.5, 1.2));
                    odometers[i].advance([&pose(at[i]), &pose(to)], 1.0, motion[i].abs(), 1.0);
                    at[i] = to;
                    if step % 97 == 96 {
                        at[i] += f64::from(random.range(-30.0, 30.0));
                        (0..random.range(1.0, 40.0) as usize).for_each(|_| odometers[i].jump());
                    }
                }
                let [a, b] = odometers;
                let reach = motion.map(f32::abs).iter().sum::<f32>();
                let gap = (at[1] - at[0]).abs() as f32;
                if out_of_reach(a, b, limit) {
                    passed += 1;
                    assert!(gap > reach, "{gap} m apart, within {reach} m");
                } else {
                    looks += 1;
                    limit = reading(a, b, gap);
                }
            }
        }
        assert!(passed > 2 * looks, "{passed} passed over, {looks} looked at");
    }

    /// The path of a point of a shape that turns, by any angle and about any axis.
    #[test]
    fn a_turn_counts_for_as_much_as_it_moves_points() {
        let mut random = Random(8);
        for _ in 0..2000 {
            let turn = |v: Vec3| Quat::from_xyzw(v.x, v.y, v.z, 1.0).normalize();
            let [from, by] = [10.0, 10f32.powi(-(random.below(6) as i32))].map(|s| turn(random.cube() * s));
            let pose = |rotation: Quat| Pose { position: DVec3::ZERO, rotation };
            let mut odometer = Odometer::default();
            odometer.advance([&pose(from), &pose(by * from)], 0.5, 0.0, 1.0);
            let point = random.direction() * 0.5;
            let way = ((by * from) * point - from * point).length();
            let counted = odometer.now as f32 / UNIT;
            assert!(counted >= way - 1e-6, "{counted} m for {way} m");
        }
    }

    #[test]
    fn what_is_no_number_is_looked_at() {
        let mut a = Odometer::default();
        let there = Pose { position: DVec3::ZERO, rotation: Quat::IDENTITY };
        a.advance([&there, &there], f32::INFINITY, f32::NAN, 1.0);
        assert!(!out_of_reach(a, Odometer::default(), reading(a, Odometer::default(), 3.0)));
        assert_eq!(reading(a, a, f32::NAN), 0);
        assert_eq!(reading(a, a, f32::NEG_INFINITY), 0);
        a.advance([&there, &there], f32::INFINITY, 0.0, 1.0);
        assert!(out_of_reach(a, a, reading(a, a, f32::INFINITY)));
    }
}
