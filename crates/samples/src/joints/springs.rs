//! Springs: five blocks hang on springs of the same frequency and of different damping.

use crate::parts::{fixed, solid};
use backstop::glam::{DVec3, Vec3};
use backstop::{Axis, BodyHandle, Error, Geometry, JointDesc, Motion, Motor, Settings, Spring, World};

/// Frequency of the springs [Hz]: a block sinks by g / (2 pi f)².
const HERTZ: f32 = 0.6;
/// Damping ratios; 1 is critical.
const RATIOS: [f32; 5] = [0.0, 0.05, 0.2, 1.0, 3.0];
const TOP: f64 = 3.0;

/// The blocks at the height at which their springs are slack.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let mut world = World::new(Settings::default())?;
    let beam = fixed(Geometry::cuboid(2.0, 0.05, 0.2)).with_position(DVec3::Y * (TOP + 0.5));
    let beam = world.add_body(&beam)?;
    let mut blocks = Vec::new();
    for (i, ratio) in RATIOS.into_iter().enumerate() {
        let at = DVec3::new(0.8 * i as f64 - 1.6, TOP, 0.0);
        let block = world.add_body(&solid(Geometry::cuboid(0.2, 0.2, 0.2)).with_position(at))?;
        let frames = world.frames_about([beam, block], at, Vec3::Y)?;
        let spring = Motor::position(Motion::Linear, Axis::X, 0.0, Spring::Frequency { hertz: HERTZ, ratio });
        world.add_joint(&JointDesc::slider([beam, block], frames).with_motor(spring))?;
        blocks.push(block);
    }
    Ok((world, blocks))
}

#[test]
fn they_swing_and_come_to_rest_as_the_theory_has_it() -> Result<(), Error> {
    let (mut world, blocks) = build()?;
    let sag = 9.81 / (std::f32::consts::TAU * HERTZ).powi(2);
    // After six periods, 10 s, the one without damping is nearly back where it began: substeps of h damp it
    // as exp(-(2 pi f)² h t / 2), to 0.74 of its amplitude.
    crate::parts::run(&mut world, f64::from(6.0 / HERTZ))?;
    let fallen = |world: &World, i: usize| world.position(blocks[i]).map(|at| (TOP - at.y) as f32);
    assert!((fallen(&world, 0)? / sag - (1.0 - 0.74)).abs() < 0.03, "{} m", fallen(&world, 0)?);
    // exp(-0.2 * 2 pi f * 25 s) is nothing.
    crate::parts::run(&mut world, 15.0)?;
    for i in 2..RATIOS.len() {
        assert!((fallen(&world, i)? - sag).abs() < 0.01 * sag, "{i}: {} m", fallen(&world, i)?);
    }
    Ok(())
}
