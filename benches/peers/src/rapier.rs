//! Rapier, at its defaults but for the gravity and the length unit of the scene; nobody sleeps, and dynamic
//! bodies are continuous.

use crate::Engine;
use anyhow::Context;
use backstop::glam as bg;
use backstop_lab::envelope::State;
use backstop_scene::{Scene, SceneJoint};
use backstop::{BodyKind, Geometry, Motion, TriangleMesh};
use rapier3d::prelude::*;
use std::collections::HashMap;

struct Rapier {
    world: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
}

fn vec3(v: bg::Vec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

fn quat(q: bg::Quat) -> Rotation {
    Rotation::from_xyzw(q.x, q.y, q.z, q.w)
}

pub(crate) fn build(scene: &Scene, size: f32) -> anyhow::Result<Box<dyn Engine>> {
    let mut world = PhysicsWorld::new();
    world.gravity = vec3(scene.gravity);
    world.integration_parameters.length_unit = size;
    let mut bodies = Vec::new();
    for body in &scene.bodies {
        let desc = &body.desc;
        let builder = match desc.kind {
            BodyKind::Dynamic => RigidBodyBuilder::dynamic().ccd_enabled(true),
            _ => RigidBodyBuilder::fixed(),
        };
        let pose = Pose::from_parts(vec3(desc.position.as_vec3()), quat(desc.rotation));
        let handle = world.insert_body(
            builder
                .pose(pose)
                .linvel(vec3(desc.linear_velocity))
                .angvel(vec3(desc.angular_velocity))
                .can_sleep(false),
        );
        let shape = desc.shapes.first().context("a body without a shape")?;
        let collider = collider(&shape.geometry)?
            .density(shape.density)
            .friction(shape.material.dynamic_friction)
            .restitution(0.0);
        world.insert_collider(collider, Some(handle));
        bodies.push(handle);
    }
    for joint in &scene.joints {
        let frame = |side: usize| {
            let frame = &joint.frames[side];
            Pose::from_parts(vec3(frame.position), quat(frame.rotation))
        };
        let mask = match hinges(joint) {
            true => JointAxesMask::LOCKED_REVOLUTE_AXES,
            false => JointAxesMask::LOCKED_SPHERICAL_AXES,
        };
        let data = GenericJointBuilder::new(mask)
            .local_frame1(frame(0))
            .local_frame2(frame(1))
            .contacts_enabled(false)
            .build();
        world.insert_impulse_joint(bodies[joint.bodies[0]], bodies[joint.bodies[1]], data);
    }
    Ok(Box::new(Rapier { world, bodies }))
}

/// Whether a joint turns about one axis only; ranges about axes that are free are left out.
pub(crate) fn hinges(joint: &SceneJoint) -> bool {
    joint.limits.iter().any(|limit| limit.motion == Motion::Angular && limit.min == 0.0 && limit.max == 0.0)
}

/// The vertices of a mesh, each once, and its triangles.
pub(crate) fn triangles(mesh: &TriangleMesh) -> (Vec<bg::Vec3>, Vec<[u32; 3]>) {
    let (mut vertices, mut numbers) = (Vec::new(), HashMap::new());
    let triangles = (0..).map_while(|triangle| mesh.corners(triangle)).map(|corners| {
        corners.map(|corner| {
            *numbers.entry(corner.to_array().map(f32::to_bits)).or_insert_with(|| {
                vertices.push(corner);
                vertices.len() as u32 - 1
            })
        })
    });
    let triangles = triangles.collect();
    (vertices, triangles)
}

fn collider(geometry: &Geometry) -> anyhow::Result<ColliderBuilder> {
    Ok(match geometry {
        Geometry::Sphere { radius } => ColliderBuilder::ball(*radius),
        Geometry::Capsule { half_height, radius_bottom, .. } => {
            ColliderBuilder::capsule_y(*half_height, *radius_bottom)
        }
        Geometry::Box { half_extents: half } => ColliderBuilder::cuboid(half.x, half.y, half.z),
        Geometry::Hull(hull) => {
            let points: Vec<_> = hull.vertices().iter().map(|&v| vec3(v)).collect();
            ColliderBuilder::convex_hull(&points).context("no hull")?
        }
        Geometry::Mesh(mesh) => {
            let (vertices, triangles) = triangles(mesh);
            ColliderBuilder::trimesh(vertices.into_iter().map(vec3).collect(), triangles).context("no mesh")?
        }
        other => anyhow::bail!("no {}", other.kind_name()),
    })
}

impl Engine for Rapier {
    fn step(&mut self, dt: f32) {
        self.world.integration_parameters.dt = dt;
        self.world.step();
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
}
