//! The world: it owns every store; add, remove, change, look up.

mod budget;
mod joints;
mod sleep;

use crate::body::{Bodies, BodyDesc, BodyKind, Cold, Mass, NewBody, Pose, Previous, Traits};
use crate::broad_phase::{Aabb, BroadPhase, Now, Pair, aabb_of};
use crate::config::{Continuous, Settings};
use crate::constraint::RowGroup;
use crate::error::{Error, finite, finite3};
use crate::events::Events;
use crate::finish::StepReport;
use crate::forces::world_inertia;
use crate::handle::{BodyHandle, ShapeHandle, Slots};
use crate::joint::Joints;
use crate::lanes::Record;
use crate::memory::{Category, MemoryReport};
use crate::narrow_phase::Contacts;
use crate::record::record;
use crate::shape::{
    Collider, EVENTS, Filter, Geometry, HOOKS, Hot, Kind, MassProperties, Material, SENSOR, ShapeDesc,
    unit_quat,
};
use crate::sleep::Sleep;
use crate::snapshot::Revisions;
use crate::step::Buffers;
use glam::{DVec3, Quat, Vec3};

/// Bodies that move, collide and rest.
///
/// Everything is changed between steps, by handles that go stale when what they name is removed: a stale handle is an
/// [`Error`], never another body. A refused call changes nothing.
#[derive(Debug, Default)]
pub struct World {
    pub(crate) settings: Settings,
    pub(crate) bodies: Bodies,
    pub(crate) colliders: Colliders,
    pub(crate) broad: BroadPhase,
    /// Where what moves is now, for queries.
    pub(crate) now: Now,
    pub(crate) joints: Joints,
    pub(crate) contacts: Contacts,
    pub(crate) buffers: Buffers,
    pub(crate) report: StepReport,
    pub(crate) needs: Needs,
    pub(crate) origin: DVec3,
    assets: Assets,
    peaks: MemoryReport,
    removed: Vec<Pair>,
    pub(crate) sleep: Sleep,
    pub(crate) events: Events,
    /// Of what snapshots share.
    pub(crate) revisions: Revisions,
    /// While it is recorded or replayed.
    #[cfg(feature = "replay")]
    pub(crate) tape: Option<Box<crate::replay::Tape>>,
}

/// What the content of the world requires of a step; what nothing requires costs nothing.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Needs {
    /// Shapes with restitution, or with hooks, which may give them some.
    pub(crate) restitution: u32,
    /// Shapes that are listened to, are sensors, or have hooks.
    pub(crate) events: u32,
    pub(crate) sensors: u32,
    pub(crate) hooks: u32,
}

impl Needs {
    /// Counts a collider that comes (1) or goes (-1).
    fn count(&mut self, collider: &Collider, change: i32) {
        let has = |flag: u8| collider.flags & flag != 0;
        let add = |count: &mut u32, set: bool| {
            if set {
                *count = count.wrapping_add_signed(change);
            }
        };
        add(&mut self.restitution, collider.material.restitution > 0.0 || has(HOOKS));
        add(&mut self.events, has(EVENTS));
        add(&mut self.sensors, has(SENSOR));
        add(&mut self.hooks, has(HOOKS));
    }
}

/// Colliders by stable index, with their world poses.
#[derive(Debug, Default)]
pub(crate) struct Colliders {
    pub(crate) all: Vec<Collider>,
    pub(crate) hot: Vec<Hot>,
    pub(crate) poses: Vec<Pose>,
    pub(crate) slots: Slots,
}

/// Shared geometry, counted once however many shapes use it.
#[derive(Debug, Default)]
struct Assets {
    /// Address, uses, bytes.
    list: Vec<(usize, u32, Category, (usize, usize))>,
}

impl Assets {
    fn key(geometry: &Geometry) -> Option<(usize, Category, (usize, usize))> {
        match geometry {
            Geometry::Hull(hull) => {
                Some((std::sync::Arc::as_ptr(hull) as usize, Category::Shapes, hull.bytes()))
            }
            Geometry::Mesh(mesh) => {
                Some((std::sync::Arc::as_ptr(mesh) as usize, Category::Meshes, mesh.bytes()))
            }
            Geometry::HeightField(field) => {
                Some((std::sync::Arc::as_ptr(field) as usize, Category::Meshes, field.bytes()))
            }
            _ => None,
        }
    }

    fn add(&mut self, geometry: &Geometry) {
        if let Some((key, category, bytes)) = Self::key(geometry) {
            match self.list.binary_search_by_key(&key, |e| e.0) {
                Ok(i) => self.list[i].1 += 1,
                Err(i) => self.list.insert(i, (key, 1, category, bytes)),
            }
        }
    }

    fn remove(&mut self, geometry: &Geometry) {
        if let Some((key, ..)) = Self::key(geometry)
            && let Ok(i) = self.list.binary_search_by_key(&key, |e| e.0)
        {
            self.list[i].1 -= 1;
            if self.list[i].1 == 0 {
                self.list.remove(i);
            }
        }
    }

    /// Bytes that geometries would add, each counted once.
    fn cost<'a>(&self, geometries: impl Iterator<Item = &'a Geometry>) -> usize {
        let is_new = |key: usize| self.list.binary_search_by_key(&key, |e| e.0).is_err();
        let known = geometries.filter_map(Self::key);
        let mut new: Vec<(usize, usize)> =
            known.filter(|(key, ..)| is_new(*key)).map(|(key, _, (_, reserved))| (key, reserved)).collect();
        new.sort_unstable();
        new.dedup();
        new.iter().map(|(_, reserved)| reserved).sum()
    }
}

impl World {
    /// An empty world.
    ///
    /// # Errors
    /// If a setting is out of range.
    pub fn new(settings: Settings) -> Result<World, Error> {
        settings.validate()?;
        Ok(World { settings, ..World::default() })
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Replaces the settings; the next step uses them.
    ///
    /// # Errors
    /// If a setting is out of range.
    pub fn set_settings(&mut self, settings: Settings) -> Result<(), Error> {
        settings.validate()?;
        record!(self, SetSettings(settings.clone()));
        if settings.gravity != self.settings.gravity || !settings.sleeping {
            self.wake_all();
        }
        self.joints.changed |= settings.order != self.settings.order;
        self.settings = settings;
        Ok(())
    }

    /// The point that single-precision positions are relative to [m]. Zero unless set.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Moves the point that single-precision positions are relative to. Bodies stay where they are.
    ///
    /// # Errors
    /// If it is not finite.
    pub fn set_origin(&mut self, origin: DVec3) -> Result<(), Error> {
        finite_position(origin)?;
        record!(self, SetOrigin(origin));
        self.origin = origin;
        Ok(())
    }

    /// Adds a body.
    ///
    /// # Errors
    /// If its description is out of range, a dynamic body has no mass or a shape that only a static one may have, or
    /// the budget does not allow it.
    pub fn add_body(&mut self, desc: &BodyDesc) -> Result<BodyHandle, Error> {
        let (centre, mass) = self.check(desc)?;
        self.make_place(std::slice::from_ref(desc))?;
        record!(self, |tape| AddBody(tape.body(desc)));
        Ok(self.insert(desc, centre, mass))
    }

    /// Adds many bodies: all of them, or none.
    ///
    /// # Errors
    /// As for [`World::add_body`].
    pub fn add_bodies(&mut self, descs: &[BodyDesc]) -> Result<Vec<BodyHandle>, Error> {
        let masses = descs.iter().map(|d| self.check(d)).collect::<Result<Vec<_>, _>>()?;
        self.make_place(descs)?;
        record!(self, |tape| AddBodies(descs.iter().map(|desc| tape.body(desc)).collect()));
        self.bodies.reserve(descs.len());
        let shapes = descs.iter().map(|d| d.shapes.len()).sum();
        self.colliders.all.reserve(shapes);
        self.colliders.hot.reserve(shapes);
        self.colliders.poses.reserve(shapes);
        self.colliders.slots.reserve(shapes);
        Ok(descs.iter().zip(masses).map(|(desc, (cold, mass))| self.insert(desc, cold, mass)).collect())
    }

    /// Removes a body with its shapes.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn remove_body(&mut self, body: BodyHandle) -> Result<(), Error> {
        let index = self.index(body)?;
        record!(self, RemoveBody(body));
        let index = self.disturb(index);
        self.revise(index);
        self.remove_joints_of(body);
        let colliders = self.bodies.take_colliders(index);
        for &collider in colliders.as_slice() {
            self.drop_collider(collider);
        }
        let shapes = &mut self.colliders;
        self.bodies.remove(index as u32, |colliders, index| {
            colliders.as_slice().iter().for_each(|&c| shapes.follow(c, index));
        });
        Ok(())
    }

    /// Removes many bodies: all of them, or none.
    ///
    /// # Errors
    /// If a handle is stale.
    pub fn remove_bodies(&mut self, bodies: &[BodyHandle]) -> Result<(), Error> {
        bodies.iter().try_for_each(|&body| self.index(body).map(drop))?;
        // One that is named twice is gone the second time.
        for &body in bodies {
            if self.contains(body) {
                self.remove_body(body)?;
            }
        }
        Ok(())
    }

    /// Takes a body out of the world or puts it back, with its shapes and joints: one that is disabled does not move, touches
    /// nothing, and is seen by no query; its joints hold nothing. It keeps its handles, its pose and its velocities, and may
    /// be changed all the while.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_enabled(&mut self, body: BodyHandle, enabled: bool) -> Result<(), Error> {
        let index = self.index(body)?;
        if self.bodies.traits[index].disabled != enabled {
            return Ok(());
        }
        record!(self, SetEnabled(body, enabled));
        let index = self.disturb(index);
        self.revise(index);
        if !enabled {
            for place in 0..self.bodies.colliders[index].as_slice().len() {
                let collider = self.bodies.colliders[index].as_slice()[place];
                self.leave_broad(collider);
            }
        }
        let World { bodies, colliders, .. } = self;
        let index = bodies.set_enabled(index as u32, enabled, |own, index| {
            own.as_slice().iter().for_each(|&c| colliders.follow(c, index));
        });
        if enabled {
            for place in 0..self.bodies.colliders[index as usize].as_slice().len() {
                let collider = self.bodies.colliders[index as usize].as_slice()[place];
                self.colliders.place(collider, &self.bodies.pose[index as usize]);
                self.enter_broad(collider);
            }
        }
        self.joints.changed = true;
        Ok(())
    }

    /// Whether a body takes part in the world; see [`World::set_enabled`].
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn is_enabled(&self, body: BodyHandle) -> Result<bool, Error> {
        Ok(!self.bodies.traits[self.index(body)?].disabled)
    }

    /// Puts a further shape on a body; its mass follows if it comes from the shapes.
    ///
    /// # Errors
    /// If the handle is stale or the shape is refused.
    pub fn add_shape(&mut self, body: BodyHandle, shape: &ShapeDesc) -> Result<ShapeHandle, Error> {
        let index = self.index(body)?;
        shape.validate()?;
        if self.bodies.kind[index] == BodyKind::Dynamic {
            shape.geometry.require_convex()?;
        }
        let mass =
            MassProperties::of(&shape.geometry, shape.density).transformed(shape.position, shape.rotation);
        if self.bodies.kind[index] == BodyKind::Dynamic && mass.mass != 0.0 {
            movable(&mass)?;
        }
        self.make_place_for_shape(
            self.bodies.kind[index],
            shape,
            self.bodies.colliders[index].as_slice().len(),
        )?;
        record!(self, |tape| AddShape(body, tape.shape(shape)));
        let index = self.disturb(index);
        self.revise(index);
        let collider = self.new_collider(index, shape);
        if self.bodies.cold[index].mass_from_shapes && mass.mass > 0.0 {
            self.refresh_mass(index);
        }
        Ok(self.shape_handle(collider))
    }

    /// Takes a shape off its body; its mass follows if it comes from the shapes, unless none would be left.
    ///
    /// # Errors
    /// If the handle is stale, or a dynamic body would be left without mass.
    pub fn remove_shape(&mut self, shape: ShapeHandle) -> Result<(), Error> {
        let collider = self.collider(shape)?;
        let index = self.colliders.all[collider as usize].body as usize;
        let from_shapes =
            self.bodies.cold[index].mass_from_shapes && self.bodies.kind[index] == BodyKind::Dynamic;
        if from_shapes {
            let rest = self.bodies.colliders[index].as_slice().iter().filter(|&&c| c != collider);
            if !rest.clone().any(|&c| self.colliders.all[c as usize].density > 0.0) {
                return Err(Error::NoMass);
            }
        }
        record!(self, RemoveShape(shape));
        let index = self.disturb(index);
        self.revise(index);
        self.bodies.detach(index, collider);
        self.drop_collider(collider);
        if from_shapes {
            self.refresh_mass(index);
        }
        Ok(())
    }

    /// The shapes of a body.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn shapes(&self, body: BodyHandle) -> Result<impl Iterator<Item = ShapeHandle> + '_, Error> {
        let index = self.index(body)?;
        Ok(self.bodies.colliders[index].as_slice().iter().map(|&c| self.shape_handle(c)))
    }

    /// Form of a shape.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn geometry(&self, shape: ShapeHandle) -> Result<&Geometry, Error> {
        Ok(&self.colliders.all[self.collider(shape)? as usize].geometry)
    }

    /// Friction and restitution of a shape.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn material(&self, shape: ShapeHandle) -> Result<Material, Error> {
        Ok(self.colliders.all[self.collider(shape)? as usize].material)
    }

    /// Changes friction and restitution of a shape.
    ///
    /// # Errors
    /// If the handle is stale or a value is out of range.
    pub fn set_material(&mut self, shape: ShapeHandle, material: Material) -> Result<(), Error> {
        material.validate()?;
        let index = self.collider(shape)? as usize;
        record!(self, SetMaterial(shape, material));
        let body = self.disturb(self.colliders.all[index].body as usize);
        self.revise(body);
        let collider = &mut self.colliders.all[index];
        self.needs.count(collider, -1);
        collider.material = material;
        self.needs.count(collider, 1);
        Ok(())
    }

    /// Changes which shapes a shape collides with.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_filter(&mut self, shape: ShapeHandle, filter: Filter) -> Result<(), Error> {
        let index = self.collider(shape)?;
        record!(self, SetFilter(shape, filter));
        let body = self.disturb(self.colliders.all[index as usize].body as usize);
        self.revise(body);
        self.colliders.all[index as usize].filter = filter;
        self.broad.touch(index);
        self.disturb_box(&self.bounds(index));
        Ok(())
    }

    /// Sets whether contacts of a shape are heard of, and whether they are shown to hooks.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_listening(&mut self, shape: ShapeHandle, events: bool, hooks: bool) -> Result<(), Error> {
        let index = self.collider(shape)? as usize;
        record!(self, SetListening(shape, events, hooks));
        let collider = &mut self.colliders.all[index];
        self.needs.count(collider, -1);
        let body = collider.body as usize;
        collider.flags =
            collider.flags & SENSOR | if events { EVENTS } else { 0 } | if hooks { HOOKS } else { 0 };
        self.needs.count(collider, 1);
        self.colliders.hot[index].flags = collider.flags;
        self.revise(body);
        Ok(())
    }

    /// Makes a shape a sensor, or solid again.
    ///
    /// # Errors
    /// If the handle is stale, or a sensor would not be convex nor a plane.
    pub fn set_sensor(&mut self, shape: ShapeHandle, sensor: bool) -> Result<(), Error> {
        let index = self.collider(shape)?;
        let geometry = &self.colliders.all[index as usize].geometry;
        if sensor && !matches!(geometry, Geometry::Plane) {
            geometry.require_convex()?;
        }
        record!(self, SetSensor(shape, sensor));
        let body = self.disturb(self.colliders.all[index as usize].body as usize);
        self.revise(body);
        self.leave_broad(index);
        let collider = &mut self.colliders.all[index as usize];
        self.needs.count(collider, -1);
        collider.flags = collider.flags & !SENSOR | if sensor { SENSOR } else { 0 };
        self.needs.count(collider, 1);
        self.colliders.hot[index as usize].flags = collider.flags;
        self.enter_broad(index);
        Ok(())
    }

    /// The caller's number of a shape.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn shape_user_data(&self, shape: ShapeHandle) -> Result<u64, Error> {
        Ok(self.colliders.all[self.collider(shape)? as usize].user_data)
    }

    /// How many bodies there are.
    pub fn body_count(&self) -> usize {
        self.bodies.len()
    }

    /// All bodies: dynamic ones first, then kinematic, then dynamic ones that are asleep and
    /// those that are disabled, then static.
    pub fn bodies(&self) -> impl Iterator<Item = BodyHandle> + '_ {
        (0..self.bodies.len()).map(|index| self.handle_of(index))
    }

    /// Whether the handle still names a body.
    pub fn contains(&self, body: BodyHandle) -> bool {
        self.index(body).is_ok()
    }

    /// What moves a body.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn kind(&self, body: BodyHandle) -> Result<BodyKind, Error> {
        Ok(self.bodies.kind[self.index(body)?])
    }

    /// Where a body's origin is in the world [m].
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn position(&self, body: BodyHandle) -> Result<DVec3, Error> {
        let index = self.index(body)?;
        let (pose, cold) = (&self.bodies.pose[index], &self.bodies.cold[index]);
        let turn = pose.rotation * cold.axes.conjugate();
        Ok(pose.position - (turn * cold.centre).as_dvec3())
    }

    /// Where a body's origin is, relative to [`World::origin`] [m].
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn local_position(&self, body: BodyHandle) -> Result<Vec3, Error> {
        Ok((self.position(body)? - self.origin).as_vec3())
    }

    /// How a body's axes are turned.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn rotation(&self, body: BodyHandle) -> Result<Quat, Error> {
        let index = self.index(body)?;
        Ok(self.bodies.pose[index].rotation * self.bodies.cold[index].axes.conjugate())
    }

    /// Where a body's centre of mass is in the world [m].
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn centre_of_mass(&self, body: BodyHandle) -> Result<DVec3, Error> {
        Ok(self.bodies.pose[self.index(body)?].position)
    }

    /// Velocity of a body's centre of mass [m/s].
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn linear_velocity(&self, body: BodyHandle) -> Result<Vec3, Error> {
        Ok(self.bodies.velocity[self.index(body)?].linear)
    }

    /// Angular velocity of a body about the world's axes [rad/s].
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn angular_velocity(&self, body: BodyHandle) -> Result<Vec3, Error> {
        Ok(self.bodies.velocity[self.index(body)?].angular)
    }

    /// Mass of a body [kg]; zero for one that nothing can push.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn mass(&self, body: BodyHandle) -> Result<f32, Error> {
        Ok(self.bodies.cold[self.index(body)?].mass)
    }

    /// The caller's number of a body.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn user_data(&self, body: BodyHandle) -> Result<u64, Error> {
        Ok(self.bodies.cold[self.index(body)?].user_data)
    }

    /// Moves a body to a pose of its origin, at once.
    ///
    /// # Errors
    /// If the handle is stale or the pose is not one.
    pub fn set_pose(&mut self, body: BodyHandle, position: DVec3, rotation: Quat) -> Result<(), Error> {
        let index = self.index(body)?;
        finite_position(position)?;
        let unit = unit_quat("rotation", rotation)?;
        // As it was given: what is normalised twice may differ in a bit.
        record!(self, SetPose(body, position, rotation));
        let rotation = unit;
        let index = self.disturb(index);
        let cold = &self.bodies.cold[index];
        self.bodies.pose[index] = Pose {
            position: position + (rotation * cold.centre).as_dvec3(),
            rotation: (rotation * cold.axes).normalize(),
        };
        self.place_colliders(index);
        self.note_move(index);
        if self.bodies.kind[index] == BodyKind::Static {
            self.revise(index);
            for c in 0..self.bodies.colliders[index].as_slice().len() {
                let collider = self.bodies.colliders[index].as_slice()[c];
                self.leave_broad(collider);
                self.enter_broad(collider);
            }
        }
        Ok(())
    }

    /// Sets linear [m/s] and angular [rad/s] velocity. Has no effect on a static body.
    ///
    /// # Errors
    /// If the handle is stale or a number is not finite.
    pub fn set_velocity(&mut self, body: BodyHandle, linear: Vec3, angular: Vec3) -> Result<(), Error> {
        let index = self.index(body)?;
        finite3("linear velocity", linear)?;
        finite3("angular velocity", angular)?;
        record!(self, SetVelocity(body, linear, angular));
        if self.bodies.kind[index] != BodyKind::Static {
            let index = self.wake_body(index);
            let velocity = &mut self.bodies.velocity[index];
            (velocity.linear, velocity.angular) = (linear, angular);
        }
        Ok(())
    }

    /// Gives a kinematic body the velocity that takes it to a pose of its origin within the next step of `dt` seconds.
    ///
    /// # Errors
    /// If the handle is stale, the pose is not one or `dt` is not above zero.
    pub fn move_kinematic(
        &mut self,
        body: BodyHandle,
        position: DVec3,
        rotation: Quat,
        dt: f32,
    ) -> Result<(), Error> {
        let index = self.index(body)?;
        finite_position(position)?;
        let rotation = unit_quat("rotation", rotation)?;
        crate::error::positive("dt", dt)?;
        let (pose, cold) = (&self.bodies.pose[index], &self.bodies.cold[index]);
        let target = position + (rotation * cold.centre).as_dvec3();
        let linear = ((target - pose.position) / f64::from(dt)).as_vec3();
        let mut turn = rotation * cold.axes * pose.rotation.conjugate();
        if turn.w < 0.0 {
            turn = -turn;
        }
        // Not glam's `to_scaled_axis`: it asks the platform's arc tangent.
        let part = turn.xyz();
        let sine = part.length();
        let angle = if sine > 0.0 { 2.0 * libm::atan2f(sine, turn.w) / sine } else { 2.0 };
        self.set_velocity(body, linear, part * (angle / dt))
    }

    /// Adds a force [N] at the centre of mass and a torque [N m] to a dynamic body, for the next step.
    ///
    /// # Errors
    /// If the handle is stale, a number is not finite, or, for the first force of a world, the budget does not allow it.
    pub fn add_force(&mut self, body: BodyHandle, force: Vec3, torque: Vec3) -> Result<(), Error> {
        let index = self.index(body)?;
        finite3("force", force)?;
        finite3("torque", torque)?;
        self.make_place_for_forces()?;
        record!(self, AddForce(body, force, torque));
        let index = self.wake_body(index);
        let sum = &mut self.bodies.force[index];
        sum.linear += force;
        sum.angular += torque;
        Ok(())
    }

    /// Changes the velocity of a dynamic body by an impulse [N s] at a point of the world [m].
    ///
    /// # Errors
    /// If the handle is stale or a number is not finite.
    pub fn apply_impulse(&mut self, body: BodyHandle, impulse: Vec3, point: DVec3) -> Result<(), Error> {
        let index = self.index(body)?;
        finite3("impulse", impulse)?;
        finite_position(point)?;
        record!(self, ApplyImpulse(body, impulse, point));
        if self.bodies.kind[index] == BodyKind::Dynamic {
            let index = self.wake_body(index);
            let (mass, pose) = (&self.bodies.mass[index], &self.bodies.pose[index]);
            let t = (point - pose.position).as_vec3().cross(impulse);
            let inverse = world_inertia(&self.bodies, index);
            let change = Record {
                linear: impulse * mass.inverse,
                angular: inverse.mul(crate::lanes::Vec3::new(t.x, t.y, t.z)).lane(0),
                ..Record::default()
            };
            let velocity = &mut self.bodies.velocity[index];
            velocity.linear += change.linear;
            velocity.angular += change.angular;
            self.bodies.traits[index].lock(velocity);
        }
        Ok(())
    }

    /// Sets the factor on gravity.
    ///
    /// # Errors
    /// If the handle is stale or the number is not finite.
    pub fn set_gravity_scale(&mut self, body: BodyHandle, scale: f32) -> Result<(), Error> {
        let index = self.index(body)?;
        let scale = finite("gravity scale", scale)?;
        record!(self, SetGravityScale(body, scale));
        let index = self.wake_body(index);
        self.revise(index);
        self.bodies.traits[index].gravity_scale = scale;
        Ok(())
    }

    /// Sets how a body is kept from passing through others. Two bodies collide by the greater of their modes, save
    /// that what is static has none.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_continuous(&mut self, body: BodyHandle, mode: Continuous) -> Result<(), Error> {
        let index = self.index(body)?;
        record!(self, SetContinuous(body, mode));
        self.revise(index);
        self.bodies.traits[index].continuous = mode;
        let mode = self.bodies.mode(index);
        for &c in self.bodies.colliders[index].as_slice() {
            self.colliders.hot[c as usize].mode = mode;
        }
        Ok(())
    }

    /// Has the rows of a body solved right after those of a group, or in their own places again; see [`BodyDesc::raised`].
    ///
    /// # Errors
    /// If the handle is stale or the budget does not allow it.
    pub fn raise_body(&mut self, body: BodyHandle, above: Option<RowGroup>) -> Result<(), Error> {
        let index = self.index(body)?;
        self.make_place_for_raised(above.is_some())?;
        record!(self, RaiseBody(body, above));
        self.revise(index);
        self.bodies.raise(index, above);
        self.joints.changed = true;
        Ok(())
    }

    /// Replaces the mass of a body; from now on it does not follow from the shapes.
    ///
    /// # Errors
    /// If the handle is stale or the properties are not those of a body.
    pub fn set_mass(&mut self, body: BodyHandle, mass: MassProperties) -> Result<(), Error> {
        let index = self.index(body)?;
        mass.validate()?;
        record!(self, SetMass(body, mass));
        let index = self.wake_body(index);
        self.revise(index);
        self.bodies.cold[index].mass_from_shapes = false;
        self.replace_mass(index, &mass);
        Ok(())
    }

    /// What the last step did.
    pub fn report(&self) -> &StepReport {
        &self.report
    }

    /// A number that differs if any pose or velocity differs in a bit. Bodies count in the order of their handles.
    pub fn hash(&self) -> u64 {
        let mut order: Vec<(u32, usize)> =
            self.bodies.slot.iter().enumerate().map(|(i, &s)| (s, i)).collect();
        order.sort_unstable();
        let mut hash = 0xCBF2_9CE4_8422_2325u64;
        let mut add = |bits: u64| hash = (hash ^ bits).wrapping_mul(0x100_0000_01B3).rotate_left(5);
        for (_, index) in order {
            let (pose, v) = (&self.bodies.pose[index], &self.bodies.velocity[index]);
            pose.position.to_array().iter().for_each(|x| add(x.to_bits()));
            pose.rotation.to_array().iter().for_each(|x| add(x.to_bits().into()));
            v.linear.to_array().iter().chain(&v.angular.to_array()).for_each(|x| add(x.to_bits().into()));
        }
        hash
    }

    /// Kinetic energy of all dynamic bodies plus their potential energy in the world's gravity, relative to the
    /// world's zero [J].
    pub fn energy(&self) -> f64 {
        self.bodies
            .all_dynamic()
            .map(|i| {
                let (mass, pose, v) = (&self.bodies.mass[i], &self.bodies.pose[i], &self.bodies.velocity[i]);
                let m = f64::from(self.bodies.cold[i].mass);
                let local = pose.rotation.conjugate() * v.angular;
                let spin = 0.5 * f64::from(local.dot(mass.inertia * local));
                let linear = 0.5 * m * v.linear.as_dvec3().length_squared();
                let pull = f64::from(self.bodies.traits[i].gravity_scale) * self.settings.gravity.as_dvec3();
                linear + spin - m * pull.dot(pose.position)
            })
            .sum()
    }

    /// Whether it never had a body and never stepped: no handle was given out, and nothing depends on what was.
    #[cfg(feature = "replay")]
    pub(crate) fn is_new(&self) -> bool {
        self.bodies.slots.is_new() && self.buffers.dt == 0.0
    }

    pub(crate) fn index(&self, body: BodyHandle) -> Result<usize, Error> {
        self.bodies.slots.get(body.slot, body.generation).map(|i| i as usize).ok_or(Error::StaleBody)
    }

    pub(crate) fn collider(&self, shape: ShapeHandle) -> Result<u32, Error> {
        // A collider's slot is its index: it never moves.
        self.colliders.slots.get(shape.slot, shape.generation).ok_or(Error::StaleShape)
    }

    pub(crate) fn handle_of(&self, index: usize) -> BodyHandle {
        let slot = self.bodies.slot[index];
        BodyHandle { slot, generation: self.bodies.slots.generation(slot) }
    }

    pub(crate) fn shape_handle(&self, collider: u32) -> ShapeHandle {
        ShapeHandle { slot: collider, generation: self.colliders.slots.generation(collider) }
    }

    /// Checks a description and computes what the body's columns need.
    fn check(&self, desc: &BodyDesc) -> Result<(Cold, Mass), Error> {
        desc.validate()?;
        let total = desc.mass.unwrap_or_else(|| mass_of(&desc.shapes));
        if desc.kind == BodyKind::Dynamic && desc.mass.is_none() && total.mass <= 0.0 {
            return Err(Error::NoMass);
        }
        if desc.kind == BodyKind::Dynamic {
            movable(&total)?;
        }
        Ok(columns_of(&total, desc.kind, desc.user_data, desc.mass.is_none()))
    }

    fn insert(&mut self, desc: &BodyDesc, cold: Cold, mass: Mass) -> BodyHandle {
        let rotation = desc.rotation.normalize();
        let locks = Traits::lock_bits(desc.lock_translation, desc.lock_rotation);
        let moves = desc.kind != BodyKind::Static;
        let new = NewBody {
            kind: desc.kind,
            pose: Pose {
                position: desc.position + (rotation * cold.centre).as_dvec3(),
                rotation: (rotation * cold.axes).normalize(),
            },
            velocity: Record {
                linear: if moves { desc.linear_velocity } else { Vec3::ZERO },
                angular: if moves { desc.angular_velocity } else { Vec3::ZERO },
                ..Record::default()
            },
            mass,
            traits: Traits {
                gravity_scale: desc.gravity_scale,
                continuous: desc.continuous,
                locks,
                raised: desc.raised,
                sleepless: !desc.can_sleep,
                disabled: false,
            },
            cold,
        };
        let shapes = &mut self.colliders;
        let (slot, generation) = self.bodies.insert(new, |colliders, index| {
            colliders.as_slice().iter().for_each(|&c| shapes.follow(c, index));
        });
        let index = self.bodies.slots.get(slot, generation).unwrap_or(0) as usize;
        self.revise(index);
        for shape in &desc.shapes {
            self.new_collider(index, shape);
        }
        BodyHandle { slot, generation }
    }

    /// Something about a body changed that snapshots share.
    fn revise(&mut self, index: usize) {
        self.revisions.moving += 1;
        self.revisions.fixed += u64::from(self.bodies.kind[index] == BodyKind::Static);
    }

    /// Takes all shapes out, of whose slots there are so many.
    pub(crate) fn clear_colliders(&mut self, slots: usize) {
        let nothing = Collider {
            kind: Kind::Plane,
            body: u32::MAX,
            size: [0.0; 4],
            position: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            radius: 0.0,
            inner_radius: 0.0,
            geometry: Geometry::Plane,
            material: Material::default(),
            filter: Filter::default(),
            density: 0.0,
            flags: 0,
            user_data: 0,
        };
        let nowhere = Pose { position: DVec3::ZERO, rotation: Quat::IDENTITY };
        let shapes = &mut self.colliders;
        (self.assets, self.needs) = (Assets::default(), Needs::default());
        shapes.hot.clear();
        shapes.hot.resize(slots, nothing.hot(Continuous::Discrete));
        shapes.all.clear();
        shapes.all.resize(slots, nothing);
        shapes.poses.clear();
        shapes.poses.resize(slots, nowhere);
        self.broad.reset(slots);
    }

    /// Puts a shape into the slot that it had.
    pub(crate) fn put_collider(&mut self, slot: u32, collider: &Collider, pose: Pose) {
        let mode = self.bodies.mode(collider.body as usize);
        self.assets.add(&collider.geometry);
        self.needs.count(collider, 1);
        self.colliders.hot[slot as usize] = collider.hot(mode);
        self.colliders.all[slot as usize].clone_from(collider);
        self.colliders.poses[slot as usize] = pose;
    }

    fn new_collider(&mut self, body: usize, shape: &ShapeDesc) -> u32 {
        let cold = &self.bodies.cold[body];
        let to_axes = cold.axes.conjugate();
        let geometry = &shape.geometry;
        let collider = Collider {
            kind: Kind::of(geometry),
            body: body as u32,
            size: geometry.size(),
            position: to_axes * (shape.position - cold.centre),
            rotation: (to_axes * shape.rotation.normalize()).normalize(),
            radius: geometry.radius(),
            inner_radius: geometry.inner_radius(),
            geometry: geometry.clone(),
            material: shape.material,
            filter: shape.filter,
            density: shape.density,
            flags: shape.flags(),
            user_data: shape.user_data,
        };
        let mode = self.bodies.mode(body);
        self.assets.add(geometry);
        self.needs.count(&collider, 1);
        let next = self.colliders.all.len() as u32;
        let (slot, _) = self.colliders.slots.insert(next);
        if slot == next {
            self.colliders.hot.push(collider.hot(mode));
            self.colliders.all.push(collider);
            self.colliders.poses.push(self.bodies.pose[body]);
        } else {
            self.colliders.slots.moved(slot, slot);
            self.colliders.hot[slot as usize] = collider.hot(mode);
            self.colliders.all[slot as usize] = collider;
        }
        self.bodies.attach(body, slot);
        self.colliders.place(slot, &self.bodies.pose[body]);
        self.enter_broad(slot);
        slot
    }

    fn drop_collider(&mut self, collider: u32) {
        self.leave_broad(collider);
        let old = &mut self.colliders.all[collider as usize];
        self.needs.count(old, -1);
        self.assets.remove(&old.geometry);
        old.body = u32::MAX;
        old.geometry = Geometry::Plane;
        self.colliders.slots.remove(collider);
    }

    fn enter_broad(&mut self, collider: u32) {
        self.note_change(collider);
        let c = &self.colliders.all[collider as usize];
        let body = c.body as usize;
        if self.bodies.traits[body].disabled {
            self.broad.leave_place(collider);
            return;
        }
        if self.bodies.kind[body] == BodyKind::Static {
            let pose = &self.bodies.pose[body];
            let bounds = aabb_of(c, pose.position, pose.rotation);
            self.broad.insert_static(collider, bounds);
            self.buffers.finish.statics_changed();
            self.disturb_box(&bounds);
        } else {
            self.broad.insert_mover(collider);
        }
    }

    fn leave_broad(&mut self, collider: u32) {
        self.note_change(collider);
        self.removed.clear();
        self.broad.remove(collider, &mut self.removed);
        for place in 0..self.removed.len() {
            let pair = self.removed[place];
            self.part(&pair);
            self.contacts.remove_chain(pair.contact);
        }
    }

    /// Queries are to look where a collider is.
    fn note_change(&mut self, collider: u32) {
        if let Some(now) = self.now.change() {
            now.touch(collider);
        }
    }

    /// The same for all colliders of a body.
    fn note_move(&mut self, index: usize) {
        if let Some(now) = self.now.change() {
            self.bodies.colliders[index].as_slice().iter().for_each(|&c| now.touch(c));
        }
    }

    /// Box of a collider where its body is.
    pub(crate) fn bounds(&self, collider: u32) -> Aabb {
        let collider = &self.colliders.all[collider as usize];
        let pose = &self.bodies.pose[collider.body as usize];
        aabb_of(collider, pose.position, pose.rotation)
    }

    fn place_colliders(&mut self, body: usize) {
        for &collider in self.bodies.colliders[body].as_slice() {
            self.colliders.place(collider, &self.bodies.pose[body]);
        }
    }

    fn refresh_mass(&mut self, index: usize) {
        let cold = self.bodies.cold[index];
        let parts: Vec<MassProperties> = self.bodies.colliders[index]
            .as_slice()
            .iter()
            .map(|&c| {
                let c = &self.colliders.all[c as usize];
                let (position, rotation) = (cold.centre + cold.axes * c.position, cold.axes * c.rotation);
                MassProperties::of(&c.geometry, c.density).transformed(position, rotation)
            })
            .collect();
        self.replace_mass(index, &MassProperties::combine(&parts));
    }

    /// Moves the centre of mass and the principal axes under the colliders, which stay where they are.
    fn replace_mass(&mut self, index: usize, mass: &MassProperties) {
        let old = self.bodies.cold[index];
        let (cold, columns) = columns_of(mass, self.bodies.kind[index], old.user_data, old.mass_from_shapes);
        let pose = self.bodies.pose[index];
        let body = pose.rotation * old.axes.conjugate();
        let shift = body * (cold.centre - old.centre);
        self.bodies.pose[index] =
            Pose { position: pose.position + shift.as_dvec3(), rotation: (body * cold.axes).normalize() };
        let velocity = &mut self.bodies.velocity[index];
        velocity.linear += velocity.angular.cross(shift);
        self.bodies.cold[index] = cold;
        self.bodies.mass[index] = columns;
        // What can't turn is in no tree.
        let joined = self.joints.of_body(self.bodies.slot[index]).next().is_some();
        self.joints.changed |= joined;
        self.recentre_joints(index, &old);
        self.note_move(index);
        for &c in self.bodies.colliders[index].as_slice() {
            let c = &mut self.colliders.all[c as usize];
            c.position = cold.axes.conjugate() * (old.centre + old.axes * c.position - cold.centre);
            c.rotation = (cold.axes.conjugate() * old.axes * c.rotation).normalize();
        }
        for &c in self.bodies.colliders[index].as_slice() {
            let hot = &mut self.colliders.hot[c as usize];
            *hot = self.colliders.all[c as usize].hot(hot.mode);
        }
    }

    /// Makes the column that tells how long bodies have been at rest, if they may sleep.
    pub(crate) fn keep_rest(&mut self) {
        let wanted = if self.settings.sleeping { self.bodies.len() } else { 0 };
        self.bodies.rests = self.settings.sleeping;
        if self.bodies.rest.len() != wanted {
            self.bodies.rest.clear();
            self.bodies.rest.resize(wanted, 0.0);
            if wanted == 0 {
                self.bodies.rest.shrink_to_fit();
                self.sleep = Sleep::default();
            }
        }
    }

    pub(crate) fn keep_previous(&mut self) {
        let wanted = if self.needs.restitution > 0 { self.bodies.len() } else { 0 };
        if self.bodies.previous.len() != wanted {
            self.bodies.previous.clear();
            self.bodies.previous.resize(wanted, Previous::default());
            if wanted == 0 {
                self.bodies.previous.shrink_to_fit();
            }
        }
    }
}

impl Colliders {
    /// The collider's body has a new index.
    pub(crate) fn follow(&mut self, collider: u32, body: u32) {
        self.all[collider as usize].body = body;
        self.hot[collider as usize].body = body;
    }

    /// World pose of a collider from that of its body.
    pub(crate) fn place(&mut self, collider: u32, body: &Pose) {
        let c = &self.all[collider as usize];
        self.poses[collider as usize] = Pose {
            position: body.position + (body.rotation * c.position).as_dvec3(),
            rotation: body.rotation * c.rotation,
        };
    }
}

pub(crate) fn finite_position(position: DVec3) -> Result<(), Error> {
    match position.to_array().into_iter().find(|v| !v.is_finite()) {
        Some(value) => Err(Error::NotFinite { what: "position", value }),
        None => Ok(()),
    }
}

/// Whether mass and inertia, and one over them, are numbers: a body of 1e20 m is too heavy for them, one of 1e-20 m
/// too light.
fn movable(mass: &MassProperties) -> Result<(), Error> {
    let m = &mass.inertia;
    for (what, value) in [
        ("mass", mass.mass),
        ("moment of inertia", m.x_axis.x),
        ("moment of inertia", m.y_axis.y),
        ("moment of inertia", m.z_axis.z),
    ] {
        finite(what, value)?;
        finite(what, 1.0 / value)?;
    }
    Ok(())
}

fn mass_of(shapes: &[ShapeDesc]) -> MassProperties {
    let parts: Vec<MassProperties> = shapes
        .iter()
        .map(|s| MassProperties::of(&s.geometry, s.density).transformed(s.position, s.rotation))
        .collect();
    MassProperties::combine(&parts)
}

fn columns_of(mass: &MassProperties, kind: BodyKind, user_data: u64, mass_from_shapes: bool) -> (Cold, Mass) {
    // Rounding must not turn the axes of a body that is aligned with them already.
    let (m, tiny) =
        (mass.inertia, 1e-6 * mass.inertia.x_axis.x.max(mass.inertia.y_axis.y).max(mass.inertia.z_axis.z));
    let aligned = [m.x_axis.y, m.x_axis.z, m.y_axis.z].iter().all(|x| x.abs() <= tiny);
    let (moments, axes) = if aligned {
        (Vec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z), Quat::IDENTITY)
    } else {
        mass.principal()
    };
    let over = |x: f32| if x > 0.0 && x.is_finite() { 1.0 / x } else { 0.0 };
    let cold = Cold { centre: mass.center, axes, mass: mass.mass, mass_from_shapes, user_data };
    if kind != BodyKind::Dynamic {
        return (Cold { mass: 0.0, ..cold }, Mass::default());
    }
    let inverse_inertia = Vec3::new(over(moments.x), over(moments.y), over(moments.z));
    (cold, Mass { inverse: over(mass.mass), inertia: moments, inverse_inertia })
}
