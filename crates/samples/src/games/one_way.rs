//! One-way platforms: balls pass them from below, and lie on them from above.

use crate::parts::{Driven, lawn, solid, spread};
use backstop::glam::Vec3;
use backstop::{BodyDesc, ContactHook, ContactHooks, Error, Geometry, ShapeDesc};

const BALLS: usize = 60;
/// Speed at which balls start upwards [m/s]: they reach v² / (2 g) = 7.3 m at most.
const SPEED: f32 = 12.0;
/// Heights of the platforms [m].
const HEIGHTS: [f32; 3] = [2.0, 3.5, 5.0];
/// User data of the shapes of platforms.
const PLATFORM: u64 = 1;

/// Contacts with a platform count for bodies from above only.
struct OneWay;

impl ContactHooks for OneWay {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        let Some(own) = contact.user_data().iter().position(|&data| data == PLATFORM) else { return };
        let [platform, other] = [contact.bodies()[own], contact.bodies()[1 - own]];
        let world = contact.world();
        let [low, high] = [platform, other].map(|body| world.position(body).map_or(0.0, |at| at.y));
        let rises = world.linear_velocity(other).is_ok_and(|way| way.y > 0.01);
        if rises || high < low + 0.15 {
            contact.veto();
        }
    }
}

/// Platforms, and balls on their way up.
pub fn start() -> Result<Driven, Error> {
    let (mut world, _) = lawn()?;
    for (i, height) in HEIGHTS.into_iter().enumerate() {
        let plate = ShapeDesc::new(Geometry::cuboid(2.0 - 0.4 * i as f32, 0.08, 1.5)).with_hooks();
        let plate = plate.with_user_data(PLATFORM);
        world.add_body(&BodyDesc::fixed().with_position(Vec3::Y * height).with_shape(plate))?;
    }
    for i in 0..BALLS {
        let place = Vec3::new(3.0 * spread(i) - 1.5, 0.2, 2.4 * spread(7 * i) - 1.2);
        let up = Vec3::Y * SPEED * (0.6 + 0.4 * spread(3 * i));
        world.add_body(&solid(Geometry::sphere(0.15)).with_position(place).with_linear_velocity(up))?;
    }
    Ok(Driven::hooked(world, OneWay))
}

#[test]
fn balls_end_on_platforms() -> Result<(), Error> {
    let mut sample = start()?;
    crate::parts::run(&mut sample, 10.0)?;
    let world = crate::Running::world(&sample);
    // On the ground or on a plate of 8 cm: nowhere else, and somewhere on each.
    let levels = [0.15, 2.23, 3.73, 5.23];
    let on = |level: f64| move |&body: &_| world.position(body).is_ok_and(|at| (at.y - level).abs() < 0.01);
    let counts = levels.map(|level| world.bodies().filter(on(level)).count());
    assert!(counts.iter().all(|&count| count > 5) && counts.iter().sum::<usize>() == BALLS, "{counts:?}");
    Ok(())
}
