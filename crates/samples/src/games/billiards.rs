//! Billiards: the break of fifteen balls on a table with six cushions.

use crate::parts::{fixed, level_world};
use backstop::glam::Vec3;
use backstop::{BodyDesc, BodyHandle, Error, Geometry, Material, ShapeDesc, World};

/// Half of the table, inside of the cushions, and its height [m].
const LENGTH: f32 = 1.27;
const WIDTH: f32 = 0.635;
const HEIGHT: f32 = 0.8;
/// Radius of a ball [m], and lever arm of its rolling friction [m].
const RADIUS: f32 = 0.0286;
const ROLLING: f32 = 0.0003;
/// Speed of the cue ball [m/s].
const SPEED: f32 = 7.0;

/// The table, with the cue ball on its way.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    let cloth = Material::default().with_friction(0.2).with_restitution(0.5);
    let ivory = Material::default().with_friction(0.06).with_restitution(0.95).with_rolling_friction(ROLLING);
    let mut add = |half: [f32; 3], at: Vec3| {
        let mut body = fixed(Geometry::cuboid(half[0], half[1], half[2])).with_position(at);
        body.shapes[0].material = cloth;
        world.add_body(&body)
    };
    add([LENGTH + 0.1, 0.5 * HEIGHT, WIDTH + 0.1], Vec3::Y * 0.5 * HEIGHT)?;
    for side in [-1.0, 1.0] {
        add([LENGTH + 0.1, 0.03, 0.05], Vec3::new(0.0, HEIGHT + 0.03, side * (WIDTH + 0.05)))?;
        add([0.05, 0.03, WIDTH], Vec3::new(side * (LENGTH + 0.05), HEIGHT + 0.03, 0.0))?;
    }
    let ball = ShapeDesc::new(Geometry::sphere(RADIUS)).with_density(1_700.0).with_material(ivory);
    let ball = BodyDesc::dynamic().with_shape(ball);
    let ball = |x: f32, z: f32| ball.clone().with_position(Vec3::new(x, HEIGHT + RADIUS, z));
    let mut balls = vec![world.add_body(&ball(-0.7, 0.01).with_linear_velocity(Vec3::X * SPEED))?];
    for row in 0..5 {
        for i in 0..=row {
            let (x, z) = (0.6 + 1.74 * RADIUS * row as f32, 2.01 * RADIUS * (i as f32 - 0.5 * row as f32));
            balls.push(world.add_body(&ball(x, z))?);
        }
    }
    Ok((world, balls))
}

#[test]
fn balls_stay_on_the_table_and_come_to_rest() -> Result<(), Error> {
    let (mut world, balls) = build()?;
    crate::parts::run(&mut world, 40.0)?;
    for ball in balls {
        let (place, speed) = (world.position(ball)?.as_vec3(), world.linear_velocity(ball)?.length());
        assert!((place.y - HEIGHT - RADIUS).abs() < 0.002 && speed < 0.01, "{place}, {speed} m/s");
        assert!(place.x.abs() < LENGTH && place.z.abs() < WIDTH, "{place}");
    }
    Ok(())
}
