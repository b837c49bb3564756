//! Capsule against capsule: one point where they cross, two along the overlap where they lie side by side.
//!
//! Both kinds end in the same manifold; they differ in how the closest balls are found. Uniform capsules, the
//! common case, ask for the closest points of two segments. Tapered ones have kernels of their own bin: the
//! distance of two balls, as a function of their places on the axes, is convex, so its least value is either
//! inside, where both sides' normals agree, or with one ball at an end, which is sphere against capsule.

use super::lanes_io::{ManifoldLanes, PairLanes, direction};
use super::sphere_capsule::Axis;
use crate::lanes::{Lanes, Vec3, kernel};

kernel! {
    /// Uniform capsules; the bottom radius counts.
    pub(crate) fn capsule_capsule<'a, L: Lanes>(p: &'a PairLanes<L>) -> ManifoldLanes<L> {
        let (mut a, mut b) = axes(p);
        (a.radius[1], b.radius[1]) = (a.radius[0], b.radius[0]);
        let (s, t) = closest_on_segments(&a, &b);
        let cross = a.along.cross(b.along);
        let (fallback, _) = direction(cross, L::splat(1e-4), a.across);
        // Where the axes meet, the way out is square to both, on the side of b's centre.
        let fallback = fallback * fallback.dot(b.centre).sign();
        let least = L::splat(1e-5) * (a.radius[0] + b.radius[0]);
        let (normal, distance) = direction(b.at(t) - a.at(s), least, fallback);
        manifold(&a, &b, s, t, normal, distance, p.margin)
    }
}

kernel! {
    /// Capsules of which at least one is tapered.
    pub(crate) fn tapered_capsule_capsule<'a, L: Lanes>(p: &'a PairLanes<L>) -> ManifoldLanes<L> {
        let (a, b) = axes(p);
        let mut best = between_sides(&a, &b);
        for sign in [-1.0, 1.0] {
            // An end of a against b, then an end of b against a.
            let s = a.half * L::splat(sign);
            let (normal, distance, t, _) = b.reach(a.at(s));
            best.keep_nearer(Nearest::new(&a, &b, s, t, normal, distance));
            let t = b.half * L::splat(sign);
            let (normal, distance, s, _) = a.reach(b.at(t));
            best.keep_nearer(Nearest::new(&a, &b, s, t, -normal, distance));
        }
        manifold(&a, &b, best.s, best.t, best.normal, best.distance, p.margin)
    }
}

#[inline(always)]
fn axes<L: Lanes>(p: &PairLanes<L>) -> (Axis<L>, Axis<L>) {
    let m = p.rotation.to_matrix();
    let (x, y) = (Vec3::splat(glam::Vec3::X), Vec3::splat(glam::Vec3::Y));
    (Axis::new(&p.size_a, Vec3::zero(), y, x), Axis::new(&p.size_b, p.position, m.y, m.x))
}

/// Places of the closest points of two axes (Ericson, *Real-Time Collision Detection*, 5.1.9, with centres
/// and half lengths). If the axes are parallel: at the upper end of their overlap.
#[inline(always)]
fn closest_on_segments<L: Lanes>(a: &Axis<L>, b: &Axis<L>) -> (L, L) {
    let w = b.centre - a.centre;
    let cosine = a.along.dot(b.along);
    let (on_a, on_b) = (w.dot(a.along), w.dot(b.along));
    // The cross product keeps the digits that 1 - cosine^2 loses.
    let sine_squared = a.along.cross(b.along).length_squared();
    let parallel = sine_squared.lt(L::splat(1e-8));
    let crossing = (on_a - cosine * on_b) / L::select(parallel, L::one(), sine_squared);
    let upper = on_a + cosine.abs() * b.half;
    let s = L::select(parallel, upper, crossing).clamp(-a.half, a.half);
    let t = (cosine * s - on_b).clamp(-b.half, b.half);
    let s = (on_a + cosine * t).clamp(-a.half, a.half);
    (s, t)
}

/// A pair of balls, by their places on the axes.
#[derive(Clone, Copy)]
struct Nearest<L> {
    s: L,
    t: L,
    normal: Vec3<L>,
    /// Between the centres.
    distance: L,
    separation: L,
}

impl<L: Lanes> Nearest<L> {
    #[inline(always)]
    fn new(a: &Axis<L>, b: &Axis<L>, s: L, t: L, normal: Vec3<L>, distance: L) -> Self {
        let separation = distance - (a.radius_at(s) + b.radius_at(t));
        Nearest { s, t, normal, distance, separation }
    }

    #[inline(always)]
    fn keep_nearer(&mut self, other: Self) {
        let take = other.separation.lt(self.separation);
        self.s = L::select(take, other.s, self.s);
        self.t = L::select(take, other.t, self.t);
        self.normal = Vec3::select(take, other.normal, self.normal);
        self.distance = L::select(take, other.distance, self.distance);
        self.separation = L::select(take, other.separation, self.separation);
    }
}

/// The balls at which side meets side; infinitely far where they don't.
///
/// The normal n is known before the place: n.u = lean of a, n.v = -(lean of b), so n is a fixed combination
/// of the axes u, v and u x v. The places follow from pb(t) - pa(s) = k n.
#[inline(always)]
fn between_sides<L: Lanes>(a: &Axis<L>, b: &Axis<L>) -> Nearest<L> {
    let (u, v, w) = (a.along, b.along, b.centre - a.centre);
    let cosine = u.dot(v);
    let cross = u.cross(v);
    let sine_squared = cross.length_squared();
    let crossing = sine_squared.gt(L::splat(1e-6));
    let scale = L::one() / L::select(crossing, sine_squared, L::one());
    let (lean_a, lean_b) = (a.lean(), -b.lean());
    let along_u = (lean_a - cosine * lean_b) * scale;
    let along_v = (lean_b - cosine * lean_a) * scale;
    let rest = L::one() - (along_u * lean_a + along_v * lean_b);
    let height = (rest.max(L::zero()) * scale).sqrt() * cross.dot(w).sign();
    let n = u * along_u + v * along_v + cross * height;
    // (w + t v - s u) x n = 0, tested with the two directions in which v and u drop out.
    let (vn, un) = (v.cross(n), u.cross(n));
    let det = u.dot(vn);
    let solvable = det.abs().gt(L::splat(1e-6));
    let over = L::one() / L::select(solvable, det, L::one());
    let (s, t) = (w.dot(vn) * over, w.dot(un) * over);
    let valid = crossing
        & solvable
        & rest.gt(L::zero())
        & s.abs().le(a.half)
        & t.abs().le(b.half)
        & lean_a.abs().lt(L::one())
        & lean_b.abs().lt(L::one());
    let found = Nearest::new(a, b, s, t, n, (b.at(t) - a.at(s)).dot(n));
    Nearest { separation: L::select(valid, found.separation, L::splat(f32::INFINITY)), ..found }
}

/// Points of two capsules whose closest balls are at `s` and `t`.
///
/// Along the tangent that both follow, the overlap of the axes has two ends. An end is a point if the balls
/// there face each other nearly along the normal, so crossing capsules keep only the closest point. The
/// closest point takes the place of an end it is near to, or else is a third.
#[inline(always)]
fn manifold<L: Lanes>(
    a: &Axis<L>,
    b: &Axis<L>,
    s: L,
    t: L,
    normal: Vec3<L>,
    distance: L,
    margin: L,
) -> ManifoldLanes<L> {
    let (u, v) = (a.along, b.along);
    let (un, vn) = (u.dot(normal), v.dot(normal));
    // Side against side, within thirty degrees: at a cap there is nothing to lie on.
    let sides = (un - a.lean()).abs().lt(L::splat(0.5)) & (vn + b.lean()).abs().lt(L::splat(0.5));
    let (tangent, _) = direction(u - normal * un, L::splat(1e-3), a.across);
    let (ut, vt, start) = (u.dot(tangent), v.dot(tangent), (b.centre - a.centre).dot(tangent));
    let (reach_a, reach_b) = (a.half * ut.abs(), b.half * vt.abs());
    let low = (start - reach_b).max(-reach_a);
    let high = (start + reach_b).min(reach_a);
    let usable = sides & ut.gt(L::splat(0.5)) & vt.abs().gt(L::splat(0.5));
    let (over_u, over_v) =
        (L::one() / L::select(usable, ut, L::one()), L::one() / L::select(usable, vt, L::one()));
    let (low_s, high_s) = (low * over_u, high * over_u);
    let (ra, rb) = (a.radius_at(s), b.radius_at(t));
    let long = usable & (high - low).gt(L::splat(0.05) * (ra + rb));
    let binormal = normal.cross(tangent);

    let absent = L::splat(f32::INFINITY);
    // One after the other in a loop: a closure that is called twice would not be inlined.
    let mut ends = [(Vec3::zero(), absent); 2];
    for (end, (x, s_end)) in ends.iter_mut().zip([(low, low_s), (high, high_s)]) {
        let s_end = s_end.clamp(-a.half, a.half);
        let t_end = ((x - start) * over_v).clamp(-b.half, b.half);
        let (pa, pb) = (a.at(s_end), b.at(t_end));
        let (ra, rb) = (a.radius_at(s_end), b.radius_at(t_end));
        let d = pb - pa;
        let (ahead, aside) = (d.dot(normal), d.dot(binormal));
        let gap = L::select(ahead.gt(L::zero()), (ahead * ahead + aside * aside).sqrt(), ahead);
        // A tenth of the radii aside is half a percent of them in distance.
        let faces = long & aside.abs().le(L::splat(0.1) * (ra + rb));
        let position = (pa + pb + normal * (ra - rb)) * L::splat(0.5);
        *end = (position, L::select(faces, gap - (ra + rb), absent));
    }
    let [(mut at_low, mut sep_low), (mut at_high, mut sep_high)] = ends;

    let separation = distance - (ra + rb);
    let position = a.at(s) + normal * (ra + separation * L::splat(0.5));
    let near = (high_s - low_s) * L::splat(0.05);
    let is_low = sep_low.lt(absent) & (s - low_s).abs().le(near);
    let is_high = !is_low & sep_high.lt(absent) & (s - high_s).abs().le(near);
    (at_low, sep_low) = (Vec3::select(is_low, position, at_low), L::select(is_low, separation, sep_low));
    (at_high, sep_high) =
        (Vec3::select(is_high, position, at_high), L::select(is_high, separation, sep_high));
    let mut out = ManifoldLanes::single(normal, position, separation, margin);
    out.position = [at_low, at_high, position, Vec3::zero()];
    out.separation = [sep_low, sep_high, L::select(is_low | is_high, absent, separation), absent];
    out.key = [L::zero(), L::one(), L::splat(2.0), L::zero()];
    out
}

#[cfg(test)]
mod tests;
