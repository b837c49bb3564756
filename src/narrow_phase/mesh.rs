//! A convex shape against a triangle mesh or a height field.
//!
//! Triangles near the shape are gathered in eights and brought into its frame. In lanes, most are found to be
//! apart by more than the margin. Each of the others yields a *patch*: a normal and the points nearer than the margin,
//! real and potential ones in one go ([`mesh_box`](super::mesh_box), [`mesh_sphere`](super::mesh_sphere),
//! [`mesh_capsule`](super::mesh_capsule), [`mesh_hull`](super::mesh_hull), [`mesh_cylinder`](super::mesh_cylinder)). A
//! patch whose normal the surface doesn't have there, because its edge is flat or concave, takes the triangle's or goes
//! ([`mesh_patch`](super::mesh_patch)). Patches of about the same normal become one manifold of at most four points
//! ([`mesh_merge`](super::mesh_merge)).
//!
//! A triangle has two sides; the one on which the body's centre of mass is counts as outside, so that a shape that is
//! stuck halfway is pushed back to where its centre is ([`side_of`]).

use super::clip::CLOUD;
use super::gjk::distance;
use super::mesh_merge::{MOST, Merge};
use super::mesh_patch::{Patches, Touch};
use super::mesh_reach::{Near, Reach, along, around, bounds, side_of};
use super::nearby::{Eight, Ground, Nearby};
use super::polytope::Pose;
use super::round_polytope::Core;
use super::support::Support;
use super::touched::Touched;
use super::{RawManifold, RawPoint, Relative, mesh_box, mesh_capsule, mesh_cylinder, mesh_hull, mesh_sphere};
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, f32x8};
use crate::memory::{Buffer, Buffers, Room};
use crate::shape::{Collider, Geometry};
use glam::Vec3;

/// Feature of a triangle's key: the deepest point of the shape, wherever that is.
const DEEPEST: u32 = 0x7f;

/// Eight triangles in the shape's frame.
pub(super) struct Triangles {
    pub(super) corners: [LaneVec3<f32x8>; 3],
    /// Unit, to the side on which the shape belongs.
    pub(super) front: LaneVec3<f32x8>,
    /// Height of the shape's origin over the plane [m].
    pub(super) height: f32x8,
    /// Lanes in which the winding's own front is away from the shape.
    behind: u32,
    /// Lanes that hold a triangle whose normal is known.
    pub(super) valid: u32,
    index: [u32; 8],
}

impl Triangles {
    /// `side`: of the shape, the point whose side it belongs on.
    #[inline(always)]
    pub(super) fn new(eight: &Eight, lanes: u32, pose: &Pose, side: Vec3) -> Triangles {
        let m = &pose.axes;
        // Written out: arrays that are mapped or iterated over by value are not kept in registers.
        let (x_axis, y_axis, z_axis) =
            (LaneVec3::<f32x8>::splat(m.x_axis), LaneVec3::splat(m.y_axis), LaneVec3::splat(m.z_axis));
        let position = LaneVec3::splat(pose.position);
        let corner = |k: usize| {
            let at = eight.corners.corner(k);
            x_axis * at.x + y_axis * at.y + z_axis * at.z + position
        };
        let corners = [corner(0), corner(1), corner(2)];
        let cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let squared = cross.length_squared();
        let valid = squared.gt(f32x8::splat(f32::MIN_POSITIVE));
        let length = Lanes::select(valid, squared, f32x8::one()).sqrt();
        let before = cross.dot(LaneVec3::splat(side) - corners[0]);
        let behind = before.lt(f32x8::zero());
        let scale = before.sign() / length;
        Triangles {
            corners,
            front: cross * scale,
            height: -cross.dot(corners[0]) * scale,
            behind: behind.bits(),
            valid: valid.bits() & lanes,
            index: eight.index,
        }
    }

    /// One of them.
    #[inline]
    pub(super) fn touch(&self, lane: usize, ground: &Ground) -> Touch {
        let behind = self.behind >> lane & 1 != 0;
        Touch {
            corners: [self.corners[0].lane(lane), self.corners[1].lane(lane), self.corners[2].lane(lane)],
            front: self.front.lane(lane),
            behind,
            edges: ground.edges(self.index[lane]).seen(behind),
            index: self.index[lane],
        }
    }

    /// How far a box is apart from each: along the triangles' normals, and the most along
    /// the box's own axes, with the axis: 0, 1, 2 towards +x, +y, +z, then 3, 4, 5 towards -x, -y, -z.
    ///
    /// An axis on which the box would leave to the back of a triangle it overlaps doesn't count.
    #[inline(always)]
    pub(super) fn separate(&self, centre: Vec3, half: Vec3) -> (f32x8, f32x8, f32x8) {
        let [a, b, c] = self.corners;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let face = self.height - self.front.abs().dot(LaneVec3::splat(half));
        let mut best = f32x8::splat(f32::MIN);
        let mut axis = f32x8::zero();
        let zero = f32x8::zero();
        let mut try_axis = |name: usize, apart: f32x8, through: f32x8| {
            let wrong = through.gt(f32x8::splat(1e-3)) & apart.lt(zero);
            let better = apart.gt(best) & !wrong;
            best = Lanes::select(better, apart, best);
            axis = Lanes::select(better, f32x8::splat(name as f32), axis);
        };
        let f = self.front;
        let (c, h) = (LaneVec3::<f32x8>::splat(centre), LaneVec3::<f32x8>::splat(half));
        try_axis(0, low.x - c.x - h.x, f.x);
        try_axis(1, low.y - c.y - h.y, f.y);
        try_axis(2, low.z - c.z - h.z, f.z);
        try_axis(3, c.x - high.x - h.x, -f.x);
        try_axis(4, c.y - high.y - h.y, -f.y);
        try_axis(5, c.z - high.z - h.z, -f.z);
        (face, best, axis)
    }
}

/// Buffers of [`collide_mesh`], kept from call to call.
#[derive(Default)]
pub(crate) struct MeshScratch {
    pub(crate) nearby: Nearby,
    patches: Patches,
    merge: Merge,
    /// What its buffers may still grow by.
    pub(crate) room: Room,
    /// How often they could not: triangles, or manifolds' points, that were left out.
    pub(crate) shed: u32,
}

impl Buffers for MeshScratch {
    fn each(&mut self, f: &mut dyn FnMut(&mut dyn Buffer)) {
        f(self.nearby.buffer());
        f(&mut self.patches.touches);
        f(&mut self.patches.patches);
        f(&mut self.patches.points);
        f(&mut self.merge.points);
        f(&mut self.merge.place);
    }
}

impl std::fmt::Debug for MeshScratch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MeshScratch").finish_non_exhaustive()
    }
}

impl MeshScratch {
    /// What of the ground the last shape, which was `a`, is within a distance of [m]; not all of it, if that is much.
    /// `way`: of the shape in its own frame, of which no more than `margin` may lead into a plane [m].
    pub(crate) fn touched(&self, a: &Collider, within: f32, (way, margin): (Vec3, f32)) -> Touched {
        let Patches { touches, patches, .. } = &self.patches;
        let mut touched = Touched::of(a);
        for patch in patches.iter().filter(|p| p.least <= within) {
            let touch = &touches[patch.touch as usize];
            touched.add_triangle(touch.index);
            if patch.reach.is_some() {
                touched.add_plane(touch.front, touch.front.dot(touch.corners[0]), way, margin);
            }
        }
        touched
    }

    /// A triangle that the last shape, which was `a`, pierces although no manifold says so, because the way out past its edge is
    /// shorter and leads behind a neighbour: how far the shape is beyond its plane, and the normal into it.
    pub(crate) fn pierced(&self, a: &Collider) -> Option<(f32, Vec3)> {
        let (touch, apart) = self.patches.passed_over()?;
        let here = Relative { position: Vec3::ZERO, rotation: glam::Quat::IDENTITY };
        let gap = distance(&Support::of(a)?, &Support::triangle(touch.corners), &here, Vec3::ZERO);
        (gap.overlap || gap.distance < 0.0).then_some((-apart, -touch.front))
    }

    /// Where triangles are gathered, if there is room.
    pub(crate) fn nearby(&mut self) -> Option<&mut Nearby> {
        self.nearby.has_place(&mut self.room).then_some(&mut self.nearby)
    }

    /// Calls `f` with each buffer and the place that looks with no room to grow need: for the triangles that are held, and for
    /// what so many of them yield.
    pub(crate) fn each_ready(&mut self, triangles: usize, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        // The next eight triangles must find place for all that they might yield; most yield four.
        let points = 4 * triangles + 8 * CLOUD;
        f(self.nearby.buffer(), super::nearby::CHUNK);
        f(&mut self.patches.touches, triangles);
        f(&mut self.patches.patches, triangles);
        f(&mut self.patches.points, points);
        f(&mut self.merge.points, points);
        f(&mut self.merge.place, triangles);
    }

    /// Bytes of the triangles that a look holds.
    pub(crate) fn least(&mut self) -> usize {
        self.nearby.buffer().missing(super::nearby::CHUNK)
    }

    /// Bytes live and reserved.
    pub(crate) fn bytes(&self) -> (usize, usize) {
        let parts = [self.nearby.bytes(), self.patches.bytes(), self.merge.bytes()];
        parts.iter().fold((0, 0), |sum, part| (sum.0 + part.0, sum.1 + part.1))
    }
}

/// All points of a convex shape and a mesh or height field that are nearer than the margin, as up to
/// [`MOST`](super::mesh_merge::MOST) manifolds in the shape's frame, added to `out`; the deepest first. Says whether anything was
/// near enough to be looked at.
pub(crate) fn collide_mesh(
    a: &Collider,
    b: &Collider,
    rel: &Relative,
    reach: Reach,
    scratch: &mut MeshScratch,
    out: &mut Vec<RawManifold>,
) -> bool {
    let Some(ground) = Ground::of(b) else { return false };
    let Some((middle, half)) = bounds(a) else { return false };
    let (pose, side) = (Pose::new(rel.position, rel.rotation), side_of(a));
    let MeshScratch { nearby, patches, merge, room, shed } = scratch;
    if !nearby.has_place(room) {
        *shed += 1;
        return false;
    }
    patches.clear();
    let (each, core) = (points_each(a), Core::of(a));
    let Reach { margin, within, way } = reach;
    let mut near = Near::default();
    let mut extent = along(&pose, around(&pose, (middle, half + Vec3::splat(margin))), way);
    if within < margin {
        let close = around(&pose, (middle, half + Vec3::splat(within.max(0.0))));
        nearby.gather(&ground, close, &mut |found| {
            for (eight, lanes) in found.each() {
                let triangles = Triangles::new(eight, lanes, &pose, side);
                near.add(&triangles, a, (middle, half), within);
            }
        });
        if near.count == 0 {
            return false;
        }
        extent = near.extent(&pose, close, margin).unwrap_or(extent);
    }
    nearby.gather(&ground, extent, &mut |found| {
        for (eight, lanes) in found.each() {
            // Whatever these triangles yield must find place: the functions below don't ask.
            if !room.is_endless() && !patches.has_place(8, each, room) {
                *shed += 1;
                return;
            }
            let triangles = Triangles::new(eight, lanes, &pose, side);
            let margins = near.margins(&triangles, reach);
            match (&a.geometry, &core) {
                (Geometry::Sphere { radius }, _) => {
                    mesh_sphere::touch(*radius, &triangles, margins, &ground, patches);
                }
                (Geometry::Box { half_extents }, _) => {
                    mesh_box::touch(*half_extents, &triangles, margins, &ground, patches);
                }
                (Geometry::Hull(hull), _) => {
                    mesh_hull::touch((hull, a.radius), (middle, half), &triangles, margins, &ground, patches);
                }
                (_, Some(core)) => {
                    mesh_capsule::touch((core, half, a.radius), &triangles, margins, &ground, patches);
                }
                _ => mesh_cylinder::touch(a, (middle, half), &triangles, margins, &ground, patches),
            }
        }
    });
    if let Geometry::Sphere { radius } = a.geometry {
        mesh_sphere::finish(radius, patches);
    }
    if let (Some(touch), Some(shape)) = (patches.spare(), Support::of(a)) {
        let front = touch.front.as_dvec3();
        let deepest = (shape.support(-front) - front * shape.radius).as_vec3();
        let separation = touch.front.dot(deepest - touch.corners[0]);
        let position = deepest - touch.front * (0.5 * separation);
        patches.points.push(RawPoint { position, separation, key: mesh_box::key(touch.index, DEEPEST) });
        patches.add(touch, -touch.front, Some(separation), patches.points.len() - 1);
    }
    patches.drop_backs(side);
    patches.drop_hidden(a.radius);
    if !room.is_endless() {
        let place = out.len() + MOST;
        if !merge.has_place(patches, room) || room.fit(out, place) < place {
            *shed += 1;
            return true;
        }
    }
    merge.manifolds(patches, &pose, a.radius, out);
    true
}

/// The most points that a triangle yields.
fn points_each(a: &Collider) -> usize {
    match a.geometry {
        Geometry::Sphere { .. } => 1,
        Geometry::Capsule { .. } => 4,
        Geometry::Box { .. } => 8,
        _ => CLOUD,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::narrow_phase::convex::{collide_triangle, testing};
    use crate::shape::mesh::testing::{Random, bumpy, cuboid, grid, terrain};
    use crate::shape::{HeightField, Kind, TriangleMesh};
    use glam::{Quat, Vec2};
    use std::sync::Arc;

    const MARGIN: f32 = 0.02;

    fn mesh((vertices, triangles): (Vec<Vec3>, Vec<[u32; 3]>)) -> Collider {
        testing::collider(Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles).unwrap())))
    }

    fn flat_field() -> Collider {
        let field = HeightField::new(17, 17, Vec2::splat(0.25), vec![0.0; 17 * 17]).unwrap();
        testing::collider(Geometry::HeightField(Arc::new(field)))
    }

    /// Manifolds of a shape at a pose in the mesh's frame, brought into that frame.
    fn collide(a: &Collider, b: &Collider, position: Vec3, rotation: Quat, margin: f32) -> Vec<RawManifold> {
        let back = rotation.conjugate();
        let rel = Relative { position: -(back * position), rotation: back };
        let (mut scratch, mut out) = (MeshScratch::default(), Vec::new());
        collide_mesh(a, b, &rel, Reach::new(margin), &mut scratch, &mut out);
        for m in &mut out {
            m.normal = rotation * m.normal;
            for p in &mut m.points[..m.count as usize] {
                p.position = rotation * p.position + position;
            }
        }
        out
    }

    fn shapes() -> Vec<Collider> {
        let mut random = testing::Random(3);
        vec![
            testing::collider(Geometry::Sphere { radius: 0.3 }),
            testing::collider(Geometry::capsule(0.3, 0.2)),
            testing::collider(Geometry::cuboid(0.3, 0.2, 0.4)),
            testing::collider(Geometry::cylinder(0.25, 0.3)),
            testing::collider(testing::hull(&mut random, 20)),
        ]
    }

    #[test]
    fn a_flat_mesh_is_felt_as_a_plane_by_every_shape() {
        let mut random = Random(1);
        let fields =
            [(mesh(grid(16, 0.25, |_, _| 0.0)), Vec3::ZERO), (flat_field(), Vec3::new(2.0, 0.0, 2.0))];
        for shape in shapes() {
            for (ground, middle) in &fields {
                for i in 0..400 {
                    let rotation = match i % 4 {
                        0 => Quat::IDENTITY,
                        1 => Quat::from_rotation_y(random.range(-3.0, 3.0)),
                        2 => Quat::from_rotation_x(std::f32::consts::FRAC_PI_2),
                        _ => random.rotation(),
                    };
                    let plane =
                        testing::extent(&shape, (rotation.conjugate() * Vec3::NEG_Y).as_dvec3()) as f32;
                    let gap = random.range(-0.01, 0.01);
                    let side = if i % 2 == 0 { 1.0 } else { -1.0 };
                    // From below: the same the other way up.
                    let plane = if side < 0.0 {
                        testing::extent(&shape, (rotation.conjugate() * Vec3::Y).as_dvec3()) as f32
                    } else {
                        plane
                    };
                    let mut position = *middle + random.cube() * 1.2;
                    position.y = side * (plane + gap);
                    let found = collide(&shape, ground, position, rotation, MARGIN);
                    assert_eq!(found.len(), 1, "{:?} {i} {found:?}", shape.kind);
                    let m = &found[0];
                    let up = Vec3::NEG_Y * side;
                    assert!((m.normal - up).length() < 1e-5, "{:?} {i} {:?}", shape.kind, m.normal);
                    let least = m.points().iter().map(|p| p.separation).fold(f32::MAX, f32::min);
                    assert!((least - gap).abs() < 2e-4, "{:?} {i} {least} {gap}", shape.kind);
                    for p in m.points() {
                        assert!(p.separation <= MARGIN && p.separation >= gap - 2e-4);
                        assert!((p.position.y - 0.5 * side * p.separation).abs() < 1e-4);
                        let away = (p.position - position).length();
                        assert!(away < shape.radius + MARGIN, "{:?} {i} {away} {m:?}", shape.kind);
                    }
                }
            }
        }
    }

    #[test]
    fn a_box_on_many_triangles_rests_on_its_corners_and_they_keep_their_keys() {
        let ground = mesh(grid(16, 0.25, |_, _| 0.0));
        let shape = testing::collider(Geometry::cuboid(0.6, 0.2, 0.5));
        let mut keys = None;
        for i in 0..200 {
            // 5 mm a step, at an angle to the grid.
            let position = Vec3::new(-0.5 + 0.005 * i as f32, 0.199, -0.2 + 0.002 * i as f32);
            let rotation = Quat::from_rotation_y(0.3);
            let found = collide(&shape, &ground, position, rotation, MARGIN);
            assert_eq!(found.len(), 1);
            assert!((found[0].normal - Vec3::NEG_Y).length() < 1e-6);
            assert_eq!(found[0].count, 4);
            let mut now = Vec::new();
            for p in found[0].points() {
                let local = rotation.conjugate() * (p.position - position);
                assert!((local.x.abs() - 0.6).abs() < 1e-4 && (local.z.abs() - 0.5).abs() < 1e-4, "{local}");
                assert!((p.separation + 0.001).abs() < 1e-5);
                now.push(p.key);
            }
            now.sort_unstable();
            now.dedup();
            assert_eq!(now.len(), 4);
            assert_eq!(*keys.get_or_insert(now.clone()), now);
        }
    }

    /// A rod of 1 m by 2 cm, halfway through a floor of two triangles a cell, wherever it crosses: one of them pushes it to
    /// where its centre is. What of the rod is over the other triangle may be left out.
    #[test]
    fn a_rod_that_is_stuck_halfway_close_to_an_edge_is_pushed_back() {
        let floor = mesh(grid(4, 10.0, |_, _| 0.0));
        let rods = [Geometry::cuboid(0.01, 0.5, 0.01), Geometry::capsule(0.49, 0.01)];
        let mut random = Random(12);
        for i in 0..2000 {
            let rod = testing::collider(rods[i % 2].clone());
            let rotation = Quat::from_rotation_z(random.range(0.0, 1.2))
                * Quat::from_rotation_y(random.range(-3.0, 3.0));
            // On the diagonal of a cell, give or take 5 mm.
            let along = random.range(1.0, 9.0);
            let position = Vec3::new(along, random.range(1e-4, 2e-3), along + random.range(-0.005, 0.005));
            let found = collide(&rod, &floor, position, rotation, 0.5);
            let deepest = found.iter().flat_map(|m| m.points().iter().map(move |p| (m.normal, p.separation)));
            let (normal, least) = deepest.fold((Vec3::ZERO, 0.0), |s, p| if p.1 < s.1 { p } else { s });
            let reach = testing::extent(&rod, (rotation.conjugate() * Vec3::NEG_Y).as_dvec3()) as f32;
            assert!(normal.dot(Vec3::NEG_Y) > 0.999, "{i} {found:?}");
            let depth = position.y - reach;
            assert!(least < 0.25 * depth && least > depth - 1e-3, "{i} {least} {depth} {found:?}");
        }
    }

    #[test]
    fn a_shape_that_slides_over_the_edge_of_a_table_is_not_held_back() {
        // The sides and the bottom are behind the top; with and without cells on all of them.
        let table = mesh(cuboid(Vec3::new(1.0, 0.05, 1.0)));
        let mut random = Random(8);
        // Not the hull: its slanted faces do touch the edge.
        for shape in shapes().into_iter().take(4) {
            let lying = if shape.kind == Kind::Capsule {
                Quat::from_rotation_z(std::f32::consts::FRAC_PI_2)
            } else {
                Quat::IDENTITY
            };
            for i in 0..600 {
                let rotation = Quat::from_rotation_y(random.range(-3.0, 3.0)) * lying;
                let reach = testing::extent(&shape, (rotation.conjugate() * Vec3::NEG_Y).as_dvec3()) as f32;
                let gap = -random.range(0.0, 0.002);
                // Its centre is over the table, but its side hangs over.
                let position = Vec3::new(1.0 - 0.001 * i as f32, 0.05 + reach + gap, random.range(-0.9, 0.9));
                let found = collide(&shape, &table, position, rotation, MARGIN);
                assert!(!found.is_empty(), "{:?} {i}", shape.kind);
                for m in &found {
                    assert!(m.normal.y < -0.9999, "{:?} {i} {} {:?}", shape.kind, m.normal, m.points());
                }
            }
        }
    }

    #[test]
    fn a_box_on_a_ridge_touches_the_ridge() {
        // A roof along z, 30 degrees on either side.
        let slope = libm::tanf(std::f32::consts::FRAC_PI_6);
        let roof = mesh(grid(8, 0.5, |x, _| -slope * x.abs()));
        let shape = testing::collider(Geometry::cuboid(0.3, 0.2, 0.4));
        for offset in [0.0, 0.1, -0.2] {
            let found = collide(&shape, &roof, Vec3::new(offset, 0.199, 0.1), Quat::IDENTITY, MARGIN);
            let m = &found[0];
            assert_eq!(found.len(), 1, "{found:?}");
            assert!((m.normal - Vec3::NEG_Y).length() < 1e-5);
            for p in m.points().iter().filter(|p| p.separation < 0.0) {
                assert!(p.position.x.abs() < 1e-4 && (p.separation + 0.001).abs() < 1e-5, "{p:?}");
            }
            let ends = m.points().iter().filter(|p| p.separation < 0.0);
            let (low, high) =
                ends.fold((f32::MAX, f32::MIN), |e, p| (e.0.min(p.position.z), e.1.max(p.position.z)));
            assert!((low + 0.3).abs() < 1e-4 && (high - 0.5).abs() < 1e-4);
        }
        // Flat on one side: nothing of the other.
        let rotation = Quat::from_rotation_z(-std::f32::consts::FRAC_PI_6);
        let up = rotation * Vec3::Y;
        let at = Vec3::new(0.4, -0.4 * slope, 0.0) + up * 0.1995;
        let found = collide(&shape, &roof, at, rotation, 0.005);
        assert_eq!(found.len(), 1);
        assert!((found[0].normal + up).length() < 1e-5);
        assert_eq!(found[0].count, 4);
    }

    #[test]
    fn a_box_in_a_corner_touches_floor_and_wall() {
        let valley = mesh(grid(8, 0.5, |x, _| if x > 0.9 { 4.0 * (x - 1.0) } else { 0.0 }));
        let shape = testing::collider(Geometry::cuboid(0.3, 0.2, 0.4));
        let found = collide(&shape, &valley, Vec3::new(0.699, 0.199, 0.1), Quat::IDENTITY, MARGIN);
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(
            (found[0].normal - Vec3::NEG_Y).length() < 1e-5
                || (found[1].normal - Vec3::NEG_Y).length() < 1e-5
        );
        let wall = Vec3::new(4.0, -1.0, 0.0).normalize();
        assert!(found.iter().any(|m| (m.normal - wall).length() < 1e-5), "{found:?}");
    }

    #[test]
    fn a_shape_stuck_halfway_is_pushed_to_its_centres_side() {
        let ground = mesh(grid(16, 0.25, |_, _| 0.0));
        let mut random = Random(2);
        for shape in shapes() {
            for i in 0..100 {
                let rotation = if i % 2 == 0 { Quat::IDENTITY } else { random.rotation() };
                let side = if i % 3 == 0 { -1.0 } else { 1.0 };
                let position = Vec3::new(0.1, side * random.range(0.005, 0.08), 0.07);
                let position = position - rotation * side_of(&shape);
                let found = collide(&shape, &ground, position, rotation, MARGIN);
                assert!(!found.is_empty());
                for m in &found {
                    assert!(m.normal.y * side < -0.999, "{:?} {i} {} {side}", shape.kind, m.normal);
                }
                let deepest = found[0].points().iter().map(|p| p.separation).fold(0.0, f32::min);
                assert!(deepest < -0.1, "{:?} {deepest}", shape.kind);
            }
        }
    }

    /// The centre of mass of a tapered cylinder is nearer to its wide end than its origin is. The guard keeps the former
    /// above the ground, so that tells which way is out, even if the origin is below.
    #[test]
    fn a_shape_is_pushed_to_the_side_of_its_centre_of_mass() {
        let ground = mesh(grid(16, 0.25, |_, _| 0.0));
        let cone = Geometry::Cylinder { half_height: 0.4, radius_bottom: 0.3, radius_top: 0.1 };
        // Of a frustum: h (R² + 2 R r + 3 r²) / (4 (R² + R r + r²)) above its base, h = 0.8, R = 0.3, r = 0.1.
        let above_base = 0.8 * (0.09 + 0.06 + 0.03) / (4.0 * (0.09 + 0.03 + 0.01));
        let mut shape = testing::collider(cone);
        shape.position = Vec3::new(0.0, 0.4 - above_base, 0.0);
        // Upside down: the wide end is up, the centre of mass 0.123 m above the origin.
        let rotation = Quat::from_rotation_x(std::f32::consts::PI);
        for (origin, side) in [(-0.05, 1.0), (-0.11, 1.0), (-0.14, -1.0), (0.05, 1.0)] {
            let found = collide(&shape, &ground, Vec3::new(0.1, origin, 0.07), rotation, MARGIN);
            assert!(!found.is_empty());
            for m in &found {
                assert!(m.normal.y * side < -0.999, "{origin} {}", m.normal);
            }
        }
    }

    /// A plate that has sunk into a roof, its centre over one slope and above it, is below the plane in which the other
    /// slope goes on: what overlaps that one must not be pushed further in.
    #[test]
    fn a_plate_that_has_sunk_into_a_ridge_is_pushed_out_of_it() {
        let slope = 0.3;
        let roof = mesh(grid(16, 0.25, |x, _| -slope * x.abs()));
        let plate = testing::collider(Geometry::cuboid(0.4, 0.01, 0.3));
        for depth in [0.01, 0.02, 0.04] {
            for x in [-0.25, -0.15, -0.06] {
                for tilt in [0.0, 0.15, 0.25] {
                    let position = Vec3::new(x, slope * x + 0.009, 0.05);
                    // Its right end is below the ridge, in the other slope.
                    let rotation = Quat::from_rotation_z(tilt - depth);
                    let found = collide(&plate, &roof, position, rotation, 0.0);
                    for m in &found {
                        assert!(m.normal.y < 0.0, "{depth} {x} {tilt} {m:?}");
                    }
                }
            }
        }
    }

    /// On bumpy ground the deepest point is where triangles one by one have theirs.
    #[test]
    fn what_touches_rough_ground_is_found() {
        let ground = terrain(40);
        let shared = Arc::new(ground);
        let collider = testing::collider(Geometry::Mesh(shared.clone()));
        let mut random = Random(4);
        let mut seen = 0;
        for shape in shapes() {
            for _ in 0..1500 {
                let rotation = random.rotation();
                let (x, z) = (random.range(-8.0, 8.0), random.range(-8.0, 8.0));
                let position = Vec3::new(x, bumpy(x, z) + random.range(0.1, 0.6), z);
                let back = rotation.conjugate();
                let mut least = f32::MAX;
                for t in 0..shared.triangle_count() as u32 {
                    let corners = shared.triangle(t);
                    let far = |c: &Vec3| (*c - position).length() > shape.radius + 1.0;
                    if !corners.iter().all(far) {
                        let m = collide_triangle(&shape, corners.map(|c| back * (c - position)), 0.05);
                        least = m.points().iter().map(|p| p.separation).fold(least, f32::min);
                    }
                }
                if !(-0.005..=0.04).contains(&least) {
                    continue;
                }
                seen += 1;
                let found = collide(&shape, &collider, position, rotation, 0.05);
                let deepest =
                    found.iter().flat_map(|m| m.points()).map(|p| p.separation).fold(f32::MAX, f32::min);
                if (deepest - least).abs() >= 0.004 {
                    for t in 0..shared.triangle_count() as u32 {
                        let corners = shared.triangle(t).map(|c| back * (c - position));
                        let m = collide_triangle(&shape, corners, 0.05);
                        if m.count > 0 {
                            println!(
                                "{t} {:?} {:?} n {} {:?}",
                                shared.edges(t),
                                corners,
                                rotation * m.normal,
                                m.points()
                            );
                        }
                    }
                }
                assert!((deepest - least).abs() < 0.004, "{:?} {least} {deepest} {found:?}", shape.kind);
            }
        }
        assert!(seen > 200, "{seen}");
    }
}
