//! Seeded random numbers and uneven ground for unit tests, benches and, as a file of theirs, `tests/` and
//! `examples/`: the same on every machine and in every run.
#![allow(dead_code, reason = "each user has a use for a part of it")]

use glam::{DVec3, Vec3};

/// SplitMix64 (Steele, Lea and Flood, *Fast splittable pseudorandom number generators*, 2014), by its state:
/// the numbers of the `Rng` with which scenes are made.
#[derive(Clone, Debug)]
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// All of 64 bits.
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// In `0..n`; 0 where there is nothing to choose from.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.bits() % n.max(1) as u64) as usize
    }

    /// One of a list that is not empty.
    pub(crate) fn of<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }

    /// One of a list; none of an empty one.
    pub(crate) fn some_of<T: Copy>(&mut self, list: &[T]) -> Option<T> {
        list.get(self.below(list.len())).copied()
    }

    /// True as often as `probability` says.
    pub(crate) fn chance(&mut self, probability: f32) -> bool {
        self.unit() < probability
    }

    /// Uniform in `0.0..1.0`.
    pub(crate) fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// Uniform in `-1.0..1.0`.
    pub(crate) fn signed(&mut self) -> f32 {
        self.range(-1.0, 1.0)
    }

    /// Uniform in `low..high`.
    pub(crate) fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// Uniform in `0.0..1.0`, by Knuth's linear congruential generator (MMIX) on the same state: for tests
    /// whose bounds are known for its numbers.
    pub(crate) fn congruential(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    /// As [`Random::range`], with all the bits of `f64`.
    pub(crate) fn range64(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1u64 << 53) as f64)
    }

    /// Uniform in magnitude.
    pub(crate) fn log_range(&mut self, low: f32, high: f32) -> f32 {
        libm::expf(self.range(libm::logf(low), libm::logf(high)))
    }

    /// Uniform in a cube that reaches to 1 along each axis, to both sides.
    pub(crate) fn cube(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }

    pub(crate) fn cube64(&mut self) -> DVec3 {
        DVec3::new(self.range64(-1.0, 1.0), self.range64(-1.0, 1.0), self.range64(-1.0, 1.0))
    }

    /// Uniform on the unit sphere.
    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.cube();
            if (0.1..1.0).contains(&v.length()) {
                return v.normalize();
            }
        }
    }

    /// As [`Random::direction`], with all the bits of `f64`.
    pub(crate) fn direction64(&mut self) -> DVec3 {
        loop {
            let v = self.cube64();
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }

    /// Any rotation, not evenly.
    pub(crate) fn rotation(&mut self) -> glam::Quat {
        // By hand: glam sums in another order on each instruction set.
        let q = self.cube().extend(self.range(0.01, 1.0)).to_array();
        let scale = 1.0 / q.iter().map(|part| part * part).sum::<f32>().sqrt();
        glam::Quat::from_array(q.map(|part| part * scale))
    }
}

/// Uneven ground around the origin, `cells` by `cells` squares of side `cell` [m]: vertices, and triangles
/// counter-clockwise seen from above.
pub(crate) fn bumps(cells: u32, cell: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let row = cells + 1;
    let at = |n: u32| n as f32 * cell - cells as f32 * cell * 0.5;
    let vertex = |n: u32| {
        let (x, z) = (at(n % row), at(n / row));
        let hills = 1.5 * libm::sinf(0.35 * x) * libm::cosf(0.27 * z);
        let bumps = 0.5 * libm::sinf(0.9 * x + 1.3) * libm::sinf(1.1 * z + 0.7);
        let ridge = 1.0 - libm::sinf(0.21 * x + 0.13 * z).abs();
        Vec3::new(x, hills + bumps + 1.5 * (ridge * ridge * ridge), z)
    };
    let square = |n: u32| {
        let corner = n / cells * row + n % cells;
        let [a, b, c, d] = [corner, corner + 1, corner + row, corner + row + 1];
        [[a, c, b], [b, c, d]]
    };
    ((0..row * row).map(vertex).collect(), (0..cells * cells).flat_map(square).collect())
}
