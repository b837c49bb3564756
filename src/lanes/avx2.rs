//! Eight lanes in one register, in a program that is built for processors without AVX.
//!
//! `wide` chooses registers when it is built: in a program for every x86-64 eight lanes are two registers of
//! four. Where the processor has AVX2, kernels run as they are compiled for [`Avx8`]: the same source over
//! another type of lanes, and the same bits, since every operation is exact.

use super::kernel::Kernel;
use bytemuck::{Pod, Zeroable};
use std::arch::x86_64 as arch;
use std::ops::{Add, AddAssign, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub, SubAssign};
use std::sync::atomic::{AtomicU8, Ordering};

/// Eight floats in a register. Only kernels that were entered by [`with_best!`](super::with_best) compute
/// with it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(transparent)]
pub(crate) struct Avx8(arch::__m256);

/// An operation on whole registers.
macro_rules! avx {
    ($operation:ident$(::<$predicate:path>)?($($x:expr),*)) => {
        // SAFETY: it asks for nothing but AVX. Lanes of this type are computed with in kernels for which the
        // processor was found to have it.
        Avx8(unsafe { arch::$operation$(::<{ $predicate }>)?($($x.0),*) })
    };
}

/// An operator, and the method of its trait.
macro_rules! operators {
    ($($operator:ident $method:ident $operation:ident,)*) => {
        $(impl $operator for Avx8 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                avx!($operation(self, other))
            }
        })*
    };
}

operators! {
    Add add _mm256_add_ps,
    Sub sub _mm256_sub_ps,
    Mul mul _mm256_mul_ps,
    Div div _mm256_div_ps,
    BitAnd bitand _mm256_and_ps,
    BitOr bitor _mm256_or_ps,
    BitXor bitxor _mm256_xor_ps,
}

impl Default for Avx8 {
    #[inline(always)]
    fn default() -> Self {
        Self::ZERO
    }
}
impl Neg for Avx8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self ^ Self::splat(-0.0)
    }
}
impl Not for Avx8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        self ^ Self::splat(f32::from_bits(u32::MAX))
    }
}
impl AddAssign for Avx8 {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl SubAssign for Avx8 {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

/// The operations of `wide` on its floats, by the same names.
impl Avx8 {
    pub(crate) const ZERO: Self = Avx8::new([0.0; 8]);

    #[inline(always)]
    pub(crate) const fn new(lanes: [f32; 8]) -> Self {
        bytemuck::must_cast(lanes)
    }
    #[inline(always)]
    pub(crate) const fn splat(value: f32) -> Self {
        Avx8::new([value; 8])
    }
    #[inline(always)]
    pub(crate) fn to_array(self) -> [f32; 8] {
        bytemuck::must_cast(self)
    }
    #[inline(always)]
    pub(crate) fn as_mut_array(&mut self) -> &mut [f32; 8] {
        bytemuck::must_cast_mut(self)
    }
    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        self & Self::splat(f32::from_bits(i32::MAX as u32))
    }
    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        avx!(_mm256_sqrt_ps(self))
    }
    #[inline(always)]
    pub(crate) fn fast_min(self, other: Self) -> Self {
        avx!(_mm256_min_ps(self, other))
    }
    #[inline(always)]
    pub(crate) fn fast_max(self, other: Self) -> Self {
        avx!(_mm256_max_ps(self, other))
    }
    #[inline(always)]
    pub(crate) fn simd_lt(self, other: Self) -> Self {
        avx!(_mm256_cmp_ps::<arch::_CMP_LT_OQ>(self, other))
    }
    #[inline(always)]
    pub(crate) fn simd_le(self, other: Self) -> Self {
        avx!(_mm256_cmp_ps::<arch::_CMP_LE_OQ>(self, other))
    }
    #[inline(always)]
    pub(crate) fn simd_gt(self, other: Self) -> Self {
        avx!(_mm256_cmp_ps::<arch::_CMP_GT_OQ>(self, other))
    }
    #[inline(always)]
    pub(crate) fn simd_ge(self, other: Self) -> Self {
        avx!(_mm256_cmp_ps::<arch::_CMP_GE_OQ>(self, other))
    }
    #[inline(always)]
    pub(crate) fn simd_eq(self, other: Self) -> Self {
        avx!(_mm256_cmp_ps::<arch::_CMP_EQ_OQ>(self, other))
    }
    #[inline(always)]
    pub(crate) fn to_bitmask(self) -> u32 {
        // SAFETY: as for all operations of this type.
        unsafe { arch::_mm256_movemask_ps(self.0) as u32 }
    }
    #[inline(always)]
    pub(crate) fn select(self, yes: Self, no: Self) -> Self {
        avx!(_mm256_blendv_ps(no, yes, self))
    }
}

/// See [`Lanes::run`](super::Lanes::run).
#[inline(always)]
pub(super) fn run<K: Kernel>(kernel: K) -> K::Output {
    #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
    #[inline(never)]
    fn compiled_for_it<K: Kernel>(kernel: K) -> K::Output {
        kernel.run()
    }
    // SAFETY: lanes of this type are used only where the processor has all of it.
    unsafe { compiled_for_it(kernel) }
}

/// Whether the processor has the instructions for which kernels over [`Avx8`] are compiled. Asked for every
/// batch, so the answer is kept in one place.
#[inline(always)]
pub(crate) fn has_avx2() -> bool {
    match FOUND.load(Ordering::Relaxed) {
        YES => true,
        NO => false,
        _ => look(),
    }
}

const NO: u8 = 1;
const YES: u8 = 2;
/// The answer; zero before the first question.
static FOUND: AtomicU8 = AtomicU8::new(0);

#[cold]
fn look() -> bool {
    use std::arch::is_x86_feature_detected as has;
    let all = has!("avx2") && has!("bmi1") && has!("bmi2") && has!("lzcnt") && has!("popcnt");
    FOUND.store(if all { YES } else { NO }, Ordering::Relaxed);
    all
}
