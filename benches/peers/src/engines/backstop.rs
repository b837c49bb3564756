//! backstop, at its defaults.

use super::{Config, Continuous, Engine};
use anyhow::Context;
use backstop::{BodyHandle, Settings, World};
use backstop_lab::envelope::State;
use backstop_scene::Scene;

struct Backstop {
    world: World,
    bodies: Vec<BodyHandle>,
    /// For more than one thread.
    pool: Option<rayon::ThreadPool>,
}

pub(super) fn build(scene: &Scene, config: &Config) -> anyhow::Result<Box<dyn Engine>> {
    let usual = Settings::default();
    let continuous = match config.continuous {
        Continuous::Off => backstop::Continuous::Discrete,
        Continuous::On | Continuous::All => usual.continuous,
    };
    let settings = usual
        .clone()
        .with_gravity(scene.gravity)
        .with_length_unit(config.length_unit)
        .with_threads(config.threads)
        .with_substeps(usual.substeps * config.effort)
        .with_continuous(continuous)
        .with_sleeping(config.sleeping);
    let mut world = World::new(settings).context("these settings are refused")?;
    let bodies = scene.add_to(&mut world).context("the scene is refused")?.bodies;
    let pool = match config.threads {
        1 => None,
        threads => Some(rayon::ThreadPoolBuilder::new().num_threads(threads).build()?),
    };
    Ok(Box::new(Backstop { world, bodies, pool }))
}

impl Engine for Backstop {
    fn step(&mut self, dt: f32) -> anyhow::Result<()> {
        let world = &mut self.world;
        match &self.pool {
            Some(pool) => pool.install(|| world.step(dt).map(drop))?,
            None => world.step(dt).map(drop)?,
        }
        Ok(())
    }

    fn state(&self, body: usize) -> State {
        let (world, body) = (&self.world, self.bodies[body]);
        let known = "bodies are never removed";
        State {
            position: world.position(body).expect(known),
            rotation: world.rotation(body).expect(known),
            linear: world.linear_velocity(body).expect(known),
            angular: world.angular_velocity(body).expect(known),
        }
    }

    fn asleep(&self) -> usize {
        self.world.asleep()
    }
}
