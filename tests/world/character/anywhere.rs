//! Far from the origin, with any direction up, and what is refused.

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
        let mut mover = standing(&world, offset, MoverSettings::default());
        let mut last = Vec3::ZERO;
        (0..150).for_each(|_| _ = go(&mut mover, &world, Vec3::new(3.0, 0.0, 0.5), &mut last));
        mover.position() - offset
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
    let mut mover = standing(&world, DVec3::ZERO, MoverSettings::default());
    let before = mover.clone();
    let all = QueryFilter::new();
    for velocity in [Vec3::NAN, Vec3::X * f32::INFINITY, Vec3::X * 1e30] {
        assert!(mover.walk(&world, &all, velocity, DT).is_err());
    }
    for dt in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(mover.walk(&world, &all, Vec3::X, dt).is_err());
    }
    assert!(mover.place(DVec3::NAN).is_err());
    assert_eq!(mover, before);
    assert!(matches!(Mover::new(MoverSettings::default(), DVec3::NAN), Err(Error::NotFinite { .. })));
    let good = MoverSettings::default;
    for bad in [
        MoverSettings { radius: 0.0, ..good() },
        MoverSettings { half_height: -1.0, ..good() },
        MoverSettings { skin: 0.0, ..good() },
        MoverSettings { skin: 1.0, ..good() },
        MoverSettings { max_slope: f32::NAN, ..good() },
        MoverSettings { step_height: -0.1, ..good() },
        MoverSettings { snap: f32::INFINITY, ..good() },
        MoverSettings { iterations: 0, ..good() },
        MoverSettings { up: Vec3::ZERO, ..good() },
        MoverSettings { mass: -1.0, ..good() },
        MoverSettings { strength: f32::NAN, ..good() },
    ] {
        assert!(Mover::new(bad, DVec3::ZERO).is_err() && mover.set_settings(bad).is_err(), "{bad:?}");
    }
}

#[test]
fn up_may_be_any_direction() {
    for up in [Vec3::X, Vec3::NEG_Y, Vec3::new(1.0, 2.0, -0.5).normalize()] {
        let mut world = world();
        let turn = Quat::from_rotation_arc(Vec3::Y, up);
        fixed(&mut world, DVec3::ZERO, turn, Geometry::cuboid(20.0, 1.0, 20.0));
        let settings = MoverSettings { up, ..MoverSettings::default() };
        let mut mover = standing(&world, up.as_dvec3(), settings);
        let along = turn * Vec3::X;
        for _ in 0..60 {
            let report = walk(&mut mover, &world, along * 3.0 - up);
            assert!(report.ground.is_some());
        }
        near(mover.feet().distance((up + along * 3.0).as_dvec3()), 0.0, 1e-4);
    }
}
