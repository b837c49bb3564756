//! A closed surface of triangles on a grid of integers, where inside and outside are exact.

use super::super::mass::{Moments, principal};
use super::frame::Frame;
use super::part::clip_polygon;
use crate::error::{Error, each, index};
use crate::limits;
use glam::{DMat3, DVec3, Vec3};

/// The most triangles.
pub(super) const MAX_TRIANGLES: usize = 1 << 15;

/// A solid on its grid.
#[derive(Debug)]
pub(super) struct Solid {
    pub(super) frame: Frame,
    /// Counter-clockwise from outside [steps], below 2^23 each.
    corners: Vec<[[i64; 3]; 3]>,
    volume: f64,
    /// Mass, centre and inertia of the mesh at a density of one [m].
    pub(super) moments: Moments,
}

/// A place beside a corner of a box, inwards along each axis, as parts of a step. Unequal, so that it is
/// hardly ever in line with an edge.
const BESIDE: [i64; 3] = [31, 17, 11];
const PARTS: i64 = 64;

impl Solid {
    pub(super) fn new(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<Solid, Error> {
        each("vertex", vertices, |&v| limits::offset("mesh vertex", v))?;
        if triangles.len() > MAX_TRIANGLES {
            let most = MAX_TRIANGLES as u64;
            return Err(Error::TooMany { what: "triangles of a mesh to be decomposed", most });
        }
        let of_vertex = |&i: &u32| index("mesh index", i as usize, vertices.len()).map(drop);
        each("triangle", triangles, |corners| corners.iter().try_for_each(of_vertex))?;
        let mut places: Vec<[DVec3; 3]> =
            triangles.iter().map(|t| t.map(|v| vertices[v as usize].as_dvec3())).collect();
        let extent = places
            .iter()
            .flatten()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
        if places.is_empty() || (extent.1 - extent.0).max_element() < f64::from(limits::MIN_LENGTH) {
            return Err(Error::Degenerate("the mesh encloses no volume".into()));
        }
        let mut moments = Moments::of_triangles(&places);
        if moments.mass == 0.0 {
            // Wound from the inside.
            places.iter_mut().for_each(|triangle| triangle.swap(1, 2));
            moments = Moments::of_triangles(&places);
        }
        let frame = Frame::of(&places, DMat3::from_quat(principal(moments.inertia).1));
        let corners: Vec<[[i64; 3]; 3]> =
            places.iter().map(|triangle| triangle.map(|p| frame.to_grid(p))).collect();
        require_closed(&corners)?;
        let whole = corners.iter().map(|&triangle| determinant(triangle)).sum::<i128>();
        let volume = whole as f64 / 6.0;
        if moments.mass == 0.0 || volume <= 0.0 {
            return Err(Error::Degenerate("the mesh encloses no volume".into()));
        }
        Ok(Solid { frame, corners, volume, moments })
    }

    /// In cubic steps.
    pub(super) fn volume(&self) -> f64 {
        self.volume
    }

    pub(super) fn bounds(&self) -> [[i64; 3]; 2] {
        bounds(&self.corners)
    }

    pub(super) fn triangle_count(&self) -> usize {
        self.corners.len()
    }

    pub(super) fn places(&self, triangle: u32) -> [DVec3; 3] {
        self.corners[triangle as usize].map(place)
    }

    /// Whether a triangle looks up an axis, down it, or neither.
    pub(super) fn looks(&self, triangle: u32, axis: usize) -> i64 {
        let [a, b, c] = self.corners[triangle as usize];
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        ((b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u])).signum()
    }

    /// Whether a triangle is in the column along x through a box.
    pub(super) fn in_column(&self, triangle: u32, low: [i64; 3], high: [i64; 3]) -> bool {
        let corners = &self.corners[triangle as usize];
        (1..3).all(|a| corners.iter().any(|c| c[a] >= low[a]) && corners.iter().any(|c| c[a] <= high[a]))
    }

    /// Whether the solid is just beside a corner of a box that the column of triangles contains, in the
    /// direction of the signs: how often it winds around that place, by the faces that a ray along x leaves
    /// and enters through.
    pub(super) fn is_beside(&self, column: &[u32], at: [i64; 3], signs: [i64; 3]) -> bool {
        let at: [i64; 3] = std::array::from_fn(|a| at[a] * PARTS + signs[a] * BESIDE[a]);
        let mut winding = 0;
        for &triangle in column {
            let corners = self.corners[triangle as usize]
                .map(|c| -> [i64; 3] { std::array::from_fn(|a| c[a] * PARTS - at[a]) });
            let [a, b, c] = corners;
            let behind = |axis: usize, sign: i64| corners.iter().all(|c| c[axis] * sign < 0);
            if behind(0, 1) || behind(1, 1) || behind(1, -1) || behind(2, 1) || behind(2, -1) {
                continue;
            }
            let sides = [side(a, b), side(b, c), side(c, a)];
            let faces = sides[0];
            if sides == [faces; 3] && determinant(corners).signum() == i128::from(faces) {
                winding += faces;
            }
        }
        winding > 0
    }

    /// Volume in a box, by the divergence of the field `(clamp(x, low, high) - low, 0, 0)`, which passes no
    /// face of the column along x through the box [cubic steps].
    pub(super) fn volume_in(&self, column: &[u32], low: [i64; 3], high: [i64; 3]) -> f64 {
        let (mut polygon, mut clipped) = (Vec::new(), Vec::new());
        let [x0, x1] = [low[0] as f64, high[0] as f64];
        let mut volume = 0.0;
        for &triangle in column {
            polygon.clear();
            polygon.extend(self.places(triangle));
            for (axis, at, above) in
                [(1, low[1], true), (1, high[1], false), (2, low[2], true), (2, high[2], false)]
            {
                clipped.clear();
                clip_polygon(&polygon, axis, at as f64, above, &mut clipped);
                std::mem::swap(&mut polygon, &mut clipped);
            }
            clipped.clear();
            clip_polygon(&polygon, 0, x0, true, &mut clipped);
            polygon.clear();
            clip_polygon(&clipped, 0, x1, false, &mut polygon);
            volume += flux(&polygon, |x| x - x0);
            // One in the plane was counted.
            if clipped.iter().any(|p| p.x > x1) {
                polygon.clear();
                clip_polygon(&clipped, 0, x1, true, &mut polygon);
                volume += flux(&polygon, |_| x1 - x0);
            }
        }
        volume
    }
}

pub(super) fn place(corner: [i64; 3]) -> DVec3 {
    DVec3::from_array(corner.map(|x| x as f64))
}

/// Integral of a linear field along x over a polygon, counter-clockwise as it looks up x.
fn flux(polygon: &[DVec3], field: impl Fn(f64) -> f64) -> f64 {
    let Some((&first, others)) = polygon.split_first() else { return 0.0 };
    let through = |pair: &[DVec3]| {
        let (b, c) = (pair[0] - first, pair[1] - first);
        field((first.x + pair[0].x + pair[1].x) / 3.0) * (b.y * c.z - b.z * c.y) / 2.0
    };
    others.windows(2).map(through).sum()
}

/// On which side of the edge from `a` to `b` zero is, seen along x. If it is on the edge, the two triangles
/// that share it agree.
fn side(a: [i64; 3], b: [i64; 3]) -> i64 {
    match (a[1] * b[2] - a[2] * b[1]).signum() {
        0 if [a[1], a[2]] < [b[1], b[2]] => 1,
        0 => -1,
        sign => sign,
    }
}

fn determinant([a, b, c]: [[i64; 3]; 3]) -> i128 {
    let [a, b, c] = [a, b, c].map(|corner| corner.map(i128::from));
    a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

fn bounds(corners: &[[[i64; 3]; 3]]) -> [[i64; 3]; 2] {
    corners.iter().flatten().fold([[i64::MAX; 3], [i64::MIN; 3]], |[low, high], c| {
        [std::array::from_fn(|a| low[a].min(c[a])), std::array::from_fn(|a| high[a].max(c[a]))]
    })
}

/// Refuses surfaces with an edge that is not there as often one way as the other.
fn require_closed(corners: &[[[i64; 3]; 3]]) -> Result<(), Error> {
    let mut edges: Vec<([[i64; 3]; 2], i32)> = Vec::with_capacity(3 * corners.len());
    for &[a, b, c] in corners {
        for (a, b) in [(a, b), (b, c), (c, a)] {
            edges.push(if a < b { ([a, b], 1) } else { ([b, a], -1) });
        }
    }
    edges.sort_unstable();
    let open = edges.chunk_by(|a, b| a.0 == b.0).filter(|same| {
        let [a, b] = same[0].0;
        a != b && same.iter().map(|edge| edge.1).sum::<i32>() != 0
    });
    match open.count() {
        0 => Ok(()),
        open => Err(Error::Degenerate(format!(
            "the mesh is not closed: {open} of its edges have more triangles on one side than on the other"
        ))),
    }
}
