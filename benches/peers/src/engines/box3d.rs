//! Box3D through its C interface. Four substeps, as its documentation has them.

use super::content::{Meshes, Turning, turning};
use super::{Config, Continuous, Engine};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyKind, Geometry, ShapeDesc};
use backstop_lab::envelope::State;
use backstop_scene::{Scene, SceneBody, SceneJoint};
use box3d_sys::*;

const SUBSTEPS: u32 = 4;

struct Box3d {
    world: b3WorldId,
    bodies: Vec<b3BodyId>,
    dynamic: Vec<b3BodyId>,
    /// Shapes keep pointing to their mesh, so meshes live as long as the world.
    meshes: Vec<*mut b3MeshData>,
    substeps: i32,
    sleeping: bool,
    hinge_ranges: bool,
}

fn vec3(v: Vec3) -> b3Vec3 {
    b3Vec3 { x: v.x, y: v.y, z: v.z }
}

fn quat(q: Quat) -> b3Quat {
    b3Quat { v: vec3(Vec3::new(q.x, q.y, q.z)), s: q.w }
}

fn transform(shape: &ShapeDesc) -> b3Transform {
    b3Transform { p: vec3(shape.position), q: quat(shape.rotation) }
}

/// A rotation from z to x: its hinges turn about z, those of backstop about x.
fn z_to_x() -> Quat {
    Quat::from_rotation_arc(Vec3::Z, Vec3::X)
}

pub(super) fn build(scene: &Scene, meshes: &Meshes, config: &Config) -> anyhow::Result<Box<dyn Engine>> {
    // SAFETY: calls into the C library; every definition starts from its defaults, and every pointer outlives
    // its call. The length unit is global: one world lives at a time.
    unsafe {
        b3SetLengthUnitsPerMeter(config.length_unit);
        let mut def = b3DefaultWorldDef();
        def.gravity = vec3(scene.gravity);
        def.enableSleep = config.sleeping;
        def.enableContinuous = config.continuous != Continuous::Off;
        def.workerCount = config.threads as u32;
        if let Some(speed) = config.max_speed {
            def.maximumLinearSpeed = speed;
        }
        let mut this = Box3d {
            world: b3CreateWorld(&def),
            bodies: Vec::new(),
            dynamic: Vec::new(),
            meshes: Vec::new(),
            substeps: (SUBSTEPS * config.effort) as i32,
            sleeping: config.sleeping,
            hinge_ranges: config.hinge_ranges,
        };
        for body in &scene.bodies {
            this.add_body(body, meshes)?;
        }
        scene.joints.iter().for_each(|joint| this.add_joint(joint));
        Ok(Box::new(this))
    }
}

impl Box3d {
    unsafe fn add_body(&mut self, body: &SceneBody, meshes: &Meshes) -> anyhow::Result<()> {
        let desc = &body.desc;
        // SAFETY: as in `build`.
        unsafe {
            let mut def = b3DefaultBodyDef();
            def.type_ = match desc.kind {
                BodyKind::Dynamic => b3BodyType_b3_dynamicBody,
                BodyKind::Kinematic => b3BodyType_b3_kinematicBody,
                BodyKind::Static => b3BodyType_b3_staticBody,
            };
            def.position = vec3(desc.position.as_vec3());
            def.rotation = quat(desc.rotation);
            def.linearVelocity = vec3(desc.linear_velocity);
            def.angularVelocity = vec3(desc.angular_velocity);
            def.enableSleep = self.sleeping;
            let id = b3CreateBody(self.world, &def);
            anyhow::ensure!(
                !desc.shapes.is_empty() || desc.kind != BodyKind::Dynamic,
                "a body without a shape"
            );
            for shape in &desc.shapes {
                let mut def = b3DefaultShapeDef();
                def.density = shape.density;
                def.baseMaterial.friction = shape.material.dynamic_friction;
                def.baseMaterial.restitution = shape.material.restitution;
                // Once for all of them, below.
                def.updateBodyMass = false;
                self.add_shape(id, &def, (shape, meshes))?;
            }
            if desc.kind == BodyKind::Dynamic {
                b3Body_ApplyMassFromShapes(id);
                self.dynamic.push(id);
            }
            self.bodies.push(id);
        }
        Ok(())
    }

    unsafe fn add_shape(
        &mut self,
        body: b3BodyId,
        def: &b3ShapeDef,
        (shape, meshes): (&ShapeDesc, &Meshes),
    ) -> anyhow::Result<()> {
        // SAFETY: as in `build`.
        unsafe {
            match &shape.geometry {
                Geometry::Sphere { radius } => {
                    let sphere = b3Sphere { center: vec3(shape.position), radius: *radius };
                    b3CreateSphereShape(body, def, &sphere);
                }
                Geometry::Capsule { half_height, radius_bottom, .. } => {
                    let end = |y: Vec3| vec3(shape.position + shape.rotation * (y * *half_height));
                    let (center1, center2) = (end(Vec3::Y), end(Vec3::NEG_Y));
                    let capsule = b3Capsule { center1, center2, radius: *radius_bottom };
                    b3CreateCapsuleShape(body, def, &capsule);
                }
                Geometry::Box { half_extents: half } => {
                    let hull = b3MakeTransformedBoxHull(half.x, half.y, half.z, transform(shape));
                    b3CreateHullShape(body, def, &hull.base);
                }
                Geometry::Hull(hull) => {
                    let placed = |&v: &Vec3| vec3(shape.position + shape.rotation * v);
                    let points: Vec<b3Vec3> = hull.vertices().iter().map(placed).collect();
                    let count = points.len() as i32;
                    let hull = b3CreateHull(points.as_ptr(), count, count);
                    anyhow::ensure!(!hull.is_null(), "no hull");
                    b3CreateHullShape(body, def, hull);
                    b3DestroyHull(hull);
                }
                Geometry::Mesh(mesh) => {
                    anyhow::ensure!(shape.position == Vec3::ZERO, "meshes are at their body's origin");
                    let (vertices, triangles) = meshes.get(mesh)?;
                    let mut vertices: Vec<b3Vec3> = vertices.iter().copied().map(vec3).collect();
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
        let base = |mut base: b3JointDef| {
            let frames = [0, 1].map(|side| b3Transform {
                p: vec3(joint.frames[side].position),
                q: quat(joint.frames[side].rotation * z_to_x()),
            });
            base.bodyIdA = self.bodies[joint.bodies[0]];
            base.bodyIdB = self.bodies[joint.bodies[1]];
            [base.localFrameA, base.localFrameB] = frames;
            base
        };
        // SAFETY: as in `build`.
        unsafe {
            match turning(joint, self.hinge_ranges) {
                Turning::Hinge(range) => {
                    let mut def = b3DefaultRevoluteJointDef();
                    def.base = base(def.base);
                    if let Some([min, max]) = range {
                        (def.enableLimit, def.lowerAngle, def.upperAngle) = (true, min, max);
                    }
                    if let Some(motor) = joint.motors.first() {
                        def.enableMotor = true;
                        (def.motorSpeed, def.maxMotorTorque) = (motor.velocity, motor.max_force);
                    }
                    b3CreateRevoluteJoint(self.world, &def);
                }
                Turning::Ball => {
                    let mut def = b3DefaultSphericalJointDef();
                    def.base = base(def.base);
                    b3CreateSphericalJoint(self.world, &def);
                }
            }
        }
    }
}

impl Engine for Box3d {
    fn step(&mut self, dt: f32) -> anyhow::Result<()> {
        // SAFETY: the world is alive until `drop`.
        unsafe { b3World_Step(self.world, dt, self.substeps) }
        Ok(())
    }

    fn drive(&mut self, body: usize, linear: Vec3, angular: Vec3) -> anyhow::Result<()> {
        let id = self.bodies[body];
        // SAFETY: bodies are never destroyed before the world.
        unsafe {
            b3Body_SetLinearVelocity(id, vec3(linear));
            b3Body_SetAngularVelocity(id, vec3(angular));
        }
        Ok(())
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

    fn asleep(&self) -> usize {
        // SAFETY: as above.
        self.dynamic.iter().filter(|&&id| unsafe { !b3Body_IsAwake(id) }).count()
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
