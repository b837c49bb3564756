//! Impulses of rows, summed over the substeps of a step.

use super::joints::Source;
use super::*;
use crate::constraint::{ContactLane, JointViews, RowImpulse};
use crate::solver::Witness;

/// Impulses of the solver, and changes of velocities by other causes.
#[derive(Debug, Default)]
pub(in crate::observe) struct Sums {
    /// Impulses of contact rows, in the order of the system.
    contacts: Vec<f64>,
    /// Normal impulses of bounces, by contacts.
    impacts: Vec<f64>,
    locks: Vec<DVec3>,
    /// Impulses of other rows of joints: at both ends, and as force and torque on the second body at its
    /// point.
    rows: Vec<([f64; 2], [DVec3; 2])>,
    /// The same of couplings, which act on two joints.
    couplings: Vec<([f64; 2], [[DVec3; 2]; 2])>,
    given: Vec<Velocity>,
    /// Changes by gravity and forces; a body that stops after a bounce has none.
    pulled: Vec<Velocity>,
    before: Vec<Record>,
    /// Impulses of joints outside trees and their moments, and linear impulses of those of trees.
    pushed: Vec<Velocity>,
    /// Changes of angular velocities by the joints of trees.
    turned: Vec<DVec3>,
    /// Changes while trees moved in the last substep.
    moved: Vec<Velocity>,
    /// See [`SystemBody::unconserved`] and [`SystemBody::stiffened`].
    unconserved: Vec<bool>,
    stiffened: Vec<bool>,
}

impl Sums {
    pub(in crate::observe) fn new(world: &World, system: &System) -> Sums {
        Sums {
            contacts: vec![0.0; system.contact_rows()],
            impacts: vec![0.0; world.contacts.slots()],
            locks: vec![DVec3::ZERO; world.joints.locks.len()],
            rows: vec![([0.0; 2], [DVec3::ZERO; 2]); world.joints.rows.len()],
            couplings: vec![Default::default(); world.joints.couplings.all.len()],
            given: vec![[DVec3::ZERO; 2]; system.bodies.len()],
            pulled: vec![[DVec3::ZERO; 2]; system.bodies.len()],
            before: Vec::new(),
            pushed: vec![[DVec3::ZERO; 2]; system.bodies.len()],
            turned: vec![DVec3::ZERO; system.bodies.len()],
            moved: vec![[DVec3::ZERO; 2]; system.bodies.len()],
            unconserved: vec![false; system.bodies.len()],
            stiffened: vec![false; system.bodies.len()],
        }
    }

    /// Hands the system the impulses, and says how many contacts bounced.
    pub(in crate::observe) fn give(&self, world: &mut World, system: &mut System) -> usize {
        for (row, &impulse) in system.rows.iter_mut().zip(&self.contacts) {
            row.impulse = impulse;
        }
        for (i, body) in system.bodies.iter_mut().enumerate() {
            let (given, pulled) = (self.given[i], self.pulled[i]);
            (body.unconserved, body.stiffened) = (self.unconserved[i], self.stiffened[i]);
            body.given = [0, 1].map(|k| given[k] + pulled[k] - (body.free[k] - body.start[k]));
        }
        self.give_joints(world, system);
        self.give_turned(system);
        let bounced = self.impacts.iter().filter(|impact| **impact > 0.0).count();
        if bounced > 0 {
            self.give_impacts(world, system);
        }
        bounced
    }

    /// Adds the impulses of bounces. It is not known which of a contact's points bounced, so each gets an
    /// equal share.
    fn give_impacts(&self, world: &mut World, system: &mut System) {
        let mut rows = std::mem::take(&mut world.buffers.rows);
        let mut row = 0;
        // For each body, the number of contacts and of those that bounced.
        let mut counts = vec![[0; 2]; system.bodies.len()];
        // SAFETY: between stages there is no other thread.
        unsafe {
            rows.views().each_lane(&mut |lane| {
                let own = LaneRows::of(lane);
                let impact = self.impacts[lane.part.slot()];
                for body in system.rows[row].bodies.into_iter().flatten() {
                    counts[body][0] += 1;
                    counts[body][1] += usize::from(impact > 0.0);
                }
                for i in 0..if impact > 0.0 { own.points } else { 0 } {
                    system.give_impact(row + i, impact / own.points as f64);
                }
                row += own.count();
            });
        }
        world.buffers.rows = rows;
        for law in &mut system.laws {
            let bodies = system.rows[law.first].bodies.into_iter().flatten();
            law.bouncing = bodies.map(|body| counts[body]).any(|[all, bounced]| bounced > 0 && all > 1);
        }
    }

    /// Gives bodies the changes of their velocities by joints as far as their directions turned.
    fn give_turned(&self, system: &mut System) {
        let rows = &system.rows[self.contacts.len()..];
        let at_start = pushes(rows.iter().map(|row| (row, &row.impulse)), system.bodies.len(), Some);
        for (i, body) in system.bodies.iter_mut().enumerate() {
            let (acted, as_rows) = (body.moved(self.pushed[i]), body.moved(at_start[i]));
            body.turned = [acted[0] - as_rows[0], acted[1] + self.turned[i] - as_rows[1]];
        }
    }

    /// Adds changes of angular velocities by the joints of trees, all impulses of the substep taken to act
    /// where bodies are now: an impulse that acts from now on is the difference of two such sums.
    fn add_turned(
        &mut self,
        joints: &JointViews<'_>,
        sign: f64,
        mut linear: impl FnMut(&mut Velocity, DVec3),
    ) {
        // SAFETY: between stages there is no other thread.
        unsafe {
            joints.each_tree_push(&mut |body, push| {
                let body = body as usize;
                self.turned[body] += push.turned.as_dvec3() * sign;
                self.stiffened[body] |= push.stiffened;
                linear(&mut self.pushed[body], push.impulse.as_dvec3());
            });
        }
    }

    fn give_joints(&self, world: &World, system: &mut System) {
        let contacts = self.contacts.len();
        let mut row = contacts;
        let mut seen = vec![false; self.rows.len()];
        let mut seen_couplings = vec![false; self.couplings.len()];
        let mut rests = vec![[DVec3::ZERO; 2]; world.joints.all.len()];
        each_joint_row(world, &mut |one: &JointRow| {
            if let Source::Row(i, end) = one.source {
                let (ends, acted) = self.rows[i];
                let [lower, upper] = ends;
                system.rows[row].impulse = at_end(ends, end);
                // The guiding rows bear the rest.
                let rest = &mut rests[one.joint as usize];
                let sign = if end == 1 { -1.0 } else { 1.0 };
                if !std::mem::replace(&mut seen[i], true) {
                    let net = lower - upper;
                    for k in 0..2 {
                        rest[k] += acted[k] - one.direction[k] * (sign * net);
                    }
                }
            }
            if let Source::Coupling(i, end) = one.source {
                let (ends, acted) = self.couplings[i];
                system.rows[row].impulse = at_end(ends, end);
                let net = ends[0] - ends[1];
                let first = !std::mem::replace(&mut seen_couplings[i], true);
                for ((joint, direction), acted) in one.coupled.into_iter().flatten().zip(acted) {
                    for k in 0..if first { 2 } else { 0 } {
                        rests[joint as usize][k] += acted[k] - direction[k] * net;
                    }
                }
            }
            row += 1;
        });
        let mut row = contacts;
        each_joint_row(world, &mut |one: &JointRow| {
            if let Source::Lock(i) = one.source {
                let [force, torque] = rests[one.joint as usize];
                system.rows[row].impulse = self.locks[i].dot(one.direction[0] + one.direction[1])
                    + force.dot(one.direction[0])
                    + torque.dot(one.direction[1]);
            }
            row += 1;
        });
    }
}

/// The impulse at an end of a range, or of both.
fn at_end([lower, upper]: [f64; 2], end: usize) -> f64 {
    match end {
        0 => lower,
        1 => upper,
        _ => lower - upper,
    }
}

impl System {
    /// Adds an impulse of an impact to a row, and removes its effect from the changes that rows do not
    /// explain.
    fn give_impact(&mut self, row: usize, impulse: f64) {
        let row = &mut self.rows[row];
        row.impulse += impulse;
        for side in 0..SIDES {
            if let Some(body) = row.bodies[side] {
                let body = &mut self.bodies[body];
                body.given[0] -= body.inverse_mass * row.linear[side] * impulse;
                body.given[1] -= body.inverse_inertia * row.angular[side] * impulse;
            }
        }
    }
}

/// The rows of a lane as the system has them: normals first, then friction.
pub(in crate::observe) struct LaneRows {
    /// How many normals.
    pub(in crate::observe) points: usize,
    /// How many rows of friction.
    pub(in crate::observe) friction: usize,
    /// How many rows of rolling and spinning friction.
    pub(in crate::observe) rolling: usize,
}

impl LaneRows {
    pub(in crate::observe) fn of(lane: &ContactLane) -> LaneRows {
        let points = lane.points().len();
        let friction = match lane.friction {
            // A single point has no twist, unless rolling friction asks for the law of a patch.
            Some(f) if f.coefficient > 0.0 => {
                if points == 1 && lane.rolling.is_none() {
                    2
                } else {
                    3
                }
            }
            _ => 0,
        };
        let rolls = lane.rolling.is_some() && !Self::only_spins(lane);
        LaneRows { points, friction, rolling: if rolls { 3 } else { 0 } }
    }

    /// Whether the twist of its friction has all that its materials resist.
    pub(in crate::observe) fn only_spins(lane: &ContactLane) -> bool {
        let rubs = lane.friction.is_some_and(|f| f.coefficient > 0.0);
        rubs && lane.rolling.is_some_and(|rolling| rolling.arm == 0.0)
    }

    /// The lever arm of twist as a multiple of the bound of friction [m].
    pub(in crate::observe) fn twist_arm(lane: &ContactLane) -> f64 {
        let Some(f) = &lane.friction else { return 0.0 };
        let spins = lane.rolling.filter(|_| Self::only_spins(lane));
        f64::from(f.radius) + spins.map_or(0.0, |rolling| f64::from(rolling.spin_arm / f.coefficient))
    }

    /// The shares of sliding and of spinning friction in the twist of a lane, which is one row there, by
    /// their bounds [N m s].
    pub(in crate::observe) fn twists(lane: &ContactLane) -> [f64; 2] {
        let Some(f) = &lane.friction else { return [0.0; 2] };
        if Self::only_spins(lane) {
            return [f.impulse[2].into(), 0.0];
        }
        let (slides, spins) =
            (f.coefficient * f.radius, lane.rolling.map_or(0.0, |rolling| rolling.spin_arm));
        let share = if slides + spins > 0.0 { spins / (slides + spins) } else { 0.0 };
        let (twist, share) = (f64::from(f.impulse[2]), f64::from(share));
        [twist * (1.0 - share), twist * share]
    }

    /// The distance at which rows against rolling are velocities [m]: of the surface from the centres of
    /// mass, the greater one.
    pub(in crate::observe) fn reach(lane: &ContactLane) -> f64 {
        let arms =
            lane.friction.map_or([0.0; 2], |f| f.arms.map(|arm| f64::from(arm.dot(lane.normal).abs())));
        let most = arms[0].max(arms[1]);
        if most > 0.0 { most } else { 1.0 }
    }

    /// All of them.
    pub(in crate::observe) fn count(&self) -> usize {
        self.points + self.friction + self.rolling
    }
}

impl Witness for Sums {
    fn before(&mut self, velocity: &[Record]) {
        self.before.clear();
        self.before.extend_from_slice(velocity);
    }

    fn after(&mut self, now: &[Record]) {
        for ((given, before), now) in self.given.iter_mut().zip(&self.before).zip(now) {
            let (before, now) = (velocity(before), velocity(now));
            for k in 0..2 {
                given[k] += now[k] - before[k];
            }
        }
    }

    fn relaxed(&mut self, joints: &JointViews<'_>) {
        self.add_turned(joints, 0.0, |_, _| {});
    }

    fn trees_move(&mut self, joints: &JointViews<'_>) {
        self.add_turned(joints, 1.0, |_, _| {});
    }

    fn trees_moved(&mut self, joints: &JointViews<'_>, now: &[Record]) {
        self.add_turned(joints, -1.0, |_, _| {});
        for ((moved, before), now) in self.moved.iter_mut().zip(&self.before).zip(now) {
            let (before, now) = (velocity(before), velocity(now));
            *moved = [now[0] - before[0], now[1] - before[1]];
        }
    }

    fn contacts(&self) -> usize {
        self.impacts.len()
    }

    fn impacts(&mut self, impulses: &mut dyn Iterator<Item = f32>) {
        for (sum, impulse) in self.impacts.iter_mut().zip(impulses) {
            *sum += f64::from(impulse);
        }
    }

    fn stand(&mut self, bodies: &[u32]) {
        for &i in bodies {
            self.unconserved[i as usize] = true;
        }
    }

    fn pull(&mut self, acceleration: &[Record], h: f32) {
        for (sum, pull) in self.pulled.iter_mut().zip(acceleration) {
            let pull = velocity(pull);
            for k in 0..2 {
                sum[k] += pull[k] * f64::from(h);
            }
        }
    }

    fn substep(&mut self, views: &Views<'_>, joints: &JointViews<'_>) {
        let mut at = 0;
        // SAFETY: between stages there is no other thread.
        unsafe {
            views.each_lane(&mut |lane| {
                let own = &mut self.contacts[at..];
                for (sum, point) in own.iter_mut().zip(lane.points()) {
                    *sum += f64::from(point.impulse);
                }
                if let Some(guarded) = views.guarded.find(lane.part.slot()) {
                    for (i, sum) in own.iter_mut().enumerate().take(lane.points().len()) {
                        let push = &mut guarded[lane.part.only().unwrap_or(i)];
                        *sum += f64::from(std::mem::take(push));
                    }
                }
                let rows = LaneRows::of(lane);
                if let Some(f) = lane.friction {
                    let twists = LaneRows::twists(lane);
                    let own = &mut own[rows.points..];
                    let slid = [f.impulse[0].into(), f.impulse[1].into(), twists[0]];
                    for (sum, impulse) in own.iter_mut().zip(slid).take(rows.friction) {
                        *sum += impulse;
                    }
                    if let Some(rolling) = lane.rolling.filter(|_| rows.rolling > 0) {
                        let [x, y] = rolling.impulse.map(f64::from);
                        for (sum, impulse) in own[rows.friction..].iter_mut().zip([x, y, twists[1]]) {
                            *sum += impulse / LaneRows::reach(lane);
                        }
                    }
                }
                at += rows.count();
            });
            joints.each_impulse(
                &mut |owner, impulse| self.locks[owner as usize] += impulse.as_dvec3(),
                &mut |owner, RowImpulse { ends: impulse, force, torque, .. }| {
                    let (ends, acted) = &mut self.rows[owner as usize];
                    for k in 0..2 {
                        ends[k] += f64::from(impulse[k]);
                    }
                    let net = f64::from(impulse[0] - impulse[1]);
                    acted[0] += force.as_dvec3() * net;
                    acted[1] += torque.as_dvec3() * net;
                },
                &mut |slot, impulse, levers| {
                    let (ends, acted) = &mut self.couplings[slot as usize];
                    for k in 0..2 {
                        ends[k] += f64::from(impulse[k]);
                    }
                    let net = f64::from(impulse[0] - impulse[1]);
                    for (acted, lever) in acted.iter_mut().zip(levers) {
                        for k in 0..2 {
                            acted[k] += lever[k].as_dvec3() * net;
                        }
                    }
                },
                &mut |body, push| {
                    let of = &mut self.pushed[body as usize];
                    for k in 0..2 {
                        of[k] += push[k].as_dvec3();
                    }
                },
                &mut |body, aside| {
                    let body = body as usize;
                    self.unconserved[body] |= aside.unconserved;
                    self.given[body][0] += aside.caught.as_dvec3();
                    if aside.whirled {
                        // Impulses of joints account for it.
                        self.given[body][0] -= self.moved[body][0];
                    }
                },
            );
        }
        self.add_turned(joints, 1.0, |pushed, impulse| pushed[0] += impulse);
    }
}
