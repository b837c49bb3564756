//! Friction of a manifold that touches: two rows along the surface, one against twist, and two against
//! rolling where the material resists it.

use super::super::batch::Batch;
use super::super::body_pair::BodyPair;
use super::super::pass::Pass;
use super::super::response::{FrictionResponse, Response};
use super::{FrictionRow, RollingRow};
use crate::lanes::{GatherLanes, Lanes, Mask, Vec3, kernel};

/// During relaxation friction was bounded by the load before it, part of which pushed overlap apart and is
/// removed again. Friction follows the load that is left: down to its bound, and where it slides also up, as
/// long as the surfaces still slide.
#[inline(always)]
pub(in crate::constraint::contact) fn follow_load<
    L: GatherLanes,
    const P: usize,
    const B: usize,
    R: Response<L, P, B>,
>(
    batch: &Batch<L, P, B>,
    f: &mut FrictionRow<L, B>,
    Slid { slides, spins, extra }: Slid<L>,
    v: &mut BodyPair<L>,
    pass: &Pass<'_>,
    response: &mut R,
) {
    let load = load_of_points(batch, pass);
    let bound = load * f.coefficient;
    let [p, q] = f.impulse;
    let size = if pass.friction_box { p.abs().max(q.abs()) } else { (p * p + q * q).sqrt() };
    let mut twist_bound = bound * f.radius;
    if let Some(arm) = extra {
        twist_bound += load * arm;
    }
    let twist_size = f.twist.abs();
    let off = size.gt(bound) | twist_size.gt(twist_bound);
    let less = slides & size.lt(bound) | spins & twist_size.lt(twist_bound);
    if !(off | less).any() {
        return;
    }
    let FrictionResponse { slide_mass, twist_mass, .. } = response.friction(f);
    let Slip { along: [u1, u2], spin } = slip(batch, f, v, pass);
    let slide = share(size, bound, slides, slide_mass, (u1 * p + u2 * q) / size);
    let turn = share(twist_size, twist_bound, spins, twist_mass, spin * f.twist / twist_size);
    let acts = size.gt(L::zero());
    let new = [L::select(acts, p * slide, p), L::select(acts, q * slide, q)];
    let twist = L::select(twist_size.gt(L::zero()), f.twist * turn, f.twist);
    push(batch, f, FrictionImpulse { along: new, twist }, v, response);
}

/// By how much an impulse of friction changes to follow its bound. `speed`: that of the surfaces along the
/// impulse. If it is negative the impulse opposes the motion, and one that no more than stops it adds no
/// energy.
#[inline(always)]
fn share<L: Lanes>(size: L, bound: L, moves: L::Mask, mass: L, speed: L) -> L {
    let more = L::select(moves, (-speed * mass).max(L::zero()), L::zero());
    (size + more).min(bound) / size
}

/// Relative velocity along the surface at the centre of a manifold, and about its normal: of `b` as seen from
/// `a`.
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
    v: &BodyPair<L>,
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

/// Along the tangents [N s], and against twist [N m s].
struct FrictionImpulse<L> {
    along: [L; 2],
    twist: L,
}

/// Applies the change to new friction impulses.
#[inline(always)]
fn push<L: GatherLanes, const P: usize, const B: usize, R: Response<L, P, B>>(
    batch: &Batch<L, P, B>,
    f: &mut FrictionRow<L, B>,
    new: FrictionImpulse<L>,
    v: &mut BodyPair<L>,
    response: &mut R,
) {
    let n = batch.normal;
    let [x, y] = new.along;
    let q = f.tangent * (x - f.impulse[0]) + n.cross(f.tangent) * (y - f.impulse[1]);
    let w = n * (new.twist - f.twist);
    (f.impulse, f.twist) = (new.along, new.twist);
    let ta = f.arm_a.cross(q) + w;
    let tb = if B > 0 { f.arm_b[0].cross(q) + w } else { ta };
    response.apply(batch, v, q, ta, tb);
}

/// The load of the points that touch, by which friction is bounded [N s].
#[inline(always)]
fn load_of_points<L: GatherLanes, const P: usize, const B: usize>(
    batch: &Batch<L, P, B>,
    pass: &Pass<'_>,
) -> L {
    let real = L::splat(pass.touch_distance);
    let mut load = L::zero();
    for point in &batch.points {
        load += L::select(point.separation.le(real), point.impulse, L::zero());
    }
    load
}

/// Which friction is at its bound.
pub(in crate::constraint::contact) struct Slid<L: Lanes> {
    slides: L::Mask,
    spins: L::Mask,
    /// Lever arm of spinning friction [m], if any material of the batch has it.
    extra: Option<L>,
}

/// The rows along the surface, and against twist.
#[inline(always)]
pub(in crate::constraint::contact) fn solve_friction<
    L: GatherLanes,
    const P: usize,
    const B: usize,
    R: Response<L, P, B>,
>(
    batch: &Batch<L, P, B>,
    f: &mut FrictionRow<L, B>,
    rolling: Option<&mut RollingRow>,
    v: &mut BodyPair<L>,
    pass: &Pass<'_>,
    response: &mut R,
) -> Slid<L> {
    let load = load_of_points(batch, pass);
    let limit = load * f.coefficient;
    let mut extra = None;
    if let Some(rolling) = rolling {
        solve_rolling(batch, f.tangent, rolling, load, v, response);
        extra = Some(L::load(&rolling.spin_arm));
    }
    let FrictionResponse { mass: tangential, slide_mass, twist_mass, twist_by } = response.friction(f);
    let Slip { along: [u1, u2], spin } = slip(batch, f, v, pass);
    let old = f.impulse;
    let mut slides = L::zero().gt(L::zero());
    // Here and below spelled out: a closure for `map`, or for both, is not always inlined.
    let [m11, m12, m22] = tangential;
    let mut new = [old[0] - (m11 * u1 + m12 * u2), old[1] - (m12 * u1 + m22 * u2)];
    if pass.friction_box {
        slides = new[0].abs().gt(limit) | new[1].abs().gt(limit);
        new = [new[0].clamp(-limit, limit), new[1].clamp(-limit, limit)];
    } else {
        // A sticking lane takes the impulse that stops it. A sliding one has friction against its motion: the
        // sticking impulse, cut to the cone, would point elsewhere unless the mass is the same in all
        // directions.
        let sticks = (new[0] * new[0] + new[1] * new[1]).le(limit * limit);
        if (!sticks).any() {
            let slid = [old[0] - slide_mass * u1, old[1] - slide_mass * u2];
            let length = (slid[0] * slid[0] + slid[1] * slid[1]).sqrt();
            let scale = L::select(length.gt(limit), limit / length, L::one());
            slides = length.gt(limit);
            new = [L::select(sticks, new[0], slid[0] * scale), L::select(sticks, new[1], slid[1] * scale)];
        }
    }
    let mut bound = limit * f.radius;
    if let Some(arm) = extra {
        bound += load * arm;
    }
    let change = [new[0] - old[0], new[1] - old[1]];
    // Against the twist that remains: friction at the centre turns a long body about one end, and both rows
    // against the same twist would drive it the other way.
    let turns = spin + twist_by[0] * change[0] + twist_by[1] * change[1];
    let stops = f.twist - twist_mass * turns;
    let twist = stops.clamp(-bound, bound);
    let spins = stops.abs().gt(bound);
    push(batch, f, FrictionImpulse { along: new, twist }, v, response);
    Slid { slides, spins, extra }
}

kernel! {
    /// The rows against rolling: they stop rotation about axes in the surface as far as the load allows, as
    /// [`solve_friction`] stops slip. A function of its own: few scenes need its code.
    fn solve_rolling<'a, L: GatherLanes, const P: usize, const B: usize; R: Response<L, P, B>>(
        batch: &'a Batch<L, P, B>,
        tangent: Vec3<L>,
        row: &'a mut RollingRow,
        load: L,
        v: &'a mut BodyPair<L>,
        response: &'a mut R,
    ) {
        let (t1, t2) = (tangent, batch.normal.cross(tangent));
        let turn = if B > 0 { v.wb - v.wa } else { -v.wa };
        let (w1, w2) = (turn.dot(t1), turn.dot(t2));
        let limit = load * L::load(&row.arm);
        let [m11, m12, m22] = [L::load(&row.mass[0]), L::load(&row.mass[1]), L::load(&row.mass[2])];
        let old = [L::load(&row.impulse[0]), L::load(&row.impulse[1])];
        let held = [old[0] - (m11 * w1 + m12 * w2), old[1] - (m12 * w1 + m22 * w2)];
        let holds = (held[0] * held[0] + held[1] * held[1]).le(limit * limit);
        let mass = L::load(&row.least_mass);
        let rolled = [old[0] - mass * w1, old[1] - mass * w2];
        let length = (rolled[0] * rolled[0] + rolled[1] * rolled[1]).sqrt();
        let scale = L::select(length.gt(limit), limit / length, L::one());
        let x = L::select(holds, held[0], rolled[0] * scale);
        let new = [x, L::select(holds, held[1], rolled[1] * scale)];
        let change = t1 * (new[0] - old[0]) + t2 * (new[1] - old[1]);
        new[0].store(&mut row.impulse[0]);
        new[1].store(&mut row.impulse[1]);
        response.apply(batch, v, Vec3::zero(), change, change);
    }
}
