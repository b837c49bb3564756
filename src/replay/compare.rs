//! Where a replay diverges from its recording.

use super::probe::{Seen, Short, Stage, StepRecord};
use crate::error::Error;
use crate::handle::BodyHandle;
use crate::world::World;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// The first difference between a replay and its recording.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Divergence {
    /// Which step, from 1; for a refused call, the step after it.
    pub step: u64,
    /// The first stage with a different result.
    pub stage: Stage,
    /// The first body, in the order of handles, that differs: among those that the caller changed since the
    /// previous step, or if none of them differs, among all after the step.
    pub body: Option<DivergedBody>,
    /// How many bodies differ after the step.
    pub bodies: usize,
    /// A call that was refused although it was not when recorded, with the reason.
    pub refused: Option<(&'static str, Error)>,
    /// [`World::state_hash`] after the step as recorded and as replayed.
    pub hashes: [u64; 2],
}

/// A body that differs from the recording.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct DivergedBody {
    /// Its handle: the same in the recorded run.
    pub handle: BodyHandle,
    /// The caller's number.
    pub user_data: u64,
    /// Its name by [`World::name_recorded`].
    pub name: Option<String>,
}

impl fmt::Display for DivergedBody {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "body {}.{}", self.handle.slot, self.handle.generation)?;
        if let Some(name) = &self.name {
            write!(f, " \"{}\"", crate::error::Escaped(name))?;
        }
        write!(f, " (user data {})", self.user_data)
    }
}

impl fmt::Display for Divergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((call, error)) = &self.refused {
            return write!(f, "before step {} the call {call} is refused: {error}", self.step);
        }
        write!(f, "step {} goes another way in stage {}", self.step, self.stage.name())?;
        match &self.body {
            Some(body) => write!(f, ", first {body}")?,
            None => write!(f, ", and no body shows it")?,
        }
        match self.bodies {
            0 | 1 => Ok(()),
            n => write!(f, ", {n} bodies after it"),
        }
    }
}

/// Names of bodies by slot, and the generation that has it.
pub(super) type Names = BTreeMap<u32, (u32, String)>;

/// Differences between a step as recorded and as seen; `awake`: the recorded slots.
pub(super) fn compare(
    step: u64,
    record: &StepRecord,
    awake: &[u32],
    seen: &Seen,
    world: &World,
    names: &Names,
) -> Option<Divergence> {
    let stage = Stage::HASHED.iter().zip(record.stages.iter().zip(&seen.stages));
    let stage = stage.filter(|(_, (recorded, seen))| recorded != seen).map(|(stage, _)| *stage).next();
    let touched = differing(record.touched.iter().copied(), seen.touched.iter().copied());
    let recorded = awake.iter().copied().zip(record.bodies.iter().copied());
    let bodies = differing(recorded, seen.awake.iter().copied().zip(seen.bodies.iter().copied()));
    let stage = match (stage, touched.first(), bodies.first()) {
        (Some(stage), ..) => stage,
        (None, Some(_), _) => Stage::Forces,
        (None, None, Some(_)) => Stage::Finish,
        (None, None, None) if record.hash != seen.hash => Stage::Finish,
        (None, None, None) => return None,
    };
    let first = touched.first().or(bodies.first()).copied();
    Some(Divergence {
        step,
        stage,
        body: first.and_then(|slot| describe(slot, world, names)),
        bodies: bodies.len(),
        refused: None,
        hashes: [record.hash, seen.hash].map(u64::from_le_bytes),
    })
}

/// Slots that are in one list only, or with another hash; both lists ascend.
fn differing(one: impl Iterator<Item = (u32, Short)>, other: impl Iterator<Item = (u32, Short)>) -> Vec<u32> {
    let (mut one, mut other) = (one.peekable(), other.peekable());
    let mut slots = Vec::new();
    loop {
        let slot = match (one.peek(), other.peek()) {
            (None, None) => return slots,
            (Some(a), None) => a.0,
            (None, Some(b)) => b.0,
            (Some(a), Some(b)) => a.0.min(b.0),
        };
        let (a, b) = (one.next_if(|a| a.0 == slot), other.next_if(|b| b.0 == slot));
        if a != b {
            slots.push(slot);
        }
    }
}

fn describe(slot: u32, world: &World, names: &Names) -> Option<DivergedBody> {
    let (generation, index) = world.bodies.slots.live(slot)?;
    let name = names.get(&slot).filter(|name| name.0 == generation).map(|name| name.1.clone());
    let user_data = world.bodies.details[index as usize].user_data;
    Some(DivergedBody { handle: BodyHandle { slot, generation }, user_data, name })
}
