//! Net: a net of beads hangs at its four corners and catches balls.

use crate::parts::level_world;
use backstop::glam::Vec3;
use backstop::{BodyDesc, BodyHandle, Error, Frame, Geometry, JointDesc, Material, ShapeDesc, World};

/// Beads along an edge, and the longest distance of two neighbours [m].
const SIDE: usize = 15;
const MESH: f32 = 0.3;
/// Height of the corners [m].
const HEIGHT: f32 = 3.5;
/// Radius of a ball [m]: wider than a mesh.
const RADIUS: f32 = 0.35;

/// The net, and the balls above it.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    let bead = ShapeDesc::new(Geometry::sphere(0.08)).with_density(5_000.0);
    let mut beads: Vec<BodyHandle> = Vec::new();
    let half = 0.5 * MESH * (SIDE - 1) as f32;
    for i in 0..SIDE * SIDE {
        let (row, column) = (i / SIDE, i % SIDE);
        let place = Vec3::new(MESH * column as f32 - half, HEIGHT, MESH * row as f32 - half);
        let corner = row % (SIDE - 1) == 0 && column % (SIDE - 1) == 0;
        let body = if corner { BodyDesc::fixed() } else { BodyDesc::dynamic().with_linear_damping(0.5) };
        let body = world.add_body(&body.with_position(place).with_shape(bead.clone()))?;
        let left = (column > 0).then(|| i - 1);
        let ahead = (row > 0).then(|| i - SIDE);
        for neighbour in left.into_iter().chain(ahead) {
            let frames = [Frame::default(); 2];
            world.add_joint(&JointDesc::distance([beads[neighbour], body], frames, 0.0, MESH))?;
        }
        beads.push(body);
    }
    let rubber = Material::default().with_restitution(0.5);
    let mut balls = Vec::new();
    for i in 0..9 {
        let place = Vec3::new((i % 3) as f32 - 1.0, HEIGHT + 0.8 + 0.4 * i as f32, (i / 3) as f32 - 1.0);
        let ball = ShapeDesc::new(Geometry::sphere(RADIUS)).with_density(150.0).with_material(rubber);
        balls.push(world.add_body(&BodyDesc::dynamic().with_position(place).with_shape(ball))?);
    }
    Ok((world, balls))
}

#[test]
fn no_ball_gets_through() -> Result<(), Error> {
    let (mut world, balls) = build()?;
    crate::parts::run(&mut world, 15.0)?;
    for ball in balls {
        let height = world.position(ball)?.y;
        assert!(height > 1.0 && height < f64::from(HEIGHT), "{height} m");
    }
    Ok(())
}
