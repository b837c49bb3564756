//! Numbers for unit tests, the same on every run.

use glam::{Vec3, vec3};

/// A linear congruential generator (Knuth's MMIX), by its state.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// In 0..1.
    pub(crate) fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }
    /// In a cube that reaches so far along each axis.
    pub(crate) fn cube(&mut self, size: f32) -> Vec3 {
        let mut r = || (self.unit() * 2.0 - 1.0) * size;
        vec3(r(), r(), r())
    }
}
