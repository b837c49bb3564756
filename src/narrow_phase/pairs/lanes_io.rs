//! Input and output of a lane kernel: `L::N` pairs of one shape pair at a time.

#[cfg(test)]
use crate::lanes::Mask;
use crate::lanes::{Lanes, Quat, Vec3};
#[cfg(any(test, feature = "internals"))]
use crate::narrow_phase::Relative;
use crate::narrow_phase::{MAX_POINTS, RawManifold, RawPoint};

/// `L::N` pairs of the same two kinds, each in the frame of its shape `a`.
///
/// Sizes by kind, as in [`crate::shape`]: sphere (radius), capsule (half height, bottom radius, top radius;
/// along y), box (half extents). A lane without a pair repeats another's; its answer is not read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairLanes<L> {
    /// Centre of `b` [m].
    pub(crate) position: Vec3<L>,
    /// Axes of `b`; unit.
    pub(crate) rotation: Quat<L>,
    pub(crate) size_a: [L; 4],
    pub(crate) size_b: [L; 4],
    /// Points nearer than this are contacts [m].
    pub(crate) margin: L,
}

impl<L: Lanes> PairLanes<L> {
    /// Lane `i` from `f(i)`: relative pose, size of `a`, size of `b`, margin.
    #[inline(always)]
    #[cfg(any(test, feature = "internals"))]
    pub(crate) fn from_fn(f: impl Fn(usize) -> (Relative, [f32; 4], [f32; 4], f32)) -> Self {
        let placed = (Vec3::from_fn(|i| f(i).0.position), Quat::from_fn(|i| f(i).0.rotation));
        Self::new(placed, |i| (f(i).1, f(i).2, f(i).3))
    }

    /// Relative poses, and of lane `i` from `f(i)`: size of `a`, size of `b`, margin.
    #[inline(always)]
    pub(crate) fn new(
        (position, rotation): (Vec3<L>, Quat<L>),
        f: impl Fn(usize) -> ([f32; 4], [f32; 4], f32),
    ) -> Self {
        PairLanes {
            position,
            rotation,
            size_a: std::array::from_fn(|k| L::from_fn(|i| f(i).0[k])),
            size_b: std::array::from_fn(|k| L::from_fn(|i| f(i).1[k])),
            margin: L::from_fn(|i| f(i).2),
        }
    }
}

/// `L::N` manifolds, each in the frame of its shape `a`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ManifoldLanes<L> {
    /// Unit, from `a` to `b`.
    pub(crate) normal: Vec3<L>,
    /// Midway between the surfaces [m].
    pub(crate) position: [Vec3<L>; MAX_POINTS],
    /// [m]; infinite where the lane has no such point.
    pub(crate) separation: [L; MAX_POINTS],
    /// Which features meet: small integers, exact as floats.
    pub(crate) key: [L; MAX_POINTS],
    pub(crate) margin: L,
    /// The shapes are no nearer to each other [m].
    pub(crate) gap: L,
}

impl<L: Lanes> ManifoldLanes<L> {
    /// A manifold of one point, whose key is 0, and which is the nearest.
    #[inline(always)]
    pub(crate) fn single(normal: Vec3<L>, position: Vec3<L>, separation: L, margin: L) -> Self {
        let mut one = ManifoldLanes {
            normal,
            position: [Vec3::zero(); MAX_POINTS],
            separation: [L::splat(f32::INFINITY); MAX_POINTS],
            key: [L::zero(); MAX_POINTS],
            margin,
            gap: separation,
        };
        (one.position[0], one.separation[0]) = (position, separation);
        one
    }

    /// How many points lane `i` has.
    #[inline(always)]
    #[cfg(test)]
    pub(crate) fn count(&self, i: usize) -> u32 {
        self.separation.iter().map(|s| s.lt(self.margin).bits() >> i & 1).sum()
    }

    /// The manifold of lane `i`: its points nearer than the margin, in their order.
    #[inline(always)]
    pub(crate) fn lane(&self, i: usize) -> RawManifold {
        let mut out = RawManifold { normal: self.normal.lane(i), ..RawManifold::default() };
        let margin = self.margin.lane(i);
        let mut count = 0;
        for k in 0..MAX_POINTS {
            let separation = self.separation[k].lane(i);
            if separation < margin {
                out.points[count] = RawPoint {
                    position: self.position[k].lane(i),
                    separation,
                    key: self.key[k].lane(i) as u32,
                };
                count += 1;
            }
        }
        out.count = count as u16;
        if count == 0 {
            out.points[0].separation = self.gap.lane(i);
        }
        out
    }
}

/// Direction and length of `v`; `fallback` (unit) where it is no longer than `least` and has no direction to
/// speak of.
#[inline(always)]
pub(crate) fn direction<L: Lanes>(v: Vec3<L>, least: L, fallback: Vec3<L>) -> (Vec3<L>, L) {
    let length = v.length();
    // The floor also keeps the squares of tiny numbers, which have lost their digits, out of the division.
    let has = length.gt(least.max(L::splat(1e-15)));
    let scale = L::one() / L::select(has, length, L::one());
    (Vec3::select(has, v * scale, fallback), length)
}

/// `values[index]`, for an index of 0, 1 or 2 given as two masks.
#[inline(always)]
pub(crate) fn pick<L: Lanes>(is_1: L::Mask, is_2: L::Mask, values: [L; 3]) -> L {
    L::select(is_2, values[2], L::select(is_1, values[1], values[0]))
}

/// Pairs for the kernels' tests: random ones, and the proof that the width does not show.
#[cfg(test)]
pub(crate) mod testing {
    use super::*;
    use crate::lanes::{f32x4, f32x8};
    pub(crate) use crate::random::Random;
    use glam::DVec3;

    pub(crate) type Pair = (Relative, [f32; 4], [f32; 4], f32);

    impl Random {
        /// Any rotation; one in four is about y alone or none, so that features are parallel.
        pub(crate) fn rotation_or_parallel(&mut self) -> crate::math::Quat {
            let q = crate::math::Quat::from_xyzw(
                self.range(-1.0, 1.0),
                self.range(-1.0, 1.0),
                self.range(-1.0, 1.0),
                self.range(-1.0, 1.0),
            );
            match self.range(0.0, 8.0) as u32 {
                0 => crate::math::Quat::IDENTITY,
                1 => crate::math::Quat::from_xyzw(0.0, q.y, 0.0, q.w + 2.0).normalize(),
                _ if q.length_squared() > 1e-3 => q.normalize(),
                _ => crate::math::Quat::IDENTITY,
            }
        }
        pub(crate) fn relative(&mut self, reach: f32) -> Relative {
            Relative { position: self.cube() * reach, rotation: self.rotation_or_parallel() }
        }
        pub(crate) fn sizes(&mut self, low: f32, high: f32) -> [f32; 4] {
            std::array::from_fn(|_| self.range(low, high))
        }
    }

    /// Random pairs of any sizes within `reach` of each other.
    pub(crate) fn pairs(seed: u64, count: usize, reach: f32) -> Vec<Pair> {
        let mut random = Random(seed);
        (0..count)
            .map(|_| {
                (
                    random.relative(reach),
                    random.sizes(0.1, 1.0),
                    random.sizes(0.1, 1.0),
                    random.range(0.0, 3.0),
                )
            })
            .collect()
    }

    /// Least distance of balls of two tapered capsules: nested golden section over a convex function.
    pub(crate) fn between_capsules(relative: &Relative, a: &[f32; 4], b: &[f32; 4]) -> f64 {
        let (p, v) = (relative.position.as_dvec3(), relative.rotation.as_dquat() * DVec3::Y);
        let ball = |size: &[f32; 4], s: f64| {
            let (h, r0, r1) = (size[0] as f64, size[1] as f64, size[2] as f64);
            (h * (2.0 * s - 1.0), r0 + (r1 - r0) * s)
        };
        let least = |f: &dyn Fn(f64) -> f64| {
            let (mut low, mut high) = (0.0, 1.0);
            let golden = 0.381_966_011_250_105;
            let (mut x, mut y) = (golden, 1.0 - golden);
            let (mut fx, mut fy) = (f(x), f(y));
            for _ in 0..45 {
                if fx < fy {
                    (high, y, fy) = (y, x, fx);
                    x = low + golden * (high - low);
                    fx = f(x);
                } else {
                    (low, x, fx) = (x, y, fy);
                    y = high - golden * (high - low);
                    fy = f(y);
                }
            }
            fx.min(fy)
        };
        least(&|s| {
            let (y, ra) = ball(a, s);
            least(&|t| {
                let (z, rb) = ball(b, t);
                (p + v * z - DVec3::Y * y).length() - ra - rb
            })
        })
    }

    /// The same with capsules that are not tapered; of a box the third size changes.
    pub(crate) fn uniform(mut pairs: Vec<Pair>) -> Vec<Pair> {
        for (_, a, b, _) in &mut pairs {
            (a[2], b[2]) = (a[1], b[1]);
        }
        pairs
    }

    pub(crate) fn run<L: Lanes>(
        pairs: &[Pair],
        kernel: fn(&PairLanes<L>) -> ManifoldLanes<L>,
    ) -> Vec<RawManifold> {
        let mut out = Vec::new();
        for start in (0..pairs.len()).step_by(L::N) {
            let last = pairs.len() - 1;
            let m = kernel(&PairLanes::from_fn(|i| pairs[(start + i).min(last)]));
            for i in 0..L::N.min(pairs.len() - start) {
                out.push(m.lane(i));
                assert_eq!(m.lane(i).size(), m.count(i));
            }
        }
        out
    }

    fn bits(m: &RawManifold) -> Vec<u32> {
        let mut all = vec![m.size()];
        all.extend(m.normal.to_array().map(f32::to_bits));
        for p in m.points() {
            all.extend(p.position.to_array().map(f32::to_bits));
            all.extend([p.separation.to_bits(), p.key]);
        }
        all
    }

    /// Asserts that one, four and eight lanes give the same bits, and no NaN; returns the manifolds.
    pub(crate) fn same_at_any_width(
        pairs: &[Pair],
        one: fn(&PairLanes<f32>) -> ManifoldLanes<f32>,
        four: fn(&PairLanes<f32x4>) -> ManifoldLanes<f32x4>,
        eight: fn(&PairLanes<f32x8>) -> ManifoldLanes<f32x8>,
    ) -> Vec<RawManifold> {
        let (one, four, eight) = (run(pairs, one), run(pairs, four), run(pairs, eight));
        for (i, pair) in pairs.iter().enumerate() {
            assert_eq!(bits(&one[i]), bits(&four[i]), "four lanes, pair {i}: {pair:?}");
            assert_eq!(bits(&one[i]), bits(&eight[i]), "eight lanes, pair {i}: {pair:?}");
            let m = &one[i];
            assert!((m.normal.length() - 1.0).abs() < 1e-4, "normal {:?} of {pair:?}", m.normal);
            assert!(m.points().iter().all(|p| p.position.is_finite() && p.separation.is_finite()));
        }
        one
    }

    /// Asserts that two kernels find the same depth.
    pub(crate) fn agree(
        pairs: &[Pair],
        one: fn(&PairLanes<f32>) -> ManifoldLanes<f32>,
        other: fn(&PairLanes<f32>) -> ManifoldLanes<f32>,
    ) {
        for (x, y) in run(pairs, one).iter().zip(&run(pairs, other)) {
            assert!(x.count == 0 || y.count == 0 || (deepest(x) - deepest(y)).abs() < 2e-5);
        }
    }

    pub(crate) fn deepest(m: &RawManifold) -> f32 {
        m.points().iter().fold(f32::INFINITY, |least, p| least.min(p.separation))
    }
}
