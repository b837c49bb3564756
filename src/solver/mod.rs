//! Batches in, velocities and displacements out: warm start, iterate, substep, relax, store.
//!
//! Collisions are found once a step; the substeps solve the same rows with separations that follow the bodies
//! (Macklin et al., *Small Steps in Physics Simulation*, 2019; Catto's soft step with relaxation). One
//! substep and several iterations make it plain sequential impulses: the kernels are the same.

mod integrate;
mod joint_passes;
mod parameters;
mod store;
mod substep;

use crate::body::Bodies;
use crate::config::Settings;
use crate::constraint::contact::batch::BatchRef;
use crate::constraint::contact::crowd::Crowd;
use crate::constraint::contact::friction::FrictionView;
use crate::constraint::contact::row::{Motion, Pass, carry, solve as solve_batch, warm_start};
use crate::constraint::schedule::order::Stage;
use crate::constraint::{
    Batch, Group, JointRows, JointViews, Restitution, Rows, StepLengths, TouchInput, Views, guard,
    solve_impact_friction, usual_substep, with_batch,
};
use crate::forces::Forces;
use crate::lanes::{GatherLanes, Record, kernel, with_best};
use crate::memory::buffers;
use crate::shape::Collider;
use crate::threads::{Shared, Workers, per_block};
use integrate::{FastLimit, Integrator};
use joint_passes::JointBatches;
use parameters::PassParameters;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
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
    #[cfg(debug_assertions)]
    pub(crate) fn spoil(&mut self) {
        use crate::memory::spoil;
        let State { delta, base, usual_h: _ } = self;
        [delta, base].into_iter().for_each(spoil);
    }

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
    /// Called between two passes that relax velocities.
    fn relaxed(&mut self, joints: &JointViews<'_>);
    /// Called before trees of joints move.
    fn trees_move(&mut self, joints: &JointViews<'_>);
    /// Called after they did, once their changes of velocities are known.
    fn trees_moved(&mut self, joints: &JointViews<'_>, velocity: &[Record]);
    /// Number of contacts.
    fn contacts(&self) -> usize;
    /// Takes the normal impulses [N s] that impacts gave contacts, in the order of contacts.
    fn impacts(&mut self, impulses: &mut dyn Iterator<Item = f32>);
    /// Takes the bodies that stand still for the rest of the step after impacts.
    fn stand(&mut self, bodies: &[u32]);
    /// Called when velocities change by an acceleration over a time [s].
    fn pull(&mut self, acceleration: &[Record], h: f32);
    /// Called at the end of a substep.
    fn substep(&mut self, rows: &Views<'_>, joints: &JointViews<'_>);
}

/// Input of [`solve`]: the rows of a step, and the bodies that they act on.
pub(crate) struct SolverInput<'a> {
    pub(crate) settings: &'a Settings,
    pub(crate) lengths: StepLengths,
    pub(crate) bodies: &'a mut Bodies,
    pub(crate) colliders: &'a [Collider],
    pub(crate) forces: &'a mut Forces,
    pub(crate) rows: &'a mut Rows,
    pub(crate) joints: &'a mut JointRows,
    pub(crate) restitution: &'a mut Restitution,
    /// Normal impulses of contacts whose events are recorded are added here, as far as it has room.
    pub(crate) impulses: &'a mut [f32],
    pub(crate) crowd: &'a mut Crowd,
    pub(crate) state: &'a mut State,
    pub(crate) witness: Option<&'a mut dyn Witness>,
}

/// Solves the rows over a step. Returns whether all velocities stayed in range.
pub(crate) fn solve(workers: &Workers<'_>, input: SolverInput<'_>) -> bool {
    let SolverInput { settings, lengths, bodies, forces, joints, restitution, state, .. } = input;
    let (movers, dynamic) = (bodies.movers(), bodies.dynamic());
    let (dt, h) = (lengths.dt(), lengths.now());
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
    let passes = Passes {
        workers,
        parameters: PassParameters::new(settings, state.usual_h, h),
        has_friction: input.rows.has_friction(),
        contacts: input.rows.views(),
        joints: JointBatches { stages: &joint_stages, views: joints.views() },
        motion: &motion,
    };
    let fast = FastLimit::new(settings, &joint_stages, h);
    let integrator = Integrator { workers, motion: &motion, movers, dynamic, h, fast };
    let mut substeps = Substeps {
        context: Context {
            settings,
            dt,
            h,
            passes: &passes,
            integrator: &integrator,
            velocities,
            bodies: BodyData {
                pose: &bodies.pose,
                mass: &bodies.mass,
                traits: &bodies.traits,
                caps: &bodies.rare.caps,
                slots: &bodies.slots,
                collider_lists: &bodies.colliders,
                colliders: input.colliders,
            },
        },
        forces,
        crowd: input.crowd,
        restitution,
        nets: &mut nets,
        impulses: input.impulses,
        witness: input.witness.map(|witness| witness as &mut dyn Witness),
    };
    let mut in_range = true;
    for substep in 0..settings.substeps {
        in_range &= substeps.run(substep);
    }
    integrator.mark_relaxed();
    substeps.release_standing_bodies();
    joints.nets = nets;
    joints.stages = joint_stages;
    in_range
}

impl Substeps<'_> {
    /// One substep. Returns whether all velocities stayed in range.
    fn run(&mut self, substep: u32) -> bool {
        let Context { passes, settings, .. } = self.context;
        self.solve_impacts(substep);
        let check = self.integrate_velocities(substep);
        if substep == 0 {
            passes.run(PassKind::WarmStart);
        }
        self.carry(substep);
        passes.predict_trees();
        for _ in 0..settings.iterations {
            passes.run(PassKind::Solve);
        }
        let check = self.hold_back(check);
        let in_range = self.integrate_displacements();
        self.advance_impacts_and_trees();
        // If friction of potential points that pushed shifts much load, points share it in one more pass.
        let potential_points_push = passes.run(PassKind::Relax);
        if potential_points_push && self.solve_impact_friction() {
            passes.run(PassKind::Relax);
        }
        self.end(check);
        in_range
    }
}

/// The operation of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PassKind {
    WarmStart,
    Solve,
    Relax,
    /// Solves the friction of contacts that pushed before they touched.
    ImpactFriction,
}

/// Runs passes over the rows of a step, on several threads.
struct Passes<'a> {
    workers: &'a Workers<'a>,
    parameters: PassParameters,
    has_friction: bool,
    contacts: Views<'a>,
    joints: JointBatches<'a>,
    motion: &'a Motion<'a, 'a>,
}

impl Passes<'_> {
    /// A pass over all rows, in the order of their importance. For [`PassKind::Relax`], returns whether
    /// potential points push; for [`PassKind::ImpactFriction`], whether it shifts loads.
    fn run(&self, kind: PassKind) -> bool {
        let Passes { workers, contacts: ref batches, motion, .. } = *self;
        let found = AtomicBool::new(false);
        let touches = TouchInput { contacts: batches, pass: &self.contact_pass(Group::Static, kind) };
        let mut joints = self.joints.stages;
        for stage in batches.stages {
            if !joints.is_empty() {
                let before = joints.partition_point(|joint| joint.place < stage.place);
                self.run_joints(kind, &joints[..before], &touches);
                joints = &joints[before..];
            }
            let (group, pass) = (stage.group, self.contact_pass(stage.group, kind));
            let one = |index: usize| {
                let of = batches.schedule[index];
                // SAFETY: each batch is in the schedule once; no dynamic body is twice in a stage, unless the
                // stage is serial, and then one thread has all of it.
                let found_one = unsafe {
                    with_best!(Wide => with_batch!(Wide: batches, group, of, |batch, friction| {
                        pass_over(batch, friction, of, group, kind, batches, motion, &pass)
                    }))
                };
                if found_one {
                    found.store(true, Ordering::Relaxed);
                }
            };
            let block = if stage.serial { usize::MAX } else { BLOCK };
            share_out(workers, stage.start as usize..stage.end as usize, block, &one);
        }
        self.run_joints(kind, joints, &touches);
        found.into_inner()
    }

    /// Turns the arms of friction to ground that turns on by a substep. Apart from the kernels, whose code
    /// would grow by it in all scenes.
    #[cold]
    fn carry(&self) {
        let batches = &self.contacts;
        let moving = |stage: &&Stage| !stage.group.is_static() && !stage.group.is_potential();
        for stage in batches.stages.iter().filter(moving) {
            for &of in &batches.schedule[stage.start as usize..stage.end as usize] {
                // SAFETY: between stages this thread is alone.
                unsafe {
                    with_batch!(batches, stage.group, of, |batch, friction| {
                        if let Some(f) = friction.touching(of) {
                            carry(batch, f, self.motion.velocity, 1.0 / self.parameters.inverse_h);
                        }
                    });
                }
            }
        }
    }

    fn contact_pass(&self, group: Group, kind: PassKind) -> Pass<'_> {
        let parameters = &self.parameters;
        Pass {
            inverse_h: parameters.inverse_h,
            softness: if group.is_static() { parameters.fixed } else { parameters.dynamic },
            push_speed: parameters.push_speed,
            load_shift_speed: parameters.load_shift_speed,
            touch_distance: parameters.touch_distance,
            friction_box: parameters.friction_box,
            relax: kind == PassKind::Relax,
            surfaces: self.contacts.surfaces,
            rolling: &self.contacts.rolling,
            soft: &self.contacts.soft,
        }
    }
}

kernel! {
    /// An operation on a batch. Returns whether potential points push, or loads shift: see [`Passes::run`].
    ///
    /// # Safety
    /// The bodies of the batch that it may write are in no other batch of the stage.
    unsafe fn pass_over<'a, L: GatherLanes, const P: usize, const B: usize>(
        batch: &'a mut Batch<L, P, B>,
        friction: &'a FrictionView<'a, L, B>,
        of: BatchRef,
        group: Group,
        kind: PassKind,
        batches: &'a Views<'a>,
        motion: &'a Motion<'a, 'a>,
        pass: &'a Pass<'a>,
    ) -> bool {
        // SAFETY: by the contract.
        unsafe {
            if kind == PassKind::ImpactFriction {
                return solve_impact_friction(batch, friction, of, group, motion, pass);
            }
            if of.in_tree && kind != PassKind::WarmStart && batch.b.is_empty() {
                return guard(batch, batches, motion, pass);
            }
            // Without friction a kernel of its own.
            let rows = if group.is_potential() { None } else { friction.touching(of) };
            match (kind, rows) {
                (PassKind::WarmStart, Some(f)) => {
                    let rolling = batches.rolling_of(batch);
                    warm_start::<_, _, _, true>(batch, Some(f), rolling, motion.velocity);
                    false
                }
                (PassKind::WarmStart, None) => {
                    warm_start::<_, _, _, false>(batch, None, None, motion.velocity);
                    false
                }
                (_, Some(f)) => solve_batch::<_, _, _, true>(batch, Some(f), motion, pass),
                (_, None) => solve_batch::<_, _, _, false>(batch, None, motion, pass),
            }
        }
    }
}

/// Batches in a block of work: the smallest piece of a colour that threads share out.
const BLOCK: usize = per_block(8, 1);

/// Works through the batches of a stage: in blocks of so many on several threads. Those that must be solved
/// in order are one block.
#[inline(always)]
fn share_out(workers: &Workers<'_>, batches: Range<usize>, block: usize, one: &(impl Fn(usize) + Sync)) {
    if batches.len() <= block {
        batches.for_each(one);
        return;
    }
    workers.run(batches.len().div_ceil(block), &|k| {
        let first = batches.start + k * block;
        (first..(first + block).min(batches.end)).for_each(one);
    });
}
