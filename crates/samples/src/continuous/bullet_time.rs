//! Bullet time: near a stack of plates a bullet moves in steps forty times as short; the hit is the same.
//! Keys: E switches the slow steps off.

use crate::parts::{fixed, level_world, solid};
use crate::{Running, Tick};
use backstop::glam::{Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, ShapeDesc, World};

/// Speed of the bullet [m/s].
const SPEED: f32 = 400.0;

/// A world in which time slows down, and the bullet.
#[derive(Debug)]
pub struct BulletTime(World, BodyHandle);

/// Ten plates on a table, and the bullet on its way.
pub fn start() -> Result<BulletTime, Error> {
    let (mut world, _) = level_world()?;
    world.add_body(&fixed(Geometry::cuboid(0.6, 0.4, 0.6)).with_position(Vec3::Y * 0.4))?;
    let plate = solid(Geometry::cuboid(0.3, 0.05, 0.3));
    for i in 0..10 {
        world.add_body(&plate.clone().with_position(Vec3::Y * (0.85 + 0.1 * i as f32)))?;
    }
    let bullet = BodyDesc::dynamic()
        .with_position(Vec3::new(-300.0, 1.35, 0.0))
        .with_rotation(Quat::from_rotation_arc(Vec3::Y, Vec3::X))
        .with_linear_velocity(Vec3::X * SPEED)
        .with_gravity_scale(0.0)
        .with_shape(ShapeDesc::new(Geometry::capsule(0.06, 0.03)).with_density(7800.0));
    world.add_body(&bullet).map(|bullet| BulletTime(world, bullet))
}

impl Running for BulletTime {
    fn world(&self) -> &World {
        &self.0
    }
    fn world_mut(&mut self) -> &mut World {
        &mut self.0
    }
    fn step(&mut self, tick: &Tick) -> Result<(), Error> {
        let slow = self.0.position(self.1)?.x.abs() < 5.0 && !tick.controls.action;
        self.0.step(if slow { tick.dt / 40.0 } else { tick.dt }).map(drop)
    }
}

#[test]
fn slow_or_not_the_hit_is_the_same() -> Result<(), Error> {
    for action in [false, true] {
        let (mut sample, controls) = (start()?, crate::Controls { action, ..Default::default() });
        let speed = |sample: &BulletTime| sample.0.linear_velocity(sample.1).map(|v| v.x);
        let mut ticks = Tick::during(5.0);
        while speed(&sample)? > 0.9 * SPEED {
            sample.step(&Tick { controls, ..ticks.next().expect("it hits in 5 s") })?;
        }
        // By conservation of momentum: 3.53 kg stick to a plate of 36 kg.
        let expected = SPEED * 3.53 / (3.53 + 36.0);
        assert!((speed(&sample)? / expected - 1.0).abs() < 0.05);
    }
    Ok(())
}
