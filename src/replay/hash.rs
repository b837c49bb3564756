//! Hashes of bits.

use crate::math::Quat;
use glam::{DVec3, Vec3};

/// Takes words and gives a number that differs if a bit of any of them does: each word goes through a
/// bijection of the state.
#[derive(Clone, Copy)]
pub(super) struct Hash(u64);

impl Hash {
    pub(super) fn new() -> Hash {
        Hash(0x9E37_79B9_7F4A_7C15)
    }
    #[inline]
    pub(super) fn word(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        self.0 ^= self.0 >> 29;
    }
    #[inline]
    pub(super) fn pair(&mut self, a: u32, b: u32) {
        self.word(u64::from(a) << 32 | u64::from(b));
    }
    #[inline]
    pub(super) fn number(&mut self, x: f32) {
        self.word(x.to_bits().into());
    }
    #[inline]
    pub(super) fn vector(&mut self, v: Vec3) {
        self.pair(v.x.to_bits(), v.y.to_bits());
        self.number(v.z);
    }
    /// Two halves of one word.
    #[inline]
    pub(super) fn vectors(&mut self, a: Vec3, b: Vec3) {
        self.pair(a.x.to_bits(), a.y.to_bits());
        self.pair(a.z.to_bits(), b.x.to_bits());
        self.pair(b.y.to_bits(), b.z.to_bits());
    }
    #[inline]
    pub(super) fn place(&mut self, position: DVec3, rotation: Quat) {
        position.to_array().into_iter().for_each(|x| self.word(x.to_bits()));
        let [x, y, z, w] = rotation.to_array().map(f32::to_bits);
        self.pair(x, y);
        self.pair(z, w);
    }
    pub(super) fn bytes(&mut self, bytes: &[u8]) {
        for eight in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..eight.len()].copy_from_slice(eight);
            self.word(u64::from_le_bytes(word));
        }
        self.word(bytes.len() as u64);
    }

    pub(super) fn long(self) -> u64 {
        let h = (self.0 ^ self.0 >> 32).wrapping_mul(0x94D0_49BB_1331_11EB);
        h ^ h >> 31
    }
    pub(super) fn middle(self) -> u32 {
        (self.long() >> 32) as u32
    }
    pub(super) fn short(self) -> u16 {
        (self.long() >> 48) as u16
    }
}
