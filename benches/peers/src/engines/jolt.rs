//! Jolt, through the C interface in `native/`. It has no length unit, and its manual advises to scale what it
//! is given instead: lengths on the other side are in the scene's length unit, and densities are as they are,
//! so masses are by its third power.

use super::content::{Meshes, Turning, key, turning};
use super::{Config, Continuous, Engine};
use anyhow::{Context, bail, ensure};
use backstop::glam::{Quat, Vec3};
use backstop::{BodyKind, Geometry, ShapeDesc};
use backstop_lab::envelope::State;
use backstop_scene::{Scene, SceneBody, SceneJoint};
use std::ptr::null;

pub(super) const VERSION: &str = env!("PEERS_JOLT");

/// A world on the other side.
#[repr(C)]
struct World {
    _private: [u8; 0],
}

#[repr(C)]
struct WorldDef {
    gravity: [f32; 3],
    bodies: u32,
    threads: u32,
    steps: u32,
}

#[repr(C)]
struct Shape {
    /// Its identity, if bodies share it.
    key: u64,
    kind: u32,
    density: f32,
    position: [f32; 3],
    rotation: [f32; 4],
    size: [f32; 3],
    points: *const f32,
    point_count: u32,
    indices: *const u32,
    triangle_count: u32,
}

#[repr(C)]
struct Body {
    kind: u32,
    friction: f32,
    restitution: f32,
    position: [f32; 3],
    rotation: [f32; 4],
    linear: [f32; 3],
    angular: [f32; 3],
    max_speed: f32,
    max_spin: f32,
    continuous: bool,
    sleeping: bool,
}

#[repr(C)]
struct Joint {
    bodies: [u32; 2],
    points: [[f32; 3]; 2],
    axes: [[f32; 3]; 2],
    normals: [[f32; 3]; 2],
    hinge: bool,
    limited: bool,
    driven: bool,
    range: [f32; 2],
    /// Speed and torque.
    motor: [f32; 2],
}

#[repr(C)]
#[derive(Default)]
struct BodyState {
    position: [f32; 3],
    rotation: [f32; 4],
    linear: [f32; 3],
    angular: [f32; 3],
}

unsafe extern "C" {
    fn peers_world_new(def: *const WorldDef) -> *mut World;
    fn peers_world_delete(world: *mut World);
    fn peers_add_body(world: *mut World, def: *const Body, shapes: *const Shape, count: u32) -> bool;
    fn peers_add_joint(world: *mut World, joint: *const Joint);
    fn peers_start(world: *mut World);
    fn peers_step(world: *mut World, dt: f32) -> u32;
    fn peers_drive(world: *mut World, index: u32, linear: *const f32, angular: *const f32);
    fn peers_state(world: *const World, index: u32, state: *mut BodyState);
    fn peers_asleep(world: *const World) -> u32;
}

struct Jolt {
    world: *mut World,
    /// The length unit [m].
    unit: f32,
}

pub(super) fn build(scene: &Scene, meshes: &Meshes, config: &Config) -> anyhow::Result<Box<dyn Engine>> {
    let def = WorldDef {
        gravity: (scene.gravity / config.length_unit).to_array(),
        bodies: scene.bodies.len() as u32,
        threads: config.threads as u32,
        // Whole collision steps: it has no substeps of the solver alone.
        steps: config.effort,
    };
    // SAFETY: the definition outlives the call.
    let this = Jolt { world: unsafe { peers_world_new(&def) }, unit: config.length_unit };
    for body in &scene.bodies {
        this.add_body(body, meshes, config)?;
    }
    scene.joints.iter().for_each(|joint| this.add_joint(joint, config));
    // SAFETY: all bodies are there, and the world is alive until `drop`.
    unsafe { peers_start(this.world) };
    Ok(Box::new(this))
}

impl Jolt {
    fn add_body(&self, body: &SceneBody, meshes: &Meshes, config: &Config) -> anyhow::Result<()> {
        let desc = &body.desc;
        let first = desc.shapes.first().context("Jolt has no bodies without shapes")?;
        let def = Body {
            kind: match desc.kind {
                BodyKind::Static => 0,
                BodyKind::Kinematic => 1,
                BodyKind::Dynamic => 2,
            },
            friction: first.material.dynamic_friction,
            restitution: first.material.restitution,
            position: (desc.position.as_vec3() / self.unit).to_array(),
            rotation: desc.rotation.to_array(),
            linear: (desc.linear_velocity / self.unit).to_array(),
            angular: desc.angular_velocity.to_array(),
            // Its own default.
            max_speed: config.max_speed.map_or(500.0, |speed| speed / self.unit),
            max_spin: config.max_spin,
            continuous: config.continuous != Continuous::Off,
            sleeping: config.sleeping,
        };
        let points = desc.shapes.iter().map(|shape| Points::of(&shape.geometry, meshes, self.unit));
        let points = points.collect::<anyhow::Result<Vec<Points>>>()?;
        let shapes = desc.shapes.iter().zip(&points).map(|(desc, points)| shape(desc, points, self.unit));
        let shapes = shapes.collect::<anyhow::Result<Vec<Shape>>>()?;
        // SAFETY: all pointers outlive the call, and counts are those of what they point to.
        let added = unsafe { peers_add_body(self.world, &def, shapes.as_ptr(), shapes.len() as u32) };
        ensure!(added, "Jolt refuses \"{}\"", body.name);
        Ok(())
    }

    fn add_joint(&self, joint: &SceneJoint, config: &Config) {
        // In the axes of each body: far from the origin, points in the world would be rounded.
        let of = |place: &dyn Fn(usize) -> Vec3| [place(0).to_array(), place(1).to_array()];
        let axis = |axis: Vec3| of(&|side: usize| joint.frames[side].rotation * axis);
        let (hinge, range) = match turning(joint, config.hinge_ranges) {
            Turning::Ball => (false, None),
            Turning::Hinge(range) => (true, range),
        };
        let motor = joint.motors.first();
        // Lengths by the unit, masses by its third power.
        let torque = |torque: f32| torque / self.unit.powi(5);
        let def = Joint {
            bodies: joint.bodies.map(|body| body as u32),
            points: of(&|side: usize| joint.frames[side].position / self.unit),
            axes: axis(Vec3::X),
            normals: axis(Vec3::Y),
            hinge,
            limited: range.is_some(),
            driven: motor.is_some(),
            range: range.unwrap_or_default(),
            motor: motor.map_or([0.0; 2], |motor| [motor.velocity, torque(motor.max_force)]),
        };
        // SAFETY: the bodies were added, and the definition outlives the call.
        unsafe { peers_add_joint(self.world, &def) }
    }
}

/// Points and indices that a shape points to.
struct Points<'a> {
    points: Vec<f32>,
    triangles: &'a [[u32; 3]],
}

impl Points<'_> {
    fn of<'a>(geometry: &Geometry, meshes: &'a Meshes, unit: f32) -> anyhow::Result<Points<'a>> {
        let flat = |points: &[Vec3]| points.iter().flat_map(|&p| (p / unit).to_array()).collect();
        Ok(match geometry {
            Geometry::Hull(hull) => Points { points: flat(hull.vertices()), triangles: &[] },
            Geometry::Mesh(mesh) => {
                let (vertices, triangles) = meshes.get(mesh)?;
                Points { points: flat(vertices), triangles }
            }
            _ => Points { points: Vec::new(), triangles: &[] },
        })
    }
}

fn shape(desc: &ShapeDesc, points: &Points, unit: f32) -> anyhow::Result<Shape> {
    let (kind, size) = match &desc.geometry {
        Geometry::Sphere { radius } => (0, [*radius, 0.0, 0.0]),
        Geometry::Capsule { half_height, radius_bottom, .. } => (1, [*half_height, *radius_bottom, 0.0]),
        Geometry::Box { half_extents } => (2, half_extents.to_array()),
        Geometry::Hull(_) => (3, [0.0; 3]),
        Geometry::Mesh(_) => (4, [0.0; 3]),
        other => bail!("no {}", other.kind_name()),
    };
    let key = match &desc.geometry {
        Geometry::Hull(hull) => key(hull) as u64,
        _ => 0,
    };
    Ok(Shape {
        key,
        kind,
        density: desc.density,
        position: (desc.position / unit).to_array(),
        rotation: desc.rotation.to_array(),
        size: size.map(|length| length / unit),
        points: if points.points.is_empty() { null() } else { points.points.as_ptr() },
        point_count: (points.points.len() / 3) as u32,
        indices: points.triangles.as_flattened().as_ptr(),
        triangle_count: points.triangles.len() as u32,
    })
}

impl Engine for Jolt {
    fn step(&mut self, dt: f32) -> anyhow::Result<()> {
        // SAFETY: the world is alive until `drop`.
        let errors = unsafe { peers_step(self.world, dt) };
        ensure!(errors == 0, "a table of Jolt is full: errors {errors:#x}");
        Ok(())
    }

    fn drive(&mut self, body: usize, linear: Vec3, angular: Vec3) -> anyhow::Result<()> {
        let (linear, angular) = ((linear / self.unit).to_array(), angular.to_array());
        // SAFETY: as above; both have three numbers.
        unsafe { peers_drive(self.world, body as u32, linear.as_ptr(), angular.as_ptr()) };
        Ok(())
    }

    fn state(&self, body: usize) -> State {
        let mut state = BodyState::default();
        // SAFETY: as above; bodies are never removed.
        unsafe { peers_state(self.world, body as u32, &mut state) };
        State {
            position: Vec3::from_array(state.position).as_dvec3() * f64::from(self.unit),
            rotation: Quat::from_array(state.rotation),
            linear: Vec3::from_array(state.linear) * self.unit,
            angular: Vec3::from_array(state.angular),
        }
    }

    fn asleep(&self) -> usize {
        // SAFETY: as above.
        unsafe { peers_asleep(self.world) as usize }
    }
}

impl Drop for Jolt {
    fn drop(&mut self) {
        // SAFETY: nothing uses the world after this.
        unsafe { peers_world_delete(self.world) }
    }
}
