//! One impact: its points, its impulses, and the new paths of the two bodies.

use super::impulse::{self, Law, Point, resolve};
use super::queue::Hit;
use super::track::Way;
use super::{Buffers, Run};
use crate::body::{Pose, carry_spin, exp_map};
use crate::constraint::ImpactBody;
use crate::finish::is_in_range;
use crate::forces::spins_freely;
use crate::lanes::Record;
use crate::limits::MAX_LEFT_SPEED;
use crate::narrow_phase::{RawManifold, Reach, Relative, collide_convex, collide_mesh};
use glam::Vec3;

impl Run<'_, '_> {
    /// Solves an impact, if both bodies are still on the paths that lead to it.
    pub(super) fn strike(&mut self, hit: &Hit) {
        let view = self.view();
        if [hit.a, hit.b].map(|c| view.turns(c)) != hit.turns {
            return;
        }
        let of = |c: u32| self.on.colliders.summaries[c as usize].body as usize;
        let (i, k) = (of(hit.a), of(hit.b));
        let dynamic = self.on.bodies.dynamic();
        let tracks = [i, k].map(|body| (body < self.on.bodies.movers()).then(|| self.track(body)));
        let goes = |run: &Self, side: usize| {
            tracks[side].is_some_and(|t| [i, k][side] < dynamic && !run.buffers.tracks[t].stands)
        };
        if !goes(self, 0) && !goes(self, 1) {
            // A kinematic body runs over one that lost the rest of the step: the next step's contacts handle
            // it.
            return;
        }
        self.impacts.struck += 1;
        let time = hit.touch.fraction;
        let ends = [i, k].map(|body| self.on.bodies.pose[body]);
        for (body, track) in [i, k].into_iter().zip(tracks) {
            if let Some(track) = track {
                self.on.bodies.pose[body] = self.buffers.tracks[track].way.at(time);
            }
        }
        let (points, count, part) = self.points(hit, [i, k]);
        let mut a = self.struck(i, tracks[0], time, &ends[0]);
        let mut b = self.struck(k, tracks[1], time, &ends[1]);
        let before = [a.velocity.angular, b.velocity.angular];
        let [x, y] = [hit.a, hit.b].map(|c| &self.on.colliders.all[c as usize]);
        let (x, y) = (&x.material, &y.surface(part));
        let law = Law {
            friction: x.friction_with(y).1,
            restitution: x.restitution_with(y),
            threshold: self.on.settings.measures().bounce_speed,
        };
        let met = resolve(&mut a, &mut b, &points[..count], law);
        let (parting, normal) = met.unwrap_or((0.0, hit.touch.normal));
        for (side, (body, struck)) in [(i, a), (k, b)].into_iter().enumerate() {
            let Some(track) = tracks[side] else { continue };
            if body >= dynamic {
                // A kinematic body moves on.
                self.on.bodies.pose[body] = ends[side];
                continue;
            }
            // A body that rests against the other one is not accelerated into it.
            let into = if side == 0 { normal } else { -normal };
            let pull = &mut self.buffers.tracks[track].pull;
            if parting <= law.threshold {
                *pull -= into * pull.dot(into).max(0.0);
            }
            self.send(body, track, time, struck.velocity, before[side]);
        }
        for side in 0..2 {
            if let Some(track) = tracks[side].filter(|_| [i, k][side] < dynamic) {
                self.search(track, time);
            }
        }
    }

    /// State of a body in an impact, at its current pose; `end`: its pose at the end of the step.
    fn struck(&self, body: usize, track: Option<usize>, time: f32, end: &Pose) -> ImpactBody {
        let bodies = &self.on.bodies;
        let Some(track) = track else { return ImpactBody::default() };
        if body >= bodies.dynamic() {
            return ImpactBody { velocity: bodies.velocity[body], ..ImpactBody::default() };
        }
        let mut velocity = self.buffers.tracks[track].velocity_at(&bodies.velocity[body], time, self.dt);
        velocity.angular = self.carried(body, end, &bodies.pose[body], velocity.angular);
        ImpactBody { velocity, ..ImpactBody::now(bodies, body) }
    }

    /// The spin of a body that turns freely from one pose to another.
    fn carried(&self, body: usize, from: &Pose, to: &Pose, spin: Vec3) -> Vec3 {
        let bodies = &self.on.bodies;
        if self.rules.linear || !spins_freely(&bodies.mass[body], &bodies.traits[body], spin, self.dt) {
            return spin;
        }
        carry_spin(from.rotation, to.rotation, spin, bodies.mass[body].inertia)
    }

    /// Moves a body on from its current pose with the velocity after the impact.
    fn send(&mut self, body: usize, track: usize, time: f32, velocity: Record, spin_before: Vec3) {
        let left = (1.0 - time) * self.dt;
        let (linear, most) = (self.rules.linear, self.rules.most);
        let mut velocity = velocity;
        self.on.bodies.traits[body].lock(&mut velocity);
        if self.on.bodies.rare.caps.len() > 0 {
            velocity = self.on.bodies.rare.cap(self.on.bodies.slot[body]).hold(velocity);
        }
        let place = track;
        let track = &mut self.buffers.tracks[place];
        let mut pose = self.on.bodies.pose[body];
        if !track.stands {
            track.turns += 1;
            track.stands = track.turns >= most;
            self.impacts.stood += u32::from(track.stands);
        }
        track.way = Way { since: time, ..Way::still(&pose) };
        if !track.stands {
            track.way.displacement = velocity.linear * left + track.pull * (0.5 * left * left);
            if linear {
                // It turned for the whole step before it was swept: only the difference remains.
                pose.rotation =
                    (exp_map((velocity.angular - spin_before) * left) * pose.rotation).normalize();
                track.way.rotation = pose.rotation;
            } else {
                track.way.spin = velocity.angular * left;
            }
        }
        velocity.linear += track.pull * left;
        let mut end = track.way.at(1.0);
        velocity.angular = self.carried(body, &pose, &end, velocity.angular);
        if !is_in_range(&end) || !velocity.is_within(MAX_LEFT_SPEED) {
            // The impact of bodies at the limits of speed and mass is out of range: this one stands.
            let at = self.on.bodies.pose[body];
            let way = Way { since: time, ..Way::still(&at) };
            (self.buffers.tracks[place].stands, self.buffers.tracks[place].way) = (true, way);
            (end, velocity) = (at, Record::default());
            if !self.stopped.contains(&(body as u32)) {
                self.stopped.push(body as u32);
            }
        }
        self.on.bodies.pose[body] = end;
        let record = &mut self.on.bodies.velocity[body];
        (record.linear, record.angular) = (velocity.linear, velocity.angular);
    }

    /// Contact points of two colliders, with their bodies at their current poses; their number; and the
    /// material that the second one has at the deepest.
    fn points(&mut self, hit: &Hit, bodies: [usize; 2]) -> ([Point; impulse::MAX_POINTS], usize, u8) {
        let on = &*self.on;
        let [a, b] = [hit.a, hit.b].map(|c| &on.colliders.all[c as usize]);
        let [pose_a, pose_b] = bodies.map(|i| on.bodies.pose[i]);
        let (at_a, at_b) = (pose_a.of_part(a.position, a.rotation), pose_b.of_part(b.position, b.rotation));
        let back = at_a.rotation.conjugate();
        let rel = Relative {
            position: back * (at_b.position - at_a.position).as_vec3(),
            rotation: back * at_b.rotation,
        };
        let margin = on.settings.measures().touch;
        let Buffers { manifolds, mesh, .. } = &mut *self.buffers;
        let one: [RawManifold; 1];
        let manifolds = if b.kind.is_ground() {
            manifolds.clear();
            mesh.allowance = self.allowance;
            mesh.nearby.forget();
            collide_mesh(a, b, &rel, Reach::new(margin), mesh, manifolds);
            self.allowance = mesh.allowance;
            mesh.allowance = crate::memory::Allowance::ENDLESS;
            self.impacts.shed += std::mem::take(&mut mesh.shed);
            &manifolds[..]
        } else {
            one = [collide_convex(a, b, &rel, margin)];
            &one
        };
        let mut points = [Point::default(); impulse::MAX_POINTS];
        let mut count = 0;
        let from_centre = (at_a.position - pose_a.position).as_vec3();
        let apart = (pose_a.position - pose_b.position).as_vec3();
        let mut add = |normal: Vec3, position: Vec3| {
            if let Some(point) = points.get_mut(count) {
                let arm = from_centre + at_a.rotation * position;
                *point = Point { normal, arms: [arm, arm + apart] };
                count += 1;
            }
        };
        for raw in manifolds.iter() {
            raw.points().iter().for_each(|p| add(at_a.rotation * raw.normal, p.position));
        }
        if manifolds.iter().all(|raw| raw.count == 0) {
            // The kernel finds no contact where the search for the time found a touch: use the result of the
            // search.
            let normal = hit.touch.normal;
            let along = back * normal;
            let shape = a.geometry.support();
            let tip = shape.map_or(Vec3::ZERO, |s| {
                (s.support(along.as_dvec3()) + along.as_dvec3() * s.radius).as_vec3()
            });
            add(normal, tip);
        }
        (points, count, manifolds.first().map_or(0, |raw| raw.material as u8))
    }
}
