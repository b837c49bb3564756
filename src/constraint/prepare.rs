//! Contacts -> batches: arranged by importance, colour and size, the contacts fill the lanes.

use super::arrange::{Part, PrepareScratch, Prepared, arrange};
use super::batch::{Batch, lock_bits, unlocked};
use super::friction::Rub;
use super::rows::{Rows, Surface, Views, with_batch};
use super::seats::{Seat, Seats};
use super::step_lengths::StepLengths;
use super::tweak::{Tweak, tweak_of};
use crate::body::{Bodies, Pose};
use crate::broad_phase::Pair;
use crate::config::Order;
use crate::lanes::{GatherLanes, Lanes, Record, Sym3, Vec3, gather, ones};
use crate::memory::{Category, Rooms};
use crate::narrow_phase::{Contact, MAX_POINTS, Point, Scale};
use crate::shape::{Collider, EVENTS, Hot};
use crate::threads::{Crew, Shared, per_block};

/// What preparing reads.
pub(crate) struct PrepareInput<'a> {
    pub(crate) bodies: &'a Bodies,
    pub(crate) colliders: &'a [Collider],
    pub(crate) hot: &'a [Hot],
    pub(crate) poses: &'a [Pose],
    pub(crate) contacts: &'a [Contact],
    pub(crate) pairs: &'a [Pair],
    /// Predicted displacement of each body that can move.
    pub(crate) motion: &'a [Record],
    /// World inverse inertia of each dynamic body.
    pub(crate) inverse_inertia: &'a [Sym3<f32>],
    /// A separation up to this is real [m].
    pub(crate) real: f32,
    /// Without continuous collision nothing further than this is looked for [m].
    pub(crate) near: f32,
    /// Bytes that contacts further than that, and their rows, may take.
    pub(crate) ahead: usize,
    /// What becomes of the impulses of the last step.
    pub(crate) lengths: StepLengths,
    /// Slip speed below which friction is static [m/s].
    pub(crate) stick: f32,
    /// [m]
    pub(crate) slop: f32,
    /// In which order groups of rows are solved.
    pub(crate) order: Order,
    /// Bodies whose contacts with what is static go along with their trees of joints.
    pub(crate) seats: &'a Seats,
    /// What hooks said of each contact; empty if there are none.
    pub(crate) tweaks: &'a [Tweak],
    /// Friction at every point: each point then is a manifold of its own.
    pub(crate) per_point: bool,
    /// Whether anything may have friction.
    pub(crate) friction: bool,
    /// What contacts weigh, should there not be enough memory for all.
    pub(crate) scale: Scale<'a>,
}

/// Share of a mobility below which nothing is left of it but rounding, of bodies whose axes are locked.
pub(super) const GONE: f32 = 1e-6;
/// Share of the mobility along the surface that is added to it where axes are locked: more than rounding, and so little
/// that friction takes no more passes.
const YIELDS: f32 = 1e-4;
/// Overlap that is left alone is at most this share of what the thinner of two shapes measures from its middle to its surface:
/// the slop of a world made for boxes of a metre would swallow a coin, and half of a wall of 1 mm.
const THIN: f32 = 0.05;

/// Batches a block.
const BLOCK: usize = per_block(8, 1);

/// Builds all batches of the step, as far as there is room for them.
pub(crate) fn prepare(
    crew: &Crew<'_>,
    input: &PrepareInput<'_>,
    rows: &mut Rows,
    scratch: &mut PrepareScratch,
    rooms: &mut Rooms,
) -> Prepared {
    rows.set_rubs(input.friction);
    let prepared = arrange(input, rows, scratch, rooms);
    rows.surfaces.clear();
    if input.tweaks.iter().any(|tweak| tweak.surface != glam::Vec3::ZERO)
        && rooms.within(Category::Rows, |room| room.fit(&mut rows.surfaces, rows.schedule.len()))
            == rows.schedule.len()
    {
        rows.surfaces.resize(rows.schedule.len(), [[0.0; 8]; 2]);
    }
    let mut surfaces = std::mem::take(&mut rows.surfaces);
    fill_all(crew, input, &rows.views(), &mut surfaces, scratch);
    rows.surfaces = surfaces;
    prepared
}

/// Fills the batches of the schedule.
#[allow(clippy::needless_range_loop, reason = "the index is also that of the ranges")]
fn fill_all(
    crew: &Crew<'_>,
    input: &PrepareInput<'_>,
    views: &Views<'_>,
    surfaces: &mut [Surface],
    scratch: &PrepareScratch,
) {
    let (moving, surfaces) = (!surfaces.is_empty(), Shared::new(surfaces));
    let (schedule, stages) = (views.schedule, views.stages);
    crew.run(schedule.len().div_ceil(BLOCK), &|block| {
        let mut stage = stages.partition_point(|s| s.end as usize <= block * BLOCK);
        for place in block * BLOCK..((block + 1) * BLOCK).min(schedule.len()) {
            while stages[stage].end as usize <= place {
                stage += 1;
            }
            let group = stages[stage].group;
            let (first, count) = scratch.ranges[place];
            let contacts = &scratch.sorted[first as usize..(first + count) as usize];
            let of = schedule[place];
            let seats = of.seated.then_some(input.seats);
            // SAFETY: as below.
            let surface = moving.then(|| (place, unsafe { surfaces.get(place) }));
            // SAFETY: each batch stands in the schedule once, so no other block fills it.
            unsafe {
                with_batch!(views, group, of, |batch, friction| {
                    fill(batch, friction.to_fill(of, group), contacts, (seats, surface), input)
                });
            }
        }
    });
}

/// What a batch needs of its contacts, transposed: a column of eight lanes for each number. Inert lanes are zero.
struct Columns<const P: usize> {
    /// Bodies, contacts and bits of the lanes: see [`Batch`].
    a: [u32; 8],
    b: [u32; 8],
    contact: [Part; 8],
    write: [u8; 2],
    swapped: u8,
    heard: u8,
    rotation: [[f32; 8]; 4],
    normal: [[f32; 8]; 3],
    /// From the batch's body a to the origin of the contact's shape a, at the time of the contact.
    origin: [[f32; 8]; 3],
    /// From the batch's body b to its body a, at the time of the contact.
    to_b: [[f32; 8]; 3],
    sign: [f32; 8],
    inverse_mass: [[f32; 8]; 2],
    locks: [u32; 2],
    inverse_inertia: [[[f32; 8]; 6]; 2],
    position: [[[f32; 8]; 3]; P],
    separation: [[f32; 8]; P],
    impulse: [[f32; 8]; P],
    lasting: [[f32; 8]; P],
    rest: [f32; 8],
    reach: [f32; 8],
    present: [[f32; 8]; P],
    friction: [[f32; 8]; 3],
    twist: [f32; 8],
    /// Static and dynamic.
    coefficient: [[f32; 8]; 2],
}

fn put3(columns: &mut [[f32; 8]; 3], lane: usize, v: glam::Vec3) {
    for (column, x) in columns.iter_mut().zip(v.to_array()) {
        column[lane] = x;
    }
}

fn vec3<L: Lanes>(columns: &[[f32; 8]; 3]) -> Vec3<L> {
    Vec3::new(L::load(&columns[0]), L::load(&columns[1]), L::load(&columns[2]))
}

fn sym3<L: Lanes>(c: &[[f32; 8]; 6]) -> Sym3<L> {
    let [xx, yy, zz, xy, xz, yz] = [0, 1, 2, 3, 4, 5].map(|i| L::load(&c[i]));
    Sym3 { xx, yy, zz, xy, xz, yz }
}

/// Looks up one lane after another: each contact is touched once, and the arithmetic is left to the lanes.
///
/// Not inlined: of all that makes a batch this is the most code, and it is the same for any width and any bodies `b`.
#[inline(never)]
fn gather_columns<const P: usize>(
    parts: &[Part],
    touching: bool,
    seats: Option<&Seats>,
    input: &PrepareInput<'_>,
) -> Columns<P> {
    let mut out = Columns {
        a: [0; 8],
        b: [0; 8],
        contact: [Part::NONE; 8],
        write: [0; 2],
        swapped: 0,
        heard: 0,
        rotation: [[0.0; 8]; 4],
        normal: [[0.0; 8]; 3],
        origin: [[0.0; 8]; 3],
        to_b: [[0.0; 8]; 3],
        sign: [0.0; 8],
        inverse_mass: [[0.0; 8]; 2],
        locks: [0; 2],
        inverse_inertia: [[[0.0; 8]; 6]; 2],
        position: [[[0.0; 8]; 3]; P],
        separation: [[f32::INFINITY; 8]; P],
        impulse: [[0.0; 8]; P],
        lasting: [[0.0; 8]; P],
        rest: [0.0; 8],
        reach: [0.0; 8],
        present: [[0.0; 8]; P],
        friction: [[0.0; 8]; 3],
        twist: [0.0; 8],
        coefficient: [[0.0; 8]; 2],
    };
    let (dynamic, movers) = (input.bodies.dynamic() as u32, input.bodies.movers() as u32);
    let mut first = 0;
    for (place, &part) in parts.iter().enumerate() {
        let contact = &input.contacts[part.slot()];
        let (shape_a, shape_b) = (&input.colliders[contact.a as usize], &input.colliders[contact.b as usize]);
        let pose = &input.poses[contact.a as usize];
        // `a` of the batch is a body that can be pushed.
        let swap = shape_a.body >= dynamic;
        let (a, b) = if swap { (shape_b.body, shape_a.body) } else { (shape_a.body, shape_b.body) };
        let lane = seats.and_then(|seats| seats.of(a as usize)).map_or(place, Seat::lane);
        if place == 0 {
            first = lane;
        }
        out.contact[lane] = part;
        out.swapped |= u8::from(swap) << lane;
        out.write[0] |= u8::from(a < dynamic) << lane;
        out.write[1] |= u8::from(b < dynamic) << lane;
        // A static body has no record: its velocity is never used.
        (out.a[lane], out.b[lane]) = (a, if b < movers { b } else { a });

        let at = |body: u32| &input.bodies.pose[body as usize].position;
        let own = (pose.position - *at(shape_a.body)).as_vec3();
        let between = if contact.fraction > 0.0 {
            let moved = |body: u32| input.motion.get(body as usize).map_or(glam::Vec3::ZERO, |m| m.linear);
            (*at(shape_a.body) - *at(shape_b.body)).as_vec3()
                + (moved(shape_a.body) - moved(shape_b.body)) * contact.fraction
        } else {
            // As the shapes stood when the contact was found.
            let own_b = (input.poses[contact.b as usize].position - *at(shape_b.body)).as_vec3();
            own_b - own - contact.frame * contact.found_at.position
        };
        put3(&mut out.origin, lane, if swap { own + between } else { own });
        put3(&mut out.to_b, lane, if swap { -between } else { between });
        out.sign[lane] = if swap { -1.0 } else { 1.0 };
        put3(&mut out.normal, lane, contact.normal);
        for (column, x) in out.rotation.iter_mut().zip(contact.frame.to_array()) {
            column[lane] = x;
        }
        for (side, body) in [a, b].into_iter().enumerate() {
            if let Some(i) = input.inverse_inertia.get(body as usize) {
                out.inverse_mass[side][lane] = input.bodies.mass[body as usize].inverse;
                if input.bodies.locked > 0 {
                    out.locks[side] |= lock_bits(input.bodies.traits[body as usize].locks, lane);
                }
                for (column, x) in
                    out.inverse_inertia[side].iter_mut().zip([i.xx, i.yy, i.zz, i.xy, i.xz, i.yz])
                {
                    column[lane] = x;
                }
            }
        }
        let points = part.points(contact);
        let mut lasting = contact.lasting_force * input.lengths.now();
        let carried = |p: &Point| input.lengths.carry(p.impulse, p.mean_force).max(0.0);
        // Points that stand for others bear their loads.
        let (mut load, mut missing) = (1.0, 0.0);
        if part.is_cut() {
            let kept = |of: &dyn Fn(&Point) -> f32| ones(points).map(|i| of(&contact.points[i])).sum::<f32>();
            let all: f32 = contact.points().iter().map(carried).sum();
            let (own, share) = (kept(&carried), kept(&|p| p.share));
            if own > 0.0 {
                load = all / own
            } else {
                missing = all / points.count_ones() as f32
            }
            lasting = if share > 0.0 { lasting / share } else { 0.0 };
        }
        let thinnest = shape_a.thickness().min(shape_b.thickness());
        [out.rest[lane], out.reach[lane]] = contact.spring(input.slop.min(THIN * thinnest));
        for (i, point) in ones(points).map(|i| &contact.points[i % MAX_POINTS]).enumerate().take(P) {
            put3(&mut out.position[i], lane, point.position);
            out.separation[i][lane] = point.separation;
            let borne = carried(point);
            out.impulse[i][lane] = if part.is_cut() { borne * load + missing } else { borne };
            out.lasting[i][lane] = point.share * lasting;
            out.present[i][lane] = 1.0;
        }
        if touching {
            // Friction was stored for the whole contact; its points share it by their load.
            let total: f32 = contact.points().iter().map(|p| p.impulse).sum();
            let share = part
                .only()
                .map_or(1.0, |p| if total > 0.0 { contact.points[p].impulse / total } else { 0.0 });
            let carried = input.lengths.carry(contact.friction.extend(contact.twist), contact.mean_friction);
            put3(&mut out.friction, lane, carried.truncate() * share);
            out.twist[lane] = carried.w;
        }
        out.heard |= u8::from((shape_a.flags | shape_b.flags) & EVENTS != 0) << lane;
        if !input.friction {
            continue;
        }
        let mut friction = shape_a.material.friction_with(&shape_b.material);
        if !input.tweaks.is_empty() {
            friction = tweak_of(input.tweaks, part.slot()).friction_or(friction);
        }
        let (sticking, sliding) = friction;
        (out.coefficient[0][lane], out.coefficient[1][lane]) = (sticking, sliding);
    }
    for lane in (0..8).filter(|&lane| out.contact[lane] == Part::NONE) {
        (out.a[lane], out.b[lane]) = (out.a[first], out.b[first]);
    }
    out
}

/// Fills the lanes of a batch; lanes without a contact get rows without mass.
fn fill<L: GatherLanes, const P: usize, const B: usize>(
    batch: &mut Batch<L, P, B>,
    rub: Rub<'_, L, B>,
    parts: &[Part],
    (seats, surface): (Option<&Seats>, Option<(usize, &mut Surface)>),
    input: &PrepareInput<'_>,
) {
    let columns = gather_columns::<P>(parts, matches!(rub, Rub::Touching(_)), seats, input);
    (batch.a, batch.contact, batch.surface) = (columns.a, columns.contact, u32::MAX);
    [batch.write_a, batch.write_b] = columns.write;
    (batch.swapped, batch.heard, batch.locks) = (columns.swapped, columns.heard, columns.locks);
    let turn = crate::lanes::Quat {
        v: Vec3::new(
            L::load(&columns.rotation[0]),
            L::load(&columns.rotation[1]),
            L::load(&columns.rotation[2]),
        ),
        w: L::load(&columns.rotation[3]),
    }
    .to_matrix();
    let sign = L::load(&columns.sign);
    let n = turn.mul(vec3(&columns.normal)) * sign;
    let (ma, ia) = (L::load(&columns.inverse_mass[0]), sym3(&columns.inverse_inertia[0]));
    let (origin, to_b) = (vec3::<L>(&columns.origin), vec3::<L>(&columns.to_b));
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
    // Of unit impulses along `x`, what the masses make of them along `y`; `all`: if no axis is locked.
    let locks = columns.locks;
    let linear = |x: Vec3<L>, y: Vec3<L>, all: L| {
        if locks == [0; 2] {
            return all;
        }
        unlocked(locks[0], x).dot(y) * ma + unlocked(locks[1], x).dot(y) * mb
    };
    let along = linear(n, n, ma + mb);
    let (mut ra, mut rb) = ([Vec3::<L>::zero(); P], [Vec3::<L>::zero(); P]);
    let (mut turned_a, mut turned_b) = ([Vec3::<L>::zero(); P], [Vec3::<L>::zero(); P]);
    let mut arms_b = [Vec3::<L>::zero(); P];
    let mut present = [L::zero(); P];
    for i in 0..P {
        present[i] = L::load(&columns.present[i]);
        ra[i] = turn.mul(vec3(&columns.position[i])) + origin;
        rb[i] = ra[i] + to_b;
        let (arm_a, arm_b) = (ra[i].cross(n), rb[i].cross(n));
        (turned_a[i], turned_b[i]) = (ia.mul(arm_a), ib.mul(arm_b));
        let k = along + arm_a.dot(turned_a[i]) + arm_b.dot(turned_b[i]);
        let possible = present[i].gt(L::zero()) & k.gt((ma + mb) * L::splat(GONE));
        let s = L::load(&columns.separation[i]);
        let point = &mut batch.points[i];
        (point.arm_a, point.arm_b) = (arm_a, [arm_b; B]);
        arms_b[i] = arm_b;
        (point.separation, point.now) = (s, s);
        point.mass = L::select(possible, L::one() / k, L::zero());
        point.stiffness = k;
        point.lasting = L::load(&columns.lasting[i]);
        point.impulse = L::select(possible, L::load(&columns.impulse[i]), L::zero());
        for (k, other_b) in arms_b.iter().enumerate().take(i) {
            let both = batch.points[k].arm_a.dot(turned_a[i]) + other_b.dot(turned_b[i]);
            batch.couple(k, i, along + both);
        }
    }
    if let Rub::Nothing = rub {
        return;
    }
    let count = present.iter().fold(L::zero(), |s, &x| s + x).max(L::one());
    let share = L::one() / count;
    let mean =
        |of: &[Vec3<L>; P]| of.iter().zip(&present).fold(Vec3::zero(), |s, (&r, &x)| s + r * x) * share;
    let (fa, fb) = (mean(&ra), mean(&rb));
    let (sticking, sliding) = (L::load(&columns.coefficient[0]), L::load(&columns.coefficient[1]));
    let f = match rub {
        Rub::Nothing => return,
        Rub::Impact(f) => {
            (f.along, f.to_b, f.coefficient) = (n.dot(fa), [fb - fa; B], sliding);
            return;
        }
        Rub::Touching(f) => f,
    };
    (f.arm_a, f.arm_b) = (fa, [fb; B]);

    let radius = ra.iter().zip(&present).fold(L::zero(), |s, (&r, &x)| s + (r - fa).length() * x) * share;
    let (t1, t2) = n.tangents();
    let (a1, a2, b1, b2) = (fa.cross(t1), fa.cross(t2), fb.cross(t1), fb.cross(t2));
    let (ia1, ib1, ia2, ib2) = (ia.mul(a1), ib.mul(b1), ia.mul(a2), ib.mul(b2));
    let mut k11 = linear(t1, t1, ma + mb) + a1.dot(ia1) + b1.dot(ib1);
    let k12 = linear(t1, t2, L::zero()) + a1.dot(ia2) + b1.dot(ib2);
    let mut k22 = linear(t2, t2, ma + mb) + a2.dot(ia2) + b2.dot(ib2);
    if locks != [0; 2] {
        // Where nothing moves along the surface in some direction, the matrix has an inverse all the same.
        let tiny = (k11 + k22) * L::splat(YIELDS);
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
    f.radius = radius;
    let old = turn.mul(vec3(&columns.friction)) * sign;
    f.impulse = [old.dot(t1), old.dot(t2)].map(|x| L::select(possible, x, L::zero()));
    f.twist = L::load(&columns.twist);

    let velocity = &input.bodies.velocity;
    let record = |i: usize| velocity[i];
    let (va, wa) = gather::<L>(record, &batch.a);
    let (vb, wb) = if B > 0 { gather::<L>(record, &batch.b[0].index) } else { (Vec3::zero(), Vec3::zero()) };
    let mut slip = vb + wb.cross(fb) - (va + wa.cross(fa));
    if let Some((place, surface)) = surface {
        let past = Vec3::<L>::from_fn(|lane| {
            let part = batch.contact[lane];
            let past = if part == Part::NONE {
                glam::Vec3::ZERO
            } else {
                tweak_of(input.tweaks, part.slot()).surface
            };
            if batch.swapped >> lane & 1 != 0 { -past } else { past }
        });
        slip += past;
        past.dot(t1).store(&mut surface[0]);
        past.dot(t2).store(&mut surface[1]);
        batch.surface = place as u32;
    }
    let slip = slip - n * slip.dot(n);
    let stick = slip.length_squared().lt(L::splat(input.stick * input.stick));
    f.coefficient = L::select(stick, sticking, sliding);
}
