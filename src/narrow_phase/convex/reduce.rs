//! Reduces many points to four.
//!
//! After Moravánszky and Terdiman (*Fast Contact Reduction for Dynamics Simulation*, Game Programming Gems 4,
//! 2004): points that lie together are merged (one round of k-means, with the deepest as seeds), the rest is
//! projected on the plane of contact, and the corner of their convex hull that takes least area with it goes,
//! until four are left. Any wrench that the contact can transmit is a blend of those at the corners of the
//! hull, so that area is the loss of a reduction. The deepest point always stays.

use crate::config::tuning::{POINT_CLUSTER, POINT_DEEPER};
use crate::lanes::Vec3 as LaneVec3;
use crate::narrow_phase::contacts::manifold::{MAX_POINTS, RawPoint};
use glam::{Vec2, Vec3};

/// Most points that are considered.
const MAX_CLOUD: usize = 64;

/// At most four of the points of one plane of contact, whose unit normal is given; the deepest first if any
/// had to go.
///
/// Depends on the order of the points only where two are equally good: then the first one stays.
pub(crate) fn reduce(points: &[RawPoint], normal: Vec3) -> ([RawPoint; MAX_POINTS], u32) {
    let mut out = [RawPoint::default(); MAX_POINTS];
    if points.len() <= MAX_POINTS {
        out[..points.len()].copy_from_slice(points);
        return (out, points.len() as u32);
    }
    let points = &points[..points.len().min(MAX_CLOUD)];
    let mut deepest = 0;
    // A later point has to be clearly deeper: the choice among corners that press alike must not flicker.
    let away = |p: &RawPoint| p.position.distance_squared(points[0].position);
    let clearly = POINT_DEEPER * points.iter().map(away).fold(0.0, f32::max).sqrt();
    for (i, point) in points.iter().enumerate() {
        if point.separation < points[deepest].separation - clearly {
            deepest = i;
        }
    }

    let lanes = LaneVec3::new(normal.x, normal.y, normal.z);
    let (u, v) = lanes.tangents();
    let (u, v) = (u.lane(0), v.lane(0));
    let origin = points[deepest].position;
    let flat = |p: &RawPoint| Vec2::new(u.dot(p.position - origin), v.dot(p.position - origin));
    let reach = points.iter().map(|p| flat(p).length_squared()).fold(0.0, f32::max);

    let mut seeds = [(Vec2::ZERO, 0usize); MAX_CLOUD];
    let count = seed_clusters(points, flat, deepest, POINT_CLUSTER * POINT_CLUSTER * reach, &mut seeds);
    if let Some(ends) = ends_of_line(&seeds[..count]) {
        out[0] = points[deepest];
        let mut kept = 1;
        for end in ends.into_iter().filter(|&end| end != deepest) {
            out[kept] = points[end];
            kept += 1;
        }
        return (out, kept as u32);
    }
    let mut hull = [(Vec2::ZERO, 0usize); MAX_CLOUD];
    let all = convex_hull(&mut seeds[..count], &mut hull);
    let keep = hull[..all].iter().any(|h| h.1 == deepest);
    let allowance = if keep { MAX_POINTS } else { MAX_POINTS - 1 };
    let mut left = hull;
    let corners = drop_least_corners(&mut left, all, allowance, deepest);
    let mut chosen = [(Vec2::ZERO, deepest); MAX_POINTS];
    let mut kept = 1;
    for &corner in left[..corners].iter().filter(|h| h.1 != deepest).take(MAX_POINTS - 1) {
        chosen[kept] = corner;
        kept += 1;
    }
    if kept == MAX_POINTS && all > allowance {
        exchange_for_area(&mut chosen, &hull[..all]);
    }
    for (to, from) in out.iter_mut().zip(&chosen[..kept]) {
        *to = points[from.1];
    }
    (out, kept as u32)
}

/// A point on the plane of contact, and its number among the points.
type Seed = (Vec2, usize);

/// One seed for each cluster of points: the deepest, then the points in order that are far from all seeds
/// before. `near`: square of the distance within which points are one. Says how many there are.
#[inline(always)]
fn seed_clusters(
    points: &[RawPoint],
    flat: impl Fn(&RawPoint) -> Vec2,
    deepest: usize,
    near: f32,
    seeds: &mut [Seed; MAX_CLOUD],
) -> usize {
    seeds[0] = (Vec2::ZERO, deepest);
    let mut count = 1;
    for (i, point) in points.iter().enumerate() {
        let at = flat(point);
        match seeds[..count].iter().position(|s| (s.0 - at).length_squared() <= near) {
            None => {
                seeds[count] = (at, i);
                count += 1;
            }
            // The deepest of a cluster represents it.
            Some(k) if k > 0 && point.separation < points[seeds[k].1].separation => seeds[k] = (at, i),
            Some(_) => {}
        }
    }
    count
}

/// Drops the corner that takes least area with it until there are `allowance`, but never the deepest. Says
/// how many are left.
#[inline(always)]
fn drop_least_corners(left: &mut [Seed; MAX_CLOUD], all: usize, allowance: usize, deepest: usize) -> usize {
    let mut corners = all;
    while corners > allowance {
        let area = |i: usize| {
            let (before, this) = (left[(i + corners - 1) % corners].0, left[i].0);
            (this - before).perp_dot(left[(i + 1) % corners].0 - this)
        };
        let mut least: Option<(usize, f32)> = None;
        for i in (0..corners).filter(|&i| left[i].1 != deepest) {
            let loss = area(i);
            // The last of equals goes.
            if least.is_none_or(|(_, best)| loss <= best * (1.0 + 1e-4)) {
                least = Some((i, loss));
            }
        }
        let Some((gone, _)) = least else { break };
        left.copy_within(gone + 1..corners, gone);
        corners -= 1;
    }
    corners
}

/// Corners that were removed one by one may be worth more than those that stayed: exchanges them while that
/// gains area.
#[inline(always)]
fn exchange_for_area(chosen: &mut [Seed; MAX_POINTS], hull: &[Seed]) {
    for _ in 0..2 {
        for place in 1..MAX_POINTS {
            for corner in hull {
                if chosen.iter().any(|c| c.1 == corner.1) {
                    continue;
                }
                let mut other = *chosen;
                other[place] = *corner;
                if area_of_four(&other) > area_of_four(chosen) * (1.0 + 1e-3) {
                    *chosen = other;
                }
            }
        }
    }
}

/// The ends of points that lie on a line, as the contact of a capsule with many triangles does: its area is
/// all rounding, and would choose any of them.
fn ends_of_line(points: &[Seed]) -> Option<[usize; 2]> {
    let furthest = |from: Vec2| {
        let away = |p: &Seed| (p.0 - from).length_squared();
        points
            .iter()
            .fold((from, 0, -1.0), |best, p| if away(p) > best.2 { (p.0, p.1, away(p)) } else { best })
    };
    let one = furthest(Vec2::ZERO);
    let other = furthest(one.0);
    let along = other.0 - one.0;
    let limit = POINT_CLUSTER * along.length_squared();
    points.iter().all(|p| along.perp_dot(p.0 - one.0).abs() <= limit).then_some([one.1, other.1])
}

/// Twice the area of the convex hull of four points in any order: as a quadrilateral with two of them as ends
/// of one diagonal, or as a triangle with the fourth inside.
fn area_of_four(p: &[Seed; 4]) -> f32 {
    let [a, b, c, d] = p.map(|p| p.0);
    let quad = |a: Vec2, b: Vec2, c: Vec2, d: Vec2| (b - a).perp_dot(d - c).abs();
    let triangle = |a: Vec2, b: Vec2, c: Vec2| (b - a).perp_dot(c - a).abs();
    let quads = quad(a, b, c, d).max(quad(a, c, b, d)).max(quad(a, d, b, c));
    quads.max(triangle(a, b, c)).max(triangle(a, b, d)).max(triangle(a, c, d)).max(triangle(b, c, d))
}

/// The corners of the convex hull, counter-clockwise: Andrew's monotone chain (1979). Sorts the points.
fn convex_hull(points: &mut [Seed], hull: &mut [Seed; MAX_CLOUD]) -> usize {
    points.sort_unstable_by(|a, b| a.0.x.total_cmp(&b.0.x).then(a.0.y.total_cmp(&b.0.y)).then(a.1.cmp(&b.1)));
    if points.len() < 3 {
        hull[..points.len()].copy_from_slice(points);
        return points.len();
    }
    let mut count = 0;
    let mut half = |points: &mut dyn Iterator<Item = &Seed>, hull: &mut [Seed; MAX_CLOUD]| {
        let base = count;
        for point in points {
            while count >= base + 2
                && (hull[count - 1].0 - hull[count - 2].0).perp_dot(point.0 - hull[count - 1].0) <= 0.0
            {
                count -= 1;
            }
            // Only NaN coordinates give a hull more corners than points.
            let Some(corner) = hull.get_mut(count) else { break };
            *corner = *point;
            count += 1;
        }
        // The last is the first of the other half.
        count -= 1;
        count
    };
    half(&mut points.iter(), hull);
    half(&mut points.iter().rev(), hull)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    fn area(points: &[Vec2]) -> f32 {
        let mut sorted: Vec<Seed> = points.iter().copied().zip(0..).collect();
        let mut hull = [(Vec2::ZERO, 0); MAX_CLOUD];
        let n = convex_hull(&mut sorted, &mut hull);
        (0..n).map(|i| hull[i].0.perp_dot(hull[(i + 1) % n].0) / 2.0).sum()
    }

    fn flat(points: &[RawPoint]) -> Vec<Vec2> {
        points.iter().map(|p| Vec2::new(p.position.x, p.position.z)).collect()
    }

    #[test]
    fn four_of_many_lose_little_area_against_the_best_four() {
        let mut random = Random(7);
        let (mut worst, mut sum) = (1.0f32, 0.0);
        for round in 0..300 {
            let n = 5 + random.below(12);
            let points: Vec<RawPoint> = (0..n)
                .map(|i| RawPoint {
                    position: random.cube() * Vec3::new(1.0, 0.0, 0.3 + (round % 3) as f32),
                    separation: -random.unit(),
                    key: i as u32,
                })
                .collect();
            let (four, count) = reduce(&points, Vec3::Y);
            let four = &four[..count as usize];
            let deepest = points.iter().map(|p| p.separation).fold(0.0, f32::min);
            assert!(four.iter().any(|p| p.separation == deepest));
            assert!(four.iter().all(|p| points.contains(p)));
            // Brute force: every four that have the deepest.
            let first = points.iter().position(|p| p.separation == deepest).unwrap();
            let mut best = 0.0f32;
            for a in 0..n {
                for b in 0..a {
                    for c in 0..b {
                        best = best.max(area(&flat(&[points[first], points[a], points[b], points[c]])));
                    }
                }
            }
            let share = area(&flat(four)) / best;
            worst = worst.min(share);
            sum += share / 300.0;
        }
        println!("area against the best four: worst {worst}, mean {sum}");
        assert!(worst > 0.7 && sum > 0.95, "worst {worst} mean {sum}");
    }

    /// A wrench of unit forces along the normal is its centre of pressure: how far the points' hull reaches.
    #[test]
    fn a_regular_polygon_keeps_its_reach_in_every_direction() {
        for n in [8, 16, 32] {
            let points: Vec<RawPoint> = (0..n)
                .map(|i| {
                    let angle = i as f32 / n as f32 * std::f32::consts::TAU;
                    let position = Vec3::new(libm::cosf(angle), 0.0, libm::sinf(angle));
                    RawPoint { position, separation: -0.01, key: i }
                })
                .collect();
            let (four, count) = reduce(&points, Vec3::Y);
            assert_eq!(count, 4);
            // An inscribed square has 2 of the circle's pi; any four points have no more.
            assert!(area(&flat(&four)) > 1.7, "{}", area(&flat(&four)));
            for k in 0..64 {
                let angle = k as f32 / 64.0 * std::f32::consts::TAU;
                let d = Vec2::new(libm::cosf(angle), libm::sinf(angle));
                let reach = flat(&four).iter().map(|p| p.dot(d)).fold(f32::MIN, f32::max);
                assert!(reach > 0.35, "{reach} towards {d}");
            }
        }
    }

    #[test]
    fn points_on_a_line_or_on_top_of_each_other_are_no_trouble() {
        let at = |x: f32, key| RawPoint { position: Vec3::X * x, separation: 0.0, key };
        let line: Vec<RawPoint> = (0..9).map(|i| at(i as f32, i)).collect();
        let (four, count) = reduce(&line, Vec3::Y);
        assert!(count >= 2 && four[..count as usize].iter().any(|p| p.position.x == 8.0));
        assert!(four[..count as usize].iter().any(|p| p.position.x == 0.0));
        let (_, count) = reduce(&[at(1.0, 0); 9], Vec3::Y);
        assert_eq!(count, 1);
        assert_eq!(reduce(&[], Vec3::Y).1, 0);
        assert_eq!(reduce(&line[..3], Vec3::Y).1, 3);
    }
}
