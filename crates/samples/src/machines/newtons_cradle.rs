//! Newton's cradle: two balls strike a row of five, and at the other end two leave.

use crate::parts::fixed;
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, JointDesc, Material, Settings, ShapeDesc, World};

const BALLS: usize = 5;
const RAISED: usize = 2;
/// Radius of a ball, and the room between two [m].
const RADIUS: f64 = 0.25;
const GAP: f64 = 0.001;
/// Length of a thread [m], and angle of the raised ones [rad].
const THREAD: f64 = 2.0;
const ANGLE: f64 = 0.5;

/// The cradle, with two balls raised.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let mut world = World::new(Settings::default())?;
    let beam = fixed(Geometry::cuboid(1.5, 0.05, 0.1)).with_position(DVec3::Y * 3.0);
    let beam = world.add_body(&beam)?;
    let steel = Material::default().with_restitution(1.0).with_friction(0.0);
    let mut balls = Vec::new();
    for i in 0..BALLS {
        let pivot = DVec3::new((2.0 * RADIUS + GAP) * (i as f64 - 2.0), 3.0, 0.0);
        let angle = if i < RAISED { ANGLE } else { 0.0 };
        let place = pivot - THREAD * DVec3::new(angle.sin(), angle.cos(), 0.0);
        let ball = ShapeDesc::new(Geometry::sphere(RADIUS as f32)).with_material(steel);
        let ball = world.add_body(&BodyDesc::dynamic().with_position(place).with_shape(ball))?;
        // Two threads in a V are a hinge.
        let frames = world.frames_about([beam, ball], pivot, Vec3::Z)?;
        world.add_joint(&JointDesc::hinge([beam, ball], frames))?;
        balls.push(ball);
    }
    Ok((world, balls))
}

#[test]
fn as_many_leave_as_came() -> Result<(), Error> {
    let (mut world, balls) = build()?;
    // Half a period of 2 pi sqrt(l / g) later, and two and a half.
    for seconds in [1.43, 2.0 * 2.86] {
        crate::parts::run(&mut world, seconds)?;
        let height = |i: usize| world.position(balls[i]).map(|at| at.y - 3.0 + THREAD);
        let raised = THREAD * (1.0 - ANGLE.cos());
        for i in 0..BALLS {
            let expected = if i < BALLS - RAISED { 0.0 } else { raised };
            assert!((height(i)? - expected).abs() < 0.1 * raised, "{i}: {} of {expected} m", height(i)?);
        }
    }
    Ok(())
}
