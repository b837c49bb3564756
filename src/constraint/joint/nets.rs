//! Nets of joined bodies, and a bound on their energy where directions turn too fast for the substep.
//!
//! Joints do no work. For their rows this holds with the directions at the start of a substep, and with how
//! these bend within it as far as a series goes: for a tenth of a radian or so. Beyond that, their impulses
//! have little to do with the impulses that would hold the joint; in some positions they add energy, and the
//! next substep adds more. Two balls on a slider came from 300 m/s to 43 km/s within two seconds. No substep
//! that a game can pay for follows that. So where directions turn by more than [`FOLLOWED_TURN`], joints may
//! take energy but give none: after a substep a net has no more than before, except for the work of motors.
//! Any excess is removed from all of its velocities in proportion, except for the motion of the centre of
//! mass.
//!
//! Energy is kinetic energy, the potential of external forces, and that of springs. A stiff spring can give
//! back less than it stores: the energy of its displacement as a speed over a substep.

mod rates;

use super::batch::{Link, Watched};
use super::ends::Recovery;
use super::kinds::JointStage;
use super::run::JointViews;
use crate::body::{Mass, Pose, exp_map};
use crate::config::tuning::{CHORD_ENERGY, WILD_ENERGY};
use crate::constraint::contact::row::Motion;
use crate::constraint::contact::rows::{Views, with_batch};
use crate::lanes::Record;
use crate::memory::buffers;
use glam::{DVec3, Vec3};
use rates::visit;

// Guard: beyond, the numbers are no motion.
/// Velocities above this [m/s] or [rad/s] are as good as not finite.
const RUNAWAY: f32 = 1e6;
// Rounding: of an energy.
/// A loss of a smaller share of its energy is rounding, and not counted.
const COUNTED: f64 = 1e-4;

/// A body of a net. Each net is a circular list, and named by one of its bodies, the root.
#[derive(Clone, Copy, Debug, Default)]
struct Member {
    root: u32,
    next: u32,
    /// For a root: the maximum energy, and that of motion and springs at the start of the substep [J].
    most: f32,
    moving: f32,
    /// Energy of springs, now and at the start of the substep [J].
    spring_energy: f32,
    start_springs: f32,
    flags: u32,
    /// Velocity before joints acted in the substep, and the displacement at its start.
    start: Record,
    moved: Record,
}

/// Flags of a root: it is joined to or touches a body that can't be pushed; that body moves; bodies turn fast
/// enough to be checked; rows turn too fast; it lost energy in this step; it was limited in the substep
/// before; it diverged; its energy at the start of the substep is known.
const HELD: u32 = 1;
const CARRIED: u32 = 2;
const SWIFT: u32 = 8;
const FAST: u32 = 16;
const DAMPED: u32 = 32;
const BOUND: u32 = 64;
const WILDLY: u32 = 128;
const KNOWN: u32 = 256;

/// All nets.
#[derive(Debug, Default)]
pub(crate) struct Nets {
    all: Vec<Member>,
    linked: bool,
    any_bound: bool,
}

/// Input of the check.
pub(crate) struct NetInput<'a, 'b> {
    pub(crate) views: &'a JointViews<'b>,
    pub(crate) stages: &'a [JointStage],
    pub(crate) motion: &'a Motion<'a, 'b>,
    pub(crate) pose: &'a [Pose],
    pub(crate) mass: &'a [Mass],
    /// Acceleration by external forces; empty if there is none.
    pub(crate) pull: &'a [Record],
    /// Substep [s].
    pub(crate) h: f32,
    pub(crate) recovery: Recovery,
}

/// State of a net at one moment.
#[derive(Clone, Copy, Debug, Default)]
struct Ledger {
    mass: f64,
    momentum: DVec3,
    kinetic: f64,
    /// Potential energy of external forces, relative to the start of the step.
    potential: f64,
}

/// Whether the substep can follow a net with such flags, or others give it energy.
fn is_followed(flags: u32) -> bool {
    flags & FAST == 0 || flags & CARRIED != 0
}

impl NetInput<'_, '_> {
    fn velocity(&self, body: usize) -> Record {
        // SAFETY: between stages this thread is alone.
        unsafe { self.motion.velocity.read(body) }
    }

    /// Velocity and displacement.
    fn state(&self, body: usize) -> [Record; 2] {
        // SAFETY: between stages this thread is alone.
        [self.velocity(body), unsafe { self.motion.delta.read(body) }]
    }

    /// Velocity of a body, the same before joints acted, and its displacement.
    ///
    /// # Safety
    /// Between stages only, and while no other reference to the body is held.
    #[allow(clippy::mut_from_ref, reason = "the contract is the caller's, see `Shared::get`")]
    unsafe fn all(&self, body: usize) -> (&mut Record, &mut Record, &mut Record) {
        // SAFETY: by the contract.
        unsafe { (self.motion.velocity.get(body), self.motion.base.get(body), self.motion.delta.get(body)) }
    }

    /// Energy that a body may have while an error is corrected [J].
    fn closing_energy(&self, body: usize) -> f64 {
        let (mass, Recovery { linear, angular }) = (&self.mass[body], self.recovery);
        let m = self.mass_of(body);
        let inertia = f64::from(mass.inertia.max_element().min(f32::MAX));
        0.5 * (m * f64::from(linear).powi(2) + inertia * f64::from(angular).powi(2))
    }

    /// Mass [kg]; zero for bodies that can't be moved.
    fn mass_of(&self, body: usize) -> f64 {
        let inverse = self.mass[body].inverse;
        if inverse > 0.0 { 1.0 / f64::from(inverse) } else { 0.0 }
    }

    fn pull_of(&self, body: usize) -> Record {
        self.pull.get(body).copied().unwrap_or_default()
    }

    /// Adds a body at a velocity and a displacement.
    fn add(&self, ledger: &mut Ledger, body: usize, [v, d]: [&Record; 2]) {
        let (mass, pose, pull) = (&self.mass[body], &self.pose[body], self.pull_of(body));
        let m = self.mass_of(body);
        // Bodies of trees that conserve energy have turned already; the inertia of others turns at the end of
        // the step.
        let turn = if d.is_turned() { exp_map(d.angular) * pose.rotation } else { pose.rotation };
        let inertia = Vec3::select(mass.inverse_inertia.cmpgt(Vec3::ZERO), mass.inertia, Vec3::ZERO);
        let spin_energy = |a: Vec3, b: Vec3| {
            let [a, b] = [a, b].map(|x| turn.conjugate() * x);
            a.as_dvec3().dot(inertia.as_dvec3() * b.as_dvec3())
        };
        let linear = v.linear.as_dvec3();
        ledger.mass += m;
        ledger.momentum += linear * m;
        ledger.kinetic += 0.5 * (m * linear.length_squared() + spin_energy(v.angular, v.angular));
        ledger.potential -= m * f64::from(pull.linear.dot(d.linear));
        if pull.angular != Vec3::ZERO {
            ledger.potential -= spin_energy(pull.angular, d.angular);
        }
    }
}

buffers! { Nets { each(dynamic: usize) { all(dynamic) } } }

impl Nets {
    /// Number of nets that lost energy in the step.
    pub(crate) fn damped(&self) -> u32 {
        if !self.linked {
            return 0;
        }
        self.all.iter().filter(|member| member.flags & DAMPED != 0).count() as u32
    }

    /// Resets the nets at the start of a step.
    pub(crate) fn start(&mut self) {
        *self = Nets { all: std::mem::take(&mut self.all), ..Nets::default() };
    }

    fn root(&self, body: u32) -> usize {
        let mut at = body;
        while self.all[at as usize].root != at {
            at = self.all[at as usize].root;
        }
        at as usize
    }

    /// Links bodies that are joined or touch: contacts do no work either, but carry energy from one body to
    /// another.
    fn link(&mut self, input: &NetInput<'_, '_>, contacts: &Views<'_>, dynamic: usize) {
        self.all.clear();
        self.all.extend((0..dynamic as u32).map(|i| Member { root: i, next: i, ..Member::default() }));
        visit(input.views, input.stages, &mut |batch: &mut dyn Watched| {
            batch.links(&mut |link| self.tie(input, link));
        });
        for stage in contacts.stages {
            for &of in &contacts.schedule[stage.start as usize..stage.end as usize] {
                // SAFETY: there is no other thread.
                unsafe {
                    with_batch!(contacts, stage.group, of, |batch, _friction| {
                        let b = batch.b.first().map(|b| b.index);
                        for lane in 0..8 {
                            let moves = [batch.write_a, batch.write_b].map(|write| write >> lane & 1 != 0);
                            let moves = [moves[0], moves[1] && b.is_some()];
                            // Rows with static bodies do not store them.
                            let bodies = [batch.a[lane], b.map_or(u32::MAX, |b| b[lane])];
                            self.tie(input, Link { bodies, moves });
                        }
                    });
                }
            }
        }
        for i in 0..dynamic {
            self.all[i].root = self.root(i as u32) as u32;
        }
        self.linked = true;
    }

    fn tie(&mut self, input: &NetInput<'_, '_>, Link { bodies, moves }: Link) {
        let known = |side: usize| moves[side] && (bodies[side] as usize) < self.all.len();
        match [known(0), known(1)] {
            [true, true] => {
                let [a, b] = bodies.map(|body| self.root(body));
                if a != b {
                    // The lower root, in any order.
                    let (low, high) = (a.min(b), a.max(b));
                    self.all[high].root = low as u32;
                    let next = self.all[low].next;
                    self.all[low].next = self.all[high].next;
                    self.all[high].next = next;
                    self.all[low].flags |= self.all[high].flags;
                }
            }
            [false, false] => {}
            [first, _] => {
                let (body, other) = (bodies[usize::from(!first)], bodies[usize::from(first)]);
                let moves = other != u32::MAX && {
                    let v = input.velocity(other as usize);
                    v.linear != Vec3::ZERO || v.angular != Vec3::ZERO
                };
                let root = self.root(body);
                self.all[root].flags |= HELD | if moves { CARRIED } else { 0 };
            }
        }
    }

    fn flag(&mut self, body: u32, flags: u32) {
        if let Some(member) = self.all.get(body as usize) {
            let root = member.root as usize;
            self.all[root].flags |= flags;
        }
    }

    /// Finds the nets that turn fast, and their energy before the rows of a substep.
    #[cold]
    #[inline(never)]
    pub(crate) fn begin(
        &mut self,
        input: &NetInput<'_, '_>,
        contacts: &Views<'_>,
        dynamic: usize,
        swift: &dyn Fn(&Record) -> bool,
    ) {
        if !self.linked {
            self.link(input, contacts, dynamic);
        }
        self.all.iter_mut().for_each(|member| member.flags &= !(SWIFT | FAST | KNOWN));
        self.find_fast(input, swift);
        self.sum_springs(input, false);
        for (body, member) in self.all.iter_mut().enumerate() {
            // SAFETY: between stages this thread is alone.
            (member.start, member.moved) =
                unsafe { (input.motion.base.read(body), input.motion.delta.read(body)) };
            member.start_springs = member.spring_energy;
        }
    }

    /// Finds the energy of a net before the rows of the substep, on demand only: most nets are followed.
    fn know_energy(&mut self, input: &NetInput<'_, '_>, root: usize) {
        if self.all[root].flags & KNOWN != 0 {
            return;
        }
        let now = self.ledger(input, root, |body| {
            let (Member { start, moved, .. }, pull) = (&self.all[body], input.pull_of(body));
            let linear = start.linear - pull.linear * input.h;
            let angular = start.angular - pull.angular * input.h;
            [Record { linear, angular, ..*start }, *moved]
        });
        let given = self.ledger(input, root, |body| [self.all[body].start, self.all[body].moved]).kinetic;
        let member = &mut self.all[root];
        // Energy by which a spring was stretched beyond that in the substep before can't be taken back.
        let start = (now.kinetic + now.potential) as f32 + member.start_springs;
        member.most = if member.flags & BOUND != 0 { member.most.min(start) } else { start };
        member.moving = given.max(now.kinetic) as f32 + member.start_springs;
        member.flags |= KNOWN;
    }

    /// Sums the energy of springs; if `done`, also the work of motors in the substep.
    fn sum_springs(&mut self, input: &NetInput<'_, '_>, done: bool) {
        self.all.iter_mut().for_each(|member| member.spring_energy = 0.0);
        visit(input.views, input.stages, &mut |batch: &mut dyn Watched| {
            batch.stored(input.h, &mut |body, [stored, given]| {
                let Some(Member { root, .. }) = self.all.get(body as usize).copied() else { return };
                let root = &mut self.all[root as usize];
                root.spring_energy += stored;
                root.most += if done { given } else { 0.0 };
            });
        });
    }

    fn find_fast(&mut self, input: &NetInput<'_, '_>, swift: &dyn Fn(&Record) -> bool) {
        for body in 0..self.all.len() {
            // SAFETY: between stages this thread is alone.
            if swift(&unsafe { input.motion.velocity.read(body) }) {
                self.flag(body as u32, SWIFT);
            }
        }
        visit(input.views, input.stages, &mut |batch: &mut dyn Watched| {
            batch.turning(input.motion, input.h, &mut |body| self.flag(body, FAST));
        });
    }

    fn around(&self, root: usize, mut f: impl FnMut(usize)) {
        let mut at = root;
        loop {
            f(at);
            at = self.all[at].next as usize;
            if at == root {
                return;
            }
        }
    }

    /// After a substep without a check.
    pub(crate) fn rest(&mut self) {
        if std::mem::take(&mut self.any_bound) {
            self.all.iter_mut().for_each(|member| member.flags &= !BOUND);
        }
    }

    /// Before bodies move: limits how far a net moves by its energy.
    #[cold]
    #[inline(never)]
    pub(crate) fn hold_back(&mut self, input: &NetInput<'_, '_>, swift: &dyn Fn(&Record) -> bool) {
        // Some may have become fast within the substep.
        self.find_fast(input, swift);
        for root in 0..self.all.len() {
            if self.may_gain(input, root) {
                self.know_energy(input, root);
                let Member { moving, .. } = self.all[root];
                // The speed that corrects errors does not last.
                let mut closing = 0.0;
                self.around(root, |body| closing += input.closing_energy(body));
                let most = CHORD_ENERGY * f64::from(moving) + closing;
                let now = self.ledger(input, root, |body| input.state(body));
                self.bound(input, root, &now, most);
            }
        }
        self.forget_wild(input);
    }

    /// After the substep.
    #[cold]
    #[inline(never)]
    pub(crate) fn end(&mut self, input: &NetInput<'_, '_>) {
        visit(input.views, input.stages, &mut |batch: &mut dyn Watched| {
            batch.lost(input.motion, input.h, &mut |body| self.flag(body, FAST));
            batch.unsolved(input.motion, &mut |body| self.flag(body, FAST));
        });
        for root in 0..self.all.len() {
            if self.may_gain(input, root) {
                self.know_energy(input, root);
            }
        }
        self.sum_springs(input, true);
        self.rest();
        for root in 0..self.all.len() {
            let Member { most, spring_energy, .. } = self.all[root];
            if self.may_gain(input, root) {
                let now = self.ledger(input, root, |body| input.state(body));
                let most = f64::from(most - spring_energy) - now.potential;
                self.bound(input, root, &now, most);
            }
        }
        self.forget_wild(input);
    }

    fn ledger(&self, input: &NetInput<'_, '_>, root: usize, state: impl Fn(usize) -> [Record; 2]) -> Ledger {
        let mut ledger = Ledger::default();
        self.around(root, |body| input.add(&mut ledger, body, state(body).each_ref()));
        ledger
    }

    /// Whether a body is the root of a net whose energy has to be looked at: that turns too fast to be
    /// followed, or whose velocities are out of range.
    fn may_gain(&self, input: &NetInput<'_, '_>, root: usize) -> bool {
        let Member { root: own, flags, .. } = self.all[root];
        if own as usize != root || flags & SWIFT == 0 {
            return false;
        }
        let mut sound = is_followed(flags);
        self.around(root, |body| {
            let v = input.velocity(body);
            // A sum with a NaN is NaN.
            sound &= v.linear.abs().max(v.angular.abs()).max_element() <= RUNAWAY
                && (v.linear.element_sum() + v.angular.element_sum()).is_finite();
        });
        !sound
    }

    /// Limits the kinetic energy of a net that turns too fast [J]. A net with far more, or with an energy
    /// that is not finite, moves on as one rigid piece without rotation.
    fn bound(&mut self, input: &NetInput<'_, '_>, root: usize, now: &Ledger, most: f64) {
        let flags = self.all[root].flags;
        let followed = is_followed(flags);
        let mut fastest = 0.0_f32;
        self.around(root, |body| {
            let v = input.velocity(body);
            fastest = fastest.max(v.linear.abs().max(v.angular.abs()).max_element());
        });
        let far = most.max(0.0) * WILD_ENERGY + now.mass;
        // The motion of the centre of mass is that before joints acted: they don't change it.
        let free = flags & HELD == 0 && now.mass > 0.0;
        let mean_of = |momentum: DVec3| if free { momentum / now.mass } else { DVec3::ZERO };
        let mut before = DVec3::ZERO;
        if free {
            self.around(root, |body| before += self.all[body].start.linear.as_dvec3() * input.mass_of(body));
        }
        let mean = mean_of(before);
        if !now.kinetic.is_finite() || fastest > RUNAWAY || (!followed && now.kinetic > far) {
            self.all[root].flags |= DAMPED | WILDLY;
            self.around(root, |body| {
                // SAFETY: between stages this thread is alone.
                let (v, base, d) = unsafe { input.all(body) };
                // It leaves its predicted path, though no row shows that.
                d.set_touched();
                v.linear = mean.as_vec3();
                v.angular = Vec3::ZERO;
                *base = *v;
            });
            return;
        }
        if followed {
            return;
        }
        self.all[root].flags |= BOUND;
        self.any_bound = true;
        if now.kinetic <= most {
            return;
        }
        if now.kinetic - most > COUNTED * now.kinetic {
            self.all[root].flags |= DAMPED;
        }
        let own = mean_of(now.momentum);
        let energy_of = |mean: DVec3| 0.5 * now.mass * mean.length_squared();
        let share = (most - energy_of(mean)).max(0.0) / (now.kinetic - energy_of(own)).max(f64::MIN_POSITIVE);
        let (own, mean, share) = (own.as_vec3(), mean.as_vec3(), share.min(1.0).sqrt() as f32);
        self.around(root, |body| {
            // SAFETY: between stages this thread is alone.
            let (v, base, d) = unsafe { input.all(body) };
            d.set_touched();
            let old = *v;
            v.linear = mean + (v.linear - own) * share;
            v.angular *= share;
            // Impulses of rows are warm-started as before.
            base.linear += v.linear - old.linear;
            base.angular += v.angular - old.angular;
        });
    }

    /// Clears the impulses of joints in nets that diverged: as a warm start they would drive them ever
    /// faster.
    fn forget_wild(&mut self, input: &NetInput<'_, '_>) {
        if !self.all.iter().any(|member| member.flags & WILDLY != 0) {
            return;
        }
        let all = &self.all;
        let wild = |body: u32| {
            let root = all.get(body as usize).and_then(|member| all.get(member.root as usize));
            root.is_some_and(|root| root.flags & WILDLY != 0)
        };
        visit(input.views, input.stages, &mut |batch: &mut dyn Watched| batch.forget(&wild));
        self.all.iter_mut().for_each(|member| member.flags &= !WILDLY);
    }
}
