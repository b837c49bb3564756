//! Marble run: marbles roll down six gutters to and fro, into a tray.

use crate::parts::{level_world, solid};
use backstop::glam::{Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, ShapeDesc, World};

const GUTTERS: usize = 6;
const MARBLES: usize = 16;
/// Half length and half width of a gutter [m], and its slope [rad].
const LENGTH: f32 = 2.0;
const WIDTH: f32 = 0.2;
const SLOPE: f32 = 0.08;
/// Height of one gutter above the next [m].
const DROP: f32 = 0.8;
const RADIUS: f32 = 0.09;

/// The run, with the marbles above the highest gutter.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    let part =
        |half: Vec3, at: Vec3| ShapeDesc::new(Geometry::cuboid(half.x, half.y, half.z)).with_position(at);
    // A floor, two rails, and a wall at the upper end, against which marbles come from above.
    let floor = part(Vec3::new(LENGTH, 0.02, WIDTH), Vec3::ZERO);
    let rail = |side: f32| part(Vec3::new(LENGTH, 0.2, 0.02), Vec3::new(0.0, 0.18, side * WIDTH));
    for i in 0..GUTTERS {
        // Upper ends are left and right in turn, further out than the lower end of the one above.
        let side = if i % 2 == 0 { 1.0 } else { -1.0 };
        let end = part(Vec3::new(0.02, 0.4, WIDTH), Vec3::new(-side * LENGTH, 0.38, 0.0));
        let height = 0.5 + DROP * (GUTTERS - i) as f32;
        let gutter = BodyDesc::fixed()
            .with_position(Vec3::new(-side * 0.3, height, 0.0))
            .with_rotation(Quat::from_rotation_z(-side * SLOPE))
            .with_shapes([floor.clone(), rail(-1.0), rail(1.0), end]);
        world.add_body(&gutter)?;
    }
    let tray = [-1.0, 1.0].map(|side| part(Vec3::new(0.05, 0.3, 1.0), Vec3::new(side * 3.5, 0.3, 0.0)));
    let ends = [-1.0, 1.0].map(|side| part(Vec3::new(3.5, 0.3, 0.05), Vec3::new(0.0, 0.3, side)));
    world.add_body(&BodyDesc::fixed().with_shapes(tray.into_iter().chain(ends)))?;
    let mut marbles = Vec::new();
    for i in 0..MARBLES {
        let place = Vec3::new(-2.1 + 0.22 * i as f32, 0.8 + DROP * GUTTERS as f32, 0.0);
        marbles.push(world.add_body(&solid(Geometry::sphere(RADIUS)).with_position(place))?);
    }
    Ok((world, marbles))
}

#[test]
fn all_arrive_in_the_tray() -> Result<(), Error> {
    let (mut world, marbles) = build()?;
    crate::parts::run(&mut world, 40.0)?;
    for marble in marbles {
        let place = world.position(marble)?;
        assert!(place.y < 0.2 && place.x.abs() < 3.5 && place.z.abs() < 1.0, "{place}");
    }
    Ok(())
}
