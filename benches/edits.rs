//! What an edit of a height field of 513 x 513 samples costs under 1000 boxes: a patch by
//! `World::set_heights`, cells by `World::set_holes`, and the whole field by `World::set_geometry`.
//!
//!     cargo bench --bench edits

use backstop::glam::{Vec2, Vec3};
use backstop::{BodyDesc, Error, Geometry, HeightField, Settings, ShapeDesc, ShapeHandle, World};
use std::time::Instant;

const SIDE: usize = 513;
const PATCH: usize = 16;
const ROUNDS: usize = 101;

fn heights() -> Vec<f32> {
    let at = |i: usize| ((i % SIDE % 7) as f32 - 3.0) * ((i / SIDE % 5) as f32 - 2.0);
    (0..SIDE * SIDE).map(|i| 0.05 * at(i)).collect()
}

fn field(heights: Vec<f32>) -> Result<HeightField, Error> {
    HeightField::new(SIDE, SIDE, Vec2::splat(0.5), heights)
}

/// A world with boxes that were let fall on the field, and its shape.
fn world() -> Result<(World, ShapeHandle), Error> {
    let mut world = World::new(Settings::default())?;
    let ground = ShapeDesc::new(Geometry::height_field(field(heights())?));
    let ground = world.add_body(&BodyDesc::fixed().with_shape(ground))?;
    let shape = world.shapes(ground)?.next().ok_or(Error::StaleShape)?;
    for i in 0..1000 {
        let at = Vec3::new(20.0 + 6.0 * (i % 32) as f32, 1.0, 20.0 + 6.0 * (i / 32) as f32);
        let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
        world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(cube))?;
    }
    for _ in 0..120 {
        world.step(1.0 / 60.0)?;
    }
    Ok((world, shape))
}

/// The time of a call [ms].
fn time<T>(call: impl FnOnce() -> Result<T, Error>) -> Result<(f64, T), Error> {
    let start = Instant::now();
    let result = call()?;
    Ok((start.elapsed().as_secs_f64() * 1e3, result))
}

fn main() -> Result<(), Error> {
    let (mut world, shape) = world()?;
    let mut times = [const { Vec::new() }; 4];
    for round in 0..ROUNDS {
        // Interleaved: whatever else the machine does meets all of them.
        let first = [32 + 3 * round % 400, 32 + 7 * round % 400];
        let depth = if round % 2 == 0 { -0.2 } else { 0.1 };
        let patch = [depth; PATCH * PATCH];
        times[0].push(time(|| world.set_heights(shape, first, [PATCH; 2], &patch))?.0);
        let holes = [round % 2 == 0; PATCH * PATCH];
        times[1].push(time(|| world.set_holes(shape, first, [PATCH; 2], &holes))?.0);
        world.step(1.0 / 60.0)?;
        let (build, whole) = time(|| field(heights()))?;
        times[2].push(build);
        times[3].push(time(|| world.set_geometry(shape, Geometry::height_field(whole)))?.0);
        world.step(1.0 / 60.0)?;
    }
    let names = ["set_heights, 16 x 16", "set_holes, 16 x 16", "HeightField::new", "set_geometry"];
    for (name, mut times) in names.into_iter().zip(times) {
        times.sort_by(f64::total_cmp);
        println!("{name:22} {:8.4} ms (median of {ROUNDS})", times[ROUNDS / 2]);
    }
    Ok(())
}
