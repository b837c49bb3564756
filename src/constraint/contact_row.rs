//! The rows of a contact: friction, then normal. One kernel for every width and number of points, for sequential
//! impulses and for soft substeps.

use super::batch::{Batch, couple};
use super::prepare::Part;
use crate::lanes::{GatherLanes, Lanes, Record, Vec3, gather, scatter};
use crate::threads::Shared;

/// Sweeps over the points of a manifold in one step over its batch.
const SWEEPS: usize = 2;

/// How overlap is pushed apart: a damped spring, solved implicitly so that it is stable at any stiffness (Catto,
/// *Soft Constraints*, GDC 2011).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Softness {
    /// Speed per overlap [1/s].
    pub(crate) bias_rate: f32,
    pub(crate) mass_scale: f32,
    pub(crate) impulse_scale: f32,
}

impl Softness {
    /// Spring of `hertz` and damping ratio `zeta`, for a substep of `h` seconds.
    pub(crate) fn new(hertz: f32, zeta: f32, h: f32) -> Self {
        let omega = 2.0 * std::f32::consts::PI * hertz;
        let a1 = 2.0 * zeta + h * omega;
        let a2 = h * omega * a1;
        let a3 = 1.0 / (1.0 + a2);
        Softness { bias_rate: omega / a1, mass_scale: a2 * a3, impulse_scale: a3 }
    }
}

/// What a pass over the rows uses.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pass {
    /// 1 / substep [1/s].
    pub(crate) inverse_h: f32,
    pub(crate) softness: Softness,
    /// The fastest push [m/s].
    pub(crate) push_speed: f32,
    /// Overlap left alone [m].
    pub(crate) slop: f32,
    /// Friction as a box instead of a cone.
    pub(crate) friction_box: bool,
}

/// The bodies' solver state: velocities, and displacements since the start of the step.
pub(crate) struct Motion<'a, 'b> {
    pub(crate) velocity: &'a Shared<'b, Record>,
    pub(crate) delta: &'a Shared<'b, Record>,
}

/// Velocities of the two bodies of each lane.
struct Pair<L> {
    va: Vec3<L>,
    wa: Vec3<L>,
    vb: Vec3<L>,
    wb: Vec3<L>,
}

impl<L: GatherLanes> Pair<L> {
    /// # Safety
    /// The bodies of the batch are this thread's, or are not written in this stage.
    #[inline(always)]
    unsafe fn load<const P: usize, const TWO: bool>(
        batch: &Batch<L, P>,
        records: &Shared<'_, Record>,
    ) -> Self {
        // SAFETY: by the contract.
        let records = unsafe { records.slice() };
        let (va, wa) = gather(records, &batch.a);
        let (vb, wb) = if TWO { gather(records, &batch.b) } else { (Vec3::zero(), Vec3::zero()) };
        Pair { va, wa, vb, wb }
    }

    /// # Safety
    /// As for [`Pair::load`].
    #[inline(always)]
    unsafe fn save<const P: usize, const TWO: bool>(
        &self,
        batch: &Batch<L, P>,
        records: &Shared<'_, Record>,
    ) {
        let write = |linear, angular, index: &[u32; 8], mask: u32| {
            let out = scatter(linear, angular);
            for lane in 0..L::N {
                if mask >> lane & 1 != 0 {
                    // SAFETY: a lane that may be written has its body alone in this stage.
                    unsafe { *records.get(index[lane] as usize) = out[lane] };
                }
            }
        };
        write(self.va, self.wa, &batch.a, batch.write_a);
        if TWO {
            write(self.vb, self.wb, &batch.b, batch.write_b);
        }
    }

    /// Applies an impulse `p` on `b` and `-p` on `a`, with angular impulses `ta` (taken from `a`) and `tb`.
    #[inline(always)]
    fn apply<const P: usize, const TWO: bool>(
        &mut self,
        batch: &Batch<L, P>,
        p: Vec3<L>,
        ta: Vec3<L>,
        tb: Vec3<L>,
    ) {
        self.va -= p * batch.inverse_mass_a;
        self.wa -= batch.inverse_inertia_a.mul(ta);
        if TWO {
            self.vb += p * batch.inverse_mass_b;
            self.wb += batch.inverse_inertia_b.mul(tb);
        }
    }
}

/// Applies the impulses of the last step.
///
/// # Safety
/// The bodies of the batch that it may write are in no other batch of the stage.
#[inline(always)]
pub(crate) unsafe fn warm_start<L: GatherLanes, const P: usize, const TWO: bool, const FRICTION: bool>(
    batch: &Batch<L, P>,
    velocity: &Shared<'_, Record>,
) {
    // SAFETY: by the contract.
    let mut v = unsafe { Pair::load::<P, TWO>(batch, velocity) };
    let (mut sum, mut ta, mut tb) = (L::zero(), Vec3::zero(), Vec3::zero());
    for point in &batch.points {
        sum += point.impulse;
        ta += point.arm_a * point.impulse;
        if TWO {
            tb += point.arm_b * point.impulse;
        }
    }
    let mut p = batch.normal * sum;
    if FRICTION {
        let f = &batch.friction;
        let q = f.tangent * f.impulse[0] + batch.normal.cross(f.tangent) * f.impulse[1];
        p += q;
        ta += f.arm_a.cross(q) + batch.normal * f.twist;
        if TWO {
            tb += f.arm_b.cross(q) + batch.normal * f.twist;
        }
    }
    v.apply::<P, TWO>(batch, p, ta, tb);
    // SAFETY: by the contract.
    unsafe { v.save::<P, TWO>(batch, velocity) };
}

/// One Gauss-Seidel step over the rows of a batch. With `BIAS` overlap is pushed apart softly; without it (relaxing)
/// what the push added to the velocities is taken out again.
///
/// # Safety
/// The bodies of the batch that it may write are in no other batch of the stage.
#[inline(always)]
pub(crate) unsafe fn solve<
    L: GatherLanes,
    const P: usize,
    const TWO: bool,
    const FRICTION: bool,
    const BIAS: bool,
>(
    batch: &mut Batch<L, P>,
    motion: &Motion<'_, '_>,
    pass: &Pass,
) {
    // SAFETY: by the contract.
    let mut v = unsafe { Pair::load::<P, TWO>(batch, motion.velocity) };
    // SAFETY: displacements are not written while rows are solved.
    let d = unsafe { Pair::load::<P, TWO>(batch, motion.delta) };
    let n = batch.normal;

    if FRICTION {
        let t2 = n.cross(batch.friction.tangent);
        let limit =
            batch.points.iter().fold(L::zero(), |s, p| s + p.impulse * p.real) * batch.friction.coefficient;
        let f = &mut batch.friction;
        let mut u = -(v.va + v.wa.cross(f.arm_a));
        let mut spin = -v.wa;
        if TWO {
            u += v.vb + v.wb.cross(f.arm_b);
            spin += v.wb;
        }
        let (u1, u2) = (u.dot(f.tangent), u.dot(t2));
        let old = f.impulse;
        let mut new =
            [old[0] - (f.mass[0] * u1 + f.mass[1] * u2), old[1] - (f.mass[1] * u1 + f.mass[2] * u2)];
        // A soft row leaves less than the load until it is relaxed, which comes after friction: what was allowed by the
        // load stays.
        let limit = if BIAS { limit } else { limit.max((old[0] * old[0] + old[1] * old[1]).sqrt()) };
        if pass.friction_box {
            new = new.map(|x| x.clamp(-limit, limit));
        } else {
            let length = (new[0] * new[0] + new[1] * new[1]).sqrt();
            let scale = L::select(length.gt(limit), limit / length, L::one());
            new = new.map(|x| x * scale);
        }
        let bound = limit * f.radius;
        let twist = (f.twist - f.twist_mass * spin.dot(n)).clamp(-bound, bound);
        let q = f.tangent * (new[0] - old[0]) + t2 * (new[1] - old[1]);
        let w = n * (twist - f.twist);
        (f.impulse, f.twist) = (new, twist);
        let ta = f.arm_a.cross(q) + w;
        let tb = if TWO { f.arm_b.cross(q) + w } else { ta };
        v.apply::<P, TWO>(batch, q, ta, tb);
    }

    let relative = |p: &Pair<L>| if TWO { n.dot(p.vb - p.va) } else { -n.dot(p.va) };
    let row = |p: &Pair<L>, point: &super::batch::PointRow<L>| {
        let a = point.arm_a.dot(p.wa);
        if TWO { point.arm_b.dot(p.wb) - a } else { -a }
    };
    let (speed, gap) = (relative(&v), relative(&d));
    let (mut sum, mut ta, mut tb) = (L::zero(), Vec3::zero(), Vec3::zero());
    let mut u = [L::zero(); P];
    let mut bias = [L::zero(); P];
    let mut mass = [L::zero(); P];
    let mut yielding = [L::zero(); P];
    let mut impulse = [L::zero(); P];
    for i in 0..P {
        let point = batch.points[i];
        let s = point.separation + gap + row(&d, &point);
        u[i] = speed + row(&v, &point);
        impulse[i] = point.impulse;
        // Apart: only what would close the gap within this substep is taken away, and rigidly so.
        let apart = s.gt(L::zero());
        let speculative = s * L::splat(pass.inverse_h);
        if BIAS {
            let deep = (s + L::splat(pass.slop)).min(L::zero());
            let push = (deep * L::splat(pass.softness.bias_rate)).max(L::splat(-pass.push_speed));
            bias[i] = L::select(apart, speculative, push);
            mass[i] = point.mass * L::select(apart, L::one(), L::splat(pass.softness.mass_scale));
            yielding[i] = L::select(apart, L::zero(), L::splat(pass.softness.impulse_scale));
        } else {
            bias[i] = speculative.max(L::zero());
            mass[i] = point.mass;
        }
    }
    // Forward and back over the points: their order must not turn a body that lies flat. It costs little, since the
    // coupling is in registers by now.
    for sweep in 0..SWEEPS {
        for j in 0..P {
            let i = if sweep % 2 == 0 { j } else { P - 1 - j };
            let point = &batch.points[i];
            let mut new = impulse[i] - mass[i] * (u[i] + bias[i]);
            if BIAS {
                new -= impulse[i] * yielding[i];
            }
            // An inert lane has an infinite separation: 0 * inf must not become an impulse.
            let new = L::select(point.mass.gt(L::zero()), new.max(L::zero()), L::zero());
            let change = new - impulse[i];
            impulse[i] = new;
            for k in 0..P {
                let a = if k == i { point.stiffness } else { batch.coupling[couple(k.min(i), k.max(i))] };
                u[k] += a * change;
            }
        }
    }
    for i in 0..P {
        let change = impulse[i] - batch.points[i].impulse;
        batch.points[i].impulse = impulse[i];
        sum += change;
        ta += batch.points[i].arm_a * change;
        if TWO {
            tb += batch.points[i].arm_b * change;
        }
    }
    v.apply::<P, TWO>(batch, n * sum, ta, tb);
    // SAFETY: by the contract.
    unsafe { v.save::<P, TWO>(batch, motion.velocity) };
}

/// Hands the impulses of each lane to `sink`: of the points, of friction (on the contact's own `b`) and of twist.
#[inline(always)]
pub(crate) fn store<L: Lanes, const P: usize>(
    batch: &Batch<L, P>,
    mut sink: impl FnMut(Part, &[f32; P], glam::Vec3, f32),
) {
    let f = &batch.friction;
    let friction = f.tangent * f.impulse[0] + batch.normal.cross(f.tangent) * f.impulse[1];
    for lane in 0..L::N {
        let part = batch.contact[lane];
        if part != Part::NONE {
            let sign = if batch.swapped >> lane & 1 != 0 { -1.0 } else { 1.0 };
            let impulses = std::array::from_fn(|i| batch.points[i].impulse.lane(lane));
            sink(part, &impulses, friction.lane(lane) * sign, f.twist.lane(lane));
        }
    }
}
