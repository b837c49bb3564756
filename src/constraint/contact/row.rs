//! The rows of a contact: friction, then normal. One kernel for every width and number of points, for
//! sequential impulses and for soft substeps.

use super::batch::{Batch, PointRow};
use super::friction::impact::potential_load;
use super::friction::rows::{follow_load, solve_friction};
use super::friction::{self, FrictionRow, RollingRow};
use super::soft::solve_soft;
use crate::constraint::schedule::part::Part;
use crate::lanes::{GatherLanes, Lanes, Mask, Record, Vec3};
use crate::threads::Shared;

pub(crate) use super::body_pair::{BodyPair, Motion};
pub(crate) use super::pass::Pass;
pub(crate) use super::response::{Free, FrictionResponse, Response};
pub(crate) use super::softness::Softness;

/// Applies the impulses of the last step.
///
/// # Safety
/// The bodies of the batch that it may write are in no other batch of the stage.
#[inline(always)]
pub(crate) unsafe fn warm_start<L: GatherLanes, const P: usize, const B: usize, const FRICTION: bool>(
    batch: &Batch<L, P, B>,
    friction: Option<&mut FrictionRow<L, B>>,
    rolling: Option<&mut RollingRow>,
    velocity: &Shared<'_, Record>,
) {
    // Most potential contacts carry no impulse.
    if !FRICTION && !batch.points.iter().fold(L::zero(), |s, p| s + p.impulse).gt(L::zero()).any() {
        return;
    }
    // SAFETY: by the contract.
    let mut v = unsafe { BodyPair::load(batch, velocity) };
    let (mut sum, mut ta, mut tb) = (L::zero(), Vec3::zero(), Vec3::zero());
    for point in &batch.points {
        sum += point.impulse;
        ta += point.arm_a * point.impulse;
        if B > 0 {
            tb += point.arm_b[0] * point.impulse;
        }
    }
    let mut p = batch.normal * sum;
    if FRICTION && let Some(f) = friction {
        let q = f.tangent * f.impulse[0] + batch.normal.cross(f.tangent) * f.impulse[1];
        p += q;
        ta += f.arm_a.cross(q) + batch.normal * f.twist;
        if B > 0 {
            tb += f.arm_b[0].cross(q) + batch.normal * f.twist;
        }
        if let Some(rolling) = rolling {
            let roll = rolling.on_b(batch.normal, f.tangent);
            ta += roll;
            tb += roll;
        }
    }
    v.apply(batch, p, ta, tb);
    // SAFETY: by the contract.
    unsafe { v.save(batch, velocity) };
}

/// Clears the lanes of some bodies, as if they had no contact. Their impulses of the substep before are no
/// warm start any more, so their effect is added to the velocities before any row acted.
///
/// # Safety
/// No other thread works on the bodies of the batch.
pub(crate) unsafe fn disable_lanes<L: GatherLanes, const P: usize, const B: usize>(
    batch: &mut Batch<L, P, B>,
    mut friction: Option<&mut FrictionRow<L, B>>,
    rolling: Option<&mut RollingRow>,
    motion: &Motion<'_, '_>,
    of: &dyn Fn(u32) -> bool,
) {
    let other = |lane: usize| batch.b.first().map_or(batch.a[lane], |b| b.index[lane]);
    let lanes: u32 = (0..L::N).filter(|&i| of(batch.a[i]) || of(other(i))).map(|i| 1 << i).sum();
    if lanes == 0 {
        return;
    }
    let take = |from: &mut L| {
        let mut taken = L::zero();
        for lane in (0..L::N).filter(|lane| lanes >> lane & 1 != 0) {
            taken.set_lane(lane, from.lane(lane));
            from.set_lane(lane, 0.0);
        }
        taken
    };
    let (mut p, mut ta, mut tb) = (Vec3::zero(), Vec3::zero(), Vec3::zero());
    for point in &mut batch.points {
        take(&mut point.mass);
        let impulse = take(&mut point.impulse);
        p += batch.normal * impulse;
        ta += point.arm_a * impulse;
        if B > 0 {
            tb += point.arm_b[0] * impulse;
        }
    }
    if let Some(f) = &mut friction {
        let [x, y] = [0, 1].map(|i| take(&mut f.impulse[i]));
        let twist = batch.normal * take(&mut f.twist);
        let q = f.tangent * x + batch.normal.cross(f.tangent) * y;
        p += q;
        ta += f.arm_a.cross(q) + twist;
        if B > 0 {
            tb += f.arm_b[0].cross(q) + twist;
        }
        if let Some(rolling) = rolling {
            let impulses = &mut rolling.impulse;
            let [x, y] = [0, 1].map(|i| {
                let mut impulse = L::load(&impulses[i]);
                let taken = take(&mut impulse);
                impulse.store(&mut impulses[i]);
                taken
            });
            let roll = f.tangent * x + batch.normal.cross(f.tangent) * y;
            ta += roll;
            tb += roll;
        }
    }
    // SAFETY: by the contract.
    unsafe {
        let mut v = BodyPair::load(batch, motion.base);
        v.apply(batch, p, ta, tb);
        v.save(batch, motion.base);
    }
}

/// Turns the arms of friction to ground that turns on by a substep of `h` seconds.
///
/// # Safety
/// No other thread works on the batch or writes velocities.
pub(crate) unsafe fn carry<L: GatherLanes, const P: usize, const B: usize>(
    batch: &Batch<L, P, B>,
    row: &mut FrictionRow<L, B>,
    velocity: &Shared<'_, Record>,
    h: f32,
) {
    let ground = u32::from(batch.write_a & !batch.write_b);
    if B > 0 && ground != 0 {
        // SAFETY: by the contract.
        let v = unsafe { BodyPair::<L>::load(batch, velocity) };
        friction::carry(row, ground, &v.wb, h);
    }
}

/// One Gauss-Seidel step over the rows of a batch. Returns whether potential points push.
///
/// # Safety
/// The bodies of the batch that it may write are in no other batch of the stage.
#[inline(always)]
pub(crate) unsafe fn solve<L: GatherLanes, const P: usize, const B: usize, const FRICTION: bool>(
    batch: &mut Batch<L, P, B>,
    friction: Option<&mut FrictionRow<L, B>>,
    motion: &Motion<'_, '_>,
    pass: &Pass<'_>,
) -> bool {
    // SAFETY: by the contract.
    let mut v = unsafe { BodyPair::load(batch, motion.velocity) };
    if pass.relax {
        // SAFETY: displacements are not written while rows are solved.
        unsafe { follow::<L, P, B>(batch, motion) };
    }
    // SAFETY: by the contract: each batch has a row of its own.
    let rolling = if FRICTION { unsafe { pass.rolling.find(batch.rolling as usize) } } else { None };
    // SAFETY: as above.
    if let Some(soft) = unsafe { pass.soft.find(batch.soft as usize) } {
        // SAFETY: by the contract.
        return unsafe { solve_soft::<L, P, B, FRICTION>(batch, friction, rolling, soft, motion, pass) };
    }
    if !sweep::<L, P, B, FRICTION, _>(batch, friction, rolling, &mut v, pass, &mut Free) {
        return false;
    }
    // SAFETY: by the contract.
    unsafe { v.save(batch, motion.velocity) };
    pass.relax && potential_load(batch, pass.touch_distance).0.gt(L::zero()).any()
}

/// Updates separations after displacements. Bodies are moved before the rows relax, and not again before they
/// are solved in the next substep.
///
/// # Safety
/// No thread writes displacements.
#[inline(always)]
pub(crate) unsafe fn follow<L: GatherLanes, const P: usize, const B: usize>(
    batch: &mut Batch<L, P, B>,
    motion: &Motion<'_, '_>,
) {
    // SAFETY: by the contract.
    let d = unsafe { BodyPair::load(batch, motion.delta) };
    let gap = relative::<L, B>(batch.normal, &d);
    for point in &mut batch.points {
        point.now = point.separation + gap + row::<L, B>(&d, point);
    }
}

/// Pushes overlap apart softly or, to relax, removes the velocities which that added: the same code with
/// other numbers, since in a small scene each kernel runs once a pass, and fetching its code is a third of
/// its time.
///
/// Returns whether anything may have changed.
#[inline(always)]
pub(crate) fn sweep<
    L: GatherLanes,
    const P: usize,
    const B: usize,
    const FRICTION: bool,
    R: Response<L, P, B>,
>(
    batch: &mut Batch<L, P, B>,
    friction: Option<&mut FrictionRow<L, B>>,
    rolling: Option<&mut RollingRow>,
    v: &mut BodyPair<L>,
    pass: &Pass<'_>,
    response: &mut R,
) -> bool {
    let mut slid = None;
    if FRICTION && let Some(f) = friction {
        let which = solve_friction::<L, P, B, R>(batch, f, rolling, v, pass, response);
        slid = Some((f, which));
    }
    let mut rows = NormalRows::new(batch, v, pass, response);
    // Nothing closes and nothing bears load: the rest would change nothing. Most potential contacts are like
    // that.
    if !FRICTION && !rows.act(batch) {
        return false;
    }
    rows.solve(batch, response);
    let ImpulseChange { sum, moment_a, moment_b } = rows.store::<B, FRICTION>(batch);
    response.apply(batch, v, batch.normal * sum, moment_a, moment_b);
    if FRICTION
        && pass.relax
        && let Some((f, which)) = slid
    {
        follow_load(batch, f, which, v, pass, response);
    }
    true
}

/// Whether nothing closes and nothing bears load, however heavy the bodies are: a sweep would change nothing.
#[inline(always)]
pub(crate) fn is_idle<L: GatherLanes, const P: usize, const B: usize>(
    batch: &Batch<L, P, B>,
    v: &BodyPair<L>,
    pass: &Pass<'_>,
) -> bool {
    !NormalRows::new(batch, v, pass, &Free).act(batch)
}

/// By how much a pass changed the impulses along the normal: all of them [N s], and their moments about each
/// body's centre of mass.
pub(super) struct ImpulseChange<L> {
    pub(super) sum: L,
    pub(super) moment_a: Vec3<L>,
    pub(super) moment_b: Vec3<L>,
}

/// The normal rows of a batch while they are solved.
pub(super) struct NormalRows<L, const P: usize> {
    /// Normal velocities [m/s], and the bias added to them.
    pub(super) u: [L; P],
    bias: [L; P],
    /// Effective masses [kg]; zero for rows that wait.
    mass: [L; P],
    /// Share of an impulse that its spring gives up.
    yielding: [L; P],
    pub(super) impulse: [L; P],
}

impl<L: GatherLanes, const P: usize> NormalRows<L, P> {
    #[inline(always)]
    #[allow(clippy::needless_range_loop, reason = "several arrays by point")]
    pub(super) fn new<const B: usize, R: Response<L, P, B>>(
        batch: &Batch<L, P, B>,
        v: &BodyPair<L>,
        pass: &Pass<'_>,
        response: &R,
    ) -> Self {
        // To relax, rows are rigid and overlap is not pushed.
        let (rate, push_speed, yields) = if pass.relax {
            (L::zero(), L::zero(), L::zero())
        } else {
            let Softness { bias_rate, impulse_scale, .. } = pass.softness;
            (L::splat(bias_rate), L::splat(-pass.push_speed), L::splat(impulse_scale))
        };
        let mass_scale = L::splat(if pass.relax { 1.0 } else { pass.softness.mass_scale });
        let ease = L::splat(pass.softness.ease);
        let pushes = L::splat(if pass.relax { 0.0 } else { 1.0 }).gt(L::zero());
        let (rest, reach) = (batch.rest, batch.reach);
        let speed = relative::<L, B>(batch.normal, v);
        let zero = [L::zero(); P];
        let mut rows = NormalRows { u: zero, bias: zero, mass: zero, yielding: zero, impulse: zero };
        let mut touches = L::zero().gt(L::zero());
        for i in 0..P {
            let point = batch.points[i];
            let s = point.now;
            rows.u[i] = speed + row::<L, B>(v, &point);
            rows.impulse[i] = point.impulse;
            let sag = ease * point.lasting * point.stiffness;
            // Apart: only the velocity that would close the gap within this substep is removed, and rigidly
            // so. Springs end where they would pull.
            let apart = s.ge(rest + sag.min(reach));
            let speculative = (s * L::splat(pass.inverse_h)).max(L::zero());
            rows.bias[i] = L::select(apart, speculative, ((s - rest) * rate).max(push_speed));
            rows.mass[i] = response.mass(batch, i) * L::select(apart, L::one(), mass_scale);
            rows.yielding[i] = L::select(apart | point.mass.le(L::zero()), L::zero(), yields);
            touches = touches | (point.mass.gt(L::zero()) & (s.le(L::zero()) | point.impulse.gt(L::zero())));
        }
        // During relaxation a manifold that is apart and did not have to push waits for the next substep: its
        // gaps at the end of this one do not predict the overlap of the next, and a step that ends here must
        // not push for the next. If any point touches, the whole manifold comes to rest.
        for i in 0..P {
            rows.mass[i] = L::select(touches | pushes, rows.mass[i], L::zero());
        }
        rows
    }

    /// Whether a row closes or bears load.
    #[inline(always)]
    fn act<const B: usize>(&self, batch: &Batch<L, P, B>) -> bool {
        let acts = |i: usize| {
            let loaded = self.impulse[i].gt(L::zero()) | batch.points[i].lasting.gt(L::zero());
            self.mass[i].gt(L::zero()) & (loaded | (self.u[i] + self.bias[i]).lt(L::zero()))
        };
        (1..P).fold(acts(0), |any, i| any | acts(i)).any()
    }

    /// First one equal impulse for all active points, then one point after another.
    #[inline(always)]
    #[allow(clippy::needless_range_loop, reason = "several arrays by point")]
    fn solve<const B: usize, R: Response<L, P, B>>(&mut self, batch: &Batch<L, P, B>, response: &R) {
        if P > 1 {
            let (push, on) = self.level(batch, response);
            for i in 0..P {
                let change = push * on[i];
                self.impulse[i] += change;
                self.accelerate(batch, response, i, change);
            }
        }
        for i in 0..P {
            let new = self.solved(batch, i);
            let change = new - self.impulse[i];
            self.impulse[i] = new;
            self.accelerate(batch, response, i, change);
        }
    }

    /// The impulse with which a row leaves no velocity error, except by its softness.
    #[inline(always)]
    pub(super) fn solved<const B: usize>(&self, batch: &Batch<L, P, B>, i: usize) -> L {
        let mut new = self.impulse[i] - self.mass[i] * (self.u[i] + self.bias[i]);
        new -= (self.impulse[i] - batch.points[i].lasting) * self.yielding[i];
        // An inert lane has an infinite separation; the maximum of NaN (0 * inf) and zero is zero.
        new.max(L::zero())
    }

    /// Updates the normal velocities after a change of the impulse at point `i`.
    #[inline(always)]
    #[allow(clippy::needless_range_loop, reason = "several arrays by point")]
    pub(super) fn accelerate<const B: usize, R: Response<L, P, B>>(
        &mut self,
        batch: &Batch<L, P, B>,
        response: &R,
        i: usize,
        change: L,
    ) {
        for k in 0..P {
            self.u[k] += response.stiffness(batch, i, k) * change;
        }
    }

    /// Writes the impulses to the batch. Returns the sums of their changes and of the moments of these on
    /// both bodies.
    #[inline(always)]
    #[allow(clippy::needless_range_loop, reason = "several arrays by point")]
    pub(super) fn store<const B: usize, const FRICTION: bool>(
        &self,
        batch: &mut Batch<L, P, B>,
    ) -> ImpulseChange<L> {
        let (mut sum, mut ta, mut tb) = (L::zero(), Vec3::zero(), Vec3::zero());
        for i in 0..P {
            let change = self.impulse[i] - batch.points[i].impulse;
            batch.points[i].impulse = self.impulse[i];
            if !FRICTION {
                batch.peak = batch.peak.max(self.impulse[i]);
            }
            sum += change;
            ta += batch.points[i].arm_a * change;
            if B > 0 {
                tb += batch.points[i].arm_b[0] * change;
            }
        }
        ImpulseChange { sum, moment_a: ta, moment_b: tb }
    }

    /// The one impulse that, applied at every point that bears load or closes, leaves them no velocity error
    /// on average; and which points these are (1 or 0).
    ///
    /// Points are swept one after another, so the first would take the load of all, the body would turn, and
    /// the others would turn it back, but never quite: a tower that stands straight would start to lean.
    /// After this step a body that lies flat and evenly loaded leaves nothing for the sweep.
    #[inline(always)]
    pub(super) fn level<const B: usize, R: Response<L, P, B>>(
        &self,
        batch: &Batch<L, P, B>,
        response: &R,
    ) -> (L, [L; P]) {
        let NormalRows { u, bias, mass, yielding, impulse } = self;
        let mut on = [L::zero(); P];
        let (mut error, mut sum, mut least) = (L::zero(), L::zero(), L::splat(f32::INFINITY));
        for i in 0..P {
            let rest = u[i] + bias[i];
            let acts = mass[i].gt(L::zero()) & (impulse[i].gt(L::zero()) | rest.lt(L::zero()));
            on[i] = L::select(acts, L::one(), L::zero());
            // A row that yields acts as a less stiff one: (k + soft) impulse = -error.
            let rigid = response.stiffness(batch, i, i);
            let soft = rigid * yielding[i] / (L::one() - yielding[i]);
            let own = rigid + soft;
            let missing = rest + soft * (impulse[i] - batch.points[i].lasting);
            // A select and not a product: an inert lane has an infinite bias.
            error += L::select(acts, missing, L::zero());
            least = L::select(acts, least.min(impulse[i]), least);
            sum += on[i] * own;
            for k in 0..i {
                let both = on[i] * on[k] * response.stiffness(batch, i, k);
                sum += both + both;
            }
        }
        let push = (-error / sum).max(-least);
        (L::select(sum.gt(L::zero()), push, L::zero()), on)
    }
}

/// Speed of `b` away from `a` along the normal; [`row`] adds the contribution of their spins at a point.
#[inline(always)]
pub(crate) fn relative<L: Lanes, const B: usize>(n: Vec3<L>, p: &BodyPair<L>) -> L {
    if B > 0 { n.dot(p.vb - p.va) } else { -n.dot(p.va) }
}

#[inline(always)]
pub(crate) fn row<L: Lanes, const B: usize>(p: &BodyPair<L>, point: &PointRow<L, B>) -> L {
    let a = point.arm_a.dot(p.wa);
    if B > 0 { point.arm_b[0].dot(p.wb) - a } else { -a }
}

/// Passes the impulses of each lane to `sink`: those of the points, the largest of the step, friction (on the
/// contact's own `b`) and twist.
#[inline(always)]
pub(crate) fn store<L: Lanes, const P: usize, const B: usize>(
    batch: &Batch<L, P, B>,
    friction: Option<&FrictionRow<L, B>>,
    mut sink: impl FnMut(Part, &[f32; P], f32, glam::Vec3, f32),
) {
    let (friction, twist) = friction.map_or((Vec3::zero(), L::zero()), |f| {
        (f.tangent * f.impulse[0] + batch.normal.cross(f.tangent) * f.impulse[1], f.twist)
    });
    for lane in 0..L::N {
        let part = batch.contact[lane];
        if part != Part::NONE {
            let sign = if batch.swapped >> lane & 1 != 0 { -1.0 } else { 1.0 };
            let impulses = std::array::from_fn(|i| batch.points[i].impulse.lane(lane));
            sink(part, &impulses, batch.peak.lane(lane), friction.lane(lane) * sign, twist.lane(lane));
        }
    }
}
