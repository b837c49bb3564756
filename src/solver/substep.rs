//! The parts of a substep before, between and after the passes over its rows.

use super::integrate::{Integrator, WarmStart};
use super::store::{add_impulses, disable};
use super::{PassKind, Passes, Witness};
use crate::body::{BySlot, ColliderList, Mass, Pose, SpeedCap, Traits};
use crate::config::Settings;
use crate::config::tuning::BOUNCE_TOGETHER;
use crate::constraint::contact::crowd::Crowd;
use crate::constraint::{NetInput, Nets, Restitution, Struck, move_by_mean};
use crate::forces::Forces;
use crate::handle::Slots;
use crate::lanes::Record;
use crate::shape::Collider;

/// Properties of bodies that the solver does not change.
pub(super) struct BodyData<'a> {
    pub(super) pose: &'a [Pose],
    pub(super) mass: &'a [Mass],
    pub(super) traits: &'a [Traits],
    /// Greatest speeds by slot, and where bodies are by theirs.
    pub(super) caps: &'a BySlot<SpeedCap>,
    pub(super) slots: &'a Slots,
    pub(super) collider_lists: &'a [ColliderList],
    pub(super) colliders: &'a [Collider],
}

/// Input that all substeps share.
pub(super) struct Context<'a> {
    pub(super) settings: &'a Settings,
    /// Step and substep [s].
    pub(super) dt: f32,
    pub(super) h: f32,
    pub(super) passes: &'a Passes<'a>,
    pub(super) integrator: &'a Integrator<'a>,
    /// Number of velocities: those of movable bodies, and one for all static bodies if there are any.
    pub(super) velocities: usize,
    pub(super) bodies: BodyData<'a>,
}

/// State of the bodies for a single thread.
struct MotionSlices<'a> {
    /// Also of static bodies.
    velocity: &'a mut [Record],
    base: &'a mut [Record],
    delta: &'a mut [Record],
}

impl Context<'_> {
    /// Velocities, displacements, and velocities before any row acted.
    ///
    /// # Safety
    /// No stage runs, and while the slices are used nothing else gets at these records.
    #[inline(always)]
    unsafe fn slices(&self) -> MotionSlices<'_> {
        let (motion, movers) = (self.integrator.motion, self.integrator.movers);
        // SAFETY: by the contract.
        unsafe {
            MotionSlices {
                velocity: motion.velocity.part(0..self.velocities),
                base: motion.base.part(0..movers),
                delta: motion.delta.part(0..movers),
            }
        }
    }

    #[inline(always)]
    fn net_input<'s>(&'s self, acceleration: &'s [Record]) -> NetInput<'s, 's> {
        NetInput {
            views: &self.passes.joints.views,
            stages: self.passes.joints.stages,
            motion: self.integrator.motion,
            pose: self.bodies.pose,
            mass: self.bodies.mass,
            pull: acceleration,
            h: self.h,
            recovery: self.passes.parameters.recovery,
        }
    }
}

/// Whether the energy of joint nets is checked in a substep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NetCheck {
    Off,
    On,
}

/// The substeps of a step, apart from the passes over rows.
pub(super) struct Substeps<'a> {
    pub(super) context: Context<'a>,
    pub(super) forces: &'a mut Forces,
    pub(super) crowd: &'a mut Crowd,
    pub(super) restitution: &'a mut Restitution,
    pub(super) nets: &'a mut Nets,
    pub(super) impulses: &'a mut [f32],
    pub(super) witness: Option<&'a mut dyn Witness>,
}

impl Substeps<'_> {
    /// Solves the impacts of the substep at their times, before the rows.
    #[inline(always)]
    pub(super) fn solve_impacts(&mut self, substep: u32) {
        if self.restitution.is_empty() {
            return;
        }
        let standing = self.restitution.standing().len();
        self.meet_impacts(substep);
        if self.restitution.standing().len() > standing {
            let Context { passes, .. } = &self.context;
            disable(&passes.contacts, passes.motion, &|body| self.restitution.stands(body));
            // SAFETY: between stages this thread is alone.
            let MotionSlices { velocity, base, .. } = unsafe { self.context.slices() };
            self.restitution.standing().iter().for_each(|&i| base[i as usize] = velocity[i as usize]);
        }
        self.outside_rows(Self::limit_speeds);
    }

    fn meet_impacts(&mut self, substep: u32) {
        let Context { settings, h, bodies, .. } = &self.context;
        // SAFETY: between stages this thread is alone.
        let MotionSlices { velocity, base, delta } = unsafe { self.context.slices() };
        let mut struck = Struck {
            velocity,
            base,
            delta,
            acceleration: &mut self.forces.acceleration,
            inverse_inertia: &self.forces.inverse_inertia,
            mass: bodies.mass,
            traits: bodies.traits,
            pose: bodies.pose,
            collider_lists: bodies.collider_lists,
            colliders: bodies.colliders,
            done: h * substep as f32,
            h: *h,
            left: h * (settings.substeps - substep) as f32,
            threshold: settings.measures().bounce_speed,
            together: BOUNCE_TOGETHER * settings.length_unit,
        };
        let Some(witness) = self.witness.as_deref_mut() else {
            return self.restitution.meet(&mut struck, self.impulses);
        };
        witness.before(struck.velocity);
        let mut own = self.impulses.to_vec();
        own.resize(witness.contacts(), 0.0);
        self.restitution.meet(&mut struck, &mut own);
        let old = |i: usize| self.impulses.get(i).copied().unwrap_or(0.0);
        witness.impacts(&mut own.iter().enumerate().map(|(i, new)| new - old(i)));
        let recorded = self.impulses.len();
        self.impulses.copy_from_slice(&own[..recorded]);
        witness.after(struck.velocity);
        witness.stand(self.restitution.standing());
    }

    /// Adds gravity, forces and, from the second substep on, the warm start to velocities. If bodies are
    /// fast, begins to check nets.
    #[inline(always)]
    pub(super) fn integrate_velocities(&mut self, substep: u32) -> NetCheck {
        let acceleration = &self.forces.acceleration;
        if let Some(witness) = self.witness.as_deref_mut() {
            witness.pull(acceleration, self.context.h);
        }
        let warm_start = if substep == 0 { WarmStart::ByRows } else { WarmStart::ByDifference };
        let fast = self.context.integrator.velocities(warm_start, acceleration);
        if fast && self.context.passes.joints.exist() {
            self.begin_nets();
            return NetCheck::On;
        }
        NetCheck::Off
    }

    /// Lets friction follow ground that has turned since the substep before.
    #[inline(always)]
    pub(super) fn carry(&self, substep: u32) {
        let Context { passes, integrator, .. } = &self.context;
        if substep > 0 && passes.has_friction && integrator.ground_turns() {
            passes.carry();
        }
    }

    /// Limits the speed of bodies that overlap several others, and the energy with which nets of joints
    /// move. Returns whether they are checked: bodies may have
    /// become fast by others, or by a spring.
    #[inline(always)]
    pub(super) fn hold_back(&mut self, mut check: NetCheck) -> NetCheck {
        self.outside_rows(|this| {
            this.set_crowd_limits();
            this.limit_crowd();
            this.limit_speeds();
        });
        if self.context.passes.joints.exist() && self.context.integrator.any_fast() && check == NetCheck::Off
        {
            self.begin_nets();
            check = NetCheck::On;
        }
        self.outside_rows(|this| {
            if check == NetCheck::On {
                let fast = this.context.integrator.fast;
                let input = this.context.net_input(&this.forces.acceleration);
                this.nets.hold_back(&input, &|velocity| fast.is_exceeded_by(velocity));
            }
        });
        check
    }

    /// Moves bodies on by the substep. Returns whether all velocities are in range.
    #[inline(always)]
    pub(super) fn integrate_displacements(&self) -> bool {
        let (acceleration, marks) = (&self.forces.acceleration, self.context.passes.contacts.marks);
        let in_range = self.context.integrator.displacements(acceleration);
        if !marks.is_empty() {
            // SAFETY: between stages this thread is alone.
            let MotionSlices { velocity, base, delta } = unsafe { self.context.slices() };
            move_by_mean(marks, velocity, base, delta, acceleration, self.context.h);
        }
        in_range
    }

    /// Gives bodies the velocities after their last impacts; closes joints, and moves trees that conserve
    /// energy.
    #[inline(always)]
    pub(super) fn advance_impacts_and_trees(&mut self) {
        self.outside_rows(|this| {
            let h = &this.context.h;
            if !this.restitution.is_empty() {
                // SAFETY: between stages this thread is alone.
                let MotionSlices { velocity, base, delta } = unsafe { this.context.slices() };
                this.restitution.go_on(*h, [velocity, base, delta], &this.forces.acceleration);
            }
        });
        let Context { passes, settings, .. } = &self.context;
        if !passes.joints.exist() {
            return;
        }
        let slop = settings.measures().slop;
        if let Some(witness) = self.witness.as_deref_mut() {
            witness.trees_move(&passes.joints.views);
        }
        self.outside_rows(|this| this.context.passes.close_joints(slop));
        if let Some(witness) = self.witness.as_deref_mut() {
            let Context { passes, .. } = &self.context;
            // SAFETY: between stages this thread is alone.
            witness.trees_moved(&passes.joints.views, unsafe { self.context.slices() }.velocity);
        }
    }

    /// Gives contacts that pushed before they touched their friction, after rows have relaxed. Returns
    /// whether that shifts much load.
    #[inline(always)]
    pub(super) fn solve_impact_friction(&mut self) -> bool {
        let mut shifts_loads = false;
        if let Some(witness) = self.witness.as_deref_mut() {
            witness.relaxed(&self.context.passes.joints.views);
        }
        if self.context.passes.has_friction {
            self.outside_rows(|this| shifts_loads = this.context.passes.run(PassKind::ImpactFriction));
        }
        shifts_loads
    }

    /// Ends the substep: limits the energy of nets, and the speed of bodies that overlap several others;
    /// records impulses.
    #[inline(always)]
    pub(super) fn end(&mut self, check: NetCheck) {
        self.outside_rows(|this| {
            match check {
                NetCheck::On => this.nets.end(&this.context.net_input(&this.forces.acceleration)),
                NetCheck::Off => this.nets.rest(),
            }
            this.limit_crowd();
            this.limit_speeds();
        });
        if let Some(witness) = self.witness.as_deref_mut() {
            witness.substep(&self.context.passes.contacts, &self.context.passes.joints.views);
        }
        if !self.impulses.is_empty() {
            add_impulses(&self.context.passes.contacts, self.impulses);
        }
    }

    /// Lets bodies that stood after an impact move on, at the end of the step.
    pub(super) fn release_standing_bodies(&mut self) {
        self.outside_rows(|this| {
            // SAFETY: no stage runs.
            let MotionSlices { velocity, .. } = unsafe { this.context.slices() };
            this.restitution.let_go(this.context.dt, velocity, &mut this.forces.acceleration);
        });
    }

    #[cold]
    fn begin_nets(&mut self) {
        let Context { integrator, passes, .. } = &self.context;
        let fast = integrator.fast;
        self.nets.begin(
            &self.context.net_input(&self.forces.acceleration),
            &passes.contacts,
            integrator.dynamic,
            &|velocity| fast.is_exceeded_by(velocity),
        );
    }

    /// Finds the greatest speeds of bodies that overlap several others.
    #[inline(always)]
    fn set_crowd_limits(&mut self) {
        if !self.crowd.is_empty() {
            // SAFETY: between stages this thread is alone.
            let MotionSlices { base, .. } = unsafe { self.context.slices() };
            self.crowd.set_limits(base, self.context.settings.measures().push_speed);
        }
    }

    /// Limits the speed of bodies that overlap several others.
    #[inline(always)]
    fn limit_crowd(&self) {
        if !self.crowd.is_empty() {
            // SAFETY: between stages this thread is alone.
            let MotionSlices { velocity, base, .. } = unsafe { self.context.slices() };
            self.crowd.calm(velocity, base);
        }
    }

    /// Holds capped bodies to their greatest speeds. The velocity before any row acted is changed too, as if
    /// the body had been slower: warm starting must not repeat the change by the cap.
    #[inline(always)]
    fn limit_speeds(&mut self) {
        let BodyData { caps, slots, .. } = self.context.bodies;
        if caps.len() == 0 {
            return;
        }
        let dynamic = self.context.integrator.dynamic;
        // SAFETY: between stages this thread is alone.
        let MotionSlices { velocity, base, .. } = unsafe { self.context.slices() };
        for (slot, cap) in caps.iter() {
            let i = slots.dense(slot) as usize;
            if i >= dynamic {
                continue;
            }
            let (now, held, before) = (velocity[i], cap.hold(velocity[i]), base[i]);
            if held == now {
                continue;
            }
            velocity[i] = held;
            // To the bit the same where no row acted: the body flies free.
            (base[i].linear, base[i].angular) = if before.linear == now.linear
                && before.angular == now.angular
            {
                (held.linear, held.angular)
            } else {
                (before.linear + (held.linear - now.linear), before.angular + (held.angular - now.angular))
            };
        }
    }

    /// Changes velocities by other means than rows, and shows the witness those before and after.
    #[inline(always)]
    fn outside_rows(&mut self, change: impl FnOnce(&mut Self)) {
        if let Some(witness) = self.witness.as_deref_mut() {
            // SAFETY: between stages this thread is alone.
            witness.before(unsafe { self.context.slices() }.velocity);
        }
        change(self);
        if let Some(witness) = self.witness.as_deref_mut() {
            // SAFETY: as above.
            witness.after(unsafe { self.context.slices() }.velocity);
        }
    }
}
