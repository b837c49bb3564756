//! Stairs and steps.

use super::*;

/// Ten steps along x from the origin, then a landing, then ten down again.
pub(super) fn stairs(world: &mut World, rise: f32, tread: f32, as_mesh: bool) {
    floor(world);
    let top = 10.0 * rise;
    if !as_mesh {
        for i in 0..10 {
            let half = 0.5 * rise * (i + 1) as f32;
            let (x, length) = (tread * i as f32, tread * (10 - i) as f32 + 1.0);
            cuboid(world, [(x + length).into(), half.into(), 0.0], [length, half, 2.0]);
        }
        return;
    }
    let mut outline = vec![Vec2::ZERO];
    for i in 0..10 {
        let (x, y) = (tread * i as f32, rise * i as f32);
        outline.extend([Vec2::new(x, y + rise), Vec2::new(x + tread, y + rise)]);
    }
    let end = 20.0 * tread + 2.0;
    outline.push(Vec2::new(end - 10.0 * tread, top));
    for i in (0..10).rev() {
        let (x, y) = (end - tread * (i + 1) as f32, rise * i as f32);
        outline.extend([Vec2::new(x, y), Vec2::new(x + tread, y)]);
    }
    let corners: Vec<Vec3> = outline.iter().flat_map(|p| [p.extend(-2.0), p.extend(2.0)]).collect();
    let quads = 0..outline.len() as u32 - 1;
    let triangles: Vec<[u32; 3]> =
        quads.flat_map(|i| [[2 * i, 2 * i + 1, 2 * i + 2], [2 * i + 2, 2 * i + 1, 2 * i + 3]]).collect();
    fixed(world, DVec3::ZERO, Quat::IDENTITY, mesh(&corners, &triangles));
}

#[test]
fn it_climbs_stairs_and_comes_down_them_at_full_speed_with_its_feet_on_the_ground() {
    for as_mesh in [false, true] {
        for (rise, tread) in [(0.17, 0.29), (0.25, 0.25), (0.3, 0.6), (0.1, 0.3)] {
            for speed in [0.4, 3.0, 12.0] {
                let mut world = world();
                stairs(&mut world, rise, tread, as_mesh);
                let mut character =
                    standing(&world, DVec3::new(-1.0, 0.0, 0.0), CharacterSettings::default());
                let mut last = Vec3::ZERO;
                let (mut climbed, mut highest) = (0.0, 0.0_f64);
                let whole = 20.0 * tread + 4.0;
                let steps = (whole / speed / DT) as u32;
                for step in 1..=steps {
                    let report = go(&mut character, &world, Vec3::X * speed, &mut last);
                    let name = format!("{rise} {tread} {speed} mesh {as_mesh} at {}", character.feet());
                    assert!(report.ground.is_some(), "{name}");
                    assert!(!is_inside(&character, &world), "{name}");
                    let way = -1.0 + f64::from(speed) * f64::from(DT) * f64::from(step);
                    assert!((character.feet().x - way).abs() < 1e-3, "{name}: {way}");
                    climbed += report.stepped;
                    highest = highest.max(character.feet().y);
                }
                near(highest, (10.0 * rise).into(), 1e-3);
                near(character.feet().y, 0.0, 1e-3);
                // Lower edges the round bottom gets over by itself.
                assert!(rise < 0.11 || climbed > 0.0, "{rise} {tread}: {climbed}");
            }
        }
    }
}

#[test]
fn a_step_is_climbed_up_to_its_limit_and_no_further() {
    for (height, climbs) in
        [(0.15, true), (0.29, true), (0.2999, true), (0.3005, false), (0.4, false), (1.0, false)]
    {
        for speed in [0.3, 4.0] {
            let mut world = world();
            floor(&mut world);
            cuboid(&mut world, [5.0, 0.0, 0.0], [4.0, height, 4.0]);
            let mut character = standing(&world, DVec3::ZERO, CharacterSettings::default());
            let mut last = Vec3::ZERO;
            let steps = (2.0 / speed / DT) as u32;
            for _ in 0..steps {
                go(&mut character, &world, Vec3::X * speed, &mut last);
            }
            let expected = if climbs { (2.0, height) } else { (1.0 - 0.32, 0.0) };
            near(character.feet().x, expected.0, 0.08);
            near(character.feet().y, expected.1.into(), 1e-3);
        }
    }
    // Not under a ceiling, and not in the air.
    let mut world = world();
    floor(&mut world);
    cuboid(&mut world, [5.0, 0.0, 0.0], [4.0, 0.2, 4.0]);
    cuboid(&mut world, [0.0, 2.5, 0.0], [9.0, 0.55, 9.0]);
    let mut character = standing(&world, DVec3::ZERO, CharacterSettings::default());
    let mut last = Vec3::ZERO;
    (0..120).for_each(|_| _ = go(&mut character, &world, Vec3::X * 2.0, &mut last));
    // Its bottom gets onto the edge, as far as there is room for its head.
    assert!(
        character.feet().x < 0.8 && character.feet().y < 0.12 && !is_inside(&character, &world),
        "{}",
        character.feet()
    );
}
