//! Polygons out of the triangles of a hull.
//!
//! The largest triangle goes first and takes in its neighbours as far as they are in its plane; then the
//! largest of the rest, and so on. A large triangle's plane is the least disturbed by the noise of its
//! corners. A vertex with fewer than three faces around it is in the middle of a face or of an edge: it goes,
//! and the hull of the others is built anew, until every vertex is a corner. Whether the outcome is a closed
//! convex polyhedron is checked and not assumed; where noise defeats the merge, it is repeated with a smaller
//! tolerance, in the end with none.

use super::HullEdge;
use super::build::{Polyhedron, Quickhull, Tolerance, Triangle, first_tetrahedron};
use crate::error::Error;
use glam::DVec3;

const NONE: u32 = u32::MAX;

pub(crate) fn polygons(
    points: &[DVec3],
    triangles: Vec<Triangle>,
    tolerance: Tolerance,
    left_out: f64,
) -> Result<Polyhedron, Error> {
    let Tolerance { noise, rounding } = tolerance;
    for flat in [noise, noise / 4.0, noise / 16.0, noise / 64.0, rounding, -1.0] {
        if let Some(mut polyhedron) = attempt(points, &triangles, tolerance, flat) {
            polyhedron.left_out = left_out;
            return Ok(polyhedron);
        }
    }
    Err(Error::Degenerate("the points of a hull are too close together for a closed surface".into()))
}

/// Triangles whose corners are within `flat` of a plane become one face.
fn attempt(points: &[DVec3], first: &[Triangle], tolerance: Tolerance, flat: f64) -> Option<Polyhedron> {
    let all = vertices_of(first);
    let mut triangles = first.to_vec();
    // Twice is the rule; each round loses a vertex, so this ends anyway.
    loop {
        let (groups, count) = group(points, &triangles, flat);
        let before = vertices_of(&triangles);
        let corners = corners(&triangles, &groups);
        if corners.len() == before.len() {
            return faces(points, &triangles, &groups, count, &corners, &all, tolerance);
        }
        let start = first_tetrahedron(points, &corners, tolerance, tolerance.noise).ok()?;
        let mut hull = Quickhull::new(points, &corners, start, 10.0 * tolerance.rounding, tolerance.rounding);
        hull.grow(corners.len());
        triangles = hull.triangles();
        if vertices_of(&triangles).len() >= before.len() {
            return None;
        }
    }
}

fn vertices_of(triangles: &[Triangle]) -> Vec<u32> {
    let mut all: Vec<u32> = triangles.iter().flat_map(|t| t.vertices).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// Which face each triangle belongs to, and how many faces there are; the largest first.
fn group(points: &[DVec3], triangles: &[Triangle], flat: f64) -> (Vec<u32>, usize) {
    let mut by_area: Vec<usize> = (0..triangles.len()).collect();
    by_area.sort_by(|&a, &b| triangles[b].area.total_cmp(&triangles[a].area));
    let mut groups = vec![NONE; triangles.len()];
    let mut count = 0;
    let mut open = Vec::new();
    for seed in by_area {
        if groups[seed] != NONE {
            continue;
        }
        let plane = &triangles[seed];
        let in_plane = |t: &Triangle| {
            t.normal.dot(plane.normal) > 0.0
                && t.vertices.iter().all(|&v| plane.height(points[v as usize]).abs() <= flat)
        };
        groups[seed] = count;
        open.push(seed);
        while let Some(triangle) = open.pop() {
            for next in triangles[triangle].across.map(|t| t as usize) {
                if groups[next] == NONE && in_plane(&triangles[next]) {
                    groups[next] = count;
                    open.push(next);
                }
            }
        }
        count += 1;
    }
    (groups, count as usize)
}

/// The vertices where at least three faces meet, ascending.
fn corners(triangles: &[Triangle], groups: &[u32]) -> Vec<u32> {
    let mut at: Vec<(u32, u32)> =
        triangles.iter().zip(groups).flat_map(|(t, &g)| t.vertices.map(|v| (v, g))).collect();
    at.sort_unstable();
    at.dedup();
    at.chunk_by(|a, b| a.0 == b.0).filter(|faces| faces.len() >= 3).map(|faces| faces[0].0).collect()
}

/// The polyhedron, or none if it isn't closed, convex and flat on its faces. `all` are the vertices before
/// the merge.
fn faces(
    points: &[DVec3],
    triangles: &[Triangle],
    groups: &[u32],
    count: usize,
    corners: &[u32],
    all: &[u32],
    tolerance: Tolerance,
) -> Option<Polyhedron> {
    let mut rims: Vec<Vec<(u32, u32)>> = vec![Vec::new(); count];
    for (t, &g) in triangles.iter().zip(groups) {
        for edge in 0..3 {
            if groups[t.across[edge] as usize] != g {
                rims[g as usize].push((t.vertices[edge], t.vertices[(edge + 1) % 3]));
            }
        }
    }
    let mut faces = Vec::with_capacity(count);
    let mut normals = Vec::with_capacity(count);
    for rim in rims {
        let polygon = walk(&rim)?;
        normals.push(plane_of(points, &polygon, all, tolerance.noise)?);
        let local = polygon.iter().map(|v| corners.binary_search(v).ok().map(|i| i as u16));
        faces.push(local.collect::<Option<Vec<u16>>>()?);
    }
    let edges = edges(&faces)?;
    let euler = corners.len() as i64 - edges.len() as i64 + faces.len() as i64;
    (euler == 2).then(|| Polyhedron { vertices: corners.to_vec(), faces, normals, edges, left_out: 0.0 })
}

/// The vertices along a rim, or none if it isn't a single loop.
fn walk(rim: &[(u32, u32)]) -> Option<Vec<u32>> {
    let mut polygon = vec![rim.first()?.0];
    let mut at = rim[0].1;
    while at != polygon[0] {
        if polygon.len() >= rim.len() {
            return None;
        }
        polygon.push(at);
        let mut next = rim.iter().filter(|e| e.0 == polygon[polygon.len() - 1]);
        at = next.next()?.1;
        if next.next().is_some() {
            return None;
        }
    }
    (polygon.len() == rim.len() && polygon.len() >= 3).then_some(polygon)
}

/// The unit normal of a polygon (Newell: the mean over its corners), or none if the polygon isn't flat, isn't
/// convex or has a vertex of the hull in front of it.
fn plane_of(points: &[DVec3], polygon: &[u32], all: &[u32], noise: f64) -> Option<DVec3> {
    let at = |i: usize| points[polygon[i % polygon.len()] as usize];
    let origin = at(0);
    let doubled: DVec3 = (1..polygon.len() - 1).map(|i| (at(i) - origin).cross(at(i + 1) - origin)).sum();
    let normal = doubled.try_normalize()?;
    let height = |p: DVec3| normal.dot(p - origin);
    let front = all.iter().map(|&v| height(points[v as usize])).fold(f64::MIN, f64::max);
    let back = (0..polygon.len()).map(|i| height(at(i))).fold(f64::MAX, f64::min);
    let convex = (0..polygon.len()).all(|i| {
        let (a, b, c) = (at(i), at(i + 1), at(i + 2));
        normal.dot((b - a).cross(c - b)) >= -noise * (c - a).length()
    });
    (front - back <= 3.0 * noise && convex).then_some(normal)
}

/// Every edge once, in the order of its vertices, or none if one isn't shared by two faces that go round it
/// opposite ways.
fn edges(faces: &[Vec<u16>]) -> Option<Vec<HullEdge>> {
    // (vertices ascending, whether the face has them descending, face): the ascending one sorts first.
    let mut sides: Vec<([u16; 2], bool, u16)> = Vec::new();
    for (face, polygon) in faces.iter().enumerate() {
        for (i, &a) in polygon.iter().enumerate() {
            let b = polygon[(i + 1) % polygon.len()];
            sides.push(([a.min(b), a.max(b)], a > b, face as u16));
        }
    }
    sides.sort_unstable();
    if sides.len() % 2 == 1 {
        return None;
    }
    sides
        .chunks_exact(2)
        .enumerate()
        .map(|(i, pair)| {
            let (up, down) = (pair[0], pair[1]);
            let twice = sides.get(2 * i + 2).is_some_and(|third| third.0 == up.0);
            (up.0 == down.0 && !up.1 && down.1 && !twice)
                .then_some(HullEdge { vertices: up.0, faces: [up.2, down.2] })
        })
        .collect()
}
