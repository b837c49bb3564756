//! Triangles that stand for a shape in a viewer. Contacts never see them, except those of hulls and meshes.

use crate::shape::{ConvexHull, Geometry};
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, TAU};

/// Segments around, and rings from pole to equator.
const AROUND: u32 = 24;
const RINGS: u32 = 6;
// Guard: an endless plane is drawn to here.
/// What is drawn of a plane to each side of its origin [m].
pub(super) const PLANE: f32 = 20.0;

/// The triangles that show a shape, in its own frame [m], counter-clockwise from outside; those of meshes as
/// they were given.
///
/// `window`: as for [`wireframe`](super::wireframe()).
pub fn triangles(geometry: &Geometry, window: Option<(Vec3, Vec3)>, triangle: &mut dyn FnMut([Vec3; 3])) {
    match geometry {
        Geometry::Mesh(mesh) => {
            let (min, max) = window.unwrap_or(mesh.aabb());
            mesh.visit_box(min, max, &mut |_, corners| triangle(corners));
        }
        Geometry::HeightField(field) => {
            let (min, max) = window.unwrap_or(field.aabb());
            field.visit_box(min, max, &mut |_, corners| triangle(corners));
        }
        Geometry::Plane => {
            let (min, max) = window.unwrap_or((Vec3::splat(-PLANE), Vec3::splat(PLANE)));
            if min.y <= 0.0 && max.y >= 0.0 {
                let at = |x: f32, z: f32| Vec3::new(x, 0.0, z);
                let corners = [at(min.x, min.z), at(min.x, max.z), at(max.x, max.z), at(max.x, min.z)];
                triangle([corners[0], corners[1], corners[2]]);
                triangle([corners[0], corners[2], corners[3]]);
            }
        }
        _ => {
            let (vertices, triangles) = convex(geometry);
            triangles.iter().for_each(|t| triangle(t.map(|v| vertices[v as usize])));
        }
    }
}

/// Vertices and triangles of a convex shape; none of any other.
pub fn convex(geometry: &Geometry) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    match geometry {
        Geometry::Sphere { radius } => lathe(&capsule_profile(0.0, *radius, *radius)),
        Geometry::Capsule { half_height, radius_bottom, radius_top } => {
            lathe(&capsule_profile(*half_height, *radius_bottom, *radius_top))
        }
        Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
            let (h, b, t) = (*half_height, *radius_bottom, *radius_top);
            lathe(&[(-h, 0.0), (-h, b), (h, t), (h, 0.0)])
        }
        Geometry::Box { half_extents } => cuboid(*half_extents),
        Geometry::Hull(hull) => fans(hull),
        Geometry::Plane | Geometry::Mesh(_) | Geometry::HeightField(_) => Default::default(),
    }
}

/// Vertices and triangles of a hull.
fn fans(hull: &ConvexHull) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let fan = |face: &[u16]| -> Vec<[u32; 3]> {
        face.windows(2).skip(1).map(|w| [face[0], w[0], w[1]].map(u32::from)).collect()
    };
    (hull.vertices().to_vec(), hull.faces().flat_map(fan).collect())
}

/// Where the cone around two balls touches each of them, as (height, radius), and the angle at which that is.
/// A ball inside the other has no cone: its circle is the pole of the other.
pub(super) fn seams(half_height: f32, bottom: f32, top: f32) -> ([(f32, f32); 2], f32) {
    let slope = if half_height > 0.0 { ((bottom - top) / (2.0 * half_height)).clamp(-1.0, 1.0) } else { 0.0 };
    let seam = libm::asinf(slope);
    let at = |y: f32, radius: f32| (y + radius * slope, (radius * libm::cosf(seam)).max(0.0));
    let (low, high) = (at(-half_height, bottom), at(half_height, top));
    if slope >= 1.0 {
        ([(low.0, 0.0); 2], seam)
    } else if slope <= -1.0 {
        ([(high.0, 0.0); 2], seam)
    } else {
        ([low, high], seam)
    }
}

/// (height, radius) from the lower pole to the upper one, along the two balls. Where their radii differ, each
/// ball ends where the cone touches it.
pub(super) fn capsule_profile(half_height: f32, bottom: f32, top: f32) -> Vec<(f32, f32)> {
    // Two balls at one place are the larger one.
    let (bottom, top) = if half_height > 0.0 { (bottom, top) } else { (bottom.max(top), bottom.max(top)) };
    let (_, seam) = seams(half_height, bottom, top);
    let mut profile = Vec::new();
    let mut arc = |y: f32, radius: f32, from: f32, to: f32| {
        // Nearly a whole ball, if the other is nearly inside it.
        let rings = if to - from > 1.5 * FRAC_PI_2 { 2 * RINGS } else { RINGS };
        // A ball inside the other shows nothing.
        for i in (0..=rings).filter(|_| to > from) {
            let angle = from + (to - from) * i as f32 / rings as f32;
            profile.push((y + radius * libm::sinf(angle), (radius * libm::cosf(angle)).max(0.0)));
        }
    };
    arc(-half_height, bottom, -FRAC_PI_2, seam);
    arc(half_height, top, seam, FRAC_PI_2);
    if half_height == 0.0 {
        profile.remove(RINGS as usize);
    }
    profile
}
/// Turns a profile of (height, radius) about the y axis; its ends are on the axis.
fn lathe(profile: &[(f32, f32)]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let [(low, _), inner @ .., (high, _)] = profile else { return Default::default() };
    let mut vertices = vec![Vec3::new(0.0, *low, 0.0)];
    for &(y, radius) in inner {
        for i in 0..AROUND {
            let angle = TAU * i as f32 / AROUND as f32;
            vertices.push(Vec3::new(radius * libm::sinf(angle), y, radius * libm::cosf(angle)));
        }
    }
    let top = vertices.len() as u32;
    vertices.push(Vec3::new(0.0, *high, 0.0));
    let at = |ring: u32, i: u32| 1 + ring * AROUND + i % AROUND;
    let rings = inner.len() as u32;
    let mut triangles = Vec::new();
    for i in 0..AROUND {
        triangles.push([0, at(0, i + 1), at(0, i)]);
        for ring in 0..rings - 1 {
            triangles.push([at(ring, i), at(ring, i + 1), at(ring + 1, i)]);
            triangles.push([at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i)]);
        }
        triangles.push([top, at(rings - 1, i), at(rings - 1, i + 1)]);
    }
    (vertices, triangles)
}

fn cuboid(half: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let corner =
        |i: u32| Vec3::from_array([0, 1, 2].map(|a| if i >> a & 1 == 0 { -half[a] } else { half[a] }));
    let quads: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    ((0..8).map(corner).collect(), triangles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::MassProperties;

    /// Volume by the divergence theorem: positive only if all triangles face outwards and leave no hole.
    fn volume(geometry: &Geometry) -> f32 {
        let mut sum = 0.0;
        triangles(geometry, None, &mut |[a, b, c]| sum += a.dot(b.cross(c)) / 6.0);
        sum
    }

    #[test]
    fn visible_volumes_are_nearly_those_of_the_shapes() {
        for geometry in [
            Geometry::Sphere { radius: 0.7 },
            Geometry::capsule(0.5, 0.3),
            Geometry::Capsule { half_height: 0.5, radius_bottom: 0.5, radius_top: 0.2 },
            Geometry::Capsule { half_height: 0.1, radius_bottom: 0.2, radius_top: 0.5 },
            Geometry::Capsule { half_height: 0.0, radius_bottom: 0.2, radius_top: 0.5 },
            Geometry::cuboid(0.1, 0.2, 0.3),
            Geometry::cylinder(0.4, 0.3),
            Geometry::Cylinder { half_height: 0.4, radius_bottom: 0.3, radius_top: 0.0 },
        ] {
            let exact = MassProperties::of(&geometry, 1.0).mass;
            let ratio = volume(&geometry) / exact;
            assert!(ratio > 0.95 && ratio < 1.0001, "{geometry:?}: {ratio}");
        }
    }
}
