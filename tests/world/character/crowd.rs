//! At any speed and among many it is never in anything.

use super::*;

#[test]
fn nothing_is_too_fast_for_it() {
    let wall = |x: f32, y: f32| {
        mesh(
            &[[-30.0, -30.0], [30.0, -30.0], [30.0, 30.0], [-30.0, 30.0]]
                .map(|[a, b]| Vec3::new(x * a, b, y * a)),
            &[[0, 1, 2], [0, 2, 3]],
        )
    };
    let mut world = world();
    floor(&mut world);
    // A room of meshes without thickness.
    let ceiling = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]].map(|[x, z]| Vec3::new(x, 0.0, z));
    fixed(&mut world, DVec3::Y * 6.0, Quat::IDENTITY, mesh(&ceiling, &[[0, 1, 2], [0, 2, 3]]));
    for (at, geometry) in [
        (DVec3::X * 5.0, wall(0.0, 1.0)),
        (DVec3::X * -5.0, wall(0.0, 1.0)),
        (DVec3::Z * 5.0, wall(1.0, 0.0)),
        (DVec3::Z * -5.0, wall(1.0, 0.0)),
    ] {
        fixed(&mut world, at, Quat::IDENTITY, geometry);
    }
    let mut random = Random(7);
    for speed in [20.0, 100.0, 1000.0, 1e5] {
        let mut character = standing(&world, DVec3::ZERO, CharacterSettings::default());
        for _ in 0..200 {
            let wish = Vec3::new(random.signed(), random.signed(), random.signed()) * speed;
            let report = walk(&mut character, &world, wish);
            let at = character.feet();
            let (side, top) = (at.x.abs().max(at.z.abs()), at.y + 1.82);
            assert!(side < 4.69 && at.y > -0.01 && top < 5.99, "{speed}: {at}");
            assert!(!is_inside(&character, &world) && report.overlap == 0.0);
        }
    }
}

/// A heap of everything, static and in motion.
fn crowd(random: &mut Random, moving: bool) -> World {
    let mut world = world();
    floor(&mut world);
    for i in 0..140 {
        let at = Vec3::new(8.0 * random.signed(), 3.0 * random.unit(), 8.0 * random.signed());
        let [x, y, z] = [0; 3].map(|_| 0.1 + 0.6 * random.unit());
        let geometry = match i % 5 {
            0 => Geometry::cuboid(x, y, z),
            1 => Geometry::Sphere { radius: x },
            2 => Geometry::capsule(y, x),
            3 => Geometry::cylinder(y, x),
            _ => common::flat_mesh(2, 0.5 * x),
        };
        let turn = random.rotation();
        if moving && i % 2 == 0 {
            let velocity = Vec3::new(random.signed(), 0.3 * random.signed(), random.signed()) * 2.0;
            let body = BodyDesc::kinematic()
                .with_position(at)
                .with_rotation(turn)
                .with_shape(ShapeDesc::new(geometry));
            world.add_body(&body.with_velocity(velocity, Vec3::ZERO)).unwrap();
        } else {
            fixed(&mut world, at.as_dvec3(), turn, geometry);
        }
    }
    world
}

/// A place where it is in nothing.
fn free_place(random: &mut Random, world: &World, settings: CharacterSettings) -> Character {
    loop {
        let at = DVec3::new(f64::from(7.0 * random.signed()), 3.0, f64::from(7.0 * random.signed()));
        let character = character_at(at, settings);
        if !is_inside(&character, world) {
            return character;
        }
    }
}

#[test]
fn in_a_crowd_it_is_never_in_anything() {
    let mut random = Random(11);
    let mut stuck = 0;
    for round in 0..12 {
        let world = crowd(&mut random, false);
        let settings = CharacterSettings { radius: 0.25, half_height: 0.3, ..CharacterSettings::default() };
        let mut character = free_place(&mut random, &world, settings);
        let mut last = Vec3::ZERO;
        let mut wish = Vec3::X;
        for step in 0..400 {
            if step % 20 == 0 {
                wish = Vec3::new(random.signed(), 0.0, random.signed()) * 8.0;
                if random.unit() < 0.3 {
                    last.y = 5.0;
                }
            }
            let before = character.position();
            let report = go(&mut character, &world, wish, &mut last);
            assert!(!is_inside(&character, &world), "round {round}, step {step}: {report:?}");
            assert!(report.overlap == 0.0);
            stuck += u32::from(character.position() == before);
        }
    }
    println!("stood still in {stuck} of 4800 steps");
}

#[test]
fn among_what_moves_it_gets_out_again() {
    let mut random = Random(5);
    let (mut deep, mut all) = (0, 0);
    for _ in 0..6 {
        let mut world = crowd(&mut random, true);
        let settings = CharacterSettings { radius: 0.25, half_height: 0.3, ..CharacterSettings::default() };
        let mut character = free_place(&mut random, &world, settings);
        let mut last = Vec3::ZERO;
        for _ in 0..300 {
            world.step(DT).unwrap();
            let wish = Vec3::new(random.signed(), 0.0, random.signed()) * 5.0;
            let report = go(&mut character, &world, wish, &mut last);
            // It reports an overlap wherever it is in something.
            assert!(report.overlap > 0.0 || !is_inside(&character, &world));
            assert!(character.feet().y > -0.5 && character.position().is_finite());
            all += 1;
            deep += u32::from(report.overlap > 0.0);
        }
    }
    println!("squeezed in {deep} of {all} steps");
    assert!(deep * 20 < all, "{deep} of {all}");
}

#[test]
fn many_walk_at_once_and_as_one_by_one() {
    let mut random = Random(3);
    let world = crowd(&mut random, false);
    let run = |i: u64| {
        let mut random = Random(100 + i);
        let mut character = free_place(&mut random, &world, CharacterSettings::default());
        let mut last = Vec3::ZERO;
        for _ in 0..200 {
            let wish = Vec3::new(random.signed(), 0.0, random.signed()) * 6.0;
            go(&mut character, &world, wish, &mut last);
        }
        character
    };
    let alone: Vec<Character> = (0..4).map(run).collect();
    let together: Vec<Character> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|i| scope.spawn(move || run(i))).collect();
        threads.into_iter().map(|t| t.join().unwrap()).collect()
    });
    assert_eq!(alone, together);
}
