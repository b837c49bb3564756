//! Characters of other shapes than a capsule: boxes, cylinders, hulls.

use super::*;
use backstop::ConvexHull;

const HALF: Vec3 = Vec3::new(0.3, 0.9, 0.3);
const SKIN: f64 = 0.02;

/// As tall and as wide as the default capsule.
fn forms() -> [(&'static str, Geometry); 3] {
    let corner = |i: u32| {
        let sign = |bit: u32| if i & bit == 0 { -1.0 } else { 1.0 };
        // Its origin is in the middle of a side, not in its own middle.
        Vec3::new(sign(1), sign(2), sign(4)) * HALF + Vec3::X * HALF.x
    };
    let corners: Vec<Vec3> = (0..8).map(corner).collect();
    [
        ("box", Geometry::cuboid(HALF.x, HALF.y, HALF.z)),
        ("cylinder", Geometry::cylinder(HALF.y, HALF.x)),
        ("hull", Geometry::Hull(Arc::new(ConvexHull::new(&corners).unwrap()))),
    ]
}

/// A character of a shape with its feet at a point.
fn shaped_at(feet: DVec3, form: &Geometry, settings: CharacterSettings) -> Character {
    let mut character = Character::new(settings, DVec3::ZERO).unwrap().with_shape(form.clone()).unwrap();
    let below = character.feet();
    character.set_position(feet - below).unwrap();
    character
}

fn shaped(world: &World, feet: DVec3, form: &Geometry) -> Character {
    let mut character = shaped_at(feet, form, CharacterSettings::default());
    character.walk(world, &QueryFilter::new(), Vec3::NEG_Y * 0.1, 1e-3).unwrap();
    assert!(character.ground().is_some());
    character
}

fn is_in_anything(character: &Character, world: &World) -> bool {
    let (shape, rotation) = character.shape();
    world.overlap_any(&shape, character.position(), rotation, &QueryFilter::new()).unwrap()
}

/// Expected: the way of level ground, and heights of the treads (geometry).
#[test]
fn boxes_and_cylinders_climb_stairs_and_come_down_them() {
    for (name, form) in forms() {
        for as_mesh in [false, true] {
            for (rise, tread) in [(0.17, 0.29), (0.25, 0.6)] {
                for speed in [0.7, 3.0, 9.0] {
                    let mut world = world();
                    stairs::stairs(&mut world, rise, tread, as_mesh);
                    let mut character = shaped(&world, DVec3::new(-1.0, 0.0, 0.0), &form);
                    let (mut last, mut highest) = (Vec3::ZERO, 0.0_f64);
                    let steps = ((20.0 * tread + 4.0) / speed / DT) as u32;
                    for step in 1..=steps {
                        let report = go(&mut character, &world, Vec3::X * speed, &mut last);
                        let at = character.feet();
                        let name = format!("{name} {rise} {tread} {speed} mesh {as_mesh} at {at}");
                        assert!(report.ground.is_some(), "{name}");
                        assert!(!is_in_anything(&character, &world), "{name}");
                        let way = -1.0 + f64::from(speed) * f64::from(DT) * f64::from(step);
                        assert!((at.x - way).abs() < 2e-3, "{name}: {way}");
                        highest = highest.max(at.y);
                    }
                    near(highest, (10.0 * rise).into(), 1e-3);
                    near(character.feet().y, 0.0, 1e-3);
                }
            }
        }
    }
}

/// Expected: steps by the limit of the settings; the box's lower edge with its round skin on a slope touches
/// `w tan a + s (1 / cos a - 1)` above the slope below its middle.
#[test]
fn steps_and_slopes_have_the_limits_of_the_settings() {
    for (name, form) in forms() {
        for (height, climbs) in [(0.15, true), (0.2999, true), (0.31, false), (1.0, false)] {
            let mut world = world();
            floor(&mut world);
            cuboid(&mut world, [5.0, 0.0, 0.0], [4.0, height, 4.0]);
            let mut character = shaped(&world, DVec3::ZERO, &form);
            let mut last = Vec3::ZERO;
            (0..120).for_each(|_| _ = go(&mut character, &world, Vec3::X, &mut last));
            let expected = if climbs { (2.0, height) } else { (1.0 - 0.32, 0.0) };
            near(character.feet().x, expected.0, 2e-3);
            near(character.feet().y, expected.1.into(), 1e-3);
        }
        for (degrees, walks) in [(30.0_f32, true), (49.0, true), (51.0, false)] {
            let mut world = world();
            floor(&mut world);
            let turn = common::turned(Vec3::Z, degrees);
            let middle = turn * Vec3::new(20.0, -1.0, 0.0);
            fixed(&mut world, middle.as_dvec3(), turn, Geometry::cuboid(20.0, 1.0, 5.0));
            let mut character = shaped(&world, DVec3::NEG_X * 2.0, &form);
            let mut last = Vec3::ZERO;
            for _ in 0..120 {
                go(&mut character, &world, Vec3::X * 3.0, &mut last);
                assert!(!is_in_anything(&character, &world), "{name} {degrees}");
            }
            let (tangent, cosine) = (f64::from(degrees.to_radians().tan()), degrees.to_radians().cos());
            if walks {
                let above = 0.3 * tangent + SKIN * (1.0 / f64::from(cosine) - 1.0);
                near(character.feet().x, 4.0, 2e-3);
                near(character.feet().y, 4.0 * tangent + above, 5e-3);
                let rest = character.position();
                (0..60).for_each(|_| _ = go(&mut character, &world, Vec3::ZERO, &mut last));
                near(character.position().distance(rest), 0.0, 1e-5);
            } else {
                assert!(character.feet().x < 0.0 && character.feet().y < 1e-3, "{name} {degrees}");
            }
        }
    }
}

/// Expected: kinematics of the plate; a jump ends where the head meets the ceiling; off a ledge it is on its
/// face until its whole width is beyond the edge.
#[test]
fn platforms_ceilings_and_ledges() {
    for (name, form) in forms() {
        let mut carried = world();
        let plate = ShapeDesc::new(Geometry::cylinder(0.5, 6.0));
        let plate = carried
            .add_body(&BodyDesc::kinematic().with_position(DVec3::Y * -0.5).with_shape(plate))
            .unwrap();
        let mut character = shaped(&carried, DVec3::new(4.0, 0.0, 0.0), &form);
        let mut turned = 0.0;
        for step in 1..=180 {
            let t = f64::from(DT) * f64::from(step);
            let turn = Quat::from_rotation_y(0.8 * t as f32);
            let centre = DVec3::new(3.0 * (0.7 * t).sin(), -0.5 + (0.9 * t).sin(), 1.2 * t);
            carried.move_kinematic(plate, centre, turn, DT).unwrap();
            carried.step(DT).unwrap();
            turned += walk(&mut character, &carried, Vec3::NEG_Y * 0.1).turned;
            let expected = centre + (turn * Vec3::new(4.0, 0.5, 0.0)).as_dvec3();
            let off = character.feet().distance(expected);
            assert!(off < 2e-3, "{name} {step}: {} {expected}", character.feet());
            near(turned.into(), 0.8 * t, 1e-3);
        }

        let mut low = world();
        floor(&mut low);
        cuboid(&mut low, [0.0, 3.0, 0.0], [4.0, 0.5, 4.0]);
        let mut character = shaped(&low, DVec3::ZERO, &form);
        let mut velocity = Vec3::Y * 6.0;
        let mut highest = 0.0_f64;
        for _ in 0..60 {
            velocity = walk(&mut character, &low, velocity - Vec3::Y * G * DT).velocity;
            highest = highest.max(character.feet().y);
        }
        // Height and skin at both ends under the ceiling at 2.5 m.
        near(highest, 2.5 - 1.84, 1e-4);
        near(character.feet().y, 0.0, 1e-3);

        let mut ledge = world();
        floor(&mut ledge);
        cuboid(&mut ledge, [-5.0, 1.0, 0.0], [5.0, 1.0, 4.0]);
        let mut character = shaped(&ledge, DVec3::new(-1.0, 2.0, 0.0), &form);
        let mut last = Vec3::ZERO;
        for _ in 0..90 {
            go(&mut character, &ledge, Vec3::X, &mut last);
            let at = character.feet();
            assert!((at.y - 2.0).abs() < 1e-3 || at.x > 0.27, "{name}: {at}");
            assert!(!is_in_anything(&character, &ledge), "{name}: {at}");
        }
        (0..60).for_each(|_| _ = go(&mut character, &ledge, Vec3::X, &mut last));
        near(character.feet().y, 0.0, 1e-3);
    }
}

/// Expected: the impact of two free bodies, within the strength times the step.
#[test]
fn it_pushes_and_is_pushed_out() {
    for (name, form) in forms() {
        let mut world = world();
        floor(&mut world);
        // 30 kg: its friction is below the strength.
        let crate_ = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5)).with_density(30.0);
        let crate_ =
            world.add_body(&BodyDesc::dynamic().with_position(DVec3::new(1.2, 0.5, 0.0)).with_shape(crate_));
        let crate_ = crate_.unwrap();
        let mut character = shaped(&world, DVec3::ZERO, &form);
        let mut last = Vec3::ZERO;
        for _ in 0..120 {
            let report = go(&mut character, &world, Vec3::X * 2.0, &mut last);
            assert!(report.hits().all(|hit| hit.impulse.length() <= 500.0 * DT * 1.0001), "{name}");
            report.push(&mut world).unwrap();
            world.step(DT).unwrap();
        }
        assert!(world.position(crate_).unwrap().x > 1.3, "{name}");
        assert!(character.feet().x > 0.4, "{name}: {}", character.feet());

        // A wall that closes in at 1 m/s pushes it along.
        let wall = ShapeDesc::new(Geometry::cuboid(0.2, 2.0, 4.0));
        let wall =
            world.add_body(&BodyDesc::kinematic().with_position(DVec3::new(-2.0, 2.0, 0.0)).with_shape(wall));
        let wall = wall.unwrap();
        let mut character = shaped(&world, DVec3::new(-1.0, 0.0, 2.0), &form);
        world.set_velocity(wall, Vec3::X, Vec3::ZERO).unwrap();
        for _ in 0..120 {
            world.step(DT).unwrap();
            walk(&mut character, &world, Vec3::NEG_Y * 0.1);
            let gap = character.feet().x - world.position(wall).unwrap().x - 0.2;
            assert!(gap > 0.32 - 1e-4, "{name} {gap}");
        }
        near(world.position(wall).unwrap().x, 0.0, 1e-3);
    }
}

/// Expected: by promise; a cast goes through nothing, at any length of its path.
#[test]
fn nothing_gets_through_the_floor_at_any_rate() {
    let mut random = Random(5);
    let ceiling = mesh(
        &[[-40.0, -40.0], [40.0, -40.0], [40.0, 40.0], [-40.0, 40.0]].map(|[x, z]| Vec3::new(x, 0.0, z)),
        &[[0, 2, 1], [0, 3, 2]],
    );
    let plate = Geometry::cuboid(40.0, 0.01, 40.0);
    for (name, form) in forms() {
        for floor in [ceiling.clone(), plate.clone()] {
            for rate in [2.0, 5.0, 12.0, 30.0, 60.0_f32] {
                let mut world = world();
                fixed(&mut world, DVec3::ZERO, Quat::IDENTITY, floor.clone());
                for i in 0..6_u8 {
                    let at = [f64::from(i) * 3.0 - 9.0, 0.1 * f64::from(i), 2.0];
                    cuboid(&mut world, at, [0.7, 0.15, 0.7]);
                }
                let mut character = shaped_at(DVec3::Y * 3.0, &form, CharacterSettings::default());
                let (mut velocity, mut wish) = (Vec3::NEG_Y * 60.0, Vec3::ZERO);
                for step in 0..(20.0 * rate) as u32 {
                    if step % 8 == 0 {
                        wish = Vec3::new(random.signed(), 0.0, random.signed()) * 5.0;
                    }
                    let jump = if step % 31 == 30 { 5.0 } else { velocity.y };
                    let asked = Vec3::new(wish.x, jump - G / rate, wish.z);
                    let report = character.walk(&world, &QueryFilter::new(), asked, 1.0 / rate).unwrap();
                    velocity = report.velocity;
                    let at = character.feet();
                    assert!(at.y > -0.01, "{name} {rate} {step}: {at}");
                    assert!(!is_in_anything(&character, &world), "{name} {rate} {step}: {at}");
                    if at.x.abs().max(at.z.abs()) > 30.0 {
                        let up = character.position().y;
                        character.set_position(DVec3::new(0.0, up, -5.0)).unwrap();
                    }
                }
            }
        }
    }
}

/// Expected: a capsule as a shape of its own is the capsule of the settings, up to the rounding of its skin.
#[test]
fn a_capsule_of_its_own_walks_as_the_capsule_of_the_settings() {
    let mut world = world();
    stairs::stairs(&mut world, 0.17, 0.29, true);
    let start = DVec3::new(-1.0, 0.0, 0.0);
    let mut one = standing(&world, start, CharacterSettings::default());
    let mut other = shaped(&world, start, &Geometry::capsule(0.6, 0.3));
    let mut last = [Vec3::ZERO; 2];
    for _ in 0..240 {
        go(&mut one, &world, Vec3::X * 2.0, &mut last[0]);
        go(&mut other, &world, Vec3::X * 2.0, &mut last[1]);
        near(one.feet().distance(other.feet()), 0.0, 1e-3);
    }
    assert_eq!(one.shape().1, one.capsule().1);
    assert!(matches!(one.shape().0, Geometry::Capsule { half_height: 0.6, .. }));
}

/// Expected: a box 2 m long and 0.4 m wide fits through a gap of 1 m if it is turned along it.
#[test]
fn its_orientation_counts() {
    let settings = CharacterSettings::default();
    for (up, wish) in [(Vec3::Y, Vec3::X), (Vec3::Z, Vec3::X)] {
        for turned in [false, true] {
            let mut world = world();
            let straight = Quat::from_rotation_arc(Vec3::Y, up);
            fixed(&mut world, DVec3::ZERO, straight, Geometry::Plane);
            for side in [-1.0_f64, 1.0] {
                let at = straight * Vec3::new(3.0, 0.0, 2.5 * side as f32);
                fixed(&mut world, at.as_dvec3(), straight, Geometry::cuboid(0.5, 3.0, 2.0));
            }
            let form = Geometry::cuboid(0.2, 0.9, 1.0);
            let settings = CharacterSettings { up, ..settings };
            let mut character = shaped_at(DVec3::ZERO, &form, settings);
            if turned {
                let quarter = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
                character.set_rotation(quarter).unwrap();
                assert_eq!(character.rotation(), quarter.normalize());
            }
            for _ in 0..180 {
                walk(&mut character, &world, wish * 2.0 - up * 0.2);
                assert!(!is_in_anything(&character, &world));
            }
            let x = character.feet().x;
            near(x, if turned { 6.0 } else { 2.5 - 0.22 }, 1e-3);
        }
    }
    let mut character = Character::new(settings, DVec3::ZERO).unwrap();
    let flat = mesh(&[Vec3::ZERO, Vec3::X, Vec3::Z], &[[0, 1, 2]]);
    assert!(matches!(character.set_shape(Some(flat)), Err(Error::NotConvex { .. })));
    assert!(character.set_shape(Some(Geometry::sphere(-1.0))).is_err());
    assert!(character.set_rotation(Quat::from_xyzw(0.0, 0.0, 0.0, 2.0)).is_err());
    assert_eq!(character, Character::new(settings, DVec3::ZERO).unwrap());
}

/// Expected: as for the capsule, by promise.
#[test]
fn on_ridged_terrain_a_box_is_never_in_anything() {
    let (vertices, triangles) = backstop_scene::builtin::talk_terrain().mesh();
    let mut world = world();
    fixed(&mut world, DVec3::ZERO, Quat::IDENTITY, mesh(&vertices, &triangles));
    let mut random = Random(29);
    for (name, form) in forms() {
        for run in 0..4 {
            let mut character = shaped_at(DVec3::Y * 6.0, &form, CharacterSettings::default());
            let (mut last, mut wish) = (Vec3::ZERO, Vec3::ZERO);
            for step in 0..400 {
                if step % 50 == 0 {
                    wish = Vec3::new(random.signed(), 0.0, random.signed()) * 7.0;
                }
                let report = go(&mut character, &world, wish, &mut last);
                assert!(!is_in_anything(&character, &world), "{name} {run} {step} {report:?}");
                assert!(last.y > -25.0, "{name} {run} {step} {}", character.feet());
            }
        }
    }
}
