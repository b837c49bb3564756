//! Solves the impacts of a substep, one after another.
//!
//! An impact at time `t` of the substep changes `v` to `v'`. From then on the body is treated as if it had
//! had `v'` from the start of the substep and started displaced by `(v - v') t`; it ends where it would if it
//! had turned round at the surface, with the work of gravity done on the way in and out, so a ball rises to
//! e² of its height at any step. Separations follow that path as any other, and later impacts of the substep
//! need no bookkeeping. Joined bodies are not displaced, which would tear their joints: they turn round
//! before the surface, by less than they move in a substep.
//!
//! Contacts were found along the predicted motion. A body that is thrown off it so far that it could pass
//! through something unknown stays where it is for the rest of the step, with its new velocity: the next step
//! looks along that. It loses time, but no energy. Its rows are disabled until then
//! (`solver::store::disable`).
//!
//! Rows act on overlap at the end of the substep, so they get the mean velocity, which leads there from where
//! the body really starts; once bodies have moved, the velocity is that after the last impact
//! ([`Restitution::go_on`]).

use super::strike::{Impact, Moving, velocity};
use super::{Link, NONE, Restitution, Spot, Struck, queue};
use crate::body::{ColliderList, Mass, Pose, Traits};
use crate::config::tuning::{BOUNCE_REST_SHARE, CREEP_SHARE};
use crate::lanes::{Record, Sym3};
use crate::shape::Collider;

/// The bodies in a substep.
pub(crate) struct Bodies<'a> {
    /// Velocities of all moving bodies, before acceleration is applied.
    pub(crate) velocity: &'a mut [Record],
    /// Velocities of the substep before any row acted, from which warm starting is counted.
    pub(crate) base: &'a mut [Record],
    /// Displacement since the start of the step.
    pub(crate) delta: &'a mut [Record],
    /// Bodies that are held until the end of the step lose it.
    pub(crate) acceleration: &'a mut [Record],
    pub(crate) inverse_inertia: &'a [Sym3<f32>],
    pub(crate) mass: &'a [Mass],
    pub(crate) traits: &'a [Traits],
    pub(crate) pose: &'a [Pose],
    pub(crate) collider_lists: &'a [ColliderList],
    pub(crate) colliders: &'a [Collider],
    /// Time of the step that has passed and that is left at the start of the substep, and length of the
    /// substep [s].
    pub(crate) done: f32,
    pub(crate) h: f32,
    pub(crate) left: f32,
    /// Approach speeds below this don't bounce [m/s].
    pub(crate) threshold: f32,
    /// Points with a separation up to this take part when another one touches [m].
    pub(crate) together: f32,
}

// Rounding: of the way to a touch.
/// A point that ends a substep nearer than this counts as touching: a share of its displacement, and of
/// `together`.
const SLACK: f32 = 1e-4;
/// Maximum number of impacts of a site in a substep; then it is left to the rows. A ball between two that
/// close in on it bounces without end.
const HITS: u32 = 256;

impl Restitution {
    /// Solves all impacts within the substep. Impulses are added to those of their contacts, where these are
    /// recorded.
    pub(crate) fn meet(&mut self, bodies: &mut Bodies<'_>, impulses: &mut [f32]) {
        for &body in &self.moved {
            let struck = &mut self.struck[body as usize];
            (struck.moved, struck.listed) = (Record::default(), false);
        }
        self.moved.clear();
        for i in 0..self.wakeful.len() {
            self.sites[self.wakeful[i] as usize].hits = 0;
            self.look(self.wakeful[i], 0.0, bodies);
        }
        while let Some(&site) = self.queue.first() {
            let time = self.sites[site as usize].time;
            self.solve(site, time, bodies, impulses);
            self.sites[site as usize].hits += 1;
            for body in self.sites[site as usize].bodies {
                let mut link = self.struck.get(body as usize).map_or(Link::NONE, |struck| struck.first);
                while link.site != NONE {
                    let site = &mut self.sites[link.site as usize];
                    if !site.wakeful {
                        site.wakeful = true;
                        self.wakeful.push(link.site);
                    }
                    let next = site.next[link.side as usize];
                    self.look(link.site, time, bodies);
                    link = next;
                }
            }
        }
        let share = 1.0 / bodies.h;
        for &body in &self.moved {
            let (i, pull) = (body as usize, bodies.pull(body as usize));
            let moved = &mut self.struck[i].moved;
            add(&mut bodies.delta[i], moved, -1.0);
            // Rows see velocities with all of the acceleration, but a body that bounced has fallen by half of
            // that.
            add(moved, &pull, -0.5 * bodies.h * bodies.h);
            add(&mut bodies.velocity[i], moved, share);
            add(&mut bodies.base[i], moved, share);
        }
    }

    /// Gives struck bodies their velocities of the end of the substep, after bodies have moved.
    pub(crate) fn go_on(&self, h: f32, [velocity, base, delta]: [&mut [Record]; 3], acceleration: &[Record]) {
        let share = -1.0 / h;
        for &body in &self.moved {
            let (i, moved) = (body as usize, &self.struck[body as usize].moved);
            if let Some(pull) = acceleration.get(i)
                && velocity[i].linear == base[i].linear
            {
                // No row acted on it, and in that case half of the fall is left out for all bodies.
                delta[i].linear += pull.linear * (0.5 * h * h);
            }
            add(&mut velocity[i], moved, share);
            add(&mut base[i], moved, share);
        }
    }

    /// Finds when a site closes next, from a given time on.
    fn look(&mut self, index: u32, now: f32, bodies: &Bodies<'_>) {
        let site = &mut self.sites[index as usize];
        (site.time, site.approach) = (f32::INFINITY, 0.0);
        if site.hits < HITS {
            let spots = &self.spots[site.first as usize..][..site.count as usize];
            let next = if bodies.will_touch(spots) { bodies.h } else { 0.0 };
            for spot in spots {
                if let Some((time, approach)) = bodies.closing(spot, &self.struck, now, next)
                    && (time < site.time || time == site.time && approach > site.approach)
                {
                    (site.time, site.approach) = (time, approach);
                }
            }
        }
        queue::update(&mut self.queue, &mut self.sites, index);
    }

    /// Solves the impact at all points of a site that touch and approach at a given time.
    fn solve(&mut self, site: u32, time: f32, bodies: &mut Bodies<'_>, impulses: &mut [f32]) {
        let site = &self.sites[site as usize];
        let spots = &self.spots[site.first as usize..][..site.count as usize];
        let of = |body: u32| self.struck.get(body as usize);
        let mut moving = site.bodies.map(|body| Moving::new(bodies, body, of(body), time));
        let mut impact = Impact::new(spots);
        let next = if time >= bodies.h && bodies.will_touch(spots) { bodies.h } else { 0.0 };
        for (i, spot) in spots.iter().enumerate() {
            let approach = -spot.speed(|body| velocity(&moving, bodies, body));
            if approach > 0.0 && bodies.gap(spot, time) <= bodies.together + approach * next {
                impact.add(i, approach, &moving);
            }
        }
        if impact.fastest() <= bodies.threshold {
            // It runs into a body that would not be there any more: it is held too.
            for moving in moving.iter().filter(|moving| moving.body != NONE) {
                self.stand(moving.body, bodies, time);
            }
            return;
        }
        self.count += 1;
        impact.solve(&mut moving, bodies);
        for (slot, impulse) in impact.impulses() {
            if let Some(sum) = impulses.get_mut(slot as usize) {
                *sum += impulse;
            }
        }
        for moving in moving.iter().filter(|moving| moving.body != NONE) {
            let (i, change) = (moving.body as usize, moving.change(&bodies.traits[moving.body as usize]));
            let struck = &mut self.struck[i];
            struck.bounced = true;
            if let Some(rotation) = moving.rotation {
                struck.turned = Some((rotation, bodies.done + time));
            }
            bodies.delta[i].set_touched();
            if struck.stands {
                add(&mut struck.velocity_after, &change, 1.0);
                continue;
            }
            add(&mut bodies.velocity[i], &change, 1.0);
            add(&mut bodies.base[i], &change, 1.0);
            if !struck.joined {
                self.shift(moving.body, bodies, &change, -time);
                if bodies.goes_astray(i, &change, bodies.left - time) {
                    self.stand(moving.body, bodies, time);
                }
            }
        }
    }

    /// Displaces the start of a body's substep by a velocity times `times` seconds.
    fn shift(&mut self, body: u32, bodies: &mut Bodies<'_>, by: &Record, times: f32) {
        let struck = &mut self.struck[body as usize];
        if !std::mem::replace(&mut struck.listed, true) {
            self.moved.push(body);
        }
        add(&mut struck.moved, by, times);
        add(&mut bodies.delta[body as usize], by, times);
    }

    /// Holds a body from a time of the substep to the end of the step, and keeps its velocity for then.
    fn stand(&mut self, body: u32, bodies: &mut Bodies<'_>, time: f32) {
        let (i, struck) = (body as usize, &mut self.struck[body as usize]);
        if struck.stands || struck.joined {
            return;
        }
        let (velocity, pull) = (bodies.velocity[i], bodies.pull(i));
        (struck.stands, struck.velocity_after) = (true, bodies.velocity_at(i, time));
        self.standing.push(body);
        self.shift(body, bodies, &velocity, time);
        self.shift(body, bodies, &pull, 0.5 * time * time);
        add(&mut bodies.velocity[i], &velocity, -1.0);
        add(&mut bodies.base[i], &velocity, -1.0);
        // A held body is not accelerated; events read the acceleration after the step.
        if let Some(own) = bodies.acceleration.get_mut(i) {
            *own = Record::default();
            self.struck[i].pull = pull;
        }
        bodies.delta[i].set_touched();
    }

    /// Gives held bodies their velocities back, at the end of the step.
    pub(crate) fn let_go(&mut self, dt: f32, velocity: &mut [Record], acceleration: &mut [Record]) {
        for &body in &self.standing {
            let struck = &mut self.struck[body as usize];
            add(&mut velocity[body as usize], &struck.velocity_after, 1.0);
            if let Some(own) = acceleration.get_mut(body as usize) {
                *own = struck.pull;
            }
            // It did not turn while it was held.
            struck.turned = struck.turned.map(|(rotation, _)| (rotation, dt));
        }
    }
}

impl Bodies<'_> {
    pub(super) fn velocity_at(&self, body: usize, time: f32) -> Record {
        let (mut v, pull) = (self.velocity[body], self.pull(body));
        v.linear += pull.linear * time;
        v.angular += pull.angular * time;
        v
    }

    fn pull(&self, body: usize) -> Record {
        self.acceleration.get(body).copied().unwrap_or_default()
    }

    /// Separation at a moment of the substep [m].
    fn gap(&self, spot: &Spot, time: f32) -> f32 {
        let [gap, speed, pull] = self.fall(spot);
        gap + (speed + 0.5 * pull * time) * time
    }

    /// Separation, and speed and acceleration of separating, as from the start of the substep.
    fn fall(&self, spot: &Spot) -> [f32; 3] {
        [
            spot.separation + spot.speed(|body| self.delta.get(body).copied().unwrap_or_default()),
            spot.speed(|body| self.velocity.get(body).copied().unwrap_or_default()),
            spot.speed(|body| self.pull(body)),
        ]
    }

    /// Separation at the end of the substep as rows see it, with all of the acceleration [m].
    fn end_gap(&self, spot: &Spot) -> f32 {
        let [gap, speed, pull] = self.fall(spot);
        gap + (speed + pull.min(0.0) * self.h) * self.h
    }

    /// Whether any of some points touches at the end of the substep.
    fn will_touch(&self, spots: &[Spot]) -> bool {
        spots.len() > 1 && spots.iter().any(|spot| self.end_gap(spot) <= self.together)
    }

    /// When a point closes in the rest of the substep, and how fast [m/s], if an impact is due: it is fast
    /// enough to bounce, or one body runs into another that is held.
    ///
    /// `next`: time ahead that is looked at too [s]. Rows of a touching manifold come to rest as a whole, and
    /// would remove the approach of its other points in the next substep, so these bounce at the end of this
    /// one.
    fn closing(&self, spot: &Spot, struck: &[Struck], now: f32, next: f32) -> Option<(f32, f32)> {
        let [whole, speed, pull] = self.fall(spot);
        let gap = whole + (speed + 0.5 * pull * now) * now;
        let speed = speed + pull * now;
        let left = self.h - now;
        let stand = spot.bodies.iter().any(|&body| struck.get(body as usize).is_some_and(|s| s.stands));
        let after = if stand {
            spot.speed(|i| struck.get(i).map_or(Record::default(), |s| s.velocity_after))
        } else {
            0.0
        };
        let mut time = 0.0;
        if gap > 0.0 {
            // To the end of the substep as rows see it, and a little further: points that they would stop
            // must have bounced.
            let end = self.end_gap(spot);
            let rest = end - (end - whole).abs() * SLACK - self.together * BOUNCE_REST_SHARE;
            if rest > 0.0 && rest > -(speed + pull * left) * next {
                return None;
            }
            let root = (speed * speed - 2.0 * pull * gap).max(0.0).sqrt();
            time = 2.0 * gap / (root - speed);
            time = if time >= 0.0 { time.min(left) } else { left };
        }
        let runs = -(speed + pull * time);
        let approach = runs - after;
        // The rows must not push a held body: they do not see its velocity.
        let acts = approach > self.threshold || stand && runs > CREEP_SHARE * self.threshold;
        acts.then_some((now + time, approach.max(runs)))
    }

    /// Whether a change of velocity takes a body so far off its path in some seconds that it could pass
    /// through something: by half of its inner radius.
    fn goes_astray(&self, body: usize, change: &Record, left: f32) -> bool {
        self.collider_lists[body].as_slice().iter().any(|&c| {
            let shape = &self.colliders[c as usize];
            let reach = shape.position.length() + shape.radius;
            (change.linear.length() + change.angular.length() * reach) * left > 0.5 * shape.inner_radius
        })
    }
}

pub(super) fn add(to: &mut Record, what: &Record, times: f32) {
    to.linear += what.linear * times;
    to.angular += what.angular * times;
}
