//! What queries promise: exact answers on every shape, filters, the world as it is now, far from the origin as near it,
//! clear errors, any thread, any order. `src/query/tests.rs` checks them against all shapes one by one and against dense
//! samples; here another library has its say as well.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]
use crate::common;
use crate::common::random::Random;

use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::{
    BodyDesc, BodyHandle, ClosestPoint, ConvexHull, Error, Filter, Geometry, HeightField, Overlap,
    QueryFilter, Ray, RayHit, Settings, ShapeCast, ShapeDesc, ShapeHandle, ShapeHit, TriangleMesh, World,
};
use std::sync::Arc;

const ALL: fn() -> QueryFilter<'static> = QueryFilter::new;

fn world() -> World {
    World::new(Settings::default()).unwrap()
}

fn add(world: &mut World, desc: BodyDesc, geometry: Geometry) -> BodyHandle {
    world.add_body(&desc.with_shape(ShapeDesc::new(geometry))).unwrap()
}

fn alone(geometry: Geometry) -> World {
    let mut world = world();
    add(&mut world, BodyDesc::fixed(), geometry);
    world
}

fn ball(radius: f32) -> Geometry {
    Geometry::Sphere { radius }
}

fn cube_hull() -> Geometry {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0;
    Geometry::Hull(Arc::new(ConvexHull::new(&(0..8).map(corner).collect::<Vec<_>>()).unwrap()))
}

fn flat_field() -> Geometry {
    Geometry::HeightField(Arc::new(HeightField::new(9, 9, Vec2::ONE, vec![0.0; 81]).unwrap()))
}

fn ray(from: [f64; 3], path: [f32; 3]) -> Ray {
    Ray::new(DVec3::from(from), Vec3::from(path))
}

fn first(world: &World, ray: Ray) -> Option<RayHit> {
    let hit = world.cast_ray(&ray, &ALL()).unwrap();
    assert_eq!(world.cast_ray_any(&ray, &ALL()).unwrap(), hit.is_some());
    let mut all = Vec::new();
    world.cast_ray_all(&ray, &ALL(), &mut all).unwrap();
    assert_eq!(all.first(), hit.as_ref());
    hit
}

#[track_caller]
fn meets(geometry: Geometry, from: [f64; 3], path: [f32; 3], fraction: f32, normal: [f32; 3]) {
    let ray = ray(from, path);
    let hit = first(&alone(geometry), ray).unwrap();
    assert!((hit.fraction - fraction).abs() < 1e-6, "{hit:?}");
    assert!((hit.normal - Vec3::from(normal)).length() < 1e-5, "{hit:?}");
    assert!((hit.point - ray.at(fraction)).length() < 1e-5 && !hit.inside, "{hit:?}");
}

#[test]
fn a_ray_meets_each_shape_where_geometry_says() {
    let down = [0.0, -10.0, 0.0];
    let (up, right) = ([0.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
    meets(ball(1.0), [0.0, 5.0, 0.0], down, 0.4, up);
    meets(ball(1.0), [5.0, 0.6, 0.0], [-5.0, 0.0, 0.0], (5.0 - 0.8) / 5.0, [0.8, 0.6, 0.0]);
    meets(Geometry::capsule(1.0, 0.5), [0.0, 5.0, 0.0], down, 0.35, up);
    meets(Geometry::capsule(1.0, 0.5), [5.0, 0.7, 0.0], [-10.0, 0.0, 0.0], 0.45, right);
    meets(Geometry::cuboid(1.0, 2.0, 3.0), [0.5, 5.0, 2.9], down, 0.3, up);
    meets(Geometry::cuboid(1.0, 2.0, 3.0), [5.0, 1.9, 0.0], [-10.0, 0.0, 0.0], 0.4, right);
    meets(Geometry::cylinder(1.0, 0.5), [0.4, 5.0, 0.0], down, 0.4, up);
    meets(Geometry::cylinder(1.0, 0.5), [5.0, 0.7, 0.0], [-10.0, 0.0, 0.0], 0.45, right);
    // Halfway up a cone of height 2 and radius 1 its radius is 0.5; it leans by an angle of tangent 1/2.
    let cone = Geometry::Cylinder { half_height: 1.0, radius_bottom: 1.0, radius_top: 0.0 };
    let lean = Vec3::new(2.0, 1.0, 0.0).normalize();
    meets(cone, [5.0, 0.0, 0.0], [-10.0, 0.0, 0.0], 0.45, lean.to_array());
    meets(cube_hull(), [0.3, 5.0, 0.2], down, 0.4, up);
    meets(Geometry::Plane, [3.0, 5.0, 2.0], [1.0, -20.0, 0.0], 0.25, up);
    meets(common::flat_mesh(4, 1.0), [0.3, 5.0, 0.2], down, 0.5, up);
    meets(flat_field(), [0.3, 5.0, 0.2], down, 0.5, up);
    // Of triangles both sides, facing whoever comes.
    meets(common::flat_mesh(4, 1.0), [0.3, -5.0, 0.2], [0.0, 10.0, 0.0], 0.5, [0.0, -1.0, 0.0]);
    meets(flat_field(), [0.3, -5.0, 0.2], [0.0, 10.0, 0.0], 0.5, [0.0, -1.0, 0.0]);
}

#[test]
fn a_ray_names_the_triangle_and_the_triangle_its_corners() {
    for geometry in [common::flat_mesh(4, 1.0), flat_field()] {
        let hit = first(&alone(geometry.clone()), ray([0.3, 5.0, 0.2], [0.0, -10.0, 0.0])).unwrap();
        let corners = match &geometry {
            Geometry::Mesh(mesh) => mesh.corners(hit.triangle.unwrap()),
            Geometry::HeightField(field) => field.corners(hit.triangle.unwrap()),
            _ => None,
        }
        .unwrap();
        let at = hit.point.as_vec3();
        let edge = |i: usize| (corners[(i + 1) % 3] - corners[i]).cross(at - corners[i]).y;
        assert!(edge(0) >= 0.0 && edge(1) >= 0.0 && edge(2) >= 0.0, "{corners:?} {at}");
        if let Geometry::Mesh(mesh) = &geometry {
            assert_eq!(mesh.corners(mesh.triangle_count() as u32), None);
        }
    }
}

#[test]
fn a_ray_that_starts_inside_says_so_or_passes() {
    let solid = [
        ball(1.0),
        Geometry::capsule(1.0, 0.5),
        Geometry::cuboid(1.0, 1.0, 1.0),
        Geometry::cylinder(1.0, 0.5),
        cube_hull(),
        Geometry::Plane,
    ];
    for geometry in solid {
        let world = alone(geometry.clone());
        let from = DVec3::new(0.1, -0.2, 0.1);
        for path in [Vec3::Y * 5.0, Vec3::NEG_X * 0.1, Vec3::ZERO] {
            let ray = Ray::new(from, path);
            let hit = first(&world, ray).unwrap();
            let expected = (0.0, from, Vec3::ZERO, true);
            assert_eq!((hit.fraction, hit.point, hit.normal, hit.inside), expected, "{geometry:?}");
            assert_eq!(world.cast_ray(&ray, &ALL().skipping_inside()).unwrap(), None);
        }
    }
    // On the surface: in is a hit, out is none, and neither is inside.
    let world = alone(Geometry::cuboid(1.0, 1.0, 1.0));
    let hit = first(&world, ray([0.0, 1.0, 0.0], [0.0, -1.0, 0.0])).unwrap();
    assert_eq!((hit.fraction, hit.normal, hit.inside), (0.0, Vec3::Y, false));
    assert_eq!(first(&world, ray([0.0, 1.0, 0.0], [0.0, 1.0, 0.0])), None);
    // Short of it, and just as far.
    assert_eq!(first(&world, ray([0.0, 3.0, 0.0], [0.0, -1.99, 0.0])), None);
    assert_eq!(first(&world, ray([0.0, 3.0, 0.0], [0.0, -2.0, 0.0])).unwrap().fraction, 1.0);
    // Meshes are hollow.
    assert_eq!(first(&alone(common::flat_mesh(4, 1.0)), ray([0.3, 0.0, 0.2], [0.0, 0.0, 0.0])), None);
}

fn touch(world: &World, cast: ShapeCast<'_>) -> Option<ShapeHit> {
    let hit = world.cast_shape(&cast, &ALL()).unwrap();
    assert_eq!(world.cast_shape_any(&cast, &ALL()).unwrap(), hit.is_some());
    let mut all = Vec::new();
    world.cast_shape_all(&cast, &ALL(), &mut all).unwrap();
    assert_eq!(all.first(), hit.as_ref());
    hit
}

#[test]
fn a_moving_shape_touches_every_floor_where_geometry_says() {
    let floors = [
        Geometry::cuboid(4.0, 1.0, 4.0),
        Geometry::Plane,
        common::flat_mesh(4, 1.0),
        flat_field(),
        Geometry::Hull(match cube_hull() {
            Geometry::Hull(hull) => hull,
            _ => unreachable!(),
        }),
    ];
    let shapes = [
        (ball(0.5), 0.5),
        (Geometry::capsule(1.0, 0.5), 1.5),
        (Geometry::cuboid(0.5, 0.7, 0.5), 0.7),
        (Geometry::cylinder(0.6, 0.5), 0.6),
        (cube_hull(), 1.0),
    ];
    for floor in floors {
        let top = if matches!(floor, Geometry::Box { .. } | Geometry::Hull(_)) { 1.0 } else { 0.0 };
        let world = alone(floor.clone());
        for (shape, below) in &shapes {
            let cast = ShapeCast::new(shape, DVec3::new(0.3, 11.0, 0.2), Vec3::NEG_Y * 20.0);
            let hit = touch(&world, cast).unwrap();
            let gap = cast.at(hit.fraction).y - below - top;
            assert!((0.0..1e-5).contains(&gap), "{} {shape:?} {hit:?} {gap}", floor.kind_name());
            assert!((hit.normal - Vec3::Y).length() < 1e-3 && hit.depth == 0.0, "{hit:?}");
            assert!((hit.point.y - top).abs() < 1e-4, "{} {shape:?} {hit:?}", floor.kind_name());
            // Short of it.
            let short = ShapeCast { path: Vec3::NEG_Y * (10.99 - (below + top) as f32), ..cast };
            assert_eq!(touch(&world, short), None);
            // Where it touched it overlaps nothing; 1 mm further it does.
            let place = |at: DVec3| world.overlap_any(shape, at, Quat::IDENTITY, &ALL()).unwrap();
            assert!(!place(cast.at(hit.fraction)));
            assert!(place(cast.at(hit.fraction) - DVec3::Y * 1e-3));
        }
    }
}

#[test]
fn a_shape_that_overlaps_at_the_start_is_told_the_way_out() {
    let floors = [Geometry::Plane, Geometry::cuboid(9.0, 2.0, 9.0), common::flat_mesh(4, 1.0), flat_field()];
    for floor in floors {
        let deep = match floor {
            Geometry::Box { .. } => 2.0,
            _ => 0.0,
        };
        let mut world = world();
        add(&mut world, BodyDesc::fixed().at(Vec3::NEG_Y * deep), floor.clone());
        for shape in [ball(0.5), Geometry::capsule(0.1, 0.4), Geometry::cuboid(0.5, 0.5, 0.5), cube_hull()] {
            let below = if matches!(shape, Geometry::Hull(_)) { 1.0 } else { 0.5 };
            let at = DVec3::new(3.3, below - 0.1, 3.2);
            for path in [Vec3::ZERO, Vec3::Y * 3.0, Vec3::X, Vec3::NEG_Y] {
                let cast = ShapeCast::new(&shape, at, path);
                let hit = touch(&world, cast).unwrap();
                assert!(
                    hit.fraction == 0.0 && (hit.depth - 0.1).abs() < 1e-4,
                    "{} {shape:?} {hit:?}",
                    floor.kind_name()
                );
                assert!((hit.normal - Vec3::Y).length() < 1e-3, "{} {shape:?} {hit:?}", floor.kind_name());
                // Sideways the next triangle is in the way.
                if path == Vec3::X && matches!(floor, Geometry::Mesh(_) | Geometry::HeightField(_)) {
                    continue;
                }
                // Out of it, or along it: not seen if so wished; further in: always.
                let seen = world.cast_shape(&cast, &ALL().skipping_inside()).unwrap();
                assert_eq!(
                    seen.is_some(),
                    path == Vec3::NEG_Y,
                    "{} {shape:?} {path} {seen:?}",
                    floor.kind_name()
                );
            }
        }
    }
}

#[test]
fn what_is_touched_at_the_start_only_stops_what_moves_into_it() {
    let world = alone(Geometry::cuboid(5.0, 1.0, 5.0));
    let feet = ball(0.5);
    let cast = |path: Vec3| touch(&world, ShapeCast::new(&feet, DVec3::Y * (1.5 + 1e-6), path));
    assert_eq!(cast(Vec3::X), None);
    assert_eq!(cast(Vec3::Y), None);
    assert_eq!(cast(Vec3::ZERO), None);
    let hit = cast(Vec3::NEG_Y).unwrap();
    assert!(hit.fraction == 0.0 && hit.depth == 0.0 && hit.normal == Vec3::Y);
    // Over a floor of triangles, whose edges stop nothing.
    for floor in [common::flat_mesh(4, 1.0), flat_field()] {
        let world = alone(floor);
        for shape in [ball(0.5), Geometry::capsule(0.1, 0.4), Geometry::cuboid(0.5, 0.5, 0.5)] {
            let path = Vec3::new(2.3, 0.0, 1.1);
            let slide = ShapeCast::new(&shape, DVec3::new(0.4, 0.5 + 2e-5, 0.3), path);
            assert_eq!(touch(&world, slide), None, "{shape:?}");
        }
    }
}

fn near(geometry: Geometry, at: [f64; 3]) -> Option<ClosestPoint> {
    let world = alone(geometry);
    let found = world.closest_point(DVec3::from(at), 10.0, &ALL()).unwrap();
    assert_eq!(world.closest_point_any(DVec3::from(at), 10.0, &ALL()).unwrap(), found.is_some());
    found
}

#[test]
fn the_nearest_point_of_each_shape_is_where_geometry_says() {
    let check = |geometry: Geometry, at: [f64; 3], point: [f64; 3]| {
        let found = near(geometry, at).unwrap();
        let (at, point) = (DVec3::from(at), DVec3::from(point));
        assert!((found.point - point).length() < 1e-6, "{found:?}");
        assert!((f64::from(found.distance) - (at - point).length()).abs() < 1e-6 && !found.inside);
        assert!((found.normal.as_dvec3() - (at - point).normalize()).length() < 1e-5, "{found:?}");
    };
    check(ball(1.0), [0.0, 3.0, 4.0], [0.0, 0.6, 0.8]);
    check(Geometry::capsule(1.0, 0.5), [3.0, 0.5, 0.0], [0.5, 0.5, 0.0]);
    check(Geometry::capsule(1.0, 0.5), [0.0, 3.0, 0.0], [0.0, 1.5, 0.0]);
    check(Geometry::cuboid(1.0, 2.0, 3.0), [2.0, 1.0, 1.0], [1.0, 1.0, 1.0]);
    check(Geometry::cuboid(1.0, 2.0, 3.0), [2.0, 3.0, 4.0], [1.0, 2.0, 3.0]);
    check(Geometry::cylinder(1.0, 0.5), [3.0, 0.5, 0.0], [0.5, 0.5, 0.0]);
    check(Geometry::cylinder(1.0, 0.5), [0.2, 4.0, 0.0], [0.2, 1.0, 0.0]);
    check(Geometry::cylinder(1.0, 0.5), [0.0, -4.0, 2.5], [0.0, -1.0, 0.5]);
    let cone = Geometry::Cylinder { half_height: 1.0, radius_bottom: 1.0, radius_top: 0.0 };
    check(cone.clone(), [0.0, 3.0, 0.0], [0.0, 1.0, 0.0]);
    // From the middle of the slope along its normal (2, 1).
    check(cone, [2.5, 1.0, 0.0], [0.5, 0.0, 0.0]);
    check(cube_hull(), [3.0, 0.3, 0.2], [1.0, 0.3, 0.2]);
    check(cube_hull(), [3.0, 2.0, 0.2], [1.0, 1.0, 0.2]);
    check(Geometry::Plane, [3.0, 2.0, 0.2], [3.0, 0.0, 0.2]);
    check(common::flat_mesh(4, 1.0), [1.3, 2.0, 0.2], [1.3, 0.0, 0.2]);
    check(common::flat_mesh(4, 1.0), [6.0, -2.0, 0.2], [4.0, 0.0, 0.2]);
    check(flat_field(), [1.3, 2.0, 0.2], [1.3, 0.0, 0.2]);
    for solid in [ball(1.0), Geometry::cuboid(1.0, 1.0, 1.0), cube_hull(), Geometry::Plane] {
        let found = near(solid, [0.1, -0.3, 0.2]).unwrap();
        let expected = (0.0, DVec3::new(0.1, -0.3, 0.2), Vec3::ZERO, true);
        assert_eq!((found.distance, found.point, found.normal, found.inside), expected);
    }
    // On the surface: its own normal.
    let on = near(Geometry::cuboid(1.0, 1.0, 1.0), [0.2, 1.0, 0.3]).unwrap();
    assert_eq!((on.distance, on.normal, on.inside), (0.0, Vec3::Y, false));
    assert_eq!(near(ball(1.0), [0.0, 11.001, 0.0]), None);
    assert!(near(ball(1.0), [0.0, 11.0, 0.0]).is_some());
}

#[test]
fn filters_leave_out_what_they_say() {
    let mut world = world();
    let down = ray([0.0, 100.0, 0.0], [0.0, -200.0, 0.0]);
    let slab = || Geometry::cuboid(1.0, 0.5, 1.0);
    let fixed = add(&mut world, BodyDesc::fixed().at(DVec3::Y * 10.0), slab());
    let kinematic = add(&mut world, BodyDesc::kinematic().at(DVec3::Y * 20.0), slab());
    let dynamic = add(&mut world, BodyDesc::dynamic().at(DVec3::Y * 30.0), slab());
    let mut red = ShapeDesc::new(slab());
    red.filter = Filter { category: 4, mask: 8, group: 0 };
    let red = world.add_body(&BodyDesc::dynamic().at(DVec3::Y * 40.0).with_shape(red)).unwrap();
    let order = |filter: &QueryFilter<'_>| {
        let (mut rays, mut casts, mut near, mut over) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        world.cast_ray_all(&down, filter, &mut rays).unwrap();
        let rays: Vec<BodyHandle> = rays.iter().map(|h| h.body).collect();
        assert_eq!(world.cast_ray(&down, filter).unwrap().map(|h| h.body), rays.first().copied());
        assert_eq!(world.cast_ray_any(&down, filter).unwrap(), !rays.is_empty());
        let drop = ball(0.2);
        world.cast_shape_all(&ShapeCast::new(&drop, down.from, down.path), filter, &mut casts).unwrap();
        assert_eq!(casts.iter().map(|h| h.body).collect::<Vec<_>>(), rays);
        world.closest_point_all(DVec3::Y * 100.0, 200.0, filter, &mut near).unwrap();
        assert_eq!(near.iter().map(|h| h.body).collect::<Vec<_>>(), rays);
        let pole = Geometry::cuboid(0.1, 100.0, 0.1);
        world.overlap(&pole, DVec3::ZERO, Quat::IDENTITY, filter, &mut over).unwrap();
        let mut sorted = rays.clone();
        sorted.sort_unstable();
        let mut bodies: Vec<BodyHandle> = over.iter().map(|o| o.body).collect();
        bodies.sort_unstable();
        assert_eq!(bodies, sorted);
        rays
    };
    assert_eq!(order(&ALL()), [red, dynamic, kinematic, fixed]);
    assert_eq!(order(&QueryFilter::only_static()), [fixed]);
    assert_eq!(order(&QueryFilter::only_dynamic()), [red, dynamic]);
    assert_eq!(order(&QueryFilter { dynamic: false, ..ALL() }), [kinematic, fixed]);
    assert_eq!(order(&ALL().without(red)), [dynamic, kinematic, fixed]);
    let shape = world.shapes(dynamic).unwrap().next().unwrap();
    assert_eq!(order(&ALL().without_shape(shape)), [red, kinematic, fixed]);
    let bullet = Filter { category: 1, ..Filter::default() };
    assert_eq!(order(&ALL().collides(bullet)), [dynamic, kinematic, fixed]);
    assert_eq!(order(&ALL().collides(Filter { category: 8, mask: 4, group: 0 })), [red]);
    let says = |body: BodyHandle, asked: ShapeHandle| body != kinematic && asked != shape;
    assert_eq!(order(&ALL().when(&says)), [red, fixed]);
    assert_eq!(order(&ALL().when(&|_, _| false)), []);
    // A handle of another world's, or of what is gone, excludes nothing.
    let mut gone = self::world();
    let other = (0..9).map(|_| add(&mut gone, BodyDesc::fixed(), ball(1.0))).last().unwrap();
    assert_eq!(order(&ALL().without(other)).len(), 4);
}

/// Everything on the vertical line through a place, by a ray, by body.
fn below(world: &World, x: f64) -> Vec<BodyHandle> {
    let mut hits = Vec::new();
    world.cast_ray_all(&ray([x, 1000.0, 0.0], [0.0, -2000.0, 0.0]), &ALL(), &mut hits).unwrap();
    hits.iter().map(|h| h.body).collect()
}

#[test]
fn queries_see_the_world_as_it_is_now() {
    let mut world = world();
    assert_eq!(below(&world, 0.0), []);
    let unit = || Geometry::cuboid(0.5, 0.5, 0.5);
    let wall = add(&mut world, BodyDesc::fixed(), unit());
    assert_eq!(below(&world, 0.0), [wall], "before any step");
    let crate_ = add(&mut world, BodyDesc::dynamic().at(DVec3::Y * 5.0), unit());
    let lift = add(&mut world, BodyDesc::kinematic().at(DVec3::Y * 9.0), unit());
    assert_eq!(below(&world, 0.0), [lift, crate_, wall]);
    world.set_pose(crate_, DVec3::X * 3.0, Quat::IDENTITY).unwrap();
    world.set_pose(wall, DVec3::X * 6.0, Quat::IDENTITY).unwrap();
    assert_eq!([below(&world, 0.0), below(&world, 3.0), below(&world, 6.0)], [[lift], [crate_], [wall]]);
    world.step(1.0 / 60.0).unwrap();
    assert_eq!([below(&world, 0.0), below(&world, 3.0), below(&world, 6.0)], [[lift], [crate_], [wall]]);
    // After steps, moved by hand again, static or not.
    world.set_pose(wall, DVec3::X * -3.0, Quat::IDENTITY).unwrap();
    world.set_pose(crate_, DVec3::X * -3.0 + DVec3::Y * 3.0, Quat::IDENTITY).unwrap();
    assert_eq!([below(&world, 6.0), below(&world, -3.0)], [vec![], vec![crate_, wall]]);
    // A second shape comes and goes; the mass, and with it the frame that all is kept in, changes.
    let mut arm = ShapeDesc::new(unit());
    arm.position = Vec3::X * 20.0;
    let arm = world.add_shape(crate_, &arm).unwrap();
    assert_eq!([below(&world, 17.0), below(&world, -3.0)], [vec![crate_], vec![crate_, wall]]);
    world.remove_shape(arm).unwrap();
    assert_eq!([below(&world, 17.0), below(&world, -3.0)], [vec![], vec![crate_, wall]]);
    world.remove_body(wall).unwrap();
    assert_eq!(below(&world, -3.0), [crate_]);
    world.remove_body(crate_).unwrap();
    assert_eq!(below(&world, -3.0), []);
    // A slot that is used again, by another kind of body.
    let floor = add(&mut world, BodyDesc::fixed().at(DVec3::X * -3.0), Geometry::cuboid(0.4, 0.1, 0.4));
    assert_eq!(below(&world, -3.0), [floor]);
    // Far in a step: seen where it is, not where it was or where a box around its way is.
    let fast = BodyDesc::dynamic().moving(Vec3::X * 6000.0, Vec3::ZERO).at(DVec3::new(100.0, 0.0, 0.0));
    let fast = add(&mut world, fast, unit());
    for _ in 0..3 {
        world.step(1.0 / 60.0).unwrap();
        let x = world.position(fast).unwrap().x;
        assert_eq!(
            [below(&world, x), below(&world, x - 50.0), below(&world, x - 100.0)],
            [vec![fast], vec![], vec![]]
        );
    }
    // Planes, which have no box, static and moving.
    let ground = add(&mut world, BodyDesc::fixed().at(DVec3::Y * -50.0), Geometry::Plane);
    let tide = add(&mut world, BodyDesc::kinematic().at(DVec3::Y * -40.0), Geometry::Plane);
    assert_eq!(below(&world, 77.0), [tide, ground]);
    world.set_pose(tide, DVec3::Y * -60.0, Quat::IDENTITY).unwrap();
    assert_eq!(below(&world, 77.0), [ground, tide]);
    world.remove_body(ground).unwrap();
    world.remove_body(tide).unwrap();
    assert_eq!(below(&world, 77.0), []);
    assert!(world.contains(lift));
}

/// Asleep or not, everything is where it is.
#[test]
fn what_sleeps_is_seen_as_well() {
    let mut world = World::new(Settings { sleeping: true, ..Settings::default() }).unwrap();
    let floor = add(&mut world, BodyDesc::fixed().at(DVec3::Y * -0.5), Geometry::cuboid(50.0, 0.5, 5.0));
    let balls: Vec<BodyHandle> = (0..5)
        .map(|i| add(&mut world, BodyDesc::dynamic().at(DVec3::new(f64::from(i) * 4.0, 1.0, 0.0)), ball(0.5)))
        .collect();
    for step in 0..400 {
        world.step(1.0 / 60.0).unwrap();
        // Asked now and then, so that many step between two questions.
        if step % 70 == 0 || world.asleep() > 0 {
            for (i, &ball) in balls.iter().enumerate() {
                assert_eq!(below(&world, i as f64 * 4.0), [ball, floor]);
                let top = world.position(ball).unwrap().y + 0.5;
                let hit = world.cast_ray(&ray([i as f64 * 4.0, 9.0, 0.0], [0.0, -9.0, 0.0]), &ALL());
                assert!((hit.unwrap().unwrap().point.y - top).abs() < 1e-9);
            }
        }
    }
    assert_eq!(world.asleep(), balls.len());
    assert_eq!(
        world
            .cast_ray(&ray([0.0, 9.0, 0.0], [0.0, -9.0, 0.0]), &QueryFilter::only_dynamic())
            .unwrap()
            .unwrap()
            .body,
        balls[0]
    );
    world.remove_body(balls[0]).unwrap();
    world.set_pose(balls[1], DVec3::new(-4.0, 0.5, 0.0), Quat::IDENTITY).unwrap();
    let lines = [0.0, 4.0, -4.0, 8.0].map(|x| below(&world, x));
    assert_eq!(lines, [vec![floor], vec![floor], vec![balls[1], floor], vec![balls[2], floor]]);
}

/// On a grid of 1/64 m, which numbers of 1e6 m still know.
fn on_grid(random: &mut Random, size: f32) -> DVec3 {
    (random.cube() * size * 64.0).round().as_dvec3() / 64.0
}

fn convex(random: &mut Random, kind: usize) -> Geometry {
    let mut size = || random.range(0.2, 1.0);
    let (x, y, z) = (size(), size(), size());
    match kind % 5 {
        0 => ball(x),
        1 => Geometry::capsule(x, y),
        2 => Geometry::cuboid(x, y, z),
        3 => Geometry::cylinder(x, y),
        _ => {
            let points: Vec<Vec3> = (0..20).map(|_| random.cube()).collect();
            Geometry::Hull(Arc::new(ConvexHull::new(&points).unwrap()))
        }
    }
}

/// A crowd of bodies with its hill; each body's place in `order` is its number.
fn crowd(centre: DVec3, seed: u64, order: &[usize]) -> World {
    let mut random = Random(seed);
    let mut world = world();
    let mut descs: Vec<BodyDesc> = (0..order.len() - 1)
        .map(|i| {
            let kind = [BodyDesc::dynamic(), BodyDesc::fixed(), BodyDesc::kinematic()][i % 3].clone();
            let at = centre + on_grid(&mut random, 20.0);
            let (turned, shape) = (random.rotation(), convex(&mut random, i));
            kind.at(at).rotated(turned).with_shape(ShapeDesc::new(shape))
        })
        .collect();
    let hill: Vec<f32> = (0..41 * 41).map(|_| random.range(-1.0, 1.0)).collect();
    let hill = HeightField::new(41, 41, Vec2::ONE, hill).unwrap();
    let at = centre - DVec3::new(20.0, 15.0, 20.0);
    descs.push(BodyDesc::fixed().at(at).with_shape(ShapeDesc::new(Geometry::HeightField(Arc::new(hill)))));
    for &i in order {
        let mut desc = descs[i].clone();
        desc.user_data = i as u64;
        world.add_body(&desc).unwrap();
    }
    world
}

/// Who answered, numbers of bodies in place of handles, which differ from world to world; and the numbers.
#[derive(Clone, Debug, Default, PartialEq)]
struct Answer {
    who: Vec<u64>,
    triangle: Option<u32>,
    fraction: f32,
    normal: Vec3,
}

fn answers(world: &World, centre: DVec3, seed: u64, count: usize) -> Vec<Answer> {
    let mut random = Random(seed);
    let who = |body: BodyHandle| world.user_data(body).unwrap();
    let mut out = Vec::new();
    let mut add = |answer: Option<(BodyHandle, Option<u32>, f32, Vec3)>| {
        out.push(answer.map_or_else(Answer::default, |(body, triangle, fraction, normal)| Answer {
            who: vec![who(body)],
            triangle,
            fraction,
            normal,
        }));
    };
    for i in 0..count {
        let (from, path) = (on_grid(&mut random, 25.0), random.cube() * 40.0);
        let at = centre + from;
        let hit = world.cast_ray(&Ray::new(at, path), &ALL()).unwrap();
        add(hit.map(|h| (h.body, h.triangle, h.fraction, h.normal)));
        let found = world.closest_point(at, 9.0, &ALL()).unwrap();
        add(found.map(|f| (f.body, f.triangle, f.distance, f.normal)));
        let (shape, turned) = (convex(&mut random, i), random.rotation());
        let cast = ShapeCast::new(&shape, at, path).rotated(turned);
        let hit = world.cast_shape(&cast, &ALL()).unwrap();
        add(hit.map(|h| (h.body, h.triangle, h.fraction, h.normal)));
        let mut over = Vec::new();
        world.overlap(&shape, at, turned, &ALL(), &mut over).unwrap();
        over.iter().for_each(|o: &Overlap| add(Some((o.body, None, 0.0, Vec3::ZERO))));
    }
    // Those of an overlap come by handle.
    out.chunk_by_mut(|a, b| a.normal == Vec3::ZERO && b.normal == Vec3::ZERO)
        .for_each(|same| same.sort_by(|a, b| a.who.cmp(&b.who)));
    out
}

#[test]
fn far_from_the_origin_answers_are_the_same() {
    let order: Vec<usize> = (0..300).collect();
    let near = answers(&crowd(DVec3::ZERO, 5, &order), DVec3::ZERO, 6, 400);
    for far in [DVec3::new(1e6, -1e6, 5e5), DVec3::new(0.0, 0.0, 1.0e7)] {
        let there = answers(&crowd(far, 5, &order), far, 6, 400);
        assert_eq!(near.len(), there.len());
        for (near, there) in near.iter().zip(&there) {
            // Positions of 1e7 m are known to 2e-9 m.
            assert_eq!(near.who, there.who);
            assert!((near.fraction - there.fraction).abs() <= 1e-6, "{near:?} {there:?}");
            assert!((near.normal - there.normal).length() < 1e-4, "{near:?} {there:?}");
        }
    }
}

#[test]
fn answers_depend_on_what_is_there_and_not_on_how_it_came() {
    let forward: Vec<usize> = (0..300).collect();
    let backward: Vec<usize> = forward.iter().rev().copied().collect();
    let expected = answers(&crowd(DVec3::ZERO, 9, &forward), DVec3::ZERO, 6, 300);
    let mut world = crowd(DVec3::ZERO, 9, &backward);
    assert_eq!(answers(&world, DVec3::ZERO, 6, 300), expected);
    // Added and removed, moved away and back.
    let others: Vec<BodyHandle> = (0..50)
        .map(|i| add(&mut world, BodyDesc::dynamic().at(DVec3::X * f64::from(i)), ball(1.0)))
        .collect();
    answers(&world, DVec3::ZERO, 6, 3);
    let bodies: Vec<BodyHandle> = world.bodies().collect();
    for &body in bodies.iter().step_by(2) {
        let (position, rotation) = (world.position(body).unwrap(), world.rotation(body).unwrap());
        if position.fract() != DVec3::ZERO && rotation != Quat::IDENTITY {
            continue;
        }
        world.set_pose(body, position + DVec3::Y * 100.0, rotation).unwrap();
        answers(&world, DVec3::ZERO, 6, 1);
        world.set_pose(body, position, rotation).unwrap();
    }
    others.into_iter().for_each(|body| world.remove_body(body).unwrap());
    assert_eq!(answers(&world, DVec3::ZERO, 6, 300), expected);
}

/// SSE2, AVX2 and all other builds: one number for all answers.
#[test]
fn every_build_gives_the_pinned_answers() {
    let order: Vec<usize> = (0..300).collect();
    let mut world = crowd(DVec3::new(1000.0, 0.5, -300.0), 31, &order);
    let mut hash = 0xCBF2_9CE4_8422_2325u64;
    let mut add = |bits: u64| hash = (hash ^ bits).wrapping_mul(0x100_0000_01B3).rotate_left(5);
    for round in 0..3 {
        for answer in answers(&world, DVec3::new(1000.0, 0.5, -300.0), round, 200) {
            answer.who.iter().for_each(|&who| add(who));
            add(answer.triangle.map_or(u64::MAX, u64::from));
            add(answer.fraction.to_bits().into());
            answer.normal.to_array().iter().for_each(|x| add(x.to_bits().into()));
        }
        world.step(1.0 / 60.0).unwrap();
    }
    assert_eq!(format!("{hash:016x}"), "698f0337ab1dd46b");
}

#[test]
fn of_equal_answers_the_lower_handle_comes_first() {
    let mut world = world();
    let twins: Vec<BodyHandle> = (0..9).map(|_| add(&mut world, BodyDesc::dynamic(), ball(1.0))).collect();
    let down = ray([0.0, 5.0, 0.0], [0.0, -10.0, 0.0]);
    let mut all = Vec::new();
    world.cast_ray_all(&down, &ALL(), &mut all).unwrap();
    assert_eq!(all.iter().map(|h| h.body).collect::<Vec<_>>(), twins);
    let drop = ball(0.5);
    let hit = world.cast_shape(&ShapeCast::new(&drop, down.from, down.path), &ALL()).unwrap().unwrap();
    let near = world.closest_point(down.from, 99.0, &ALL()).unwrap().unwrap();
    assert_eq!([first(&world, down).unwrap().body, hit.body, near.body], [twins[0]; 3]);
}

/// All there is to say of a hit, to the bit.
type HitBits = (BodyHandle, ShapeHandle, u32, [u64; 3], [u32; 3], Option<u32>, bool);

fn bits_of(hit: &Option<RayHit>) -> Option<HitBits> {
    hit.map(|h| {
        let (point, normal) = (h.point.to_array().map(f64::to_bits), h.normal.to_array().map(f32::to_bits));
        (h.body, h.shape, h.fraction.to_bits(), point, normal, h.triangle, h.inside)
    })
}

/// A crowd on a field, above meshes rough and flat, with a plane, a sensor, and some who are there twice.
fn crowd_and_meshes(centre: DVec3) -> World {
    let order: Vec<usize> = (0..300).collect();
    let mut world = crowd(centre, 11, &order);
    let mut random = Random(14);
    let n = 33;
    let vertices = (0..n * n).map(|i| Vec3::new((i % n) as f32, random.range(0.0, 2.0), (i / n) as f32));
    let vertices = vertices.collect();
    let triangles = (0..n * (n - 1)).filter(|c| c % n < n - 1);
    let triangles = triangles.flat_map(|c| [[c, c + n, c + 1], [c + 1, c + n, c + n + 1]]).collect();
    let rough = Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles).unwrap()));
    let at = |x: f64, y: f64, z: f64| BodyDesc::fixed().at(centre + DVec3::new(x, y, z));
    add(&mut world, at(-16.0, -5.0, -16.0).rotated(random.rotation()), rough);
    for _ in 0..2 {
        add(&mut world, at(0.0, -12.0, 0.0), common::flat_mesh(16, 1.0));
        add(&mut world, at(3.0, 4.0, 5.0), Geometry::cuboid(1.0, 2.0, 3.0));
    }
    add(&mut world, at(0.0, -14.0, 0.0), Geometry::Plane);
    let mut sensor = ShapeDesc::new(ball(3.0));
    sensor.sensor = true;
    world.add_body(&at(0.0, 6.0, 0.0).with_shape(sensor)).unwrap();
    world
}

/// Rays that a batch may be made of, of each kind some hundred.
fn bundles(centre: DVec3) -> Vec<Vec<Ray>> {
    let mut random = Random(12);
    let scattered: Vec<Ray> =
        (0..700).map(|_| Ray::new(centre + on_grid(&mut random, 25.0), random.cube() * 40.0)).collect();
    let mut camera = |down: f32, wide: f32, far: f32| -> Vec<Ray> {
        let eye = centre + on_grid(&mut random, 8.0) + DVec3::Y * 5.0;
        let place = |i: i32| ((i as f32 + 0.5) / 16.0 - 1.0) * wide;
        let way = |i: i32| Vec3::new(place(i % 32), down, place(i / 32) + 0.3);
        (0..32 * 32).map(|i| Ray::new(eye, way(i) * far)).collect()
    };
    let cameras = [camera(-1.0, 1.0, 30.0), camera(-0.2, 0.1, 60.0), camera(0.3, 2.0, 1e4)];
    // On the corners and edges of flat meshes: all triangles there are met at the same fraction.
    let grid = |i: i32| centre + DVec3::new(f64::from(i % 30 - 15), -10.0, f64::from(i / 30 - 15) * 0.5);
    let straight: Vec<Ray> = (0..900).map(|i| Ray::new(grid(i), Vec3::NEG_Y * 3.0)).collect();
    let around = |i: i32| {
        let angle = libm::sincosf(i as f32 * 0.0175);
        Ray::new(centre + DVec3::Y, Vec3::new(angle.1, -0.2, angle.0) * 50.0)
    };
    let sensor = (0..360).map(around).collect();
    let still = scattered.iter().map(|ray| Ray { path: Vec3::ZERO, ..*ray }).collect();
    let along_x =
        |i: i32| Ray::new(centre + DVec3::new(-40.0, f64::from(i) * 0.05 - 16.0, 1.0), Vec3::X * 80.0);
    let level = (0..400).map(along_x).collect();
    // Of the same with and without a length, near and far: neighbours that have little in common.
    let mixed = scattered.iter().zip(&straight).zip(&cameras[0]).enumerate();
    let mixed = mixed.map(|(i, ((a, b), c))| match i % 5 {
        0 => *a,
        1 => Ray { path: Vec3::ZERO, ..*b },
        2 => Ray { path: c.path * 1e8, ..*c },
        _ => *c,
    });
    let mixed = mixed.collect();
    let short: Vec<Ray> = cameras[0].iter().map(|ray| Ray { path: ray.path * 0.2, ..*ray }).collect();
    let [a, b, c] = cameras;
    vec![scattered, a, b, c, straight, sensor, still, level, mixed, short]
}

#[test]
fn a_batch_has_the_bits_of_one_by_one() {
    for centre in [DVec3::ZERO, DVec3::new(1e6, -3e5, 2e5)] {
        let mut world = crowd_and_meshes(centre);
        let one = world.bodies().nth(50).unwrap();
        let late = |body: BodyHandle, _: ShapeHandle| body > one;
        let filters = [
            ALL(),
            ALL().skipping_inside(),
            ALL().with_sensors().without(one),
            QueryFilter::only_static(),
            QueryFilter::only_dynamic(),
            ALL().when(&late),
        ];
        let (mut met, mut triangles, mut inside) = (0, 0, 0);
        for step in 0..2 {
            for rays in bundles(centre) {
                for filter in &filters {
                    let mut hits = vec![None; rays.len()];
                    world.cast_rays(&rays, filter, &mut hits).unwrap();
                    for (ray, hit) in rays.iter().zip(&hits) {
                        let single = world.cast_ray(ray, filter).unwrap();
                        assert_eq!(bits_of(hit), bits_of(&single), "{ray:?} {filter:?}");
                    }
                    met += hits.iter().flatten().count();
                    triangles += hits.iter().flatten().filter(|h| h.triangle.is_some()).count();
                    inside += hits.iter().flatten().filter(|h| h.inside).count();
                }
            }
            if step == 0 {
                world.step(1.0 / 60.0).unwrap();
            }
        }
        println!("{met} hits, {triangles} of triangles, {inside} inside");
        assert!(met > 20_000 && triangles > 5_000 && inside > 1_000);
        let rays = &bundles(centre)[1];
        for count in [0, 1, 8, 31, 32, 33, 63, 64, 65, 95, 96, 130] {
            let mut hits = vec![None; count];
            world.cast_rays(&rays[..count], &ALL(), &mut hits).unwrap();
            let single: Vec<_> = rays[..count].iter().map(|r| world.cast_ray(r, &ALL()).unwrap()).collect();
            assert_eq!(hits, single);
        }
    }
}

#[test]
fn any_number_of_threads_may_ask() {
    fn shared<T: Sync + Send>() {}
    shared::<World>();
    let order: Vec<usize> = (0..300).collect();
    let mut world = crowd(DVec3::ZERO, 13, &order);
    for _ in 0..5 {
        let fresh = crowd(DVec3::ZERO, 13, &order);
        drop(fresh);
        // The first to ask makes the tree, whoever that is.
        let world_ref = &world;
        let all: Vec<Vec<Answer>> = std::thread::scope(|scope| {
            let asked: Vec<_> =
                (0..4).map(|_| scope.spawn(move || answers(world_ref, DVec3::ZERO, 3, 40))).collect();
            asked.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        assert!(all.iter().all(|one| *one == all[0]));
        assert_eq!(answers(&world, DVec3::ZERO, 3, 40), all[0]);
        world.step(1.0 / 60.0).unwrap();
    }
}

#[test]
fn queries_change_nothing_in_the_steps() {
    let order: Vec<usize> = (0..200).collect();
    let (mut asked, mut left_alone) = (crowd(DVec3::ZERO, 15, &order), crowd(DVec3::ZERO, 15, &order));
    assert_eq!(asked.memory(), left_alone.memory());
    for i in 0..40 {
        answers(&asked, DVec3::ZERO, i, 5);
        asked.step(1.0 / 60.0).unwrap();
        left_alone.step(1.0 / 60.0).unwrap();
        assert_eq!(asked.hash(), left_alone.hash());
    }
    assert!(asked.memory().total() > left_alone.memory().total(), "the tree of queries is counted");
}

#[test]
fn bad_input_is_refused_and_leaves_buffers_as_they_were() {
    let world = alone(ball(1.0));
    let bad_rays = [
        ray([f64::NAN, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ray([0.0, f64::INFINITY, 0.0], [1.0, 0.0, 0.0]),
        ray([0.0, 1e16, 0.0], [1.0, 0.0, 0.0]),
        ray([0.0, 0.0, 0.0], [f32::NAN, 0.0, 0.0]),
        ray([0.0, 0.0, 0.0], [0.0, 0.0, f32::INFINITY]),
        ray([0.0, 0.0, 0.0], [0.0, 2e15, 0.0]),
    ];
    let mut hits = Vec::new();
    world.cast_ray_all(&ray([0.0, 5.0, 0.0], [0.0, -10.0, 0.0]), &ALL(), &mut hits).unwrap();
    let before = hits.clone();
    for ray in bad_rays {
        let is_bad = |e: &Error| matches!(e, Error::NotFinite { .. } | Error::OutOfRange { .. });
        assert!(is_bad(&world.cast_ray(&ray, &ALL()).unwrap_err()));
        assert!(is_bad(&world.cast_ray_any(&ray, &ALL()).unwrap_err()));
        assert!(is_bad(&world.cast_ray_all(&ray, &ALL(), &mut hits).unwrap_err()));
        let mut places = [Some(before[0]), None];
        assert!(is_bad(
            &world.cast_rays(&[Ray::new(DVec3::Y, Vec3::Y), ray], &ALL(), &mut places).unwrap_err()
        ));
        assert_eq!(places, [Some(before[0]), None]);
        let shape = ball(1.0);
        assert!(is_bad(&world.cast_shape(&ShapeCast::new(&shape, ray.from, ray.path), &ALL()).unwrap_err()));
        if ray.path.is_finite() && ray.path.length() < 1e15 {
            assert!(is_bad(&world.closest_point(ray.from, 1.0, &ALL()).unwrap_err()));
            let overlap = world.overlap_any(&shape, ray.from, Quat::IDENTITY, &ALL());
            assert!(is_bad(&overlap.unwrap_err()));
        }
    }
    assert_eq!(hits, before);
    let rays = [Ray::new(DVec3::Y, Vec3::Y)];
    assert!(matches!(world.cast_rays(&rays, &ALL(), &mut []), Err(Error::OutOfRange { .. })));
    for distance in [f32::NAN, -1.0, f32::INFINITY] {
        assert!(world.closest_point(DVec3::Y, distance, &ALL()).is_err());
    }
    for hollow in [Geometry::Plane, common::flat_mesh(2, 1.0), flat_field()] {
        let found = world.cast_shape(&ShapeCast::new(&hollow, DVec3::Y, Vec3::Y), &ALL());
        let Err(Error::NotConvex { shape }) = found else { panic!("{found:?}") };
        assert_eq!(shape, hollow.kind_name());
        assert!(world.overlap_any(&hollow, DVec3::Y, Quat::IDENTITY, &ALL()).is_err());
    }
    for empty in [ball(0.0), Geometry::cuboid(1.0, 0.0, 1.0), ball(f32::NAN), ball(1e20)] {
        assert!(world.cast_shape(&ShapeCast::new(&empty, DVec3::Y, Vec3::Y), &ALL()).is_err(), "{empty:?}");
    }
    let shape = ball(1.0);
    for rotation in [Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0)] {
        assert!(world.overlap_any(&shape, DVec3::Y, rotation, &ALL()).is_err());
        assert!(
            world.cast_shape(&ShapeCast::new(&shape, DVec3::Y, Vec3::Y).rotated(rotation), &ALL()).is_err()
        );
    }
    // As large as may be: no panic, no nonsense.
    let far = ray([1e15, -1e15, 1e15], [-1e15, 1e15, -1e15]);
    assert!(first(&world, far).is_none_or(|hit| hit.point.is_finite()));
    assert!(world.cast_shape(&ShapeCast::new(&shape, far.from, far.path), &ALL()).is_ok());
    assert!(world.closest_point(far.from, 1e15, &ALL()).is_ok());
}

/// The same shape for both libraries.
fn in_parry(geometry: &Geometry) -> parry3d::shape::SharedShape {
    use parry3d::shape::SharedShape;
    let vectors = |v: &[Vec3]| v.iter().map(|v| v.to_array().into()).collect::<Vec<_>>();
    match geometry {
        Geometry::Sphere { radius } => SharedShape::ball(*radius),
        Geometry::Capsule { half_height, radius_top, .. } => {
            SharedShape::capsule_y(*half_height, *radius_top)
        }
        Geometry::Box { half_extents: h } => SharedShape::cuboid(h.x, h.y, h.z),
        Geometry::Cylinder { half_height, radius_top, .. } => {
            SharedShape::cylinder(*half_height, *radius_top)
        }
        Geometry::Hull(hull) => SharedShape::convex_hull(&vectors(hull.vertices())).unwrap(),
        Geometry::Mesh(mesh) => {
            let corners: Vec<Vec3> =
                (0..mesh.triangle_count() as u32).flat_map(|i| mesh.corners(i).unwrap()).collect();
            let triangles =
                (0..mesh.triangle_count() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            SharedShape::trimesh(vectors(&corners), triangles).unwrap()
        }
        _ => unreachable!("not asked for"),
    }
}

/// Another library, shape by shape: single precision, and its own idea of how near a touch is.
#[test]
fn another_library_says_the_same() {
    use parry3d::math::{Pose, Rotation, Vector};
    use parry3d::query::{Ray as ParryRay, ShapeCastOptions, cast_shapes, intersection_test};
    let mut random = Random(21);
    let vertices: Vec<Vec3> = (0..400)
        .map(|i| Vec3::new((i % 20) as f32 - 10.0, random.range(-1.0, 1.0), (i / 20) as f32 - 10.0) * 0.4)
        .collect();
    let triangles = (0..361u32).flat_map(|i| {
        let c = i / 19 * 20 + i % 19;
        [[c, c + 20, c + 1], [c + 1, c + 20, c + 21]]
    });
    let mesh = Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles.collect()).unwrap()));
    let (mut rays, mut casts, mut overlaps, mut odd) = (0, 0, 0, 0);
    for i in 0..6000 {
        let geometry = if i % 6 == 5 { mesh.clone() } else { convex(&mut random, i % 6) };
        let other = in_parry(&geometry);
        let turned = random.rotation();
        let mut world = world();
        add(&mut world, BodyDesc::fixed().rotated(turned), geometry.clone());
        let pose = Pose::from_parts(Vector::ZERO, Rotation::from_array(turned.to_array()));
        let from = random.cube() * 5.0;
        let path = (random.cube() * 1.5 - from) * random.range(0.5, 2.0);
        let vector = |v: Vec3| Vector::from(v.to_array());

        let ours = world.cast_ray(&Ray::new(from.as_dvec3(), path), &ALL()).unwrap();
        let ray = ParryRay::new(vector(from), vector(path));
        let theirs = other.cast_ray_and_get_normal(&pose, &ray, 1.0, true);
        match (ours, theirs) {
            (Some(ours), Some(theirs)) => {
                rays += 1;
                let apart = (ours.fraction - theirs.time_of_impact).abs() * path.length();
                // Grazing rays differ by more than rounding.
                let facing = ours.normal.dot(path.normalize()).abs();
                let same = apart < 1e-4 / facing.max(0.01);
                assert!(same || ours.inside, "{i}: {ours:?} {theirs:?}");
            }
            (None, None) => {}
            _ => odd += 1,
        }

        let asked = in_parry(&geometry);
        let found = world.closest_point(from.as_dvec3(), 100.0, &ALL()).unwrap().unwrap();
        let theirs = asked.distance_to_point(&pose, vector(from), true);
        assert!((found.distance - theirs).abs() < 1e-3, "{i}: {found:?} {theirs}");

        let shape = convex(&mut random, i / 6);
        let (moving, turn) = (in_parry(&shape), random.rotation());
        let start = Pose::from_parts(vector(from), Rotation::from_array(turn.to_array()));
        let ours = world.overlap_any(&shape, from.as_dvec3(), turn, &ALL()).unwrap();
        let theirs = intersection_test(&start, &*moving, &pose, &*other).unwrap().intersecting;
        overlaps += usize::from(ours && theirs);
        odd += usize::from(ours != theirs);
        let cast = ShapeCast::new(&shape, from.as_dvec3(), path).rotated(turn);
        let ours = world.cast_shape(&cast, &ALL()).unwrap();
        let options = ShapeCastOptions::with_max_time_of_impact(1.0);
        let theirs =
            cast_shapes(&start, vector(path), &*moving, &pose, Vector::ZERO, &*other, options).unwrap();
        match (ours, theirs) {
            (Some(ours), Some(theirs)) => {
                casts += 1;
                let apart = (ours.fraction - theirs.time_of_impact).abs() * path.length();
                odd += usize::from(apart > 2e-3);
            }
            (None, None) => {}
            _ => odd += 1,
        }
    }
    println!("{rays} rays, {casts} casts, {overlaps} overlaps alike; {odd} not");
    // Which of the two is right where they differ, the oracles of `src/query/tests.rs` say.
    assert!(rays > 1500 && casts > 2000 && overlaps > 200 && odd < 60, "{rays} {casts} {overlaps} {odd}");
}
