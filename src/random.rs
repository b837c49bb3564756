//! Random numbers for unit tests, the same on every run and machine.

use glam::{Vec3, vec3};

/// A SplitMix64 generator by its state (Steele, Lea and Flood, *Fast splittable pseudorandom number
/// generators*, 2014). The same state gives the numbers of [`Rng`](crate::scene::rng::Rng), with which scenes
/// are made.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
    /// An integer in `0..n`.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }
    /// Uniform in `0..1`.
    pub(crate) fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }
    /// Uniform in `low..high`.
    pub(crate) fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }
    /// Uniform in `-1..1`.
    #[cfg(feature = "lab")]
    pub(crate) fn signed_f64(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    /// In a cube that reaches `size` along each axis, to both sides.
    pub(crate) fn cube(&mut self, size: f32) -> Vec3 {
        let mut r = || (self.unit() * 2.0 - 1.0) * size;
        vec3(r(), r(), r())
    }
}

#[test]
fn the_numbers_are_those_of_scenes() {
    let (mut random, mut rng) = (Random(7), crate::scene::rng::Rng::new(7));
    for _ in 0..10 {
        assert_eq!(random.bits(), rng.next());
        assert_eq!(random.range(2.0, 3.0), rng.range(2.0, 3.0));
    }
}
