//! backstop, at its defaults.

use super::content::Meshes;
use super::{Config, Continuous, Engine};
use anyhow::Context;
use backstop::glam::Vec3;
use backstop::{BodyHandle, Geometry, Settings, TriangleMesh, World};
use backstop_lab::envelope::State;
use backstop_scene::Scene;
use std::sync::Arc;

struct Backstop {
    world: World,
    bodies: Vec<BodyHandle>,
}

pub(super) fn build(scene: &Scene, meshes: &Meshes, config: &Config) -> anyhow::Result<Box<dyn Engine>> {
    let usual = Settings::default();
    let continuous = match config.continuous {
        Continuous::Off => backstop::ContinuousMode::Discrete,
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
    let scene = with_own_meshes(scene, meshes)?;
    let bodies = scene.add_to(&mut world).context("the scene is refused")?.bodies;
    if config.threads > 1 {
        // A process is one run: the pool may be there already, and then has as many threads.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(config.threads).build_global();
    }
    Ok(Box::new(Backstop { world, bodies }))
}

/// The scene with meshes made anew, which the world then shares with nobody: they are part of its bytes.
fn with_own_meshes(scene: &Scene, meshes: &Meshes) -> anyhow::Result<Scene> {
    let mut scene = scene.clone();
    for shape in scene.bodies.iter_mut().flat_map(|body| &mut body.desc.shapes) {
        if let Geometry::Mesh(mesh) = &mut shape.geometry {
            let (vertices, triangles) = meshes.get(mesh)?.clone();
            *mesh = Arc::new(TriangleMesh::new(vertices, triangles)?);
        }
    }
    Ok(scene)
}

impl Engine for Backstop {
    fn step(&mut self, dt: f32) -> anyhow::Result<()> {
        self.world.step(dt)?;
        Ok(())
    }

    fn drive(&mut self, body: usize, linear: Vec3, angular: Vec3) -> anyhow::Result<()> {
        Ok(self.world.set_velocity(self.bodies[body], linear, angular)?)
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
        self.world.sleeping_body_count()
    }
}
