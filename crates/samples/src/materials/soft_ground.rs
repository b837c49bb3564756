//! Soft contacts: crates sink into mats by g / (2 pi f)², and a mat without damping is a trampoline.

use crate::parts::{level_world, solid};
use backstop::glam::Vec3;
use backstop::{BodyDesc, BodyHandle, Error, Geometry, Material, ShapeDesc, World};

/// Frequencies of the mats [Hz], and half their height [m].
const HERTZ: [f32; 4] = [2.0, 3.0, 5.0, 10.0];
const MAT: f32 = 0.4;
/// Half the edge of a crate [m].
const CRATE: f32 = 0.35;

/// The mats with crates, and the trampoline with a ball.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>, BodyHandle), Error> {
    let (mut world, _) = level_world()?;
    let mut add_mat = |x: f32, soft: Material| {
        let mat = ShapeDesc::new(Geometry::cuboid(0.6, MAT, 0.6)).with_material(soft);
        world.add_body(&BodyDesc::fixed().with_position(Vec3::new(x, MAT, 0.0)).with_shape(mat))
    };
    for (i, hertz) in HERTZ.into_iter().enumerate() {
        add_mat(1.4 * i as f32 - 2.8, Material::default().with_contact_hertz(hertz))?;
    }
    add_mat(2.8, Material::default().with_contact_hertz(5.0).with_contact_damping(0.0))?;
    let mut crates = Vec::new();
    for i in 0..HERTZ.len() {
        let place = Vec3::new(1.4 * i as f32 - 2.8, 2.0 * MAT + CRATE, 0.0);
        crates.push(world.add_body(&solid(Geometry::cuboid(CRATE, CRATE, CRATE)).with_position(place))?);
    }
    let ball = solid(Geometry::sphere(0.4)).with_position(Vec3::new(2.8, 2.4, 0.0));
    let ball = world.add_body(&ball)?;
    Ok((world, crates, ball))
}

#[test]
fn the_softer_the_deeper() -> Result<(), Error> {
    let (mut world, crates, ball) = build()?;
    let (mut highest, start) = (0.0_f64, world.position(ball)?.y);
    for step in 0..60 * 10 {
        world.step(1.0 / 60.0)?;
        if step > 60 * 5 {
            highest = highest.max(world.position(ball)?.y);
        }
    }
    // After several jumps the ball comes back to most of its height.
    assert!(highest > 0.9 * start && highest < start + 0.01, "{highest} of {start} m");
    for (crate_, hertz) in crates.into_iter().zip(HERTZ) {
        let sunk = 2.0 * MAT + CRATE - world.position(crate_)?.y as f32;
        let expected = 9.81 / (std::f32::consts::TAU * hertz).powi(2);
        assert!((sunk - expected).abs() < 0.05 * expected, "{hertz} Hz: {sunk} of {expected} m");
    }
    Ok(())
}
