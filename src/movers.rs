//! The broad stage: updates the colliders of moving bodies and finds the pairs of the step.
//!
//! Bodies with their predicted motions in; poses of their colliders at the start of the step, the list of
//! pairs, and [`Buffers::removed`], the pairs that ended, out.

use crate::body::{Bodies, BodyKind, Colliders};
use crate::broad_phase::{Aabb, BroadPhase, BroadStats, Mover, Pair, PairMemory, Rules, aabb_of};
use crate::config::ContinuousMode;
use crate::config::tuning::FAT_MARGIN;
use crate::joint::Joints;
use crate::lanes::Record;
use crate::math::Quat;
use crate::memory::{Allowances, Category, buffers, bytes_of};
use crate::shape::{Collider, ColliderSummary, Symmetry};
use crate::threads::{Shared, Workers, per_block};
use glam::Vec3;

/// Buffers of one step.
#[derive(Debug, Default)]
pub(crate) struct Buffers {
    movers: Vec<Mover>,
    /// For each body, the number of colliders of the bodies before it.
    starts: Vec<u32>,
    /// Pairs that ended.
    pub(crate) removed: Vec<Pair>,
}

impl Buffers {
    #[cfg(debug_assertions)]
    pub(crate) fn spoil(&mut self) {
        use crate::memory::spoil;
        spoil(&mut self.movers);
        spoil(&mut self.starts);
    }
}

buffers! {
    Buffers {
        /// For so many bodies that can move, and their colliders; without the list of pairs.
        each(bodies: usize, colliders: usize) { movers(colliders), starts(bodies) }
    }
}

impl Buffers {
    /// Live and reserved bytes of the pairs that ended.
    pub(crate) fn removed_bytes(&self) -> (usize, usize) {
        bytes_of(&self.removed)
    }
}

/// Number of bodies whose movers are made before the broad phase takes them in: they stay in the L1 cache,
/// and a few buffers suffice.
const WAVE: usize = 8 * BLOCK;
/// Bodies in a block of work.
const BLOCK: usize = per_block(128, 1);

/// Input of the broad stage.
pub(crate) struct Input<'a> {
    pub(crate) bodies: &'a Bodies,
    pub(crate) joints: &'a Joints,
    /// Predicted displacement [m] and rotation vector [rad] of each movable body.
    pub(crate) motion: &'a [Record],
    /// The world's mode; a body's own may be less.
    pub(crate) mode: ContinuousMode,
    /// The length unit [m].
    pub(crate) unit: f32,
    /// Whether a sensor notices static shapes.
    pub(crate) senses_static: bool,
}

/// Updates the colliders of all movable bodies, and their boxes in the broad phase.
pub(crate) fn place(
    workers: &Workers<'_>,
    input: &Input<'_>,
    colliders: &mut Colliders,
    broad: &mut BroadPhase,
    buffers: &mut Buffers,
    allowances: &mut Allowances,
) {
    let count = input.bodies.movers();
    let Buffers { movers, starts, .. } = buffers;
    starts.clear();
    let mut total = 0;
    for colliders in &input.bodies.colliders[..count] {
        starts.push(total);
        total += colliders.as_slice().len() as u32;
    }
    let empty = Mover {
        collider: 0,
        aabb: Aabb { min: Vec3::ZERO, max: Vec3::ZERO },
        motion: Vec3::ZERO,
        spin: 0.0,
        mode: ContinuousMode::Discrete,
    };
    // With a budget, capacity for all is reserved in advance.
    let wave = if allowances.is_endless() { WAVE } else { count.max(1) };
    let per_metre = 1.0 / input.unit;
    broad.start_movers();
    for first in (0..count).step_by(wave) {
        let end = count.min(first + wave);
        let start = starts[first];
        let len = (starts.get(end).copied().unwrap_or(total) - start) as usize;
        allowances.within(Category::Scratch, |allowance| allowance.fit(movers, len));
        movers.resize(len, empty);
        let out = Shared::new(movers);
        let (poses, swings) = (Shared::new(&mut colliders.poses), Shared::new(&mut colliders.swings));
        let odometers = Shared::new(&mut colliders.odometers);
        let (bodies, all, summaries) = (input.bodies, &colliders.all, &colliders.summaries);
        let (motion, whole) = (input.motion, input.mode);
        let starts = &*starts;
        workers.run((end - first).div_ceil(BLOCK), &|block| {
            for i in first + block * BLOCK..(first + (block + 1) * BLOCK).min(end) {
                let mode = whole.of(bodies.traits[i].continuous);
                let pose = &bodies.pose[i];
                for (k, &c) in bodies.colliders[i].as_slice().iter().enumerate() {
                    let collider = &all[c as usize];
                    // SAFETY: a collider has one body, and a body is in one block.
                    unsafe {
                        let placed = poses.get(c as usize);
                        let old =
                            std::mem::replace(placed, pose.of_part(collider.position, collider.rotation));
                        let shape = &summaries[c as usize];
                        let swing = swing(shape, placed.rotation, &motion[i]);
                        *swings.get(c as usize) = swing;
                        let reach = motion[i].linear.length() + swing;
                        odometers.get(c as usize).advance([&old, placed], shape.radius, reach, per_metre);
                        *out.get((starts[i] - start) as usize + k) = mover(
                            c,
                            collider,
                            &motion[i],
                            aabb_of(collider, pose.position, pose.rotation),
                            mode,
                        );
                    }
                }
            }
        });
        broad.place_movers(movers, FAT_MARGIN * input.unit);
    }
}

/// Finds the pairs of the step. `missing`: bytes that later stages need for so many pairs.
pub(crate) fn find(
    workers: &Workers<'_>,
    input: &Input<'_>,
    colliders: &[Collider],
    broad: &mut BroadPhase,
    buffers: &mut Buffers,
    missing: &dyn Fn(usize) -> usize,
    memory: &mut PairMemory<'_>,
) -> BroadStats {
    let count = input.bodies.movers();
    buffers.removed.clear();
    let (bodies, all, joints) = (input.bodies, colliders, input.joints);
    let may_collide = |a: u32, b: u32| {
        let (a, b) = (&all[a as usize], &all[b as usize]);
        let dynamic = |c: &Collider| bodies.kind[c.body as usize] == BodyKind::Dynamic;
        let awake = |c: &Collider| (c.body as usize) < count;
        let moves = |c: &Collider| bodies.kind[c.body as usize] != BodyKind::Static;
        let still = || !moves(a) && !moves(b) && (a.senses_static() || b.senses_static());
        a.body != b.body
            && (awake(a) || awake(b) || still())
            && a.filter.allows(&b.filter)
            && if a.is_sensor() || b.is_sensor() {
                let (sensor, visitor) = if a.is_sensor() { (a, b) } else { (b, a) };
                !visitor.is_sensor() && (moves(visitor) || sensor.senses_static())
            } else {
                (dynamic(a) || dynamic(b))
                    && !joints.keep_apart(bodies.slot[a.body as usize], bodies.slot[b.body as usize])
            }
    };
    let order = |a: u32, b: u32| {
        let kind = |c: u32| all[c as usize].kind;
        if (kind(a), a) <= (kind(b), b) { (a, b) } else { (b, a) }
    };
    let still = input.senses_static;
    let rules = Rules { may_collide: &may_collide, order: &order, missing, still };
    broad.update_within(workers, &rules, &mut buffers.removed, memory)
}

/// How far a motion's rotation moves points of a shape, at most [m]. `rotation`: the shape's.
fn swing(shape: &ColliderSummary, rotation: Quat, motion: &Record) -> f32 {
    // An endless plane on a body that doesn't turn reaches nowhere.
    let turn = motion.turn_angle;
    if turn == 0.0 {
        return 0.0;
    }
    // Turning a round shape about its axis does not change it.
    let tilt = match shape.kind.symmetry() {
        Symmetry::Ball => return turn * shape.lever,
        Symmetry::Axis => motion.angular.cross(rotation * Vec3::Y).length(),
        Symmetry::None => turn,
    };
    // A point of the shape can't move further than across it.
    turn * shape.lever + (tilt * shape.radius).min(2.0 * shape.radius)
}

fn mover(c: u32, collider: &Collider, motion: &Record, aabb: Aabb, mode: ContinuousMode) -> Mover {
    let turn = motion.angular.length();
    // A point can't move further than the diameter of its circle.
    let swing = |arm: f32| (turn * arm).min(2.0 * arm);
    let spin = if turn == 0.0 { 0.0 } else { swing(collider.position.length() + collider.radius) };
    Mover { collider: c, aabb, motion: motion.linear, spin, mode }
}
