//! Accelerations of the step, inertia in world axes, and the predicted motion.

use crate::body::{Bodies, Damping, Mass, Traits, is_uneven};
use crate::lanes::{Lanes, Record, Sym3, is_within};
use crate::limits::MAX_LEFT_SPEED;
use crate::math::Quat;
use crate::memory::buffers;
use crate::threads::{Shared, Workers, per_block};
use glam::{Mat3, Vec3};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// Data of each body that is computed before collision detection.
#[derive(Debug, Default)]
pub(crate) struct Forces {
    /// Linear [m/s²] and angular [rad/s²] acceleration.
    pub(crate) acceleration: Vec<Record>,
    /// Inverse inertia in world axes [1/(kg m²)], of dynamic bodies.
    pub(crate) inverse_inertia: Vec<Sym3<f32>>,
    /// Velocities at the start of the step.
    pub(crate) start: Vec<Record>,
    /// Predicted displacement [m] and rotation vector [rad] of the step.
    pub(crate) motion: Vec<Record>,
    /// [`Bodies::rearranged`] at the prediction.
    rearranged: u64,
}

impl Forces {
    /// Whether its columns are those of the bodies as they are arranged now. Stages of a step index both
    /// alike, so from the prediction until bodies have moved none may wake, fall asleep, come or go.
    pub(crate) fn is_of(&self, bodies: &Bodies) -> bool {
        self.rearranged == bodies.rearranged
    }
}

buffers! {
    Forces {
        /// For so many bodies that can move, and that can be pushed; without the predicted motion.
        each(movers: usize, dynamic: usize) { acceleration(movers), inverse_inertia(dynamic), start(movers) }
    }
}

impl Forces {
    #[cfg(debug_assertions)]
    pub(crate) fn spoil(&mut self) {
        use crate::memory::spoil;
        let Forces { acceleration, inverse_inertia, start, motion, rearranged: _ } = self;
        [acceleration, start, motion].into_iter().for_each(spoil);
        spoil(inverse_inertia);
    }
}

/// Bodies in a block of work.
const BLOCK: usize = per_block(256, 1);

/// Whether a step can begin with a motion: the velocity that it predicts is within [`MAX_LEFT_SPEED`].
pub(crate) fn is_sound(motion: &Record, pull: &Record, dt: f32) -> bool {
    let (motion, pull) = (bytemuck::must_cast(*motion), bytemuck::must_cast(*pull));
    // The angle of a motion is that of its rotation, about any axis.
    is_within(motion, 2.0 * MAX_LEFT_SPEED * dt) && is_within(pull, MAX_LEFT_SPEED / dt)
}

/// Takes away half of the velocity that damped bodies lose in a step of `dt` seconds: once when it begins,
/// and once when it has ended.
///
/// Two halves, so that where a body gets to, and its terminal velocity in gravity, have errors of the second
/// order in `dt`; the decay itself is exact, with any number of substeps.
pub(crate) fn damp(bodies: &mut Bodies, dt: f32) {
    let dynamic = bodies.dynamic();
    let Bodies { rare, slots, velocity, .. } = bodies;
    let (mut last, mut factors) = (Damping::default(), [1.0; 2]);
    // Guard: far below any speed that matters. Denormal numbers are slow.
    let left = |v: Vec3| if v.abs().max_element() < 1e-30 { Vec3::ZERO } else { v };
    for (slot, damping) in rare.damping.iter() {
        let index = slots.dense(slot) as usize;
        if index >= dynamic {
            continue;
        }
        if damping != last {
            last = damping;
            factors = [damping.linear, damping.angular]
                .map(|rate| libm::exp(-0.5 * f64::from(rate) * f64::from(dt)) as f32);
        }
        let v = &mut velocity[index];
        (v.linear, v.angular) = (left(v.linear * factors[0]), left(v.angular * factors[1]));
    }
}

/// Slows capped bodies down to their greatest speeds.
pub(crate) fn cap(bodies: &mut Bodies) {
    let dynamic = bodies.dynamic();
    let Bodies { rare, slots, velocity, .. } = bodies;
    for (slot, cap) in rare.caps.iter() {
        let index = slots.dense(slot) as usize;
        if index < dynamic {
            velocity[index] = cap.hold(velocity[index]);
        }
    }
}

/// Computes [`Forces`] for a step of `dt` seconds. Returns whether the motion of a dynamic body is not
/// [sound](is_sound).
pub(crate) fn predict(
    workers: &Workers<'_>,
    bodies: &mut Bodies,
    gravity: Vec3,
    forces: &mut Forces,
    dt: f32,
) -> bool {
    let (movers, dynamic) = (bodies.movers(), bodies.dynamic());
    if bodies.locked > 0 {
        // A velocity that the caller set about a locked axis must not look like an impact to the rows.
        bodies.velocity[..dynamic].iter_mut().zip(&bodies.traits).for_each(|(v, traits)| traits.lock(v));
    }
    let Forces { acceleration, inverse_inertia, start, motion, rearranged } = forces;
    *rearranged = bodies.rearranged;
    start.clear();
    start.extend_from_slice(&bodies.velocity[..movers]);
    let pulled = gravity != Vec3::ZERO || bodies.is_pushed();
    acceleration.resize(if pulled { movers } else { 0 }, Record::default());
    motion.resize(movers, Record::default());
    inverse_inertia.resize(dynamic, Sym3::default());
    let bodies = &*bodies;
    let out = Out {
        acceleration: Shared::new(acceleration),
        inverse_inertia: Shared::new(inverse_inertia),
        motion: Shared::new(motion),
    };
    let unsound = AtomicBool::new(false);
    workers.run(movers.div_ceil(BLOCK), &|block| {
        let block = block * BLOCK..((block + 1) * BLOCK).min(movers);
        // Features that no body needs are not checked for each body.
        let sound = match (bodies.locked > 0, pulled) {
            (false, true) => predict_block::<false, true>(block, bodies, gravity, dt, &out),
            (false, false) => predict_block::<false, false>(block, bodies, gravity, dt, &out),
            (true, true) => predict_block::<true, true>(block, bodies, gravity, dt, &out),
            (true, false) => predict_block::<true, false>(block, bodies, gravity, dt, &out),
        };
        if !sound {
            unsound.store(true, Ordering::Relaxed);
        }
    });
    unsound.into_inner()
}

/// Where predictions are written.
struct Out<'a> {
    acceleration: Shared<'a, Record>,
    inverse_inertia: Shared<'a, Sym3<f32>>,
    motion: Shared<'a, Record>,
}

/// Returns whether all motions are sound.
fn predict_block<const LOCKED: bool, const PULLED: bool>(
    block: Range<usize>,
    bodies: &Bodies,
    gravity: Vec3,
    dt: f32,
    out: &Out<'_>,
) -> bool {
    let (dynamic, mut sound) = (bodies.dynamic(), true);
    for i in block {
        let v = bodies.velocity[i];
        let mut pull = Record::default();
        if i < dynamic {
            let inverse = if LOCKED { world_inertia(bodies, i) } else { free_inertia(bodies, i) };
            if PULLED {
                pull = accelerate(bodies, i, gravity, &inverse);
                if LOCKED {
                    bodies.traits[i].lock(&mut pull);
                }
            }
            // SAFETY: each body is in one block.
            unsafe { *out.inverse_inertia.get(i) = inverse };
        }
        let predicted = Record::predicted(
            v.linear * dt + pull.linear * (0.5 * dt * dt),
            v.angular * dt,
            v.angular.length() * dt,
        );
        // Without acceleration a velocity is as the caller set it or the previous step left it.
        if PULLED {
            sound &= is_sound(&predicted, &pull, dt);
        }
        // SAFETY: each body is in one block.
        unsafe {
            if PULLED {
                *out.acceleration.get(i) = pull;
            }
            *out.motion.get(i) = predicted;
        }
    }
    sound
}

fn accelerate(bodies: &Bodies, i: usize, gravity: Vec3, inverse: &Sym3<f32>) -> Record {
    let (mass, traits) = (&bodies.mass[i], &bodies.traits[i]);
    // Zeros have no sign, so that a column of them is equivalent to none.
    let mut pull = Record { linear: gravity * traits.gravity_scale + Vec3::ZERO, ..Record::default() };
    if let Some(force) = bodies.force.get(i).filter(|force| **force != Record::default()) {
        pull.linear += force.linear * mass.inverse;
        let t = force.angular;
        pull.angular = inverse.mul(crate::lanes::Vec3::new(t.x, t.y, t.z)).lane(0);
    }
    if mass.inverse == 0.0 {
        pull.linear = Vec3::ZERO;
    }
    pull
}

/// Whether the gyroscopic term matters, which `finish` adds when it rotates a body: unequal moments, and a
/// large enough angular velocity.
pub(crate) fn spins_freely(mass: &Mass, traits: &Traits, spin: Vec3, dt: f32) -> bool {
    spin.length_squared() * dt * dt > 1e-6 && is_uneven(mass, traits)
}

/// Inverse inertia in world axes. A locked axis has none, and the others rotate as if it did not exist.
pub(crate) fn world_inertia(bodies: &Bodies, i: usize) -> Sym3<f32> {
    let locks = bodies.traits[i].locks >> 3;
    if locks == 0 {
        return free_inertia(bodies, i);
    }
    let mass = &bodies.mass[i];
    let r = bodies.pose[i].rotation.matrix();
    let [x, y, z] = diagonal(&r, mass.inertia);
    let mut m = Mat3::from_cols(x, y, z);
    for axis in (0..3).filter(|axis| locks >> axis & 1 != 0) {
        for other in 0..3 {
            m.col_mut(axis)[other] = 0.0;
            m.col_mut(other)[axis] = 0.0;
        }
        m.col_mut(axis)[axis] = 1.0;
    }
    // Scaled by a power of two, which is exact: otherwise the determinant of huge or tiny values would
    // overflow or underflow.
    let unit = 1.0 / m.x_axis.x.max(m.y_axis.y).max(m.z_axis.z).power_of_two().max(f32::MIN_POSITIVE);
    m *= unit;
    let mut inverse = if m.determinant() > 0.0 { m.inverse() * unit } else { Mat3::ZERO };
    for axis in (0..3).filter(|axis| locks >> axis & 1 != 0) {
        inverse.col_mut(axis)[axis] = 0.0;
    }
    let (x, y, z) = (inverse.x_axis, inverse.y_axis, inverse.z_axis);
    Sym3 { xx: x.x, yy: y.y, zz: z.z, xy: x.y, xz: x.z, yz: y.z }
}

/// The same for a body without locked axes.
#[inline(always)]
fn free_inertia(bodies: &Bodies, i: usize) -> Sym3<f32> {
    turned_inertia(bodies.pose[i].rotation, &bodies.mass[i])
}

/// The same for a body in a given orientation.
#[inline(always)]
pub(crate) fn turned_inertia(rotation: Quat, mass: &Mass) -> Sym3<f32> {
    let r = rotation.matrix();
    let [x, y, z] = diagonal(&r, mass.inverse_inertia);
    Sym3 { xx: x.x, yy: y.y, zz: z.z, xy: x.y, xz: x.z, yz: y.z }
}

/// A diagonal matrix in rotated axes.
#[inline(always)]
fn diagonal(r: &Mat3, d: Vec3) -> [Vec3; 3] {
    let column = |row: usize| {
        r.x_axis[row] * d.x * r.x_axis + r.y_axis[row] * d.y * r.y_axis + r.z_axis[row] * d.z * r.z_axis
    };
    [column(0), column(1), column(2)]
}
