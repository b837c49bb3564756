//! Merges the patches of many triangles into few manifolds.
//!
//! Patches whose normals are about the same become one manifold, if their triangles are of one material. A
//! box that lies on ten triangles has some forty points, most of them on flat edges inside its own outline.
//! Points that are furthest in none of eight directions are dropped before the more expensive reduction to
//! four.

use super::patch::Patches;
use super::triangle_contact::CORNERS;
use crate::config::tuning::{RELATED_NORMAL_COSINE, SAME_NORMAL_COSINE};
use crate::lanes::{Lanes, Vec3 as LaneVec3, f32x8};
use crate::memory::{Allowance, buffers};
use crate::narrow_phase::convex::polytope::Pose;
use crate::narrow_phase::convex::reduce::reduce;
use crate::narrow_phase::{MAX_POINTS, RawManifold, RawPoint};
use crate::shape::Ground;
use glam::{Vec3, Vec3Swizzles as _};

/// Most manifolds of a pair.
pub(crate) const MAX_MANIFOLDS: usize = 8;

/// Buffers.
#[derive(Debug, Default)]
pub(crate) struct Merge {
    pub(crate) points: Vec<RawPoint>,
    /// The manifold of each patch.
    pub(crate) place: Vec<u8>,
}

buffers! { Merge { bytes { points, place } } }

impl Merge {
    /// Reserves capacity for these patches; returns whether there was memory.
    pub(crate) fn has_place(&mut self, of: &Patches, allowance: &mut Allowance) -> bool {
        let (patches, points) = (of.patches.len(), of.points.len());
        allowance.fit(&mut self.place, patches) >= patches
            && allowance.fit(&mut self.points, points) >= points
    }

    /// Adds the manifolds of patches that are sorted, the deepest first.
    pub(crate) fn manifolds(
        &mut self,
        patches: &Patches,
        ground: &Ground<'_>,
        pose: &Pose,
        size: f32,
        out: &mut Vec<RawManifold>,
    ) {
        let mut normals = [Vec3::ZERO; MAX_MANIFOLDS];
        let mut materials = [0; MAX_MANIFOLDS];
        let mut count = 0;
        self.place.clear();
        for patch in &patches.patches {
            let material = ground.material(patches.touches[patch.touch as usize].index);
            // Once there are as many as there may be, materials are told apart no longer: the deepest patch
            // of a manifold decides.
            let full = count == MAX_MANIFOLDS;
            let some = (0..count).filter(|&i| full || materials[i] == material);
            let nearest = some
                .map(|i| (normals[i].dot(patch.normal), i))
                .fold((f32::MIN, MAX_MANIFOLDS), |best, this| if this.0 > best.0 { this } else { best });
            let place = if nearest.0 > SAME_NORMAL_COSINE || (full && nearest.0 > RELATED_NORMAL_COSINE) {
                nearest.1
            } else if !full {
                (normals[count], materials[count]) = (patch.normal, material);
                count += 1;
                count - 1
            } else {
                // Too many different normals: the shallowest are dropped.
                MAX_MANIFOLDS
            };
            self.place.push(place as u8);
        }
        for (i, &normal) in normals[..count].iter().enumerate() {
            self.points.clear();
            for (patch, _) in
                patches.patches.iter().zip(&self.place).filter(|(_, place)| usize::from(**place) == i)
            {
                let first = patch.first as usize;
                self.points.extend_from_slice(&patches.points[first..first + patch.count as usize]);
            }
            let mut manifold = few(&self.points, normal, size);
            manifold.material = materials[i].into();
            // A corner keeps its key from triangle to triangle; floors and walls are told apart by the side
            // they face.
            let side = pose.back(normal);
            // Of equals the last.
            let axis = 2 - side.abs().zyx().max_position();
            let facing = 2 * axis as u32 + u32::from(side[axis] > 0.0);
            for point in &mut manifold.points[..manifold.count as usize] {
                if point.key < CORNERS {
                    point.key |= facing << 8;
                }
            }
            out.push(manifold);
        }
    }
}

/// At most four of the points.
fn few(points: &[RawPoint], normal: Vec3, size: f32) -> RawManifold {
    let mut some = [RawPoint::default(); 9];
    let mut count = 0;
    let same = 1e-3 * size;
    let mut take = |point: &RawPoint| {
        // The deepest of several at the same place: corners where triangles meet.
        for other in some[..count].iter_mut() {
            if (other.position - point.position).length_squared() < same * same {
                if point.separation < other.separation {
                    *other = *point;
                }
                return;
            }
        }
        if count < some.len() {
            some[count] = *point;
            count += 1;
        }
    };
    if points.len() <= MAX_POINTS {
        points.iter().for_each(&mut take);
    } else {
        furthest(points, normal, 1e-5 * size).iter().for_each(|&i| take(&points[i]));
    }
    let (points, count) = reduce(&some[..count], normal);
    RawManifold { normal, count: count as u16, material: 0, points }
}

/// The points furthest in eight directions across the normal, and the deepest; some may be the same. The
/// first of equally far ones counts.
fn furthest(points: &[RawPoint], normal: Vec3, tolerance: f32) -> [usize; 9] {
    // Guard: an identity of geometry.
    const DIAGONAL: f32 = std::f32::consts::FRAC_1_SQRT_2;
    let (u, v) = LaneVec3::<f32>::splat(normal).tangents();
    let (u, v) = (LaneVec3::<f32x8>::splat(u.lane(0)), LaneVec3::splat(v.lane(0)));
    // Every corner of a rectangle that lies along u and v is furthest along a diagonal, and the other way
    // round; the eight are turned by an odd angle, or of two corners at one edge either might be the
    // furthest.
    let x = f32x8::new([1.0, DIAGONAL, 0.0, -DIAGONAL, -1.0, -DIAGONAL, 0.0, DIAGONAL]);
    let y = f32x8::new([0.0, DIAGONAL, 1.0, DIAGONAL, 0.0, -DIAGONAL, -1.0, -DIAGONAL]);
    let (s, c) = (f32x8::splat(0.224_951), f32x8::splat(0.974_370));
    let (x, y) = (x * c - y * s, x * s + y * c);
    let directions = u * x + v * y;

    let mut best = f32x8::splat(f32::MIN);
    let mut index = f32x8::zero();
    let mut deepest = 0;
    for (i, point) in points.iter().enumerate() {
        let along = directions.dot(LaneVec3::splat(point.position));
        let further = along.gt(best + f32x8::splat(tolerance));
        best = Lanes::select(further, along, best);
        index = Lanes::select(further, f32x8::splat(i as f32), index);
        if point.separation < points[deepest].separation - tolerance {
            deepest = i;
        }
    }
    let index = index.to_array();
    let mut found: [usize; 9] = std::array::from_fn(|i| index[i % 8] as usize);
    // Only if it is clearly deeper than those at the border: a box that lies flat keeps its corners.
    let least = found.iter().map(|&i| points[i].separation).fold(f32::MAX, f32::min);
    if points[deepest].separation < least - 10.0 * tolerance {
        found[8] = deepest;
    }
    found
}

#[cfg(test)]
mod tests {
    use crate::math::Quat;
    use crate::narrow_phase::convex::testing;
    use crate::narrow_phase::mesh::reach::Reach;
    use crate::narrow_phase::mesh::{MeshScratch, collide_mesh};
    use crate::narrow_phase::{RawPoint, Relative};
    use crate::random::Random;
    use crate::shape::mesh::testing::grid;
    use crate::shape::{Collider, Geometry, TriangleMesh};
    use glam::Vec3;
    use std::sync::Arc;

    /// Flat, of uneven triangles of about `cell` metres, none of which folds over its neighbour.
    fn uneven(cells: u32, cell: f32, random: &mut Random) -> Collider {
        let (mut vertices, triangles) = grid(cells, cell, |_, _| 0.0);
        for v in &mut vertices {
            *v += random.cube().with_y(0.0) * (0.2 * cell);
        }
        testing::collider(Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles).unwrap())))
    }

    /// A flat mesh is a plane, so a capsule that lies on it rests on both ends of its side and nothing else,
    /// for any triangles and any margin.
    #[test]
    fn a_capsule_that_lies_on_uneven_triangles_bears_on_the_ends_of_its_side() {
        let mut random = Random(5);
        let (half, radius) = (0.5, 0.25);
        let shape = testing::collider(Geometry::capsule(half, radius));
        let (mut scratch, mut out) = (MeshScratch::default(), Vec::new());
        for (cells, cell) in [(16, 0.25), (40, 0.1), (80, 0.05), (4, 1.0)] {
            for _ in 0..4 {
                let ground = uneven(cells, cell, &mut random);
                for i in 0..2000 {
                    let yaw = if i % 4 == 0 { 0.0 } else { random.range(-3.0, 3.0) };
                    let rotation =
                        Quat::from_rotation_y(yaw) * Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
                    let gap = random.range(-1e-3, 1e-3);
                    let position = Vec3::new(random.range(-0.9, 0.9), radius + gap, random.range(-0.9, 0.9));
                    let rel = Relative { position, rotation }.inverse();
                    let margin = if i % 2 == 0 { 0.01 } else { 0.15 };
                    out.clear();
                    collide_mesh(&shape, &ground, &rel, Reach::new(margin), &mut scratch, &mut out);
                    assert_eq!(out.len(), 1, "{cell} {i} {out:?}");
                    for end in [-half, half] {
                        let near = |p: &RawPoint| (p.position.y - end).abs() < 1e-3;
                        assert!(
                            out[0].points().iter().any(near),
                            "{cell} {i} {position} {rotation:?} {out:?}"
                        );
                    }
                    // Round as the ends are, 3 mm beyond them it is 20 um higher.
                    for p in out[0].points() {
                        assert!(
                            (p.separation - gap).abs() < 2e-5,
                            "{cell} {i} {position} {rotation:?} {out:?}"
                        );
                    }
                }
            }
        }
    }

    /// On a flat mesh a cylinder that lies bears on its lowest line, for any triangles: a point before or
    /// behind that moves with the shape as it rolls, and would be pushed.
    #[test]
    fn a_cylinder_that_lies_on_uneven_triangles_bears_on_its_lowest_line() {
        let mut random = Random(5);
        let (half, radius) = (0.2, 0.4);
        let shape = testing::collider(Geometry::cylinder(half, radius));
        let (mut scratch, mut out) = (MeshScratch::default(), Vec::new());
        for (cells, cell) in [(16, 0.25), (40, 0.1), (80, 0.05), (4, 1.0)] {
            let ground = uneven(cells, cell, &mut random);
            for i in 0..2000 {
                let yaw = if i % 4 == 0 { 0.0 } else { random.range(-3.0, 3.0) };
                let rotation = Quat::from_rotation_y(yaw)
                    * Quat::from_rotation_x(std::f32::consts::FRAC_PI_2)
                    * Quat::from_rotation_y(random.range(-3.0, 3.0));
                let gap = random.range(-1e-4, 1e-4);
                let position = Vec3::new(random.range(-0.9, 0.9), radius + gap, random.range(-0.9, 0.9));
                let rel = Relative { position, rotation }.inverse();
                let margin = if i % 2 == 0 { 0.02 } else { 0.15 };
                out.clear();
                collide_mesh(&shape, &ground, &rel, Reach::new(margin), &mut scratch, &mut out);
                assert_eq!(out.len(), 1, "{cell} {i} {out:?}");
                let across = (rotation * Vec3::Y).cross(Vec3::Y);
                let off = |p: &RawPoint| (rotation * p.position).dot(across).abs();
                let worst = out[0].points().iter().map(off).fold(0.0, f32::max);
                let end = out[0].points().iter().map(|p| p.position.y).fold(f32::MIN, f32::max);
                assert!(worst < 3e-3 && end > half - 2e-3, "{cell} {i} {yaw} {position}: {out:?}");
            }
        }
    }
}
