//! Meshes that tests share.

use super::*;
pub(crate) use crate::random::Random;

/// A box that winds outwards.
pub(crate) fn cuboid(half: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let sign = |i: u32, bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
    let vertices = (0..8).map(|i| Vec3::new(sign(i, 0), sign(i, 1), sign(i, 2)) * half).collect();
    let quads = [[1, 3, 7, 5], [0, 4, 6, 2], [2, 6, 7, 3], [0, 1, 5, 4], [4, 5, 7, 6], [0, 2, 3, 1]];
    (vertices, quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect())
}

/// Square cells around the origin whose fronts look up.
pub(crate) fn grid(cells: u32, cell: f32, height: impl Fn(f32, f32) -> f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (row, half) = (cells + 1, cells as f32 * cell * 0.5);
    let at = |n: u32| n as f32 * cell - half;
    let vertices = (0..row * row).map(|v| (at(v % row), at(v / row)));
    let vertices = vertices.map(|(x, z)| Vec3::new(x, height(x, z), z)).collect();
    let mut triangles = Vec::new();
    for k in 0..cells {
        for i in 0..cells {
            let (v00, v01) = (k * row + i, (k + 1) * row + i);
            triangles.push([v00, v01, v00 + 1]);
            triangles.push([v00 + 1, v01, v01 + 1]);
        }
    }
    (vertices, triangles)
}

/// Hills, bumps and sharp ridges.
pub(crate) fn bumpy(x: f32, z: f32) -> f32 {
    use libm::{cosf, sinf};
    let hills = 1.5 * sinf(0.35 * x) * cosf(0.27 * z);
    let bumps = 0.5 * sinf(0.9 * x + 1.3) * sinf(1.1 * z + 0.7);
    let ridge = 1.0 - sinf(0.21 * x + 0.13 * z).abs();
    hills + bumps + 1.5 * ridge * ridge * ridge
}

pub(crate) fn terrain(cells: u32) -> TriangleMesh {
    let (vertices, triangles) = grid(cells, 0.5, bumpy);
    TriangleMesh::new(vertices, triangles).unwrap()
}

/// Triangles of all sizes anywhere, with edges in common now and then.
pub(crate) fn soup(count: usize, random: &mut Random) -> TriangleMesh {
    let vertices: Vec<Vec3> = (0..count).map(|_| random.cube() * 10.0).collect();
    let triangles = (0..count)
        .map(|i| {
            let near = |r: &mut Random| (i + r.below((count / 20).max(9))) % count;
            [i as u32, near(random) as u32, near(random) as u32]
        })
        .collect();
    TriangleMesh::new(vertices, triangles).unwrap()
}
