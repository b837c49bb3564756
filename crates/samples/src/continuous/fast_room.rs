//! Fast room: two hundred balls at 100 m/s bounce in a closed room with walls of 1 cm and stay inside.

use crate::parts::{fixed, spread};
use backstop::glam::Vec3;
use backstop::{BodyDesc, Error, Geometry, Material, Settings, ShapeDesc, World};

const COUNT: usize = 200;
/// Speed of the balls at the start [m/s], 1.7 m in a step, and the radius of the smallest [m].
const SPEED: f32 = 100.0;
const RADIUS: f32 = 0.06;
/// Half the width of the room, and half the thickness of its walls [m].
const ROOM: f32 = 3.0;
const WALL: f32 = 0.005;

/// The room and the balls in it.
pub fn start() -> Result<World, Error> {
    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO))?;
    let bouncy = Material::default().with_restitution(1.0).with_friction(0.0);
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        let half = Vec3::splat(ROOM + 2.0 * WALL) - axis * (ROOM + WALL);
        let mut wall = fixed(Geometry::cuboid(half.x, half.y, half.z));
        wall.shapes[0].material = bouncy;
        for side in [-1.0, 1.0] {
            let at = Vec3::Y * ROOM + axis * (side * (ROOM + WALL));
            world.add_body(&wall.clone().with_position(at))?;
        }
    }
    for i in 0..COUNT {
        let [x, y, z] = [1, 7, 13].map(|k| 2.0 * spread(k * i) - 1.0);
        let place = Vec3::Y * ROOM + Vec3::new(x, y, z) * (ROOM - 0.3);
        let shape = ShapeDesc::new(Geometry::sphere(RADIUS * (1.0 + spread(3 * i))));
        let ball = BodyDesc::dynamic()
            .with_position(place)
            .with_linear_velocity(Vec3::new(z, x, y).normalize() * SPEED)
            .with_shape(shape.with_material(bouncy));
        world.add_body(&ball)?;
    }
    Ok(world)
}

#[test]
fn all_stay_inside_and_keep_moving() -> Result<(), Error> {
    let mut world = start()?;
    let energy = world.energy();
    crate::parts::run(&mut world, 20.0)?;
    for body in world.bodies() {
        let out = (world.position(body)? - Vec3::Y.as_dvec3() * f64::from(ROOM)).abs().max_element();
        assert!(out < f64::from(ROOM + 2.0 * WALL), "{out} m from the middle");
    }
    // Nothing gains energy, and little is lost where three bodies meet within a step.
    let left = world.energy() / energy;
    assert!((0.5..1.01).contains(&left), "{left}");
    Ok(())
}
