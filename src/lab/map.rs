//! The map of some steps, linearised by central differences.

use super::state::Layout;
use super::{ModeBody, Probe, TOLD};
use crate::error::Error;
use crate::snapshot::Snapshot;
use crate::world::World;

/// A copy of a world, where nothing falls asleep.
pub(super) fn copy_of(world: &World, rest: &mut Snapshot) -> Result<World, Error> {
    world.snapshot(rest);
    let mut copy = World::new(world.settings().clone())?;
    copy.restore(rest)?;
    let settings = copy.settings().clone();
    if settings.sleeping {
        copy.set_settings(crate::config::Settings { sleeping: false, ..settings })?;
        copy.snapshot(rest);
    }
    Ok(copy)
}

/// Takes a displacement from rest to what it has become after some steps.
#[derive(Debug)]
pub(super) struct StepMap {
    rest: Snapshot,
    layout: Layout,
    plus: World,
    minus: World,
    dt: f32,
    displacement: f64,
    changed: usize,
}

impl StepMap {
    pub(super) fn new(world: &World, probe: &Probe) -> Result<StepMap, Error> {
        let mut rest = Snapshot::new();
        let mut plus = copy_of(world, &mut rest)?;
        let mut minus = World::new(plus.settings().clone())?;
        minus.restore(&rest)?;
        let layout = Layout::of(&mut plus, probe.dt / world.settings().substeps as f32);
        Ok(StepMap { rest, layout, plus, minus, dt: probe.dt, displacement: probe.displacement, changed: 0 })
    }

    pub(super) fn unknowns(&self) -> usize {
        self.layout.len()
    }

    pub(super) fn changed(&self) -> usize {
        self.changed
    }

    /// The derivative of `steps` steps, times `v`: one world starts at rest plus `v`, another at rest minus
    /// `v`, where `v` is scaled so that its greatest component is `part` of the probe's displacement.
    pub(super) fn apply(&mut self, v: &[f64], steps: u32, part: f64) -> Result<Vec<f64>, Error> {
        let greatest = v.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        if greatest == 0.0 {
            return Ok(vec![0.0; v.len()]);
        }
        let scale = part * self.displacement / greatest;
        for (world, scale) in [(&mut self.plus, scale), (&mut self.minus, -scale)] {
            world.restore(&self.rest)?;
            self.layout.displace(world, v, scale);
            for _ in 0..steps {
                world.step(self.dt)?;
            }
        }
        let (mut out, changed) = self.layout.difference(&mut self.plus, &mut self.minus);
        self.changed = self.changed.max(changed);
        out.iter_mut().for_each(|x| *x /= 2.0 * scale);
        Ok(out)
    }

    pub(super) fn lives(&self, v: &[f64]) -> ([f64; 3], Vec<ModeBody>) {
        self.layout.lives(&self.plus, v, TOLD)
    }
}
