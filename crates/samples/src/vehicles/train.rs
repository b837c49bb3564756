//! Train: an engine on a rail pulls eight wagons; by the slack in their couplings they start one by one.
//! Keys: up and down drive; without keys it goes to and fro.

use crate::parts::{Driven, fixed, level_world, solid};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{Axis, BodyHandle, Error, Geometry, JointDesc, JointHandle, Motion, Motor, World};

const WAGONS: usize = 8;
/// Distance of two wagons at the start, and how much further the coupling lets them [m].
const APART: f64 = 2.4;
const SLACK: f32 = 0.3;
/// Speed [m/s] and force [N] of the engine, and how long it goes one way [s].
const SPEED: f32 = 4.0;
const FORCE: f32 = 20_000.0;
const LEG: f64 = 10.0;

/// The train on its rail, with crates as load.
pub fn start() -> Result<Driven, Error> {
    let (world, _, engine) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let alone = if ((tick.time / LEG) as u32).is_multiple_of(2) { 1.0 } else { -1.0 };
        let share = if tick.controls.forward == 0.0 { alone } else { tick.controls.forward };
        world.set_joint_motor(engine, Motor::velocity(Motion::Linear, Axis::X, share * SPEED, FORCE))
    }))
}

fn build() -> Result<(World, Vec<BodyHandle>, JointHandle), Error> {
    let (mut world, ground) = level_world()?;
    world.add_body(&fixed(Geometry::cuboid(30.0, 0.05, 0.1)).with_position(Vec3::new(10.0, 0.05, 0.0)))?;
    let (mut wagons, mut sliders) = (Vec::<BodyHandle>::new(), Vec::new());
    for i in 0..=WAGONS {
        // The engine is the first.
        let at = DVec3::new(-APART * i as f64, 0.5, 0.0);
        let wagon = world.add_body(&solid(Geometry::cuboid(1.0, 0.3, 0.6)).with_position(at))?;
        let frames = world.frames_at([ground, wagon], at, Quat::IDENTITY)?;
        sliders.push(world.add_joint(&JointDesc::slider([ground, wagon], frames))?);
        if let Some(&before) = wagons.last() {
            let frames = world.frames_at([before, wagon], at, Quat::IDENTITY)?;
            world.add_joint(&JointDesc::distance([before, wagon], frames, 0.0, SLACK))?;
        }
        let load = Geometry::cuboid(0.3, 0.2 + 0.05 * i as f32, 0.4);
        world.add_body(&solid(load).with_position(at + DVec3::Y * (0.5 + 0.05 * i as f64)))?;
        wagons.push(wagon);
    }
    Ok((world, wagons, sliders[0]))
}

#[test]
fn all_wagons_get_the_speed_of_the_engine() -> Result<(), Error> {
    let (mut sample, wagons) = (start()?, build()?.1);
    crate::parts::run(&mut sample, LEG - 1.0)?;
    let world = crate::Running::world(&sample);
    for pair in wagons.windows(2) {
        let apart = world.position(pair[0])?.x - world.position(pair[1])?.x;
        assert!((apart - APART) as f32 > 0.0 && (apart - APART) as f32 <= SLACK + 0.001, "{apart} m");
        assert!((world.linear_velocity(pair[1])?.x - SPEED).abs() < 0.05);
    }
    Ok(())
}
