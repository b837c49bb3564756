//! The part of a solid in a box: its surface there, exactly, and the corners of the box that are inside.

use super::super::hull::build;
use super::solid::{Solid, place};
use glam::DVec3;

/// A plane across an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Plane {
    pub(super) axis: usize,
    /// [steps]
    pub(super) at: i64,
}

/// A part of the solid.
#[derive(Debug)]
pub(super) struct Part {
    /// Its box.
    pub(super) low: [i64; 3],
    pub(super) high: [i64; 3],
    pub(super) surface: Surface,
    /// Triangles in the column along x through the box.
    pub(super) column: Vec<u32>,
    /// Volumes of the part and of its hull [cubic steps].
    pub(super) volume: f64,
    pub(super) hull: f64,
    /// Corners of the hull.
    pub(super) points: Vec<DVec3>,
}

/// Convex polygons: triangles of the solid, cut by a box.
#[derive(Debug, Default)]
pub(super) struct Surface {
    points: Vec<DVec3>,
    /// Where each begins and which triangle it is of.
    starts: Vec<(usize, u32)>,
}

impl Surface {
    fn push(&mut self, triangle: u32, points: &[DVec3]) {
        self.starts.push((self.points.len(), triangle));
        self.points.extend_from_slice(points);
    }

    fn polygons(&self) -> impl Iterator<Item = (u32, &[DVec3])> {
        let ends = self.starts.iter().skip(1).map(|start| start.0).chain([self.points.len()]);
        self.starts.iter().zip(ends).map(|(&(start, triangle), end)| (triangle, &self.points[start..end]))
    }

    pub(super) fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// The surface of what is on one side of a plane: without polygons that only touch it from the other
    /// side.
    fn beyond(&self, solid: &Solid, plane: Plane, above: bool) -> Surface {
        let (mut result, mut clipped) = (Surface::default(), Vec::new());
        for (triangle, polygon) in self.polygons() {
            let touch = Touch::of(polygon, solid, triangle, plane.axis);
            let at = plane.at as f64;
            if if above { touch.is_above(at) } else { touch.is_below(at) } {
                clipped.clear();
                clip_polygon(polygon, plane.axis, at, above, &mut clipped);
                result.push(triangle, &clipped);
            }
        }
        result
    }
}

/// Where a polygon is along an axis.
struct Touch {
    low: f64,
    high: f64,
    /// Whether it looks up the axis or down.
    looks: i64,
}

impl Touch {
    fn of(polygon: &[DVec3], solid: &Solid, triangle: u32, axis: usize) -> Touch {
        let along = polygon.iter().map(|p| p[axis]);
        let (low, high) = along.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
        Touch { low, high, looks: solid.looks(triangle, axis) }
    }

    /// Whether it bounds what is above a plane: it is there, or in the plane and looks down from there.
    fn is_above(&self, at: f64) -> bool {
        self.high > at || self.low == at && self.looks < 0
    }
    fn is_below(&self, at: f64) -> bool {
        self.low < at || self.high == at && self.looks > 0
    }
}

impl Part {
    pub(super) fn whole(solid: &Solid) -> Part {
        let mut surface = Surface::default();
        let column: Vec<u32> = (0..solid.triangle_count() as u32).collect();
        column.iter().for_each(|&triangle| surface.push(triangle, &solid.places(triangle)));
        let [low, high] = solid.bounds();
        let mut whole = Part::new(solid, surface, &column, [low, high]).unwrap_or_else(|| Part {
            low,
            high,
            surface: Surface::default(),
            column: Vec::new(),
            volume: 0.0,
            hull: 0.0,
            points: Vec::new(),
        });
        whole.volume = solid.volume();
        whole
    }

    /// How much of the hull is not solid.
    pub(super) fn excess(&self) -> f64 {
        (self.hull - self.volume).max(0.0)
    }

    /// What is in a box, or nothing if it has no volume. The box is shrunk to it.
    fn new(solid: &Solid, surface: Surface, column: &[u32], [low, high]: [[i64; 3]; 2]) -> Option<Part> {
        let points = corners_of(solid, &surface, column, [low, high]);
        let (hull, corners) = build::measure(&points)?;
        let points: Vec<DVec3> = corners.into_iter().map(|i| points[i as usize]).collect();
        let bound = points
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
        let low: [i64; 3] = std::array::from_fn(|a| low[a].max(bound.0[a].floor() as i64));
        let high: [i64; 3] = std::array::from_fn(|a| high[a].min(bound.1[a].ceil() as i64));
        let column = column.iter().copied().filter(|&t| solid.in_column(t, low, high)).collect();
        Some(Part { low, high, surface, column, volume: 0.0, hull, points })
    }

    /// The box on one side of a plane.
    fn beyond(&self, Plane { axis, at }: Plane, above: bool) -> [[i64; 3]; 2] {
        let mut bounds = [self.low, self.high];
        bounds[usize::from(!above)][axis] = at;
        bounds
    }

    /// Volume of the hull of what is on one side of a plane [cubic steps].
    pub(super) fn hull_beyond(&self, solid: &Solid, plane: Plane, above: bool) -> f64 {
        let surface = self.surface.beyond(solid, plane, above);
        let points = corners_of(solid, &surface, &self.column, self.beyond(plane, above));
        build::measure(&points).map_or(0.0, |(volume, _)| volume)
    }

    /// What is on both sides of a plane.
    pub(super) fn split(self, solid: &Solid, plane: Plane) -> impl Iterator<Item = Part> {
        let side = |above| {
            let surface = self.surface.beyond(solid, plane, above);
            Part::new(solid, surface, &self.column, self.beyond(plane, above))
        };
        let mut sides = [side(false), side(true)];
        for part in sides.iter_mut().flatten() {
            part.volume = solid.volume_in(&part.column, part.low, part.high);
        }
        sides.into_iter().flatten()
    }
}

/// Points of which the hull of what is in a box is made: its surface there, and corners of the box just
/// beside which the solid is.
fn corners_of(solid: &Solid, surface: &Surface, column: &[u32], [low, high]: [[i64; 3]; 2]) -> Vec<DVec3> {
    let mut points = surface.points.clone();
    for corner in 0..8 {
        let is_high: [bool; 3] = std::array::from_fn(|a| corner >> a & 1 == 1);
        let at: [i64; 3] = std::array::from_fn(|a| if is_high[a] { high[a] } else { low[a] });
        if solid.is_beside(column, at, is_high.map(|high| if high { -1 } else { 1 })) {
            points.push(place(at));
        }
    }
    points
}

/// The part of a convex polygon on one side of a plane across an axis (Sutherland and Hodgman, *Reentrant
/// polygon clipping*, 1974).
pub(super) fn clip_polygon(polygon: &[DVec3], axis: usize, at: f64, above: bool, out: &mut Vec<DVec3>) {
    let height = |p: DVec3| if above { p[axis] - at } else { at - p[axis] };
    let Some(&last) = polygon.last() else { return };
    let mut a = last;
    for &b in polygon {
        let (of_a, of_b) = (height(a), height(b));
        if of_a * of_b < 0.0 {
            let mut crossing = a + (b - a) * ((at - a[axis]) / (b[axis] - a[axis]));
            crossing[axis] = at;
            out.push(crossing);
        }
        if of_b >= 0.0 {
            out.push(b);
        }
        a = b;
    }
}
