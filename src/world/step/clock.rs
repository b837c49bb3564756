//! Bookkeeping around the stages of a step: clocks, the name of the current stage, and hashes for recordings.

use crate::clock::Instant;
use crate::constraint::{StepLengths, evenness};
use crate::world::{Demand, Part, PartTimes, Stage, StageTimes, StepCounts, World};

/// The clock of a step, and the features that the step needs.
pub(crate) struct Clock {
    start: Instant,
    /// When the last stage ended.
    last: Instant,
    times: StageTimes,
    pub(crate) demand: Demand,
}

impl Clock {
    /// Runs a stage and adds the time since the last one ended.
    pub(crate) fn stage(&mut self, world: &mut World, stage: Stage, work: impl FnOnce(&mut World)) {
        let (name, time) = match stage {
            Stage::Broad => ("broad", &mut self.times.broad),
            Stage::Narrow | Stage::Hooks => ("narrow", &mut self.times.narrow),
            Stage::Prepare => ("prepare", &mut self.times.prepare),
            Stage::Solve => ("solve", &mut self.times.solve),
            Stage::Finish => ("finish", &mut self.times.finish),
        };
        world.stage = Some(name);
        work(world);
        debug_assert!(stage == Stage::Finish || world.buffers.forces.is_of(&world.bodies), "after {name}");
        world.note_stage(stage);
        let now = Instant::now();
        *time += microseconds(now - self.last);
        self.last = now;
    }
}

fn microseconds(time: std::time::Duration) -> f32 {
    time.as_secs_f32() * 1e6
}

impl World {
    /// Runs a part of a stage. It is timed only if the world needs it.
    pub(crate) fn part<R>(&mut self, part: Part, work: impl FnOnce(&mut World) -> R) -> R {
        let needed = match part {
            Part::Restitution => self.needs.restitution > 0,
            Part::Joints => self.joints.count > 0,
            Part::Sleeping => self.settings.sleeping,
            Part::Events => self.needs.events > 0,
            Part::Sensors => self.needs.sensors > 0,
            Part::Hooks => self.needs.hooks > 0,
        };
        let start = needed.then(Instant::now);
        let done = work(self);
        if let Some(start) = start {
            self.spent[part as usize] += microseconds(start.elapsed());
        }
        done
    }

    /// Begins a step of `dt` seconds: clears the report, and reserves the buffers that the step can't do
    /// without.
    pub(crate) fn begin_step(&mut self, dt: f32) -> Clock {
        self.stage = Some("broad");
        let start = Instant::now();
        let clock = Clock { start, last: start, times: StageTimes::default(), demand: self.demand() };
        self.spent = PartTimes::default();
        #[cfg(debug_assertions)]
        self.buffers.spoil();
        #[cfg(debug_assertions)]
        self.colliders.swings.fill(f32::NAN);
        self.bodies.stop_at_targets();
        self.reserve_for_step();
        self.keep_rest();
        self.events.start();
        self.faults.forget();
        self.sleep.fell_asleep.clear();
        self.buffers.dt = dt;
        clock
    }

    /// Ends a step: completes its report, and allows the next one.
    pub(crate) fn end_step(&mut self, clock: Clock, did: &StepCounts, lengths: StepLengths) {
        let times = StageTimes { step: microseconds(clock.last - clock.start), ..clock.times };
        self.buffers.evenness = evenness(self.buffers.evenness, lengths);
        self.buffers.last_h = lengths.now();
        self.report = self.report_of(times, did);
        (self.sleep.woke, self.sleep.slept) = (0, 0);
        self.note_peaks();
        self.bodies.end_targets();
        self.stage = None;
    }
}
