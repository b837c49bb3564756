//! Slopes, edges of meshes, and rough terrain.

use super::*;

/// A ramp that rises along x from the origin.
fn ramp(world: &mut World, degrees: f32) {
    let turn = common::turned(Vec3::Z, degrees);
    let middle = turn * Vec3::new(20.0, -1.0, 0.0);
    fixed(world, middle.as_dvec3(), turn, Geometry::cuboid(20.0, 1.0, 5.0));
}

#[test]
fn slopes_cost_nothing_up_to_the_limit_and_are_walls_beyond() {
    for limit in [30.0_f32, 45.0, 50.0, 60.0] {
        let settings = CharacterSettings { max_slope: limit.to_radians(), ..CharacterSettings::default() };
        for (degrees, walks) in
            [(limit - 20.0, true), (limit, true), (limit + 0.1, false), (limit + 15.0, false)]
        {
            let mut world = world();
            floor(&mut world);
            ramp(&mut world, degrees);
            let mut character = standing(&world, DVec3::NEG_X * 2.0, settings);
            let mut last = Vec3::ZERO;
            for _ in 0..120 {
                go(&mut character, &world, Vec3::X * 3.0, &mut last);
                assert!(!is_inside(&character, &world));
            }
            // Feet of a round bottom on a slope: where its circle touches.
            let (tangent, cosine) = (degrees.to_radians().tan(), degrees.to_radians().cos());
            let (tangent, round) = (f64::from(tangent), 0.32 * (f64::from(1.0 / cosine) - 1.0));
            if walks {
                near(character.feet().x, 4.0, 1e-4);
                near(character.feet().y, 4.0 * tangent + round, 1e-3);
                assert!(character.ground().unwrap().normal.x < -0.1);
                // Down again without a hop, and it stands where it stops.
                for _ in 0..60 {
                    let report = go(&mut character, &world, Vec3::X * -3.0, &mut last);
                    let y = character.feet().x * tangent + round;
                    near(character.feet().y, y, 1e-3);
                    assert!(report.ground.is_some());
                }
                let rest = character.position();
                (0..60).for_each(|_| _ = go(&mut character, &world, Vec3::ZERO, &mut last));
                near(character.position().distance(rest), 0.0, 1e-5);
            } else {
                near(character.feet().y, 0.0, 1e-3);
                assert!(character.feet().x < 0.0);
                // Put on it, it slides down, with any wish.
                let up = DVec3::new(6.0, 6.0 * tangent + round, 0.0);
                character = character_at(up, settings);
                last = Vec3::ZERO;
                for _ in 0..150 {
                    go(&mut character, &world, Vec3::X * 3.0, &mut last);
                    assert!(!is_inside(&character, &world));
                }
                assert!(character.feet().y < 2.0, "{limit} {degrees}: {}", character.feet());
            }
        }
    }
}

#[test]
fn in_a_gutter_of_steep_slopes_it_stands() {
    let mut world = world();
    for degrees in [65.0, -65.0] {
        let turn = common::turned(Vec3::Z, degrees);
        let at = turn * Vec3::new(0.0, -1.0, 0.0);
        fixed(&mut world, at.as_dvec3(), turn, Geometry::cuboid(9.0, 1.0, 20.0));
    }
    let mut character = Character::new(CharacterSettings::default(), DVec3::Y * 4.0).unwrap();
    let mut last = Vec3::ZERO;
    (0..120).for_each(|_| _ = go(&mut character, &world, Vec3::ZERO, &mut last));
    for step in 1..=60 {
        let z = character.position().z;
        let report = go(&mut character, &world, Vec3::new(1.0, 0.0, 2.0), &mut last);
        assert!(report.ground.is_some(), "{step}: {report:?}");
        near(character.position().z - z, 2.0 / 60.0, 1e-4);
    }
    // From there it can jump.
    let report = walk(&mut character, &world, Vec3::Y * 3.0);
    assert!(report.ground.is_none() && report.moved.y > 0.04);
}

#[test]
fn edges_inside_a_mesh_are_not_felt() {
    // Level, with small triangles: the height stays as it is, and nothing is run into.
    let mut flat = world();
    fixed(&mut flat, DVec3::ZERO, Quat::IDENTITY, common::flat_mesh(40, 0.25));
    let mut character = standing(&flat, DVec3::new(-5.0, 0.0, -4.0), CharacterSettings::default());
    let mut last = Vec3::ZERO;
    for _ in 0..150 {
        let report = go(&mut character, &flat, Vec3::new(3.1, 0.0, 2.3), &mut last);
        near(character.feet().y, 0.0, GAP);
        assert!(report.hits().count() == 0 && report.ground.is_some());
    }
    // Hills: always on the ground and no further from it than the skin, as fast across as on level ground.
    let terrain = Terrain::from_fn(128, 0.5, |x, z| (0.4 * x).sin() + 0.8 * (0.3 * z).cos());
    let (vertices, triangles) = terrain.mesh();
    let mut hills = world();
    fixed(&mut hills, DVec3::ZERO, Quat::IDENTITY, mesh(&vertices, &triangles));
    for speed in [1.5_f32, 5.0, 9.0] {
        let height = f64::from(terrain.height(-25.0, -20.0)) + 0.1;
        let mut character = character_at(DVec3::new(-25.0, height, -20.0), CharacterSettings::default());
        let mut last = Vec3::ZERO;
        (0..30).for_each(|_| _ = go(&mut character, &hills, Vec3::ZERO, &mut last));
        let (capsule, _) = character.capsule();
        for _ in 0..(40.0 / speed / DT) as u32 {
            let report = go(&mut character, &hills, Vec3::new(0.8, 0.0, 0.6) * speed, &mut last);
            let across = report.moved.with_y(0.0);
            assert!((across.length() - speed * DT).abs() < 1e-3 * speed * DT, "{report:?}");
            assert!(report.ground.is_some() && !is_inside(&character, &hills));
            // The skin, along the steepest normal of these hills.
            let down = ShapeCast::new(&capsule, character.position(), Vec3::NEG_Y * 0.03);
            assert!(hills.cast_shape_any(&down, &QueryFilter::new()).unwrap());
        }
    }
}

/// The builtin terrain has ridges and slopes of any steepness: never below it, and never in it.
#[test]
fn on_steep_and_ridged_terrain_it_is_never_in_anything() {
    let terrain = backstop_scene::builtin::talk_terrain();
    let (vertices, triangles) = terrain.mesh();
    let mut world = world();
    fixed(&mut world, DVec3::ZERO, Quat::IDENTITY, mesh(&vertices, &triangles));
    let mut random = Random(23);
    let (mut off, mut all) = (0, 0);
    for limit in [25.0_f32, 40.0, 50.0] {
        for _ in 0..8 {
            let settings =
                CharacterSettings { max_slope: limit.to_radians(), ..CharacterSettings::default() };
            let mut character = character_at(DVec3::Y * 6.0, settings);
            let mut last = Vec3::ZERO;
            let mut wish = Vec3::ZERO;
            for step in 0..400 {
                if step % 50 == 0 {
                    wish = Vec3::new(random.signed(), 0.0, random.signed()) * 9.0;
                }
                let report = go(&mut character, &world, wish, &mut last);
                let at = character.position().as_vec3();
                assert!(!is_inside(&character, &world), "{limit} {step} {report:?}");
                assert!(f64::from(terrain.height(at.x, at.z)) < character.feet().y + 0.4, "{at}");
                // A character that falls for long has got stuck where nothing counts as ground.
                assert!(last.y > -25.0, "{limit} {step} {at}");
                all += 1;
                off += u32::from(report.ground.is_none());
            }
        }
    }
    println!("in the air or on a steep slope in {off} of {all} steps");
}
