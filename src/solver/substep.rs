//! The order of a substep: impacts, velocities, rows, displacements, relaxing.

use super::integrate::{Integrator, WarmStart};
use super::pass::{PassKind, Passes};
use super::store::{add_impulses, disable};
use super::{Witness, closing};
use crate::body::{ColliderList, Mass, Pose, Traits};
use crate::config::Settings;
use crate::config::tuning::BOUNCE_TOGETHER;
use crate::constraint::contact::crowd::Crowd;
use crate::constraint::{NetInput, Nets, Restitution, Struck};
use crate::forces::Forces;
use crate::lanes::Record;
use crate::shape::Collider;

/// Properties of bodies that the solver does not change.
pub(super) struct BodyData<'a> {
    pub(super) pose: &'a [Pose],
    pub(super) mass: &'a [Mass],
    pub(super) traits: &'a [Traits],
    pub(super) collider_lists: &'a [ColliderList],
    pub(super) colliders: &'a [Collider],
}

/// Input that all substeps share.
pub(super) struct Context<'a> {
    pub(super) settings: &'a Settings,
    /// Step and substep [s].
    pub(super) dt: f32,
    pub(super) h: f32,
    pub(super) passes: Passes<'a>,
    pub(super) integrator: Integrator<'a>,
    /// Number of velocities: those of movable bodies, and one for all static bodies if there are any.
    pub(super) velocities: usize,
    pub(super) bodies: BodyData<'a>,
    pub(super) crowd: &'a Crowd,
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
enum NetCheck {
    Off,
    On,
}

/// The substeps of a step.
pub(super) struct Substeps<'a> {
    pub(super) context: Context<'a>,
    pub(super) forces: &'a mut Forces,
    pub(super) restitution: &'a mut Restitution,
    pub(super) nets: &'a mut Nets,
    pub(super) impulses: &'a mut [f32],
    pub(super) witness: Option<&'a mut dyn Witness>,
}

impl Substeps<'_> {
    /// Returns whether all velocities are in range.
    #[inline(always)]
    pub(super) fn run(&mut self, substep: u32) -> bool {
        self.solve_impacts(substep);
        let mut check = self.integrate_velocities(substep);
        self.solve_rows(substep);
        check = self.hold_back_nets(check);
        let in_range = self.context.integrator.displacements(&self.forces.acceleration);
        self.advance_impacts_and_trees();
        self.relax();
        self.end_nets(check);
        if let Some(witness) = self.witness.as_deref_mut() {
            witness.substep(&self.context.passes.batches, &self.context.passes.joints.views);
        }
        if !self.impulses.is_empty() {
            add_impulses(&self.context.passes.batches, self.impulses);
        }
        in_range
    }

    /// Solves the impacts of the substep at their times, before the rows.
    #[inline(always)]
    fn solve_impacts(&mut self, substep: u32) {
        if self.restitution.is_empty() {
            return;
        }
        let standing = self.restitution.standing().len();
        self.meet_impacts(substep);
        if self.restitution.standing().len() > standing {
            let Context { passes, .. } = &self.context;
            disable(&passes.batches, passes.motion, &|body| self.restitution.stands(body));
            // SAFETY: between stages this thread is alone.
            let MotionSlices { velocity, base, .. } = unsafe { self.context.slices() };
            self.restitution.standing().iter().for_each(|&i| base[i as usize] = velocity[i as usize]);
        }
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
            threshold: settings.restitution_threshold * settings.length_unit,
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
    }

    /// Adds gravity, forces and, from the second substep on, the warm start to velocities. If bodies are
    /// fast, begins to check nets.
    #[inline(always)]
    fn integrate_velocities(&mut self, substep: u32) -> NetCheck {
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

    /// Applies the impulses of the last step, in the first substep, and iterates over the rows.
    #[inline(always)]
    fn solve_rows(&mut self, substep: u32) {
        let Context { passes, settings, .. } = &self.context;
        if substep == 0 {
            passes.run(PassKind::WarmStart);
        }
        if passes.joints.exist() {
            passes.predict();
        }
        for _ in 0..settings.iterations {
            passes.run(PassKind::Solve);
        }
        self.outside_rows(|this| this.limit_crowd());
    }

    /// Limits the energy with which nets of joints move. Returns whether they are checked: bodies may have
    /// become fast by others, or by a spring.
    #[inline(always)]
    fn hold_back_nets(&mut self, mut check: NetCheck) -> NetCheck {
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

    /// Gives bodies the velocities after their last impacts; closes joints, and moves trees that conserve
    /// energy.
    #[inline(always)]
    fn advance_impacts_and_trees(&mut self) {
        self.outside_rows(|this| {
            let Context { passes, settings, h, .. } = &this.context;
            if !this.restitution.is_empty() {
                // SAFETY: between stages this thread is alone.
                let MotionSlices { velocity, base, delta } = unsafe { this.context.slices() };
                this.restitution.go_on(*h, [velocity, base, delta], &this.forces.acceleration);
            }
            if passes.joints.exist() {
                passes.close_joints(&closing(settings));
            }
        });
    }

    /// Removes from velocities what pushing overlap apart added to them. Contacts that pushed before they
    /// touched get their friction now; if that shifts much load, the points share it in one more pass.
    #[inline(always)]
    fn relax(&mut self) {
        let potential_points_push = self.context.passes.run(PassKind::Relax);
        if potential_points_push && self.context.passes.has_friction {
            let mut shifts_loads = false;
            self.outside_rows(|this| shifts_loads = this.context.passes.run(PassKind::ImpactFriction));
            if shifts_loads {
                self.context.passes.run(PassKind::Relax);
            }
        }
    }

    /// Limits the energy of nets, and the speed of bodies that overlap several others, at the end of the
    /// substep.
    #[inline(always)]
    fn end_nets(&mut self, check: NetCheck) {
        self.outside_rows(|this| {
            match check {
                NetCheck::On => this.nets.end(&this.context.net_input(&this.forces.acceleration)),
                NetCheck::Off => this.nets.rest(),
            }
            this.limit_crowd();
        });
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
            &passes.batches,
            integrator.dynamic,
            &|velocity| fast.is_exceeded_by(velocity),
        );
    }

    /// Limits the speed of bodies that overlap several others.
    #[inline(always)]
    fn limit_crowd(&mut self) {
        let Context { crowd, settings, .. } = &self.context;
        if !crowd.is_empty() {
            // SAFETY: between stages this thread is alone.
            let MotionSlices { velocity, base, .. } = unsafe { self.context.slices() };
            crowd.calm(velocity, base, settings.push_speed * settings.length_unit);
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
