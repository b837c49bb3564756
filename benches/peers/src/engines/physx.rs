//! PhysX through its C interface: the CPU solver in both of its kinds.

use super::content::{Meshes, Turning, key, turning};
use super::{Config, Continuous, Engine};
use anyhow::{bail, ensure};
use backstop::glam::{Quat, Vec3};
use backstop::{BodyKind, Geometry, Material, ShapeDesc};
use backstop_lab::envelope::State;
use backstop_scene::{Scene, SceneBody, SceneJoint};
use physx_sys::*;
use std::collections::HashMap;
use std::ptr::{null, null_mut};

/// A moved body that nothing pushes: PhysX wants its next pose before each step.
struct Moved {
    actor: *mut PxRigidDynamic,
    linear: Vec3,
    angular: Vec3,
}

struct Physx {
    physics: *mut PxPhysics,
    scene: *mut PxScene,
    /// All bodies, and whether each is dynamic.
    actors: Vec<(*mut PxRigidActor, bool)>,
    dynamic: Vec<*mut PxRigidDynamic>,
    moved: Vec<Moved>,
    /// Hulls that are made.
    hulls: HashMap<usize, *mut PxConvexMesh>,
    effort: u32,
}

pub(super) fn tgs(scene: &Scene, meshes: &Meshes, config: &Config) -> anyhow::Result<Box<dyn Engine>> {
    build(scene, meshes, config, PxSolverType::Tgs)
}

pub(super) fn pgs(scene: &Scene, meshes: &Meshes, config: &Config) -> anyhow::Result<Box<dyn Engine>> {
    build(scene, meshes, config, PxSolverType::Pgs)
}

/// Greater effort means whole steps that are shorter: it has no substeps.
fn build(
    scene: &Scene,
    meshes: &Meshes,
    config: &Config,
    solver: PxSolverType,
) -> anyhow::Result<Box<dyn Engine>> {
    // SAFETY: calls into the C++ library; every pointer comes from it or outlives its call. A process makes
    // one world, and its end frees everything.
    unsafe {
        let physics = physx_create_physics(physx_create_foundation());
        ensure!(phys_PxInitExtensions(physics, null_mut()), "PhysX has no extensions");
        let mut desc = PxSceneDesc_new(PxPhysics_getTolerancesScale(physics));
        desc.gravity = vec3(scene.gravity);
        desc.solverType = solver;
        let wait = PxDefaultCpuDispatcherWaitForWorkMode::WaitForWork;
        // With one thread the caller's own steps: a worker would only add the way to it.
        let workers = if config.threads == 1 { 0 } else { config.threads as u32 };
        desc.cpuDispatcher = phys_PxDefaultCpuDispatcherCreate(workers, null_mut(), wait, 0).cast();
        if config.continuous == Continuous::Off {
            desc.filterShader = get_default_simulation_filter_shader();
        } else {
            desc.flags |= PxSceneFlags::EnableCcd;
            enable_custom_filter_shader(&mut desc, continuous_contacts, 0);
        }
        let mut this = Physx {
            physics,
            scene: PxPhysics_createScene_mut(physics, &desc),
            actors: Vec::new(),
            dynamic: Vec::new(),
            moved: Vec::new(),
            hulls: HashMap::new(),
            effort: config.effort,
        };
        ensure!(!this.scene.is_null(), "PhysX makes no scene");
        for body in &scene.bodies {
            this.add_body(body, meshes, config)?;
        }
        scene.joints.iter().for_each(|joint| this.add_joint(joint, config));
        Ok(Box::new(this))
    }
}

/// Contacts of every pair, found discretely and continuously.
unsafe extern "C" fn continuous_contacts(info: *mut FilterShaderCallbackInfo) -> PxFilterFlags {
    // SAFETY: PhysX hands out a valid structure for the time of this call.
    unsafe { *(*info).pairFlags = PxPairFlags::ContactDefault | PxPairFlags::DetectCcdContact }
    PxFilterFlags::empty()
}

impl Physx {
    unsafe fn add_body(&mut self, body: &SceneBody, meshes: &Meshes, config: &Config) -> anyhow::Result<()> {
        let desc = &body.desc;
        let pose = transform(desc.position.as_vec3(), desc.rotation);
        // SAFETY: as in `build`.
        unsafe {
            let actor: *mut PxRigidActor = match desc.kind {
                BodyKind::Static => PxPhysics_createRigidStatic_mut(self.physics, &pose).cast(),
                _ => PxPhysics_createRigidDynamic_mut(self.physics, &pose).cast(),
            };
            for shape in &desc.shapes {
                let made = self.shape(shape, meshes)?;
                ensure!(PxRigidActor_attachShape_mut(actor, made), "PhysX refuses \"{}\"", body.name);
            }
            match desc.kind {
                BodyKind::Static => {}
                BodyKind::Kinematic => {
                    PxRigidBody_setRigidBodyFlag_mut(actor.cast(), PxRigidBodyFlag::Kinematic, true);
                    let (linear, angular) = (desc.linear_velocity, desc.angular_velocity);
                    self.moved.push(Moved { actor: actor.cast(), linear, angular });
                }
                BodyKind::Dynamic => {
                    set_up(actor.cast(), body, config);
                    self.dynamic.push(actor.cast());
                }
            }
            PxScene_addActor_mut(self.scene, actor.cast(), null());
            if desc.kind == BodyKind::Dynamic && !config.sleeping {
                // With the threshold of zero this keeps it awake.
                PxRigidDynamic_setWakeCounter_mut(actor.cast(), 1e6);
            }
            self.actors.push((actor, desc.kind == BodyKind::Dynamic));
        }
        Ok(())
    }

    unsafe fn shape(&mut self, desc: &ShapeDesc, meshes: &Meshes) -> anyhow::Result<*mut PxShape> {
        let physics = self.physics;
        // SAFETY: as in `build`; what a description points to outlives the cooking.
        unsafe {
            let Material { dynamic_friction: friction, restitution, .. } = desc.material;
            let material = PxPhysics_createMaterial_mut(physics, friction, friction, restitution);
            let flags = PxShapeFlags::SceneQueryShape | PxShapeFlags::SimulationShape;
            let create = |geometry: *const PxGeometry| {
                PxPhysics_createShape_mut(physics, geometry, material, true, flags)
            };
            let cooking = PxCookingParams_new(&PxTolerancesScale_new(1.0, 10.0));
            let insert = PxPhysics_getPhysicsInsertionCallback_mut(physics);
            let whole = PxMeshScale_new();
            let mut turn = desc.rotation;
            let shape = match &desc.geometry {
                Geometry::Sphere { radius } => {
                    let geometry = PxSphereGeometry_new(*radius);
                    create((&raw const geometry).cast())
                }
                Geometry::Box { half_extents: half } => {
                    let geometry = PxBoxGeometry_new(half.x, half.y, half.z);
                    create((&raw const geometry).cast())
                }
                Geometry::Capsule { half_height, radius_bottom, .. } => {
                    // It lays capsules along x.
                    turn *= Quat::from_rotation_arc(Vec3::X, Vec3::Y);
                    let geometry = PxCapsuleGeometry_new(*radius_bottom, *half_height);
                    create((&raw const geometry).cast())
                }
                Geometry::Hull(hull) => {
                    let mesh = *self.hulls.entry(key(hull)).or_insert_with(|| {
                        let mut desc = PxConvexMeshDesc_new();
                        desc.points = data(hull.vertices());
                        desc.flags = PxConvexFlags::ComputeConvex;
                        phys_PxCreateConvexMesh(&cooking, &desc, insert, null_mut())
                    });
                    ensure!(!mesh.is_null(), "PhysX makes no hull");
                    let flags = PxConvexMeshGeometryFlags::empty();
                    let geometry = PxConvexMeshGeometry_new(mesh, &whole, flags);
                    create((&raw const geometry).cast())
                }
                Geometry::Mesh(mesh) => {
                    let (vertices, triangles) = meshes.get(mesh)?;
                    let mut desc = PxTriangleMeshDesc_new();
                    desc.points = data(vertices);
                    desc.triangles = data(triangles);
                    let mesh = phys_PxCreateTriangleMesh(&cooking, &desc, insert, null_mut());
                    ensure!(!mesh.is_null(), "PhysX makes no mesh");
                    let geometry = PxTriangleMeshGeometry_new(mesh, &whole, PxMeshGeometryFlags::empty());
                    create((&raw const geometry).cast())
                }
                other => bail!("no {}", other.kind_name()),
            };
            PxShape_setLocalPose_mut(shape, &transform(desc.position, turn));
            Ok(shape)
        }
    }

    unsafe fn add_joint(&self, joint: &SceneJoint, config: &Config) {
        let [a, b] = joint.bodies.map(|body| self.actors[body].0);
        let [on_a, on_b] = [0, 1].map(|side| {
            let frame = &joint.frames[side];
            transform(frame.position, frame.rotation)
        });
        // SAFETY: as in `build`.
        unsafe {
            match turning(joint, config.hinge_ranges) {
                Turning::Ball => {
                    phys_PxSphericalJointCreate(self.physics, a, &on_a, b, &on_b);
                }
                Turning::Hinge(range) => {
                    let hinge = phys_PxRevoluteJointCreate(self.physics, a, &on_a, b, &on_b);
                    if let Some([min, max]) = range {
                        PxRevoluteJoint_setLimit_mut(hinge, &PxJointAngularLimitPair_new(min, max, -1.0));
                        let flag = PxRevoluteJointFlag::LimitEnabled;
                        PxRevoluteJoint_setRevoluteJointFlag_mut(hinge, flag, true);
                    }
                }
            }
        }
    }

    /// Tells it where bodies go that nothing pushes.
    unsafe fn move_on(&self, dt: f32) {
        for Moved { actor, linear, angular } in &self.moved {
            // SAFETY: actors are never released.
            unsafe {
                let (p, q) = parts(PxRigidActor_getGlobalPose(actor.cast()));
                let turn = Quat::from_scaled_axis(*angular * dt);
                let target = transform(p + *linear * dt, (turn * q).normalize());
                PxRigidDynamic_setKinematicTarget_mut(*actor, &target);
            }
        }
    }
}

unsafe fn set_up(actor: *mut PxRigidDynamic, body: &SceneBody, config: &Config) {
    let desc = &body.desc;
    let densities: Vec<f32> = desc.shapes.iter().map(|shape| shape.density).collect();
    // SAFETY: as in `build`; there are as many densities as it is told.
    unsafe {
        let rigid: *mut PxRigidBody = actor.cast();
        let count = densities.len() as u32;
        PxRigidBodyExt_updateMassAndInertia(rigid, densities.as_ptr(), count, null(), false);
        PxRigidBody_setAngularDamping_mut(rigid, 0.0);
        PxRigidBody_setLinearDamping_mut(rigid, 0.0);
        if let Some(speed) = config.max_speed {
            PxRigidBody_setMaxLinearVelocity_mut(rigid, speed);
        }
        let continuous = config.continuous != Continuous::Off;
        PxRigidBody_setRigidBodyFlag_mut(rigid, PxRigidBodyFlag::EnableCcd, continuous);
        PxRigidDynamic_setLinearVelocity_mut(actor, &vec3(desc.linear_velocity), true);
        PxRigidDynamic_setAngularVelocity_mut(actor, &vec3(desc.angular_velocity), true);
        if !config.sleeping {
            PxRigidDynamic_setSleepThreshold_mut(actor, 0.0);
        }
    }
}

impl Engine for Physx {
    fn step(&mut self, dt: f32) -> anyhow::Result<()> {
        let part = dt / self.effort as f32;
        for _ in 0..self.effort {
            // SAFETY: the scene is alive as long as the process.
            unsafe {
                self.move_on(part);
                PxScene_simulate_mut(self.scene, part, null_mut(), null_mut(), 0, true);
                let mut error = 0;
                PxScene_fetchResults_mut(self.scene, true, &mut error);
                ensure!(error == 0, "PhysX reports error {error}");
            }
        }
        Ok(())
    }

    fn state(&self, body: usize) -> State {
        let (actor, is_dynamic) = self.actors[body];
        // SAFETY: actors are never released.
        let (position, rotation) = parts(unsafe { PxRigidActor_getGlobalPose(actor) });
        let rigid: *const PxRigidDynamic = actor.cast();
        let (v, w) = if is_dynamic {
            // SAFETY: as above.
            unsafe { (PxRigidDynamic_getLinearVelocity(rigid), PxRigidDynamic_getAngularVelocity(rigid)) }
        } else {
            (vec3(Vec3::ZERO), vec3(Vec3::ZERO))
        };
        State {
            position: position.as_dvec3(),
            rotation,
            linear: Vec3::new(v.x, v.y, v.z),
            angular: Vec3::new(w.x, w.y, w.z),
        }
    }

    fn asleep(&self) -> usize {
        // SAFETY: as above.
        self.dynamic.iter().filter(|&&actor| unsafe { PxRigidDynamic_isSleeping(actor) }).count()
    }
}

/// Points to `items`, which must outlive the objects made with it.
fn data<T>(items: &[T]) -> PxBoundedData {
    // SAFETY: makes an empty description.
    let mut data = unsafe { PxBoundedData_new() };
    data.count = items.len() as u32;
    data.stride = size_of::<T>() as u32;
    data.data = items.as_ptr().cast();
    data
}

fn vec3(v: Vec3) -> PxVec3 {
    PxVec3 { x: v.x, y: v.y, z: v.z }
}

fn transform(position: Vec3, rotation: Quat) -> PxTransform {
    let [x, y, z, w] = rotation.to_array();
    PxTransform { q: PxQuat { x, y, z, w }, p: vec3(position) }
}

fn parts(PxTransform { q, p }: PxTransform) -> (Vec3, Quat) {
    (Vec3::new(p.x, p.y, p.z), Quat::from_xyzw(q.x, q.y, q.z, q.w))
}
