//! Events of the last step for the caller, and the parts of the step that record them.

use super::World;
use crate::broad_phase::Pair;
use crate::error::Error;
use crate::events::{ContactEnd, ContactEvent, Sensing, SensorEvent, StartOfStep, Touching};
use crate::handle::ShapeHandle;

/// # Events
///
/// Of the last step, for shapes that ask for them.
impl World {
    /// Pairs that began to touch in the last step and of which one shape asks for
    /// [`events`](crate::ShapeDesc::events); sorted by their handles. Shapes that touched and separated again
    /// within the step count as touching, if they were pushed.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// let shape = world.shapes(body)?.next().expect("its cube");
    /// world.set_events(shape, true)?;
    /// let mut landed = 0;
    /// for _ in 0..60 {
    ///     world.step(1.0 / 60.0)?;
    ///     landed += world.contact_begins().len();
    /// }
    /// assert_eq!(landed, 1);
    /// # Ok::<(), Error>(())
    /// ```
    pub fn contact_begins(&self) -> &[ContactEvent] {
        &self.events.begins
    }

    /// Pairs that no longer touch since the last step, or of which a shape was removed while they did.
    pub fn contact_ends(&self) -> &[ContactEnd] {
        &self.events.ends
    }

    /// Pairs that hit each other in the last step, at [`Settings::hit_speed`](crate::Settings::hit_speed) or
    /// faster.
    pub fn contact_hits(&self) -> &[ContactEvent] {
        &self.events.hits
    }

    /// Shapes that entered sensors in the last step, however fast. A shape that crossed one within the step
    /// is here and in [`World::sensor_ends`].
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// let zone = ShapeDesc::new(Geometry::cuboid(3.0, 0.5, 3.0)).as_sensor();
    /// world.add_body(&BodyDesc::fixed().with_position(Vec3::Y * 0.5).with_shape(zone))?;
    /// let mut entered = false;
    /// for _ in 0..60 {
    ///     world.step(1.0 / 60.0)?;
    ///     entered |= !world.sensor_begins().is_empty();
    /// }
    /// assert!(entered);
    /// # Ok::<(), Error>(())
    /// ```
    pub fn sensor_begins(&self) -> &[SensorEvent] {
        &self.events.entered
    }

    /// Shapes that left sensors in the last step, or were removed while they were in one.
    pub fn sensor_ends(&self) -> &[SensorEvent] {
        &self.events.left
    }

    /// Writes the shapes that are in a sensor as of the last step into `into`, in the order of their handles.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn sensor_overlaps(&self, sensor: ShapeHandle, into: &mut Vec<ShapeHandle>) -> Result<(), Error> {
        let collider = self.collider(sensor)?;
        into.clear();
        for pair in self.broad.pairs.iter().chain(self.sleep.sleeping_pairs()).filter(|pair| pair.touching) {
            let other = match collider {
                c if c == pair.a => pair.b,
                c if c == pair.b => pair.a,
                _ => continue,
            };
            into.push(self.shape_handle(other));
        }
        into.sort_unstable();
        Ok(())
    }

    /// A shape no longer asks for events: forgets its touching pairs, unless the other shape asks for them.
    pub(crate) fn forget_touches(&mut self, collider: u32) {
        let summaries = &self.colliders.summaries;
        for pair in self.broad.pairs.iter_mut().filter(|pair| pair.a == collider || pair.b == collider) {
            let [a, b] = [pair.a, pair.b].map(|c| &summaries[c as usize]);
            pair.touching &= a.has_events() || b.has_events() || a.is_sensor() || b.is_sensor();
        }
    }

    /// Records the ends of pairs, if a shape asks for events.
    pub(crate) fn part_pair(&mut self, pair: &Pair) {
        self.events.part(&self.colliders, pair);
    }

    /// Reserves the impulses of contacts, if a shape asks for events.
    pub(crate) fn reserve_impulses(&mut self) {
        let wanted = if self.needs.events > 0 { self.contacts.slots() } else { 0 };
        self.events.impulses.clear();
        if wanted > 0 {
            self.refresh_event_allowance();
        }
        self.events.reserve_impulses(wanted);
    }

    /// Compares the pairs that touch with those that did, and measures impacts.
    pub(crate) fn record_contact_events(&mut self) {
        if self.needs.events == 0 {
            return;
        }
        self.refresh_event_allowance();
        let World { bodies, colliders, buffers, contacts, settings, broad, events, .. } = self;
        let start = StartOfStep { bodies, colliders, forces: &buffers.forces, dt: buffers.dt };
        Touching { start, contacts, settings }.record(&mut broad.pairs, events);
    }

    /// Records the shapes that entered or left sensors in this step.
    pub(crate) fn record_sensor_events(&mut self) {
        if self.needs.sensors == 0 {
            return;
        }
        self.refresh_event_allowance();
        let World { bodies, colliders, settings, broad, events, .. } = self;
        Sensing { bodies, colliders, settings }.record(&mut broad.pairs, events);
    }

    /// Sorts the events of the step.
    pub(crate) fn sort_events(&mut self) {
        self.refresh_event_allowance();
        self.events.finish(self.settings.event_capacity as usize);
    }

    pub(crate) fn start_of_step(&self) -> StartOfStep<'_> {
        let (bodies, colliders, buffers) = (&self.bodies, &self.colliders, &self.buffers);
        StartOfStep { bodies, colliders, forces: &buffers.forces, dt: buffers.dt }
    }
}
