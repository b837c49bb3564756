//! The rows of a step as one system: bodies, J, laws, and the impulse of each row by the engine's own solver.
//!
//! Contacts are read from the batches that the solver works on, so their normals, arms and coefficients are
//! the ones it used. Joints are evaluated anew in `f64` at the bodies' poses, by the same measures: their
//! batches hold blocks with directions eliminated and trees hold recursions only, so neither has rows of J.
//! Impulses are those of the batches, of trees and cut loops too, summed over the substeps of the step
//! (`Sums`).
//!
//! The system is that of the whole step with directions as they are at its start. Its unknowns are therefore
//! impulses of the step, and `u` is the velocity at its end.

mod contacts;
mod couplings;
mod frames;
mod islands;
mod joints;
mod sums;

pub use joints::{JointRow, joint_rows};

use super::law::Law;
use crate::body::Bodies;
use crate::constraint::Views;
use crate::forces::world_inertia;
use crate::handle::{BodyHandle, CouplingHandle, JointHandle};
use crate::lanes::{Record, Sym3};
use crate::world::World;
use glam::{DMat3, DVec3};
use joints::each_joint_row;
pub(super) use sums::{LaneRows, Sums};

/// A linear and an angular velocity [m/s], [rad/s].
pub type Velocity = [DVec3; 2];

/// A body that can move.
#[derive(Clone, Debug, PartialEq)]
pub struct SystemBody {
    /// Its handle.
    pub body: BodyHandle,
    /// Whether impulses move it; kinematic bodies go where the caller wants.
    pub dynamic: bool,
    /// Inverse mass by axis of the world, zero along locked ones [1/kg].
    pub inverse_mass: DVec3,
    /// Inverse inertia in the world's axes [1/(kg m²)].
    pub inverse_inertia: DMat3,
    /// Its centre of mass at the start of the step [m].
    pub centre: DVec3,
    /// Velocity at the start of the step.
    pub start: Velocity,
    /// The same with gravity and forces of the whole step applied, before any row acted.
    pub free: Velocity,
    /// Velocity at the end of the step.
    pub end: Velocity,
    /// Changes of its velocity by anything but gravity, forces and rows: friction of impacts, impacts as far
    /// as they are not in rows, and limits, minus the part of gravity and forces that was not applied.
    pub given: Velocity,
    /// Changes of its velocity by joints beyond those by the impulses of their rows: directions turn within
    /// the step, and rows have those at its start.
    pub turned: Velocity,
    /// Whether a tree of joints counted it as harder to turn than it is, by the stiffness of its load.
    pub stiffened: bool,
    /// Whether the engine moved it otherwise than by the impulses of its rows: in a tree of joints, bodies
    /// counted as heavier than they are or a substep was solved again; or it stood still after several
    /// impacts.
    pub unconserved: bool,
    /// Displacement [m] and rotation vector [rad] of the step.
    pub moved: Velocity,
    /// The caller's force [N] and torque [N m].
    pub force: Velocity,
}

/// The most bodies that a row moves: a coupling has two joints.
pub const SIDES: usize = 4;

/// A direction in which bodies move past each other. `u = Σ linear · v + angular · w` over all of them. Rows
/// of contacts and joints have two bodies, in the first two places; no body is in two places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SystemRow {
    /// Indices of the bodies; none for static ones.
    pub bodies: [Option<usize>; SIDES],
    /// J of the linear velocities.
    pub linear: [DVec3; SIDES],
    /// J of the angular velocities [m], or without a unit where the row is an angular one.
    pub angular: [DVec3; SIDES],
    /// Added to the velocity: motion of surfaces, minus the target speed of a motor [m/s] or [rad/s].
    pub bias: f64,
    /// Compliance: velocity per impulse [1/kg] or [1/(kg m²)]; zero for rigid rows.
    pub compliance: f64,
    /// Its impulse by the engine's solver over the step [N s] or [N m s].
    pub impulse: f64,
    /// Whether it measures an angle.
    pub angle: bool,
}

impl SystemRow {
    /// A rigid row without a velocity of its own, of bodies that it moves by these forces and torques.
    pub(super) fn of_two(bodies: [Option<usize>; 2], linear: [DVec3; 2], angular: [DVec3; 2]) -> SystemRow {
        SystemRow {
            bodies: of_two(bodies),
            linear: of_two(linear),
            angular: of_two(angular),
            bias: 0.0,
            compliance: 0.0,
            impulse: 0.0,
            angle: linear[1] == DVec3::ZERO,
        }
    }

    /// The same as seen from the other side.
    pub(super) fn times(mut self, sign: f64) -> SystemRow {
        self.linear = self.linear.map(|d| d * sign);
        self.angular = self.angular.map(|d| d * sign);
        self
    }
}

/// The contact, joint or coupling of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    /// A contact of two bodies, in the order of its rows.
    Contact([BodyHandle; 2]),
    /// A joint, a limit or a motor of it.
    Joint(JointHandle),
    /// A coupling of two motions of joints.
    Coupling(CouplingHandle),
}

/// One law over one or more rows in sequence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SystemLaw {
    /// The law; the normals of a patch are rows of the system.
    pub law: Law,
    /// Its first row.
    pub first: usize,
    /// Its contact, joint or coupling.
    pub owner: Owner,
    /// For one-sided laws, the gap at the start of the step [m] or [rad], negative in overlap.
    pub gap: Option<f64>,
    /// For locks, the error along its row at the start of the step [m] or [rad].
    pub off: f64,
    /// Whether the solver treated it as a potential contact point.
    pub potential: bool,
    /// For such a point, its coefficient of friction once it touches, and its arms from the centres of mass
    /// [m].
    pub impact: Option<(f64, [DVec3; 2])>,
    /// Coefficient of restitution.
    pub restitution: f64,
    /// Whether one of its bodies bounced in the step and had other contacts too.
    pub bouncing: bool,
    /// Whether it is a spring or a yielding motor.
    pub yields: bool,
    /// Whether it is a motor.
    pub drives: bool,
    /// Whether it is of a contact whose materials resist rolling or spinning.
    pub resists: bool,
    /// Size of the smaller of two shapes, from its middle to its surface [m].
    pub size: f64,
}

impl SystemLaw {
    /// A law of rigid rows that bounce off nothing.
    fn new(law: Law, owner: Owner) -> SystemLaw {
        SystemLaw {
            law,
            first: 0,
            owner,
            gap: None,
            off: 0.0,
            potential: false,
            impact: None,
            restitution: 0.0,
            bouncing: false,
            yields: false,
            drives: false,
            resists: false,
            size: f64::INFINITY,
        }
    }
}

/// Bodies that rows connect, and the laws between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SystemIsland {
    /// Indices of its dynamic bodies.
    pub bodies: Vec<usize>,
    /// Indices of its laws.
    pub laws: Vec<usize>,
}

/// All rows of a step: those of contacts as the solver has them, those of joints measured anew in `f64`. Its
/// unknowns are the impulses of the whole step, and `u` is the velocity at its end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct System {
    /// Length of the step [s].
    pub dt: f64,
    /// Approach speed above which contacts with restitution bounce [m/s].
    pub threshold: f64,
    /// Dynamic bodies, then kinematic ones.
    pub bodies: Vec<SystemBody>,
    /// All rows.
    pub rows: Vec<SystemRow>,
    /// All laws, in the order of their rows: contacts first, then joints, then couplings.
    pub laws: Vec<SystemLaw>,
    /// The islands that have rows, by their first bodies.
    pub islands: Vec<SystemIsland>,
    /// How many laws are of contacts; those of joints come after them.
    pub contacts: usize,
}

impl System {
    /// Assembles the system from rows that are prepared and not yet solved. `dt`: length of the step [s].
    pub(crate) fn assemble(world: &mut World, dt: f32) -> System {
        let mut system = System {
            dt: dt.into(),
            threshold: world.settings.measures().bounce_speed.into(),
            ..System::default()
        };
        system.take_bodies(world);
        let mut rows = std::mem::take(&mut world.buffers.rows);
        system.take_contacts(world, &rows.views());
        world.buffers.rows = rows;
        system.contacts = system.laws.len();
        system.take_joints(world);
        system.find_islands();
        system
    }

    fn take_bodies(&mut self, world: &World) {
        let bodies = &world.bodies;
        for i in 0..bodies.movers() {
            let start = velocity(&bodies.velocity[i]);
            let pull = world.buffers.forces.acceleration.get(i).map_or([DVec3::ZERO; 2], velocity);
            let dynamic = i < bodies.dynamic();
            let mut body = SystemBody {
                body: world.handle_of(i),
                dynamic,
                inverse_mass: DVec3::ZERO,
                inverse_inertia: DMat3::ZERO,
                centre: bodies.pose[i].position,
                start,
                free: [0, 1].map(|k| start[k] + pull[k] * self.dt),
                end: start,
                given: [DVec3::ZERO; 2],
                turned: [DVec3::ZERO; 2],
                stiffened: false,
                unconserved: false,
                moved: [DVec3::ZERO; 2],
                force: bodies.force.get(i).map_or([DVec3::ZERO; 2], velocity),
            };
            if dynamic {
                let one = glam::Vec3::ONE * bodies.mass[i].inverse;
                body.inverse_mass = bodies.traits[i].free(one).as_dvec3();
                body.inverse_inertia = inverse_inertia(bodies, i);
            }
            self.bodies.push(body);
        }
    }

    /// How many rows are of contacts; those of joints come after them.
    pub fn contact_rows(&self) -> usize {
        self.laws.get(self.contacts).map_or(self.rows.len(), |first_joint| first_joint.first)
    }

    /// Appends a law with its rows, of which it has as many as its kind says.
    pub fn push(&mut self, mut law: SystemLaw, rows: &[SystemRow]) {
        law.first = self.rows.len();
        debug_assert_eq!(law.law.rows(), rows.len());
        self.rows.extend_from_slice(rows);
        self.laws.push(law);
    }

    /// The index of a body that can move.
    pub(super) fn mover(&self, dense: usize) -> Option<usize> {
        (dense < self.bodies.len()).then_some(dense)
    }

    /// Velocity of a row, without its bias, with the body velocities given by `of`.
    pub fn speed(&self, row: &SystemRow, of: impl Fn(&SystemBody) -> Velocity) -> f64 {
        let side = |i: usize| {
            row.bodies[i].map_or(0.0, |body| {
                let [v, w] = of(&self.bodies[body]);
                row.linear[i].dot(v) + row.angular[i].dot(w)
            })
        };
        (0..SIDES).map(side).sum()
    }

    /// By how much impulses of all rows change the velocity of each body: `M⁻¹ Jᵀ r`. Panics if `r` has
    /// another number of rows.
    pub fn velocity_changes(&self, r: &[f64]) -> Vec<Velocity> {
        assert_eq!(r.len(), self.rows.len(), "an impulse for each row");
        let push = pushes(self.rows.iter().zip(r), self.bodies.len(), Some);
        self.bodies.iter().zip(push).map(|(body, push)| body.moved(push)).collect()
    }

    /// Whether a law is of rolling and spinning friction: a patch whose rows push nothing along.
    pub fn is_rolling(&self, law: &SystemLaw) -> bool {
        matches!(law.law, Law::Patch { .. }) && self.rows[law.first].linear == [DVec3::ZERO; SIDES]
    }

    /// Velocities of the bodies of an island at the end of the step if its rows get the impulses `r`, in the
    /// order of its laws.
    pub fn velocities_with(&self, island: &SystemIsland, r: &[f64]) -> Vec<Velocity> {
        let place = |body: usize| island.bodies.binary_search(&body).ok();
        let rows = island.laws.iter().flat_map(|&law| {
            let law = &self.laws[law];
            &self.rows[law.first..law.first + law.law.rows()]
        });
        let push = pushes(rows.zip(r), island.bodies.len(), place);
        let moved = |(&i, push): (&usize, Velocity)| {
            let (body, moved) = (&self.bodies[i], self.bodies[i].moved(push));
            [body.free[0] + moved[0], body.free[1] + moved[1]]
        };
        island.bodies.iter().zip(push).map(moved).collect()
    }

    /// The entry of a row on the diagonal of W, without compliance [1/kg] or [1/(kg m²)].
    pub fn mobility(&self, row: &SystemRow) -> f64 {
        let side = |i: usize| {
            row.bodies[i].map_or(0.0, |body| {
                let body = &self.bodies[body];
                row.linear[i].dot(body.inverse_mass * row.linear[i])
                    + row.angular[i].dot(body.inverse_inertia * row.angular[i])
            })
        };
        (0..SIDES).map(side).sum()
    }

    /// The impulse of each row by the engine's solver [N s] or [N m s].
    pub fn impulses(&self) -> Vec<f64> {
        self.rows.iter().map(|row| row.impulse).collect()
    }
}

impl SystemBody {
    /// Its change of velocity by an impulse and an angular one.
    fn moved(&self, [p, l]: Velocity) -> Velocity {
        [self.inverse_mass * p, self.inverse_inertia * l]
    }
}

/// The impulses of rows on so many bodies; `place`: where a body is among them.
fn pushes<'a>(
    rows: impl Iterator<Item = (&'a SystemRow, &'a f64)>,
    bodies: usize,
    place: impl Fn(usize) -> Option<usize>,
) -> Vec<Velocity> {
    let mut push = vec![[DVec3::ZERO; 2]; bodies];
    for (row, &r) in rows {
        for (side, body) in row.bodies.iter().enumerate() {
            if let Some(i) = body.and_then(&place) {
                push[i][0] += row.linear[side] * r;
                push[i][1] += row.angular[side] * r;
            }
        }
    }
    push
}

/// The parts of a row on two bodies, for [`SystemRow`].
pub fn of_two<T: Copy + Default>([a, b]: [T; 2]) -> [T; SIDES] {
    [a, b, T::default(), T::default()]
}

/// A record in `f64`.
pub(super) fn velocity(record: &Record) -> Velocity {
    [record.linear.as_dvec3(), record.angular.as_dvec3()]
}

fn inverse_inertia(bodies: &Bodies, i: usize) -> DMat3 {
    if bodies.traits[i].locks >> 3 != 0 {
        let Sym3 { xx, yy, zz, xy, xz, yz } = world_inertia(bodies, i);
        let [xx, yy, zz, xy, xz, yz] = [xx, yy, zz, xy, xz, yz].map(f64::from);
        return DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
    }
    let turn = DMat3::from_quat(bodies.pose[i].rotation.as_dquat().normalize());
    turn * DMat3::from_diagonal(bodies.mass[i].inverse_inertia.as_dvec3()) * turn.transpose()
}
