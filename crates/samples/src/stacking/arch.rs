//! Arch: of two arches without mortar the thick one stands, and the thin one falls.

use crate::parts::{level_world, solid};
use backstop::glam::Vec3;
use backstop::{BodyHandle, ConvexHull, Error, Geometry, World};
use std::f32::consts::PI;

/// Radius of the middle line [m].
const RADIUS: f32 = 3.0;
const STONES: usize = 17;
/// Thickness over radius. A half circle stands above 0.107 (Heyman, *The Stone Skeleton*).
const THICK: f32 = 0.2;
const THIN: f32 = 0.08;

/// Both arches, the thick one behind.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, [BodyHandle; 2]), Error> {
    let (mut world, _) = level_world()?;
    let crowns = [add_arch(&mut world, THICK, -1.5)?, add_arch(&mut world, THIN, 1.5)?];
    Ok((world, crowns))
}

/// An arch across x; returns its highest stone.
fn add_arch(world: &mut World, ratio: f32, z: f32) -> Result<BodyHandle, Error> {
    let half_angle = 0.5 * PI / STONES as f32;
    let mut crown = None;
    for i in 0..STONES {
        let angle = (2 * i + 1) as f32 * half_angle;
        let middle = RADIUS * Vec3::new(angle.cos(), angle.sin(), 0.0);
        let mut corners = Vec::new();
        for side in [-half_angle, half_angle] {
            for radius in [RADIUS * (1.0 - 0.5 * ratio), RADIUS * (1.0 + 0.5 * ratio)] {
                let (sin, cos) = (angle + side).sin_cos();
                let corner = radius * Vec3::new(cos, sin, 0.0) - middle;
                corners.extend([corner - Vec3::Z * 0.5, corner + Vec3::Z * 0.5]);
            }
        }
        let stone = solid(Geometry::hull(ConvexHull::new(&corners)?));
        let stone = world.add_body(&stone.with_position(middle + Vec3::Z * z))?;
        if i == STONES / 2 {
            crown = Some(stone);
        }
    }
    Ok(crown.expect("there is a middle stone"))
}

#[test]
fn only_the_thick_one_stands() -> Result<(), Error> {
    let (mut world, [thick, thin]) = build()?;
    crate::parts::run(&mut world, 20.0)?;
    // Its joints close by the slop of the contacts, half a millimetre each, and the crown comes down by 3 cm.
    assert!((world.position(thick)?.y - 3.0).abs() < 0.05, "{}", world.position(thick)?);
    assert!(world.position(thin)?.y < 1.0, "{}", world.position(thin)?);
    Ok(())
}
