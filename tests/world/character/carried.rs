//! Ground that moves, goes, or runs into it; bodies that it pushes itself.

use super::*;

#[test]
fn moving_and_turning_ground_carries_it() {
    for before in [false, true] {
        let mut world = world();
        let plate = ShapeDesc::new(Geometry::cylinder(0.5, 6.0));
        let plate =
            world.add_body(&BodyDesc::kinematic().with_position(DVec3::Y * -0.5).with_shape(plate)).unwrap();
        let mut character = standing(&world, DVec3::new(4.0, 0.0, 0.0), CharacterSettings::default());
        let mut turned = 0.0;
        let dt = f64::from(DT);
        let place = |t: f64| {
            let centre = DVec3::new(3.0 * (0.7 * t).sin(), -0.5 + (0.9 * t).sin(), 1.2 * t);
            (centre, Quat::from_rotation_y(0.8 * t as f32))
        };
        for step in 1..=240 {
            let t = dt * f64::from(step);
            let (centre, turn) = place(t);
            world.move_kinematic(plate, centre, turn, DT).unwrap();
            if !before {
                world.step(DT).unwrap();
            }
            let report = walk(&mut character, &world, Vec3::NEG_Y * 0.1);
            if before {
                world.step(DT).unwrap();
            }
            turned += report.turned;
            assert!(report.ground.is_some() && report.hits().count() == 0);
            // As the world is when it is asked.
            let (centre, turn) = place(if before { t - dt } else { t });
            let expected = centre + (turn * Vec3::new(4.0, 0.5, 0.0)).as_dvec3();
            assert!(character.feet().distance(expected) < 2e-3, "{step}: {} {expected}", character.feet());
            let turned_by = 0.8 * if before { t - dt } else { t };
            near(turned.into(), turned_by, 1e-3);
        }
        // It jumps off with the ground's velocity, and lands with none over the ground.
        let velocity = world.linear_velocity(plate).unwrap();
        let spin = world.angular_velocity(plate).unwrap();
        let arm = (character.feet() - world.position(plate).unwrap()).as_vec3();
        let report = walk(&mut character, &world, Vec3::Y * 3.0);
        let expected = velocity + spin.cross(arm) + Vec3::Y * 3.0;
        assert!(report.ground.is_none() && report.velocity.distance(expected) < 0.1, "{report:?} {expected}");
        let mut velocity = report.velocity;
        world.set_velocity(plate, velocity.with_y(0.0), Vec3::ZERO).unwrap();
        let mut landed = None;
        for _ in 0..120 {
            world.step(DT).unwrap();
            velocity.y -= G * DT;
            let report = walk(&mut character, &world, velocity);
            velocity = report.velocity;
            if report.ground.is_some() {
                landed = Some(report);
                break;
            }
        }
        assert!(landed.unwrap().velocity.length() < 1e-3, "{landed:?}");
    }
}

#[test]
fn ground_that_is_removed_lets_it_fall_and_a_wall_stops_who_is_carried() {
    let mut world = world();
    let plate = ShapeDesc::new(Geometry::cuboid(3.0, 0.5, 3.0));
    let plate = BodyDesc::kinematic().with_position(DVec3::Y * -0.5).with_shape(plate);
    let plate = world.add_body(&plate.with_velocity(Vec3::X * 2.0, Vec3::ZERO)).unwrap();
    cuboid(&mut world, [4.0, 2.0, 0.0], [1.0, 1.5, 9.0]);
    let mut character = standing(&world, DVec3::ZERO, CharacterSettings::default());
    let mut last = Vec3::ZERO;
    for _ in 0..120 {
        world.step(DT).unwrap();
        let report = go(&mut character, &world, Vec3::ZERO, &mut last);
        assert!(report.ground.is_some() && !is_inside(&character, &world));
    }
    near(character.feet().x, 3.0 - 0.32, 1e-3);
    world.remove_body(plate).unwrap();
    let report = go(&mut character, &world, Vec3::ZERO, &mut last);
    assert!(report.ground.is_none());
}

#[test]
fn what_moves_into_it_pushes_it_out() {
    let mut world = world();
    floor(&mut world);
    let ram = ShapeDesc::new(Geometry::cuboid(1.0, 2.0, 2.0));
    let ram = BodyDesc::kinematic().with_position(DVec3::X * -3.0).with_shape(ram);
    world.add_body(&ram.with_velocity(Vec3::X * 4.0, Vec3::ZERO)).unwrap();
    let mut character = standing(&world, DVec3::ZERO, CharacterSettings::default());
    let mut last = Vec3::ZERO;
    for step in 1..=90 {
        world.step(DT).unwrap();
        let report = go(&mut character, &world, Vec3::ZERO, &mut last);
        let face = -2.0 + 4.0 * f64::from(DT) * f64::from(step);
        near(character.feet().x, (face + 0.32).max(0.0), 1e-3);
        assert!(report.overlap == 0.0 && report.ground.is_some());
        assert_eq!(report.pushed_out.x > 0.0, face + 0.32 > 1e-3);
    }
    // Against a wall it is squeezed, says so, and stays in between.
    cuboid(&mut world, [character.feet().x + 0.5 + 0.3, 0.0, 0.0], [0.3, 5.0, 5.0]);
    let mut deepest = 0.0_f32;
    for _ in 0..8 {
        world.step(DT).unwrap();
        let report = go(&mut character, &world, Vec3::ZERO, &mut last);
        deepest = deepest.max(report.overlap);
        assert!(character.position().is_finite());
    }
    assert!(deepest > 0.05, "{deepest}");
}

#[test]
fn a_ceiling_ends_a_jump_and_a_platform_may_be_passed_from_below() {
    let mut world = world();
    floor(&mut world);
    let plate = cuboid(&mut world, [0.0, 2.5, 0.0], [2.0, 0.1, 2.0]);
    let mut character = standing(&world, DVec3::ZERO, CharacterSettings::default());
    let first = walk(&mut character, &world, Vec3::Y * 20.0);
    // From 1.82 m to 2.4 m there is 0.56 m and a gap.
    assert!(first.velocity.y == 20.0 && first.ground.is_none());
    let second = walk(&mut character, &world, first.velocity);
    near(character.feet().y, 2.4 - 1.84, GAP);
    assert!(second.velocity.y.abs() < 1e-3 && second.hits().next().unwrap().body == plate, "{second:?}");
    // One-way: seen by those above it only.
    let mut character = standing(&world, DVec3::ZERO, CharacterSettings::default());
    let mut velocity = Vec3::Y * 8.0;
    let mut highest = 0.0_f64;
    for _ in 0..180 {
        let above = character.feet().y > 2.6 - 1e-3;
        let sees = |body: BodyHandle, _: ShapeHandle| body != plate || above;
        let report = character.walk(&world, &QueryFilter::new().with_predicate(&sees), velocity, DT).unwrap();
        velocity = report.velocity - Vec3::Y * G * DT;
        highest = highest.max(character.feet().y);
    }
    assert!(highest > 3.0);
    near(character.feet().y, 2.6, 1e-3);
    assert_eq!(character.ground().unwrap().body, plate);
}

#[test]
fn it_pushes_what_it_can_and_weighs_on_what_it_stands_on() {
    let mut world = world();
    floor(&mut world);
    let material = Material::default().with_friction(0.3);
    // 20 kg take 59 N to slide, 8 t more than it has.
    let add = |world: &mut World, at: DVec3, density: f32| {
        let shape =
            ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5)).with_density(density).with_material(material);
        world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(shape)).unwrap()
    };
    let light = add(&mut world, DVec3::new(2.0, 0.5, 0.0), 20.0);
    let heavy = add(&mut world, DVec3::new(2.0, 0.5, 6.0), 8000.0);
    let settings = CharacterSettings { step_height: 0.0, ..CharacterSettings::default() };
    let mut characters = [DVec3::ZERO, DVec3::Z * 6.0].map(|at| standing(&world, at, settings));
    let mut last = [Vec3::ZERO; 2];
    for _ in 0..180 {
        world.step(DT).unwrap();
        for (character, last) in characters.iter_mut().zip(&mut last) {
            let report = go(character, &world, Vec3::X * 2.0, last);
            report.push(&mut world).unwrap();
        }
    }
    assert!(world.position(light).unwrap().x > 4.0, "{}", world.position(light).unwrap());
    near(world.position(heavy).unwrap().x, 2.0, 1e-3);
    near(characters[1].feet().x, 1.5 - 0.32, 1e-3);
    // A seesaw goes down on the side where it stands.
    let beam = ShapeDesc::new(Geometry::cuboid(2.0, 0.05, 0.5)).with_density(50.0);
    let beam = world
        .add_body(&BodyDesc::dynamic().with_position(DVec3::new(0.0, 0.45, -9.0)).with_shape(beam))
        .unwrap();
    fixed(&mut world, DVec3::new(0.0, 0.2, -9.0), Quat::IDENTITY, Geometry::cuboid(0.05, 0.2, 0.5));
    let mut character = standing(&world, DVec3::new(0.9, 0.5, -9.0), CharacterSettings::default());
    let mut fall = Vec3::ZERO;
    for _ in 0..60 {
        world.step(DT).unwrap();
        go(&mut character, &world, Vec3::ZERO, &mut fall).push(&mut world).unwrap();
    }
    let right = world.rotation(beam).unwrap() * Vec3::X;
    assert!(right.y < -0.05, "{right}");
    assert!(!is_inside(&character, &world));
}
