//! Rays: a lighthouse casts ninety-six rays in each step, and a mark shows where each of them ends.

use crate::parts::{Driven, level_world, solid};
use backstop::glam::{DVec3, Quat};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, QueryFilter, Ray, ShapeDesc, World};
use std::f64::consts::TAU;

const RAYS: usize = 96;
/// Where they come from, how far they go, how far the boxes swing, and half the edge of one [m].
const FROM: DVec3 = DVec3::new(0.0, 0.4, 0.0);
const REACH: f64 = 6.0;
const SWING: f64 = 1.0;
const HALF: f32 = 0.4;

/// Boxes around the lighthouse, and the marks.
pub fn start() -> Result<Driven, Error> {
    let (world, marks, boxes) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        for (i, &cube) in boxes.iter().enumerate() {
            world.move_kinematic_and_stop(cube, place(i, tick.time), Quat::IDENTITY, tick.dt)?;
        }
        for (i, &mark) in marks.iter().enumerate() {
            let (sin, cos) = (TAU * i as f64 / RAYS as f64).sin_cos();
            let ray = Ray::between(FROM, FROM + REACH * DVec3::new(cos, 0.0, sin));
            let end = world.cast_ray(&ray, &QueryFilter::new())?.map_or(ray.at(1.0), |hit| hit.point);
            world.set_pose(mark, end, Quat::IDENTITY)?;
        }
        Ok(())
    }))
}

/// Where a box is at a time.
fn place(i: usize, time: f64) -> DVec3 {
    let (angle, away) = (TAU * i as f64 / 7.0, 3.5 + SWING * (time + i as f64).sin());
    DVec3::new(angle.cos() * away, 0.4, angle.sin() * away)
}

fn build() -> Result<(World, Vec<BodyHandle>, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    // Rays see no sensors.
    let mark = BodyDesc::kinematic().with_shape(ShapeDesc::new(Geometry::sphere(0.06)).as_sensor());
    let marks = world.add_bodies(&vec![mark; RAYS])?;
    let cube = solid(Geometry::cuboid(HALF, HALF, HALF)).with_kind(backstop::BodyKind::Kinematic);
    let boxes: Vec<BodyDesc> = (0..7).map(|i| cube.clone().with_position(place(i, 0.0))).collect();
    let boxes = world.add_bodies(&boxes)?;
    Ok((world, marks, boxes))
}

#[test]
fn the_first_ray_meets_the_first_box() -> Result<(), Error> {
    let (mut sample, (_, marks, boxes)) = (start()?, build()?);
    for seconds in [0.5, 2.0, 4.0] {
        // Along x: the ray ends half a box before its middle, which moves a little in that step.
        crate::parts::run(&mut sample, seconds)?;
        let world = crate::Running::world(&sample);
        let gap = world.position(boxes[0])?.x - world.position(marks[0])?.x;
        assert!((gap - f64::from(HALF)).abs() < SWING / 60.0 + 1e-3, "{gap} m");
    }
    Ok(())
}
