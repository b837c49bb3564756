//! Quickhull: a triangulated convex hull out of points (Barber, Dobkin and Huhdanpaa, *The Quickhull
//! algorithm for convex hulls*, 1996). `hull_merge` then makes polygons of the triangles.
//!
//! Two tolerances keep it out of trouble. A point becomes a vertex only if it stands out by more than the
//! noise of f32 coordinates (`Tolerance::noise`). But once it is a vertex, all that it sees by more than the
//! rounding of f64 (`Tolerance::rounding`, a millionth of that) gives way, so the triangles are convex to f64
//! and never a patchwork of nearly coplanar guesses. Among equally good points the one that is extreme in two
//! further directions is taken, a corner rather than the middle of a face, so no three vertices are on a
//! line.

use super::HullEdge;
use super::merge;
use crate::error::Error;
use glam::{DVec3, Vec3};

/// A closed convex polyhedron, as the builder hands it over.
pub(crate) struct Polyhedron {
    /// Which of the points are vertices, ascending.
    pub(crate) vertices: Vec<u32>,
    /// Indices into `vertices`, counter-clockwise from outside.
    pub(crate) faces: Vec<Vec<u16>>,
    /// Unit outward normals of the faces.
    pub(crate) normals: Vec<DVec3>,
    pub(crate) edges: Vec<HullEdge>,
    /// How far the furthest point is outside [m].
    pub(crate) left_out: f64,
}

/// Lengths below which two things are one [m].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tolerance {
    /// Error of coordinates that were rounded to f32.
    pub(crate) noise: f64,
    /// Error of sums and products in f64.
    pub(crate) rounding: f64,
}

impl Tolerance {
    fn of(min: DVec3, max: DVec3) -> Self {
        // Three times the unit in the last place, on each axis: a plane of vertices that are off by one, seen
        // from a vertex that is off the other way. Coordinates far from zero are coarser, so size alone would
        // not do.
        let noise = 3.0 * f64::from(f32::EPSILON) * min.abs().max(max.abs()).element_sum();
        Tolerance { noise, rounding: 1e-13 * (max - min).element_sum() }
    }
}

/// The hull of `points` with at most `most` vertices.
pub(crate) fn build(points: &[Vec3], most: usize) -> Result<Polyhedron, Error> {
    if points.len() < 4 {
        return Err(Error::Degenerate(format!("a hull needs four points, but there are {}", points.len())));
    }
    if points.len() > u32::MAX as usize / 2 {
        return Err(Error::TooMany { what: "hull points", most: u64::from(u32::MAX / 2) });
    }
    let mut min = points[0].as_dvec3();
    let mut max = min;
    for p in points {
        (min, max) = (min.min(p.as_dvec3()), max.max(p.as_dvec3()));
    }
    let tolerance = Tolerance::of(min, max);
    // Around the middle, differences of f32 numbers are exact in f64.
    let middle = ((min + max) * 0.5).as_vec3().as_dvec3();
    let local: Vec<DVec3> = points.iter().map(|p| p.as_dvec3() - middle).collect();

    let all: Vec<u32> = (0..points.len() as u32).collect();
    let start = first_tetrahedron(&local, &all, tolerance, 4.0 * tolerance.noise)?;
    let mut hull = Quickhull::new(&local, &all, start, tolerance.noise, tolerance.rounding);
    let left_out = hull.grow(most).max(0.0);
    merge::polygons(&local, hull.triangles(), tolerance, left_out)
}

/// Volume of the hull of points on a grid, in its steps cubed, and which of them are its corners; nothing if
/// all are within two steps of a plane.
pub(crate) fn measure(points: &[DVec3]) -> Option<(f64, Vec<u32>)> {
    let first = *points.first()?;
    let (min, max) = points.iter().fold((first, first), |(min, max), &p| (min.min(p), max.max(p)));
    let tolerance = Tolerance { noise: 0.5, rounding: 1e-13 * (max - min).element_sum() };
    let all: Vec<u32> = (0..points.len() as u32).collect();
    let start = first_tetrahedron(points, &all, tolerance, 2.0).ok()?;
    let mut hull = Quickhull::new(points, &all, start, tolerance.noise, tolerance.rounding);
    hull.grow(points.len());
    let triangles = hull.triangles();
    let inside = points[start[0] as usize];
    let volume = triangles.iter().map(|t| (t.offset - t.normal.dot(inside)) * t.area / 3.0).sum();
    let mut corners: Vec<u32> = triangles.iter().flat_map(|t| t.vertices).collect();
    corners.sort_unstable();
    corners.dedup();
    Some((volume, corners))
}

/// A corner of the triangulated hull: three vertices counter-clockwise from outside, and the triangle across
/// the edge from each vertex to the next.
#[derive(Clone, Debug)]
pub(crate) struct Triangle {
    pub(crate) vertices: [u32; 3],
    pub(crate) across: [u32; 3],
    /// Unit outward normal n, and the offset n·x on the triangle.
    pub(crate) normal: DVec3,
    pub(crate) offset: f64,
    pub(crate) area: f64,
}

impl Triangle {
    fn new(points: &[DVec3], vertices: [u32; 3]) -> Self {
        let [a, b, c] = vertices.map(|v| points[v as usize]);
        let cross = (b - a).cross(c - a);
        let twice = cross.length();
        // A triangle without area has no normal, and sees nothing.
        let normal = if twice > 0.0 { cross / twice } else { DVec3::ZERO };
        Triangle { vertices, across: [NONE; 3], normal, offset: normal.dot(a), area: 0.5 * twice }
    }
    /// Distance of a point from the plane, positive outside.
    pub(crate) fn height(&self, p: DVec3) -> f64 {
        self.normal.dot(p) - self.offset
    }
}

const NONE: u32 = u32::MAX;

/// A triangle while the hull grows, with the points that it sees.
struct Face {
    triangle: Triangle,
    /// By any height above rounding; points below noise become no vertices, but are kept.
    outside: Vec<u32>,
    /// The greatest height among `outside`.
    furthest: f64,
    alive: bool,
}

impl Face {
    fn measure(&mut self, points: &[DVec3]) {
        let heights = self.outside.iter().map(|&p| self.triangle.height(points[p as usize]));
        self.furthest = heights.fold(0.0, f64::max);
    }
}

pub(crate) struct Quickhull<'a> {
    points: &'a [DVec3],
    faces: Vec<Face>,
    alive: usize,
    /// A point further outside than this has to become a vertex.
    noise: f64,
    /// A point further outside than this sees a face.
    rounding: f64,
    visible: Vec<u32>,
    is_visible: Vec<bool>,
    /// Edges between faces that the new vertex sees and others: vertices and the face that stays.
    horizon: Vec<(u32, u32, u32)>,
    orphans: Vec<u32>,
}

impl<'a> Quickhull<'a> {
    /// Starts with a tetrahedron; `noise` is how far outside a point must be to count.
    pub(crate) fn new(
        points: &'a [DVec3],
        subset: &[u32],
        start: [u32; 4],
        noise: f64,
        rounding: f64,
    ) -> Self {
        let [a, b, c, d] = start;
        let mut hull = Quickhull {
            points,
            faces: Vec::new(),
            alive: 0,
            noise,
            rounding,
            visible: Vec::new(),
            is_visible: Vec::new(),
            horizon: Vec::new(),
            orphans: subset.to_vec(),
        };
        // `d` is below the triangle a, b, c. Neighbours by hand: face 0 is the base, face i has base edge i -
        // 1.
        for (vertices, across) in
            [([a, b, c], [1, 2, 3]), ([b, a, d], [0, 3, 2]), ([c, b, d], [0, 1, 3]), ([a, c, d], [0, 2, 1])]
        {
            hull.push(Triangle { across, ..Triangle::new(points, vertices) });
        }
        hull.share_orphans(0);
        hull
    }

    /// Adds the furthest point until none is outside, or there are `most` vertices. Returns how far the
    /// furthest of the points that were left is outside.
    pub(crate) fn grow(&mut self, most: usize) -> f64 {
        let mut left_out = 0.0_f64;
        // Every round takes a point for good. A closed surface of triangles has 2 V - 4 of them.
        loop {
            let full = self.alive + 4 >= 2 * most;
            let furthest = self.furthest_face().filter(|_| !full);
            let Some(face) = furthest.or_else(|| self.look_again()).filter(|_| !full) else { break };
            let point = self.furthest_point(face);
            if !self.add(face as u32, point) {
                // Rounding left no clean horizon: do without this point.
                let face = &mut self.faces[face];
                left_out = left_out.max(face.triangle.height(self.points[point as usize]));
                face.outside.retain(|&p| p != point);
                face.measure(self.points);
            }
        }
        self.faces.iter().filter(|f| f.alive).map(|f| f.furthest).fold(left_out, f64::max)
    }

    /// Moves every point that is left to the face that it is furthest outside of. Beside a sharp edge, a
    /// point just above one face may be far outside one that came later. Returns a face with a point that
    /// counts.
    fn look_again(&mut self) -> Option<usize> {
        for face in 0..self.faces.len() {
            let outside = std::mem::take(&mut self.faces[face].outside);
            for &point in &outside {
                let p = self.points[point as usize];
                self.find_visible(face as u32, p);
                let (mut best, mut height) = (face, f64::MIN);
                for &seen in &self.visible {
                    let h = self.faces[seen as usize].triangle.height(p);
                    if h > height {
                        (best, height) = (seen as usize, h);
                    }
                }
                self.forget_visible();
                self.faces[best].outside.push(point);
            }
        }
        for face in self.faces.iter_mut().filter(|f| f.alive) {
            face.measure(self.points);
        }
        self.furthest_face()
    }

    /// The triangles of the hull, neighbours by their index in the list.
    pub(crate) fn triangles(&self) -> Vec<Triangle> {
        let mut renamed = vec![NONE; self.faces.len()];
        let alive = self.faces.iter().enumerate().filter(|(_, f)| f.alive);
        for (new, (old, _)) in alive.clone().enumerate() {
            renamed[old] = new as u32;
        }
        alive
            .map(|(_, f)| Triangle {
                across: f.triangle.across.map(|o| renamed[o as usize]),
                ..f.triangle.clone()
            })
            .collect()
    }

    /// The face with a point furthest outside: the order in which points matter, should there be too many.
    fn furthest_face(&self) -> Option<usize> {
        let mut best = None;
        let mut most = self.noise;
        for (i, face) in self.faces.iter().enumerate() {
            if face.alive && face.furthest > most {
                (best, most) = (Some(i), face.furthest);
            }
        }
        best
    }

    /// The furthest point outside a face; among equals, one that is extreme along the face too.
    fn furthest_point(&self, face: usize) -> u32 {
        let Face { triangle, outside, .. } = &self.faces[face];
        extreme(self.points, outside, triangle.normal, self.rounding)
    }

    /// Makes a point a vertex: removes all faces that it sees and closes the hole with new ones. Says no, and
    /// changes nothing, if the hole isn't a disk.
    fn add(&mut self, seen: u32, point: u32) -> bool {
        let p = self.points[point as usize];
        self.find_horizon(seen, p);
        if !self.sort_horizon() {
            self.forget_visible();
            return false;
        }
        let first = self.faces.len() as u32;
        let count = self.horizon.len() as u32;
        let horizon = std::mem::take(&mut self.horizon);
        let fan: Vec<Triangle> =
            horizon.iter().map(|&(a, b, _)| Triangle::new(self.points, [a, b, point])).collect();
        if fan.iter().any(|t| t.area == 0.0) {
            self.horizon = horizon;
            self.forget_visible();
            return false;
        }
        for &v in &self.visible {
            let face = &mut self.faces[v as usize];
            face.alive = false;
            // The buffer goes with the face: a dead one must not hold on to it.
            self.orphans.append(&mut std::mem::take(&mut face.outside));
        }
        self.alive -= self.visible.len();
        self.forget_visible();
        for (i, (mut triangle, &(a, _, stays))) in fan.into_iter().zip(&horizon).enumerate() {
            let i = i as u32;
            triangle.across = [stays, first + (i + 1) % count, first + (i + count - 1) % count];
            let beyond = &mut self.faces[stays as usize].triangle;
            for edge in 0..3 {
                // The face that stays has the edge the other way round.
                if beyond.vertices[(edge + 1) % 3] == a {
                    beyond.across[edge] = first + i;
                }
            }
            self.push(triangle);
        }
        self.horizon = horizon;
        self.orphans.retain(|&o| o != point);
        self.share_orphans(first);
        true
    }

    /// Fills `visible` with the faces that see `p` and are connected with `seen`.
    fn find_visible(&mut self, seen: u32, p: DVec3) {
        self.visible.push(seen);
        self.is_visible[seen as usize] = true;
        let mut next = 0;
        while let Some(&face) = self.visible.get(next) {
            next += 1;
            for other in self.faces[face as usize].triangle.across {
                let sees = self.faces[other as usize].triangle.height(p) > self.rounding;
                if sees && !self.is_visible[other as usize] {
                    self.is_visible[other as usize] = true;
                    self.visible.push(other);
                }
            }
        }
    }

    /// Fills `visible` as above, and `horizon` with its rim.
    fn find_horizon(&mut self, seen: u32, p: DVec3) {
        self.horizon.clear();
        self.find_visible(seen, p);
        for &face in &self.visible {
            let triangle = &self.faces[face as usize].triangle;
            for edge in 0..3 {
                let other = triangle.across[edge];
                if !self.is_visible[other as usize] {
                    self.horizon.push((triangle.vertices[edge], triangle.vertices[(edge + 1) % 3], other));
                }
            }
        }
    }

    /// Puts the horizon in the order of a walk around it; false if it isn't one loop that meets each vertex
    /// once.
    fn sort_horizon(&mut self) -> bool {
        // A few dozen edges at most in practice: looking for the next one beats a table.
        for i in 1..self.horizon.len() {
            let end = self.horizon[i - 1].1;
            let Some(next) = (i..self.horizon.len()).find(|&j| self.horizon[j].0 == end) else {
                return false;
            };
            self.horizon.swap(i, next);
            if self.horizon[..i].iter().any(|e| e.0 == end) {
                return false;
            }
        }
        self.horizon.len() >= 3 && self.horizon.last().map(|e| e.1) == self.horizon.first().map(|e| e.0)
    }

    fn forget_visible(&mut self) {
        for v in self.visible.drain(..) {
            self.is_visible[v as usize] = false;
        }
    }

    fn push(&mut self, triangle: Triangle) {
        self.faces.push(Face { triangle, outside: Vec::new(), furthest: 0.0, alive: true });
        self.is_visible.push(false);
        self.alive += 1;
    }

    /// Gives each orphan to the new face that it is furthest outside of. One that is outside none is inside
    /// the hull, for good: it can't see another face without seeing one of these. That holds for exact
    /// distances only, hence `rounding`: with `noise` here, a point beside a sharp edge would be lost
    /// although it is far outside.
    fn share_orphans(&mut self, first: u32) {
        let (points, rounding) = (self.points, self.rounding);
        let new = &mut self.faces[first as usize..];
        for orphan in self.orphans.drain(..) {
            let p = points[orphan as usize];
            let mut best = (rounding, NONE);
            for (i, face) in new.iter().enumerate() {
                let height = face.triangle.height(p);
                if height > best.0 {
                    best = (height, i as u32);
                }
            }
            if best.1 != NONE {
                let face = &mut new[best.1 as usize];
                face.outside.push(orphan);
                face.furthest = face.furthest.max(best.0);
            }
        }
    }
}

/// The point furthest along `direction`; among equals furthest along a second one, and a third.
fn extreme(points: &[DVec3], subset: &[u32], direction: DVec3, equal: f64) -> u32 {
    let u = direction.any_orthonormal_vector();
    let v = direction.cross(u);
    let key = |i: u32| {
        let p = points[i as usize];
        [direction.dot(p), u.dot(p), v.dot(p)]
    };
    let further = |a: [f64; 3], b: [f64; 3]| {
        for (a, b) in a.into_iter().zip(b) {
            if (a - b).abs() > equal {
                return a > b;
            }
        }
        false
    };
    let mut best = (subset[0], key(subset[0]));
    for &i in &subset[1..] {
        let k = key(i);
        if further(k, best.1) {
            best = (i, k);
        }
    }
    best.0
}

/// Four points that span a volume: the first two far apart, each of the others far from those before. Refuses
/// sets that are within `flat` of a point, a line or a plane.
pub(crate) fn first_tetrahedron(
    points: &[DVec3],
    subset: &[u32],
    tolerance: Tolerance,
    flat: f64,
) -> Result<[u32; 4], Error> {
    let at = |i: u32| points[i as usize];
    let furthest_by = |measure: &dyn Fn(DVec3) -> f64| {
        let mut best = (subset[0], f64::MIN);
        for &i in subset {
            let m = measure(at(i));
            if m > best.1 {
                best = (i, m);
            }
        }
        best
    };
    let degenerate = |what: &str, size: f64| {
        let count = subset.len();
        let within = if size > 0.0 { format!(" within {size:.1e} m") } else { String::new() };
        Err(Error::Degenerate(format!("the {count} points of a hull are {what}{within}")))
    };

    let mut longest = (0.0, DVec3::X);
    for axis in DVec3::AXES {
        let (high, low) = (furthest_by(&|p| p.dot(axis)).1, -furthest_by(&|p| -p.dot(axis)).1);
        if high - low > longest.0 {
            longest = (high - low, axis);
        }
    }
    let (length, axis) = longest;
    if length <= flat {
        return degenerate("all equal", length);
    }
    let a = extreme(points, subset, axis, tolerance.rounding);
    let b = extreme(points, subset, -axis, tolerance.rounding);

    let along = (at(b) - at(a)).normalize();
    let aside = |p: DVec3| (p - at(a)) - along * (p - at(a)).dot(along);
    let (c, width) = furthest_by(&|p| aside(p).length());
    if width <= flat {
        return degenerate("all on a line", width);
    }
    let c = extreme(points, subset, aside(at(c)).normalize(), tolerance.rounding);

    let mut normal = (at(b) - at(a)).cross(at(c) - at(a)).normalize();
    let above = furthest_by(&|p| normal.dot(p - at(a))).1;
    let below = furthest_by(&|p| -normal.dot(p - at(a))).1;
    if above + below <= flat {
        return degenerate("all in a plane", above + below);
    }
    if above > below {
        normal = -normal;
    }
    let d = extreme(points, subset, -normal, tolerance.rounding);
    // Counter-clockwise as seen from the side that `d` isn't on.
    Ok(if above > below { [b, a, c, d] } else { [a, b, c, d] })
}
