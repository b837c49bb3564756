//! What a mover promises: it walks as far as geometry says, over steps and slopes up to its limits, goes along with moving
//! ground, and is never in anything.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use crate::common::random::Random;
use crate::common::{self, Floor};
use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::scene::Terrain;
use backstop::{
    BodyDesc, BodyHandle, Error, Geometry, HeightField, Material, Mover, MoverReport, MoverSettings,
    QueryFilter, Settings, ShapeCast, ShapeDesc, ShapeHandle, TriangleMesh, World,
};
use std::sync::Arc;

const DT: f32 = 1.0 / 60.0;
const G: f32 = 9.81;
/// What a cast leaves open, for each of a few casts [m].
const GAP: f64 = 3e-5;

fn world() -> World {
    World::new(Settings::default()).unwrap()
}

fn fixed(world: &mut World, at: DVec3, turn: Quat, geometry: Geometry) -> BodyHandle {
    let body = BodyDesc::fixed().at(at).rotated(turn);
    world.add_body(&body.with_shape(ShapeDesc::new(geometry))).unwrap()
}

fn cuboid(world: &mut World, at: [f64; 3], half: [f32; 3]) -> BodyHandle {
    fixed(world, at.into(), Quat::IDENTITY, Geometry::cuboid(half[0], half[1], half[2]))
}

fn floor(world: &mut World) -> BodyHandle {
    world.add_body(&Floor::Plane.desc(Material::default())).unwrap()
}

/// A mover with its feet at a point.
fn mover_at(feet: DVec3, settings: MoverSettings) -> Mover {
    let height = settings.half_height + settings.radius + settings.skin;
    Mover::new(settings, feet + settings.up.as_dvec3() * f64::from(height)).unwrap()
}

/// One that stands already.
fn standing(world: &World, feet: DVec3, settings: MoverSettings) -> Mover {
    let mut mover = mover_at(feet, settings);
    mover.walk(world, &QueryFilter::new(), -settings.up * 0.1, 1e-3).unwrap();
    assert!(mover.ground().is_some());
    mover
}

fn walk(mover: &mut Mover, world: &World, velocity: Vec3) -> MoverReport {
    mover.walk(world, &QueryFilter::new(), velocity, DT).unwrap()
}

/// What a game does: the wish across, gravity and what is left of a fall.
fn go(mover: &mut Mover, world: &World, wish: Vec3, last: &mut Vec3) -> MoverReport {
    let report = walk(mover, world, Vec3::new(wish.x, last.y - G * DT, wish.z));
    *last = report.velocity;
    report
}

/// Whether the capsule without its skin overlaps anything.
fn is_inside(mover: &Mover, world: &World) -> bool {
    let (capsule, rotation) = mover.capsule();
    world.overlap_any(&capsule, mover.position(), rotation, &QueryFilter::new()).unwrap()
}

#[track_caller]
fn near(a: f64, b: f64, within: f64) {
    assert!((a - b).abs() <= within, "{a} is not {b}");
}

fn mesh(corners: &[Vec3], triangles: &[[u32; 3]]) -> Geometry {
    Geometry::Mesh(Arc::new(TriangleMesh::new(corners.to_vec(), triangles.to_vec()).unwrap()))
}

#[test]
fn on_level_ground_it_walks_just_as_far_as_it_wants() {
    let field =
        Geometry::HeightField(Arc::new(HeightField::new(41, 41, Vec2::ONE, vec![0.0; 1681]).unwrap()));
    let floors = Floor::ALL.map(|floor| floor.desc(Material::default()));
    let field = BodyDesc::fixed().at(DVec3::new(-20.0, 0.0, -20.0)).with_shape(ShapeDesc::new(field));
    for floor in floors.into_iter().chain([field]) {
        let mut world = world();
        world.add_body(&floor).unwrap();
        let start = DVec3::new(-4.03, 0.0, -2.01);
        let mut mover = standing(&world, start, MoverSettings::default());
        let velocity = Vec3::new(4.0, -0.1, 1.7);
        for step in 1..=120 {
            let report = walk(&mut mover, &world, velocity);
            let way = DVec3::new(4.0, 0.0, f64::from(1.7_f32)) * f64::from(DT) * f64::from(step);
            near((mover.feet() - start).with_y(0.0).distance(way), 0.0, 1e-7);
            near(mover.feet().y, 0.0, GAP);
            let ground = report.ground.unwrap();
            assert!(ground.normal.distance(Vec3::Y) < 1e-4 && ground.velocity == Vec3::ZERO);
            assert_eq!(report.velocity, Vec3::new(4.0, 0.0, 1.7));
            assert_eq!(report.hits().count(), 0);
        }
    }
}

#[test]
fn along_a_wall_it_goes_as_far_as_its_wish_points_along_it() {
    let wall = mesh(
        &[[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]].map(|[x, y]| Vec3::new(x, y, 0.0)),
        &[[0, 1, 2], [0, 2, 3]],
    );
    for geometry in [Geometry::cuboid(9.0, 9.0, 0.5), wall] {
        let depth = if matches!(geometry, Geometry::Mesh(_)) { 0.0 } else { 0.5 };
        for degrees in [0.0_f32, 20.0, 45.0, 70.0, 133.0] {
            let mut world = world();
            floor(&mut world);
            let turn = common::turned(Vec3::Y, degrees);
            fixed(&mut world, DVec3::ZERO, turn, geometry.clone());
            let (along, out) = ((turn * Vec3::X).as_dvec3(), (turn * Vec3::Z).as_dvec3());
            let start = out * (depth + 0.32 + 0.001) - along * 2.0;
            let mut mover = standing(&world, start, MoverSettings::default());
            let wish = (along * 2.0 - out * 3.0).as_vec3();
            walk(&mut mover, &world, wish);
            let first = mover.position();
            let mut last = first;
            for step in 1..=60 {
                let report = walk(&mut mover, &world, wish);
                near((mover.position() - first).dot(along), f64::from(step) / 30.0, 1e-4);
                near(mover.position().dot(out), depth + 0.32, GAP);
                // Each step alike.
                near((mover.position() - last).length(), 1.0 / 30.0, 1e-5);
                assert!(report.velocity.distance((along * 2.0).as_vec3()) < 1e-3, "{report:?}");
                assert!(report.hits().all(|hit| hit.impulse == Vec3::ZERO));
                last = mover.position();
            }
        }
    }
}

#[test]
fn a_corner_stops_it_without_jitter() {
    for degrees in [90.0_f32, 60.0, 120.0, 20.0] {
        for as_mesh in [false, true] {
            let mut world = world();
            floor(&mut world);
            let half = 0.5 * degrees.to_radians();
            // Two walls that open towards -x, by so many degrees.
            let sides = [half, -half].map(|a| Vec3::new(-a.cos(), 0.0, a.sin()) * 8.0);
            if as_mesh {
                let (down, up) = (Vec3::NEG_Y, Vec3::Y * 4.0);
                let [a, b] = sides;
                let corners = [down, up, a + down, a + up, b + down, b + up];
                let walls = mesh(&corners, &[[0, 2, 1], [2, 3, 1], [0, 1, 4], [4, 1, 5]]);
                fixed(&mut world, DVec3::ZERO, Quat::IDENTITY, walls);
            } else {
                for (side, out) in sides.into_iter().zip([1.0, -1.0]) {
                    let turn = Quat::from_rotation_arc(Vec3::NEG_X, side.normalize());
                    let beside = turn * Vec3::new(0.0, 0.0, 0.5 * out);
                    let at = (0.5 * side + beside).as_dvec3();
                    fixed(&mut world, at, turn, Geometry::cuboid(6.0, 4.0, 0.5));
                }
            }
            let mut mover = standing(&world, DVec3::new(-5.0, 0.0, 0.1), MoverSettings::default());
            let mut last = Vec3::ZERO;
            for _ in 0..180 {
                go(&mut mover, &world, Vec3::new(5.0, 0.0, -0.4), &mut last);
            }
            let rest = mover.position();
            // As deep as a circle of its radius gets.
            near(rest.x, -0.32 / f64::from(half.sin()), 3e-3);
            for _ in 0..120 {
                let report = go(&mut mover, &world, Vec3::new(5.0, 0.0, -0.4), &mut last);
                near(mover.position().distance(rest), 0.0, 1e-4);
                assert!(report.ground.is_some() && report.velocity.length() < 1e-3, "{report:?}");
            }
            // And it gets out again.
            let report = go(&mut mover, &world, Vec3::new(-3.0, 0.0, 0.0), &mut last);
            near(report.moved.x.into(), -0.05, 1e-5);
        }
    }
}

/// Ten steps along x from the origin, then a landing, then ten down again.
fn stairs(world: &mut World, rise: f32, tread: f32, as_mesh: bool) {
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
                let mut mover = standing(&world, DVec3::new(-1.0, 0.0, 0.0), MoverSettings::default());
                let mut last = Vec3::ZERO;
                let (mut climbed, mut highest) = (0.0, 0.0_f64);
                let whole = 20.0 * tread + 4.0;
                let steps = (whole / speed / DT) as u32;
                for step in 1..=steps {
                    let report = go(&mut mover, &world, Vec3::X * speed, &mut last);
                    let name = format!("{rise} {tread} {speed} mesh {as_mesh} at {}", mover.feet());
                    assert!(report.ground.is_some(), "{name}");
                    assert!(!is_inside(&mover, &world), "{name}");
                    let way = -1.0 + f64::from(speed) * f64::from(DT) * f64::from(step);
                    assert!((mover.feet().x - way).abs() < 1e-3, "{name}: {way}");
                    climbed += report.stepped;
                    highest = highest.max(mover.feet().y);
                }
                near(highest, (10.0 * rise).into(), 1e-3);
                near(mover.feet().y, 0.0, 1e-3);
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
            let mut mover = standing(&world, DVec3::ZERO, MoverSettings::default());
            let mut last = Vec3::ZERO;
            let steps = (2.0 / speed / DT) as u32;
            for _ in 0..steps {
                go(&mut mover, &world, Vec3::X * speed, &mut last);
            }
            let expected = if climbs { (2.0, height) } else { (1.0 - 0.32, 0.0) };
            near(mover.feet().x, expected.0, 0.08);
            near(mover.feet().y, expected.1.into(), 1e-3);
        }
    }
    // Not under a ceiling, and not in the air.
    let mut world = world();
    floor(&mut world);
    cuboid(&mut world, [5.0, 0.0, 0.0], [4.0, 0.2, 4.0]);
    cuboid(&mut world, [0.0, 2.5, 0.0], [9.0, 0.55, 9.0]);
    let mut mover = standing(&world, DVec3::ZERO, MoverSettings::default());
    let mut last = Vec3::ZERO;
    (0..120).for_each(|_| _ = go(&mut mover, &world, Vec3::X * 2.0, &mut last));
    // Its bottom gets onto the edge, as far as there is room for its head.
    assert!(mover.feet().x < 0.8 && mover.feet().y < 0.12 && !is_inside(&mover, &world), "{}", mover.feet());
}

/// A ramp that rises along x from the origin.
fn ramp(world: &mut World, degrees: f32) {
    let turn = common::turned(Vec3::Z, degrees);
    let middle = turn * Vec3::new(20.0, -1.0, 0.0);
    fixed(world, middle.as_dvec3(), turn, Geometry::cuboid(20.0, 1.0, 5.0));
}

#[test]
fn slopes_cost_nothing_up_to_the_limit_and_are_walls_beyond() {
    for limit in [30.0_f32, 45.0, 50.0, 60.0] {
        let settings = MoverSettings { max_slope: limit.to_radians(), ..MoverSettings::default() };
        for (degrees, walks) in
            [(limit - 20.0, true), (limit, true), (limit + 0.1, false), (limit + 15.0, false)]
        {
            let mut world = world();
            floor(&mut world);
            ramp(&mut world, degrees);
            let mut mover = standing(&world, DVec3::NEG_X * 2.0, settings);
            let mut last = Vec3::ZERO;
            for _ in 0..120 {
                go(&mut mover, &world, Vec3::X * 3.0, &mut last);
                assert!(!is_inside(&mover, &world));
            }
            // Feet of a round bottom on a slope: where its circle touches.
            let (tangent, cosine) = (degrees.to_radians().tan(), degrees.to_radians().cos());
            let (tangent, round) = (f64::from(tangent), 0.32 * (f64::from(1.0 / cosine) - 1.0));
            if walks {
                near(mover.feet().x, 4.0, 1e-4);
                near(mover.feet().y, 4.0 * tangent + round, 1e-3);
                assert!(mover.ground().unwrap().normal.x < -0.1);
                // Down again without a hop, and it stands where it stops.
                for _ in 0..60 {
                    let report = go(&mut mover, &world, Vec3::X * -3.0, &mut last);
                    let y = mover.feet().x * tangent + round;
                    near(mover.feet().y, y, 1e-3);
                    assert!(report.ground.is_some());
                }
                let rest = mover.position();
                (0..60).for_each(|_| _ = go(&mut mover, &world, Vec3::ZERO, &mut last));
                near(mover.position().distance(rest), 0.0, 1e-5);
            } else {
                near(mover.feet().y, 0.0, 1e-3);
                assert!(mover.feet().x < 0.0);
                // Put on it, it slides down, whatever it wants.
                let up = DVec3::new(6.0, 6.0 * tangent + round, 0.0);
                mover = mover_at(up, settings);
                last = Vec3::ZERO;
                for _ in 0..150 {
                    go(&mut mover, &world, Vec3::X * 3.0, &mut last);
                    assert!(!is_inside(&mover, &world));
                }
                assert!(mover.feet().y < 2.0, "{limit} {degrees}: {}", mover.feet());
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
    let mut mover = Mover::new(MoverSettings::default(), DVec3::Y * 4.0).unwrap();
    let mut last = Vec3::ZERO;
    (0..120).for_each(|_| _ = go(&mut mover, &world, Vec3::ZERO, &mut last));
    for step in 1..=60 {
        let z = mover.position().z;
        let report = go(&mut mover, &world, Vec3::new(1.0, 0.0, 2.0), &mut last);
        assert!(report.ground.is_some(), "{step}: {report:?}");
        near(mover.position().z - z, 2.0 / 60.0, 1e-4);
    }
    // From there it can jump.
    let report = walk(&mut mover, &world, Vec3::Y * 3.0);
    assert!(report.ground.is_none() && report.moved.y > 0.04);
}

#[test]
fn moving_and_turning_ground_carries_it() {
    for before in [false, true] {
        let mut world = world();
        let plate = ShapeDesc::new(Geometry::cylinder(0.5, 6.0));
        let plate = world.add_body(&BodyDesc::kinematic().at(DVec3::Y * -0.5).with_shape(plate)).unwrap();
        let mut mover = standing(&world, DVec3::new(4.0, 0.0, 0.0), MoverSettings::default());
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
            let report = walk(&mut mover, &world, Vec3::NEG_Y * 0.1);
            if before {
                world.step(DT).unwrap();
            }
            turned += report.turned;
            assert!(report.ground.is_some() && report.hits().count() == 0);
            // As the world is when it is asked.
            let (centre, turn) = place(if before { t - dt } else { t });
            let expected = centre + (turn * Vec3::new(4.0, 0.5, 0.0)).as_dvec3();
            assert!(mover.feet().distance(expected) < 2e-3, "{step}: {} {expected}", mover.feet());
            let turned_by = 0.8 * if before { t - dt } else { t };
            near(turned.into(), turned_by, 1e-3);
        }
        // It jumps off with the ground's velocity, and lands with none over the ground.
        let velocity = world.linear_velocity(plate).unwrap();
        let spin = world.angular_velocity(plate).unwrap();
        let arm = (mover.feet() - world.position(plate).unwrap()).as_vec3();
        let report = walk(&mut mover, &world, Vec3::Y * 3.0);
        let expected = velocity + spin.cross(arm) + Vec3::Y * 3.0;
        assert!(report.ground.is_none() && report.velocity.distance(expected) < 0.1, "{report:?} {expected}");
        let mut velocity = report.velocity;
        world.set_velocity(plate, velocity.with_y(0.0), Vec3::ZERO).unwrap();
        let mut landed = None;
        for _ in 0..120 {
            world.step(DT).unwrap();
            velocity.y -= G * DT;
            let report = walk(&mut mover, &world, velocity);
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
    let plate = BodyDesc::kinematic().at(DVec3::Y * -0.5).with_shape(plate);
    let plate = world.add_body(&plate.moving(Vec3::X * 2.0, Vec3::ZERO)).unwrap();
    cuboid(&mut world, [4.0, 2.0, 0.0], [1.0, 1.5, 9.0]);
    let mut mover = standing(&world, DVec3::ZERO, MoverSettings::default());
    let mut last = Vec3::ZERO;
    for _ in 0..120 {
        world.step(DT).unwrap();
        let report = go(&mut mover, &world, Vec3::ZERO, &mut last);
        assert!(report.ground.is_some() && !is_inside(&mover, &world));
    }
    near(mover.feet().x, 3.0 - 0.32, 1e-3);
    world.remove_body(plate).unwrap();
    let report = go(&mut mover, &world, Vec3::ZERO, &mut last);
    assert!(report.ground.is_none());
}

#[test]
fn what_moves_into_it_pushes_it_out() {
    let mut world = world();
    floor(&mut world);
    let ram = ShapeDesc::new(Geometry::cuboid(1.0, 2.0, 2.0));
    let ram = BodyDesc::kinematic().at(DVec3::X * -3.0).with_shape(ram);
    world.add_body(&ram.moving(Vec3::X * 4.0, Vec3::ZERO)).unwrap();
    let mut mover = standing(&world, DVec3::ZERO, MoverSettings::default());
    let mut last = Vec3::ZERO;
    for step in 1..=90 {
        world.step(DT).unwrap();
        let report = go(&mut mover, &world, Vec3::ZERO, &mut last);
        let face = -2.0 + 4.0 * f64::from(DT) * f64::from(step);
        near(mover.feet().x, (face + 0.32).max(0.0), 1e-3);
        assert!(report.overlap == 0.0 && report.ground.is_some());
        assert_eq!(report.pushed_out.x > 0.0, face + 0.32 > 1e-3);
    }
    // Against a wall it is squeezed, says so, and stays in between.
    cuboid(&mut world, [mover.feet().x + 0.5 + 0.3, 0.0, 0.0], [0.3, 5.0, 5.0]);
    let mut deepest = 0.0_f32;
    for _ in 0..8 {
        world.step(DT).unwrap();
        let report = go(&mut mover, &world, Vec3::ZERO, &mut last);
        deepest = deepest.max(report.overlap);
        assert!(mover.position().is_finite());
    }
    assert!(deepest > 0.05, "{deepest}");
}

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
        let mut mover = standing(&world, DVec3::ZERO, MoverSettings::default());
        for _ in 0..200 {
            let wish = Vec3::new(random.signed(), random.signed(), random.signed()) * speed;
            let report = walk(&mut mover, &world, wish);
            let at = mover.feet();
            let (side, top) = (at.x.abs().max(at.z.abs()), at.y + 1.82);
            assert!(side < 4.69 && at.y > -0.01 && top < 5.99, "{speed}: {at}");
            assert!(!is_inside(&mover, &world) && report.overlap == 0.0);
        }
    }
}

#[test]
fn edges_inside_a_mesh_are_not_felt() {
    // Level, with small triangles: the height stays as it is, and nothing is run into.
    let mut flat = world();
    fixed(&mut flat, DVec3::ZERO, Quat::IDENTITY, common::flat_mesh(40, 0.25));
    let mut mover = standing(&flat, DVec3::new(-5.0, 0.0, -4.0), MoverSettings::default());
    let mut last = Vec3::ZERO;
    for _ in 0..150 {
        let report = go(&mut mover, &flat, Vec3::new(3.1, 0.0, 2.3), &mut last);
        near(mover.feet().y, 0.0, GAP);
        assert!(report.hits().count() == 0 && report.ground.is_some());
    }
    // Hills: always on the ground and no further from it than the skin, as fast across as on level ground.
    let terrain = Terrain::from_fn(128, 0.5, |x, z| (0.4 * x).sin() + 0.8 * (0.3 * z).cos());
    let (vertices, triangles) = terrain.mesh();
    let mut hills = world();
    fixed(&mut hills, DVec3::ZERO, Quat::IDENTITY, mesh(&vertices, &triangles));
    for speed in [1.5_f32, 5.0, 9.0] {
        let height = f64::from(terrain.height(-25.0, -20.0)) + 0.1;
        let mut mover = mover_at(DVec3::new(-25.0, height, -20.0), MoverSettings::default());
        let mut last = Vec3::ZERO;
        (0..30).for_each(|_| _ = go(&mut mover, &hills, Vec3::ZERO, &mut last));
        let (capsule, _) = mover.capsule();
        for _ in 0..(40.0 / speed / DT) as u32 {
            let report = go(&mut mover, &hills, Vec3::new(0.8, 0.0, 0.6) * speed, &mut last);
            let across = report.moved.with_y(0.0);
            assert!((across.length() - speed * DT).abs() < 1e-3 * speed * DT, "{report:?}");
            assert!(report.ground.is_some() && !is_inside(&mover, &hills));
            // The skin, along the steepest normal of these hills.
            let down = ShapeCast::new(&capsule, mover.position(), Vec3::NEG_Y * 0.03);
            assert!(hills.cast_shape_any(&down, &QueryFilter::new()).unwrap());
        }
    }
}

/// The builtin terrain has ridges and slopes of any steepness: never below it, and never in it.
#[test]
fn on_steep_and_ridged_terrain_it_is_never_in_anything() {
    let terrain = backstop::scene::builtin::talk_terrain();
    let (vertices, triangles) = terrain.mesh();
    let mut world = world();
    fixed(&mut world, DVec3::ZERO, Quat::IDENTITY, mesh(&vertices, &triangles));
    let mut random = Random(23);
    let (mut off, mut all) = (0, 0);
    for limit in [25.0_f32, 40.0, 50.0] {
        for _ in 0..8 {
            let settings = MoverSettings { max_slope: limit.to_radians(), ..MoverSettings::default() };
            let mut mover = mover_at(DVec3::Y * 6.0, settings);
            let mut last = Vec3::ZERO;
            let mut wish = Vec3::ZERO;
            for step in 0..400 {
                if step % 50 == 0 {
                    wish = Vec3::new(random.signed(), 0.0, random.signed()) * 9.0;
                }
                let report = go(&mut mover, &world, wish, &mut last);
                let at = mover.position().as_vec3();
                assert!(!is_inside(&mover, &world), "{limit} {step} {report:?}");
                assert!(f64::from(terrain.height(at.x, at.z)) < mover.feet().y + 0.4, "{at}");
                // Who falls long has got stuck where nothing counts as ground.
                assert!(last.y > -25.0, "{limit} {step} {at}");
                all += 1;
                off += u32::from(report.ground.is_none());
            }
        }
    }
    println!("in the air or on a steep slope in {off} of {all} steps");
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
            let body = BodyDesc::kinematic().at(at).rotated(turn).with_shape(ShapeDesc::new(geometry));
            world.add_body(&body.moving(velocity, Vec3::ZERO)).unwrap();
        } else {
            fixed(&mut world, at.as_dvec3(), turn, geometry);
        }
    }
    world
}

/// A place where it is in nothing.
fn free_place(random: &mut Random, world: &World, settings: MoverSettings) -> Mover {
    loop {
        let at = DVec3::new(f64::from(7.0 * random.signed()), 3.0, f64::from(7.0 * random.signed()));
        let mover = mover_at(at, settings);
        if !is_inside(&mover, world) {
            return mover;
        }
    }
}

#[test]
fn in_a_crowd_it_is_never_in_anything() {
    let mut random = Random(11);
    let mut stuck = 0;
    for round in 0..12 {
        let world = crowd(&mut random, false);
        let settings = MoverSettings { radius: 0.25, half_height: 0.3, ..MoverSettings::default() };
        let mut mover = free_place(&mut random, &world, settings);
        let mut last = Vec3::ZERO;
        let mut wish = Vec3::X;
        for step in 0..400 {
            if step % 20 == 0 {
                wish = Vec3::new(random.signed(), 0.0, random.signed()) * 8.0;
                if random.unit() < 0.3 {
                    last.y = 5.0;
                }
            }
            let before = mover.position();
            let report = go(&mut mover, &world, wish, &mut last);
            assert!(!is_inside(&mover, &world), "round {round}, step {step}: {report:?}");
            assert!(report.overlap == 0.0);
            stuck += u32::from(mover.position() == before);
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
        let settings = MoverSettings { radius: 0.25, half_height: 0.3, ..MoverSettings::default() };
        let mut mover = free_place(&mut random, &world, settings);
        let mut last = Vec3::ZERO;
        for _ in 0..300 {
            world.step(DT).unwrap();
            let wish = Vec3::new(random.signed(), 0.0, random.signed()) * 5.0;
            let report = go(&mut mover, &world, wish, &mut last);
            // What it says is what is.
            assert!(report.overlap > 0.0 || !is_inside(&mover, &world));
            assert!(mover.feet().y > -0.5 && mover.position().is_finite());
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
        let mut mover = free_place(&mut random, &world, MoverSettings::default());
        let mut last = Vec3::ZERO;
        for _ in 0..200 {
            let wish = Vec3::new(random.signed(), 0.0, random.signed()) * 6.0;
            go(&mut mover, &world, wish, &mut last);
        }
        mover
    };
    let alone: Vec<Mover> = (0..4).map(run).collect();
    let together: Vec<Mover> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|i| scope.spawn(move || run(i))).collect();
        threads.into_iter().map(|t| t.join().unwrap()).collect()
    });
    assert_eq!(alone, together);
}

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
fn a_ceiling_ends_a_jump_and_a_platform_may_be_passed_from_below() {
    let mut world = world();
    floor(&mut world);
    let plate = cuboid(&mut world, [0.0, 2.5, 0.0], [2.0, 0.1, 2.0]);
    let mut mover = standing(&world, DVec3::ZERO, MoverSettings::default());
    let first = walk(&mut mover, &world, Vec3::Y * 20.0);
    // From 1.82 m to 2.4 m there is 0.56 m and a gap.
    assert!(first.velocity.y == 20.0 && first.ground.is_none());
    let second = walk(&mut mover, &world, first.velocity);
    near(mover.feet().y, 2.4 - 1.84, GAP);
    assert!(second.velocity.y.abs() < 1e-3 && second.hits().next().unwrap().body == plate, "{second:?}");
    // One-way: seen by those above it only.
    let mut mover = standing(&world, DVec3::ZERO, MoverSettings::default());
    let mut velocity = Vec3::Y * 8.0;
    let mut highest = 0.0_f64;
    for _ in 0..180 {
        let above = mover.feet().y > 2.6 - 1e-3;
        let sees = |body: BodyHandle, _: ShapeHandle| body != plate || above;
        let report = mover.walk(&world, &QueryFilter::new().when(&sees), velocity, DT).unwrap();
        velocity = report.velocity - Vec3::Y * G * DT;
        highest = highest.max(mover.feet().y);
    }
    assert!(highest > 3.0);
    near(mover.feet().y, 2.6, 1e-3);
    assert_eq!(mover.ground().unwrap().body, plate);
}

#[test]
fn it_pushes_what_it_can_and_weighs_on_what_it_stands_on() {
    let mut world = world();
    floor(&mut world);
    let material = Material::default().with_friction(0.3);
    // 20 kg take 59 N to slide, 8 t more than it has.
    let add = |world: &mut World, at: DVec3, density: f32| {
        let shape = ShapeDesc { density, material, ..ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5)) };
        world.add_body(&BodyDesc::dynamic().at(at).with_shape(shape)).unwrap()
    };
    let light = add(&mut world, DVec3::new(2.0, 0.5, 0.0), 20.0);
    let heavy = add(&mut world, DVec3::new(2.0, 0.5, 6.0), 8000.0);
    let settings = MoverSettings { step_height: 0.0, ..MoverSettings::default() };
    let mut movers = [DVec3::ZERO, DVec3::Z * 6.0].map(|at| standing(&world, at, settings));
    let mut last = [Vec3::ZERO; 2];
    for _ in 0..180 {
        world.step(DT).unwrap();
        for (mover, last) in movers.iter_mut().zip(&mut last) {
            let report = go(mover, &world, Vec3::X * 2.0, last);
            report.push(&mut world).unwrap();
        }
    }
    assert!(world.position(light).unwrap().x > 4.0, "{}", world.position(light).unwrap());
    near(world.position(heavy).unwrap().x, 2.0, 1e-3);
    near(movers[1].feet().x, 1.5 - 0.32, 1e-3);
    // A seesaw goes down on the side where it stands.
    let beam = ShapeDesc { density: 50.0, ..ShapeDesc::new(Geometry::cuboid(2.0, 0.05, 0.5)) };
    let beam = world.add_body(&BodyDesc::dynamic().at(DVec3::new(0.0, 0.45, -9.0)).with_shape(beam)).unwrap();
    fixed(&mut world, DVec3::new(0.0, 0.2, -9.0), Quat::IDENTITY, Geometry::cuboid(0.05, 0.2, 0.5));
    let mut mover = standing(&world, DVec3::new(0.9, 0.5, -9.0), MoverSettings::default());
    let mut fall = Vec3::ZERO;
    for _ in 0..60 {
        world.step(DT).unwrap();
        go(&mut mover, &world, Vec3::ZERO, &mut fall).push(&mut world).unwrap();
    }
    let right = world.rotation(beam).unwrap() * Vec3::X;
    assert!(right.y < -0.05, "{right}");
    assert!(!is_inside(&mover, &world));
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
