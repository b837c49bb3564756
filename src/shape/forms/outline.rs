//! Lines and triangles that show forms. Contacts never see them.

use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, TAU};

/// Low and high corner of the box that is wanted, in the frame of the shape.
pub(crate) type Window = Option<(Vec3, Vec3)>;
/// Vertices, and triangles that wind counter-clockwise seen from outside.
pub(crate) type Solid = (Vec<Vec3>, Vec<[u32; 3]>);
/// Called with a triangle.
pub(crate) type Triangle<'a> = dyn FnMut([Vec3; 3]) + 'a;
/// Called with the ends of a line.
pub(crate) type Line<'a> = dyn FnMut(Vec3, Vec3) + 'a;

/// Segments around, and rings from pole to equator.
const AROUND: u32 = 24;
const RINGS: u32 = 6;
/// Lines that a circle is made of.
const CHORDS: u32 = 32;

/// Where the cone around two balls touches each of them, as (height, radius), and the angle at which that is.
/// A ball inside the other has no cone: its circle is the pole of the other.
pub(in crate::shape) fn seams(half_height: f32, bottom: f32, top: f32) -> ([(f32, f32); 2], f32) {
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
pub(in crate::shape) fn capsule_profile(half_height: f32, bottom: f32, top: f32) -> Vec<(f32, f32)> {
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
pub(in crate::shape) fn lathe(profile: &[(f32, f32)]) -> Solid {
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

/// The twelve edges of a box.
pub(crate) fn cuboid(min: Vec3, max: Vec3, line: &mut Line<'_>) {
    let corner = |i: u32| Vec3::from_array([0, 1, 2].map(|a| if i >> a & 1 == 0 { min[a] } else { max[a] }));
    for i in 0..8u32 {
        for axis in (0..3).filter(|axis| i >> axis & 1 == 0) {
            line(corner(i), corner(i | 1 << axis));
        }
    }
}

/// Part of an ellipse, from `u` towards `v`, between two angles [rad].
pub(crate) fn arc(centre: Vec3, u: Vec3, v: Vec3, (from, to): (f32, f32), line: &mut Line<'_>) {
    let parts = (((to - from).abs() / TAU * CHORDS as f32).ceil() as u32).clamp(1, CHORDS);
    let at = |i: u32| {
        let angle = from + (to - from) * i as f32 / parts as f32;
        centre + u * libm::cosf(angle) + v * libm::sinf(angle)
    };
    (0..parts).for_each(|i| line(at(i), at(i + 1)));
}

/// A circle around the y axis.
pub(in crate::shape) fn ring(y: f32, radius: f32, line: &mut Line<'_>) {
    if radius > 0.0 {
        arc(Vec3::Y * y, Vec3::X * radius, Vec3::Z * radius, (0.0, TAU), line);
    }
}

/// A profile of (height, radius) on four sides of the y axis.
pub(in crate::shape) fn turned(profile: &[(f32, f32)], line: &mut Line<'_>) {
    for side in [Vec3::X, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Z] {
        let at = |(y, radius): (f32, f32)| side * radius + Vec3::Y * y;
        profile.windows(2).for_each(|w| line(at(w[0]), at(w[1])));
    }
}
