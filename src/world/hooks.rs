//! Contact hooks: may veto or edit a contact before it is solved.

use super::World;
use crate::constraint::Tweak;
use crate::error::{Error, within};
use crate::events::{Approach, Events, StartOfStep};
use crate::handle::{BodyHandle, ShapeHandle};
use crate::limits;
use crate::narrow_phase::{ContactRef, NO_CONTACT};
use glam::{DVec3, Vec3};

/// Callbacks on contacts, for [`World::step_with`](crate::World::step_with).
///
/// Called for each manifold of a pair of which one shape has [`hooks`](crate::ShapeDesc::hooks), after
/// contacts are found and before anything is solved: by the thread that called the step, one after another,
/// always in the same order. They are [`Sync`] in every build, because a step that
/// is called on a thread of a pool passes through the pool: `parallel` changes nothing for a caller.
pub trait ContactHooks: Sync {
    /// May veto a contact, or change its friction, restitution and surface velocity, for this step.
    fn contact(&self, contact: &mut ContactHook<'_>);
}

/// No hooks.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoHooks;

impl ContactHooks for NoHooks {
    fn contact(&self, _: &mut ContactHook<'_>) {}
}

/// A manifold that is about to be solved, as [`ContactHooks`] see it.
#[derive(Debug)]
pub struct ContactHook<'a> {
    world: &'a World,
    contact: ContactRef<'a>,
    tweak: Tweak,
    vetoed: bool,
}

impl ContactHook<'_> {
    /// The two shapes. The normal points from the first to the second.
    pub fn shapes(&self) -> [ShapeHandle; 2] {
        [self.contact.a, self.contact.b].map(|c| self.world.shape_handle(c))
    }

    /// Their bodies.
    pub fn bodies(&self) -> [BodyHandle; 2] {
        self.indices().map(|i| self.world.handle_of(i))
    }

    /// The user data of the two shapes.
    pub fn user_data(&self) -> [u64; 2] {
        [self.contact.a, self.contact.b].map(|c| self.world.colliders.all[c as usize].user_data)
    }

    /// Which of the two shapes this one is: 0 or 1.
    pub fn side_of(&self, shape: ShapeHandle) -> Option<usize> {
        self.shapes().iter().position(|&s| s == shape)
    }

    /// Unit, from the first shape to the second, in the world.
    pub fn normal(&self) -> Vec3 {
        self.world.colliders.poses[self.contact.a as usize].rotation * self.contact.normal
    }

    /// Positions of the points, midway between the surfaces [m], and the separation there, negative in
    /// overlap [m].
    pub fn points(&self) -> impl Iterator<Item = (DVec3, f32)> + '_ {
        let pose = &self.world.colliders.poses[self.contact.a as usize];
        let place = move |at: Vec3| pose.position + (pose.rotation * at).as_dvec3();
        self.contact.points().iter().map(move |p| (place(p.position), p.separation))
    }

    /// Approach speed of the two at the point where it is greatest [m/s]; negative if they separate.
    pub fn approach_speed(&self) -> f32 {
        let speed = |p| self.start().approach(self.contact, p).speed;
        self.contact.points().iter().map(speed).fold(f32::NEG_INFINITY, f32::max)
    }

    /// The impulse that would stop the approach at its fastest point, if nothing else touched the two [N s]:
    /// an estimate of [`ContactEvent::impulse`](crate::ContactEvent::impulse).
    pub fn estimated_impulse(&self) -> f32 {
        let start = self.start();
        let one = |p| {
            let Approach { normal, position, speed } = start.approach(self.contact, p);
            let mobility: f32 = self.indices().iter().map(|&i| start.mobility(i, position, normal)).sum();
            if mobility > 0.0 { speed.max(0.0) / mobility } else { 0.0 }
        };
        self.contact.points().iter().map(one).fold(0.0, f32::max)
    }

    /// The world at the start of the step, for hooks that decide by poses and velocities.
    pub fn world(&self) -> &World {
        self.world
    }

    /// Vetoes the contact: the two pass through each other in this step, as on a one-way platform.
    pub fn veto(&mut self) {
        self.vetoed = true;
    }

    /// Sets the coefficients of static and of dynamic friction.
    ///
    /// # Errors
    /// If one is negative or not a number.
    pub fn set_friction(&mut self, of_rest: f32, of_motion: f32) -> Result<(), Error> {
        limits::friction("static friction", of_rest)?;
        limits::friction("dynamic friction", of_motion)?;
        self.tweak.friction = [of_rest, of_motion];
        Ok(())
    }

    /// Sets the coefficient of restitution: the share of the approach speed after the impact.
    ///
    /// # Errors
    /// If it is not in 0..=1.
    pub fn set_restitution(&mut self, restitution: f32) -> Result<(), Error> {
        limits::share("restitution", restitution)?;
        self.tweak.restitution = restitution;
        Ok(())
    }

    /// Sets the velocity of the surface of one of the two shapes (0 or 1) in the world [m/s], as of a belt:
    /// friction carries bodies on it along. The part along the normal has no effect.
    ///
    /// # Errors
    /// If a number is not finite, or the side is neither 0 nor 1.
    pub fn set_surface_velocity(&mut self, side: usize, velocity: Vec3) -> Result<(), Error> {
        limits::speed("surface velocity", velocity)?;
        within("side of a contact", side as f32, 0.0, 1.0, "0 or 1")?;
        self.tweak.surface = if side == 1 { velocity } else { -velocity };
        Ok(())
    }

    /// Applies changes that were recorded before.
    #[cfg(feature = "replay")]
    pub(crate) fn say(&mut self, tweak: Tweak, vetoed: bool) {
        (self.tweak, self.vetoed) = (tweak, vetoed);
    }

    fn start(&self) -> StartOfStep<'_> {
        self.world.start_of_step()
    }

    fn indices(&self) -> [usize; 2] {
        [self.contact.a, self.contact.b].map(|c| self.world.colliders.summaries[c as usize].body as usize)
    }
}

impl World {
    /// Calls the hooks for all contacts that ask for them.
    pub(crate) fn ask_hooks(&mut self, hooks: &dyn ContactHooks) {
        self.events.vetoed.clear();
        if self.needs.hooks == 0 {
            self.events.tweaks.clear();
            return;
        }
        self.refresh_event_allowance();
        // The lists stay where their bytes are counted: hooks may ask the world, which takes memory.
        let Events { tweaks, allowance, .. } = &mut self.events;
        tweaks.clear();
        let granted = allowance.fit(tweaks, self.contacts.slots());
        tweaks.resize(granted, Tweak::NONE);
        for place in 0..self.broad.pairs.len() {
            let pair = self.broad.pairs[place];
            let asks = |c: u32| self.colliders.summaries[c as usize].has_hooks();
            let asked = asks(pair.a) || asks(pair.b);
            if pair.contact == NO_CONTACT
                || !asked
                || pair.is_idle(&self.colliders.summaries, self.bodies.dynamic())
            {
                continue;
            }
            let (mut slot, mut passes) = (pair.contact, false);
            while slot != NO_CONTACT {
                let contact = self.contacts.at(slot);
                let next = contact.next;
                if contact.count > 0 {
                    let mut hook = ContactHook { world: self, contact, tweak: Tweak::NONE, vetoed: false };
                    hooks.contact(&mut hook);
                    let (tweak, vetoed) = (hook.tweak, hook.vetoed);
                    #[cfg(feature = "replay")]
                    if let Some(recorder) = &mut self.recorder {
                        recorder.record(tweak, vetoed);
                    }
                    passes |= vetoed;
                    match self.events.tweaks.get_mut(slot as usize) {
                        Some(place) => *place = tweak,
                        // The changes can't be kept.
                        None => self.events.lost += u32::from(!tweak.is_none()),
                    }
                }
                slot = next;
            }
            if passes {
                self.refresh_event_allowance();
            }
            // The guard has to know of a veto, or it would stop the body.
            let Events { vetoed, allowance, .. } = &mut self.events;
            let listed = passes && allowance.push(vetoed, (pair.a.min(pair.b), pair.a.max(pair.b)));
            self.events.lost += u32::from(passes && !listed);
            if listed {
                self.contacts.for_each_of([&pair], |_, contact| (contact.count, contact.pushed) = (0, false));
            }
        }
        self.events.vetoed.sort_unstable();
    }
}
