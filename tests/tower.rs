//! A tower of thirty boxes stands.

mod common;

use backstop::glam::DVec3;
use backstop::scene::builtin;
use backstop::{Settings, World};

const DT: f32 = 1.0 / 60.0;

/// How far the top of the tower is from where it was put, sideways and down [m], after each of 20 seconds; and where
/// it is relative to the origin of the tower in the end.
fn stand(settings: Settings, origin: DVec3) -> (Vec<[f64; 2]>, Vec<DVec3>) {
    let mut descs = builtin::tall_stack().descs();
    descs.iter_mut().for_each(|d| d.position += origin);
    let mut world = World::new(settings).unwrap();
    let bodies = world.add_bodies(&descs).unwrap();
    let top = *bodies.last().unwrap();
    let start = world.position(top).unwrap();
    let mut way = Vec::new();
    for _ in 0..20 {
        common::steps(&mut world, 60, DT);
        let moved = world.position(top).unwrap() - start;
        way.push([common::sideways(moved), -moved.y]);
    }
    (way, bodies.iter().map(|&b| world.position(b).unwrap() - origin).collect())
}
