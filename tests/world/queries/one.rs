//! Queries against one body or one shape, and by boxes.

use super::*;
use backstop::{Aabb, QueryTarget};

/// Expected: the answers of the same query with a predicate that lets only these shapes pass.
#[test]
fn queries_of_one_body_or_shape_answer_as_a_predicate_would() {
    let order: Vec<usize> = (0..60).collect();
    let world = crowd(DVec3::new(1e5, 0.0, -3e4), 9, &order);
    let centre = DVec3::new(1e5, 0.0, -3e4);
    let mut random = Random(21);
    let handles: Vec<BodyHandle> = world.bodies().collect();
    let mut met = 0;
    for round in 0..400 {
        let body = handles[if round % 3 == 0 { 59 } else { random.below(handles.len()) }];
        let shape = world.shapes(body).unwrap().next().unwrap();
        let is_body = move |other: BodyHandle, _: ShapeHandle| other == body;
        let is_shape = move |_: BodyHandle, other: ShapeHandle| other == shape;
        let of_body: (QueryTarget, QueryFilter<'_>) = (body.into(), ALL().with_predicate(&is_body));
        let of_shape: (QueryTarget, QueryFilter<'_>) = (shape.into(), ALL().with_predicate(&is_shape));
        for (target, slow) in [of_body, of_shape] {
            let only = QueryFilter::only(target);
            let aim = world.position(body).unwrap();
            let from = centre + random.cube().as_dvec3() * 25.0;
            let ray = Ray::new(from, (aim - from).as_vec3() * 2.0);
            let hit = world.cast_ray(&ray, &only).unwrap();
            assert_eq!(hit, world.cast_ray(&ray, &slow).unwrap());
            met += u32::from(hit.is_some());
            let mut batch = vec![None; 70];
            world.cast_rays(&[ray; 70], &only, &mut batch).unwrap();
            assert!(batch.iter().all(|one| *one == hit));
            let form = convex(&mut random, round);
            let cast = ShapeCast::new(&form, from, ray.path).with_rotation(random.rotation());
            for cast in [cast, cast.with_spin(random.cube() * 3.0)] {
                assert_eq!(world.cast_shape(&cast, &only).unwrap(), world.cast_shape(&cast, &slow).unwrap());
            }
            // How deep it is in it, and the way out.
            let still = ShapeCast::new(&form, aim + random.cube().as_dvec3(), Vec3::ZERO);
            let (mut deep, mut deep_slow) = (Vec::new(), Vec::new());
            world.cast_shape_all(&still, &only, &mut deep).unwrap();
            world.cast_shape_all(&still, &slow, &mut deep_slow).unwrap();
            assert_eq!(deep, deep_slow);
            let (mut over, mut over_slow) = (Vec::new(), Vec::new());
            world.overlap(&form, still.position, Quat::IDENTITY, &only, &mut over).unwrap();
            world.overlap(&form, still.position, Quat::IDENTITY, &slow, &mut over_slow).unwrap();
            assert_eq!(over, over_slow);
            let near = world.closest_point(from, 30.0, &only).unwrap();
            assert_eq!(near, world.closest_point(from, 30.0, &slow).unwrap());
        }
    }
    println!("{met} rays met their target");
    assert!(met > 200);
}

/// Expected: no tree is made for them; other fields of the filter count; stale handles are refused.
#[test]
fn a_target_needs_no_tree_and_keeps_to_the_filter() {
    let mut world = world();
    let unit = Geometry::cuboid(0.5, 0.5, 0.5);
    let body = add(&mut world, BodyDesc::dynamic(), unit.clone());
    let other = add(&mut world, BodyDesc::dynamic().with_position(DVec3::X * 3.0), unit.clone());
    let mut sensor = ShapeDesc::new(unit);
    sensor.sensor = true;
    let sensor = world.add_shape(body, &sensor).unwrap();
    let down = ray([0.0, 9.0, 0.0], [0.0, -20.0, 0.0]);
    let before = world.memory();
    assert_eq!(world.cast_ray(&down, &QueryFilter::only(body)).unwrap().unwrap().body, body);
    assert_eq!(world.cast_ray(&down, &QueryFilter::only(other)).unwrap(), None);
    assert_eq!(world.memory(), before);
    assert_eq!(world.cast_ray(&down, &QueryFilter::only(sensor)).unwrap(), None);
    assert!(world.cast_ray(&down, &QueryFilter::only(sensor).with_sensors()).unwrap().is_some());
    assert_eq!(world.cast_ray(&down, &QueryFilter::only(body).excluding(body)).unwrap(), None);
    world.set_enabled(body, false).unwrap();
    assert_eq!(world.cast_ray(&down, &QueryFilter::only(body)).unwrap(), None);
    world.remove_body(body).unwrap();
    let mut kept = vec![Overlap { body: other, shape: sensor }];
    for (only, error) in
        [(QueryFilter::only(body), Error::StaleBody), (QueryFilter::only(sensor), Error::StaleShape)]
    {
        assert_eq!(world.cast_ray(&down, &only), Err(error.clone()));
        assert_eq!(world.closest_point(DVec3::ZERO, 1.0, &only), Err(error.clone()));
        assert_eq!(world.overlap(&ball(1.0), DVec3::ZERO, Quat::IDENTITY, &only, &mut kept), Err(error));
        assert_eq!(kept.len(), 1);
    }
}

/// Expected: all shapes one by one, by their boxes; the exact overlap is among them.
#[test]
fn boxes_find_all_shapes_whose_boxes_meet_them() {
    let order: Vec<usize> = (0..90).collect();
    for centre in [DVec3::ZERO, DVec3::new(-7e5, 1e3, 2e5)] {
        let mut world = crowd(centre, 4, &order);
        // The box around the half-space of a plane that leans is everywhere.
        let leans = BodyDesc::fixed()
            .with_position(centre - DVec3::Y * 60.0)
            .with_rotation(Quat::from_rotation_z(0.3));
        let plane = add(&mut world, leans, Geometry::Plane);
        let mut random = Random(2);
        let mut found = Vec::new();
        for round in 0..300 {
            if round % 50 == 49 {
                world.step(1.0 / 60.0).unwrap();
            }
            let middle = centre + random.cube().as_dvec3() * 22.0;
            let half = (random.cube().abs() * [0.0, 2.0, 9.0][round % 3]).as_dvec3();
            let area = Aabb { min: middle - half, max: middle + half };
            world.overlap_aabb(&area, &ALL(), &mut found).unwrap();
            let mut expected: Vec<Overlap> = world
                .bodies()
                .flat_map(|body| world.shapes(body).unwrap().map(move |shape| Overlap { body, shape }))
                .filter(|one| world.shape_aabb(one.shape).unwrap().overlaps(&area))
                .collect();
            expected.sort_unstable_by_key(|one| one.shape);
            assert_eq!(found, expected, "{round}");
            assert!(found.iter().any(|one| one.body == plane));
            if half.min_element() > 0.0 {
                let form = Geometry::Box { half_extents: half.as_vec3() };
                let mut exact = Vec::new();
                world.overlap(&form, middle, Quat::IDENTITY, &ALL(), &mut exact).unwrap();
                assert!(exact.iter().all(|one| found.contains(one)));
            }
            let dynamic = QueryFilter::only_dynamic();
            let mut fewer = Vec::new();
            world.overlap_aabb(&area, &dynamic, &mut fewer).unwrap();
            assert!(fewer.len() < found.len() && fewer.iter().all(|one| found.contains(one)));
        }
        let wrong = [
            Aabb { min: DVec3::ONE, max: DVec3::ZERO },
            Aabb { min: DVec3::NAN, max: DVec3::ONE },
            Aabb { min: DVec3::ZERO, max: DVec3::splat(2e15) },
        ];
        let before = found.clone();
        for area in wrong {
            assert!(world.overlap_aabb(&area, &ALL(), &mut found).is_err());
            assert_eq!(found, before);
        }
    }
}
