//! Capsule against box, in the frame of the box.
//!
//! The axis point nearest to the box is the root of a monotone function that is linear between the places
//! where the axis crosses the planes of the faces: no search, no case per feature. It fixes the normal,
//! exactly so at edges and vertices too. Where the axis itself runs through the box, the normal is that of
//! the least separating-axis overlap instead. The ends of the stretch that faces the box then make up to two
//! points.

use super::lanes_io::{ManifoldLanes, PairLanes, direction};
use super::sphere_capsule::Axis;
use crate::lanes::{Lanes, Mask, Vec3, kernel};

kernel! {
    /// Uniform capsules; the bottom radius counts.
    pub(crate) fn capsule_box<'a, L: Lanes>(p: &'a PairLanes<L>) -> ManifoldLanes<L> {
        collide::<L, false>(p)
    }
}

kernel! {
    /// Tapered capsules, in a bin of their own.
    pub(crate) fn tapered_capsule_box<'a, L: Lanes>(p: &'a PairLanes<L>) -> ManifoldLanes<L> {
        collide::<L, true>(p)
    }
}

#[inline(always)]
fn collide<L: Lanes, const TAPERED: bool>(p: &PairLanes<L>) -> ManifoldLanes<L> {
    let axes = p.rotation.to_matrix();
    let half = Vec3::new(p.size_b[0], p.size_b[1], p.size_b[2]);
    let along = Vec3::new(axes.x.y, axes.y.y, axes.z.y);
    let mut a = Axis::new(&p.size_a, -axes.mul_transposed(p.position), along, along);
    if !TAPERED {
        a.radius[1] = a.radius[0];
    }
    let planes = Planes::new(&a, half);

    let t = planes.nearest::<TAPERED>(&a, half);
    let excess = excess(a.at(t), half);
    let scale = a.half + half.x + half.y + half.z;
    let (outwards, distance) = direction(excess, L::splat(1e-6) * scale, Vec3::splat(glam::Vec3::X));
    let through = distance.le(L::splat(1e-6) * scale);
    let way_out = if through.any() { Some(least_overlap::<L, TAPERED>(&a, half)) } else { None };
    let mut outwards = outwards;
    let mut near = t;
    if let Some((normal, place)) = way_out {
        outwards = Vec3::select(through, normal, outwards);
        near = L::select(through, place, near);
    }

    // The stretch of the axis over the box: within the faces that the normal is nearly square to.
    let (low, high) = planes.stretch(&a, outwards);
    let faces = low.le(high);
    let near = L::select(through & faces, near.clamp(low, high), near);
    let support = outwards.abs().dot(half);
    let low_is_near = (near - low).abs().le((near - high).abs());
    let far = L::select(low_is_near, high, low);
    // One after the other in a loop: a closure that is called twice would not be inlined.
    let mut points = [(Vec3::zero(), L::zero(), through); 2];
    for (point, t) in points.iter_mut().zip([near, far.clamp(-a.half, a.half)]) {
        let at = a.at(t);
        let radius = a.radius_at(t);
        let own = self::excess(at, half);
        let own_distance = own.length();
        let gap = L::select(through, at.dot(outwards) - support, own_distance);
        // A ball with another way to the box than the manifold's is not part of it.
        let agrees = through | own.dot(outwards).ge(L::splat(0.9) * own_distance);
        let separation = gap - radius;
        *point = (at - outwards * (radius + separation * L::splat(0.5)), separation, agrees);
    }
    let [(near_position, near_separation, _), (far_position, far_separation, agrees)] = points;
    let apart = (far - near).abs().gt(L::splat(0.05) * a.radius_at(near));
    let two = faces & agrees & apart;

    let back = |x: Vec3<L>| p.position + axes.mul(x);
    let mut out = ManifoldLanes::single(-axes.mul(outwards), back(near_position), near_separation, p.margin);
    out.position[1] = back(far_position);
    out.separation[1] = L::select(two, far_separation, out.separation[1]);
    // Keyed by the end of the stretch, so that swapping which is nearer changes nothing.
    out.key[0] = L::select(low_is_near, L::zero(), L::one());
    out.key[1] = L::one() - out.key[0];
    out
}

/// From the box to a point; zero within it.
#[inline(always)]
fn excess<L: Lanes>(point: Vec3<L>, half: Vec3<L>) -> Vec3<L> {
    point - point.max(-half).min(half)
}

/// Where the axis crosses the planes of the faces, by box axis: lower and upper place.
struct Planes<L> {
    cross: [[L; 2]; 3],
}

impl<L: Lanes> Planes<L> {
    #[inline(always)]
    fn new(a: &Axis<L>, half: Vec3<L>) -> Self {
        let (c, u) = (a.centre, a.along);
        let mut cross = [[L::zero(); 2]; 3];
        let axes = [(c.x, u.x, half.x), (c.y, u.y, half.y), (c.z, u.z, half.z)];
        for (cross, (centre, along, half)) in cross.iter_mut().zip(axes) {
            let tiny = L::splat(1e-12);
            // Parallel: both crossings are far away, on either side or (outside the planes) on one.
            let slope = L::select(along.abs().gt(tiny), along, tiny);
            let (x, y) = ((-half - centre) / slope, (half - centre) / slope);
            *cross = [x.min(y), x.max(y)];
        }
        Planes { cross }
    }

    /// Place of the ball nearest to the box. Half the derivative of the squared distance is `along . excess`,
    /// monotone and linear between crossings; a taper adds its slope to the derivative of the distance.
    #[inline(always)]
    fn nearest<const TAPERED: bool>(&self, a: &Axis<L>, half: Vec3<L>) -> L {
        // The radius grows along the axis by this.
        let growth = -a.lean();
        let (mut low, mut high) = (-a.half, a.half);
        let mut rate_low = rate::<L, TAPERED>(a, half, growth, low);
        let mut rate_high = rate::<L, TAPERED>(a, half, growth, high);
        for crossing in self.cross.as_flattened() {
            let t = crossing.clamp(-a.half, a.half);
            let rate = rate::<L, TAPERED>(a, half, growth, t);
            let falls = rate.le(L::zero());
            let lower = falls & t.gt(low);
            let upper = !falls & t.lt(high);
            (low, rate_low) = (L::select(lower, t, low), L::select(lower, rate, rate_low));
            (high, rate_high) = (L::select(upper, t, high), L::select(upper, rate, rate_high));
        }
        if TAPERED {
            return self.nearest_in(a, half, low, high, growth);
        }
        // At an end the root may lie outside. 0 / 0 (flat all along) is caught by max, which answers 0.
        let share = (-rate_low / (rate_high - rate_low)).max(L::zero()).min(L::one());
        low + (high - low) * share
    }

    /// The taper's root between neighbouring crossings: there the excess is a straight line e + t w, and the
    /// balls lean against it as against a point (see `sphere_capsule.rs`).
    #[inline(always)]
    fn nearest_in(&self, a: &Axis<L>, half: Vec3<L>, low: L, high: L, growth: L) -> L {
        let middle = (low + high) * L::splat(0.5);
        let e = excess(a.at(middle), half);
        let zero = L::zero();
        let live = |e: L, u: L| L::select(e.eq(zero), zero, u);
        let w = Vec3::new(live(e.x, a.along.x), live(e.y, a.along.y), live(e.z, a.along.z));
        let speed_squared = w.length_squared();
        let moving = speed_squared.gt(L::splat(1e-12));
        let squared = L::select(moving, speed_squared, L::one());
        let root = middle - e.dot(w) / squared;
        let aside = e.cross(w).length();
        // tan of the lean, within the plane of e and w
        let steep = (squared - growth * growth).max(L::splat(1e-30)).sqrt();
        let t = root + aside * growth / (steep * squared);
        let runs_out = !moving | (growth * growth).ge(squared);
        let end = L::select(growth.gt(zero), high, low);
        L::select(runs_out, end, t).clamp(low, high)
    }

    /// The places between which the axis is over the box, seen along the normal; empty if low > high.
    #[inline(always)]
    fn stretch(&self, a: &Axis<L>, normal: Vec3<L>) -> (L, L) {
        let (mut low, mut high) = (-a.half, a.half);
        for (&[from, to], n) in self.cross.iter().zip([normal.x, normal.y, normal.z]) {
            // Sixty degrees: between face, edge and vertex, no plane that the normal leans into cuts.
            let side = n.abs().lt(L::splat(0.5));
            low = L::select(side, low.max(from), low);
            high = L::select(side, high.min(to), high);
        }
        (low, high)
    }
}

/// See [`Planes::nearest`].
#[inline(always)]
fn rate<L: Lanes, const TAPERED: bool>(a: &Axis<L>, half: Vec3<L>, growth: L, t: L) -> L {
    let e = excess(a.at(t), half);
    let rate = e.dot(a.along);
    if TAPERED { rate / e.length().max(L::splat(1e-15)) - growth } else { rate }
}

/// Where the axis runs through the box: the separating axis of least overlap (faces, and edges crossed with
/// the capsule's side), pointing out of the box, and the place of the deepest ball.
#[inline(always)]
fn least_overlap<L: Lanes, const TAPERED: bool>(a: &Axis<L>, half: Vec3<L>) -> (Vec3<L>, L) {
    let (c, u, zero) = (a.centre, a.along, L::zero());
    let growth = -a.lean();
    let mean = (a.radius[0] + a.radius[1]) * L::splat(0.5);
    let (c3, u3, h3) = ([c.x, c.y, c.z], [u.x, u.y, u.z], [half.x, half.y, half.z]);

    // The side of the capsule's centre is the nearer one, but a taper can turn that round.
    let turns: &[f32] = if TAPERED { &[1.0, -1.0] } else { &[1.0] };

    let mut best = L::splat(f32::NEG_INFINITY);
    let (mut normal, mut place) = (Vec3::zero(), zero);
    for k in 0..3 {
        for &turn in turns {
            let sign = c3[k].sign() * L::splat(turn);
            let (middle, rise) = (sign * c3[k], sign * u3[k] * a.half);
            let (bottom, top) = (middle - rise - a.radius[0], middle + rise - a.radius[1]);
            // The ball that reaches furthest back.
            let end = L::select(bottom.lt(top), -a.half, a.half);
            let overlap = bottom.min(top) - h3[k];
            let take = overlap.gt(best);
            best = overlap.max(best);
            let axis = |i: usize| if i == k { sign } else { zero };
            normal = Vec3::select(take, Vec3::new(axis(0), axis(1), axis(2)), normal);
            place = L::select(take, end, place);
        }
    }
    // An edge must be better by something, or flat contact would flicker.
    best += L::splat(1e-3) * (half.x.min(half.y).min(half.z) + mean);
    for k in 0..3 {
        let keep = |v: Vec3<L>| {
            Vec3::new(
                if k == 0 { zero } else { v.x },
                if k == 1 { zero } else { v.y },
                if k == 2 { zero } else { v.z },
            )
        };
        let (flat, centre, edge) = (keep(u), keep(c), keep(half));
        let squared = flat.length_squared();
        // Square to the edge and leaning as the side does: normal . along = growth.
        let lean = growth * growth;
        let exists = squared.gt(L::splat(1e-6)) & lean.lt(squared);
        let over = L::one() / L::select(exists, squared, L::one());
        let across = match k {
            0 => Vec3::new(zero, u.z, -u.y),
            1 => Vec3::new(-u.z, zero, u.x),
            _ => Vec3::new(u.y, -u.x, zero),
        };
        let height = ((L::one() - lean * over).max(zero) * over).sqrt();
        let toward = across.dot(centre).sign();
        for &turn in turns {
            let n = flat * (growth * over) + across * (height * toward * L::splat(turn));
            let overlap = n.dot(centre) - mean - n.abs().dot(edge);
            let take = exists & overlap.gt(best);
            best = L::select(take, overlap, best);
            normal = Vec3::select(take, n, normal);
            let corner = Vec3::new(edge.x * n.x.sign(), edge.y * n.y.sign(), edge.z * n.z.sign());
            let across_edge = -((centre - corner).dot(flat) * over);
            place = L::select(take, across_edge.clamp(-a.half, a.half), place);
        }
    }
    (normal, place)
}

#[cfg(test)]
mod tests;
