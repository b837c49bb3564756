//! Steps, walls, corners and gaps are felt, as they are no seams; and a lift of pieces is one surface too.

use super::RATES;
use super::floors::rough;
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, BodyHandle, Geometry, Settings, World};

/// A row of boxes of `edge` metres from -2 m on along x, with its top at `top`, and their number.
fn row(world: &mut World, edge: f32, from: f32, to: f32, top: f32) {
    let mut x = from;
    while x < to {
        for k in -2..=2 {
            let at = Vec3::new(x + 0.5 * edge, top - 0.5 * edge, k as f32 * edge);
            let half = 0.5 * edge;
            let shape = rough(Geometry::cuboid(half, half, half), 0.0);
            world.add_body(&BodyDesc::fixed().with_position(at.as_dvec3()).with_shape(shape)).unwrap();
        }
        x += edge;
    }
}

fn push(world: &mut World, geometry: Geometry, height: f32, speed: f32) -> BodyHandle {
    let body = BodyDesc::dynamic()
        .with_position(DVec3::Y * f64::from(height))
        .with_velocity(Vec3::X * speed, Vec3::ZERO);
    world.add_body(&body.with_shape(rough(geometry, 0.0))).unwrap()
}

/// Steps a world for so many seconds, and says how far along x the body got at most [m].
fn furthest(world: &mut World, body: BodyHandle, seconds: f32, hz: f32) -> f64 {
    let mut most = f64::MIN;
    for _ in 0..(seconds * hz) as usize {
        world.step(1.0 / hz).unwrap();
        most = most.max(world.position(body).unwrap().x);
    }
    most
}

/// A step of 5 mm is none of the gaps that are passed over. Expected: a ball of 25 cm at 2 m/s loses to its
/// edge the speed into it, 1 - cos(0.2), and climbs: 1.93 m/s are left, less by the length of a step; a box
/// that strikes it with its side is thrown back, and comes no further than it tips.
#[test]
fn a_step_is_felt() {
    for hz in RATES {
        for ball in [true, false] {
            let mut world = World::new(Settings::default()).unwrap();
            row(&mut world, 0.5, -2.0, 2.0, 0.0);
            row(&mut world, 0.5, 2.0, 6.0, 0.005);
            let shape = if ball { Geometry::sphere(0.25) } else { Geometry::cuboid(0.25, 0.25, 0.25) };
            let body = push(&mut world, shape, 0.25, 2.0);
            let most = furthest(&mut world, body, 2.0, hz);
            let (speed, at) = (world.linear_velocity(body).unwrap().x, world.position(body).unwrap());
            if ball {
                assert!(
                    (1.82..1.95).contains(&speed) && (at.y - 0.255).abs() < 1e-3,
                    "{hz} Hz: {speed} {at}"
                );
            } else {
                assert!(most < 1.9 && speed < 0.1, "{hz} Hz: {most} {speed}");
            }
        }
    }
}

/// A wall of boxes on a floor of boxes, at 1 to 100 m/s. Expected: nothing gets into it by more than a tenth
/// of a millimetre, or off the floor before it.
#[test]
fn a_wall_of_boxes_stops() {
    for hz in RATES {
        for speed in [1.0, 5.0, 20.0, 100.0] {
            for shape in
                [Geometry::sphere(0.25), Geometry::cuboid(0.25, 0.25, 0.25), Geometry::cylinder(0.25, 0.25)]
            {
                let mut world = World::new(Settings::default()).unwrap();
                row(&mut world, 0.5, -2.0, 6.0, 0.0);
                for k in 1..=4 {
                    row(&mut world, 0.5, 4.0, 4.5, 0.5 * k as f32);
                }
                let name = format!("{hz} Hz, {speed} m/s, {shape:?}");
                let body = push(&mut world, shape, 0.25, speed);
                let most = furthest(&mut world, body, 4.0 / speed + 0.2, hz);
                assert!((3.7..3.7501).contains(&most), "{name}: {most}");
            }
        }
    }
}

/// A gap of 40 cm takes a ball of 30. Expected: at 1 m/s it falls in.
#[test]
fn a_gap_that_is_wide_enough_takes_a_ball() {
    for hz in RATES {
        let mut world = World::new(Settings::default()).unwrap();
        row(&mut world, 0.5, -2.0, 2.0, 0.0);
        row(&mut world, 0.5, 2.4, 6.0, 0.0);
        let body = push(&mut world, Geometry::sphere(0.15), 0.15, 1.0);
        furthest(&mut world, body, 4.0, hz);
        let at = world.position(body).unwrap();
        assert!(at.y < -1.0 && (2.1..2.3).contains(&at.x), "{hz} Hz: {at}");
    }
}

/// An inner corner of a wall of boxes and a long box. Expected: a ball that slides into it stays in both.
#[test]
fn an_inner_corner_holds() {
    for hz in RATES {
        let mut world = World::new(Settings::default()).unwrap();
        row(&mut world, 0.5, -2.0, 6.0, 0.0);
        for k in 1..=4 {
            row(&mut world, 0.5, 4.0, 4.5, 0.5 * k as f32);
        }
        let side = BodyDesc::fixed().with_position(DVec3::new(0.0, 0.5, 1.5));
        world.add_body(&side.with_shape(rough(Geometry::cuboid(6.0, 1.0, 0.5), 0.0))).unwrap();
        let body = push(&mut world, Geometry::sphere(0.25), 0.25, 5.0);
        world.set_linear_velocity(body, Vec3::new(5.0, 0.0, 3.0)).unwrap();
        furthest(&mut world, body, 3.0, hz);
        let off = (world.position(body).unwrap() - DVec3::new(3.75, 0.25, 0.75)).length();
        assert!(off < 1e-3, "{hz} Hz: {off}");
    }
}

/// A lift of boxes that goes along and up. Expected: bodies that slide on it without friction keep their
/// speed, and go up with it.
#[test]
fn a_lift_of_boxes_is_one_surface() {
    for hz in RATES {
        let mut world = World::new(Settings::default()).unwrap();
        let places =
            (-8..24).flat_map(|i| (-2..3).map(move |k| Vec3::new(0.5 * i as f32, -0.25, 0.5 * k as f32)));
        let shapes = places.map(|at| rough(Geometry::cuboid(0.25, 0.25, 0.25), 0.0).with_position(at));
        let lift = BodyDesc::kinematic().with_velocity(Vec3::new(3.0, 1.0, 0.0), Vec3::ZERO);
        world.add_body(&lift.with_shapes(shapes.collect::<Vec<_>>())).unwrap();
        let body = push(&mut world, Geometry::cuboid(0.2, 0.2, 0.2), 0.2, 8.0);
        world.set_linear_velocity(body, Vec3::new(8.0, 1.0, 0.0)).unwrap();
        furthest(&mut world, body, 1.5, hz);
        let (velocity, at) = (world.linear_velocity(body).unwrap(), world.position(body).unwrap());
        assert!((velocity - Vec3::new(8.0, 1.0, 0.0)).length() < 1e-3, "{hz} Hz: {velocity}");
        assert!((at.y - 1.7).abs() < 2e-3, "{hz} Hz: {at}");
    }
}
