//! The plugin, and when its systems run.

use crate::hooks::CollisionHooks;
use crate::messages::*;
use crate::world::PhysicsWorld;
use crate::{poses, prepare, report, walk};
use backstop::{Error, Settings, World};
use bevy_app::prelude::*;
use bevy_ecs::intern::Interned;
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleLabel;
use bevy_ecs::system::{SystemParam, SystemParamItem};
use bevy_time::{Fixed, Time};

/// Adds a [`PhysicsWorld`] and the systems that step it, by default in `FixedPostUpdate`, by the length of
/// `Time<Fixed>` and with interpolated transforms. Needs Bevy's `TimePlugin`.
#[derive(Clone, Debug)]
pub struct BackstopPlugin {
    settings: Settings,
    schedule: Interned<dyn ScheduleLabel>,
    step: Option<f32>,
    interpolation: bool,
    extrapolation: bool,
    add_step: fn(&mut App, Interned<dyn ScheduleLabel>),
}

impl Default for BackstopPlugin {
    fn default() -> Self {
        BackstopPlugin {
            settings: Settings::default(),
            schedule: FixedPostUpdate.intern(),
            step: None,
            interpolation: true,
            extrapolation: false,
            add_step: add_step::<()>,
        }
    }
}

impl BackstopPlugin {
    /// With other settings of the world.
    ///
    /// # Errors
    /// If a setting is out of range.
    pub fn new(settings: Settings) -> Result<Self, Error> {
        settings.validate()?;
        Ok(BackstopPlugin { settings, ..BackstopPlugin::default() })
    }
    /// Steps in another schedule: `FixedUpdate`, or one that the game runs itself.
    #[must_use]
    pub fn in_schedule(mut self, schedule: impl ScheduleLabel) -> Self {
        self.schedule = schedule.intern();
        self
    }
    /// Steps of a length of its own, instead of that of `Time<Fixed>` [s]. For schedules that are not of the
    /// fixed ones, whose transforms should not be interpolated either.
    #[must_use]
    pub fn with_step(mut self, seconds: f32) -> Self {
        self.step = Some(seconds);
        self
    }
    /// Puts all transforms ahead of the last step, where velocities lead in the time since, instead of
    /// between the last two: [`Extrapolation`](crate::Extrapolation) for all.
    #[must_use]
    pub fn with_extrapolation(mut self) -> Self {
        self.extrapolation = true;
        self
    }
    /// Calls hooks that read the app on contacts of shapes with [`ContactHooked`](crate::ContactHooked),
    /// before those of the resource [`PhysicsHooks`](crate::PhysicsHooks). They replace others that were
    /// given here.
    #[must_use]
    pub fn with_hooks<H: SystemParam + 'static>(mut self) -> Self
    where
        for<'w, 's> SystemParamItem<'w, 's, H>: CollisionHooks,
    {
        self.add_step = add_step::<H>;
        self
    }
    /// Leaves all transforms as they are after the last step.
    #[must_use]
    pub fn without_interpolation(mut self) -> Self {
        self.interpolation = false;
        self
    }
}

/// What the plugin does in its schedule, one after the other, and in a frame.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PhysicsSystems {
    /// Components that are new or changed reach the world.
    Prepare,
    /// The world is stepped.
    Step,
    /// Characters walk; components and messages say what happened.
    Report,
    /// Transforms are put between the last two steps; in `RunFixedMainLoop`, after the fixed schedules.
    Interpolate,
}

impl Plugin for BackstopPlugin {
    fn build(&self, app: &mut App) {
        let world = match World::new(self.settings.clone()) {
            Ok(world) => world,
            Err(error) => {
                log::error!("there is no physics: {error}");
                return;
            }
        };
        app.insert_resource(PhysicsWorld::new(world)).insert_resource(Step(self.step));
        app.add_message::<ContactBegan>()
            .add_message::<ContactEnded>()
            .add_message::<ContactHit>()
            .add_message::<SensorEntered>()
            .add_message::<SensorLeft>()
            .add_message::<JointBroke>()
            .add_message::<CouplingBroke>()
            .add_message::<JointStrained>()
            .add_message::<BodyWoke>()
            .add_message::<BodyFellAsleep>()
            .add_message::<PhysicsError>();
        #[cfg(feature = "reflect")]
        crate::reflect::register(app);
        app.configure_sets(
            self.schedule,
            (PhysicsSystems::Prepare, PhysicsSystems::Step, PhysicsSystems::Report).chain(),
        );
        let prepare = (
            prepare::find_written,
            prepare::find_changed,
            prepare::change_shapes,
            prepare::add_bodies_and_shapes,
            prepare::change_bodies,
            prepare::read_motion,
            prepare::read_poses,
            walk::sync_characters,
            prepare::sync_joints,
            prepare::sync_couplings,
        );
        let report =
            (report::write_motion, walk::walk, report::write_sleep, report::write_messages, poses::show_last);
        app.add_systems(
            self.schedule,
            (prepare.chain().in_set(PhysicsSystems::Prepare), report.chain().in_set(PhysicsSystems::Report)),
        );
        (self.add_step)(app, self.schedule);
        if self.extrapolation {
            app.insert_resource(poses::AllAhead);
        }
        if self.interpolation {
            app.add_systems(FixedFirst, poses::show_last);
            app.add_systems(
                RunFixedMainLoop,
                poses::interpolate
                    .in_set(PhysicsSystems::Interpolate)
                    .in_set(RunFixedMainLoopSystems::AfterFixedMainLoop),
            );
        }
    }
}

fn add_step<H: SystemParam + 'static>(app: &mut App, schedule: Interned<dyn ScheduleLabel>)
where
    for<'w, 's> SystemParamItem<'w, 's, H>: CollisionHooks,
{
    app.add_systems(schedule, report::step::<H>.in_set(PhysicsSystems::Step));
}

/// The length of steps, if it is not that of `Time<Fixed>` [s].
#[derive(Resource)]
pub(crate) struct Step(Option<f32>);

/// The length of the next step.
#[derive(SystemParam)]
pub(crate) struct StepLength<'w> {
    own: Res<'w, Step>,
    time: Option<Res<'w, Time<Fixed>>>,
}

impl StepLength<'_> {
    /// [s]; zero, which the world refuses, if there is no clock.
    pub(crate) fn seconds(&self) -> f32 {
        let clock = self.time.as_ref().map_or(0.0, |time| time.timestep().as_secs_f32());
        self.own.0.unwrap_or(clock)
    }
}
