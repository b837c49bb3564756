//! Numbers of a sequence: tame ones, of which ordinary scenes are made, and now and then others.

use super::super::input::Input;
use backstop::glam::{DVec3, Quat, Vec3};

/// Which numbers a sequence has beside tame ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mood {
    Tame,
    /// Some are up to 10^6 times as large or as small.
    Extreme,
    /// Some are none, or out of any range.
    Bad,
}

const BAD: [f32; 12] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    0.0,
    -0.0,
    -1.0,
    1e-30,
    -1e30,
    1e30,
    f32::MAX,
    f32::MIN_POSITIVE,
    1e-45,
];

const FACTORS: [f32; 8] = [1e-6, 1e-4, 1e-2, 0.1, 10.0, 1e2, 1e4, 1e6];

/// Reads bytes as numbers.
pub struct Draw<'a> {
    input: Input<'a>,
    pub mood: Mood,
}

impl<'a> Draw<'a> {
    pub fn new(input: Input<'a>) -> Draw<'a> {
        Draw { input, mood: Mood::Tame }
    }

    pub fn is_empty(&self) -> bool {
        self.input.is_empty()
    }

    pub fn below(&mut self, end: usize) -> usize {
        if end <= 256 { usize::from(self.input.byte()) % end.max(1) } else { self.input.below(end) }
    }

    /// True in so many of 256 cases; false where the bytes have ended.
    pub fn chance(&mut self, of_256: u8) -> bool {
        let byte = self.input.byte();
        255 - byte < of_256
    }

    pub fn bool(&mut self) -> bool {
        self.input.bool()
    }

    pub fn of<T: Clone>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())].clone()
    }

    fn unit(&mut self) -> f32 {
        let bytes = [self.input.byte(), self.input.byte()];
        f32::from(u16::from_le_bytes(bytes)) / 65536.0
    }

    fn with_mood(&mut self, tame: f32) -> f32 {
        let other = match self.mood {
            Mood::Tame => false,
            Mood::Extreme => self.chance(10),
            Mood::Bad => self.chance(8),
        };
        match self.mood {
            Mood::Extreme if other => tame * self.of(&FACTORS),
            Mood::Bad if other => self.of(&BAD),
            _ => tame,
        }
    }

    /// Evenly in a range; its ends and its middle more often.
    pub fn range(&mut self, low: f32, high: f32) -> f32 {
        let unit = if self.chance(24) { self.of(&[0.0, 0.5, 1.0]) } else { self.unit() };
        self.with_mood(low + (high - low) * unit)
    }

    /// In a range above zero, small numbers as often as large ones.
    pub fn scale(&mut self, low: f32, high: f32) -> f32 {
        let unit = self.unit();
        self.with_mood(low + (high - low) * unit.powi(4))
    }

    /// Within so much along each axis; zero, or along an axis alone, now and then.
    pub fn vector(&mut self, most: f32) -> Vec3 {
        match self.below(8) {
            0 => Vec3::ZERO,
            1 => Vec3::Y * self.range(-most, most),
            _ => Vec3::new(self.range(-most, most), self.range(-most, most), self.range(-most, most)),
        }
    }

    /// Where something may be put: above the ground, near everything else.
    pub fn place(&mut self) -> DVec3 {
        let mut place =
            Vec3::new(self.range(-2.5, 2.5), self.range(0.0, 4.0), self.range(-2.5, 2.5)).as_dvec3();
        if self.mood == Mood::Bad && self.chance(3) {
            place.x = self.of(&[1e15, 1e30, 1e300, f64::NAN]);
        }
        if self.mood == Mood::Extreme && self.chance(3) {
            place += DVec3::splat(self.of(&[1e3, 1e5, 9e8]));
        }
        place
    }

    pub fn rotation(&mut self) -> Quat {
        if self.chance(110) {
            return Quat::IDENTITY;
        }
        if self.mood == Mood::Bad && self.chance(6) {
            return Quat::from_xyzw(0.0, 0.0, 0.0, self.of(&[0.0, 2.0, f32::NAN]));
        }
        let parts = [0; 4].map(|_| 2.0 * self.unit() - 1.0);
        let length = parts.iter().map(|part| part * part).sum::<f32>().sqrt();
        if length < 0.1 { Quat::IDENTITY } else { Quat::from_array(parts.map(|part| part / length)) }
    }

    pub fn flags(&mut self, of_256: u8) -> [bool; 3] {
        [0; 3].map(|_| self.chance(of_256))
    }

    pub fn word(&mut self) -> u64 {
        u64::from_le_bytes([0; 8].map(|_: u8| self.input.byte()))
    }
}
