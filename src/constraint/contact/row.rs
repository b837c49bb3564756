//! The rows of a contact: friction, then normal. One kernel for every width and number of points, for sequential
//! impulses and for soft substeps.

use super::batch::{Batch, PointRow};
use super::friction::FrictionRow;
use super::impact_friction::potential_load;
use super::rows::Surface;
use crate::constraint::schedule::arrange::Part;
use crate::lanes::{GatherLanes, Lanes, Mask, Record, Vec3, gather, scatter};
use crate::threads::Shared;

/// How overlap is pushed apart: a damped spring, solved implicitly so that it is stable at any stiffness (Catto,
/// *Soft Constraints*, GDC 2011).
///
/// Such a spring gives way under load: a stack becomes a column of springs, which sinks and, if it is high enough,
/// buckles. So a lasting force acts beside the spring, at each point its share ([`PointRow::lasting`],
/// `Contact::lasting_force`): the rest position of the spring is where this force bears the load alone. What differs from it,
/// which is what resists leaning, acts on the springs. They act at any depth, and over a small gap too, or nothing would take a
/// lean back that is smaller than it; without a lasting force only what is deeper than the slop is pushed apart, and
/// rows are rigid above it: a new load meets no spring that it could press through something thin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Softness {
    /// Speed per overlap [1/s].
    pub(crate) bias_rate: f32,
    pub(crate) mass_scale: f32,
    pub(crate) impulse_scale: f32,
    /// By how much an impulse in a substep compresses the spring of a row with an effective mass of 1 kg [m/(N s)].
    pub(crate) ease: f32,
}

impl Softness {
    /// Gives way to nothing and pushes nothing apart: a spring whose damping has no end.
    pub(crate) const RIGID: Softness =
        Softness { bias_rate: 0.0, mass_scale: 1.0, impulse_scale: 0.0, ease: 0.0 };

    /// A spring of `hertz` and damping ratio `zeta`, or none that moves in a substep of `h` seconds that is too long for it
    /// with so many passes over the rows: see [`Softness::stiffest`], without the margin.
    pub(crate) fn for_substep(hertz: f32, zeta: f32, passes: u32, h: f32) -> Self {
        let spring = Self::new(hertz, zeta, h);
        if hertz > 1.5 * Self::stiffest(passes, h) { spring.locked() } else { spring }
    }

    /// One that moves nothing, and ends where this one does.
    pub(crate) fn locked(self) -> Self {
        Softness { ease: self.ease, ..Self::RIGID }
    }

    /// The stiffest spring [Hz] that substeps of `h` seconds with so many passes over the rows may have.
    ///
    /// Gauss-Seidel knows of a tall stack as a whole only after many substeps. For its slowest sway, the share `r` of
    /// the velocity error that a pass removes goes to zero; the push removes the share `b` of the overlap in a
    /// substep, and the share `y` of the impulse yields. With `p` passes the sway obeys
    /// s³ + (p r + y) s² + (p + b) r s + b r = 0, which by Routh decays for every r if and only if y > b / (p + b), and
    /// with `b` and `y` as below that is (2 pi hertz h)² < p. Two thirds of that frequency leave a margin.
    pub(crate) fn stiffest(passes: u32, h: f32) -> f32 {
        0.106 * (passes as f32).sqrt() / h
    }

    /// Spring of `hertz` and damping ratio `zeta`, for a substep of `h` seconds.
    pub(crate) fn new(hertz: f32, zeta: f32, h: f32) -> Self {
        let omega = 2.0 * std::f32::consts::PI * hertz;
        let a1 = 2.0 * zeta + h * omega;
        let a2 = h * omega * a1;
        let a3 = 1.0 / (1.0 + a2);
        let ease = 1.0 / (h * omega * omega);
        Softness { bias_rate: omega / a1, mass_scale: a2 * a3, impulse_scale: a3, ease }
    }
}

/// What a pass over the rows uses.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pass<'a> {
    /// 1 / substep [1/s].
    pub(crate) inverse_h: f32,
    pub(crate) softness: Softness,
    /// The fastest push [m/s].
    pub(crate) push_speed: f32,
    /// Friction of an impact that changes the slip by no more than this shifts no loads worth speaking of [m/s].
    pub(crate) shift: f32,
    /// A point whose separation was no more than this touches: its impulse bounds friction [m].
    pub(crate) real: f32,
    /// Friction as a box instead of a cone.
    pub(crate) friction_box: bool,
    /// What pushing overlap apart added to the velocities is taken out again.
    pub(crate) relax: bool,
    /// See [`Rows::surfaces`](crate::constraint::Rows::surfaces).
    pub(crate) surfaces: &'a [Surface],
}

/// The bodies' solver state: velocities, displacements since the start of the step, and velocities of the substep before
/// any row acted.
pub(crate) struct Motion<'a, 'b> {
    pub(crate) velocity: &'a Shared<'b, Record>,
    pub(crate) delta: &'a Shared<'b, Record>,
    pub(crate) base: &'a Shared<'b, Record>,
}

/// Velocities of the two bodies of each lane.
pub(crate) struct Pair<L> {
    pub(crate) va: Vec3<L>,
    pub(crate) wa: Vec3<L>,
    pub(crate) vb: Vec3<L>,
    pub(crate) wb: Vec3<L>,
}

impl<L: GatherLanes> Pair<L> {
    /// # Safety
    /// The bodies of the batch are this thread's, or are not written in this stage.
    #[inline(always)]
    pub(crate) unsafe fn load<const P: usize, const B: usize>(
        batch: &Batch<L, P, B>,
        records: &Shared<'_, Record>,
    ) -> Self {
        // SAFETY: by the contract.
        unsafe { Self::load_bodies(&batch.a, if B > 0 { Some(&batch.b[0].index) } else { None }, records) }
    }

    /// The same of bodies in lists.
    ///
    /// # Safety
    /// As for [`Pair::load`].
    #[inline(always)]
    pub(crate) unsafe fn load_bodies(
        a: &[u32; 8],
        b: Option<&[u32; 8]>,
        records: &Shared<'_, Record>,
    ) -> Self {
        // SAFETY: by the contract. One by one: a slice of all would include those that other threads write.
        let record = |i| unsafe { records.read(i) };
        let (va, wa) = gather(record, a);
        let (vb, wb) = match b {
            Some(b) => gather(record, b),
            None => (Vec3::zero(), Vec3::zero()),
        };
        Pair { va, wa, vb, wb }
    }

    /// # Safety
    /// As for [`Pair::load`].
    #[inline(always)]
    pub(crate) unsafe fn save<const P: usize, const B: usize>(
        &self,
        batch: &Batch<L, P, B>,
        records: &Shared<'_, Record>,
    ) {
        let b = if B > 0 { Some((&batch.b[0].index, u32::from(batch.write_b))) } else { None };
        // SAFETY: by the contract.
        unsafe { self.save_bodies((&batch.a, u32::from(batch.write_a)), b, records) };
    }

    /// The same of bodies in lists, with a bit for each that may be written.
    ///
    /// # Safety
    /// As for [`Pair::load`].
    #[inline(always)]
    pub(crate) unsafe fn save_bodies(
        &self,
        (a, write_a): (&[u32; 8], u32),
        b: Option<(&[u32; 8], u32)>,
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
        write(self.va, self.wa, a, write_a);
        if let Some((b, write_b)) = b {
            write(self.vb, self.wb, b, write_b);
        }
    }

    /// Applies an impulse `p` on `b` and `-p` on `a`, with angular impulses `ta` (taken from `a`) and `tb`.
    #[inline(always)]
    pub(crate) fn apply<const P: usize, const B: usize>(
        &mut self,
        batch: &Batch<L, P, B>,
        p: Vec3<L>,
        ta: Vec3<L>,
        tb: Vec3<L>,
    ) {
        let [on_a, on_b] = batch.moving(p);
        self.va -= on_a * batch.inverse_mass_a;
        self.wa -= batch.inverse_inertia_a.mul(ta);
        if B > 0 {
            let b = &batch.b[0];
            self.vb += on_b * b.inverse_mass;
            self.wb += b.inverse_inertia.mul(tb);
        }
    }
}

/// Applies the impulses of the last step.
///
/// # Safety
/// The bodies of the batch that it may write are in no other batch of the stage.
#[inline(always)]
pub(crate) unsafe fn warm_start<L: GatherLanes, const P: usize, const B: usize, const FRICTION: bool>(
    batch: &Batch<L, P, B>,
    friction: Option<&mut FrictionRow<L, B>>,
    velocity: &Shared<'_, Record>,
) {
    // So it is with most that may meet.
    if !FRICTION && !batch.points.iter().fold(L::zero(), |s, p| s + p.impulse).gt(L::zero()).any() {
        return;
    }
    // SAFETY: by the contract.
    let mut v = unsafe { Pair::load(batch, velocity) };
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
    }
    v.apply(batch, p, ta, tb);
    // SAFETY: by the contract.
    unsafe { v.save(batch, velocity) };
}

/// Empties the lanes of some bodies, as if they had no contact. What they did in the substep before is no warm start any more.
///
/// # Safety
/// No other thread works on the bodies of the batch.
pub(crate) unsafe fn disable_lanes<L: GatherLanes, const P: usize, const B: usize>(
    batch: &mut Batch<L, P, B>,
    mut friction: Option<&mut FrictionRow<L, B>>,
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
    }
    // SAFETY: by the contract.
    unsafe {
        let mut v = Pair::load(batch, motion.base);
        v.apply(batch, p, ta, tb);
        v.save(batch, motion.base);
    }
}

/// By how much impulses of a batch change the velocities of its bodies.
pub(crate) trait Response<L: GatherLanes, const P: usize, const B: usize> {
    /// Effective mass of a point's row [kg]; zero without a point.
    #[inline(always)]
    fn mass(&self, batch: &Batch<L, P, B>, i: usize) -> L {
        batch.points[i].mass
    }
    /// By how much a unit impulse at one point changes the normal velocity of another [1/kg].
    #[inline(always)]
    fn stiffness(&self, batch: &Batch<L, P, B>, i: usize, k: usize) -> L {
        if i == k { batch.points[i].stiffness } else { batch.coupling(i.min(k), i.max(k)) }
    }
    #[inline(always)]
    fn friction(&self, f: &FrictionRow<L, B>) -> FrictionResponse<L> {
        let FrictionRow { mass, slide_mass, twist_mass, twist_by, .. } = *f;
        FrictionResponse { mass, slide_mass, twist_mass, twist_by }
    }
    /// Applies an impulse `p` on `b` and `-p` on `a`, with angular impulses `ta` (taken from `a`) and `tb`.
    #[inline(always)]
    fn apply(&mut self, batch: &Batch<L, P, B>, v: &mut Pair<L>, p: Vec3<L>, ta: Vec3<L>, tb: Vec3<L>) {
        v.apply(batch, p, ta, tb);
    }
}

/// How bodies answer friction; see the fields of [`FrictionRow`].
#[derive(Clone, Copy)]
pub(crate) struct FrictionResponse<L> {
    pub(crate) mass: [L; 3],
    pub(crate) slide_mass: L,
    pub(crate) twist_mass: L,
    pub(crate) twist_by: [L; 2],
}

/// Two bodies that nothing else holds.
pub(crate) struct Free;

impl<L: GatherLanes, const P: usize, const B: usize> Response<L, P, B> for Free {}

/// One Gauss-Seidel step over the rows of a batch. Says whether potential points push.
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
    let mut v = unsafe { Pair::load(batch, motion.velocity) };
    if pass.relax {
        // SAFETY: displacements are not written while rows are solved.
        unsafe { follow::<L, P, B>(batch, motion) };
    }
    if !sweep::<L, P, B, FRICTION, _>(batch, friction, &mut v, pass, &mut Free) {
        return false;
    }
    // SAFETY: by the contract.
    unsafe { v.save(batch, motion.velocity) };
    pass.relax && potential_load(batch, pass.real).0.gt(L::zero()).any()
}

/// Separations after displacements. Bodies are moved before the rows relax, and not again before they are solved in the
/// next substep.
///
/// # Safety
/// No thread writes displacements.
#[inline(always)]
pub(crate) unsafe fn follow<L: GatherLanes, const P: usize, const B: usize>(
    batch: &mut Batch<L, P, B>,
    motion: &Motion<'_, '_>,
) {
    // SAFETY: by the contract.
    let d = unsafe { Pair::load(batch, motion.delta) };
    let gap = relative::<L, B>(batch.normal, &d);
    for point in &mut batch.points {
        point.now = point.separation + gap + row::<L, B>(&d, point);
    }
}

/// Overlap is pushed apart softly, or, to relax, what the push added to the velocities is taken out again: the same code
/// with other numbers, since in a small scene each kernel runs once a pass, and what it takes to fetch it is a third of
/// its time.
///
/// Says whether anything could change.
#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "several arrays by point")]
pub(crate) fn sweep<
    L: GatherLanes,
    const P: usize,
    const B: usize,
    const FRICTION: bool,
    R: Response<L, P, B>,
>(
    batch: &mut Batch<L, P, B>,
    friction: Option<&mut FrictionRow<L, B>>,
    v: &mut Pair<L>,
    pass: &Pass<'_>,
    response: &mut R,
) -> bool {
    // Relaxing, rows are rigid and nothing is pushed.
    let (rate, push_speed, yields) = if pass.relax {
        (L::zero(), L::zero(), L::zero())
    } else {
        let Softness { bias_rate, impulse_scale, .. } = pass.softness;
        (L::splat(bias_rate), L::splat(-pass.push_speed), L::splat(impulse_scale))
    };
    let mass_scale = L::splat(if pass.relax { 1.0 } else { pass.softness.mass_scale });
    let ease = L::splat(pass.softness.ease);
    let pushes = L::splat(if pass.relax { 0.0 } else { 1.0 }).gt(L::zero());
    let n = batch.normal;
    let (rest, reach) = (batch.rest, batch.reach);

    let mut slid = None;
    if FRICTION && let Some(f) = friction {
        let which = rub::<L, P, B, R>(batch, f, v, pass, response);
        slid = Some((f, which));
    }
    let speed = relative::<L, B>(n, v);
    let (mut sum, mut ta, mut tb) = (L::zero(), Vec3::zero(), Vec3::zero());
    let mut u = [L::zero(); P];
    let mut bias = [L::zero(); P];
    let mut mass = [L::zero(); P];
    let mut yielding = [L::zero(); P];
    let mut impulse = [L::zero(); P];
    let mut touches = L::zero().gt(L::zero());
    for i in 0..P {
        let point = batch.points[i];
        let s = point.now;
        u[i] = speed + row::<L, B>(v, &point);
        impulse[i] = point.impulse;
        // Apart: only what would close the gap within this substep is taken away, and rigidly so.
        // Springs end where they would pull.
        let apart = s.ge(rest + (ease * point.lasting * point.stiffness).min(reach));
        let speculative = (s * L::splat(pass.inverse_h)).max(L::zero());
        bias[i] = L::select(apart, speculative, ((s - rest) * rate).max(push_speed));
        mass[i] = response.mass(batch, i) * L::select(apart, L::one(), mass_scale);
        yielding[i] = L::select(apart | point.mass.le(L::zero()), L::zero(), yields);
        touches = touches | (point.mass.gt(L::zero()) & (s.le(L::zero()) | point.impulse.gt(L::zero())));
    }
    // Relaxing, a manifold that is apart, and did not have to push, waits for the next substep: its gaps at the end of
    // this one say nothing of what would be crossed in it, and a step that ends here must not push for the next. One that
    // touches with any point is no guess, and comes to rest as a whole.
    let mass = mass.map(|m| L::select(touches | pushes, m, L::zero()));
    if !FRICTION {
        // Nothing closes and nothing bears load: what follows would change nothing. So it is with most that may meet.
        let acts = |i: usize| {
            let loaded = impulse[i].gt(L::zero()) | batch.points[i].lasting.gt(L::zero());
            mass[i].gt(L::zero()) & (loaded | (u[i] + bias[i]).lt(L::zero()))
        };
        if !(1..P).fold(acts(0), |any, i| any | acts(i)).any() {
            return false;
        }
    }
    if P > 1 {
        let (push, on) = level(batch, response, &u, &bias, &impulse, (&mass, &yielding));
        for i in 0..P {
            let change = push * on[i];
            impulse[i] += change;
            for k in 0..P {
                u[k] += response.stiffness(batch, i, k) * change;
            }
        }
    }
    for i in 0..P {
        let mut new = impulse[i] - mass[i] * (u[i] + bias[i]);
        new -= (impulse[i] - batch.points[i].lasting) * yielding[i];
        // An inert lane has an infinite separation; of 0 * inf, which is no number, the larger one is zero.
        let new = new.max(L::zero());
        let change = new - impulse[i];
        impulse[i] = new;
        for k in 0..P {
            u[k] += response.stiffness(batch, i, k) * change;
        }
    }
    for i in 0..P {
        let change = impulse[i] - batch.points[i].impulse;
        batch.points[i].impulse = impulse[i];
        if !FRICTION {
            batch.peak = batch.peak.max(impulse[i]);
        }
        sum += change;
        ta += batch.points[i].arm_a * change;
        if B > 0 {
            tb += batch.points[i].arm_b[0] * change;
        }
    }
    response.apply(batch, v, n * sum, ta, tb);
    if FRICTION
        && pass.relax
        && let Some((f, which)) = slid
    {
        follow_load(batch, f, which, v, pass, response);
    }
    true
}

/// While rows relax, friction was bounded by the load before them, of which a part had pushed overlap apart and is taken out
/// again. It follows the load that is left: down to its bound, and what slides also up, as far as something still slides.
#[inline(always)]
fn follow_load<L: GatherLanes, const P: usize, const B: usize, R: Response<L, P, B>>(
    batch: &Batch<L, P, B>,
    f: &mut FrictionRow<L, B>,
    Slid { slides, spins }: Slid<L>,
    v: &mut Pair<L>,
    pass: &Pass<'_>,
    response: &mut R,
) {
    let bound = friction_limit(batch, f, pass);
    let [p, q] = f.impulse;
    let size = if pass.friction_box { p.abs().max(q.abs()) } else { (p * p + q * q).sqrt() };
    let (twist_bound, twist_size) = (bound * f.radius, f.twist.abs());
    let off = size.gt(bound) | twist_size.gt(twist_bound);
    let less = slides & size.lt(bound) | spins & twist_size.lt(twist_bound);
    if !(off | less).any() {
        return;
    }
    let FrictionResponse { slide_mass, twist_mass, .. } = response.friction(f);
    let Slip { along: [u1, u2], spin } = slip(batch, f, v, pass);
    // By `speed` its impulse goes along with a motion. Against one, no more than stops it gains no energy.
    let share = |size: L, bound: L, moves: L::Mask, mass: L, speed: L| {
        let more = L::select(moves, (-speed * mass).max(L::zero()), L::zero());
        (size + more).min(bound) / size
    };
    let some = |size: L| size.gt(L::zero());
    let slide = share(size, bound, slides, slide_mass, (u1 * p + u2 * q) / size);
    let turn = share(twist_size, twist_bound, spins, twist_mass, spin * f.twist / twist_size);
    let new = [p, q].map(|x| L::select(some(size), x * slide, x));
    let twist = L::select(some(twist_size), f.twist * turn, f.twist);
    push(batch, f, (new, twist), v, response);
}

/// Motion along a surface, at the centre of a manifold, and about its normal: of `b` as seen from `a`.
struct Slip<L> {
    /// Along the tangents [m/s].
    along: [L; 2],
    /// [rad/s]
    spin: L,
}

#[inline(always)]
fn slip<L: GatherLanes, const P: usize, const B: usize>(
    batch: &Batch<L, P, B>,
    f: &FrictionRow<L, B>,
    v: &Pair<L>,
    pass: &Pass<'_>,
) -> Slip<L> {
    let n = batch.normal;
    let mut u = -(v.va + v.wa.cross(f.arm_a));
    let mut spin = -v.wa;
    if B > 0 {
        u += v.vb + v.wb.cross(f.arm_b[0]);
        spin += v.wb;
    }
    let (mut u1, mut u2) = (u.dot(f.tangent), u.dot(n.cross(f.tangent)));
    if let Some(surface) = pass.surfaces.get(batch.surface as usize) {
        u1 += L::load(&surface[0]);
        u2 += L::load(&surface[1]);
    }
    Slip { along: [u1, u2], spin: spin.dot(n) }
}

/// Changes the impulses of friction to those along the tangents and against twist.
#[inline(always)]
fn push<L: GatherLanes, const P: usize, const B: usize, R: Response<L, P, B>>(
    batch: &Batch<L, P, B>,
    f: &mut FrictionRow<L, B>,
    (new, twist): ([L; 2], L),
    v: &mut Pair<L>,
    response: &mut R,
) {
    let n = batch.normal;
    let q = f.tangent * (new[0] - f.impulse[0]) + n.cross(f.tangent) * (new[1] - f.impulse[1]);
    let w = n * (twist - f.twist);
    (f.impulse, f.twist) = (new, twist);
    let ta = f.arm_a.cross(q) + w;
    let tb = if B > 0 { f.arm_b[0].cross(q) + w } else { ta };
    response.apply(batch, v, q, ta, tb);
}

/// The greatest friction that the points bear [N s].
#[inline(always)]
fn friction_limit<L: GatherLanes, const P: usize, const B: usize>(
    batch: &Batch<L, P, B>,
    f: &FrictionRow<L, B>,
    pass: &Pass<'_>,
) -> L {
    let real = L::splat(pass.real);
    let load = |p: &PointRow<L, B>| L::select(p.separation.le(real), p.impulse, L::zero());
    batch.points.iter().fold(L::zero(), |s, p| s + load(p)) * f.coefficient
}

/// Which friction is at its bound.
struct Slid<L: Lanes> {
    slides: L::Mask,
    spins: L::Mask,
}

/// The rows along the surface, and against twist.
#[inline(always)]
fn rub<L: GatherLanes, const P: usize, const B: usize, R: Response<L, P, B>>(
    batch: &Batch<L, P, B>,
    f: &mut FrictionRow<L, B>,
    v: &mut Pair<L>,
    pass: &Pass<'_>,
    response: &mut R,
) -> Slid<L> {
    let limit = friction_limit(batch, f, pass);
    let FrictionResponse { mass: tangential, slide_mass, twist_mass, twist_by } = response.friction(f);
    let Slip { along: [u1, u2], spin } = slip(batch, f, v, pass);
    let old = f.impulse;
    let mut slides = L::zero().gt(L::zero());
    let mut new = [0, 1].map(|i| old[i] - (tangential[i] * u1 + tangential[i + 1] * u2));
    if pass.friction_box {
        slides = new[0].abs().gt(limit) | new[1].abs().gt(limit);
        new = new.map(|x| x.clamp(-limit, limit));
    } else {
        // What sticks needs the impulse that stops it. What slides has friction against its motion, and that
        // impulse, cut to the cone, would point elsewhere unless the mass is the same in all directions.
        let sticks = (new[0] * new[0] + new[1] * new[1]).le(limit * limit);
        if (!sticks).any() {
            let slid = [old[0] - slide_mass * u1, old[1] - slide_mass * u2];
            let length = (slid[0] * slid[0] + slid[1] * slid[1]).sqrt();
            let scale = L::select(length.gt(limit), limit / length, L::one());
            slides = length.gt(limit);
            new = std::array::from_fn(|i| L::select(sticks, new[i], slid[i] * scale));
        }
    }
    let bound = limit * f.radius;
    let change = [new[0] - old[0], new[1] - old[1]];
    // Of the twist that is left then: friction at the centre turns a long body about an end of it, and both rows against the
    // same twist would drive it the other way.
    let turns = spin + twist_by[0] * change[0] + twist_by[1] * change[1];
    let stops = f.twist - twist_mass * turns;
    let twist = stops.clamp(-bound, bound);
    let spins = stops.abs().gt(bound);
    push(batch, f, (new, twist), v, response);
    Slid { slides, spins }
}

/// Speed of `b` away from `a` along the normal, and what their spins add to it at a point.
#[inline(always)]
pub(crate) fn relative<L: Lanes, const B: usize>(n: Vec3<L>, p: &Pair<L>) -> L {
    if B > 0 { n.dot(p.vb - p.va) } else { -n.dot(p.va) }
}

#[inline(always)]
pub(crate) fn row<L: Lanes, const B: usize>(p: &Pair<L>, point: &PointRow<L, B>) -> L {
    let a = point.arm_a.dot(p.wa);
    if B > 0 { point.arm_b[0].dot(p.wb) - a } else { -a }
}

/// The one impulse that, given to every point that bears load or is closing, leaves them no velocity error on average;
/// and which points these are (1 or 0).
///
/// Points are swept one after the other, so the first would take what is everybody's, the body would turn, and the
/// others would turn it back, never quite: a tower that stands straight would learn to lean. After this step a body
/// that lies flat and evenly loaded has nothing left for the sweep.
#[inline(always)]
fn level<L: GatherLanes, const P: usize, const B: usize, R: Response<L, P, B>>(
    batch: &Batch<L, P, B>,
    response: &R,
    u: &[L; P],
    bias: &[L; P],
    impulse: &[L; P],
    (mass, yielding): (&[L; P], &[L; P]),
) -> (L, [L; P]) {
    let mut on = [L::zero(); P];
    let (mut error, mut sum, mut least) = (L::zero(), L::zero(), L::splat(f32::INFINITY));
    for i in 0..P {
        let rest = u[i] + bias[i];
        let acts = mass[i].gt(L::zero()) & (impulse[i].gt(L::zero()) | rest.lt(L::zero()));
        on[i] = L::select(acts, L::one(), L::zero());
        // A row that yields is one that is less stiff: (k + soft) impulse = -error.
        let rigid = response.stiffness(batch, i, i);
        let soft = rigid * yielding[i] / (L::one() - yielding[i]);
        let own = rigid + soft;
        let missing = rest + soft * (impulse[i] - batch.points[i].lasting);
        // Not a product: an inert lane has an infinite bias.
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

/// Hands the impulses of each lane to `sink`: of the points, the largest of the step, of friction (on the contact's own `b`) and of twist.
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
