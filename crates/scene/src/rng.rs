//! Seeded random numbers, the same on every machine.

use backstop::math::Quat;
use glam::Vec3;
use std::f32::consts::TAU;

/// SplitMix64 (Steele, Lea and Flood, *Fast splittable pseudorandom number generators*, 2014).
#[derive(Clone, Debug)]
pub struct Rng(u64);

/// Increment of the state from one number to the next.
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

impl Rng {
    /// With this seed.
    pub fn new(seed: u64) -> Self {
        Rng(seed)
    }

    /// The generator with seed 0 after `count` numbers.
    pub fn after(count: u64) -> Self {
        Rng(count.wrapping_mul(STEP))
    }

    /// All of 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(STEP);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in `low..high`.
    pub fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * ((self.bits() >> 40) as f32 / (1u64 << 24) as f32)
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> Vec3 {
        let (y, angle) = (self.range(-1.0, 1.0), self.range(0.0, TAU));
        let ring = (1.0 - y * y).max(0.0).sqrt();
        Vec3::new(ring * libm::cosf(angle), y, ring * libm::sinf(angle))
    }

    /// About a uniform axis, by an angle uniform in a whole turn.
    pub fn rotation(&mut self) -> Quat {
        self.small_rotation(TAU)
    }

    /// About a uniform axis, by an angle uniform in `0..limit`.
    pub fn small_rotation(&mut self, limit: f32) -> Quat {
        let axis = self.direction();
        axis_angle(axis, self.range(0.0, limit))
    }
}

/// As glam's `from_axis_angle`, with sine and cosine that are the same on every machine.
pub fn axis_angle(axis: Vec3, angle: f32) -> Quat {
    let v = axis * libm::sinf(angle * 0.5);
    Quat::from_xyzw(v.x, v.y, v.z, libm::cosf(angle * 0.5))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_generator_gives_the_published_numbers() {
        // First outputs of SplitMix64 with seed 1234567, as in the author's reference code.
        let mut rng = Rng::new(1_234_567);
        assert_eq!(rng.bits(), 6_457_827_717_110_365_317);
        assert_eq!(rng.bits(), 3_203_168_211_198_807_973);
    }

    #[test]
    fn the_numbers_are_those_of_tests() {
        let (mut random, mut rng) = (crate::random::Random(7), Rng::new(7));
        for _ in 0..10 {
            assert_eq!(random.bits(), rng.bits());
            assert_eq!(random.range(2.0, 3.0), rng.range(2.0, 3.0));
        }
    }

    #[test]
    fn directions_and_rotations_have_unit_length() {
        let mut rng = Rng::new(1);
        for _ in 0..1000 {
            assert!((rng.direction().length() - 1.0).abs() < 1e-6);
            assert!((rng.rotation().length() - 1.0).abs() < 1e-6);
        }
    }
}
