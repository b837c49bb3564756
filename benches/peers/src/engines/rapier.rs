//! Rapier, at its defaults.

use super::content::{Meshes, Turning, key, turning};
use super::{Config, Continuous, Engine};
use anyhow::Context;
use backstop::glam as bg;
use backstop::{BodyKind, Geometry};
use backstop_lab::envelope::State;
use backstop_scene::{Scene, SceneBody};
use rapier3d::prelude::*;
use std::collections::HashMap;

/// The build decides how Rapier runs, so it is part of the name.
pub(super) const NAME: &str = match (cfg!(feature = "rapier-parallel"), cfg!(feature = "rapier-simd8")) {
    (false, false) => "rapier",
    (false, true) => "rapier-simd8",
    (true, false) => "rapier-parallel",
    (true, true) => "rapier-parallel-simd8",
};

struct Rapier {
    world: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
    /// Hulls that are made.
    hulls: HashMap<usize, SharedShape>,
}

fn vec3(v: bg::Vec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

fn quat(q: bg::Quat) -> Rotation {
    Rotation::from_xyzw(q.x, q.y, q.z, q.w)
}

fn pose(position: bg::Vec3, rotation: bg::Quat) -> Pose {
    Pose::from_parts(vec3(position), quat(rotation))
}

pub(super) fn build(scene: &Scene, meshes: &Meshes, config: &Config) -> anyhow::Result<Box<dyn Engine>> {
    let mut world = PhysicsWorld::new();
    world.gravity = vec3(scene.gravity);
    let parameters = &mut world.integration_parameters;
    parameters.length_unit = config.length_unit;
    parameters.num_solver_iterations *= config.effort as usize;
    if let Some(speed) = config.max_speed {
        parameters.normalized_max_linear_velocity = speed / config.length_unit;
    }
    if config.continuous == Continuous::Off {
        parameters.max_ccd_substeps = 0;
    }
    set_threads(&mut world, config.threads)?;
    let mut this = Rapier { world, bodies: Vec::new(), hulls: HashMap::new() };
    for body in &scene.bodies {
        this.add_body(body, meshes, config)?;
    }
    for joint in &scene.joints {
        let frame = |side: usize| {
            let frame = &joint.frames[side];
            pose(frame.position, frame.rotation)
        };
        let (mask, range) = match turning(joint, config.hinge_ranges) {
            Turning::Hinge(range) => (JointAxesMask::LOCKED_REVOLUTE_AXES, range),
            Turning::Ball => (JointAxesMask::LOCKED_SPHERICAL_AXES, None),
        };
        let mut data = GenericJointBuilder::new(mask)
            .local_frame1(frame(0))
            .local_frame2(frame(1))
            .contacts_enabled(false);
        if let Some(range) = range {
            data = data.limits(JointAxis::AngX, range);
        }
        for motor in &joint.motors {
            // Its motors pull like dampers: this one is all but rigid.
            data = data
                .motor_velocity(JointAxis::AngX, motor.velocity, 1e6)
                .motor_max_force(JointAxis::AngX, motor.max_force);
        }
        let [a, b] = joint.bodies.map(|body| this.bodies[body]);
        this.world.insert_impulse_joint(a, b, data.build());
    }
    Ok(Box::new(this))
}

#[cfg(feature = "rapier-parallel")]
fn set_threads(world: &mut PhysicsWorld, threads: usize) -> anyhow::Result<()> {
    world.configure_thread_pool(threads).context("can't start threads")
}

#[cfg(not(feature = "rapier-parallel"))]
fn set_threads(_: &mut PhysicsWorld, threads: usize) -> anyhow::Result<()> {
    anyhow::ensure!(threads == 1, "this Rapier is built without `rapier-parallel`");
    Ok(())
}

impl Rapier {
    fn collider(&mut self, geometry: &Geometry, meshes: &Meshes) -> anyhow::Result<ColliderBuilder> {
        Ok(match geometry {
            Geometry::Sphere { radius } => ColliderBuilder::ball(*radius),
            Geometry::Capsule { half_height, radius_bottom, .. } => {
                ColliderBuilder::capsule_y(*half_height, *radius_bottom)
            }
            Geometry::Box { half_extents: half } => ColliderBuilder::cuboid(half.x, half.y, half.z),
            Geometry::Hull(hull) => {
                let made = match self.hulls.get(&key(hull)) {
                    Some(made) => made.clone(),
                    None => {
                        let points: Vec<_> = hull.vertices().iter().map(|&v| vec3(v)).collect();
                        SharedShape::convex_hull(&points).context("no hull")?
                    }
                };
                self.hulls.insert(key(hull), made.clone());
                ColliderBuilder::new(made)
            }
            Geometry::Mesh(mesh) => {
                let (vertices, triangles) = meshes.get(mesh)?.clone();
                ColliderBuilder::trimesh(vertices.into_iter().map(vec3).collect(), triangles)
                    .context("no mesh")?
            }
            other => anyhow::bail!("no {}", other.kind_name()),
        })
    }

    fn add_body(&mut self, body: &SceneBody, meshes: &Meshes, config: &Config) -> anyhow::Result<()> {
        let desc = &body.desc;
        let builder = match desc.kind {
            BodyKind::Dynamic => {
                RigidBodyBuilder::dynamic().ccd_enabled(config.continuous == Continuous::All)
            }
            BodyKind::Kinematic => RigidBodyBuilder::kinematic_velocity_based(),
            BodyKind::Static => RigidBodyBuilder::fixed(),
        };
        let handle = self.world.insert_body(
            builder
                .pose(pose(desc.position.as_vec3(), desc.rotation))
                .linvel(vec3(desc.linear_velocity))
                .angvel(vec3(desc.angular_velocity))
                .can_sleep(config.sleeping),
        );
        for shape in &desc.shapes {
            let collider = self
                .collider(&shape.geometry, meshes)?
                .position(pose(shape.position, shape.rotation))
                .density(shape.density)
                .friction(shape.material.dynamic_friction)
                .restitution(shape.material.restitution);
            self.world.insert_collider(collider, Some(handle));
        }
        self.bodies.push(handle);
        Ok(())
    }
}

impl Engine for Rapier {
    fn step(&mut self, dt: f32) -> anyhow::Result<()> {
        self.world.integration_parameters.dt = dt;
        self.world.step();
        Ok(())
    }

    fn drive(&mut self, body: usize, linear: bg::Vec3, angular: bg::Vec3) -> anyhow::Result<()> {
        let body = &mut self.world.bodies[self.bodies[body]];
        body.set_linvel(vec3(linear), true);
        body.set_angvel(vec3(angular), true);
        Ok(())
    }

    fn state(&self, body: usize) -> State {
        let body = &self.world.bodies[self.bodies[body]];
        let (pose, v, w) = (body.position(), body.linvel(), body.angvel());
        let (p, q) = (pose.translation, pose.rotation);
        State {
            position: bg::DVec3::new(p.x.into(), p.y.into(), p.z.into()),
            rotation: bg::Quat::from_xyzw(q.x, q.y, q.z, q.w),
            linear: bg::Vec3::new(v.x, v.y, v.z),
            angular: bg::Vec3::new(w.x, w.y, w.z),
        }
    }

    fn asleep(&self) -> usize {
        let bodies = self.bodies.iter().map(|&handle| &self.world.bodies[handle]);
        bodies.filter(|body| body.is_dynamic() && body.is_sleeping()).count()
    }
}
