//! One pass over all batches, in the order of their importance.

use crate::constraint::contact::row::{
    Motion, Pass, Softness, disable_lanes, solve, store as store_batch, warm_start,
};
use crate::constraint::{
    Batch, BatchRef, Closing, FrictionRow, FrictionView, Group, JointPass, JointRows, JointStage, JointType,
    JointViews, Recovery, Rows, Stage, StepLengths, Surface, TreeRef, Views, guard, solve_impact_friction,
    with_batch,
};
use crate::lanes::GatherLanes;
use crate::narrow_phase::{Contact, Point};
use crate::threads::{Shared, Workers, per_block};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// What a pass does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    WarmStart,
    Solve,
    Relax,
    /// Friction of what was pushed before it touched.
    Rub,
}

/// What all passes of a step share.
pub(crate) struct Passes {
    pub(crate) inverse_h: f32,
    pub(crate) dynamic: Softness,
    pub(crate) fixed: Softness,
    pub(crate) push_speed: f32,
    pub(crate) shift: f32,
    pub(crate) real: f32,
    pub(crate) friction_box: bool,
    /// Of what joints lock.
    pub(crate) joint: Softness,
    pub(crate) recovery: Recovery,
}

/// Rows of joints, sorted as they are solved.
pub(crate) struct Joined<'a> {
    pub(crate) stages: &'a [JointStage],
    pub(crate) views: &'a JointViews<'a>,
}

/// Batches a block: the smallest piece of a colour that two threads share.
const BLOCK: usize = per_block(8, 1);
/// The same where impulses go back to their contacts, which is less work.
const STORED: usize = per_block(16, 1);

/// How often a pass goes over the rows of joints that have loops: a net of 10,000 points of which seven are held stretches by
/// 1.75 m at one and 0.84 m at two, which costs a fifth more; at three by 0.78 m.
const JOINT_SWEEPS: u32 = 2;

impl Passes {
    /// Relaxing, says whether potential points push; rubbing, whether that shifts loads.
    pub(crate) fn run(
        &self,
        workers: &Workers<'_>,
        kind: Kind,
        views: &Views<'_>,
        joined: &Joined<'_>,
        motion: &Motion<'_, '_>,
    ) -> bool {
        let pushes = AtomicBool::new(false);
        let surfaces = views.surfaces;
        let along = (views, &self.of(Group::Static, kind, surfaces));
        let mut joints = joined.stages;
        for stage in views.stages {
            if !joints.is_empty() {
                let before = joints.partition_point(|joint| joint.place < stage.place);
                self.run_joints(workers, kind, &joints[..before], joined.views, motion, along);
                joints = &joints[before..];
            }
            let pass = self.of(stage.group, kind, surfaces);
            let one = |index: usize| {
                let of = views.schedule[index];
                // SAFETY: each batch stands in the schedule once; no dynamic body is twice in a stage, unless the stage
                // is serial, and then one thread has it all.
                let pushed = unsafe {
                    with_batch!(views, stage.group, of, |batch, friction| {
                        step(kind, stage.group, of, batch, friction, motion, &pass)
                    })
                };
                if pushed {
                    pushes.store(true, Ordering::Relaxed);
                }
            };
            share_out(workers, stage.start as usize..stage.end as usize, stage.serial, &one);
        }
        self.run_joints(workers, kind, joints, joined.views, motion, along);
        pushes.into_inner()
    }

    fn run_joints(
        &self,
        workers: &Workers<'_>,
        kind: Kind,
        stages: &[JointStage],
        views: &JointViews<'_>,
        motion: &Motion<'_, '_>,
        along: (&Views<'_>, &Pass<'_>),
    ) {
        if kind == Kind::Rub {
            return;
        }
        let relax = kind == Kind::Relax;
        let sweeps = if kind == Kind::WarmStart { 1 } else { JOINT_SWEEPS };
        for (sweep, stage) in (0..sweeps).flat_map(|sweep| stages.iter().map(move |stage| (sweep, stage))) {
            // Once is enough for trees, which are solved exactly, and the last time is theirs.
            let is_tree = stage.kind == JointType::Tree;
            if is_tree && sweep + 1 < sweeps {
                continue;
            }
            let pass = JointPass {
                inverse_h: self.inverse_h,
                softness: self.joint,
                recovery: self.recovery,
                moved: relax && (is_tree || sweep == 0),
                fresh: !relax && sweep == 0,
                relax,
            };
            let pass = (kind != Kind::WarmStart).then_some(&pass);
            // SAFETY: each batch is in one stage; no dynamic body is twice in it, unless it is of rows that found no
            // colour, and then one thread has it all.
            let one = |i: usize| unsafe { JointRows::step(views, stage, i, motion, pass, along) };
            share_out(workers, stage.start as usize..stage.end as usize, stage.single && !is_tree, &one);
        }
    }

    /// Lets joints of trees that keep their energy act before any row of the substep is solved.
    pub(crate) fn predict(&self, workers: &Workers<'_>, joined: &Joined<'_>, motion: &Motion<'_, '_>) {
        let pass = JointPass {
            inverse_h: self.inverse_h,
            softness: self.joint,
            recovery: self.recovery,
            moved: false,
            fresh: true,
            relax: false,
        };
        for stage in joined.stages.iter().filter(|stage| stage.kind == JointType::Tree) {
            // SAFETY: each batch is in one stage, and no body that can be moved is in two.
            let one = |i: usize| unsafe {
                JointRows::predict(joined.views, TreeRef::new(i, stage.single), motion, &pass);
            };
            share_out(workers, stage.start as usize..stage.end as usize, false, &one);
        }
    }

    /// Closes locks that are in no tree, moves the bodies of trees that keep their energy, and closes the joints of trees.
    pub(crate) fn go(
        &self,
        workers: &Workers<'_>,
        along: &Views<'_>,
        joined: &Joined<'_>,
        motion: &Motion<'_, '_>,
        closing: &Closing,
    ) {
        let most = Recovery {
            linear: self.recovery.linear / self.inverse_h,
            angular: self.recovery.angular / self.inverse_h,
        };
        for stage in (0..JOINT_SWEEPS).flat_map(|_| joined.stages).filter(|stage| stage.kind.is_lock()) {
            // SAFETY: each batch is in one stage; no dynamic body is twice in it, unless it is of rows that found no
            // colour, and then one thread has it all.
            let one = |i: usize| unsafe { JointRows::close_locks(joined.views, stage, i, motion, most) };
            share_out(workers, stage.start as usize..stage.end as usize, stage.single, &one);
        }
        for stage in joined.stages.iter().filter(|stage| stage.kind == JointType::Tree) {
            // SAFETY: each batch is in one stage, and no body that can be moved is in two.
            let one = |i: usize| unsafe {
                JointRows::go(joined.views, TreeRef::new(i, stage.single), motion, closing, along);
            };
            share_out(workers, stage.start as usize..stage.end as usize, false, &one);
        }
    }

    fn of<'a>(&self, group: Group, kind: Kind, surfaces: &'a [Surface]) -> Pass<'a> {
        Pass {
            inverse_h: self.inverse_h,
            softness: if group.is_static() { self.fixed } else { self.dynamic },
            push_speed: self.push_speed,
            shift: self.shift,
            real: self.real,
            friction_box: self.friction_box,
            relax: kind == Kind::Relax,
            surfaces,
        }
    }
}

/// Works through the batches of a stage, in blocks for several threads unless they have to go one after another.
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

/// One pass over one batch, by the kernel of its group. See [`Passes::run`] for the answer.
///
/// # Safety
/// The bodies of the batch that it may write are in no other batch that is worked on now.
#[inline(always)]
unsafe fn step<L: GatherLanes, const P: usize, const B: usize>(
    kind: Kind,
    group: Group,
    of: BatchRef,
    batch: &mut Batch<L, P, B>,
    friction: &FrictionView<'_, L, B>,
    motion: &Motion<'_, '_>,
    pass: &Pass<'_>,
) -> bool {
    // SAFETY: by the contract.
    unsafe {
        if kind == Kind::Rub {
            return solve_impact_friction(batch, friction, of, group, motion, pass);
        }
        if B == 0 && kind != Kind::WarmStart && of.in_tree {
            return guard(batch, motion, pass);
        }
        let rows = if group.is_potential() { None } else { friction.touching(of) };
        match (kind, rows) {
            (Kind::WarmStart, Some(f)) => warm_start::<L, P, B, true>(batch, Some(f), motion.velocity),
            (Kind::WarmStart, None) => warm_start::<L, P, B, false>(batch, None, motion.velocity),
            (_, Some(f)) => return solve::<L, P, B, true>(batch, Some(f), motion, pass),
            (_, None) => return solve::<L, P, B, false>(batch, None, motion, pass),
        }
        false
    }
}

/// Adds the normal impulses of the substep to those of the contacts that someone listens to.
pub(crate) fn add_impulses(views: &Views<'_>, impulses: &mut [f32]) {
    fn of<L: GatherLanes, const P: usize, const B: usize>(batch: &Batch<L, P, B>, impulses: &mut [f32]) {
        for lane in (0..L::N).filter(|lane| batch.heard >> lane & 1 != 0) {
            let sum: f32 = batch.points.iter().map(|p| p.impulse.lane(lane)).sum();
            // Of those that there was no room for, nothing is heard.
            impulses.get_mut(batch.contact[lane].slot()).into_iter().for_each(|impulse| *impulse += sum);
        }
    }
    for stage in views.stages {
        for &batch in &views.schedule[stage.start as usize..stage.end as usize] {
            // SAFETY: there is no other thread.
            unsafe { with_batch!(views, stage.group, batch, |batch, _friction| of(batch, impulses)) };
        }
    }
}

/// Takes the rows of some bodies out of what is left of the step: what stands after an impact is not there any more. Rows would
/// push it out of overlap, which gains energy, and into others, which takes theirs.
pub(crate) fn disable(views: &Views<'_>, motion: &Motion<'_, '_>, stands: &dyn Fn(u32) -> bool) {
    for stage in views.stages {
        for &batch in &views.schedule[stage.start as usize..stage.end as usize] {
            // SAFETY: there is no other thread.
            unsafe {
                with_batch!(views, stage.group, batch, |row, friction| {
                    let touching = if stage.group.is_potential() { None } else { friction.touching(batch) };
                    disable_lanes(row, touching, motion, stands);
                });
            }
        }
    }
}

/// What storing the impulses of a step found.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stored {
    /// Contacts that pushed before they touched.
    pub(crate) pushed: u32,
    /// Whether some contact bears a load that statics did not estimate yet.
    pub(crate) unknown_load: bool,
}

/// Writes impulses back to the contacts, after a step of `dt` seconds.
pub(crate) fn store(
    workers: &Workers<'_>,
    rows: &mut Rows,
    dt: f32,
    lengths: StepLengths,
    contacts: &Shared<'_, Contact>,
) -> Stored {
    let (pushed, unknown) = (AtomicU32::new(0), AtomicBool::new(false));
    let views = rows.views();
    let block = |stage: &Stage, index: usize| {
        let of = views.schedule[index];
        let potential = stage.group.is_potential();
        // SAFETY: each batch stands in the schedule once. Of what may touch there are no rows.
        let stored = unsafe {
            with_batch!(views, stage.group, of, |batch, friction| {
                let rows = if potential { None } else { friction.touching(of) };
                store_in_contacts(batch, rows.as_deref(), potential, (dt, lengths), contacts)
            })
        };
        if stored.pushed > 0 {
            pushed.fetch_add(stored.pushed, Ordering::Relaxed);
        }
        if stored.unknown_load {
            unknown.store(true, Ordering::Relaxed);
        }
    };
    for stage in views.stages {
        let (start, end) = (stage.start as usize, stage.end as usize);
        if stage.serial {
            // Points of one contact may both be here.
            (start..end).for_each(|index| block(stage, index));
            continue;
        }
        workers.run((end - start).div_ceil(STORED), &|n| {
            let first = start + n * STORED;
            (first..(first + STORED).min(end)).for_each(|index| block(stage, index));
        });
    }
    Stored { pushed: pushed.into_inner(), unknown_load: unknown.into_inner() }
}

fn take(point: &mut Point, impulse: f32, lengths: StepLengths) {
    point.impulse = impulse;
    point.mean_force = lengths.follow(point.mean_force, impulse);
}

fn store_in_contacts<L: GatherLanes, const P: usize, const B: usize>(
    batch: &Batch<L, P, B>,
    friction: Option<&FrictionRow<L, B>>,
    potential: bool,
    (dt, lengths): (f32, StepLengths),
    contacts: &Shared<'_, Contact>,
) -> Stored {
    let (mut stored, rubs) = (Stored::default(), friction.is_some());
    store_batch(batch, friction, |part, impulses, peak, friction, twist| {
        // SAFETY: a contact is in one lane of one batch. Its points, if apart, are in different stages, or in one that is
        // serial.
        let contact = unsafe { contacts.get(part.slot()) };
        let pushed = potential && peak > 0.0;
        let friction = if rubs { contact.frame.conjugate() * friction } else { glam::Vec3::ZERO };
        // Of a contact whose points are apart, another may have pushed already.
        stored.pushed += u32::from(pushed && !contact.pushed);
        if let Some(point) = part.only() {
            take(&mut contact.points[point], impulses[0], lengths);
            contact.pushed |= pushed;
            contact.friction += friction;
            forget_unsound(contact);
            return;
        }
        if part.is_cut() {
            let (kept, mut impulses) = (part.points(contact), impulses.iter());
            for (i, point) in contact.points[..contact.count as usize].iter_mut().enumerate() {
                let impulse = if kept >> i & 1 != 0 { impulses.next() } else { None };
                take(point, impulse.copied().unwrap_or(0.0), lengths);
            }
        } else {
            for (point, &impulse) in contact.points.iter_mut().zip(impulses).take(contact.count as usize) {
                take(point, impulse, lengths);
            }
        }
        contact.pushed = pushed;
        (contact.friction, contact.twist) = (friction, twist);
        contact.mean_friction = lengths.follow(contact.mean_friction, friction.extend(twist));
        stored.unknown_load |= contact.bear(dt, lengths.now());
        forget_unsound(contact);
    });
    stored
}

/// The heaviest bodies at the greatest speeds may bear more than is a number, though they are stopped.
fn forget_unsound(contact: &mut Contact) {
    if !contact.has_sound_loads() {
        contact.forget_loads();
    }
}
