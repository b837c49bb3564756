//! A bullet of 5 mm at 10 km/s, 167 m a step, and a wall of 1 mm, also far from the origin.

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, ConvexHull, Geometry, Settings, ShapeDesc, World};
use std::sync::Arc;

/// Size of bullets [m]: their radius, or half their width.
const SMALL: f32 = 0.0025;
/// Half of the wall's thickness [m].
const HALF_WALL: f32 = 0.0005;
const SPEED: f32 = 1e4;

/// Each is 5 mm across at its thinnest and no more than four times as long.
fn bullets() -> Vec<Geometry> {
    let corners = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - Vec3::ONE;
    let hull: Vec<Vec3> = (0..8).map(corners).chain([Vec3::X * 2.5, Vec3::NEG_X * 2.5]).collect();
    let hull = ConvexHull::new(&hull.iter().map(|p| *p * SMALL).collect::<Vec<_>>()).unwrap();
    vec![
        Geometry::Sphere { radius: SMALL },
        Geometry::capsule(2.0 * SMALL, SMALL),
        Geometry::cuboid(SMALL, 2.0 * SMALL, SMALL),
        Geometry::cylinder(3.0 * SMALL, SMALL),
        Geometry::Hull(Arc::new(hull)),
    ]
}

/// Half of the wall's width [m]: as far as single precision resolves a bullet on it.
const REACH: f32 = 300.0;

fn world_with_wall(origin: DVec3) -> World {
    let settings = Settings::default().with_gravity(Vec3::ZERO);
    let mut world = World::new(settings).unwrap();
    let wall = ShapeDesc::new(Geometry::cuboid(REACH, HALF_WALL, REACH));
    world.add_body(&BodyDesc::fixed().with_position(origin).with_shape(wall)).unwrap();
    world
}

/// Where a bullet is after each step until it is beyond the wall's rim, seen from the wall [m].
fn flight(geometry: &Geometry, degrees: f32, before: f32, spin: Vec3, origin: DVec3) -> Vec<DVec3> {
    let mut world = world_with_wall(origin);
    let slope = degrees.to_radians();
    let way = Vec3::new(libm::sinf(slope), -libm::cosf(slope), 0.0);
    // It is to touch the wall `before` metres of its path later, wherever that is within a step.
    let start = Vec3::Y * (HALF_WALL + 2.0 * SMALL) - way * before;
    let turn = Quat::from_xyzw(0.3, 0.5, 0.1, 0.8).normalize();
    let bullet = BodyDesc::dynamic()
        .with_position(origin + start.as_dvec3())
        .with_rotation(turn)
        .with_velocity(way * SPEED, spin)
        .with_shape(ShapeDesc::new(geometry.clone()));
    let bullet = world.add_body(&bullet).unwrap();
    let mut places = Vec::new();
    for _ in 0..30 {
        world.step(1.0 / 60.0).unwrap();
        let at = world.position(bullet).unwrap() - origin;
        if at.x.abs().max(at.z.abs()) > f64::from(REACH) {
            break;
        }
        places.push(at);
    }
    places
}

/// At all angles from the normal, at touches early, late and between in the step, with and without spin. By
/// geometry the centre of a stopped body stays on its side of the wall's face; that it stops there and does
/// not bounce is e = 0.
#[test]
fn a_bullet_of_five_millimetres_at_ten_kilometres_a_second_stops_at_a_wall_of_one() {
    let mut lost = Vec::new();
    for (number, geometry) in bullets().into_iter().enumerate() {
        for degrees in [0.0, 30.0, 60.0, 80.0, 88.0, 89.0, 89.5, 89.9, 89.99] {
            for before in [0.02, 1.7, 40.0, 83.0, 166.0, 166.66] {
                for spin in [Vec3::ZERO, Vec3::new(30.0, -200.0, 90.0)] {
                    let places = flight(&geometry, degrees, before, spin, DVec3::ZERO);
                    let name =
                        format!("bullet {number} at {degrees} degrees, {before} m before, spin {spin}");
                    for (step, at) in places.iter().enumerate() {
                        let above = at.y - f64::from(HALF_WALL);
                        if above <= 0.0 {
                            lost.push(format!("{name}: after step {step} at {at}"));
                            break;
                        }
                    }
                    // A body that tumbles along the wall may lift off again, a ball that doesn't spin can't.
                    // The rest of its speed towards the wall is rounding: single precision has 0.001 m/s at
                    // 10 km/s.
                    if spin == Vec3::ZERO && matches!(geometry, Geometry::Sphere { .. }) {
                        let [.., before, last] = places[..] else { continue };
                        let rise = 60.0 * (last.y - before.y);
                        let most = 1e-3 * f64::from(SPEED);
                        assert!(rise < most, "{name}: rises at {rise} m/s");
                    }
                }
            }
        }
    }
    assert!(lost.is_empty(), "through: {lost:#?}");
}

/// Positions are doubles with 2 nm between them at ten thousand kilometres, and pairs are worked on in a
/// frame of their own.
const DISTANCES: [f64; 5] = [1e3, 1e4, 1e5, 1e6, 1e7];

#[test]
fn a_bullet_stops_at_the_same_place_however_far_from_the_origin() {
    for geometry in bullets() {
        for degrees in [0.0, 60.0, 89.0] {
            let here = flight(&geometry, degrees, 83.0, Vec3::ZERO, DVec3::ZERO);
            for distance in DISTANCES {
                let far =
                    flight(&geometry, degrees, 83.0, Vec3::ZERO, DVec3::new(distance, -distance, distance));
                // A ball; a body that tumbles away from the impact at kilometres a second amplifies rounding.
                if matches!(geometry, Geometry::Sphere { .. }) {
                    let off = (here[0] - far[0]).length();
                    assert!(off < 1e-4, "{geometry:?} at {degrees} degrees, {distance} m: {off} m off");
                }
                let through = far.iter().find(|at| at.y < f64::from(HALF_WALL));
                assert!(through.is_none(), "{geometry:?} at {degrees}, {distance} m: {through:?}");
            }
        }
    }
}
