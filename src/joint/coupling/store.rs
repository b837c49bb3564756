//! The couplings of a world, and their snapshots.

use super::{Coupling, NONE, Term, check_factor, check_range};
use crate::error::Error;
use crate::handle::{CouplingHandle, Slots};
use crate::joint::desc::{axes_code, axes_of};
use crate::joint::motion::{Axes, Motion};
use crate::limits::MAX_LOAD;
use crate::memory::{buffers, bytes_of};
use crate::words::{Reader, all_loads, are_free, broken, record, words};

/// All couplings.
#[derive(Debug, Default)]
pub(crate) struct Couplings {
    pub(crate) slots: Slots,
    pub(crate) all: Vec<Coupling>,
    /// How many there are.
    pub(crate) count: usize,
    /// Those that broke in the last step.
    pub(crate) broken: Vec<CouplingHandle>,
}

buffers! { Couplings { each(n: usize) { all(n), slots(n), broken(n) } } }

impl Couplings {
    pub(crate) fn handle(&self, slot: u32) -> CouplingHandle {
        CouplingHandle { slot, generation: self.slots.generation(slot) }
    }

    /// Those that are there, with their slots.
    pub(crate) fn live(&self) -> impl Iterator<Item = (u32, &Coupling)> {
        (0..).zip(&self.all).filter(|(_, coupling)| coupling.is_there())
    }

    pub(crate) fn add(&mut self, coupling: Coupling) -> CouplingHandle {
        let (slot, generation) = self.slots.place(coupling, &mut self.all);
        self.count += 1;
        CouplingHandle { slot, generation }
    }

    pub(crate) fn remove(&mut self, slot: u32) {
        self.all[slot as usize].terms.iter_mut().for_each(|term| term.joint = NONE);
        self.slots.remove(slot);
        self.count -= 1;
    }

    /// Removes those of a joint.
    pub(crate) fn remove_of(&mut self, joint: u32) {
        if self.count > 0 {
            for slot in 0..self.all.len() {
                if self.all[slot].is_there() && self.all[slot].joints().contains(&joint) {
                    self.remove(slot as u32);
                }
            }
        }
    }

    /// Couplings whose loads are NaN or out of range begin the next step without them.
    pub(crate) fn forget_unsound(&mut self) {
        for coupling in &mut self.all {
            let ([low, high], [a, b]) = (coupling.impulse, coupling.load);
            let loads = [low, high, coupling.lasting_impulse, a, b];
            if !loads.iter().all(|load| load.abs() <= MAX_LOAD) {
                coupling.forget();
            }
        }
    }

    /// Number of slots beyond those that so many more can use again.
    pub(crate) fn slots_for(&self, more: usize) -> usize {
        self.all.len() + more.saturating_sub(self.slots.spare())
    }

    /// Reserved bytes.
    pub(crate) fn reserved(&self) -> usize {
        if self.count > 0 { self.bytes().1 } else { bytes_of(&self.broken).1 }
    }

    /// Writes the state that changes from step to step.
    pub(crate) fn save(&self, out: &mut Vec<u32>) -> u32 {
        for coupling in &self.all {
            out.extend_from_slice(&words::<4>(coupling.displacements));
            let ([low, high], [a, b]) = (coupling.impulse, coupling.load);
            out.extend_from_slice(&words::<5>([low, high, coupling.lasting_impulse, a, b]));
        }
        self.all.len() as u32
    }

    /// Restores the output of [`Couplings::save`].
    pub(crate) fn restore(&mut self, saved: &SavedCouplings<'_>) {
        for (coupling, words) in self.all.iter_mut().zip(saved.0.as_chunks::<STATE>().0) {
            coupling.displacements = record::<_, 4>(&words[..4]);
            let [low, high, lasting_impulse, a, b]: [f32; 5] = record::<_, 5>(&words[4..]);
            (coupling.impulse, coupling.lasting_impulse, coupling.load) =
                ([low, high], lasting_impulse, [a, b]);
        }
        self.broken.clear();
    }

    /// Writes the definitions of couplings.
    pub(crate) fn save_all(&self, out: &mut Vec<u32>) {
        out.push(self.all.len() as u32);
        for (slot, coupling) in self.all.iter().enumerate() {
            out.extend(coupling.joints());
            if !coupling.is_there() {
                continue;
            }
            out.push(self.slots.generation(slot as u32));
            for Term { motion, axes, .. } in coupling.terms {
                out.push(motion as u32 | axes_code(axes) << 4);
            }
            out.extend_from_slice(&words::<4>(coupling.factors));
            out.extend_from_slice(&words::<4>(coupling.range));
            out.extend(coupling.strength.map(f32::to_bits));
            out.extend_from_slice(&words::<2>(coupling.user_data));
        }
        self.slots.save_free(out);
    }

    /// Replaces all couplings.
    pub(crate) fn restore_all(&mut self, records: &CouplingRecords) {
        self.all.clone_from(&records.all);
        let taken = || (0u32..).zip(&records.all).filter(|(_, coupling)| coupling.is_there());
        self.count = taken().count();
        let taken = taken().map(|(slot, _)| (slot, records.generations[slot as usize], slot));
        self.slots.rebuild(records.all.len(), taken, &records.free);
    }
}

// Guard: a billion seconds at the greatest speed.
/// Largest displacement of a coupled motion, with whole turns [m] or [rad].
pub(crate) const MAX_DISPLACEMENT: f64 = 1e15;

/// Words of a coupling in a state.
const STATE: usize = 9;

/// State of couplings that changes from step to step, as words.
#[derive(Clone, Copy)]
pub(crate) struct SavedCouplings<'a>(&'a [u32]);

impl<'a> SavedCouplings<'a> {
    pub(crate) fn read(from: &mut Reader<'a>, count: u32) -> Result<SavedCouplings<'a>, Error> {
        Ok(SavedCouplings(from.table(count, STATE)?))
    }

    /// Whether there are as many as the world will have, each with numbers that a step can begin with.
    pub(crate) fn check(&self, records: &CouplingRecords) -> Result<(), Error> {
        let saved = self.0.as_chunks::<STATE>().0;
        if saved.len() != records.all.len() {
            return Err(broken("the number of couplings"));
        }
        for words in saved {
            let displacements: [f64; 2] = record::<_, 4>(&words[..4]);
            all_loads(&words[4..])?;
            if !displacements.iter().all(|x| x.abs() <= MAX_DISPLACEMENT) {
                return Err(broken("a coupling"));
            }
        }
        Ok(())
    }
}

/// All couplings of a snapshot.
#[derive(Debug, Default)]
pub(crate) struct CouplingRecords {
    all: Vec<Coupling>,
    generations: Vec<u32>,
    free: Vec<(u32, u32)>,
}

impl CouplingRecords {
    /// Number of slots.
    pub(crate) fn len(&self) -> usize {
        self.all.len()
    }

    /// Slots of the joints of each coupling.
    pub(crate) fn joints(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.all.iter().filter(|coupling| coupling.is_there()).map(Coupling::joints)
    }

    /// Reads the output of [`Couplings::save_all`]. `exists`: whether there is a joint.
    pub(crate) fn read(from: &mut Reader<'_>, exists: impl Fn(u32) -> bool) -> Result<Self, Error> {
        let count = from.one()?;
        let mut records = CouplingRecords::default();
        for _ in 0..count {
            let joints: [u32; 2] = from.record::<_, 2>()?;
            let gone = joints == [NONE; 2];
            let (coupling, generation) = if gone { (NOTHING, 0) } else { read_one(from, joints)? };
            if !gone && !joints.iter().all(|&joint| exists(joint)) {
                return Err(broken("a coupling"));
            }
            records.all.push(coupling);
            records.generations.push(generation);
        }
        records.free = from.free_slots()?;
        let dead = (0u32..).zip(&records.all).filter(|(_, one)| !one.is_there()).map(|(slot, _)| slot);
        if are_free(&records.free, dead) { Ok(records) } else { Err(broken("a list of couplings")) }
    }
}

/// A coupling that was removed.
const NOTHING: Coupling = Coupling {
    terms: [Term { joint: NONE, motion: Motion::Linear, axes: Axes::All }; 2],
    factors: [1.0; 2],
    range: [0.0; 2],
    strength: [f32::INFINITY; 2],
    user_data: 0,
    displacements: [0.0; 2],
    impulse: [0.0; 2],
    lasting_impulse: 0.0,
    load: [0.0; 2],
};

fn read_one(from: &mut Reader<'_>, joints: [u32; 2]) -> Result<(Coupling, u32), Error> {
    let generation = from.one()?;
    let mut coupling = NOTHING;
    for (term, joint) in coupling.terms.iter_mut().zip(joints) {
        let code = from.one()?;
        let motion = [Motion::Linear, Motion::Angular].into_iter().nth((code & 15) as usize);
        let motion = motion.ok_or_else(|| broken("a coupled motion"))?;
        let axes = axes_of(code >> 4).ok_or_else(|| broken("a coupled motion"))?;
        if motion == Motion::Angular && !matches!(axes, Axes::One(_)) {
            return Err(broken("a coupled motion"));
        }
        *term = Term { joint, motion, axes };
    }
    coupling.factors = from.record::<_, 4>()?;
    coupling.range = from.record::<_, 4>()?;
    coupling.strength = from.record::<_, 2>()?;
    coupling.user_data = from.long()?;
    coupling.factors.into_iter().try_for_each(check_factor)?;
    check_range(coupling.range)?;
    let [a, b] = coupling.terms;
    if a == b || !coupling.strength.iter().all(|strength| *strength >= 0.0) {
        return Err(broken("a coupling"));
    }
    Ok((coupling, generation))
}
