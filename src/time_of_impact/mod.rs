//! Impacts one after the other, each at its time: the methods with which the engine is compared.
//!
//! The input is a step that was solved with discrete contacts: displacements and velocities. The output are
//! poses and velocities as if each impact had been met at its time. A queue holds every touch on the paths of
//! this step. The earliest is taken out, both bodies are moved to that time, the impact is solved
//! ([`impulse`]), and for the rest of the step they move on with their new velocities: sub-steps of the two
//! colliding bodies, not of the world. Their new paths are searched for touches, and touches on the old ones
//! become invalid. A body that was redirected too often stands still for the rest of the step, and so loses
//! that time.
//!
//! Pairs that may touch are those of the broad phase; for a new path its trees are queried again. All but the
//! first search is done by one thread, in the order of times and then of indices, so the result never depends
//! on threads.
//!
//! Known weaknesses, kept because such methods have them: a sub-stepped limb leaves the limbs that it is
//! joined to behind, and its joint opens; hooks and events cover only the contacts of the start of the step;
//! sleeping bodies are struck as if they were static, and woken by the next step.

mod first_touch;
mod impulse;
mod queue;
mod strike;
mod track;

use crate::body::{Bodies, Colliders};
use crate::broad_phase::{Aabb, BroadPhase, Pair, STACK, SearchSet, aabb_of};
use crate::config::tuning::IMPACT_TOLERANCE;
use crate::config::{ContinuousMethod, ContinuousMode, Settings};
use crate::forces::Forces;
use crate::joint::Joints;
use crate::lanes::Record;
use crate::memory::{Allowance, buffers};
use crate::narrow_phase::{MeshScratch, RawManifold, Touch};
use crate::threads::{Shared, Workers, per_block};
use first_touch::{NEVER, first_touch};
use glam::Vec3;
use queue::{Hit, Queue};
use track::Track;
pub(crate) use track::Way;

/// Counts of a step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Impacts {
    /// Number of impacts that were solved at their times.
    pub(crate) struck: u32,
    /// Number of bodies that lost the rest of the step.
    pub(crate) stood: u32,
    /// Number of touches beyond the capacity, and of triangles or points of impacts with meshes.
    pub(crate) shed: u32,
}

/// Parameters of a method.
#[derive(Clone, Copy, Debug)]
struct Rules {
    /// Sweeps are straight, with the rotations of the end of the step.
    linear: bool,
    /// How often a body may be redirected.
    most: u32,
}

impl Rules {
    fn of(settings: &Settings) -> Option<Rules> {
        match settings.continuous_method {
            _ if settings.continuous == ContinuousMode::Discrete => None,
            // As many as in Box2D.
            ContinuousMethod::LinearCast => Some(Rules { linear: true, most: 8 }),
            ContinuousMethod::ConservativeAdvancement => Some(Rules { linear: false, most: 64 }),
            _ => None,
        }
    }
}

/// Buffers of one step.
#[derive(Debug, Default)]
pub(crate) struct Buffers {
    /// For each movable body: its track, or `NONE`.
    track_of: Vec<u32>,
    tracks: Vec<Track>,
    queue: Queue,
    /// For each pair: when it first touches; beyond the step if it doesn't.
    times: Vec<Touch>,
    stack: Vec<u32>,
    /// Colliders near a path.
    near: Vec<u32>,
    /// Points of an impact with a mesh or height field.
    manifolds: Vec<RawManifold>,
    mesh: MeshScratch,
}

buffers! {
    Buffers {
        /// Those that have an entry for each body that can move, and the stack.
        each(movers: usize) { track_of(movers), tracks(movers), stack(STACK) }
        bytes { queue, times, near, manifolds, mesh }
    }
}

impl Buffers {
    #[cfg(debug_assertions)]
    pub(crate) fn spoil(&mut self) {
        use crate::memory::spoil;
        let Buffers { track_of, tracks, queue: _, times, stack, near, manifolds, mesh: _ } = self;
        [track_of, stack, near].into_iter().for_each(spoil);
        spoil(tracks);
        spoil(times);
        spoil(manifolds);
    }
}

const NONE: u32 = u32::MAX;
/// Pairs in a block of work.
const BLOCK: usize = per_block(32, 1);

/// The solved step: bodies at its end, and the colliders that may be struck.
pub(crate) struct Solved<'a> {
    pub(crate) bodies: &'a mut Bodies,
    /// With the poses of the start of the step.
    pub(crate) colliders: &'a Colliders,
    pub(crate) broad: &'a BroadPhase,
    pub(crate) joints: &'a Joints,
    pub(crate) forces: &'a Forces,
    /// Displacement [m] and rotation vector [rad] of each movable body.
    pub(crate) delta: &'a [Record],
    /// Pairs that hooks let pass through each other, sorted.
    pub(crate) vetoed: &'a [(u32, u32)],
    pub(crate) settings: &'a Settings,
    /// Length of the step [s].
    pub(crate) dt: f32,
}

/// Whether a method solves impacts one by one.
pub(crate) fn meets_impacts(settings: &Settings) -> bool {
    Rules::of(settings).is_some()
}

/// Solves the impacts of a step whose bodies are at its end, if the method asks for that. `allowance`: bytes
/// by which buffers may grow. Also returns the bodies that were stopped because an impact left them no
/// position or velocity in range.
pub(crate) fn meet_impacts(
    workers: &Workers<'_>,
    on: &mut Solved<'_>,
    buffers: &mut Buffers,
    allowance: Allowance,
) -> (Impacts, Vec<u32>) {
    let Some(rules) = Rules::of(on.settings) else { return Default::default() };
    let (dt, stopped) = (on.dt, Vec::new());
    let mut run = Run { dt, on, buffers, rules, allowance, impacts: Impacts::default(), stopped };
    run.find_first(workers);
    while let Some(hit) = run.buffers.queue.pop() {
        run.strike(&hit);
    }
    (run.impacts, run.stopped)
}

/// State while the impacts of a step are solved.
struct Run<'a, 'b> {
    on: &'a mut Solved<'b>,
    buffers: &'a mut Buffers,
    rules: Rules,
    dt: f32,
    allowance: Allowance,
    impacts: Impacts,
    stopped: Vec<u32>,
}

impl Run<'_, '_> {
    /// Fills the queue with the touches on the paths of the step.
    fn find_first(&mut self, workers: &Workers<'_>) {
        let movers = self.on.bodies.movers();
        let Buffers { track_of, tracks, queue, times, .. } = &mut *self.buffers;
        track_of.clear();
        track_of.resize(movers, NONE);
        tracks.clear();
        queue.clear();
        times.clear();
        self.find_strays();
        let redirected = self.buffers.tracks.len();
        let count = self.on.broad.pairs.len();
        if redirected == 0 && !self.on.broad.pairs.iter().any(|pair| pair.fast) {
            return;
        }
        let mut times = std::mem::take(&mut self.buffers.times);
        let place = self.allowance.fit(&mut times, count).min(count);
        self.impacts.shed += (count - place) as u32;
        times.resize(place, NEVER);
        {
            let (out, this) = (Shared::new(&mut times), self.view());
            workers.run(place.div_ceil(BLOCK), &|block| {
                for i in block * BLOCK..((block + 1) * BLOCK).min(place) {
                    let pair = &this.on.broad.pairs[i];
                    if pair.fast && !this.is_tracked(pair) && this.may_strike(pair.a, pair.b) {
                        // SAFETY: each pair is in one block.
                        unsafe { *out.get(i) = this.touch(pair.a, pair.b, 0.0) };
                    }
                }
            });
        }
        for (i, touch) in times.iter().enumerate().filter(|(_, touch)| touch.fraction <= 1.0) {
            let Pair { a, b, .. } = self.on.broad.pairs[i];
            self.push(Hit { touch: *touch, a, b, turns: [0; 2] });
        }
        self.buffers.times = times;
        for track in 0..redirected {
            self.search(track, 0.0);
        }
    }

    /// Makes tracks for bodies that leave the path that the broad phase checked, because something pushed
    /// them.
    fn find_strays(&mut self) {
        let (margin, linear) = (self.on.settings.measures().margin, self.rules.linear);
        for i in 0..self.on.bodies.dynamic() {
            let on = &*self.on;
            let (went, meant) = (&on.delta[i], &on.forces.motion[i]);
            let aside = (went.linear - meant.linear).length();
            let turned = if linear { 0.0 } else { (went.angular - meant.angular).length() };
            if aside + turned == 0.0
                || on.settings.continuous.of(on.bodies.traits[i].continuous) == ContinuousMode::Discrete
            {
                continue;
            }
            let own = on.bodies.colliders[i].as_slice();
            let far = own.iter().any(|&c| {
                let summaries = &on.colliders.summaries[c as usize];
                let least = on.colliders.all[c as usize].inner_radius;
                let swing = (summaries.lever + summaries.radius) * turned.min(2.0);
                // A body that hardly moves passes through nothing.
                let moves =
                    went.linear.length() + (summaries.lever + summaries.radius) * went.angular.length();
                aside + swing > margin && moves > 0.5 * least
            });
            if far {
                self.track(i);
            }
        }
    }

    /// The track of a movable body; created if there is none.
    fn track(&mut self, body: usize) -> usize {
        let known = self.buffers.track_of[body];
        if known != NONE {
            return known as usize;
        }
        let way = self.view().way(body);
        let free = body < self.on.bodies.dynamic() && !self.on.delta[body].is_touched();
        // If nothing accelerates bodies, there is no such column.
        let pull = self.on.forces.acceleration.get(body).filter(|_| free);
        let pull = pull.map_or(Vec3::ZERO, |pull| pull.linear);
        self.buffers.tracks.push(Track { body: body as u32, way, pull, turns: 0, stands: false });
        self.buffers.track_of[body] = self.buffers.tracks.len() as u32 - 1;
        self.buffers.tracks.len() - 1
    }

    /// Adds the touches on a body's path from a moment on.
    fn search(&mut self, track: usize, since: f32) {
        if since >= 1.0 {
            return;
        }
        let (body, way) = (self.buffers.tracks[track].body as usize, self.buffers.tracks[track].way);
        let count = self.on.bodies.colliders[body].as_slice().len();
        let mut near = std::mem::take(&mut self.buffers.near);
        let mut stack = std::mem::take(&mut self.buffers.stack);
        for k in 0..count {
            let c = self.on.bodies.colliders[body].as_slice()[k];
            if self.on.colliders.summaries[c as usize].is_sensor() {
                continue;
            }
            let bounds = self.view().bounds(c, &way, since);
            near.clear();
            let (allowance, shed) = (&mut self.allowance, &mut self.impacts.shed);
            self.on.broad.in_box(&mut stack, SearchSet::All, &bounds, |other| {
                *shed += u32::from(!allowance.push(&mut near, other));
            });
            // In an order that does not depend on the shape of a tree.
            near.sort_unstable();
            for &other in &near {
                // Redirected bodies are not where the tree has them.
                let of = self.on.colliders.summaries[other as usize].body as usize;
                if self.buffers.track_of.get(of).is_none_or(|&track| track == NONE) {
                    self.try_pair(c, other, since);
                }
            }
            for other in 0..self.buffers.tracks.len() {
                let Track { body: of, way, .. } = self.buffers.tracks[other];
                for j in 0..self.on.bodies.colliders[of as usize].as_slice().len() {
                    let d = self.on.bodies.colliders[of as usize].as_slice()[j];
                    if other != track && self.view().bounds(d, &way, since).overlaps(&bounds) {
                        self.try_pair(c, d, since);
                    }
                }
            }
        }
        (self.buffers.near, self.buffers.stack) = (near, stack);
    }

    fn try_pair(&mut self, one: u32, other: u32, since: f32) {
        let view = self.view();
        if !view.may_strike(one, other) {
            return;
        }
        let key = |c: u32| (view.on.colliders.summaries[c as usize].kind, c);
        let (a, b) = if key(one) <= key(other) { (one, other) } else { (other, one) };
        let touch = view.touch(a, b, since);
        let turns = [a, b].map(|c| view.turns(c));
        if touch.fraction <= 1.0 {
            self.push(Hit { touch, a, b, turns });
        }
    }

    fn push(&mut self, hit: Hit) {
        if !self.buffers.queue.push(hit, &mut self.allowance) {
            self.impacts.shed += 1;
        }
    }

    fn view(&self) -> View<'_> {
        View {
            on: self.on,
            track_of: &self.buffers.track_of,
            tracks: &self.buffers.tracks,
            rules: self.rules,
        }
    }
}

/// Input of searches.
struct View<'a> {
    on: &'a Solved<'a>,
    track_of: &'a [u32],
    tracks: &'a [Track],
    rules: Rules,
}

impl View<'_> {
    fn track_of(&self, body: usize) -> Option<&Track> {
        self.track_of.get(body).and_then(|&track| self.tracks.get(track as usize))
    }

    fn is_tracked(&self, pair: &Pair) -> bool {
        let of = |c: u32| self.on.colliders.summaries[c as usize].body as usize;
        self.track_of(of(pair.a)).is_some() || self.track_of(of(pair.b)).is_some()
    }

    /// How often the body of a collider was redirected.
    fn turns(&self, collider: u32) -> u32 {
        self.track_of(self.on.colliders.summaries[collider as usize].body as usize)
            .map_or(0, |track| track.turns)
    }

    /// Whether an impact of two colliders would be solved.
    fn may_strike(&self, a: u32, b: u32) -> bool {
        let Solved { bodies, colliders, joints, settings, vetoed, .. } = self.on;
        let [x, y] = [a, b].map(|c| &colliders.summaries[c as usize]);
        let (i, k) = (x.body as usize, y.body as usize);
        let dynamic = bodies.dynamic();
        let filter = |c: u32| &colliders.all[c as usize].filter;
        let there = |i: usize| i < bodies.movers() || !bodies.traits[i].disabled;
        i != k
            && (i < dynamic || k < dynamic)
            && there(i)
            && there(k)
            && !x.is_sensor()
            && !y.is_sensor()
            && settings.continuous.of(x.mode.max(y.mode)) != ContinuousMode::Discrete
            && filter(a).allows(filter(b))
            && !joints.keep_apart(bodies.slot[i], bodies.slot[k])
            && (vetoed.is_empty() || vetoed.binary_search(&(a.min(b), a.max(b))).is_err())
    }

    /// The path of a body, as far as it is known.
    fn way(&self, body: usize) -> Way {
        let pose = &self.on.bodies.pose[body];
        if let Some(track) = self.track_of(body) {
            return track.way;
        }
        let own = self.on.bodies.colliders[body].as_slice().first();
        let Some(&c) = own.filter(|_| body < self.on.bodies.movers()) else { return Way::still(pose) };
        let (shape, placed) = (&self.on.colliders.all[c as usize], &self.on.colliders.poses[c as usize]);
        let turned = self.on.delta[body].angular;
        let way = Way::taken(shape, placed, pose, turned);
        if self.rules.linear { Way { rotation: pose.rotation, spin: Vec3::ZERO, ..way } } else { way }
    }

    /// When two colliders first touch if nothing else happens after a moment.
    fn touch(&self, a: u32, b: u32, since: f32) -> Touch {
        let shape = |c: u32| &self.on.colliders.all[c as usize];
        let path = |c: u32| self.way(shape(c).body as usize).rest(since);
        let turns = self.turns(a).max(self.turns(b));
        let share = if self.rules.linear { IMPACT_TOLERANCE } else { tightness(turns) };
        let measures = self.on.settings.measures();
        let touch = first_touch(shape(a), &path(a), shape(b), &path(b), share, measures);
        touch.map_or(NEVER, |touch| Touch { fraction: since + touch.fraction * (1.0 - since), ..touch })
    }

    /// Bounds of a collider on the rest of a path.
    fn bounds(&self, collider: u32, way: &Way, since: f32) -> Aabb {
        let shape = &self.on.colliders.all[collider as usize];
        let rest = way.rest(since);
        let (from, to) = (aabb_of(shape, rest.centre, rest.rotation), {
            let end = way.at(1.0);
            aabb_of(shape, end.position, end.rotation)
        });
        let arm = shape.position.length() + if shape.radius.is_finite() { shape.radius } else { 0.0 };
        let swing = Vec3::splat((rest.spin.length() * arm).min(2.0 * arm));
        Aabb { min: from.min.min(to.min) - swing, max: from.max.max(to.max) + swing }
    }
}

/// The same for a pair whose bodies were redirected already. Bodies that touched once in a step are a little
/// nearer than the tolerance; so that they can touch again, it shrinks each time, by less than a search may
/// fall short of it.
fn tightness(turns: u32) -> f32 {
    (0..turns.min(12)).fold(IMPACT_TOLERANCE, |share, _| share * 0.4)
}
