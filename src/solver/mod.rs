//! Batches in, velocities and displacements out: warm start, iterate, substep, relax, store.
//!
//! Collisions are found once a step; the substeps solve the same rows with separations that follow the bodies
//! (Macklin et al., *Small Steps in Physics Simulation*, 2019; Catto's soft step with relaxation). One
//! substep and several iterations make it plain sequential impulses: the kernels are the same.

mod impact_body;
mod integrate;
mod pass;
mod store;
mod substep;

use crate::body::Bodies;
use crate::config::Settings;
use crate::config::tuning::JOINT_OPEN;
use crate::constraint::contact::crowd::Crowd;
use crate::constraint::contact::row::Motion;
use crate::constraint::{Closing, JointRows, JointViews, Restitution, Rows, Views, usual_substep};
use crate::forces::Forces;
use crate::lanes::Record;
use crate::memory::buffers;
use crate::shape::Collider;
use crate::threads::{Shared, Workers, per_block};
pub(crate) use impact_body::ImpactBody;
use integrate::{FastLimit, Integrator};
use pass::{JointBatches, PassParameters, Passes};
pub(crate) use store::store;
use substep::{BodyData, Context, Substeps};

/// Solver state of the movable bodies.
#[derive(Debug, Default)]
pub(crate) struct State {
    /// Displacement [m] and rotation vector [rad] since the start of the step.
    pub(crate) delta: Vec<Record>,
    /// Velocities of the substep before any row acted.
    base: Vec<Record>,
    /// Length of a substep for which the springs of contacts are tuned [s].
    pub(crate) usual_h: f32,
}

buffers! { State { each(movers: usize) { delta(movers + 1), base(movers + 1) } } }

impl State {
    /// Clears both buffers for a step with so many movable bodies.
    fn reset(&mut self, movers: usize) {
        self.delta.clear();
        // One more record for all static bodies, to which joints may be attached.
        self.delta.resize(movers + 1, Record::default());
        self.base.clear();
        self.base.resize(movers + 1, Record::default());
    }
}

/// Observes the solver at work: the lab does, on request.
pub(crate) trait Witness {
    /// Called before something other than rows changes velocities.
    fn before(&mut self, velocity: &[Record]);
    /// Called after it did.
    fn after(&mut self, velocity: &[Record]);
    /// Number of contacts.
    fn contacts(&self) -> usize;
    /// Takes the normal impulses [N s] that impacts gave contacts, in the order of contacts.
    fn impacts(&mut self, impulses: &mut dyn Iterator<Item = f32>);
    /// Called when velocities change by an acceleration over a time [s].
    fn pull(&mut self, acceleration: &[Record], h: f32);
    /// Called at the end of a substep.
    fn substep(&mut self, rows: &Views<'_>, joints: &JointViews<'_>);
}

/// Input of [`solve`]: the rows of a step, and the bodies that they act on.
pub(crate) struct SolverInput<'a> {
    pub(crate) settings: &'a Settings,
    /// Length of the step [s].
    pub(crate) dt: f32,
    pub(crate) bodies: &'a mut Bodies,
    pub(crate) colliders: &'a [Collider],
    pub(crate) forces: &'a mut Forces,
    pub(crate) rows: &'a mut Rows,
    pub(crate) joints: &'a mut JointRows,
    pub(crate) restitution: &'a mut Restitution,
    /// Normal impulses of contacts whose events are recorded are added here, as far as it has room.
    pub(crate) impulses: &'a mut [f32],
    pub(crate) crowd: &'a Crowd,
    pub(crate) state: &'a mut State,
    pub(crate) witness: Option<&'a mut dyn Witness>,
}

/// Bodies in a block of work.
const BLOCK: usize = per_block(256, 1);

/// Solves the rows over a step. Returns whether all velocities stayed in range.
pub(crate) fn solve(workers: &Workers<'_>, input: SolverInput<'_>) -> bool {
    let SolverInput { settings, dt, bodies, forces, joints, restitution, state, .. } = input;
    let (movers, dynamic) = (bodies.movers(), bodies.dynamic());
    let h = dt / settings.substeps as f32;
    state.reset(movers);
    state.usual_h = usual_substep(state.usual_h, h);
    let joint_stages = std::mem::take(&mut joints.stages);
    let mut nets = std::mem::take(&mut joints.nets);
    nets.start();
    // All static bodies share one record of zero velocity.
    let velocities = bodies.velocity.len().min(movers + 1);
    let velocity = Shared::new(&mut bodies.velocity[..velocities]);
    let motion = Motion {
        velocity: &velocity,
        delta: &Shared::new(&mut state.delta),
        base: &Shared::new(&mut state.base),
    };
    let mut substeps = Substeps {
        context: Context {
            settings,
            dt,
            h,
            passes: Passes {
                workers,
                parameters: PassParameters::new(settings, state.usual_h, h),
                has_friction: input.rows.has_friction(),
                batches: input.rows.views(),
                joints: JointBatches { stages: &joint_stages, views: joints.views() },
                motion: &motion,
            },
            integrator: Integrator {
                workers,
                motion: &motion,
                movers,
                dynamic,
                h,
                fast: FastLimit::new(settings, &joint_stages, h),
            },
            velocities,
            bodies: BodyData {
                pose: &bodies.pose,
                mass: &bodies.mass,
                traits: &bodies.traits,
                collider_lists: &bodies.colliders,
                colliders: input.colliders,
            },
            crowd: input.crowd,
        },
        forces,
        restitution,
        nets: &mut nets,
        impulses: input.impulses,
        witness: input.witness.map(|witness| witness as &mut dyn Witness),
    };
    let mut in_range = true;
    for substep in 0..settings.substeps {
        in_range &= substeps.run(substep);
    }
    substeps.release_standing_bodies();
    joints.nets = nets;
    joints.stages = joint_stages;
    in_range
}

/// How far the joints of trees may be open.
pub(crate) fn closing(settings: &Settings) -> Closing {
    Closing { tolerance: JOINT_OPEN, slop: settings.slop * settings.length_unit }
}

/// Bits of the lanes of a record that hold the linear part, and those of both parts; and the lane of the
/// first pad.
const LINEAR: u32 = 0b0000_0111;
const BOTH: u32 = 0b0111_0111;
const PAD: [f32; 8] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
