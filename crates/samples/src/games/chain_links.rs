//! Chain links: rings which hang in each other by their holes, each made of convex hulls.

use crate::parts::level_world;
use backstop::glam::{Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Decomposition, Error, Pieces, World};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Radius of a ring, and of its wire [m].
const RING: f32 = 0.5;
const WIRE: f32 = 0.1;
/// Distance of neighbours in a taut chain [m].
const APART: f32 = 2.0 * (RING - WIRE);

/// The chain, which swings.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    let ring = ring()?;
    let mut links = Vec::new();
    for i in 0..8 {
        let body = if i == 0 { BodyDesc::fixed() } else { BodyDesc::dynamic() };
        let axis = if i % 2 == 0 { Vec3::X } else { Vec3::Z };
        let body = body
            .with_shapes(ring.shapes())
            .with_mass(ring.mass_properties(1000.0))
            .with_position(Vec3::Y * (7.0 - 0.98 * APART * i as f32))
            .with_rotation(Quat::from_axis_angle(axis, FRAC_PI_2))
            .with_linear_velocity(Vec3::X * (0.3 * i as f32));
        links.push(world.add_body(&body)?);
    }
    Ok((world, links))
}

/// What hulls make of the triangles of a ring around y.
fn ring() -> Result<Pieces, Error> {
    let (mut corners, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..16 {
        for j in 0..8 {
            let (sin, cos) = (TAU * j as f32 / 8.0).sin_cos();
            let turned = Quat::from_rotation_y(-TAU * i as f32 / 16.0);
            corners.push(turned * Vec3::new(RING + WIRE * cos, WIRE * sin, 0.0));
            let at = |i: u32, j: u32| i % 16 * 8 + j % 8;
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Decomposition::default().run(&corners, &triangles)
}

#[test]
fn the_links_hold_each_other() -> Result<(), Error> {
    let (mut world, links) = build()?;
    crate::parts::run(&mut world, 20.0)?;
    let lengths = links.windows(2).map(|two| Ok(world.position(two[0])?.distance(world.position(two[1])?)));
    assert!(lengths.collect::<Result<Vec<_>, Error>>()?.iter().all(|&length| length < 0.85));
    Ok(())
}
