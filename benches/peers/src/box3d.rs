//! Box3D through its C interface, at its defaults but for the gravity and the length unit of the scene;
//! nobody sleeps, and the limit of speeds is lifted. Four substeps, as its documentation has them.

use crate::Engine;
use crate::rapier::{hinges, triangles};
use anyhow::Context;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop_lab::envelope::State;
use backstop_scene::{Scene, SceneJoint};
use backstop::{BodyKind, Geometry};
use box3d_sys::*;

const SUBSTEPS: i32 = 4;

struct Box3d {
    world: b3WorldId,
    bodies: Vec<b3BodyId>,
    /// Shapes keep pointing to their mesh, so meshes live as long as the world.
    meshes: Vec<*mut b3MeshData>,
}

fn vec3(v: Vec3) -> b3Vec3 {
    b3Vec3 { x: v.x, y: v.y, z: v.z }
}

fn quat(q: Quat) -> b3Quat {
    b3Quat { v: vec3(Vec3::new(q.x, q.y, q.z)), s: q.w }
}

pub(crate) fn build(scene: &Scene, size: f32) -> anyhow::Result<Box<dyn Engine>> {
    // SAFETY: calls into the C library; every definition starts from its defaults, and every pointer outlives
    // its call. The length unit is global: one world lives at a time.
    unsafe {
        b3SetLengthUnitsPerMeter(size);
        let mut def = b3DefaultWorldDef();
        def.gravity = vec3(scene.gravity);
        def.enableSleep = false;
        def.enableContinuous = true;
        def.maximumLinearSpeed = 1e5;
        let mut this = Box3d { world: b3CreateWorld(&def), bodies: Vec::new(), meshes: Vec::new() };
        for body in &scene.bodies {
            let desc = &body.desc;
            let mut def = b3DefaultBodyDef();
            def.type_ = match desc.kind {
                BodyKind::Dynamic => b3BodyType_b3_dynamicBody,
                _ => b3BodyType_b3_staticBody,
            };
            def.position = vec3(desc.position.as_vec3());
            def.rotation = quat(desc.rotation);
            def.linearVelocity = vec3(desc.linear_velocity);
            def.angularVelocity = vec3(desc.angular_velocity);
            def.enableSleep = false;
            let id = b3CreateBody(this.world, &def);
            let shape = desc.shapes.first().context("a body without a shape")?;
            let mut def = b3DefaultShapeDef();
            def.density = shape.density;
            def.baseMaterial.friction = shape.material.dynamic_friction;
            def.baseMaterial.restitution = 0.0;
            this.add_shape(id, &def, &shape.geometry)?;
            this.bodies.push(id);
        }
        scene.joints.iter().for_each(|joint| this.add_joint(joint));
        Ok(Box::new(this))
    }
}

impl Box3d {
    unsafe fn add_shape(&mut self, body: b3BodyId, def: &b3ShapeDef, shape: &Geometry) -> anyhow::Result<()> {
        // SAFETY: as in `build`.
        unsafe {
            match shape {
                Geometry::Sphere { radius } => {
                    let sphere = b3Sphere { center: vec3(Vec3::ZERO), radius: *radius };
                    b3CreateSphereShape(body, def, &sphere);
                }
                Geometry::Capsule { half_height, radius_bottom, .. } => {
                    let ends = [Vec3::Y, Vec3::NEG_Y].map(|y| vec3(y * *half_height));
                    let capsule = b3Capsule { center1: ends[0], center2: ends[1], radius: *radius_bottom };
                    b3CreateCapsuleShape(body, def, &capsule);
                }
                Geometry::Box { half_extents: half } => {
                    let hull = b3MakeBoxHull(half.x, half.y, half.z);
                    b3CreateHullShape(body, def, &hull.base);
                }
                Geometry::Hull(hull) => {
                    let points: Vec<b3Vec3> = hull.vertices().iter().map(|&v| vec3(v)).collect();
                    let count = points.len() as i32;
                    let hull = b3CreateHull(points.as_ptr(), count, count);
                    anyhow::ensure!(!hull.is_null(), "no hull");
                    b3CreateHullShape(body, def, hull);
                    b3DestroyHull(hull);
                }
                Geometry::Mesh(mesh) => {
                    let (vertices, triangles) = triangles(mesh);
                    let mut vertices: Vec<b3Vec3> = vertices.into_iter().map(vec3).collect();
                    let mut indices: Vec<i32> = triangles.as_flattened().iter().map(|&i| i as i32).collect();
                    let mesh_def = b3MeshDef {
                        vertices: vertices.as_mut_ptr(),
                        indices: indices.as_mut_ptr(),
                        vertexCount: vertices.len() as i32,
                        triangleCount: triangles.len() as i32,
                        identifyEdges: true,
                        ..Default::default()
                    };
                    let data = b3CreateMesh(&mesh_def, std::ptr::null_mut(), 0);
                    anyhow::ensure!(!data.is_null(), "no mesh");
                    self.meshes.push(data);
                    b3CreateMeshShape(body, def, data, vec3(Vec3::ONE));
                }
                other => anyhow::bail!("no {}", other.kind_name()),
            }
        }
        Ok(())
    }

    unsafe fn add_joint(&mut self, joint: &SceneJoint) {
        // Box3D turns a revolute joint about the z axis of its frame, backstop about x.
        let z_to_x = Quat::from_rotation_arc(Vec3::Z, Vec3::X);
        let base = |mut base: b3JointDef| {
            let frames = [0, 1].map(|side| b3Transform {
                p: vec3(joint.frames[side].position),
                q: quat(joint.frames[side].rotation * z_to_x),
            });
            base.bodyIdA = self.bodies[joint.bodies[0]];
            base.bodyIdB = self.bodies[joint.bodies[1]];
            [base.localFrameA, base.localFrameB] = frames;
            base
        };
        // SAFETY: as in `build`.
        unsafe {
            if hinges(joint) {
                let mut def = b3DefaultRevoluteJointDef();
                def.base = base(def.base);
                b3CreateRevoluteJoint(self.world, &def);
            } else {
                let mut def = b3DefaultSphericalJointDef();
                def.base = base(def.base);
                b3CreateSphericalJoint(self.world, &def);
            }
        }
    }
}

impl Engine for Box3d {
    fn step(&mut self, dt: f32) {
        // SAFETY: the world is alive until `drop`.
        unsafe { b3World_Step(self.world, dt, SUBSTEPS) }
    }

    fn state(&self, body: usize) -> State {
        let id = self.bodies[body];
        // SAFETY: bodies are never destroyed before the world.
        let (pose, v, w) =
            unsafe { (b3Body_GetTransform(id), b3Body_GetLinearVelocity(id), b3Body_GetAngularVelocity(id)) };
        State {
            position: DVec3::new(pose.p.x.into(), pose.p.y.into(), pose.p.z.into()),
            rotation: Quat::from_xyzw(pose.q.v.x, pose.q.v.y, pose.q.v.z, pose.q.s),
            linear: Vec3::new(v.x, v.y, v.z),
            angular: Vec3::new(w.x, w.y, w.z),
        }
    }
}

impl Drop for Box3d {
    fn drop(&mut self) {
        // SAFETY: all were created in `build`, and nothing uses them after this.
        unsafe {
            b3DestroyWorld(self.world);
            self.meshes.iter().for_each(|&mesh| b3DestroyMesh(mesh));
        }
    }
}
