//! Where a path enters boxes, and how far they are from a point, for queries on the boxes of a tree.
//!
//! Slabs (Kay and Kajiya, *Ray Tracing Complex Scenes*, 1986) rather than the separating axes of
//! `mesh_bvh.rs`: less than half of the work, and they say where as well. Rounding errors are added back, so
//! no answer is ever too large and no box is missed.

use crate::lanes::{Lanes, Vec3};
use glam::DVec3;

// Guard: stands for zero in a division.
/// Stands for a zero component of a path when it is inverted: no coordinate makes an infinity of it, and so
/// small a motion does not matter.
const LEAST: f32 = 1e-18;
// Rounding: three of f32, doubled.
/// Bound on rounding errors as a share of the lengths involved: three roundings, doubled.
const ROUNDING: f32 = 6.0 / (1 << 24) as f32;

/// A straight path, of a point or of a box, to be tested against boxes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Slabs<L> {
    from: Vec3<L>,
    inverse: Vec3<L>,
    /// By how much sooner each slab is entered, and later left, because of the extent and of rounding.
    early: Vec3<L>,
    /// Axes along which the path goes down.
    down: [bool; 3],
}

impl<L: Lanes> Slabs<L> {
    /// A box of half extents `half` [m] that moves along `path` [m]; the fraction 1 is its end.
    pub(crate) fn new(from: DVec3, path: glam::Vec3, half: glam::Vec3) -> Slabs<L> {
        let start = from.as_vec3();
        // The error of storing the start in `f32` is known.
        let lost = (from - start.as_dvec3()).abs().as_vec3();
        let slack = (half + lost) * (1.0 + ROUNDING) + (path.abs() + half) * ROUNDING;
        let invert = |d: f32| 1.0 / if d.abs() < LEAST { LEAST.copysign(d) } else { d };
        let inverse = glam::Vec3::new(invert(path.x), invert(path.y), invert(path.z));
        Slabs {
            from: Vec3::splat(start),
            inverse: Vec3::splat(inverse),
            early: Vec3::splat(slack * inverse.abs()),
            down: [inverse.x < 0.0, inverse.y < 0.0, inverse.z < 0.0],
        }
    }

    /// Where the path enters each box at the earliest, as a fraction; infinite where it doesn't before
    /// `most`.
    #[inline(always)]
    pub(crate) fn enter(&self, min: &Vec3<L>, max: &Vec3<L>, most: f32) -> L {
        let mut enter = L::zero();
        let mut leave = L::splat(most);
        let mut slab = |low: L, high: L, k: usize, from: L, inverse: L, early: L| {
            let (near, far) = if self.down[k] { (high, low) } else { (low, high) };
            // In this order a NaN, from infinite numbers, excludes nothing.
            enter = ((near - from) * inverse - early).max(enter);
            leave = ((far - from) * inverse + early).min(leave);
        };
        let (from, inverse, early) = (&self.from, &self.inverse, &self.early);
        slab(min.x, max.x, 0, from.x, inverse.x, early.x);
        slab(min.y, max.y, 1, from.y, inverse.y, early.y);
        slab(min.z, max.z, 2, from.z, inverse.z, early.z);
        L::select(enter.le(leave), enter, L::splat(f32::INFINITY))
    }

    /// The same, of boxes given by their least and their greatest x, y and z. Which side is near is looked
    /// up: in a loop over rays it could not be predicted.
    #[inline(always)]
    pub(crate) fn enter_sides(&self, sides: &[L; 6], most: f32) -> L {
        let mut enter = L::zero();
        let mut leave = L::splat(most);
        let mut slab = |k: usize, from: L, inverse: L, early: L| {
            let far_side = usize::from(self.down[k]) * 3;
            let (near, far) = (sides[k + far_side], sides[k + 3 - far_side]);
            enter = ((near - from) * inverse - early).max(enter);
            leave = ((far - from) * inverse + early).min(leave);
        };
        slab(0, self.from.x, self.inverse.x, self.early.x);
        slab(1, self.from.y, self.inverse.y, self.early.y);
        slab(2, self.from.z, self.inverse.z, self.early.z);
        L::select(enter.le(leave), enter, L::splat(f32::INFINITY))
    }
}

/// Which of `L::N` boxes a straight path touches; lane `i` answers for box `i`.
///
/// `half`: half vector of the path [m]. `offset`: from the middle of the path to the middle of the box, or
/// back [m]. `extent`: half extents of the box, already inflated by the mover's and by the margin [m]. An
/// inert lane has a NaN offset or an extent of -inf and answers no. No division: a path of length zero is a
/// point test. Separating axes, three box normals and three cross products: Ericson, *Real-Time Collision
/// Detection* (2005), 5.3.3.
#[inline(always)]
pub(crate) fn path_hits_boxes<L: Lanes>(half: Vec3<L>, offset: Vec3<L>, extent: Vec3<L>) -> L::Mask {
    let d = half.abs();
    let m = offset.abs();
    let c = offset.cross(half).abs(); // c.x: the axis x × half, and so on
    m.x.le(extent.x + d.x)
        & m.y.le(extent.y + d.y)
        & m.z.le(extent.z + d.z)
        & c.x.le(extent.y * d.z + extent.z * d.y)
        & c.y.le(extent.x * d.z + extent.z * d.x)
        & c.z.le(extent.x * d.y + extent.y * d.x)
}

/// Which boxes meet others, each as its low and its high corner.
#[inline(always)]
pub(crate) fn boxes_meet<L: Lanes>(
    (low, high): (Vec3<L>, Vec3<L>),
    (min, max): (Vec3<L>, Vec3<L>),
) -> L::Mask {
    low.x.le(max.x)
        & low.y.le(max.y)
        & low.z.le(max.z)
        & high.x.ge(min.x)
        & high.y.ge(min.y)
        & high.z.ge(min.z)
}

/// A point, to be measured against boxes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near<L> {
    at: Vec3<L>,
    slack: Vec3<L>,
}

impl<L: Lanes> Near<L> {
    pub(crate) fn new(at: DVec3) -> Near<L> {
        let start = at.as_vec3();
        let lost = (at - start.as_dvec3()).abs().as_vec3();
        Near { at: Vec3::splat(start), slack: Vec3::splat(lost * (1.0 + ROUNDING)) }
    }

    /// Squared distance from each box [m²], never too large.
    #[inline(always)]
    pub(crate) fn squared(&self, min: &Vec3<L>, max: &Vec3<L>) -> L {
        let out = (*min - self.at).max(self.at - *max) - self.slack;
        let out = out.max(Vec3::zero());
        out.length_squared() * L::splat(1.0 - 2.0 * ROUNDING)
    }
}

/// The part of a path within a box, in `f64`.
pub(crate) fn path_in_box(start: DVec3, path: DVec3, min: DVec3, max: DVec3) -> Option<(f64, f64)> {
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for k in 0..3 {
        if path[k] == 0.0 {
            if start[k] < min[k] || start[k] > max[k] {
                return None;
            }
            continue;
        }
        let (s, t) = ((min[k] - start[k]) / path[k], (max[k] - start[k]) / path[k]);
        (enter, leave) = (enter.max(s.min(t)), leave.min(s.max(t)));
    }
    (enter <= leave).then_some((enter, leave))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::broad_phase::Aabb;
    use crate::lanes::f32x4;
    use crate::random::Random;
    use glam::{dvec3, vec3};

    /// The slabs of bounds that are grown by half extents and by `grow`.
    fn exact(from: DVec3, path: glam::Vec3, bounds: &Aabb, half: glam::Vec3, grow: f64) -> Option<f64> {
        let grow = half.as_dvec3() + grow;
        let (low, high) = (bounds.min.as_dvec3() - grow, bounds.max.as_dvec3() + grow);
        path_in_box(from, path.as_dvec3(), low, high).map(|(enter, _)| enter)
    }

    #[test]
    fn no_box_is_missed_or_entered_too_late_near_or_far() {
        let mut random = Random(5);
        for centre in [DVec3::ZERO, dvec3(1e6 + 0.3, -1e6, 12_345.678)] {
            let (mut hits, mut misses) = (0, 0);
            for i in 0..if cfg!(miri) { 200 } else { 40_000 } {
                let from = centre + (random.cube() * 5.0).as_dvec3() * 1.000_000_1;
                let mut path = random.cube() * [0.0, 1.0, 10.0, 100.0][i % 4];
                if i % 8 == 1 {
                    path.y = 0.0;
                    path.z = -0.0;
                }
                let middle = (from + (path * random.unit()).as_dvec3()).as_vec3() + random.cube() * 3.0;
                let size = (random.cube() * [0.0, 0.1, 5.0][i % 3]).abs();
                let bounds = Aabb { min: middle - size, max: middle + size };
                let half = (random.cube() * [0.0, 1.0][i / 4 % 2]).abs();
                let slabs = Slabs::<f32>::new(from, path, half);
                let (min, max) = (Vec3::splat(bounds.min), Vec3::splat(bounds.max));
                let entry = slabs.enter(&min, &max, 1.0);
                if let Some(expected) = exact(from, path, &bounds, half, 0.0) {
                    assert!(f64::from(entry) <= expected, "{entry} {expected}");
                    hits += 1;
                }
                let slack = 1e-5 + 1e-7 * centre.abs().max_element();
                if exact(from, path, &bounds, half, slack).is_none() {
                    assert!(entry == f32::INFINITY);
                    misses += 1;
                }
                let four = Slabs::<f32x4>::new(from, path, half);
                let lanes = four.enter(&Vec3::splat(bounds.min), &Vec3::splat(bounds.max), 1.0);
                assert_eq!(lanes.to_array().map(f32::to_bits), [entry.to_bits(); 4]);
                let sides = [min.x, min.y, min.z, max.x, max.y, max.z];
                assert_eq!(slabs.enter_sides(&sides, 1.0).to_bits(), entry.to_bits());

                let near = Near::<f32>::new(from).squared(&min, &max);
                let nearest = from.clamp(bounds.min.as_dvec3(), bounds.max.as_dvec3());
                let expected = (from - nearest).length_squared();
                assert!(
                    f64::from(near) <= expected && f64::from(near) >= expected * 0.999 - 0.2 * slack * 1e3
                );
            }
            assert!(cfg!(miri) || (hits > 5_000 && misses > 5_000), "{hits} {misses}");
        }
    }

    #[test]
    fn an_empty_box_is_never_entered() {
        let (min, max) = (Vec3::splat(Aabb::EMPTY.min), Vec3::splat(Aabb::EMPTY.max));
        for path in [vec3(1.0, -2.0, 0.0), glam::Vec3::ZERO, vec3(1e15, -1e15, 1e-30)] {
            let slabs = Slabs::<f32>::new(dvec3(1e15, -1e15, 0.0), path, glam::Vec3::splat(1e15));
            assert_eq!(slabs.enter(&min, &max, 1.0), f32::INFINITY);
        }
        assert_eq!(Near::<f32>::new(DVec3::ONE).squared(&min, &max), f32::INFINITY);
    }
}
