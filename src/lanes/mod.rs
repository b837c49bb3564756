//! The SIMD vocabulary: the operations a kernel may use, at one, four or eight lanes.
//!
//! A kernel is written once, generic over [`Lanes`]; the caller's loop fixes the width. Only exact,
//! ordered operations are offered (no fused multiply-add, no approximate reciprocal or root), so that
//! a lane computes the same bits at any width and on any instruction set. All `cfg` by instruction set
//! stays in this folder.
//!
//! Which instructions eight lanes take is chosen when the program runs: [`with_best!`] names the type of
//! lanes for the processor, and [`Lanes::run`] enters code that is compiled for it.

#[cfg(all(target_arch = "x86_64", not(target_feature = "avx2"), not(backstop_baseline)))]
mod avx2;
mod bits;
mod gather;
mod kernel;
mod math;

#[cfg(all(target_arch = "x86_64", not(target_feature = "avx2"), not(backstop_baseline)))]
pub(crate) use avx2::{Avx8, has_avx2};
pub(crate) use bits::ones;
pub(crate) use gather::{GatherLanes, Record, gather, is_within, scatter};
pub(crate) use kernel::{Kernel, kernel, with_best};
pub(crate) use math::{Mat3, Quat, Sym3, Vec3, turned};
pub(crate) use wide::{f32x4, f32x8, f64x4};

use std::fmt::Debug;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Not, Sub, SubAssign};

/// Which lanes a condition holds in.
pub(crate) trait Mask:
    Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// The value per lane: lane `i` holds if bit `i` is set.
    fn from_bits(bits: u32) -> Self;
    /// Bit `i` is set where lane `i` holds.
    fn bits(self) -> u32;
    /// Whether any lane holds.
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }
}

/// `N` floats that are worked on at once.
///
/// `max(a, b)` is `a > b ? a : b` and `min(a, b)` is `a < b ? a : b`, to the bit, on every target: with a
/// NaN on either side, or two zeros of any sign, the answer is `b`.
pub(crate) trait Lanes:
    'static
    + Copy
    + Debug
    + Default
    + bytemuck::Zeroable
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// How many lanes.
    const N: usize;
    /// The answer of a comparison.
    type Mask: Mask;

    fn splat(value: f32) -> Self;
    /// Lane `i` from `f(i)`.
    fn from_fn(f: impl FnMut(usize) -> f32) -> Self;
    /// The first `N` floats of a slice that has at least as many.
    fn load(from: &[f32]) -> Self;
    #[allow(dead_code, reason = "part of the vocabulary; tests use it")]
    fn store(self, to: &mut [f32]);
    fn lane(self, i: usize) -> f32;
    /// All lanes, of which there are at most eight; zeros beyond.
    #[inline(always)]
    fn eight(self) -> [f32; 8] {
        let mut all = [0.0; 8];
        self.store(&mut all);
        all
    }
    fn set_lane(&mut self, i: usize, value: f32);
    fn abs(self) -> Self;
    fn sqrt(self) -> Self;
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn lt(self, other: Self) -> Self::Mask;
    fn le(self, other: Self) -> Self::Mask;
    fn gt(self, other: Self) -> Self::Mask;
    fn ge(self, other: Self) -> Self::Mask;
    fn eq(self, other: Self) -> Self::Mask;
    /// The power of two at or below a value above zero; zero of one below the normal numbers.
    fn power_of_two(self) -> Self;
    /// `yes` in the lanes of `mask`, `no` in the others.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Runs a kernel that computes with these lanes, as it is compiled for their instructions.
    #[inline(never)]
    fn run<K: Kernel>(kernel: K) -> K::Output {
        kernel.run()
    }
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }
    #[inline(always)]
    fn one() -> Self {
        Self::splat(1.0)
    }
    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }
    /// 1 or -1 with the sign of the value; 1 for either zero.
    #[inline(always)]
    fn sign(self) -> Self {
        Self::select(self.lt(Self::zero()), Self::splat(-1.0), Self::one())
    }
}

impl Mask for bool {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        bits & 1 != 0
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        self as u32
    }
}

impl Lanes for f32 {
    const N: usize = 1;
    type Mask = bool;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        value
    }
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> f32) -> Self {
        f(0)
    }
    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        from[0]
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        to[0] = self;
    }
    #[inline(always)]
    fn lane(self, _: usize) -> f32 {
        self
    }
    #[inline(always)]
    fn set_lane(&mut self, _: usize, value: f32) {
        *self = value;
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f32::abs(self)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        f32::from_bits(self.to_bits() & f32::INFINITY.to_bits())
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn gt(self, other: Self) -> bool {
        self > other
    }
    #[inline(always)]
    fn ge(self, other: Self) -> bool {
        self >= other
    }
    #[inline(always)]
    fn eq(self, other: Self) -> bool {
        self == other
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
}

/// A mask of a `wide` float: all bits of a lane are set, or none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bits<F>(F);

macro_rules! wide_lanes {
    ($float:ty, $n:literal, $blends:expr $(, $run:item)?) => {
        impl BitAnd for Bits<$float> {
            type Output = Self;
            #[inline(always)]
            fn bitand(self, other: Self) -> Self {
                Bits(self.0 & other.0)
            }
        }
        impl BitOr for Bits<$float> {
            type Output = Self;
            #[inline(always)]
            fn bitor(self, other: Self) -> Self {
                Bits(self.0 | other.0)
            }
        }
        impl Not for Bits<$float> {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Bits(!self.0)
            }
        }
        impl Mask for Bits<$float> {
            #[inline(always)]
            fn from_bits(bits: u32) -> Self {
                let mut lanes = [0.0f32; $n];
                for (i, lane) in lanes.iter_mut().enumerate() {
                    *lane = f32::from_bits(0u32.wrapping_sub(bits >> i & 1));
                }
                Bits(<$float>::new(lanes))
            }
            #[inline(always)]
            fn bits(self) -> u32 {
                self.0.to_bitmask() as u32
            }
        }
        impl Lanes for $float {
            const N: usize = $n;
            type Mask = Bits<$float>;
            $($run)?

            #[inline(always)]
            fn splat(value: f32) -> Self {
                <$float>::splat(value)
            }
            #[inline(always)]
            fn from_fn(mut f: impl FnMut(usize) -> f32) -> Self {
                // `array::from_fn` is not always inlined.
                let mut lanes = [0.0; Self::N];
                lanes.iter_mut().enumerate().for_each(|(i, lane)| *lane = f(i));
                <$float>::new(lanes)
            }
            #[inline(always)]
            fn load(from: &[f32]) -> Self {
                let mut lanes = [0.0; $n];
                lanes.copy_from_slice(&from[..$n]);
                <$float>::new(lanes)
            }
            #[inline(always)]
            fn store(self, to: &mut [f32]) {
                to[..$n].copy_from_slice(&self.to_array());
            }
            #[inline(always)]
            fn lane(self, i: usize) -> f32 {
                self.to_array()[i]
            }
            #[inline(always)]
            fn set_lane(&mut self, i: usize, value: f32) {
                self.as_mut_array()[i] = value;
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <$float>::abs(self)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                <$float>::sqrt(self)
            }
            #[inline(always)]
            fn power_of_two(self) -> Self {
                // Infinity has all bits of the exponent and no other.
                self & <$float>::splat(f32::INFINITY)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                // On x86 `fast_min` is `minps`, which is this definition; elsewhere it need not be.
                if cfg!(any(target_arch = "x86", target_arch = "x86_64")) {
                    self.fast_min(other)
                } else {
                    <Self as Lanes>::select(Lanes::lt(self, other), self, other)
                }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if cfg!(any(target_arch = "x86", target_arch = "x86_64")) {
                    self.fast_max(other)
                } else {
                    <Self as Lanes>::select(Lanes::gt(self, other), self, other)
                }
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Self::Mask {
                Bits(self.simd_lt(other))
            }
            #[inline(always)]
            fn le(self, other: Self) -> Self::Mask {
                Bits(self.simd_le(other))
            }
            #[inline(always)]
            fn gt(self, other: Self) -> Self::Mask {
                Bits(self.simd_gt(other))
            }
            #[inline(always)]
            fn ge(self, other: Self) -> Self::Mask {
                Bits(self.simd_ge(other))
            }
            #[inline(always)]
            fn eq(self, other: Self) -> Self::Mask {
                Bits(self.simd_eq(other))
            }
            #[inline(always)]
            fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
                if $blends { mask.0.select(yes, no) } else { no ^ ((no ^ yes) & mask.0) }
            }
        }
    };
}

/// With plain SSE2 the selection of `wide` is a call.
const BLENDS: bool = !cfg!(all(target_arch = "x86_64", not(target_feature = "sse4.1")));

wide_lanes!(f32x4, 4, BLENDS);
wide_lanes!(f32x8, 8, BLENDS);
#[cfg(all(target_arch = "x86_64", not(target_feature = "avx2"), not(backstop_baseline)))]
wide_lanes!(
    Avx8,
    8,
    true,
    #[inline(always)]
    fn run<K: Kernel>(kernel: K) -> K::Output {
        avx2::run(kernel)
    }
);

#[cfg(test)]
mod tests;
