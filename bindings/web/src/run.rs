//! A world that is run: the way back, and what its ledger says.

use crate::scenes::OFFERS;
use backstop::{Error, JointHandle, Settings, Snapshot, World};
use std::collections::VecDeque;
use std::fmt::Write;

/// Length of a step [s].
const DT: f32 = 1.0 / 60.0;
/// Steps to go back, at most, and the bytes of their snapshots.
const STEPS_BACK: usize = 600;
const BYTES_BACK: usize = 128 << 20;

/// A world, and the snapshots of its last steps.
pub(crate) struct Run {
    pub(crate) world: World,
    pub(crate) joints: Vec<JointHandle>,
    /// Steps since the start.
    steps: u32,
    /// Before each of the last steps.
    past: VecDeque<Snapshot>,
    /// Snapshots whose buffers are used again.
    spare: Vec<Snapshot>,
}

impl Run {
    /// The scene of an index in the page's list.
    pub(crate) fn open(scene: usize, size: u32, settings: &Settings) -> Result<Run, Error> {
        let (world, joints) = OFFERS[scene % OFFERS.len()].world(settings, size)?;
        Ok(Run { world, joints, steps: 0, past: VecDeque::new(), spare: Vec::new() })
    }

    /// Changes what the page's controls can change.
    pub(crate) fn configure(&mut self, substeps: u32, iterations: u32, sleeping: bool) -> Result<(), Error> {
        let now = self.world.settings();
        if (now.substeps, now.iterations, now.sleeping) == (substeps, iterations, sleeping) {
            return Ok(());
        }
        let new = now.clone().with_substeps(substeps).with_iterations(iterations).with_sleeping(sleeping);
        self.world.set_settings(new)
    }

    /// Takes the snapshot that leads back here. Not part of [`Self::step`], whose time is measured.
    pub(crate) fn remember(&mut self) {
        let full = |past: &VecDeque<Snapshot>| {
            past.len() >= STEPS_BACK || past.iter().map(Snapshot::size).sum::<usize>() > BYTES_BACK
        };
        while !self.past.is_empty() && full(&self.past) {
            self.spare.extend(self.past.pop_front());
        }
        let mut snapshot = self.spare.pop().unwrap_or_default();
        self.spare.clear();
        self.world.snapshot(&mut snapshot);
        self.past.push_back(snapshot);
    }

    pub(crate) fn step(&mut self) -> Result<(), Error> {
        self.world.step(DT)?;
        self.steps += 1;
        Ok(())
    }

    /// Back by one step; whether there was one to go back to.
    pub(crate) fn back(&mut self) -> Result<bool, Error> {
        let Some(snapshot) = self.past.pop_back() else { return Ok(false) };
        self.world.restore(&snapshot)?;
        self.spare.push(snapshot);
        self.steps = self.steps.saturating_sub(1);
        Ok(true)
    }

    /// The ledger, as JSON.
    pub(crate) fn report(&self, json: &mut String) {
        let (world, report, settings) = (&self.world, self.world.report(), self.world.settings());
        let _ = write!(
            json,
            r#"{{"steps":{},"time":{},"bodies":{},"joints":{},"asleep":{},"hash":"{:016x}","#,
            self.steps,
            self.steps as f32 * DT,
            world.body_count(),
            world.joint_count(),
            world.sleeping_body_count(),
            world.state_hash(),
        );
        let counts = [
            ("pairs", report.pairs),
            ("manifolds", report.manifolds),
            ("real", report.real),
            ("potential", report.potential),
            ("ghosts", report.ghosts),
            ("held", report.held()),
            ("substeps", settings.substeps),
            ("iterations", settings.iterations),
            ("past", self.past.len() as u32),
        ];
        for (name, count) in counts {
            let _ = write!(json, r#""{name}":{count},"#);
        }
        let bytes: usize = self.past.iter().map(Snapshot::size).sum();
        let _ = write!(json, r#""past_bytes":{bytes},"sleeping":{},"bytes":["#, settings.sleeping);
        for (i, (category, bytes)) in world.memory().iter().enumerate() {
            let comma = if i > 0 { "," } else { "" };
            let name = category.name().replace('_', " ");
            let _ = write!(json, r#"{comma}["{name}",{},{}]"#, bytes.live, bytes.reserved);
        }
        json.push_str("]}");
    }
}
