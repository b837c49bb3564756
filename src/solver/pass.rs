//! Passes over all batches, in the order of their importance.

use crate::config::tuning::{
    JOINT_DAMPING, JOINT_HERTZ, JOINT_PUSH_SPEED, LOAD_SHIFT_SPEED, STIFFEST_SPRING_SHARE, TOUCH_DISTANCE,
};
use crate::config::{FrictionCone, Settings};
use crate::constraint::contact::row::{Motion, Pass, Softness, solve, warm_start};
use crate::constraint::{
    Batch, BatchRef, Closing, FrictionView, Group, JointPass, JointRows, JointStage, JointType, JointViews,
    Recovery, TouchInput, TreeRef, Views, guard, solve_impact_friction, with_batch,
};
use crate::lanes::GatherLanes;
use crate::threads::{Workers, per_block};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// The operation of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PassKind {
    WarmStart,
    Solve,
    Relax,
    /// Solves the friction of contacts that pushed before they touched.
    ImpactFriction,
}

/// Numbers that all passes of a step share.
pub(super) struct PassParameters {
    /// 1 / substep [1/s].
    inverse_h: f32,
    /// Springs of contacts between dynamic bodies, and of those with static ones.
    dynamic: Softness,
    fixed: Softness,
    /// See [`Pass`] for the next four.
    push_speed: f32,
    load_shift_speed: f32,
    touch_distance: f32,
    friction_box: bool,
    /// Spring of locked directions of joints.
    joint: Softness,
    pub(super) recovery: Recovery,
}

impl PassParameters {
    /// For substeps of `h`, and springs tuned for those of `usual_h` [s].
    pub(super) fn new(settings: &Settings, usual_h: f32, h: f32) -> PassParameters {
        let count = settings.iterations + 1;
        let hertz = settings.contact_hertz.min(STIFFEST_SPRING_SHARE * Softness::stiffest(count, usual_h));
        // Contacts with static bodies are twice as stiff; both are too stiff for a substep, or none is.
        let spring = Softness::for_substep(hertz, settings.contact_damping, count, h);
        let fixed = Softness::new(2.0 * hertz, settings.contact_damping, h);
        let fixed = if spring.bias_rate > 0.0 { fixed } else { fixed.locked() };
        PassParameters {
            inverse_h: 1.0 / h,
            dynamic: spring,
            fixed,
            push_speed: settings.push_speed * settings.length_unit,
            load_shift_speed: LOAD_SHIFT_SPEED * settings.length_unit,
            touch_distance: TOUCH_DISTANCE * settings.length_unit,
            friction_box: settings.friction_cone == FrictionCone::Box,
            joint: Softness::new(JOINT_HERTZ.min(Softness::stiffest(count, h)), JOINT_DAMPING, h),
            recovery: Recovery { linear: JOINT_PUSH_SPEED * settings.length_unit, angular: JOINT_PUSH_SPEED },
        }
    }
}

/// Batches of joint rows, in the order in which they are solved.
pub(super) struct JointBatches<'a> {
    pub(super) stages: &'a [JointStage],
    pub(super) views: JointViews<'a>,
}

impl JointBatches<'_> {
    pub(super) fn exist(&self) -> bool {
        !self.stages.is_empty()
    }
}

/// Runs passes over the rows of a step, on several threads.
pub(super) struct Passes<'a> {
    pub(super) workers: &'a Workers<'a>,
    pub(super) parameters: PassParameters,
    pub(super) has_friction: bool,
    pub(super) batches: Views<'a>,
    pub(super) joints: JointBatches<'a>,
    pub(super) motion: &'a Motion<'a, 'a>,
}

/// Batches in a block of work: the smallest piece of a colour that threads share out.
const BLOCK: usize = per_block(8, 1);

/// Number of sweeps over the rows of joints in a pass: a net of 10,000 points of which seven are held
/// stretches by 1.75 m with one sweep, by 0.84 m with two, which cost a fifth more, and by 0.78 m with three.
const JOINT_SWEEPS: u32 = 2;

impl Passes<'_> {
    /// A pass over all rows. For [`PassKind::Relax`], returns whether potential points push; for
    /// [`PassKind::ImpactFriction`], whether it shifts loads.
    pub(super) fn run(&self, kind: PassKind) -> bool {
        let Passes { workers, ref batches, motion, .. } = *self;
        let found = AtomicBool::new(false);
        let contacts = TouchInput { contacts: batches, pass: &self.contact_pass(Group::Static, kind) };
        let mut joints = self.joints.stages;
        for stage in batches.stages {
            if !joints.is_empty() {
                let before = joints.partition_point(|joint| joint.place < stage.place);
                self.run_joints(kind, &joints[..before], &contacts);
                joints = &joints[before..];
            }
            let pass = self.contact_pass(stage.group, kind);
            let one = |index: usize| {
                let of = batches.schedule[index];
                // SAFETY: each batch is in the schedule once; no dynamic body is twice in a stage, unless the
                // stage is serial, and then one thread has all of it.
                let found_one = unsafe {
                    with_batch!(batches, stage.group, of, |batch, friction| {
                        step(kind, stage.group, of, batch, friction, motion, &pass)
                    })
                };
                if found_one {
                    found.store(true, Ordering::Relaxed);
                }
            };
            share_out(workers, stage.start as usize..stage.end as usize, stage.serial, &one);
        }
        self.run_joints(kind, joints, &contacts);
        found.into_inner()
    }

    fn run_joints(&self, kind: PassKind, stages: &[JointStage], contacts: &TouchInput<'_>) {
        if kind == PassKind::ImpactFriction {
            return;
        }
        let relax = kind == PassKind::Relax;
        let sweeps = if kind == PassKind::WarmStart { 1 } else { JOINT_SWEEPS };
        for (sweep, stage) in (0..sweeps).flat_map(|sweep| stages.iter().map(move |stage| (sweep, stage))) {
            // Trees are solved exactly: once is enough, in the last sweep.
            let is_tree = stage.kind == JointType::Tree;
            if is_tree && sweep + 1 < sweeps {
                continue;
            }
            let pass = JointPass {
                moved: relax && (is_tree || sweep == 0),
                fresh: !relax && sweep == 0,
                relax,
                ..self.joint_pass()
            };
            let pass = (kind != PassKind::WarmStart).then_some(&pass);
            // SAFETY: each batch is in one stage; no dynamic body is twice in it, unless its rows found no
            // colour, and then one thread has all of it.
            let one = |i: usize| unsafe {
                JointRows::step(&self.joints.views, stage, i, self.motion, pass, contacts)
            };
            let batches = stage.start as usize..stage.end as usize;
            share_out(self.workers, batches, stage.single && !is_tree, &one);
        }
    }

    /// Lets joints of trees that conserve energy act before any row of the substep is solved.
    pub(super) fn predict(&self) {
        let pass = JointPass { fresh: true, ..self.joint_pass() };
        for stage in self.joints.stages.iter().filter(|stage| stage.kind == JointType::Tree) {
            // SAFETY: each batch is in one stage, and no dynamic body is in two.
            let one = |i: usize| unsafe {
                JointRows::predict(&self.joints.views, TreeRef::new(i, stage.single), self.motion, &pass);
            };
            share_out(self.workers, stage.start as usize..stage.end as usize, false, &one);
        }
    }

    /// Closes locks outside trees, moves the bodies of trees that conserve energy, and closes the joints of
    /// trees.
    pub(super) fn close_joints(&self, closing: &Closing) {
        let Recovery { linear, angular } = self.parameters.recovery;
        let inverse_h = self.parameters.inverse_h;
        let most = Recovery { linear: linear / inverse_h, angular: angular / inverse_h };
        let JointBatches { stages, views } = &self.joints;
        for stage in (0..JOINT_SWEEPS).flat_map(|_| *stages).filter(|stage| stage.kind.is_lock()) {
            // SAFETY: each batch is in one stage; no dynamic body is twice in it, unless its rows found no
            // colour, and then one thread has all of it.
            let one = |i: usize| unsafe { JointRows::close_locks(views, stage, i, self.motion, most) };
            share_out(self.workers, stage.start as usize..stage.end as usize, stage.single, &one);
        }
        for stage in stages.iter().filter(|stage| stage.kind == JointType::Tree) {
            // SAFETY: each batch is in one stage, and no dynamic body is in two.
            let one = |i: usize| unsafe {
                let tree = TreeRef::new(i, stage.single);
                JointRows::go(views, tree, self.motion, closing, &self.batches);
            };
            share_out(self.workers, stage.start as usize..stage.end as usize, false, &one);
        }
    }

    fn joint_pass(&self) -> JointPass {
        let PassParameters { inverse_h, joint, recovery, .. } = self.parameters;
        JointPass { inverse_h, softness: joint, recovery, moved: false, fresh: false, relax: false }
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
            surfaces: self.batches.surfaces,
        }
    }
}

/// Works through the batches of a stage: in blocks on several threads, unless they must be solved in order.
#[inline(always)]
fn share_out(workers: &Workers<'_>, batches: Range<usize>, serial: bool, one: &(impl Fn(usize) + Sync)) {
    if serial || batches.len() <= BLOCK {
        batches.for_each(one);
        return;
    }
    workers.run(batches.len().div_ceil(BLOCK), &|block| {
        let first = batches.start + block * BLOCK;
        (first..(first + BLOCK).min(batches.end)).for_each(one);
    });
}

/// One pass over one batch, by the kernel of its group. Returns what [`Passes::run`] does.
///
/// # Safety
/// The bodies of the batch that it may write are in no other batch that is worked on now.
#[inline(always)]
unsafe fn step<L: GatherLanes, const P: usize, const B: usize>(
    kind: PassKind,
    group: Group,
    of: BatchRef,
    batch: &mut Batch<L, P, B>,
    friction: &FrictionView<'_, L, B>,
    motion: &Motion<'_, '_>,
    pass: &Pass<'_>,
) -> bool {
    // SAFETY: by the contract.
    unsafe {
        if kind == PassKind::ImpactFriction {
            return solve_impact_friction(batch, friction, of, group, motion, pass);
        }
        if B == 0 && kind != PassKind::WarmStart && of.in_tree {
            return guard(batch, motion, pass);
        }
        let rows = if group.is_potential() { None } else { friction.touching(of) };
        match (kind, rows) {
            (PassKind::WarmStart, Some(f)) => warm_start::<L, P, B, true>(batch, Some(f), motion.velocity),
            (PassKind::WarmStart, None) => warm_start::<L, P, B, false>(batch, None, motion.velocity),
            (_, Some(f)) => return solve::<L, P, B, true>(batch, Some(f), motion, pass),
            (_, None) => return solve::<L, P, B, false>(batch, None, motion, pass),
        }
        false
    }
}
