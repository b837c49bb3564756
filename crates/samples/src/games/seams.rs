//! Seams: balls and boxes glide over a floor of four hundred tiles and feel none of its seams.

use backstop::glam::Vec3;
use backstop::{BodyDesc, BodyHandle, Error, Geometry, Material, Settings, ShapeDesc, TriangleMesh, World};
use std::sync::Arc;

/// Tiles along both edges, half the edge of a tile [m], and the speed of the bodies [m/s].
const TILES: usize = 20;
const HALF: f32 = 0.5;
const SPEED: f32 = 5.0;

/// The floor, of tiles that are meshes and boxes in turn, between two walls, with the bodies on it.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let mut world = World::new(Settings::default())?;
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let corners = corners.map(|[x, z]| Vec3::new(HALF * x, 0.0, HALF * z)).to_vec();
    let tile = Arc::new(TriangleMesh::new(corners, vec![[0, 2, 1], [0, 3, 2]])?);
    // Without friction nothing turns a ball: it glides as the boxes do.
    let ice = Material::default().with_friction(0.0).with_restitution(1.0);
    let slick = |geometry| ShapeDesc::new(geometry).with_material(ice);
    for i in 0..TILES * TILES {
        let (row, column) = (i / TILES, i % TILES);
        let place = 2.0 * HALF * Vec3::new(column as f32 - 1.5, 0.0, row as f32 - 0.5 * (TILES - 1) as f32);
        let tile = if (row + column) % 2 == 0 {
            slick(Geometry::mesh(tile.clone()))
        } else {
            slick(Geometry::cuboid(HALF, 0.1, HALF)).with_position(Vec3::Y * -0.1)
        };
        world.add_body(&BodyDesc::fixed().with_position(place).with_shape(tile))?;
    }
    for x in [-2.1, 18.1] {
        let wall = slick(Geometry::cuboid(0.1, 0.5, HALF * TILES as f32));
        world.add_body(&BodyDesc::fixed().with_position(Vec3::new(x, 0.5, 0.0)).with_shape(wall))?;
    }
    let mut gliding = Vec::new();
    for i in 0..8 {
        let shape = [Geometry::sphere(0.3), Geometry::cuboid(0.3, 0.3, 0.3)][i % 2].clone();
        let place = Vec3::new(-1.0, 0.3, 2.0 * i as f32 - 7.13);
        let body = BodyDesc::dynamic().with_position(place).with_shape(slick(shape));
        gliding.push(world.add_body(&body.with_linear_velocity(Vec3::X * SPEED))?);
    }
    Ok((world, gliding))
}

#[test]
fn nothing_bumps() -> Result<(), Error> {
    let (mut world, gliding) = build()?;
    for _ in 0..60 * 15 {
        world.step(1.0 / 60.0)?;
        for &body in &gliding {
            let way = world.linear_velocity(body)?;
            assert!((way.x.abs() - SPEED).abs() < 0.01 && way.with_x(0.0).length() < 0.01, "{way} m/s");
        }
    }
    Ok(())
}
