//! What the world holds in memory, and what it may.

use super::World;
use crate::body::{BodyDesc, BodyKind};
use crate::broad_phase::Population;
use crate::error::Error;
use crate::joint::More;
use crate::lanes::Record;
use crate::memory::{Buffer, Category, MemoryReport, Room, bytes_of};
use crate::shape::{Geometry, ShapeDesc};

/// How many there are, or will be, of what has an entry in buffers that a step can't do without.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    bodies: usize,
    movers: usize,
    dynamic: usize,
    colliders: Population,
    previous: bool,
    raised: bool,
    /// Whether there are joints.
    joined: bool,
    /// Bytes of compounds' lists and of geometry that the world doesn't have yet.
    lists: usize,
    assets: usize,
}

impl World {
    /// Bytes by category.
    pub fn memory(&self) -> MemoryReport {
        let mut report = MemoryReport::default();
        report.add(Category::Bodies, self.bodies.bytes());
        report.add(Category::Shapes, bytes_of(&self.colliders.all));
        report.add(Category::Shapes, bytes_of(&self.colliders.hot));
        report.add(Category::Shapes, bytes_of(&self.colliders.poses));
        report.add(Category::Shapes, self.colliders.slots.bytes());
        self.assets.bytes().for_each(|(category, bytes)| report.add(category, bytes));
        report.add(Category::BroadPhase, self.broad.bytes());
        report.add(Category::BroadPhase, bytes_of(&self.removed));
        report.add(Category::BroadPhase, self.now.bytes());
        report.add(Category::Manifolds, self.contacts.bytes());
        report.add(Category::Rows, self.buffers.rows.bytes());
        report.add(Category::Continuous, self.broad.continuous_bytes());
        report.add(Category::Continuous, bytes_of(&self.bodies.previous));
        report.add(Category::Joints, self.joints.bytes());
        report.add(Category::Events, self.events.bytes());
        let [islands, kept] = self.sleep.bytes();
        report.add(Category::Bodies, islands);
        report.add(Category::BroadPhase, kept);
        self.buffers.report(&mut report, self.is_continuous());
        let (manifolds, rows) = self.buffers.prepare.ahead_bytes();
        report.shift(Category::Manifolds, Category::Continuous, manifolds);
        report.shift(Category::Rows, Category::Continuous, rows);
        report.keep_peaks(&self.peaks);
        report
    }

    pub(crate) fn note_peaks(&mut self) {
        self.peaks = self.memory();
    }

    /// What a step may still reserve.
    pub(crate) fn room(&self) -> Room {
        self.settings
            .budget
            .map_or(Room::ENDLESS, |budget| Room::new(budget.saturating_sub(self.memory().total())))
    }

    /// Makes place for bodies in all that has an entry for each, including what their steps can't do without, so that
    /// only pairs and contacts are left for a step to do without.
    pub(super) fn make_place(&mut self, descs: &[BodyDesc]) -> Result<(), Error> {
        if self.settings.budget.is_none() {
            return Ok(());
        }
        let shapes = descs.iter().flat_map(|desc| &desc.shapes);
        let mut more = Counts {
            bodies: descs.len(),
            assets: self.assets.cost(shapes.map(|shape| &shape.geometry)),
            ..Counts::default()
        };
        for desc in descs {
            let (moves, pushed) = (desc.kind != BodyKind::Static, desc.kind == BodyKind::Dynamic);
            more.movers += usize::from(moves);
            more.dynamic += usize::from(pushed);
            more.lists += list_bytes(0, desc.shapes.len());
            more.raised |= desc.raised.is_some();
            desc.shapes.iter().for_each(|shape| more.add_shape(desc.kind, shape));
        }
        self.make_place_for(more)
    }

    /// The same for a further shape of a body that has some.
    pub(super) fn make_place_for_shape(
        &mut self,
        kind: BodyKind,
        shape: &ShapeDesc,
        has: usize,
    ) -> Result<(), Error> {
        if self.settings.budget.is_none() {
            return Ok(());
        }
        let mut more = Counts {
            lists: list_bytes(has, has + 1),
            assets: self.assets.cost(std::iter::once(&shape.geometry)),
            ..Counts::default()
        };
        more.add_shape(kind, shape);
        self.make_place_for(more)
    }

    /// Makes place for the order of contacts of raised bodies.
    pub(super) fn make_place_for_raised(&mut self, raised: bool) -> Result<(), Error> {
        if self.settings.budget.is_none() {
            return Ok(());
        }
        self.make_place_for(Counts { raised, ..Counts::default() })
    }

    /// Makes the column of forces, which exists only once one was applied.
    pub(super) fn make_place_for_forces(&mut self) -> Result<(), Error> {
        let (column, bodies) = (&self.bodies.force, self.bodies.len());
        if column.is_empty() {
            let (asked, left) = (column.missing(bodies), self.room().left());
            if asked > left {
                return Err(Error::Budget { category: Category::Bodies, asked, left });
            }
            self.bodies.force.widen(bodies);
            self.bodies.force.resize(bodies, Record::default());
        }
        Ok(())
    }

    /// Makes place for what is there, whether or not the budget allows it: without it there is no step.
    pub(crate) fn make_place_for_step(&mut self) {
        if self.settings.budget.is_some() {
            let counts = self.counts(Counts::default());
            self.each_buffer(counts, &mut |buffer, len| buffer.widen(len));
        }
    }

    fn make_place_for(&mut self, more: Counts) -> Result<(), Error> {
        let left = self.room().left();
        let mut counts = self.counts(more);
        let (rest, mut asked) = (more.lists + more.assets, 0);
        // Place for a quarter more while that takes a small part of what is left, so that bodies added one by one are
        // not all moved each time.
        for ahead in [4, usize::MAX] {
            let wider = counts.with_more(ahead);
            asked = self.lacking(wider);
            if ahead == usize::MAX || asked + rest <= left / 8 {
                counts = wider;
                break;
            }
        }
        if asked + rest > left {
            let category = if more.assets > asked { Category::Meshes } else { Category::Bodies };
            return Err(Error::Budget { category, asked: asked + rest, left });
        }
        if asked > 0 {
            self.each_buffer(counts, &mut |buffer, len| buffer.widen(len));
        }
        Ok(())
    }

    /// Bytes that are missing for so many.
    fn lacking(&mut self, counts: Counts) -> usize {
        let mut bytes = 0;
        self.each_buffer(counts, &mut |buffer, len| bytes += buffer.missing(len));
        bytes
    }

    /// Makes place for a joint: in its columns, in the batches of steps, and in what steps keep of each body that may be
    /// joined.
    pub(super) fn make_place_for_joint(&mut self, more: More) -> Result<(), Error> {
        if self.settings.budget.is_none() {
            return Ok(());
        }
        let counts = self.counts(Counts { joined: true, ..Counts::default() });
        let of_bodies = self.lacking(counts);
        let (asked, left) = (self.joints.missing(more) + of_bodies, self.room().left());
        if asked > left {
            return Err(Error::Budget { category: Category::Joints, asked, left });
        }
        self.each_buffer(counts, &mut |buffer, len| buffer.widen(len));
        // So that joints added one by one are not all moved each time.
        let ahead = self.joints.ahead(more);
        let far = self.joints.missing(ahead) + of_bodies <= left / 8;
        self.joints.widen(if far { ahead } else { more });
        Ok(())
    }

    fn counts(&self, more: Counts) -> Counts {
        let now = self.broad.population();
        let spare = self.colliders.slots.spare();
        Counts {
            bodies: self.bodies.len() + more.bodies,
            // Who sleeps may wake.
            movers: self.bodies.asleep().end + more.movers,
            dynamic: self.bodies.all_dynamic().count() + more.dynamic,
            colliders: Population {
                slots: self.colliders.all.len() + more.colliders.slots.saturating_sub(spare),
                moving: now.moving + more.colliders.moving,
                still: now.still + more.colliders.still,
                endless: now.endless + more.colliders.endless,
            },
            previous: more.previous || self.needs.restitution > 0,
            joined: more.joined || self.joints.count > 0,
            raised: more.raised || self.bodies.raises().next().is_some(),
            ..more
        }
    }

    /// Calls `f` with each buffer that has an entry for each body or collider, and the place that it needs.
    fn each_buffer(&mut self, n: Counts, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        self.bodies.each(n.bodies, n.previous, f);
        let colliders = &mut self.colliders;
        f(&mut colliders.all, n.colliders.slots);
        f(&mut colliders.hot, n.colliders.slots);
        f(&mut colliders.poses, n.colliders.slots);
        colliders.slots.each(n.colliders.slots, f);
        self.broad.each(n.colliders, f);
        let buffers = &mut self.buffers;
        buffers.forces.each((n.movers, n.dynamic), f);
        buffers.broad.each((n.movers, n.colliders.moving), f);
        buffers.prepare.each(n.dynamic, n.raised, f);
        buffers.solver.each(n.movers, f);
        if self.bodies.rests {
            self.sleep.each(n.bodies, n.dynamic, f);
        }
        buffers.finish.each((n.movers, n.dynamic), n.joined, f);
        if self.settings.method.meets_impacts() {
            buffers.impacts.each(n.movers, f);
        }
        if n.joined {
            buffers.joints.each(n.dynamic, f);
        }
    }
}

impl Counts {
    fn add_shape(&mut self, kind: BodyKind, shape: &ShapeDesc) {
        self.colliders.slots += 1;
        *match kind {
            BodyKind::Static => &mut self.colliders.still,
            _ => &mut self.colliders.moving,
        } += 1;
        self.colliders.endless += usize::from(matches!(shape.geometry, Geometry::Plane));
        self.previous |= shape.material.restitution > 0.0;
    }

    /// One in `part` more of each.
    fn with_more(mut self, part: usize) -> Counts {
        let Population { slots, moving, still, endless } = &mut self.colliders;
        let all = [&mut self.bodies, &mut self.movers, &mut self.dynamic, slots, moving, still, endless];
        all.into_iter().for_each(|n| *n += *n / part);
        self
    }
}

/// Bytes that a body's list of colliders grows by, from so many to so many.
fn list_bytes(from: usize, to: usize) -> usize {
    let bytes = |n: usize| if n < 2 { 0 } else { n.next_power_of_two() * size_of::<u32>() };
    bytes(to) - bytes(from)
}
