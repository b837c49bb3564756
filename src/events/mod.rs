//! What a caller hears of contacts: begins, ends and hits, what crosses sensors, and hooks that may change contacts before
//! they are solved.
//!
//! Nothing of it costs anything for shapes that don't ask for it ([`ShapeDesc::events`](crate::ShapeDesc::events),
//! [`sensor`](crate::ShapeDesc::sensor), [`hooks`](crate::ShapeDesc::hooks)). Events are those of the last step, in slices
//! that are the same at any number of threads.

mod approach;
mod contacts;
mod sensors;

/// Its example is run with the tests of the documentation.
#[cfg(doctest)]
#[doc = include_str!("../../docs/events.md")]
struct Docs;

pub(crate) use approach::StartOfStep;
pub(crate) use contacts::Touching;
pub(crate) use sensors::Sensing;

use crate::body::Colliders;
use crate::broad_phase::Pair;
use crate::constraint::Tweak;
use crate::handle::{BodyHandle, ShapeHandle};
use crate::memory::{Allowance, buffers, bytes_of};
use glam::{DVec3, Vec3};

/// Two shapes that began to touch, or hit each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactEvent {
    /// The shapes, the one with the lower handle first.
    pub shapes: [ShapeHandle; 2],
    /// Their bodies.
    pub bodies: [BodyHandle; 2],
    /// Midway between the surfaces, where they bore most, at the start of the step [m].
    pub point: DVec3,
    /// Unit, from the first shape to the second.
    pub normal: Vec3,
    /// How fast they came together there before anything was solved [m/s]; negative if they part.
    pub approach_speed: f32,
    /// Normal impulse of the whole step, over all points, as it was solved [N s].
    pub impulse: f32,
}

/// Two shapes that no longer touch. Of a shape that was removed the handles are stale.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ContactEnd {
    /// The shapes, the one with the lower handle first.
    pub shapes: [ShapeHandle; 2],
}

/// A shape that came into a sensor, or left it. Of what was removed the handles are stale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorEvent {
    /// The sensor.
    pub sensor: ShapeHandle,
    /// What crossed its surface.
    pub visitor: ShapeHandle,
    /// When, as a fraction of the step. Who leaves within the step in which it came leaves at 1.
    pub fraction: f32,
}

/// Events of the last step, and what it takes to find them.
#[derive(Debug, Default)]
pub(crate) struct Events {
    pub(crate) begins: Vec<ContactEvent>,
    pub(crate) ends: Vec<ContactEnd>,
    pub(crate) hits: Vec<ContactEvent>,
    pub(crate) entered: Vec<SensorEvent>,
    pub(crate) left: Vec<SensorEvent>,
    /// Pairs that ended while they touched, since the last step.
    gone: Vec<(ShapeHandle, ShapeHandle, bool)>,
    /// Normal impulse of each contact over the step; empty if nobody listens [N s].
    pub(crate) impulses: Vec<f32>,
    /// What hooks said of each contact; empty if there are none.
    pub(crate) tweaks: Vec<Tweak>,
    /// Pairs of colliders that hooks let pass through each other in this step, sorted.
    pub(crate) vetoed: Vec<(u32, u32)>,
    /// Events that there was no room for.
    pub(crate) lost: u32,
    /// Ends between steps that there was no room for.
    missed: u32,
    /// What its buffers may still grow by.
    pub(crate) allowance: Allowance,
}

buffers! { Events { bytes { begins, ends, hits, entered, left, gone, impulses, tweaks, vetoed } } }

impl Events {
    /// Forgets the events of the step before.
    pub(crate) fn start(&mut self) {
        self.begins.clear();
        self.ends.clear();
        self.hits.clear();
        self.entered.clear();
        self.left.clear();
        self.lost = 0;
    }

    /// Forgets all events, and what ended since the last step.
    pub(crate) fn forget(&mut self) {
        self.start();
        self.gone.clear();
        self.missed = 0;
    }

    /// Whether there are any of the last step, or pairs that ended since.
    pub(crate) fn has_any(&self) -> bool {
        !(self.gone.is_empty()
            && self.begins.is_empty()
            && self.ends.is_empty()
            && self.hits.is_empty()
            && self.entered.is_empty()
            && self.left.is_empty())
    }

    /// Nobody listens any more, and there is nothing that was not heard.
    pub(crate) fn release(&mut self) {
        let Events { tweaks, vetoed, lost, .. } = std::mem::take(self);
        *self = Events { tweaks, vetoed, lost, ..Events::default() };
    }

    /// Reserved bytes of what contacts, sensors and hooks take.
    pub(crate) fn parts(&self, contacts: bool) -> [usize; 3] {
        let gone = bytes_of(&self.gone).1;
        let (of_contacts, of_sensors) = if contacts { (gone, 0) } else { (0, gone) };
        let lists = bytes_of(&self.begins).1 + bytes_of(&self.ends).1 + bytes_of(&self.hits).1;
        [
            of_contacts + lists + bytes_of(&self.impulses).1,
            of_sensors + bytes_of(&self.entered).1 + bytes_of(&self.left).1,
            bytes_of(&self.tweaks).1 + bytes_of(&self.vetoed).1,
        ]
    }

    /// Makes place for the impulses of so many contacts; of none if nobody listens.
    pub(crate) fn reserve_impulses(&mut self, contacts: usize) {
        self.impulses.clear();
        let granted = self.allowance.fit(&mut self.impulses, contacts);
        self.impulses.resize(granted, 0.0);
        self.lost += (contacts - granted) as u32;
    }

    /// Notes the end of a pair, if anyone listens to it.
    pub(crate) fn part(&mut self, colliders: &Colliders, pair: &Pair) {
        if pair.touching {
            let [a, b] = [pair.a, pair.b].map(|c| colliders.handle(c));
            let sensor = |c: u32| colliders.summaries[c as usize].is_sensor();
            let gone = if sensor(pair.b) { (b, a, true) } else { (a, b, sensor(pair.a)) };
            self.missed += u32::from(!self.allowance.push(&mut self.gone, gone));
        }
    }

    /// Adds the ends of pairs that are gone, and sorts: the same for all who read whatever the order of pairs.
    pub(crate) fn finish(&mut self, most: usize) {
        let Events { gone, ends, left, lost, missed, allowance, .. } = self;
        *lost += std::mem::take(missed);
        for (a, b, sensor) in gone.drain(..) {
            if sensor {
                push(left, SensorEvent { sensor: a, visitor: b, fraction: 0.0 }, most, (allowance, lost));
            } else {
                push(ends, ContactEnd { shapes: [a.min(b), a.max(b)] }, most, (allowance, lost));
            }
        }
        self.begins.sort_by_key(|event| event.shapes);
        self.hits.sort_by_key(|event| event.shapes);
        self.ends.sort_unstable();
        let order = |event: &SensorEvent| (event.sensor, event.visitor);
        self.entered.sort_by_key(order);
        self.left.sort_by_key(order);
    }
}

fn push<T>(events: &mut Vec<T>, event: T, most: usize, (allowance, lost): (&mut Allowance, &mut u32)) {
    if events.len() >= most || !allowance.push(events, event) {
        *lost += 1;
    }
}
