//! A ray against one shape, in the shape's frame.

use super::candidates::{Candidate, turn_back};
use super::ray::Ray;
use crate::shape::{Ground, path_in_box};
use glam::{DVec3, Vec3};

/// Where a ray meets a shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Met {
    pub(super) fraction: f32,
    /// The same fraction in `f64`.
    pub(super) exact: f64,
    /// Unit, in the shape's frame; zero inside.
    pub(super) normal: DVec3,
    pub(super) triangle: Option<u32>,
    pub(super) inside: bool,
}

/// Where a ray first meets a shape up to the fraction `most`; if `any` will do, somewhere.
#[inline]
pub(super) fn meet(candidate: &Candidate<'_>, ray: &Ray, most: f32, any: bool) -> Option<Met> {
    let shape = candidate.shape;
    let start = candidate.local(ray.from);
    let path = turn_back(candidate.place.rotation, ray.path.as_dvec3());
    if let Some(ground) = shape.geometry.ground() {
        return meet_triangles(ground, start, path, most, any);
    }
    if let Some((exact, normal)) = shape.geometry.enter(start, path, 0.0) {
        let normal = normal.normalize_or(DVec3::Y);
        return Some(Met { fraction: exact as f32, exact, normal, triangle: None, inside: false });
    }
    shape.geometry.contains(start).then_some(Met {
        fraction: 0.0,
        exact: 0.0,
        normal: DVec3::ZERO,
        triangle: None,
        inside: true,
    })
}

// Rounding: of a start that is far from a mesh.
/// If the start is further away than this many sizes of a mesh, triangles are tested from where the ray comes
/// near: `f32` would not represent the start well enough.
const FAR: f64 = 4.0;

// Rounding: of the plane of a triangle.
/// The largest correction by the plane of a triangle, as a share of the size of the mesh.
const REFINED: f64 = 1e-5;

fn meet_triangles(ground: Ground<'_>, start: DVec3, path: DVec3, most: f32, any: bool) -> Option<Met> {
    let way = Way::new(ground, start, path, most)?;
    let (t, index) = ground.ray(way.from, way.path, way.most, any)?;
    Some(way.met(ground, start, path, t, index))
}

/// The part of a ray that is tested in `f32` among triangles.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Way {
    pub(super) from: Vec3,
    pub(super) path: Vec3,
    /// Fraction of this part up to which hits matter.
    pub(super) most: f32,
    /// Where this part begins on the ray, and its share of the ray.
    enter: f64,
    share: f64,
    /// The largest correction by the plane of a triangle [m].
    refined: f64,
}

impl Way {
    pub(super) fn new(ground: Ground<'_>, start: DVec3, path: DVec3, most: f32) -> Option<Way> {
        let (min, max) = ground.aabb();
        let (min, max) = (min.as_dvec3(), max.as_dvec3());
        let size = min.abs().max(max.abs()).length();
        let (mut enter, mut leave) = (0.0, 1.0);
        if start.length() > FAR * size || path.length() > FAR * size {
            (enter, leave) = path_in_box(start, path, min - 1e-3 * size, max + 1e-3 * size)?;
        }
        let share = leave - enter;
        let refined = REFINED * size;
        // Refinement may move a hit forward by this much, and the result must not depend on `most`.
        let slack = refined / path.length();
        let most = if share < 1.0 { 1.0 } else { (f64::from(most) + slack).min(1.0) as f32 };
        let (from, path) = ((start + path * enter).as_vec3(), (path * share).as_vec3());
        Some(Way { from, path, most, enter, share, refined })
    }

    /// The hit with a triangle at a fraction of the part.
    pub(super) fn met(&self, ground: Ground<'_>, start: DVec3, path: DVec3, t: f32, index: u32) -> Met {
        let [a, b, c] = ground.triangle(index).map(Vec3::as_dvec3);
        let across = (b - a).cross(c - a);
        let normal = across.normalize_or(-path.normalize_or(-DVec3::Y));
        let mut exact = self.enter + self.share * f64::from(t);
        // `f32` found the triangle; its plane says where, unless the ray runs along it.
        let slope = normal.dot(path);
        if slope.abs() > 1e-3 * path.length() {
            let refined = normal.dot(a - start) / slope;
            if (refined - exact).abs() * path.length() <= self.refined {
                exact = refined.clamp(0.0, 1.0);
            }
        }
        let normal = if slope > 0.0 { -normal } else { normal };
        Met { fraction: exact as f32, exact, normal, triangle: Some(index), inside: false }
    }
}
