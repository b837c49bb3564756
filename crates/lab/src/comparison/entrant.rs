//! A world under one of the methods.

use super::method::Method;
use backstop::BodyHandle;
use backstop::Error;
use backstop::Settings;
use backstop::World;
use backstop_scene::Scene;

/// A world under one method.
#[derive(Debug)]
pub(super) struct Entrant {
    pub(super) world: World,
    pub(super) bodies: Vec<BodyHandle>,
}

impl Entrant {
    pub(super) fn new(scene: &Scene, method: &Method, threads: usize) -> Result<Entrant, Error> {
        let mut world = World::new(
            Settings::default()
                .with_gravity(scene.gravity)
                .with_continuous(method.continuous)
                .with_continuous_method(method.method)
                .with_threads(threads),
        )?;
        let bodies = scene.add_to(&mut world)?.bodies;
        Ok(Entrant { world, bodies })
    }
}
