//! Far from the origin, with any direction up, and refused input.

use super::*;

#[test]
fn far_from_the_origin_it_walks_as_near_it() {
    let run = |offset: DVec3| {
        let mut world = world();
        for (at, half) in [
            (DVec3::Y * -1.0, [20.0, 1.0, 20.0]),
            (DVec3::new(3.0, 0.1, 0.0), [1.0, 0.1, 3.0]),
            (DVec3::new(6.0, 1.0, 0.0), [0.5, 3.0, 9.0]),
        ] {
            let geometry = Geometry::cuboid(half[0], half[1], half[2]);
            fixed(&mut world, at + offset, Quat::IDENTITY, geometry);
        }
        let mut character = standing(&world, offset, CharacterSettings::default());
        let mut last = Vec3::ZERO;
        (0..150).for_each(|_| _ = go(&mut character, &world, Vec3::new(3.0, 0.0, 0.5), &mut last));
        character.position() - offset
    };
    let here = run(DVec3::ZERO);
    near(here.x, 5.5 - 0.32, 1e-3);
    for offset in [DVec3::new(1e6, 0.0, -1e6), DVec3::new(-3e6, 1e6, 2e6)] {
        near(run(offset).distance(here), 0.0, 1e-5);
    }
}

#[test]
fn bad_numbers_are_refused_and_change_nothing() {
    let mut world = world();
    floor(&mut world);
    let mut character = standing(&world, DVec3::ZERO, CharacterSettings::default());
    let before = character.clone();
    let all = QueryFilter::new();
    for velocity in [Vec3::NAN, Vec3::X * f32::INFINITY, Vec3::X * 1e30] {
        assert!(character.walk(&world, &all, velocity, DT).is_err());
    }
    for dt in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(character.walk(&world, &all, Vec3::X, dt).is_err());
    }
    assert!(character.set_position(DVec3::NAN).is_err());
    assert_eq!(character, before);
    assert!(matches!(Character::new(CharacterSettings::default(), DVec3::NAN), Err(Error::NotFinite { .. })));
    let good = CharacterSettings::default;
    for bad in [
        CharacterSettings { radius: 0.0, ..good() },
        CharacterSettings { half_height: -1.0, ..good() },
        CharacterSettings { skin: 0.0, ..good() },
        CharacterSettings { skin: 1.0, ..good() },
        CharacterSettings { max_slope: f32::NAN, ..good() },
        CharacterSettings { step_height: -0.1, ..good() },
        CharacterSettings { snap: f32::INFINITY, ..good() },
        CharacterSettings { iterations: 0, ..good() },
        CharacterSettings { up: Vec3::ZERO, ..good() },
        CharacterSettings { mass: -1.0, ..good() },
        CharacterSettings { strength: f32::NAN, ..good() },
    ] {
        assert!(Character::new(bad, DVec3::ZERO).is_err() && character.set_settings(bad).is_err(), "{bad:?}");
    }
}

#[test]
fn up_may_be_any_direction() {
    for up in [Vec3::X, Vec3::NEG_Y, Vec3::new(1.0, 2.0, -0.5).normalize()] {
        let mut world = world();
        let turn = Quat::from_rotation_arc(Vec3::Y, up);
        fixed(&mut world, DVec3::ZERO, turn, Geometry::cuboid(20.0, 1.0, 20.0));
        let settings = CharacterSettings { up, ..CharacterSettings::default() };
        let mut character = standing(&world, up.as_dvec3(), settings);
        let along = turn * Vec3::X;
        for _ in 0..60 {
            let report = walk(&mut character, &world, along * 3.0 - up);
            assert!(report.ground.is_some());
        }
        near(character.feet().distance((up + along * 3.0).as_dvec3()), 0.0, 1e-4);
    }
}
