//! Contacts in, batches out: the contacts are arranged by importance, colour and size, and fill the lanes.

use super::batch::{Batch, GONE, unlocked};
use super::columns::{Columns, SpringColumns, gather as gather_columns, sym3, vec3};
use super::friction::{FrictionRow, FrictionToFill, RollingRow, carry};
use super::input::PrepareInput;
use super::rows::{Rows, Surface, Views, with_batch};
use super::soft::{SoftRow, bodies::mark, fill_soft};
use crate::config::tuning::LOCKED_YIELD;
use crate::constraint::articulation::slots::TreeSlots;
use crate::constraint::schedule::arrange::{PrepareScratch, Prepared, arrange};
use crate::constraint::schedule::part::Part;
use crate::lanes::{GatherLanes, Lanes, Mat3, Sym3, Vec3, gather, kernel, with_best};
use crate::memory::{Allowances, Category};
use crate::threads::{Shared, Workers, per_block};

/// Batches a block.
const BLOCK: usize = per_block(8, 1);

/// Makes all batches of the step, as far as memory allows.
pub(crate) fn prepare(
    workers: &Workers<'_>,
    input: &PrepareInput<'_>,
    rows: &mut Rows,
    scratch: &mut PrepareScratch,
    allowances: &mut Allowances,
) -> Prepared {
    rows.set_friction(input.friction);
    let marked = mark_soft(input, rows, allowances);
    let mut prepared = arrange(workers, input, rows, scratch, allowances);
    prepared.shed += u32::from(!marked);
    let (all, Rows { surfaces, rolling, .. }) = (rows.schedule.len(), &mut *rows);
    surfaces.clear();
    rolling.clear();
    // Without memory for them they are left out.
    if input.beside.surfaces
        && allowances.within(Category::Rows, |allowance| allowance.fit(surfaces, all)) == all
    {
        surfaces.resize(all, [[0.0; 8]; 2]);
    }
    if input.beside.rolling
        && allowances.within(Category::Rows, |allowance| allowance.fit(rolling, all)) == all
    {
        rolling.resize(all, RollingRow::default());
    }
    rows.soft.rows.clear();
    if input.beside.soft
        && allowances.within(Category::Rows, |allowance| allowance.fit(&mut rows.soft.rows, all)) == all
    {
        rows.soft.rows.resize(all, SoftRow::default());
    }
    let (mut surfaces, marks) = (std::mem::take(&mut rows.surfaces), std::mem::take(&mut rows.soft.marks));
    let marked = PrepareInput { marks: &marks, ..*input };
    fill_all(workers, &marked, &rows.views(), &mut surfaces, scratch);
    (rows.surfaces, rows.soft.marks) = (surfaces, marks);
    prepared
}

/// Marks the contacts and joints that hold each body, for soft lanes; returns whether there was memory for
/// that.
fn mark_soft(input: &PrepareInput<'_>, rows: &mut Rows, allowances: &mut Allowances) -> bool {
    let marks = &mut rows.soft.marks;
    marks.clear();
    if input.beside.soft {
        allowances.within(Category::Rows, |allowance| mark(marks, input, allowance));
    }
    !input.beside.soft || marks.len() == input.bodies.dynamic()
}

/// [`Beside`] of the batch at a place of the schedule.
struct BesideBatch<'a> {
    place: u32,
    surface: Option<&'a mut Surface>,
    rolling: Option<&'a mut RollingRow>,
    soft: Option<&'a mut SoftRow>,
}

/// Fills the batches of the schedule.
#[allow(clippy::needless_range_loop, reason = "the index is also that of the ranges")]
fn fill_all(
    workers: &Workers<'_>,
    input: &PrepareInput<'_>,
    views: &Views<'_>,
    surfaces: &mut [Surface],
    scratch: &PrepareScratch,
) {
    let surfaces = Shared::new(surfaces);
    let (schedule, stages) = (views.schedule, views.stages);
    workers.run(schedule.len().div_ceil(BLOCK), &|block| {
        let mut stage = stages.partition_point(|s| s.end as usize <= block * BLOCK);
        for place in block * BLOCK..((block + 1) * BLOCK).min(schedule.len()) {
            while stages[stage].end as usize <= place {
                stage += 1;
            }
            let group = stages[stage].group;
            let (first, count) = scratch.ranges[place];
            let contacts = &scratch.sorted[first as usize..(first + count) as usize];
            let of = schedule[place];
            let tree_slots = of.in_tree.then_some(input.tree_slots);
            // SAFETY: as below.
            let (surface, rolling) = unsafe { (surfaces.find(place), views.rolling.find(place)) };
            // SAFETY: as below.
            let soft = unsafe { views.soft.find(place) };
            let beside = BesideBatch { place: place as u32, surface, rolling, soft };
            // SAFETY: each batch stands in the schedule once, so no other block fills it.
            unsafe {
                with_best!(Wide => with_batch!(Wide: views, group, of, |batch, friction| {
                    fill(batch, friction.to_fill(of, group), contacts, tree_slots, beside, input)
                }));
            }
        }
    });
}

/// Bodies of a batch in lanes, while its rows are made of them.
struct Geometry<'a, L, const P: usize> {
    columns: &'a Columns<P>,
    /// Rotation from the contacts' frames to the world, and a sign that is negative in lanes with swapped
    /// bodies.
    turn: Mat3<L>,
    sign: L,
    normal: Vec3<L>,
    inverse_mass: [L; 2],
    inverse_inertia: [Sym3<L>; 2],
}

/// Points of a batch in lanes, while its rows are made of them.
struct Points<L, const P: usize> {
    /// From the bodies to each point.
    arms_a: [Vec3<L>; P],
    arms_b: [Vec3<L>; P],
    /// One where there is a point, zero elsewhere.
    present: [L; P],
}

impl<L: Lanes, const P: usize> Points<L, P> {
    /// One over the number of points.
    #[inline(always)]
    fn share(&self) -> L {
        let mut count = L::zero();
        for &present in &self.present {
            count += present;
        }
        L::one() / count.max(L::one())
    }

    /// Mean distance of the points from a place, each of which counts for `share` [m].
    #[inline(always)]
    fn radius(&self, from: Vec3<L>, share: L) -> L {
        let mut radii = L::zero();
        for (&arm, &present) in self.arms_a.iter().zip(&self.present) {
            radii += (arm - from).length() * present;
        }
        radii * share
    }

    /// The mean of arms, each of which counts for `share`.
    #[inline(always)]
    fn mean(&self, arms: &[Vec3<L>; P], share: L) -> Vec3<L> {
        let mut sum = Vec3::zero();
        for (&arm, &present) in arms.iter().zip(&self.present) {
            sum += arm * present;
        }
        sum * share
    }
}

impl<L: Lanes, const P: usize> Geometry<'_, L, P> {
    /// By how much a unit impulse along `x` changes the velocity along `y`; `all`: the same if no axis is
    /// locked [1/kg].
    #[inline(always)]
    fn linear(&self, x: Vec3<L>, y: Vec3<L>, all: L) -> L {
        let locks = self.columns.locks;
        if locks == [0; 2] {
            return all;
        }
        let [ma, mb] = self.inverse_mass;
        unlocked(locks[0], x).dot(y) * ma + unlocked(locks[1], x).dot(y) * mb
    }
}

kernel! {
    /// Fills the lanes of a batch; lanes without a contact get rows without mass.
    fn fill<'a, L: GatherLanes, const P: usize, const B: usize>(
        batch: &'a mut Batch<L, P, B>,
        friction: FrictionToFill<'a, L, B>,
        parts: &'a [Part],
        tree_slots: Option<&'a TreeSlots>,
        beside: BesideBatch<'a>,
        input: &'a PrepareInput<'a>,
    ) {
        let touching = matches!(friction, FrictionToFill::Touching(_));
        let mut springs = input.beside.soft.then(SpringColumns::default);
        let columns = gather_columns::<L, P>(parts, touching, tree_slots, springs.as_mut(), input);
        (batch.a, batch.contact) = (columns.a, columns.contact);
        (batch.surface, batch.rolling, batch.soft) = (u32::MAX, u32::MAX, u32::MAX);
        [batch.write_a, batch.write_b] = columns.write;
        (batch.swapped, batch.heard, batch.locks) = (columns.swapped, columns.heard, columns.locks);
        let [x, y, z, w] = &columns.rotation;
        let v = Vec3::new(L::load(x), L::load(y), L::load(z));
        let turn = crate::lanes::Quat { v, w: L::load(w) }.to_matrix();
        let sign = L::load(&columns.sign);
        let n = turn.mul(vec3(&columns.normal)) * sign;
        let (ma, ia) = (L::load(&columns.inverse_mass[0]), sym3(&columns.inverse_inertia[0]));
        (batch.normal, batch.peak) = (n, L::zero());
        (batch.rest, batch.reach) = (L::load(&columns.rest), L::load(&columns.reach));
        (batch.inverse_mass_a, batch.inverse_inertia_a) = (ma, ia);
        let (mb, ib) = if B > 0 {
            let b = &mut batch.b[0];
            b.index = columns.b;
            b.inverse_mass = L::load(&columns.inverse_mass[1]);
            b.inverse_inertia = sym3(&columns.inverse_inertia[1]);
            (b.inverse_mass, b.inverse_inertia)
        } else {
            (L::zero(), Sym3::default())
        };
        let geometry = Geometry {
            columns: &columns,
            turn,
            sign,
            normal: n,
            inverse_mass: [ma, mb],
            inverse_inertia: [ia, ib],
        };
        let points = fill_points(batch, &geometry);
        if let (Some(soft), Some(springs)) = (beside.soft, springs.filter(|springs| springs.softens)) {
            let along = geometry.linear(n, n, ma + mb);
            fill_soft(soft, batch, &springs, along, input.lengths.now());
            batch.soft = beside.place;
        }
        if let FrictionToFill::None = friction {
            return;
        }
        let share = points.share();
        let (fa, fb) = (points.mean(&points.arms_a, share), points.mean(&points.arms_b, share));
        if let Some(surface) = beside.surface {
            let (past, (t1, t2)) = (vec3::<L>(&columns.past), n.tangents());
            past.dot(t1).store(&mut surface[0]);
            past.dot(t2).store(&mut surface[1]);
            batch.surface = beside.place;
        }
        match friction {
            FrictionToFill::None => {}
            FrictionToFill::Impact(f) => {
                let sliding = L::load(&columns.coefficient[1]);
                (f.along, f.to_b, f.coefficient) = (n.dot(fa), [fb - fa; B], sliding);
            }
            FrictionToFill::Touching(f) => {
                let fb = set_arms(f, batch, [fa, fb], input);
                f.radius = points.radius(fa, share);
                fill_friction(f, &geometry, fb);
                if let Some(rolling) = beside.rolling.filter(|_| columns.rolls) {
                    fill_rolling(rolling, &geometry);
                    batch.rolling = beside.place;
                }
                choose_coefficient(batch, f, &geometry, fb, input);
            }
        }
    }
}

/// Sets the arms of friction: to ground that turns, in the middle of the first substep. Returns that of body
/// `b`.
#[inline(always)]
fn set_arms<L: GatherLanes, const P: usize, const B: usize>(
    f: &mut FrictionRow<L, B>,
    batch: &Batch<L, P, B>,
    [arm_a, arm_b]: [Vec3<L>; 2],
    input: &PrepareInput<'_>,
) -> Vec3<L> {
    (f.arm_a, f.arm_b) = (arm_a, [arm_b; B]);
    let ground = u32::from(batch.write_a & !batch.write_b);
    if B > 0 && ground != 0 {
        let (_, turn) = gather::<L>(|i| input.bodies.velocity[i], &batch.b[0].index);
        carry(f, ground, &turn, 0.5 * input.lengths.now());
    }
    f.arm_b.first().copied().unwrap_or(arm_b)
}

/// Fills the normal rows, and the couplings of their points. Returns the points.
#[inline(always)]
fn fill_points<L: GatherLanes, const P: usize, const B: usize>(
    batch: &mut Batch<L, P, B>,
    geometry: &Geometry<'_, L, P>,
) -> Points<L, P> {
    let (columns, turn, n) = (geometry.columns, geometry.turn, geometry.normal);
    let ([ma, mb], [ia, ib]) = (geometry.inverse_mass, geometry.inverse_inertia);
    let (origin, to_b) = (vec3::<L>(&columns.origin), vec3::<L>(&columns.to_b));
    let along = geometry.linear(n, n, ma + mb);
    let (mut turned_a, mut turned_b) = ([Vec3::<L>::zero(); P], [Vec3::<L>::zero(); P]);
    let mut normal_arms_b = [Vec3::<L>::zero(); P];
    let zero = [Vec3::zero(); P];
    let mut points = Points { arms_a: zero, arms_b: zero, present: [L::zero(); P] };
    for i in 0..P {
        points.present[i] = L::load(&columns.present[i]);
        let ra = turn.mul(vec3(&columns.position[i])) + origin;
        let rb = ra + to_b;
        (points.arms_a[i], points.arms_b[i]) = (ra, rb);
        let (arm_a, arm_b) = (ra.cross(n), rb.cross(n));
        (turned_a[i], turned_b[i]) = (ia.mul(arm_a), ib.mul(arm_b));
        let k = along + arm_a.dot(turned_a[i]) + arm_b.dot(turned_b[i]);
        let possible = points.present[i].gt(L::zero()) & k.gt((ma + mb) * L::splat(GONE));
        let s = L::load(&columns.separation[i]);
        let point = &mut batch.points[i];
        (point.arm_a, point.arm_b) = (arm_a, [arm_b; B]);
        normal_arms_b[i] = arm_b;
        (point.separation, point.now) = (s, s);
        point.mass = L::select(possible, L::one() / k, L::zero());
        point.stiffness = k;
        point.lasting = L::load(&columns.lasting[i]);
        point.impulse = L::select(possible, L::load(&columns.impulse[i]), L::zero());
        for (k, other_b) in normal_arms_b.iter().enumerate().take(i) {
            let both = batch.points[k].arm_a.dot(turned_a[i]) + other_b.dot(turned_b[i]);
            batch.couple(k, i, along + both);
        }
    }
    points
}

/// Fills the rows along the surface and against twist; the arms are set already. `fb`: the arm of body `b`,
/// which batches with static bodies do not store.
#[inline(always)]
fn fill_friction<L: GatherLanes, const P: usize, const B: usize>(
    f: &mut FrictionRow<L, B>,
    geometry: &Geometry<'_, L, P>,
    fb: Vec3<L>,
) {
    let (columns, n, fa) = (geometry.columns, geometry.normal, f.arm_a);
    let ([ma, mb], [ia, ib]) = (geometry.inverse_mass, geometry.inverse_inertia);
    let (t1, t2) = n.tangents();
    let (a1, a2, b1, b2) = (fa.cross(t1), fa.cross(t2), fb.cross(t1), fb.cross(t2));
    let (ia1, ib1, ia2, ib2) = (ia.mul(a1), ib.mul(b1), ia.mul(a2), ib.mul(b2));
    let mut k11 = geometry.linear(t1, t1, ma + mb) + a1.dot(ia1) + b1.dot(ib1);
    let k12 = geometry.linear(t1, t2, L::zero()) + a1.dot(ia2) + b1.dot(ib2);
    let mut k22 = geometry.linear(t2, t2, ma + mb) + a2.dot(ia2) + b2.dot(ib2);
    if columns.locks != [0; 2] {
        // The matrix stays invertible even where a direction along the surface is locked.
        let tiny = (k11 + k22) * L::splat(LOCKED_YIELD);
        (k11, k22) = (k11 + tiny, k22 + tiny);
    }
    let det = k11 * k22 - k12 * k12;
    let possible = det.gt(L::zero());
    let over = L::select(possible, L::one() / det, L::zero());
    let kt = n.dot(ia.mul(n)) + n.dot(ib.mul(n));
    f.tangent = t1;
    f.mass = [k22 * over, -(k12 * over), k11 * over];
    let (half, apart) = ((f.mass[0] + f.mass[2]) * L::splat(0.5), (f.mass[0] - f.mass[2]) * L::splat(0.5));
    f.slide_mass = (half - (apart * apart + f.mass[1] * f.mass[1]).sqrt()).max(L::zero());
    f.twist_mass = L::select(kt.gt(L::zero()), L::one() / kt, L::zero());
    f.twist_by = [n.dot(ia1) + n.dot(ib1), n.dot(ia2) + n.dot(ib2)];
    let old = geometry.turn.mul(vec3(&columns.friction)) * geometry.sign;
    let kept = |x: L| L::select(possible, x, L::zero());
    f.impulse = [kept(old.dot(t1)), kept(old.dot(t2))];
    f.twist = L::load(&columns.twist);
}

kernel! {
    /// Fills the rows against rolling, about the tangents of friction.
    fn fill_rolling<'a, L: GatherLanes, const P: usize>(
        row: &'a mut RollingRow,
        geometry: &'a Geometry<'a, L, P>,
    ) {
        let (columns, n, [ia, ib]) = (geometry.columns, geometry.normal, geometry.inverse_inertia);
        let (t1, t2) = n.tangents();
        let (x, y) = (ia.mul(t1) + ib.mul(t1), ia.mul(t2) + ib.mul(t2));
        let (k12, sum) = (t1.dot(y), t1.dot(x) + t2.dot(y));
        // The matrix stays invertible even where rotation about one axis is locked.
        let tiny = sum * L::splat(LOCKED_YIELD);
        let (k11, k22) = (t1.dot(x) + tiny, t2.dot(y) + tiny);
        let det = k11 * k22 - k12 * k12;
        let over = L::select(det.gt(L::zero()), L::one() / det, L::zero());
        let mass = [k22 * over, -(k12 * over), k11 * over];
        let (half, apart) = ((mass[0] + mass[2]) * L::splat(0.5), (mass[0] - mass[2]) * L::splat(0.5));
        let least = (half - (apart * apart + mass[1] * mass[1]).sqrt()).max(L::zero());
        mass[0].store(&mut row.mass[0]);
        mass[1].store(&mut row.mass[1]);
        mass[2].store(&mut row.mass[2]);
        least.store(&mut row.least_mass);
        [row.arm, row.spin_arm] = columns.roll_arms;
        let (old, turns) = (vec3::<L>(&columns.rolling), det.gt(L::zero()));
        L::select(turns, old.dot(t1), L::zero()).store(&mut row.impulse[0]);
        L::select(turns, old.dot(t2), L::zero()).store(&mut row.impulse[1]);
    }
}

/// Chooses static friction below a slip speed, dynamic friction above.
#[inline(always)]
fn choose_coefficient<L: GatherLanes, const P: usize, const B: usize>(
    batch: &Batch<L, P, B>,
    f: &mut FrictionRow<L, B>,
    geometry: &Geometry<'_, L, P>,
    fb: Vec3<L>,
    input: &PrepareInput<'_>,
) {
    let (n, fa, columns) = (geometry.normal, f.arm_a, geometry.columns);
    let (sticking, sliding) = (L::load(&columns.coefficient[0]), L::load(&columns.coefficient[1]));
    let velocity = &input.bodies.velocity;
    let record = |i: usize| velocity[i];
    let (va, wa) = gather::<L>(record, &batch.a);
    let (vb, wb) = if B > 0 { gather::<L>(record, &batch.b[0].index) } else { (Vec3::zero(), Vec3::zero()) };
    let mut slip = vb + wb.cross(fb) - (va + wa.cross(fa));
    if batch.surface != u32::MAX {
        slip += vec3::<L>(&columns.past);
    }
    let slip = slip - n * slip.dot(n);
    let slowest = input.measures.static_slip_speed;
    let sticks = slip.length_squared().lt(L::splat(slowest * slowest));
    f.coefficient = L::select(sticks, sticking, sliding);
}
