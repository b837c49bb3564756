//! Triangles and colours that stand for a shape in a viewer. Contacts never see them, except that hulls and meshes
//! are read back from theirs.

use super::super::assets;
use crate::shape::Geometry;
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, TAU};

/// Segments around, and rings from pole to equator.
const AROUND: u32 = 24;
const RINGS: u32 = 6;
/// Half side of the square that stands for an infinite plane [m].
const PLANE: f32 = 100.0;

/// Vertices and triangles, counter-clockwise from outside; none for a height field.
pub(super) fn triangles(geometry: &Geometry) -> (Vec<Vec3>, Vec<[u32; 3]>) {
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
        Geometry::Hull(hull) => assets::hull_triangles(hull),
        Geometry::Mesh(mesh) => assets::mesh_triangles(mesh),
        Geometry::Plane => {
            let corner = |(x, z): (f32, f32)| Vec3::new(x * PLANE, 0.0, z * PLANE);
            let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(corner);
            (corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]])
        }
        Geometry::HeightField(_) => Default::default(),
    }
}

/// Colour (linear red, green, blue) of a shape; what can't move is grey.
pub(super) fn colour(geometry: &Geometry, moves: bool) -> [f32; 3] {
    match geometry {
        _ if !moves => [0.45, 0.47, 0.5],
        Geometry::Sphere { .. } => [0.8, 0.18, 0.1],
        Geometry::Capsule { .. } => [0.85, 0.45, 0.05],
        Geometry::Box { .. } => [0.1, 0.35, 0.75],
        Geometry::Cylinder { .. } => [0.15, 0.55, 0.2],
        _ => [0.5, 0.2, 0.65],
    }
}

/// (height, radius) from the lower pole to the upper one, along the two balls. Where their radii differ, each ball
/// ends where the cone touches it.
fn capsule_profile(half_height: f32, bottom: f32, top: f32) -> Vec<(f32, f32)> {
    let slope = if half_height > 0.0 { ((bottom - top) / (2.0 * half_height)).clamp(-1.0, 1.0) } else { 0.0 };
    let seam = libm::asinf(slope);
    let mut profile = Vec::new();
    let mut arc = |y: f32, radius: f32, from: f32, to: f32| {
        for i in 0..=RINGS {
            let angle = from + (to - from) * i as f32 / RINGS as f32;
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
        let (v, t) = triangles(geometry);
        t.iter().map(|t| v[t[0] as usize].dot(v[t[1] as usize].cross(v[t[2] as usize])) / 6.0).sum()
    }

    #[test]
    fn visible_volumes_are_nearly_those_of_the_shapes() {
        for geometry in [
            Geometry::Sphere { radius: 0.7 },
            Geometry::capsule(0.5, 0.3),
            Geometry::Capsule { half_height: 0.5, radius_bottom: 0.5, radius_top: 0.2 },
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
