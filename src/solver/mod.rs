//! Batches in, velocities and displacements out: warm start, iterate, substep, relax, store.
//!
//! Collisions are found once a step; the substeps solve the same rows with separations that follow the bodies (Macklin
//! et al., *Small Steps in Physics Simulation*, 2019; Catto's soft step with relaxation). One substep and several
//! iterations make it plain sequential impulses: the kernels are the same.

mod impact_body;
mod pass;

use crate::body::Bodies;
use crate::config::tuning::{
    BOUNCE_TOGETHER, FOLLOWED_TURN, JOINT_DAMPING, JOINT_HERTZ, JOINT_OPEN, JOINT_PUSH_SPEED,
    STIFFEST_SPRING_SHARE, SWIFT_DISTANCE,
};
use crate::config::tuning::{LOAD_SHIFT_SPEED, TOUCH_DISTANCE};
use crate::config::{FrictionCone, Settings};
use crate::constraint::contact::crowd::Crowd;
use crate::constraint::contact::row::{Motion, Softness};
use crate::constraint::{
    Closing, JointRows, JointViews, NetInput, Recovery, Restitution, Rows, Struck, Views, usual_substep,
};
use crate::forces::Forces;
use crate::lanes::{Lanes, Mask, Record, f32x8, is_within};
use crate::limits::MAX_LEFT_SPEED;
use crate::memory::buffers;
use crate::shape::Collider;
use crate::threads::{Shared, Workers, per_block};
pub(crate) use impact_body::ImpactBody;
pub(crate) use pass::store;
use pass::{Joined, Kind, Passes, add_impulses, disable};
use std::sync::atomic::{AtomicBool, Ordering};

/// Solver state of the bodies that can move.
#[derive(Debug, Default)]
pub(crate) struct State {
    /// Displacement [m] and rotation vector [rad] since the start of the step.
    pub(crate) delta: Vec<Record>,
    /// Velocities of the substep before any row acted.
    base: Vec<Record>,
    /// Substep that springs of contacts are made for [s].
    pub(crate) usual_h: f32,
}

buffers! { State { each(movers: usize) { delta(movers + 1), base(movers + 1) } } }

/// Looks on while rows are solved: the lab does, on request.
pub(crate) trait Witness {
    /// Something other than rows is about to change velocities.
    fn before(&mut self, velocity: &[Record]);
    /// It did.
    fn after(&mut self, velocity: &[Record]);
    /// How many contacts there are.
    fn contacts(&self) -> usize;
    /// What bounced gave contacts such normal impulses [N s], in the order of contacts.
    fn impacts(&mut self, impulses: &mut dyn Iterator<Item = f32>);
    /// Velocities take so much acceleration for a time [s].
    fn pull(&mut self, acceleration: &[Record], h: f32);
    /// A substep is over.
    fn substep(&mut self, rows: &Views<'_>, joints: &JointViews<'_>);
}

/// Bodies a block.
const BLOCK: usize = per_block(256, 1);

/// Solves the rows over a step of `dt` seconds. `impulses`: those of contacts that someone listens to are added, or nothing if
/// it is empty. Says whether all velocities stayed in range.
pub(crate) fn solve(
    workers: &Workers<'_>,
    settings: &Settings,
    dt: f32,
    bodies: &mut Bodies,
    forces: &mut Forces,
    (rows, joints): (&mut Rows, &mut JointRows),
    (impacts, impulses, colliders): (&mut Restitution, &mut [f32], &[Collider]),
    (state, crowd, mut witness): (&mut State, &Crowd, Option<&mut dyn Witness>),
) -> bool {
    let movers = bodies.movers();
    let h = dt / settings.substeps as f32;
    state.delta.clear();
    // One more for all that stands still, which joints may be fixed to.
    state.delta.resize(movers + 1, Record::default());
    state.base.clear();
    state.base.resize(movers + 1, Record::default());

    state.usual_h = usual_substep(state.usual_h, h);
    let count = settings.iterations + 1;
    let hertz = settings.contact_hertz.min(STIFFEST_SPRING_SHARE * Softness::stiffest(count, state.usual_h));
    // What is fixed is twice as stiff; both are too stiff for a substep or none is.
    let spring = Softness::for_substep(hertz, settings.contact_damping, count, h);
    let fixed = Softness::new(2.0 * hertz, settings.contact_damping, h);
    let fixed = if spring.bias_rate > 0.0 { fixed } else { fixed.locked() };
    let passes = Passes {
        inverse_h: 1.0 / h,
        dynamic: spring,
        fixed,
        push_speed: settings.push_speed * settings.length_unit,
        shift: LOAD_SHIFT_SPEED * settings.length_unit,
        real: TOUCH_DISTANCE * settings.length_unit,
        friction_box: settings.friction_cone == FrictionCone::Box,
        recovery: Recovery { linear: JOINT_PUSH_SPEED * settings.length_unit, angular: JOINT_PUSH_SPEED },
        joint: Softness::new(JOINT_HERTZ.min(Softness::stiffest(count, h)), JOINT_DAMPING, h),
    };
    let joint_stages = std::mem::take(&mut joints.stages);
    let mut nets = std::mem::take(&mut joints.nets);
    nets.start();
    let joined_at_all = !joint_stages.is_empty();
    let dynamic = bodies.dynamic();
    // Of what stands still the first is enough: all are zero.
    let known = bodies.velocity.len().min(movers + 1);
    let velocity = Shared::new(&mut bodies.velocity[..known]);
    let delta = Shared::new(&mut state.delta);
    let base = Shared::new(&mut state.base);
    let motion = Motion { velocity: &velocity, delta: &delta, base: &base };
    let views = joints.views();
    let (rubs, batches) = (rows.has_friction(), rows.views());
    let joined = Joined { stages: &joint_stages, views: &views };
    let (pose, mass, traits, own) = (&bodies.pose, &bodies.mass, &bodies.traits, &bodies.colliders);
    // What turns or goes further in a substep may be more than rows of joints follow.
    let swift = {
        let slides = joint_stages.iter().any(|stage| stage.kind.slides());
        let way = if slides { SWIFT_DISTANCE * settings.length_unit } else { f32::INFINITY };
        let turn = if joined_at_all { FOLLOWED_TURN } else { f32::INFINITY };
        f32x8::new([way, way, way, way, turn, turn, turn, turn]) * f32x8::splat(1.0 / h)
    };
    let unsound = AtomicBool::new(false);
    let calm = || {
        if !crowd.is_empty() {
            // SAFETY: between stages this thread is alone.
            let (velocity, base) = unsafe { (velocity.part(0..known), base.part(0..movers)) };
            crowd.calm(velocity, base, settings.push_speed * settings.length_unit);
        }
    };
    let watch = |witness: &mut Option<&mut dyn Witness>, done: bool| {
        if let Some(witness) = witness.as_deref_mut() {
            // SAFETY: between stages this thread is alone.
            let velocity = unsafe { velocity.part(0..known) };
            if done { witness.after(velocity) } else { witness.before(velocity) }
        }
    };
    for substep in 0..settings.substeps {
        if !impacts.is_empty() {
            // SAFETY: between stages this thread is alone.
            let (velocity, base, delta) =
                unsafe { (velocity.part(0..known), base.part(0..movers), delta.part(0..movers)) };
            let mut struck = Struck {
                velocity,
                base,
                delta,
                acceleration: &mut forces.acceleration,
                inverse_inertia: &forces.inverse_inertia,
                mass,
                traits,
                pose,
                colliders: (own, colliders),
                done: h * substep as f32,
                h,
                left: h * (settings.substeps - substep) as f32,
                threshold: settings.restitution_threshold * settings.length_unit,
                together: BOUNCE_TOGETHER * settings.length_unit,
            };
            let before = impacts.standing().len();
            if let Some(witness) = witness.as_deref_mut() {
                witness.before(struck.velocity);
                let mut own = impulses.to_vec();
                own.resize(witness.contacts(), 0.0);
                impacts.meet(&mut struck, &mut own);
                let old = |i: usize| impulses.get(i).copied().unwrap_or(0.0);
                witness.impacts(&mut own.iter().enumerate().map(|(i, new)| new - old(i)));
                let heard = impulses.len();
                impulses.copy_from_slice(&own[..heard]);
                witness.after(struck.velocity);
            } else {
                impacts.meet(&mut struck, impulses);
            }
            if impacts.standing().len() > before {
                disable(&batches, &motion, &|body| impacts.stands(body));
                // SAFETY: as above.
                let (velocity, base) =
                    unsafe { (motion.velocity.part(0..known), motion.base.part(0..movers)) };
                impacts.standing().iter().for_each(|&i| base[i as usize] = velocity[i as usize]);
            }
        }
        if let Some(witness) = witness.as_deref_mut() {
            witness.pull(&forces.acceleration, h);
        }
        // Velocities take gravity and forces. From the second substep on, warm starting is one addition a body: rows
        // keep their directions within a step, so the impulses of the substep before change the velocities by just
        // what they did then. Those of joints turn, and see to it themselves; trees that keep their energy need none.
        let is_swift_at = |v: &Record| lanes(*v).abs().lt(swift).bits() & BOTH != BOTH;
        let is_swift = AtomicBool::new(false);
        all_bodies(workers, movers, |i| {
            // SAFETY: each body is in one block.
            let (v, b) = unsafe { (velocity.get(i), base.get(i)) };
            let now = lanes(*v);
            if is_swift_at(v) {
                is_swift.store(true, Ordering::Relaxed);
            }
            let warm = if substep == 0 { f32x8::ZERO } else { now - lanes(*b) };
            let pull = forces.acceleration.get(i).map_or(f32x8::ZERO, |&pull| lanes(pull) * f32x8::splat(h));
            let free = now + pull;
            (*b, *v) = (record(free), record(if i < dynamic { free + warm } else { free }));
        });
        let net_input = NetInput {
            views: &views,
            stages: &joint_stages,
            motion: &motion,
            pose,
            mass,
            pull: &forces.acceleration,
            h,
            recovery: passes.recovery,
        };
        let mut watched = joined_at_all && is_swift.into_inner();
        if watched {
            nets.begin(&net_input, &batches, dynamic, &is_swift_at);
        }
        if substep == 0 {
            passes.run(workers, Kind::WarmStart, &batches, &joined, &motion);
        }
        if joined_at_all {
            passes.predict(workers, &joined, &motion);
        }
        for _ in 0..settings.iterations {
            passes.run(workers, Kind::Solve, &batches, &joined, &motion);
        }
        watch(&mut witness, false);
        calm();
        watch(&mut witness, true);
        if joined_at_all {
            let is_swift = AtomicBool::new(false);
            all_bodies(workers, movers, |i| {
                // SAFETY: each body is in one block.
                if is_swift_at(unsafe { velocity.get(i) }) {
                    is_swift.store(true, Ordering::Relaxed);
                }
            });
            // What was still may be thrown by others, or by a spring.
            if !watched && is_swift.into_inner() {
                nets.begin(&net_input, &batches, dynamic, &is_swift_at);
                watched = true;
            }
        }
        watch(&mut witness, false);
        if watched {
            nets.hold_back(&net_input, &is_swift_at);
        }
        watch(&mut witness, true);
        all_bodies(workers, movers, |i| {
            // SAFETY: each body is in one block.
            let (v, d, b) = unsafe { (velocity.get(i), delta.get(i), base.get(i)) };
            let (now, before) = (lanes(*v), lanes(*b));
            if !is_within(now, MAX_LEFT_SPEED) {
                unsound.store(true, Ordering::Relaxed);
            }
            let same = now.eq(before).bits();
            let mut moved = now * f32x8::splat(h);
            if i < dynamic
                && same & LINEAR == LINEAR
                && let Some(&fall) = forces.acceleration.get(i)
            {
                // Nothing touched the body: its path is the parabola, not the chord of semi-implicit Euler.
                moved -= lanes(Record { angular: glam::Vec3::ZERO, ..fall }) * f32x8::splat(0.5 * h * h);
            }
            // The pad tells `finish` whether the body was free all along. Added with the rest: what is written in parts
            // makes the next who reads it wait.
            let touched = if same & BOTH == BOTH { 0.0 } else { 1.0 };
            *d = record(lanes(*d) + (moved + f32x8::new(PAD) * f32x8::splat(touched)));
        });
        watch(&mut witness, false);
        if !impacts.is_empty() {
            // SAFETY: as above.
            let moving = unsafe { [velocity.part(0..known), base.part(0..movers), delta.part(0..movers)] };
            impacts.go_on(h, moving, &forces.acceleration);
        }
        if joined_at_all {
            passes.go(workers, &batches, &joined, &motion, &closing(settings));
        }
        watch(&mut witness, true);
        if passes.run(workers, Kind::Relax, &batches, &joined, &motion) && rubs {
            // What was pushed before it touched has its friction now; if that is much, the points share the load that it
            // shifts.
            watch(&mut witness, false);
            let shifts = passes.run(workers, Kind::Rub, &batches, &joined, &motion);
            watch(&mut witness, true);
            if shifts {
                passes.run(workers, Kind::Relax, &batches, &joined, &motion);
            }
        }
        watch(&mut witness, false);
        if watched {
            nets.end(&net_input);
        } else {
            nets.rest();
        }
        calm();
        watch(&mut witness, true);
        if let Some(witness) = witness.as_deref_mut() {
            witness.substep(&batches, &views);
        }
        if !impulses.is_empty() {
            add_impulses(&batches, impulses);
        }
    }
    watch(&mut witness, false);
    // SAFETY: no stage runs.
    impacts.let_go(dt, unsafe { velocity.part(0..known) }, &mut forces.acceleration);
    watch(&mut witness, true);
    joints.nets = nets;
    joints.stages = joint_stages;
    !unsound.into_inner()
}

/// How far trees may be open.
pub(crate) fn closing(settings: &Settings) -> Closing {
    Closing { tolerance: JOINT_OPEN, slop: settings.slop * settings.length_unit }
}

/// Bits of the lanes of a record that hold the linear part, and both parts; and the lane of the first pad.
const LINEAR: u32 = 0b0000_0111;
const BOTH: u32 = 0b0111_0111;
const PAD: [f32; 8] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0];

#[inline(always)]
fn all_bodies(workers: &Workers<'_>, movers: usize, work: impl Fn(usize) + Sync) {
    workers.run(movers.div_ceil(BLOCK), &|block| {
        (block * BLOCK..((block + 1) * BLOCK).min(movers)).for_each(&work);
    });
}

#[inline(always)]
fn lanes(record: Record) -> f32x8 {
    bytemuck::must_cast(record)
}

#[inline(always)]
fn record(lanes: f32x8) -> Record {
    bytemuck::must_cast(lanes)
}
