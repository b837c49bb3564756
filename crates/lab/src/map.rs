//! The map of some steps, linearised by central differences.

use super::{ModeBody, Probe, TOLD};
use backstop::Error;
use backstop::Snapshot;
use backstop::World;
use backstop::observe::{BODY_VARIABLES, StateLayout};
use glam::DVec3;

/// A copy of a world, where nothing falls asleep.
pub(super) fn copy_of(world: &World, rest: &mut Snapshot) -> Result<World, Error> {
    world.snapshot(rest);
    let mut copy = World::new(world.settings().clone())?;
    copy.restore(rest)?;
    let settings = copy.settings().clone();
    if settings.sleeping {
        copy.set_settings(settings.with_sleeping(false))?;
        copy.snapshot(rest);
    }
    Ok(copy)
}

/// Maps a displacement from rest to the displacement after some steps.
#[derive(Debug)]
pub(super) struct StepMap {
    rest: Snapshot,
    layout: StateLayout,
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
        let layout = StateLayout::of(&mut plus, probe.dt / world.settings().substeps as f32);
        Ok(StepMap { rest, layout, plus, minus, dt: probe.dt, displacement: probe.displacement, changed: 0 })
    }

    pub(super) fn unknowns(&self) -> usize {
        self.layout.variables()
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

    /// Shares of the displacement of bodies across gravity, along it and by turning, and those that are
    /// displaced most.
    pub(super) fn lives(&self, v: &[f64]) -> ([f64; 3], Vec<ModeBody>) {
        let bodies = self.layout.bodies(&self.plus);
        let down = self.plus.settings().gravity.as_dvec3().normalize_or(DVec3::NEG_Y);
        let mut shares = [0.0; 3];
        let (chunks, _) = v[..BODY_VARIABLES * bodies.len()].as_chunks::<BODY_VARIABLES>();
        let mut all: Vec<ModeBody> = Vec::with_capacity(bodies.len());
        for (&body, d) in bodies.iter().zip(chunks) {
            let [linear, angular] = [0, 3].map(|k| DVec3::new(d[k], d[k + 1], d[k + 2]));
            let along = linear.dot(down);
            shares[0] += (linear - down * along).length_squared();
            shares[1] += along * along;
            shares[2] += angular.length_squared();
            all.push(ModeBody { body, linear, angular });
        }
        let sum: f64 = shares.iter().sum();
        let size = |b: &ModeBody| b.linear.length().max(b.angular.length());
        all.sort_by(|a, b| size(b).total_cmp(&size(a)));
        all.truncate(TOLD);
        let greatest = all.first().map_or(0.0, size);
        for body in all.iter_mut().filter(|_| greatest > 0.0) {
            (body.linear, body.angular) = (body.linear / greatest, body.angular / greatest);
        }
        (if sum > 0.0 { shares.map(|s| s / sum) } else { shares }, all)
    }
}
