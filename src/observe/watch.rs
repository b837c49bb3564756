//! Observers of a world's steps.

use super::system::{LaneRows, Sums, System, SystemIsland, Velocity, velocity};
use crate::constraint::ContactLane;
use crate::lanes::Record;
use crate::solver::Witness;
use crate::world::{StepMeter, World};
use std::any::Any;
use std::fmt::Debug;

/// Looks on while a world steps. A step that is observed allocates, and takes a multiple of its time.
pub trait Observer: Any + Debug + Send + Sync {
    /// Called before rows are solved; rows have the impulses that they start with.
    fn before_rows(&mut self, world: &World, system: &System);
    /// Called once they are solved; other impulses and velocities may replace theirs.
    fn after_rows(&mut self, solved: &mut Solved<'_>);
    /// Called once bodies have moved; rows have the impulses that they got.
    fn after_step(&mut self, world: &World, system: &System);
}

/// The solved rows of a step.
#[derive(Debug)]
pub struct Solved<'a> {
    world: &'a mut World,
    /// The rows, with their impulses by the solver.
    pub system: &'a mut System,
    /// Contacts that bounced: their impulses are shared out evenly among their points.
    pub bounced: usize,
}

impl Solved<'_> {
    /// The world within its step.
    pub fn world(&self) -> &World {
        self.world
    }

    /// Gives the bodies of an island other velocities at the end of the step, and others with which they move
    /// within it, in the order of the island; its rows have the impulses that explain them.
    pub fn set_motion(&mut self, island: &SystemIsland, ends: &[Velocity], moving: &[Velocity]) {
        for (&i, (end, moving)) in island.bodies.iter().zip(ends.iter().zip(moving)) {
            let delta = &mut self.world.buffers.solver.delta[i];
            *delta = record(&moving.map(|v| v * self.system.dt));
            delta.set_touched();
            let Record { linear, angular, .. } = record(end);
            let velocity = &mut self.world.bodies.velocity[i];
            (velocity.linear, velocity.angular) = (linear, angular);
            self.world.buffers.restitution.forget(i);
        }
    }

    /// Writes the impulses of the system's rows that were replaced into contacts, for warm starting and for
    /// events; a substep has its share.
    pub fn keep_impulses(&mut self, replaced: &[bool]) {
        let Solved { world, system, .. } = self;
        let share = 1.0 / f64::from(world.settings.substeps);
        let mut rows = std::mem::take(&mut world.buffers.rows);
        let heard = &mut world.events.impulses;
        let mut first = 0;
        let each = &mut |lane: &ContactLane| {
            let own = LaneRows::of(lane);
            let at = first;
            first += own.count();
            if !replaced.get(at).is_some_and(|replaced| *replaced) {
                return None;
            }
            let impulse = |row: usize| (system.rows[at + row].impulse * share) as f32;
            let (mut normals, mut friction) = ([0.0; 4], [0.0; 3]);
            let mut sum = 0.0;
            for (i, normal) in normals.iter_mut().enumerate().take(own.points) {
                *normal = impulse(i);
                sum += system.rows[at + i].impulse;
            }
            for (i, friction) in friction.iter_mut().enumerate().take(own.friction) {
                *friction = impulse(own.points + i);
            }
            let mut rolls = [0.0; 2];
            if own.rolling > 0 {
                // In the world a contact has one twist, of both kinds of friction.
                let (first, reach) = (own.points + own.friction, LaneRows::reach(lane) as f32);
                rolls = [impulse(first) * reach, impulse(first + 1) * reach];
                friction[2] += impulse(first + 2) * reach;
            }
            if let Some(heard) = heard.get_mut(lane.part.slot()) {
                *heard = sum as f32;
            }
            Some((normals, friction, rolls))
        };
        // SAFETY: between stages there is no other thread.
        unsafe { rows.views().replace_impulses(each) };
        world.buffers.rows = rows;
    }
}

fn record([linear, angular]: &Velocity) -> Record {
    Record { linear: linear.as_vec3(), angular: angular.as_vec3(), ..Record::default() }
}

/// An observer, and the data of a step that is kept for it.
#[derive(Debug)]
struct Watch {
    system: System,
    sums: Sums,
    observer: Box<dyn Observer>,
}

/// # Observers
impl World {
    /// Lets an observer look at each step from now on, in place of another one; `None` removes it. It is not
    /// part of snapshots and recordings.
    pub fn observe(&mut self, observer: Option<Box<dyn Observer>>) {
        self.meter = observer.map(|observer| -> Box<dyn StepMeter> {
            Box::new(Watch { system: System::default(), sums: Sums::default(), observer })
        });
    }

    /// The observer of the world.
    pub fn observer(&self) -> Option<&dyn Observer> {
        Some(&*watch(self)?.observer)
    }

    /// The observer of the world.
    pub fn observer_mut(&mut self) -> Option<&mut dyn Observer> {
        let meter: &mut dyn Any = self.meter.as_deref_mut()?;
        Some(&mut *meter.downcast_mut::<Watch>()?.observer)
    }

    /// The rows of the last step as one system with the impulses that they got, if somebody looked.
    pub fn observed(&self) -> Option<&System> {
        Some(&watch(self)?.system)
    }
}

fn watch(world: &World) -> Option<&Watch> {
    let meter: &dyn Any = world.meter.as_deref()?;
    meter.downcast_ref()
}

impl StepMeter for Watch {
    fn witness(&mut self) -> &mut dyn Witness {
        &mut self.sums
    }

    fn before_rows(&mut self, world: &mut World, dt: f32) {
        self.system = System::assemble(world, dt);
        self.sums = Sums::new(world, &self.system);
        world.buffers.rows.guarded = vec![[0.0; 4]; world.contacts.slots()];
        self.observer.before_rows(world, &self.system);
    }

    fn after_rows(&mut self, world: &mut World) {
        let Watch { system, sums, observer } = self;
        let bounced = sums.give(world, system);
        world.buffers.rows.guarded = Vec::new();
        observer.after_rows(&mut Solved { world, system, bounced });
        for (i, body) in system.bodies.iter_mut().enumerate() {
            body.end = velocity(&world.bodies.velocity[i]);
            body.moved = velocity(&world.buffers.solver.delta[i]);
        }
    }

    fn after_step(&mut self, world: &World) {
        self.observer.after_step(world, &self.system);
    }
}
