//! Sensors: shapes that push nothing and detect shapes that enter them.
//!
//! A pair with a sensor is a pair like any other, swept where a body is fast, but has no contact. Once bodies
//! have moved, it is checked along their actual paths: a ball that crosses a sensor within a step is seen to
//! enter and to leave.

use super::{Events, SensorEvent, push};
use crate::body::{Bodies, Colliders};
use crate::broad_phase::Pair;
use crate::config::Settings;
use crate::narrow_phase::{
    BodyPath, CastResult, MeshCast, Motion, cast_convex, cast_mesh, tolerance, touches_mesh,
};
use glam::Vec3;

/// Input of sensor events: shapes at the start of the step, and bodies at its end.
pub(crate) struct Sensing<'a> {
    pub(crate) bodies: &'a Bodies,
    pub(crate) colliders: &'a Colliders,
    pub(crate) settings: &'a Settings,
}

impl Sensing<'_> {
    /// Records the shapes that entered or left sensors in this step.
    pub(crate) fn record(&self, pairs: &mut [Pair], events: &mut Events) {
        let most = self.settings.event_capacity as usize;
        for pair in pairs {
            let sensor = |c: u32| self.colliders.summaries[c as usize].is_sensor();
            let (own, visitor) = match (sensor(pair.a), sensor(pair.b)) {
                (true, false) => (pair.a, pair.b),
                (false, true) => (pair.b, pair.a),
                _ => continue,
            };
            let event = |fraction| SensorEvent {
                sensor: self.colliders.handle(own),
                visitor: self.colliders.handle(visitor),
                fraction,
            };
            let inside = self.meet(pair, true).is_some();
            if pair.touching {
                if !inside {
                    push(&mut events.left, event(1.0), most, &mut events.allowance, &mut events.lost);
                }
            } else if let Some(fraction) = self.meet(pair, false).or(inside.then_some(1.0)) {
                push(&mut events.entered, event(fraction), most, &mut events.allowance, &mut events.lost);
                if !inside {
                    push(&mut events.left, event(1.0), most, &mut events.allowance, &mut events.lost);
                }
            }
            pair.touching = inside;
        }
    }

    /// Time at which the two first touch on their paths, if they do; and whether they touch at the end.
    fn meet(&self, pair: &Pair, at_end: bool) -> Option<f32> {
        let [a, b] = [pair.a, pair.b].map(|c| &self.colliders.all[c as usize]);
        let path = |c: u32| if at_end { self.place_now(c) } else { self.way_of(c) };
        let motion = Motion::new(a, &path(pair.a), b, &path(pair.b));
        let close = tolerance(a, b, self.settings.length_unit);
        let touch = match b.kind {
            kind if kind.is_ground() && a.senses_static() => {
                let start = motion.relative(0.0);
                // The cast leaves out triangles that are touched at the start.
                let touches = touches_mesh(a, b, &start, close);
                if touches || at_end {
                    return touches.then_some(0.0);
                }
                match cast_mesh(a, b, &start, &motion, MeshCast::first(close, close), None) {
                    CastResult::First(touch) => Some(touch),
                    CastResult::Near | CastResult::Free => None,
                }
            }
            _ => cast_convex(a, b, &motion, close),
        };
        touch.map(|touch| touch.fraction)
    }

    /// A collider's body at the end of the step, at rest.
    fn place_now(&self, collider: u32) -> BodyPath {
        let pose = &self.bodies.pose[self.colliders.summaries[collider as usize].body as usize];
        BodyPath {
            centre: pose.position,
            rotation: pose.rotation,
            displacement: Vec3::ZERO,
            spin: Vec3::ZERO,
        }
    }

    /// The path of a collider's body.
    fn way_of(&self, collider: u32) -> BodyPath {
        let shape = &self.colliders.all[collider as usize];
        let (end, placed) =
            (&self.bodies.pose[shape.body as usize], &self.colliders.poses[collider as usize]);
        let rotation = (placed.rotation * shape.rotation.conjugate()).normalize();
        let centre = placed.position - (rotation * shape.position).as_dvec3();
        let mut turn = end.rotation * rotation.conjugate();
        if turn.w < 0.0 {
            turn = -turn;
        }
        let part = turn.xyz();
        let sine = part.length();
        let angle = if sine > 0.0 { 2.0 * libm::atan2f(sine, turn.w) / sine } else { 2.0 };
        BodyPath { centre, rotation, displacement: (end.position - centre).as_vec3(), spin: part * angle }
    }
}
