//! Budget: a heap in a world of 600 kB, which leaves out contacts instead of taking more.

use crate::parts::{fixed, level_world_with, solid, spread};
use backstop::glam::Vec3;
use backstop::{Budget, Error, Geometry, Settings, World};

const BODIES: usize = 240;
/// Bytes that the world may take.
const BYTES: usize = 600_000;
/// Half the width of the pit [m].
const PIT: f32 = 2.0;

/// The pit, and the bodies above it.
pub fn start() -> Result<World, Error> {
    build(Budget::total(BYTES))
}

fn build(budget: Budget) -> Result<World, Error> {
    let (mut world, _) = level_world_with(Settings::default().with_budget(budget))?;
    for side in [-1.0, 1.0] {
        let wall = fixed(Geometry::cuboid(PIT, 1.0, 0.1));
        world.add_body(&wall.with_position(Vec3::new(0.0, 1.0, side * (PIT + 0.1))))?;
        let wall = fixed(Geometry::cuboid(0.1, 1.0, PIT));
        world.add_body(&wall.with_position(Vec3::new(side * (PIT + 0.1), 1.0, 0.0)))?;
    }
    for i in 0..BODIES {
        let (x, z) = (1.6 * (2.0 * spread(i) - 1.0), 1.6 * (2.0 * spread(7 * i) - 1.0));
        let shape = if i % 2 == 0 { Geometry::cuboid(0.2, 0.15, 0.2) } else { Geometry::sphere(0.18) };
        world.add_body(&solid(shape).with_position(Vec3::new(x, 0.5 + 0.02 * i as f32, z)))?;
    }
    Ok(world)
}

#[test]
fn it_keeps_to_its_bytes() -> Result<(), Error> {
    let mut free = build(Budget::NONE)?;
    let mut bound = start()?;
    let mut shed = 0;
    for _ in 0..60 * 8 {
        free.step(1.0 / 60.0)?;
        shed += bound.step(1.0 / 60.0)?.shed;
        assert!(bound.memory().total() <= BYTES, "{}", bound.memory().total());
    }
    println!("{} {} {shed}", free.memory().total(), bound.memory().total());
    assert!(free.memory().total() > BYTES && shed > 0, "{} {shed}", free.memory().total());
    for body in bound.bodies() {
        assert!(bound.position(body)?.y > -0.2, "{}", bound.position(body)?);
    }
    Ok(())
}
