//! Shapes that a query sees: those that the filter leaves, in the world as it is now, asleep or not.

use super::*;

#[test]
fn filters_leave_out_what_they_say() {
    let mut world = world();
    let down = ray([0.0, 100.0, 0.0], [0.0, -200.0, 0.0]);
    let slab = || Geometry::cuboid(1.0, 0.5, 1.0);
    let fixed = add(&mut world, BodyDesc::fixed().with_position(DVec3::Y * 10.0), slab());
    let kinematic = add(&mut world, BodyDesc::kinematic().with_position(DVec3::Y * 20.0), slab());
    let dynamic = add(&mut world, BodyDesc::dynamic().with_position(DVec3::Y * 30.0), slab());
    let mut red = ShapeDesc::new(slab());
    red.filter = Filter::default().with_category(4).with_mask(8).with_group(0);
    let red = world.add_body(&BodyDesc::dynamic().with_position(DVec3::Y * 40.0).with_shape(red)).unwrap();
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
    assert_eq!(order(&ALL().excluding(red)), [dynamic, kinematic, fixed]);
    let shape = world.shapes(dynamic).unwrap().next().unwrap();
    assert_eq!(order(&ALL().excluding_shape(shape)), [red, kinematic, fixed]);
    let bullet = Filter::default().with_category(1);
    assert_eq!(order(&ALL().with_filter(bullet)), [dynamic, kinematic, fixed]);
    assert_eq!(
        order(&ALL().with_filter(Filter::default().with_category(8).with_mask(4).with_group(0))),
        [red]
    );
    let says = |body: BodyHandle, asked: ShapeHandle| body != kinematic && asked != shape;
    assert_eq!(order(&ALL().with_predicate(&says)), [red, fixed]);
    assert_eq!(order(&ALL().with_predicate(&|_, _| false)), []);
    // A handle of another world's, or of a removed body, excludes nothing.
    let mut gone = self::world();
    let other = (0..9).map(|_| add(&mut gone, BodyDesc::fixed(), ball(1.0))).last().unwrap();
    assert_eq!(order(&ALL().excluding(other)).len(), 4);
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
    let crate_ = add(&mut world, BodyDesc::dynamic().with_position(DVec3::Y * 5.0), unit());
    let lift = add(&mut world, BodyDesc::kinematic().with_position(DVec3::Y * 9.0), unit());
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
    let floor =
        add(&mut world, BodyDesc::fixed().with_position(DVec3::X * -3.0), Geometry::cuboid(0.4, 0.1, 0.4));
    assert_eq!(below(&world, -3.0), [floor]);
    // Far in a step: seen where it is, not where it was or where a box around its way is.
    let fast = BodyDesc::dynamic()
        .with_velocity(Vec3::X * 6000.0, Vec3::ZERO)
        .with_position(DVec3::new(100.0, 0.0, 0.0));
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
    let ground = add(&mut world, BodyDesc::fixed().with_position(DVec3::Y * -50.0), Geometry::Plane);
    let tide = add(&mut world, BodyDesc::kinematic().with_position(DVec3::Y * -40.0), Geometry::Plane);
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
    let mut world = World::new(Settings::default().with_sleeping(true)).unwrap();
    let floor =
        add(&mut world, BodyDesc::fixed().with_position(DVec3::Y * -0.5), Geometry::cuboid(50.0, 0.5, 5.0));
    let balls: Vec<BodyHandle> = (0..5)
        .map(|i| {
            add(
                &mut world,
                BodyDesc::dynamic().with_position(DVec3::new(f64::from(i) * 4.0, 1.0, 0.0)),
                ball(0.5),
            )
        })
        .collect();
    for step in 0..400 {
        world.step(1.0 / 60.0).unwrap();
        // Asked now and then, so that many step between two questions.
        if step % 70 == 0 || world.sleeping_body_count() > 0 {
            for (i, &ball) in balls.iter().enumerate() {
                assert_eq!(below(&world, i as f64 * 4.0), [ball, floor]);
                let top = world.position(ball).unwrap().y + 0.5;
                let hit = world.cast_ray(&ray([i as f64 * 4.0, 9.0, 0.0], [0.0, -9.0, 0.0]), &ALL());
                assert!((hit.unwrap().unwrap().point.y - top).abs() < 1e-9);
            }
        }
    }
    assert_eq!(world.sleeping_body_count(), balls.len());
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

/// Expected: written fields are read again.
#[test]
fn answers_are_written_and_read() {
    fn again<T: serde::Serialize + serde::de::DeserializeOwned>(value: &T) -> T {
        serde_json::from_str(&serde_json::to_string(value).unwrap()).unwrap()
    }
    let world = alone(Geometry::cuboid(1.0, 1.0, 1.0));
    let down = ray([0.25, 5.0, 0.5], [0.0, -8.0, 0.0]);
    let hit = world.cast_ray(&down, &ALL()).unwrap().unwrap();
    assert_eq!((again(&down), again(&hit)), (down, hit));
    let form = ball(0.5);
    let cast = ShapeCast::new(&form, down.from, down.path).with_spin(Vec3::X);
    let hit = world.cast_shape(&cast, &ALL()).unwrap().unwrap();
    assert_eq!(again(&hit), hit);
    let near = world.closest_point(down.from, 9.0, &ALL()).unwrap().unwrap();
    assert_eq!(again(&near), near);
    let mut over = Vec::new();
    world.overlap(&form, DVec3::ZERO, Quat::IDENTITY, &ALL(), &mut over).unwrap();
    assert_eq!(again(&over), over);
    let area = world.shape_aabb(hit.shape).unwrap();
    assert_eq!(again(&area), area);
    let target = backstop::QueryTarget::from(hit.body);
    assert_eq!(again(&target), target);
    let settings = backstop::CharacterSettings::default();
    let mut character = backstop::Character::new(settings, DVec3::Y * 2.0).unwrap();
    let report = character.walk(&world, &ALL(), Vec3::NEG_Y, 0.5).unwrap();
    assert!(report.ground.is_some());
    assert_eq!(again(&report), report);
}
