//! Digging: four pits grow in a field of heights, one after another, and balls roll into them.

use crate::parts::{Driven, solid};
use backstop::glam::{Vec2, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, HeightField, Settings, ShapeDesc, ShapeHandle, World};

/// Samples along an edge of the field, and their distance [m].
const SIDE: usize = 65;
const CELL: f32 = 0.25;
/// Depth of a pit [m], its radius [samples], and the time that it takes [s].
const DEPTH: f32 = 1.2;
const REACH: usize = 9;
const TIME: f64 = 3.0;
/// Middles of the pits [samples].
const PITS: [[usize; 2]; 4] = [[20, 20], [44, 20], [44, 44], [20, 44]];

/// Level ground with balls on it.
pub fn start() -> Result<Driven, Error> {
    let (world, ground, _) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let Some([x, z]) = PITS.get((tick.time / TIME) as usize) else { return Ok(()) };
        let share = (tick.time / TIME).fract() as f32;
        let size = 2 * REACH + 1;
        let heights = (0..size * size).map(|i| {
            let away = Vec2::new((i % size) as f32, (i / size) as f32) / REACH as f32 - Vec2::ONE;
            -DEPTH * share * (1.0 - away.length_squared()).max(0.0)
        });
        world.set_heights(ground, [x - REACH, z - REACH], [size; 2], &heights.collect::<Vec<_>>())
    }))
}

fn build() -> Result<(World, ShapeHandle, Vec<BodyHandle>), Error> {
    let mut world = World::new(Settings::default().with_sleeping(true))?;
    let field = HeightField::new(SIDE, SIDE, Vec2::splat(CELL), vec![0.0; SIDE * SIDE])?;
    // The first sample is at the origin of the body.
    let corner = Vec3::new(-0.5, 0.0, -0.5) * CELL * (SIDE - 1) as f32;
    let ground = world.add_body(&BodyDesc::fixed().with_position(corner))?;
    let ground = world.add_shape(ground, &ShapeDesc::new(Geometry::height_field(field)))?;
    let mut balls = Vec::new();
    for i in 0..100 {
        let place = Vec3::new((i % 10) as f32 - 4.5, 0.25, (i / 10) as f32 - 4.5);
        balls.push(world.add_body(&solid(Geometry::sphere(0.25)).with_position(place))?);
    }
    Ok((world, ground, balls))
}

#[test]
fn balls_end_in_the_pits() -> Result<(), Error> {
    let (mut sample, balls) = (start()?, build()?.2);
    crate::parts::run(&mut sample, 20.0)?;
    let world = crate::Running::world(&sample);
    // Those that stood over a pit of 2.25 m: pi (2.25 m)² of a ball per square metre, in each of four.
    let low = |&&ball: &&BodyHandle| world.position(ball).is_ok_and(|at| at.y < 0.0);
    let count = balls.iter().filter(low).count();
    assert!((50..=70).contains(&count), "{count}");
    let lowest = balls.iter().filter_map(|&ball| world.position(ball).ok()).fold(0.0, |y, at| at.y.min(y));
    assert!(lowest > -f64::from(DEPTH), "none fell through: {lowest} m");
    Ok(())
}
