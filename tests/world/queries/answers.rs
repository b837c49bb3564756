//! Exact answers on every shape: rays, moving shapes, nearest points.

use super::*;

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
    // Both sides of a triangle answer, with the normal towards the ray.
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
            let gap = cast.position_at(hit.fraction).y - below - top;
            assert!((0.0..1e-5).contains(&gap), "{} {shape:?} {hit:?} {gap}", floor.kind_name());
            assert!((hit.normal - Vec3::Y).length() < 1e-3 && hit.depth == 0.0, "{hit:?}");
            assert!((hit.point.y - top).abs() < 1e-4, "{} {shape:?} {hit:?}", floor.kind_name());
            // Short of it.
            let short = ShapeCast { path: Vec3::NEG_Y * (10.99 - (below + top) as f32), ..cast };
            assert_eq!(touch(&world, short), None);
            // Where it touched it overlaps nothing; 1 mm further it does.
            let place = |at: DVec3| world.overlap_any(shape, at, Quat::IDENTITY, &ALL()).unwrap();
            assert!(!place(cast.position_at(hit.fraction)));
            assert!(place(cast.position_at(hit.fraction) - DVec3::Y * 1e-3));
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
        add(&mut world, BodyDesc::fixed().with_position(Vec3::NEG_Y * deep), floor.clone());
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
