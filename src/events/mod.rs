//! Events: begin, end and impact of contacts, and shapes that enter or leave sensors.
//!
//! They cost nothing for shapes that don't ask for them ([`ShapeDesc::events`](crate::ShapeDesc::events),
//! [`sensor`](crate::ShapeDesc::sensor), [`hooks`](crate::ShapeDesc::hooks)). Events are those of the last
//! step, in slices that are the same at any number of threads.

mod approach;
mod contacts;
mod save;
mod sensors;

pub(crate) use approach::{Approach, StartOfStep};
pub(crate) use contacts::Touching;
pub(crate) use save::{EventLists, SavedEvents};
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
    /// Midway between the surfaces, at the point with the greatest impulse, at the start of the step [m].
    pub point: DVec3,
    /// Unit, from the first shape to the second.
    pub normal: Vec3,
    /// Approach speed there before anything was solved [m/s]; negative if they separate.
    pub approach_speed: f32,
    /// Normal impulse of the whole step, over all points, as it was solved [N s].
    pub impulse: f32,
}

/// Two shapes that no longer touch. The handles of a removed shape are stale.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ContactEnd {
    /// The shapes, the one with the lower handle first.
    pub shapes: [ShapeHandle; 2],
}

/// A shape that entered a sensor, or left it. The handles of a removed shape are stale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorEvent {
    /// The sensor.
    pub sensor: ShapeHandle,
    /// The shape that crossed its surface.
    pub visitor: ShapeHandle,
    /// Time, as a fraction of the step. A shape that leaves in the step in which it entered leaves at 1.
    pub fraction: f32,
}

/// Events of the last step, and the state that finding them needs.
#[derive(Debug, Default)]
pub(crate) struct Events {
    pub(crate) begins: Vec<ContactEvent>,
    pub(crate) ends: Vec<ContactEnd>,
    pub(crate) hits: Vec<ContactEvent>,
    pub(crate) entered: Vec<SensorEvent>,
    pub(crate) left: Vec<SensorEvent>,
    /// Pairs that ended while they touched, since the last step.
    gone: Vec<Gone>,
    /// Normal impulse of each contact over the step; empty if no shape asks for events [N s].
    pub(crate) impulses: Vec<f32>,
    /// Changes of each contact by hooks; empty if there are none.
    pub(crate) tweaks: Vec<Tweak>,
    /// Pairs of colliders that hooks let pass through each other in this step, sorted.
    pub(crate) vetoed: Vec<(u32, u32)>,
    /// Number of events beyond the capacity.
    pub(crate) lost: u32,
    /// Number of ends between steps beyond the capacity.
    missed: u32,
    /// Bytes by which its buffers may still grow.
    pub(crate) allowance: Allowance,
}

/// A pair that ended while it touched. Of one with a sensor, the sensor comes first.
#[derive(Clone, Copy, Debug)]
struct Gone {
    shapes: [ShapeHandle; 2],
    sensor: bool,
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

    /// Whether there are any of the last step, or pairs that ended since.
    pub(crate) fn has_any(&self) -> bool {
        !(self.gone.is_empty()
            && self.begins.is_empty()
            && self.ends.is_empty()
            && self.hits.is_empty()
            && self.entered.is_empty()
            && self.left.is_empty())
    }

    /// Releases the buffers: no shape asks for events any more, and all of them were read.
    pub(crate) fn release(&mut self) {
        let Events { tweaks, vetoed, lost, .. } = std::mem::take(self);
        *self = Events { tweaks, vetoed, lost, ..Events::default() };
    }

    /// Reserved bytes of contact events, sensors and hooks.
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

    /// Reserves the impulses of so many contacts; none if no shape asks for events.
    pub(crate) fn reserve_impulses(&mut self, contacts: usize) {
        self.impulses.clear();
        let granted = self.allowance.fit(&mut self.impulses, contacts);
        self.impulses.resize(granted, 0.0);
        self.lost += (contacts - granted) as u32;
    }

    /// Records the end of a pair, if one of its shapes asks for events.
    pub(crate) fn part(&mut self, colliders: &Colliders, pair: &Pair) {
        if pair.touching {
            let [a, b] = [pair.a, pair.b].map(|c| colliders.handle(c));
            let sensor = |c: u32| colliders.summaries[c as usize].is_sensor();
            let shapes = if sensor(pair.b) { [b, a] } else { [a, b] };
            let gone = Gone { shapes, sensor: sensor(pair.a) || sensor(pair.b) };
            self.missed += u32::from(!self.allowance.push(&mut self.gone, gone));
        }
    }

    /// Adds the ends of removed pairs, and sorts all lists, so that they do not depend on the order of pairs.
    pub(crate) fn finish(&mut self, most: usize) {
        let Events { gone, ends, left, lost, missed, allowance, .. } = self;
        *lost += std::mem::take(missed);
        for Gone { shapes: [a, b], sensor } in gone.drain(..) {
            if sensor {
                push(left, SensorEvent { sensor: a, visitor: b, fraction: 0.0 }, most, allowance, lost);
            } else {
                push(ends, ContactEnd { shapes: [a.min(b), a.max(b)] }, most, allowance, lost);
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

fn push<T>(events: &mut Vec<T>, event: T, most: usize, allowance: &mut Allowance, lost: &mut u32) {
    if events.len() >= most || !allowance.push(events, event) {
        *lost += 1;
    }
}
