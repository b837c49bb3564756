//! Body records <-> lanes. A record is 32 bytes, so eight of them are one 8x8 transpose.

use super::{Lanes, Mask, Vec3, f32x8};
use bytemuck::{Pod, Zeroable, must_cast};

/// Two vectors of one body, in the layout that the solver gathers: linear xyz and the marks, angular xyz and
/// an angle. Only displacements have marks, and only predicted ones an angle; both are zero in all others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C, align(32))]
pub(crate) struct Record {
    pub(crate) linear: glam::Vec3,
    pub(crate) marks: Marks,
    pub(crate) angular: glam::Vec3,
    /// Angle by which the body turns, in a predicted displacement [rad].
    pub(crate) turn_angle: f32,
}

/// Events of a body within the step, a bit each.
///
/// The solver integrates whole records in float lanes, so the bits are those of an exponent: any set of them
/// is a tiny normal float, which keeps its bits where zero is added to it, on every target, and is slow
/// nowhere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub(crate) struct Marks(u32);

impl Marks {
    /// Something acted on the body: it may not be where it was predicted.
    const TOUCHED: u32 = 1 << 23;
    /// Its displacement has turned it already, and its inertia with it.
    const TURNED: u32 = 1 << 24;
    /// Its motion crossed something or left the predicted path: it is settled once all others have moved.
    const OFF_PATH: u32 = 1 << 25;
    /// It was moved out of the way of another one.
    const MOVED_ASIDE: u32 = 1 << 26;
    /// All that leave the body elsewhere than predicted.
    const ANY_TOUCH: u32 = Marks::TOUCHED | Marks::OFF_PATH | Marks::MOVED_ASIDE;

    #[inline(always)]
    fn has(self, mark: u32) -> bool {
        self.0 & mark != 0
    }
}

/// The marks of a displacement; see [`Marks`].
impl Record {
    #[inline(always)]
    pub(crate) fn is_touched(&self) -> bool {
        self.marks.has(Marks::ANY_TOUCH)
    }

    #[inline(always)]
    pub(crate) fn set_touched(&mut self) {
        self.marks.0 |= Marks::TOUCHED;
    }

    /// Lanes that mark a displacement as touched when they are joined to its own by `|`, or change nothing.
    #[inline(always)]
    pub(crate) fn touched_lanes(touched: bool) -> f32x8 {
        let marks = Marks(if touched { Marks::TOUCHED } else { 0 });
        bytemuck::must_cast(Record { marks, ..Record::default() })
    }

    #[inline(always)]
    pub(crate) fn is_turned(&self) -> bool {
        self.marks.has(Marks::TURNED)
    }

    #[inline(always)]
    pub(crate) fn set_turned(&mut self) {
        self.marks.0 |= Marks::TURNED;
    }

    #[inline(always)]
    pub(crate) fn is_off_path(&self) -> bool {
        self.marks.has(Marks::OFF_PATH)
    }

    #[inline(always)]
    pub(crate) fn set_off_path(&mut self) {
        self.marks.0 |= Marks::OFF_PATH;
    }

    #[inline(always)]
    pub(crate) fn was_moved_aside(&self) -> bool {
        self.marks.has(Marks::MOVED_ASIDE)
    }

    #[inline(always)]
    pub(crate) fn set_moved_aside(&mut self) {
        self.marks.0 |= Marks::MOVED_ASIDE;
    }

    /// A predicted displacement, with the angle by which the body turns [rad]: it bounds how far points get.
    #[inline(always)]
    pub(crate) fn predicted(linear: glam::Vec3, angular: glam::Vec3, turn_angle: f32) -> Record {
        Record { linear, angular, turn_angle, ..Record::default() }
    }
}

/// Whether all lanes are within a limit; NaN is not. One comparison of eight lanes.
#[inline(always)]
pub(crate) fn is_within(r: f32x8, most: f32) -> bool {
    r.abs().le(f32x8::splat(most)).bits() == 0xff
}

impl Record {
    /// Whether a velocity or a displacement is within a limit; NaN is not.
    #[inline(always)]
    pub(crate) fn is_within(&self, most: f32) -> bool {
        is_within(bytemuck::must_cast(*self), most)
    }
}

/// How records become lanes, per width.
pub(crate) trait GatherLanes: Lanes {
    /// Records by index, which `record` looks up.
    fn gather(record: impl Fn(usize) -> Record, index: &[u32]) -> (Vec3<Self>, Vec3<Self>);
    /// The lanes as records, in order; without marks and angles.
    fn records(linear: Vec3<Self>, angular: Vec3<Self>, out: &mut [Record]);
}

/// See [`GatherLanes::gather`].
#[inline(always)]
pub(crate) fn gather<L: GatherLanes>(record: impl Fn(usize) -> Record, index: &[u32]) -> (Vec3<L>, Vec3<L>) {
    L::gather(record, index)
}

/// The lanes as eight records (those past the width stay zero).
#[inline(always)]
pub(crate) fn scatter<L: GatherLanes>(linear: Vec3<L>, angular: Vec3<L>) -> [Record; 8] {
    let mut out = [Record::default(); 8];
    L::records(linear, angular, &mut out);
    out
}

impl GatherLanes for f32 {
    #[inline(always)]
    fn gather(record: impl Fn(usize) -> Record, index: &[u32]) -> (Vec3<f32>, Vec3<f32>) {
        let r = record(index[0] as usize);
        let v = |v: glam::Vec3| Vec3::new(v.x, v.y, v.z);
        (v(r.linear), v(r.angular))
    }
    #[inline(always)]
    fn records(linear: Vec3<f32>, angular: Vec3<f32>, out: &mut [Record]) {
        out[0] = Record { linear: linear.lane(0), angular: angular.lane(0), ..Record::default() };
    }
}

/// Eight lanes, with the transpose for their instructions.
macro_rules! gather_eight {
    ($float:ty, $transpose:ident) => {
        impl GatherLanes for $float {
            #[inline(always)]
            fn gather(record: impl Fn(usize) -> Record, index: &[u32]) -> (Vec3<Self>, Vec3<Self>) {
                let index: &[u32; 8] = index[..8].try_into().unwrap_or(&[0; 8]);
                let row = |i: usize| -> Self { must_cast(record(index[i] as usize)) };
                let c = $transpose([row(0), row(1), row(2), row(3), row(4), row(5), row(6), row(7)]);
                (Vec3::new(c[0], c[1], c[2]), Vec3::new(c[4], c[5], c[6]))
            }
            #[inline(always)]
            fn records(linear: Vec3<Self>, angular: Vec3<Self>, out: &mut [Record]) {
                let (v, w, zero) = (linear, angular, Self::zero());
                let rows = $transpose([v.x, v.y, v.z, zero, w.x, w.y, w.z, zero]);
                for (record, row) in out.iter_mut().zip(rows) {
                    *record = must_cast(row);
                }
            }
        }
    };
}

gather_eight!(f32x8, transpose);
#[cfg(all(target_arch = "x86_64", not(target_feature = "avx2"), not(backstop_baseline)))]
gather_eight!(super::Avx8, transpose_registers);

/// The 8x8 transpose in builds for these instructions.
#[cfg(target_feature = "avx")]
use transpose_registers as transpose;

/// The 8x8 transpose in registers of AVX, inlined: two of eight rows are zeros or go unused, and so does the
/// work for them. Only for code that runs where the processor has AVX.
#[cfg(any(target_feature = "avx", all(target_arch = "x86_64", not(backstop_baseline))))]
#[inline(always)]
fn transpose_registers<L: Pod>(rows: [L; 8]) -> [L; 8] {
    #[cfg(target_arch = "x86")]
    use std::arch::x86 as arch;
    #[cfg(target_arch = "x86_64")]
    use std::arch::x86_64 as arch;

    /// Of two halves of four rows each: columns 0 and 4, 1 and 5, 2 and 6, 3 and 7.
    #[inline(always)]
    fn half([a, b, c, d]: [arch::__m256; 4]) -> [arch::__m256; 4] {
        // SAFETY: as below.
        unsafe {
            let (low, high) = (arch::_mm256_unpacklo_ps(a, b), arch::_mm256_unpackhi_ps(a, b));
            let (low_2, high_2) = (arch::_mm256_unpacklo_ps(c, d), arch::_mm256_unpackhi_ps(c, d));
            [
                arch::_mm256_shuffle_ps::<0x44>(low, low_2),
                arch::_mm256_shuffle_ps::<0xee>(low, low_2),
                arch::_mm256_shuffle_ps::<0x44>(high, high_2),
                arch::_mm256_shuffle_ps::<0xee>(high, high_2),
            ]
        }
    }
    /// The lower halves of two registers, or their upper ones.
    #[inline(always)]
    fn join<L: Pod, const WHICH: i32>(a: arch::__m256, b: arch::__m256) -> L {
        // SAFETY: as below.
        must_cast(unsafe { arch::_mm256_permute2f128_ps::<WHICH>(a, b) })
    }
    // SAFETY of all of these: they ask for nothing but AVX, which the caller has made sure of.
    let [a, b, c, d, e, f, g, h] = rows;
    let upper = half([must_cast(a), must_cast(b), must_cast(c), must_cast(d)]);
    let lower = half([must_cast(e), must_cast(f), must_cast(g), must_cast(h)]);
    [
        join::<L, 0x20>(upper[0], lower[0]),
        join::<L, 0x20>(upper[1], lower[1]),
        join::<L, 0x20>(upper[2], lower[2]),
        join::<L, 0x20>(upper[3], lower[3]),
        join::<L, 0x31>(upper[0], lower[0]),
        join::<L, 0x31>(upper[1], lower[1]),
        join::<L, 0x31>(upper[2], lower[2]),
        join::<L, 0x31>(upper[3], lower[3]),
    ]
}

/// The 8x8 transpose, as four of four.
///
/// Functions that are always inlined, and not closures, `map` or `array::from_fn`, which are not: the solver
/// does this four times a batch.
#[cfg(not(target_feature = "avx"))]
#[inline(always)]
fn transpose(rows: [f32x8; 8]) -> [f32x8; 8] {
    use super::f32x4;

    #[inline(always)]
    fn four([a, b, c, d]: [f32x8; 4]) -> [[f32x4; 4]; 2] {
        let ([a0, a1], [b0, b1]): ([f32x4; 2], [f32x4; 2]) = (must_cast(a), must_cast(b));
        let ([c0, c1], [d0, d1]): ([f32x4; 2], [f32x4; 2]) = (must_cast(c), must_cast(d));
        [f32x4::transpose([a0, b0, c0, d0]), f32x4::transpose([a1, b1, c1, d1])]
    }
    #[inline(always)]
    fn join(low: f32x4, high: f32x4) -> f32x8 {
        must_cast([low, high])
    }
    let [r0, r1, r2, r3, r4, r5, r6, r7] = rows;
    let ([a, b], [c, d]) = (four([r0, r1, r2, r3]), four([r4, r5, r6, r7]));
    [
        join(a[0], c[0]),
        join(a[1], c[1]),
        join(a[2], c[2]),
        join(a[3], c[3]),
        join(b[0], d[0]),
        join(b[1], d[1]),
        join(b[2], d[2]),
        join(b[3], d[3]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Marks pass through the float arithmetic of the solver's substeps: none comes, none goes, and touches
    /// of any number of substeps are one mark.
    #[test]
    fn marks_are_bits_that_float_lanes_keep() {
        let sets: [fn(&mut Record); 4] =
            [Record::set_touched, Record::set_turned, Record::set_off_path, Record::set_moved_aside];
        for chosen in 0..16u32 {
            let mut record = Record::default();
            (0..4).filter(|i| chosen >> i & 1 != 0).for_each(|i| sets[i](&mut record));
            let before = record.marks;
            for substep in 0..5 {
                let moved = f32x8::new([0.5, -1.0, 2.0, 0.0, 1.0, 1.0, 1.0, 0.0]);
                let touched = Record::touched_lanes(substep % 2 == 1 && record.marks.has(Marks::TOUCHED));
                let lanes: f32x8 = bytemuck::must_cast(record);
                record = bytemuck::must_cast((lanes + moved) | touched);
                assert!(f32::from_bits(record.marks.0 | Marks::TOUCHED).is_normal());
            }
            assert_eq!(record.marks, before);
            assert_eq!(record.linear, glam::vec3(2.5, -5.0, 10.0));
            let [touched, turned, off_path, aside] = [0, 1, 2, 3].map(|i| chosen >> i & 1 != 0);
            assert_eq!(record.is_touched(), touched || off_path || aside);
            assert_eq!(record.is_turned(), turned);
            assert_eq!(record.is_off_path(), off_path);
            assert_eq!(record.was_moved_aside(), aside);
        }
    }

    #[test]
    fn eight_records_gathered_and_scattered_are_the_same_records() {
        let records: Vec<Record> = (0..16)
            .map(|i| Record {
                linear: glam::vec3(i as f32, 0.5 + i as f32, -1.0 - i as f32),
                angular: glam::vec3(100.0 + i as f32, 200.0 + i as f32, 300.0),
                ..Record::default()
            })
            .collect();
        let index = [3, 1, 15, 0, 7, 7, 2, 9];
        let (v, w) = gather::<f32x8>(|i| records[i], &index);
        let back = scatter(v, w);
        for lane in 0..8 {
            assert_eq!(back[lane], records[index[lane] as usize]);
            let (one, _) = gather::<f32>(|i| records[i], &index[lane..]);
            assert_eq!(one.lane(0), v.lane(lane));
        }
    }
}
