//! Where a part is cut: where the hulls of both sides are smallest together.

use super::super::hull::build;
use super::part::{Part, Plane, Touch, crossing};
use super::solid::{Solid, place};
use glam::DVec3;

/// Looks for planes.
pub(super) struct Cutter<'a> {
    solid: &'a Solid,
    resolution: u32,
    directions: Vec<DVec3>,
}

/// The furthest points in each direction, of which a hull is nearly made.
#[derive(Clone)]
struct Supports(Vec<(f64, DVec3)>);

/// Supports on both sides of the planes across an axis.
struct Sides<'a> {
    directions: &'a [DVec3],
    planes: Vec<i64>,
    /// Of points first below plane `i`, and of points last above plane `i - 1`.
    below: Vec<Supports>,
    above: Vec<Supports>,
}

impl<'a> Cutter<'a> {
    pub(super) fn new(solid: &'a Solid, resolution: u32) -> Self {
        // All that whole numbers up to two give.
        let number = -2..=2;
        let mut directions = Vec::new();
        for x in number.clone() {
            for y in number.clone() {
                directions.extend(number.clone().map(|z| DVec3::new(x.into(), y.into(), z.into())));
            }
        }
        // Half of a longer one is there already; zero is no direction.
        directions.retain(|d| d.to_array().iter().any(|x| x.abs() == 1.0));
        Cutter { solid, resolution, directions }
    }

    /// The best plane; nothing if the part is too small to be cut.
    pub(super) fn best(&self, part: &Part) -> Option<Plane> {
        let mut best: Option<(f64, Plane)> = None;
        for axis in 0..3 {
            let mut sides = Sides::new(&self.directions, planes(part, axis, self.resolution));
            self.sort(part, axis, &mut sides);
            for (at, below, above) in sides.volumes() {
                // Where many planes are alike, as across a ring, the one in the middle leads to fewer pieces.
                let balance = (below - above).abs() / (below + above).max(f64::MIN_POSITIVE);
                let cost = below + above + BALANCE * part.excess() * balance;
                if best.is_none_or(|(least, _)| cost < least) {
                    best = Some((cost, Plane { axis, at }));
                }
            }
        }
        best.map(|(_, plane)| plane)
    }

    /// Gives the points of a part to the sides of planes across an axis.
    fn sort(&self, part: &Part, axis: usize, sides: &mut Sides) {
        for (triangle, polygon) in part.surface.polygons() {
            let touch = Touch::of(polygon, self.solid, triangle, axis);
            let mut a = polygon[polygon.len() - 1];
            for &b in polygon {
                sides.add(b, axis, &touch);
                let (from, to) = (a[axis].min(b[axis]), a[axis].max(b[axis]));
                for i in sides.crossed(from, to) {
                    sides.add_on(i, crossing(a, b, axis, sides.planes[i] as f64), [true; 2]);
                }
                a = b;
            }
        }
        for &corner in &part.inner {
            let end = if corner[axis] <= part.low[axis] as f64 { 0 } else { sides.planes.len() };
            sides.add_between(end, corner);
        }
        for i in 0..sides.planes.len() {
            for corner in 0..4 {
                let (mut at, mut signs) = ([sides.planes[i]; 3], [0; 3]);
                for (k, a) in [(axis + 1) % 3, (axis + 2) % 3].into_iter().enumerate() {
                    let is_high = corner >> k & 1 == 1;
                    (at[a], signs[a]) = if is_high { (part.high[a], -1) } else { (part.low[a], 1) };
                }
                let is_inside = [-1, 1].map(|sign| {
                    signs[axis] = sign;
                    self.solid.is_beside(&part.column, at, signs)
                });
                sides.add_on(i, place(at), is_inside);
            }
        }
    }
}

// Guard: a share of the excess, so that it decides between equal planes only.
const BALANCE: f64 = 0.05;

/// Planes across a part, evenly, but at the nearest corners of polygons where there are some.
fn planes(part: &Part, axis: usize, resolution: u32) -> Vec<i64> {
    let mut corners: Vec<i64> = part.surface.points().iter().map(|p| p[axis].round() as i64).collect();
    corners.sort_unstable();
    corners.dedup();
    let (low, high) = (part.low[axis], part.high[axis]);
    let spacing = (high - low) / i64::from(resolution + 1);
    let mut planes: Vec<i64> = (1..=i64::from(resolution))
        .map(|k| {
            let even = low + (high - low) * k / i64::from(resolution + 1);
            let next = corners.partition_point(|&corner| corner < even);
            let near = corners[next.saturating_sub(1)..corners.len().min(next + 1)].iter();
            let nearest = near.copied().min_by_key(|corner| (corner - even).abs());
            nearest.filter(|corner| 2 * (corner - even).abs() <= spacing).unwrap_or(even)
        })
        .filter(|&at| low < at && at < high)
        .collect();
    planes.sort_unstable();
    planes.dedup();
    planes
}

impl Supports {
    fn new(count: usize) -> Self {
        Supports(vec![(f64::MIN, DVec3::ZERO); count])
    }

    fn join(&mut self, other: &Supports) {
        for (own, other) in self.0.iter_mut().zip(&other.0) {
            if other.0 > own.0 {
                *own = *other;
            }
        }
    }

    fn volume(&self, points: &mut Vec<DVec3>) -> f64 {
        points.clear();
        for &(distance, point) in &self.0 {
            if distance > f64::MIN && !points.contains(&point) {
                points.push(point);
            }
        }
        build::measure(points).map_or(0.0, |(volume, _)| volume)
    }
}

impl<'a> Sides<'a> {
    fn new(directions: &'a [DVec3], planes: Vec<i64>) -> Self {
        let bins = vec![Supports::new(directions.len()); planes.len() + 1];
        Sides { directions, planes, below: bins.clone(), above: bins }
    }

    /// A corner of a polygon: below the planes that it is not above, and so on, as far as the polygon is.
    fn add(&mut self, point: DVec3, axis: usize, touch: &Touch) {
        let at = point[axis];
        let (lower, upper) = (self.from(at), self.until(at));
        let below = if lower < upper && !touch.is_below(at) { upper } else { lower };
        let above = if lower < upper && !touch.is_above(at) { lower } else { upper };
        self.put(point, below, above);
    }

    /// A point on a plane that is on these sides of it.
    fn add_on(&mut self, plane: usize, point: DVec3, [below, above]: [bool; 2]) {
        match (below, above) {
            (true, true) => self.put(point, plane, plane + 1),
            (true, false) => self.put(point, plane, plane),
            (false, true) => self.put(point, plane + 1, plane + 1),
            (false, false) => {}
        }
    }

    /// A point above the planes before `end` and below the others.
    fn add_between(&mut self, end: usize, point: DVec3) {
        self.put(point, end, end);
    }

    fn put(&mut self, point: DVec3, below: usize, above: usize) {
        for (i, direction) in self.directions.iter().enumerate() {
            let distance = direction.dot(point);
            for best in [&mut self.below[below].0[i], &mut self.above[above].0[i]] {
                if distance > best.0 {
                    *best = (distance, point);
                }
            }
        }
    }

    /// The first plane that is not below a place, and the first above it.
    fn from(&self, at: f64) -> usize {
        self.planes.partition_point(|&plane| (plane as f64) < at)
    }
    fn until(&self, at: f64) -> usize {
        self.planes.partition_point(|&plane| plane as f64 <= at)
    }

    fn crossed(&self, from: f64, to: f64) -> std::ops::Range<usize> {
        let start = self.until(from);
        start..self.from(to).max(start)
    }

    /// Each plane with the volumes of the hulls below and above it.
    fn volumes(mut self) -> Vec<(i64, f64, f64)> {
        let mut points = Vec::new();
        for i in 1..self.below.len() {
            let (before, after) = self.below.split_at_mut(i);
            after[0].join(&before[i - 1]);
        }
        for i in (1..self.above.len()).rev() {
            let (before, after) = self.above.split_at_mut(i);
            before[i - 1].join(&after[0]);
        }
        (0..self.planes.len())
            .map(|i| {
                let below = self.below[i].volume(&mut points);
                (self.planes[i], below, self.above[i + 1].volume(&mut points))
            })
            .collect()
    }
}
