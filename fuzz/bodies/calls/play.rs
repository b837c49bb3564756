//! Calls are made of a world.

use super::call::{
    Anchor, Call, CouplingSpec, Id, JointSpec, OfBody, OfCharacter, OfCoupling, OfJoint, OfRagdoll, OfShape,
    ShapeId,
};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyHandle, Character, CharacterHandle, CharacterSettings, ContactHook, ContactHooks, CoupledMotion,
    CouplingHandle, Error, Geometry, JointHandle, QueryFilter, Ragdoll, Ray, ShapeHandle, Skeleton, World,
};
use std::collections::BTreeMap;

/// The handles of what calls added. A snapshot brings them back with the world.
#[derive(Clone, Debug, Default)]
pub struct Handles {
    bodies: BTreeMap<Id, BodyHandle>,
    pub joints: BTreeMap<Id, JointHandle>,
    pub couplings: BTreeMap<Id, CouplingHandle>,
    characters: BTreeMap<Id, CharacterHandle>,
    ragdolls: BTreeMap<Id, Ragdoll>,
}

/// Hooks that do what follows from a number and from the points of the contact.
struct Hooks(u8);

impl ContactHooks for Hooks {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        let points =
            contact.points().map(|(at, separation)| at.x.to_bits() ^ u64::from(separation.to_bits()));
        let all = points.fold(u64::from(self.0), |all, point| all.rotate_left(5).wrapping_mul(31) ^ point);
        let share = (all >> 8 & 0xFF) as f32 / 255.0;
        // What is refused has no effect.
        match all % 8 {
            0 => contact.veto(),
            1 => drop(contact.set_friction(share, share)),
            2 => drop(contact.set_restitution(1.1 * share)),
            3 => drop(contact.set_surface_velocity((all >> 3) as usize % 3, Vec3::X * share)),
            4 => {
                let told = (contact.approach_speed(), contact.estimated_impulse(), contact.normal());
                assert!(told.1.is_finite() && told.2.is_finite(), "a hook is told {told:?}");
                let ray = Ray::new(DVec3::Y * 5.0, Vec3::NEG_Y * 10.0);
                drop(contact.world().cast_ray(&ray, &QueryFilter::new()));
            }
            _ => {}
        }
    }
}

/// One step.
pub fn step(world: &mut World, dt: f32, hooks: Option<u8>) -> Result<(), Error> {
    match hooks {
        Some(seed) => world.step_with(dt, &Hooks(seed)).map(drop),
        None => world.step(dt).map(drop),
    }
}

fn character(settings: CharacterSettings, at: DVec3, form: Option<&Geometry>) -> Result<Character, Error> {
    let mut character = Character::new(settings, at)?;
    if let Some(form) = form {
        character.set_shape(Some(form.clone()))?;
    }
    Ok(character)
}

/// The bones that a ragdoll of so many has.
fn skeleton(bones: usize, friction: f32) -> Skeleton {
    let mut skeleton = Skeleton::humanoid().with_friction(friction);
    skeleton.bones.truncate(bones);
    skeleton
}

impl Handles {
    fn body(&self, id: Id) -> BodyHandle {
        self.bodies.get(&id).copied().unwrap_or(BodyHandle::from_bits(0x7_0000_0001))
    }

    fn joint(&self, id: Id) -> JointHandle {
        self.joints.get(&id).copied().unwrap_or(JointHandle::from_bits(0x7_0000_0001))
    }

    pub fn shape(&self, world: &World, id: ShapeId) -> Option<ShapeHandle> {
        let shapes: Vec<_> = world.shapes(self.body(id.body)).ok()?.collect();
        shapes.get(usize::from(id.place) % shapes.len().max(1)).copied()
    }

    /// Makes a call that changes the world between steps.
    pub fn call(&mut self, world: &mut World, call: &Call) -> Result<(), Error> {
        match call {
            Call::AddBody(id, desc) => drop(self.bodies.insert(*id, world.add_body(desc)?)),
            Call::AddBodies(id, descs) => {
                let added = world.add_bodies(descs)?;
                self.bodies.extend((*id..).zip(added));
            }
            Call::RemoveBodies(ids) => world.remove_bodies(&ids.map(|id| self.body(id)))?,
            Call::Body(id, what) => of_body(world, self.body(*id), what)?,
            Call::Shape(id, what) => {
                let shape = self.shape(world, *id).unwrap_or(ShapeHandle::from_bits(0x7_0000_0001));
                of_shape(world, shape, what)?;
            }
            Call::AddJoint(id, spec) => {
                let joint = self.add_joint(world, spec)?;
                self.joints.insert(*id, joint);
            }
            Call::Joint(id, what) => of_joint(world, self.joint(*id), what)?,
            Call::AddCoupling(id, spec) => {
                let coupling = self.add_coupling(world, spec)?;
                self.couplings.insert(*id, coupling);
            }
            Call::Coupling(id, what) => {
                let stale = CouplingHandle::from_bits(0x7_0000_0001);
                of_coupling(world, self.couplings.get(id).copied().unwrap_or(stale), what)?;
            }
            Call::AddCharacter(id, settings, at, form) => {
                let character = character(*settings, *at, form.as_ref())?;
                self.characters.insert(*id, world.add_character(&character)?);
            }
            Call::Character(id, what) => {
                let stale = CharacterHandle::from_bits(0x7_0000_0001);
                of_character(world, self.characters.get(id).copied().unwrap_or(stale), what)?;
            }
            Call::AddRagdoll { id, bones, at, rotation, velocity, friction } => {
                let doll = skeleton(*bones, *friction).add_to(world, *at, *rotation, *velocity)?;
                self.bodies.extend((*id..).zip(doll.bodies.iter().copied()));
                self.joints.extend((*id + *bones as Id..).zip(doll.joints.iter().copied()));
                self.ragdolls.insert(*id, doll);
            }
            Call::Ragdoll(id, what) => {
                let Some(doll) = self.ragdolls.get(id) else { return Ok(()) };
                match what {
                    OfRagdoll::Motor { pose, spring, torque } => {
                        doll.drive_to(world, pose, *spring, *torque)?
                    }
                    OfRagdoll::Relax => doll.relax(world)?,
                }
            }
            Call::Settings(settings) => {
                let settings = settings.clone().with_threads(world.settings().threads);
                world.set_settings(settings)?;
            }
            Call::Origin(origin) => world.set_origin(*origin)?,
            Call::Step { .. }
            | Call::Query(..)
            | Call::Draw
            | Call::Save(_)
            | Call::Twice(_)
            | Call::GoBack(_) => {}
        }
        Ok(())
    }

    fn add_joint(&self, world: &mut World, spec: &JointSpec) -> Result<JointHandle, Error> {
        let mut desc = spec.desc.clone();
        desc.bodies = spec.bodies.map(|id| self.body(id));
        desc.frames = match &spec.anchor {
            Anchor::Frames(frames) => *frames,
            Anchor::Between(share, rotation) => {
                let [a, b] = [world.position(desc.bodies[0])?, world.position(desc.bodies[1])?];
                world.frames_at(desc.bodies, a + (b - a) * f64::from(*share), *rotation)?
            }
        };
        world.add_joint(&desc)
    }

    fn add_coupling(&self, world: &mut World, spec: &CouplingSpec) -> Result<CouplingHandle, Error> {
        let joints = spec.joints.map(|id| self.joint(id));
        // A screw couples two motions of one joint.
        let place = |i: usize| {
            let mut motion: CoupledMotion = spec.desc.motions[i];
            motion.joint = joints[i];
            motion
        };
        world.add_coupling(&spec.desc.with_motions([place(0), place(1)]))
    }
}

fn of_body(world: &mut World, body: BodyHandle, what: &OfBody) -> Result<(), Error> {
    match what {
        OfBody::Remove => world.remove_body(body),
        OfBody::Enable(enabled) => world.set_enabled(body, *enabled),
        OfBody::Pose(at, rotation) => world.set_pose(body, *at, *rotation),
        OfBody::SamePose => {
            let (at, rotation): (DVec3, Quat) = (world.position(body)?, world.rotation(body)?);
            world.set_pose(body, at, rotation)
        }
        OfBody::Velocity(linear, angular) => world.set_velocity(body, *linear, *angular),
        OfBody::LinearVelocity(linear) => world.set_linear_velocity(body, *linear),
        OfBody::AngularVelocity(angular) => world.set_angular_velocity(body, *angular),
        OfBody::MoveKinematic(at, rotation, dt) => world.move_kinematic(body, *at, *rotation, *dt),
        OfBody::Force(force, torque) => world.add_force_and_torque(body, *force, *torque),
        OfBody::ForceAt(force, at) => world.add_force_at(body, *force, *at),
        OfBody::Impulse(impulse, at) => world.apply_impulse_at(body, *impulse, *at),
        OfBody::AngularImpulse(impulse) => world.apply_angular_impulse(body, *impulse),
        OfBody::Mass(mass) => world.set_mass(body, *mass),
        OfBody::Kind(kind) => world.set_kind(body, *kind),
        OfBody::UserData(data) => world.set_user_data(body, *data),
        OfBody::GravityScale(scale) => world.set_gravity_scale(body, *scale),
        OfBody::Damping(linear, angular) => world.set_damping(body, *linear, *angular),
        OfBody::MaxSpeeds(linear, angular) => world.set_max_speeds(body, *linear, *angular),
        OfBody::Locks(translation, rotation) => world.set_locked_axes(body, *translation, *rotation),
        OfBody::Continuous(mode) => world.set_continuous(body, *mode),
        OfBody::SolvedAfter(above) => world.set_body_solved_after(body, *above),
        OfBody::Wake => world.wake(body),
        OfBody::SendToSleep => world.sleep(body),
        OfBody::CanSleep(can_sleep) => world.set_can_sleep(body, *can_sleep),
        OfBody::AddShape(shape) => world.add_shape(body, shape).map(drop),
    }
}

fn of_shape(world: &mut World, shape: ShapeHandle, what: &OfShape) -> Result<(), Error> {
    match what {
        OfShape::Remove => world.remove_shape(shape),
        OfShape::Material(material) => world.set_material(shape, *material),
        OfShape::Filter(filter) => world.set_filter(shape, *filter),
        OfShape::Listening(events, hooks) => {
            world.set_events(shape, *events)?;
            world.set_hooks(shape, *hooks)
        }
        OfShape::Sensor(sensor) => world.set_sensor(shape, *sensor),
        OfShape::SensesStatic(senses) => world.set_senses_static(shape, *senses),
        OfShape::UserData(data) => world.set_shape_user_data(shape, *data),
        OfShape::Geometry(geometry) => world.set_geometry(shape, geometry.clone()),
        OfShape::Pose(at, rotation) => world.set_shape_pose(shape, *at, *rotation),
        OfShape::Density(density) => world.set_density(shape, *density),
        OfShape::Heights(first, size, heights) => world.set_heights(shape, *first, *size, heights),
        OfShape::Holes(first, size, holes) => world.set_holes(shape, *first, *size, holes),
    }
}

fn of_joint(world: &mut World, joint: JointHandle, what: &OfJoint) -> Result<(), Error> {
    match what {
        OfJoint::Remove => world.remove_joint(joint),
        OfJoint::Limits(limits) => world.set_joint_limits(joint, limits),
        OfJoint::Drives(drives) => world.set_joint_motors(joint, drives),
        OfJoint::Limit(limit) => world.set_joint_limit(joint, *limit),
        OfJoint::Motor(drive) => world.set_joint_motor(joint, *drive),
        OfJoint::RemoveLimit(motion, axes) => world.remove_joint_limit(joint, *motion, *axes).map(drop),
        OfJoint::RemoveDrive(motion, axis) => world.remove_joint_motor(joint, *motion, *axis).map(drop),
        OfJoint::Target(motion, axis, position, velocity) => {
            world.set_joint_target(joint, *motion, *axis, *position, *velocity)
        }
        OfJoint::Frames(frames) => world.set_joint_frames(joint, *frames),
        OfJoint::Collide(collide) => world.set_joint_collide(joint, *collide),
        OfJoint::Strength(force, torque) => world.set_joint_break_force(joint, *force, *torque),
        OfJoint::Thresholds(force, torque) => world.set_joint_thresholds(joint, *force, *torque),
        OfJoint::UserData(data) => world.set_joint_user_data(joint, *data),
        OfJoint::SolvedAfter(above) => world.set_joint_solved_after(joint, *above),
    }
}

fn of_coupling(world: &mut World, coupling: CouplingHandle, what: &OfCoupling) -> Result<(), Error> {
    match what {
        OfCoupling::Remove => world.remove_coupling(coupling),
        OfCoupling::Factors(factors) => world.set_coupling_factors(coupling, *factors),
        OfCoupling::Range(range) => world.set_coupling_range(coupling, *range),
        OfCoupling::Strength(strength) => world.set_coupling_break_force(coupling, *strength),
        OfCoupling::UserData(data) => world.set_coupling_user_data(coupling, *data),
    }
}

fn of_character(world: &mut World, handle: CharacterHandle, what: &OfCharacter) -> Result<(), Error> {
    match what {
        OfCharacter::Remove => world.remove_character(handle),
        OfCharacter::Set(settings, at, form) => {
            let character = character(*settings, *at, form.as_ref())?;
            world.set_character(handle, &character)
        }
        OfCharacter::Walk { velocity, dt, push } => {
            let report = world.walk_character(handle, &QueryFilter::new(), *velocity, *dt)?;
            assert!(report.moved.is_finite() && report.velocity.is_finite(), "a walk told {report:?}");
            if *push {
                // A body that it ran into may have no place for the impulse any more.
                drop(report.push(world));
            }
            Ok(())
        }
    }
}
