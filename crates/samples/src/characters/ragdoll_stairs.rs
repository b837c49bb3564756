//! Ragdolls on stairs: figures tumble down a long flight of steps, one after the other.

use crate::parts::{fixed, level_world};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{Error, Geometry, Skeleton, World};

const COUNT: usize = 12;
/// Number, height and depth of the steps, and half their width [m].
const STEPS: usize = 24;
const HEIGHT: f32 = 0.25;
const DEPTH: f32 = 0.35;
const HALF: f32 = 2.5;
/// Torque of friction in each joint [N m].
const FRICTION: f32 = 3.0;

/// The stairs between two walls, and the figures at the top.
pub fn start() -> Result<World, Error> {
    let (mut world, _) = level_world()?;
    for i in 0..STEPS {
        let top = HEIGHT * (STEPS - i) as f32;
        let at = Vec3::new(0.0, 0.5 * top, DEPTH * (i as f32 - 0.5 * STEPS as f32));
        world.add_body(&fixed(Geometry::cuboid(HALF, 0.5 * top, 0.5 * DEPTH)).with_position(at))?;
    }
    let top = HEIGHT * STEPS as f32;
    let figure = Skeleton::humanoid().with_friction(FRICTION);
    for i in 0..COUNT {
        let row = (i / 3) as f32;
        let at = Vec3::new(1.6 * (i % 3) as f32 - 1.6, top + 0.2 + 1.8 * row, -0.5 * DEPTH * STEPS as f32 + 0.5);
        let turned = Quat::from_rotation_y(i as f32);
        figure.add_to(&mut world, DVec3::from(at), turned, Vec3::new(0.0, 0.0, 3.5))?;
    }
    Ok(world)
}

#[test]
fn they_come_down_and_do_not_get_into_a_step() -> Result<(), Error> {
    let mut world = start()?;
    crate::parts::run(&mut world, 15.0)?;
    let mut down = 0;
    for body in world.bodies().filter(|&body| world.kind(body) == Ok(BodyKind::Dynamic)) {
        let at = world.position(body)?;
        assert!(at.y > 0.0, "{at}");
        down += usize::from(at.y < 0.5 * f64::from(HEIGHT) * STEPS as f64);
        for contact in world.contacts_of(body)? {
            // Overlap that a stack of bodies causes at most; a step is 250 mm high.
            assert!(contact.points().iter().all(|point| point.separation > -0.02));
        }
    }
    // The steps are steeper than friction of 0.6 holds.
    assert!(down > 6 * COUNT, "{down} of {}", 11 * COUNT);
    Ok(())
}
