//! What fuzz targets do with bytes: for `cargo fuzz`, and for the seeded tests of the main package.

pub mod calls;
pub mod hulls;
pub mod input;
pub mod meshes;
pub mod recordings;
pub mod scenes;
pub mod settings;
pub mod snapshots;

#[path = "../../tests/common/snapshots.rs"]
mod checksum;

use backstop::World;

/// All that is told of bodies must be numbers.
pub fn check(world: &World) {
    for body in world.bodies() {
        let position = world.position(body).expect("a body of the world");
        let rotation = world.rotation(body).expect("a body of the world");
        let linear = world.linear_velocity(body).expect("a body of the world");
        let angular = world.angular_velocity(body).expect("a body of the world");
        assert!(
            position.is_finite() && rotation.is_finite() && linear.is_finite() && angular.is_finite(),
            "{body:?} at {position} {rotation}, moving {linear} {angular}"
        );
    }
}
