//! Lines on the surface of a shape.

use super::solid::{self, PLANE};
use crate::shape::Geometry;
use glam::Vec3;
use std::f32::consts::TAU;

/// Lines that a circle is made of.
const AROUND: u32 = 32;
/// Lines along a plane, each way.
const GRID: u32 = 20;

/// The lines that show a shape, in its own frame [m]. Their ends are on its surface; between them a line is a
/// chord of what is round.
///
/// `window`: low and high corner of the box that is wanted, in the same frame. A mesh or height field
/// shows only the edges of triangles whose boxes meet the window, an edge once for each of them; a plane,
/// which has no end, the part in the window, or 20 m around its origin if there is none. All other shapes are
/// drawn as a whole.
pub fn wireframe(geometry: &Geometry, window: Option<(Vec3, Vec3)>, line: &mut dyn FnMut(Vec3, Vec3)) {
    match geometry {
        Geometry::Sphere { radius } => {
            for (u, v) in [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X)] {
                arc(Vec3::ZERO, u * *radius, v * *radius, (0.0, TAU), line);
            }
        }
        Geometry::Capsule { half_height, radius_bottom, radius_top } => {
            let profile = solid::capsule_profile(*half_height, *radius_bottom, *radius_top);
            turned(&profile, line);
            let (seams, _) = solid::seams(*half_height, *radius_bottom, *radius_top);
            seams.into_iter().for_each(|(y, radius)| ring(y, radius, line));
        }
        Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
            turned(&[(-half_height, *radius_bottom), (*half_height, *radius_top)], line);
            ring(-half_height, *radius_bottom, line);
            ring(*half_height, *radius_top, line);
        }
        Geometry::Box { half_extents } => cuboid(-*half_extents, *half_extents, line),
        Geometry::Hull(hull) => {
            for edge in &hull.edges {
                let [from, to] = edge.vertices.map(|v| hull.vertices[usize::from(v)]);
                line(from, to);
            }
        }
        Geometry::Plane => {
            let (min, max) = window.unwrap_or((Vec3::splat(-PLANE), Vec3::splat(PLANE)));
            if min.y > 0.0 || max.y < 0.0 {
                return;
            }
            let at =
                |u: f32, v: f32| Vec3::new(min.x + (max.x - min.x) * u, 0.0, min.z + (max.z - min.z) * v);
            for i in 0..=GRID {
                let u = i as f32 / GRID as f32;
                line(at(u, 0.0), at(u, 1.0));
                line(at(0.0, u), at(1.0, u));
            }
        }
        Geometry::Mesh(_) | Geometry::HeightField(_) => {
            solid::triangles(geometry, window, &mut |[a, b, c]| {
                line(a, b);
                line(b, c);
                line(c, a);
            });
        }
    }
}

/// The twelve edges of a box.
pub(super) fn cuboid(min: Vec3, max: Vec3, line: &mut dyn FnMut(Vec3, Vec3)) {
    let corner = |i: u32| Vec3::from_array([0, 1, 2].map(|a| if i >> a & 1 == 0 { min[a] } else { max[a] }));
    for i in 0..8u32 {
        for axis in (0..3).filter(|axis| i >> axis & 1 == 0) {
            line(corner(i), corner(i | 1 << axis));
        }
    }
}

/// Part of an ellipse, from `u` towards `v`, between two angles [rad].
pub(super) fn arc(centre: Vec3, u: Vec3, v: Vec3, (from, to): (f32, f32), line: &mut dyn FnMut(Vec3, Vec3)) {
    let parts = (((to - from).abs() / TAU * AROUND as f32).ceil() as u32).clamp(1, AROUND);
    let at = |i: u32| {
        let angle = from + (to - from) * i as f32 / parts as f32;
        centre + u * libm::cosf(angle) + v * libm::sinf(angle)
    };
    (0..parts).for_each(|i| line(at(i), at(i + 1)));
}

/// A circle around the y axis.
fn ring(y: f32, radius: f32, line: &mut dyn FnMut(Vec3, Vec3)) {
    if radius > 0.0 {
        arc(Vec3::Y * y, Vec3::X * radius, Vec3::Z * radius, (0.0, TAU), line);
    }
}

/// A profile of (height, radius) on four sides of the y axis.
fn turned(profile: &[(f32, f32)], line: &mut dyn FnMut(Vec3, Vec3)) {
    for side in [Vec3::X, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Z] {
        let at = |(y, radius): (f32, f32)| side * radius + Vec3::Y * y;
        profile.windows(2).for_each(|w| line(at(w[0]), at(w[1])));
    }
}
