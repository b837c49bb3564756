use super::*;
use crate::math::Quat;
use crate::narrow_phase::convex::testing;
use crate::narrow_phase::fixtures::CONVEX;
use crate::random::Random;
use crate::shape::mesh::testing::{bumpy, cuboid, grid, terrain};
use crate::shape::{HeightField, Kind, TriangleMesh};
use glam::Vec2;
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
    let rel = Relative { position, rotation }.inverse();
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
    let mut random = Random(3);
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
    let fields = [(mesh(grid(16, 0.25, |_, _| 0.0)), Vec3::ZERO), (flat_field(), Vec3::new(2.0, 0.0, 2.0))];
    for shape in shapes() {
        for (ground, middle) in &fields {
            for i in 0..400 {
                let rotation = match i % 4 {
                    0 => Quat::IDENTITY,
                    1 => Quat::from_rotation_y(random.range(-3.0, 3.0)),
                    2 => Quat::from_rotation_x(std::f32::consts::FRAC_PI_2),
                    _ => random.turn(),
                };
                let plane = testing::extent(&shape, (rotation.conjugate() * Vec3::NEG_Y).as_dvec3()) as f32;
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

/// A rod of 1 m by 2 cm, halfway through a floor of two triangles a cell, wherever it crosses: one of them
/// pushes it to where its centre is. The part of the rod over the other triangle may be left out.
#[test]
fn a_rod_that_is_stuck_halfway_close_to_an_edge_is_pushed_back() {
    let floor = mesh(grid(4, 10.0, |_, _| 0.0));
    let rods = [Geometry::cuboid(0.01, 0.5, 0.01), Geometry::capsule(0.49, 0.01)];
    let mut random = Random(12);
    for i in 0..2000 {
        let rod = testing::collider(rods[i % 2].clone());
        let rotation =
            Quat::from_rotation_z(random.range(0.0, 1.2)) * Quat::from_rotation_y(random.range(-3.0, 3.0));
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
        (found[0].normal - Vec3::NEG_Y).length() < 1e-5 || (found[1].normal - Vec3::NEG_Y).length() < 1e-5
    );
    let wall = Vec3::new(4.0, -1.0, 0.0).normalize();
    assert!(found.iter().any(|m| (m.normal - wall).length() < 1e-5), "{found:?}");
}

#[test]
fn a_triangle_pushes_back_to_the_side_that_the_centre_is_on() {
    let mut random = Random(5);
    let corners = vec![Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 0.0, -3.0), Vec3::new(0.0, 0.0, 3.0)];
    let (triangle, margin) = (mesh((corners, vec![[0, 1, 2]])), 0.05);
    // All whose centre is their origin.
    for kind in CONVEX.into_iter().filter(|&kind| kind != Kind::Hull) {
        for _ in 0..200 {
            let one = testing::shape(&mut random, kind);
            let rotation = random.turn();
            // The centre is above the triangle, by up to the size of the shape.
            let height = 0.02 + random.unit();
            let down = (rotation.conjugate() * Vec3::NEG_Y).as_dvec3();
            let lowest = height - testing::extent(&one, down) as f32;
            let found = collide(&one, &triangle, Vec3::Y * height, rotation, margin);
            assert_eq!(found.is_empty(), lowest > margin, "{kind:?} lowest {lowest}");
            for manifold in &found {
                let normal = manifold.normal;
                assert!(normal.y < 1e-3, "{kind:?} pushes through: {normal}");
                if lowest > -0.02 {
                    assert!(normal.y < -0.999, "{kind:?} {normal}, lowest {lowest}");
                    assert!((manifold.least() - lowest).abs() < 2e-3, "{kind:?} {manifold:?} {lowest}");
                }
            }
        }
    }
}

#[test]
fn a_shape_stuck_halfway_is_pushed_to_its_centres_side() {
    let ground = mesh(grid(16, 0.25, |_, _| 0.0));
    let mut random = Random(2);
    for shape in shapes() {
        for i in 0..100 {
            let rotation = if i % 2 == 0 { Quat::IDENTITY } else { random.turn() };
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

/// The centre of mass of a tapered cylinder is nearer to its wide end than its origin is. The guard keeps the
/// former above the ground, so that tells which way is out, even if the origin is below.
#[test]
fn a_shape_is_pushed_to_the_side_of_its_centre_of_mass() {
    let ground = mesh(grid(16, 0.25, |_, _| 0.0));
    let cone = Geometry::Cylinder { half_height: 0.4, radius_bottom: 0.3, radius_top: 0.1 };
    // Centre of mass of a frustum: h (R² + 2 R r + 3 r²) / (4 (R² + R r + r²)) above its base, h = 0.8,
    // R = 0.3, r = 0.1.
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

/// A plate that has sunk into a roof, its centre over one slope and above it, is below the plane in which the
/// other slope goes on: a shape that overlaps that one must not be pushed further in.
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
            let rotation = random.turn();
            let (x, z) = (random.range(-8.0, 8.0), random.range(-8.0, 8.0));
            let position = Vec3::new(x, bumpy(x, z) + random.range(0.1, 0.6), z);
            // By GJK, unless more than radii overlap.
            let at = Relative { position, rotation }.inverse();
            let own = shape.geometry.support().unwrap();
            let apart = (0..shared.triangle_count() as u32).map(|t| shared.triangle(t));
            let mut apart =
                apart.filter(|t| t.iter().any(|c| (*c - position).length() <= shape.radius + 1.0));
            let least = apart.try_fold(f32::MAX, |least, corners| {
                let gap = distance(&own, &Support::triangle(corners), &at, Vec3::ZERO);
                (!gap.overlap).then_some(least.min(gap.distance))
            });
            let Some(least) = least.filter(|least| (-0.005..=0.04).contains(least)) else { continue };
            seen += 1;
            let found = collide(&shape, &collider, position, rotation, 0.05);
            let deepest = found.iter().map(RawManifold::least).fold(f32::MAX, f32::min);
            assert!((deepest - least).abs() < 0.004, "{:?} {least} {deepest} {found:?}", shape.kind);
        }
    }
    assert!(seen > 200, "{seen}");
}
