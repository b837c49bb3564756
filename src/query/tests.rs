//! Queries against slow oracles: all shapes one by one, dense samples, and GJK where the code under test
//! doesn't use it.

use super::advance::overlaps;
use super::candidates::Candidate;
use super::closest_shape::nearest;
use super::penetration::depth;
use super::*;
use crate::math::Quat;
use crate::narrow_phase::fixtures::{CONVEX, collider, depth as inside_by, gap_along};
use crate::narrow_phase::{Accuracy, Relative, Simplex, Support, SupportPose, core_gap, distance};
use crate::random::Random;
use crate::shape::{Collider, Geometry, HeightField, TriangleMesh};
use crate::{BodyDesc, Settings, ShapeDesc, World};
use glam::{DMat3, DVec3, Vec2, Vec3};
use std::sync::Arc;

const fn many(count: usize) -> usize {
    if cfg!(miri) { 5 } else { count }
}

fn bumpy_mesh(random: &mut Random, cells: usize, size: f32) -> Geometry {
    let n = cells + 1;
    let vertices = (0..n * n)
        .map(|i| Vec3::new((i % n) as f32, random.range(0.0, 1.0), (i / n) as f32) * (size / cells as f32))
        .collect();
    let triangles = (0..cells * cells)
        .flat_map(|i| {
            let c = (i / cells * n + i % cells) as u32;
            let n = n as u32;
            [[c, c + n, c + 1], [c + 1, c + n, c + n + 1]]
        })
        .collect();
    Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles).unwrap()))
}

fn field(random: &mut Random, samples: usize, cell: f32) -> Geometry {
    let heights = (0..samples * samples).map(|_| random.range(-0.5, 0.5) * cell).collect();
    Geometry::HeightField(Arc::new(HeightField::new(samples, samples, Vec2::splat(cell), heights).unwrap()))
}

/// Bodies of all kinds and shapes about a place, with compounds, a mesh, a field and two planes.
pub(super) fn world(random: &mut Random, centre: DVec3, count: usize) -> World {
    let mut world = World::new(Settings::default()).unwrap();
    let mesh = bumpy_mesh(random, 20, 20.0);
    let field = field(random, 20, 1.0);
    for i in 0..count {
        let mut desc = match i % 4 {
            0 => BodyDesc::dynamic(),
            1 => BodyDesc::kinematic(),
            _ => BodyDesc::fixed(),
        };
        desc = desc
            .with_position(centre + random.cube().as_dvec3() * 15.0)
            .with_rotation(random.rotation_or_aligned());
        for _ in 0..1 + random.below(3) {
            let kind = CONVEX[random.below(5)];
            let mut shape = ShapeDesc::new(random.shape(kind, 1.0).geometry);
            shape.position = random.cube();
            shape.rotation = random.turn().into();
            desc = desc.with_shape(shape);
        }
        world.add_body(&desc).unwrap();
    }
    for (geometry, down) in [(mesh, 10.0), (field, 12.0), (Geometry::Plane, 14.0)] {
        let at = centre + DVec3::new(-10.0, -down, -10.0);
        let shape = ShapeDesc::new(geometry);
        world.add_body(&BodyDesc::fixed().with_position(at).with_shape(shape)).unwrap();
    }
    let tilted = BodyDesc::kinematic()
        .with_position(centre + DVec3::X * 17.0)
        .with_rotation(Quat::from_rotation_z(1.8));
    world.add_body(&tilted.with_shape(ShapeDesc::new(Geometry::Plane))).unwrap();
    world
}

impl World {
    fn every(&self) -> impl Iterator<Item = Candidate<'_>> {
        let there = |&i: &u32| self.colliders.all[i as usize].body != u32::MAX;
        (0..self.colliders.all.len() as u32).filter(there).map(|i| self.candidate(i))
    }
}

/// Shapes that the trees leave out would not have been hit, before and after steps and changes, near and far.
#[test]
fn trees_find_what_all_shapes_one_by_one_do() {
    let mut random = Random(17);
    for centre in [DVec3::ZERO, DVec3::new(1e6 + 0.1, -1e6, 3e5)] {
        let mut world = world(&mut random, centre, many(150));
        for round in 0..4 {
            check_all(&mut random, &world, centre, many(400));
            match round {
                0 => {
                    world.step(1.0 / 60.0).unwrap();
                }
                1 => {
                    // By hand, all sorts of changes.
                    let bodies: Vec<_> = world.bodies().collect();
                    for (i, &body) in bodies.iter().enumerate().step_by(3) {
                        match i % 4 {
                            0 => world.remove_body(body).unwrap(),
                            _ => {
                                let to = centre + random.cube().as_dvec3() * 15.0;
                                world.set_pose(body, to, random.turn().into()).unwrap();
                            }
                        }
                    }
                    for i in 0..20 {
                        let shape = ShapeDesc::new(random.shape(CONVEX[i % 5], 1.0).geometry);
                        let desc = if i % 2 == 0 { BodyDesc::fixed() } else { BodyDesc::dynamic() };
                        let at = centre + random.cube().as_dvec3() * 15.0;
                        let body = world.add_body(&desc.with_position(at).with_shape(shape)).unwrap();
                        if i % 5 == 0 {
                            let mut shape = ShapeDesc::new(Geometry::Sphere { radius: 0.5 });
                            shape.position = Vec3::X * 3.0;
                            world.add_shape(body, &shape).unwrap();
                        }
                    }
                }
                _ => (0..20).for_each(|_| {
                    world.step(1.0 / 60.0).unwrap();
                }),
            }
        }
    }
}

fn check_all(random: &mut Random, world: &World, centre: DVec3, count: usize) {
    let filter = QueryFilter::new();
    let (mut hits, mut touches, mut near, mut all) = (0, 0, 0, Vec::new());
    let (mut touched, mut overlapped, mut closest) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..count {
        let from = centre + random.cube().as_dvec3() * 20.0;
        let path = if i % 7 == 0 { Vec3::NEG_Y * 30.0 } else { random.cube() * random.range(0.0, 30.0) };
        let ray = Ray::new(from, path);
        let mut expected: Vec<RayHit> = world
            .every()
            .filter_map(|c| ray_shape::meet(&c, &ray, 1.0, false).map(|met| world.ray_hit(&ray, &c, &met)))
            .collect();
        expected.sort_by(|a, b| (a.fraction, a.shape).partial_cmp(&(b.fraction, b.shape)).unwrap());
        world.cast_ray_all(&ray, &filter, &mut all).unwrap();
        assert_eq!(all, expected, "{ray:?}");
        assert_eq!(world.cast_ray(&ray, &filter).unwrap(), expected.first().copied());
        assert_eq!(world.cast_ray_any(&ray, &filter).unwrap(), !expected.is_empty());
        hits += usize::from(!expected.is_empty());

        let mut points: Vec<(f32, crate::ShapeHandle)> = world
            .every()
            .filter_map(|c| {
                nearest(c.shape, c.local(from), 5.0).map(|n| (n.distance as f32, world.shape_handle(c.index)))
            })
            .collect();
        points.sort_by(|a, b| a.partial_cmp(b).unwrap());
        world.closest_point_all(from, 5.0, &filter, &mut closest).unwrap();
        assert_eq!(closest.iter().map(|c| (c.distance, c.shape)).collect::<Vec<_>>(), points);
        assert_eq!(world.closest_point(from, 5.0, &filter).unwrap(), closest.first().copied());
        assert_eq!(world.closest_point_any(from, 5.0, &filter).unwrap(), !closest.is_empty());
        near += usize::from(!points.is_empty());

        if i % 4 > 0 {
            continue;
        }
        let geometry = random.shape(CONVEX[i / 4 % 5], 1.0).geometry;
        let cast = ShapeCast::new(&geometry, from, path).with_rotation(random.rotation_or_aligned());
        world.cast_shape_all(&cast, &filter, &mut touched).unwrap();
        assert_eq!(world.cast_shape(&cast, &filter).unwrap(), touched.first().copied(), "{cast:?}");
        assert_eq!(world.cast_shape_any(&cast, &filter).unwrap(), !touched.is_empty());
        touches += usize::from(!touched.is_empty());
        // One by one, with all others out of sight.
        for candidate in world.every() {
            let handle = world.shape_handle(candidate.index);
            let only = |_: crate::BodyHandle, shape: crate::ShapeHandle| shape == handle;
            let one = world.cast_shape(&cast, &QueryFilter::new().with_predicate(&only)).unwrap();
            assert_eq!(touched.iter().find(|t| t.shape == handle).copied(), one, "{cast:?}");
        }
        world.overlap(&geometry, from, cast.rotation, &filter, &mut overlapped).unwrap();
        let still = ShapeCast { path: Vec3::ZERO, ..cast };
        world.cast_shape_all(&still, &filter, &mut touched).unwrap();
        let mut at_once: Vec<Overlap> =
            touched.iter().map(|t| Overlap { body: t.body, shape: t.shape }).collect();
        at_once.sort_unstable_by_key(|o| o.shape);
        assert_eq!(overlapped, at_once, "{still:?}");
        assert_eq!(world.overlap_any(&geometry, from, cast.rotation, &filter).unwrap(), !at_once.is_empty());
    }
    if !cfg!(miri) {
        assert!(hits > count / 3 && touches > count / 10 && near > count / 2, "{hits} {touches} {near}");
    }
}

/// The gap of a moving shape and another at a fraction of the path, by GJK; zero if they overlap.
fn gap_at(a: &Collider, b: &Collider, pose: (Vec3, Quat), path: Vec3, fraction: f64) -> f64 {
    let position = (pose.0.as_dvec3() - path.as_dvec3() * fraction).as_vec3();
    let found = distance(
        &a.geometry.support().unwrap(),
        &b.geometry.support().unwrap(),
        &Relative { position, rotation: pose.1 },
        Vec3::ZERO,
    );
    if found.overlap { 0.0 } else { f64::from(found.distance).max(0.0) }
}

#[test]
fn moving_shapes_touch_where_dense_samples_do() {
    let mut random = Random(23);
    let (mut hits, mut misses, mut inside) = (0, 0, 0);
    for i in 0..many(4000) {
        let (a, b) = (random.shape(CONVEX[i % 5], 1.0), random.shape(CONVEX[i / 5 % 5], 1.0));
        let (position, rotation) =
            (random.direction() * random.range(0.0, 6.0), random.rotation_or_aligned());
        let path = (position + random.cube() * 1.5) * random.range(0.5, 1.5);
        let mut world = World::new(Settings::default()).unwrap();
        let shape = ShapeDesc::new(b.geometry.clone());
        let desc = BodyDesc::fixed().with_position(position).with_rotation(rotation).with_shape(shape);
        world.add_body(&desc).unwrap();
        let cast = ShapeCast::new(&a.geometry, DVec3::ZERO, path);
        let hit = world.cast_shape(&cast, &QueryFilter::new()).unwrap();
        let gap = |t: f64| gap_at(&a, &b, (position, rotation), path, t);
        let end = hit.map_or(1.0, |h| f64::from(h.fraction));
        let (tolerance, scale) = (6e-6, f64::from(a.radius + b.radius));
        if gap(0.0) <= 0.0 {
            inside += 1;
            let hit = hit.unwrap();
            assert!(hit.fraction == 0.0 && hit.depth >= 0.0 && hit.normal.is_normalized());
            continue;
        }
        for k in 0..100 {
            let t = end * f64::from(k) / 100.0;
            assert!(gap(t) > 0.0, "{a:?} {b:?} {position} {rotation:?} {path}: inside at {t} of {end}");
        }
        let Some(hit) = hit else {
            misses += 1;
            continue;
        };
        hits += 1;
        assert!(gap(end) <= tolerance + 1e-6 * scale, "{a:?} {b:?} {hit:?} {}", gap(end));
        assert!(hit.normal.is_normalized() && hit.normal.dot(path) < 1e-3 * path.length());
        let on = b.clone();
        let local = rotation.as_dquat().normalize().conjugate() * (hit.point - position.as_dvec3());
        assert!(inside_by(&on, local).abs() < 1e-3 * scale, "{hit:?} {} {b:?}", inside_by(&on, local));
    }
    println!("{hits} hits, {misses} misses, {inside} inside");
    assert!(cfg!(miri) || (hits > 500 && misses > 500 && inside > 200));
}

/// Moved out by the depth they only touch; and no sampled direction gets them out sooner.
#[test]
fn the_way_out_of_an_overlap_is_the_shortest() {
    let mut random = Random(29);
    let (mut deep, mut worst) = (0, 0.0f64);
    for i in 0..many(4000) {
        let (a, b) = (random.shape(CONVEX[i % 5], 1.0), random.shape(CONVEX[i / 5 % 5], 1.0));
        let rotation = random.rotation_or_aligned();
        let position = random.direction() * random.range(0.0, 0.6);
        let (sa, sb) = (a.geometry.support().unwrap(), b.geometry.support().unwrap());
        let turn = rotation.as_dquat().normalize();
        let pose = SupportPose { rotation: DMat3::from_quat(turn), position: position.as_dvec3() };
        let gap = core_gap(
            &sa,
            &sb,
            &pose,
            pose.position,
            &mut Simplex::empty(),
            Accuracy { absolute: 1e-9, relative: 1e-6 },
        );
        if !gap.overlap && gap.upper > sa.radius + sb.radius {
            continue;
        }
        deep += 1;
        let found = depth(&sa, &sb, &pose, &gap);
        let scale = f64::from(a.radius + b.radius);
        assert!((found.normal.length() - 1.0).abs() < 1e-9 && found.depth >= 0.0);
        let by_definition = -gap_along(&a, &b, turn, pose.position, found.normal);
        assert!((by_definition - found.depth).abs() < 2e-6 * scale, "{by_definition} {found:?} {a:?} {b:?}");
        for _ in 0..300 {
            let n = random.direction().as_dvec3().normalize();
            let other = -gap_along(&a, &b, turn, pose.position, n);
            worst = worst.max((found.depth - other) / scale);
            assert!(found.depth <= other + 3e-3 * scale, "{} {other} {a:?} {b:?} {pose:?}", found.depth);
        }
        let out =
            SupportPose { position: pose.position + found.normal * (found.depth + 1e-5 * scale), ..pose };
        assert!(!overlaps(&sa, &sb, &out, found.normal));
    }
    println!("{deep} overlaps, {worst:e} too deep at most");
    assert!(cfg!(miri) || deep > 1000);
}

#[test]
fn nearest_points_are_on_the_surface_and_none_is_nearer() {
    let mut random = Random(31);
    let (mut outside, mut inside) = (0, 0);
    for i in 0..many(20_000) {
        let size = random.log_range(1e-2, 100.0);
        let shape = random.shape(CONVEX[i % 5], size);
        let scale = f64::from(shape.radius);
        let at = random.direction().as_dvec3() * scale * f64::from(random.range(0.0, 3.0));
        let found = nearest(&shape, at, f64::INFINITY).unwrap();
        let deep = inside_by(&shape, at);
        assert_eq!(found.inside, shape.geometry.contains(at));
        if found.inside {
            inside += 1;
            assert!(deep > -1e-5 * scale && found.distance == 0.0, "{shape:?} {at}");
            continue;
        }
        outside += 1;
        assert!(deep < 1e-5 * scale, "{shape:?} {at} {deep}");
        assert!(inside_by(&shape, found.point).abs() < 1e-5 * scale, "{shape:?} {at} {found:?}");
        assert!(((at - found.point).length() - found.distance).abs() < 1e-9 * scale);
        assert!((found.point + found.normal * found.distance - at).length() < 1e-9 * scale);
        // Nothing of a convex shape is beyond the plane through its nearest point.
        let gap = gap_along(
            &collider(Geometry::Sphere { radius: 1e-30 }),
            &shape,
            glam::DQuat::IDENTITY,
            -at,
            -found.normal,
        );
        assert!((gap - found.distance).abs() < 2e-6 * scale, "{shape:?} {at} {found:?} {gap}");
    }
    assert!(cfg!(miri) || (outside > 5000 && inside > 1000), "{outside} {inside}");
}

/// Meshes and fields: nothing that a search of all triangles finds is missed.
#[test]
fn triangles_are_found_as_if_all_were_asked() {
    let mut random = Random(37);
    for geometry in [bumpy_mesh(&mut random, 15, 15.0), field(&mut random, 16, 1.0)] {
        let count = match &geometry {
            Geometry::Mesh(mesh) => mesh.triangle_count(),
            Geometry::HeightField(field) => field.triangle_count(),
            _ => 0,
        };
        let corners = |i: u32| geometry.ground().unwrap().triangle(i);
        let shape = collider(geometry.clone());
        let mut world = World::new(Settings::default()).unwrap();
        world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(geometry.clone()))).unwrap();
        let all = QueryFilter::new();
        let (mut hits, mut overlapped) = (0, 0);
        for i in 0..many(600) {
            let at = Vec3::new(7.5, 0.0, 7.5) + random.cube() * Vec3::new(10.0, 3.0, 10.0);
            let by_all = (0..count as u32)
                .map(|t| (crate::narrow_phase::from_triangle(at, corners(t)).length_squared(), t))
                .min_by(|a, b| a.partial_cmp(b).unwrap())
                .unwrap();
            let found = nearest(&shape, at.as_dvec3(), 100.0).unwrap();
            assert_eq!((found.distance, found.triangle), (by_all.0.sqrt(), Some(by_all.1)));

            // Moving shapes: no overlap with any triangle on the way, a touch at the end.
            let probe = random.shape(CONVEX[i % 5], 0.7);
            let support = probe.geometry.support().unwrap();
            let rotation = random.rotation_or_aligned();
            let path = random.cube() * Vec3::new(6.0, 6.0, 6.0);
            let cast = ShapeCast::new(&probe.geometry, at, path).with_rotation(rotation);
            let turn = DMat3::from_quat(rotation.as_dquat().normalize());
            let overlaps_at = |at: DVec3| {
                let pose = SupportPose { rotation: turn.transpose(), position: turn.transpose() * -at };
                (0..count as u32)
                    .any(|t| overlaps(&support, &Support::triangle(corners(t)), &pose, DVec3::ZERO))
            };
            let overlap = world.overlap_any(&probe.geometry, at.as_dvec3(), rotation.into(), &all).unwrap();
            assert_eq!(overlap, overlaps_at(at.as_dvec3()));
            overlapped += usize::from(overlap);
            let hit = world.cast_shape(&cast, &all).unwrap();
            if overlap {
                assert_eq!(hit.unwrap().fraction, 0.0);
                continue;
            }
            let end = hit.map_or(1.0, |h| f64::from(h.fraction));
            for k in 0..12 {
                let at = at.as_dvec3() + path.as_dvec3() * (end * f64::from(k) / 11.0);
                assert!(!overlaps_at(at), "{cast:?} {hit:?}");
            }
            if let Some(hit) = hit {
                hits += 1;
                let further = cast.position_at(hit.fraction) + -hit.normal.as_dvec3() * 1e-4;
                assert!(overlaps_at(further), "{cast:?} {hit:?}");
            }
        }
        assert!(cfg!(miri) || (hits > 60 && overlapped > 60), "{hits} {overlapped}");
    }
}
