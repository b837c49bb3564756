//! Couplings of the world: add, remove, read, change.

use crate::error::Error;
use crate::handle::{CouplingHandle, JointHandle};
use crate::joint::{
    CoupledMotion, Coupling, CouplingDesc, JointAdditions, Placed, Term, check_factor, check_loads,
    check_range,
};
use crate::world::{Addition, Change, World};

/// # Couplings: gears, racks, screws, pulleys
impl World {
    /// Adds a coupling.
    ///
    /// # Errors
    /// If a handle is stale, a number out of range, a motion can't be coupled, or the budget does not allow
    /// it.
    pub fn add_coupling(&mut self, desc: &CouplingDesc) -> Result<CouplingHandle, Error> {
        let [a, b] = [self.joint(desc.motions[0].joint)?, self.joint(desc.motions[1].joint)?];
        desc.validate()?;
        self.reserve(Addition::Joints(JointAdditions::of_coupling(), true))?;
        self.note(Change::AddCoupling(desc));
        let term = |joint: u32, of: &CoupledMotion| Term { joint, motion: of.motion, axes: of.axes };
        let terms = [term(a, &desc.motions[0]), term(b, &desc.motions[1])];
        let displacements = [0, 1].map(|i| f64::from(self.displacement_of(&terms[i])));
        let mut coupling = Coupling {
            terms,
            factors: desc.motions.map(|motion| motion.factor),
            range: [0.0; 2],
            strength: desc.break_force,
            user_data: desc.user_data,
            displacements,
            impulse: [0.0; 2],
            lasting_impulse: 0.0,
            load: [0.0; 2],
        };
        coupling.range = desc.range.unwrap_or([coupling.sum(displacements); 2]);
        self.wake_coupled(&coupling);
        self.revisions.moving += 1;
        Ok(self.joints.add_coupling(coupling))
    }

    /// Removes a coupling.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn remove_coupling(&mut self, coupling: CouplingHandle) -> Result<(), Error> {
        let slot = self.coupling_slot(coupling)?;
        self.note(Change::RemoveCoupling(coupling));
        self.drop_coupling(slot);
        Ok(())
    }

    /// Number of couplings.
    pub fn coupling_count(&self) -> usize {
        self.joints.couplings.count
    }

    /// Whether the handle is not stale.
    pub fn contains_coupling(&self, coupling: CouplingHandle) -> bool {
        self.coupling_slot(coupling).is_ok()
    }

    /// The couplings of a joint, in the order of their handles' slots.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn couplings_of(
        &self,
        joint: JointHandle,
    ) -> Result<impl Iterator<Item = CouplingHandle> + '_, Error> {
        let joint = self.joint(joint)?;
        let couplings = &self.joints.couplings;
        let own = couplings.live().filter(move |(_, coupling)| coupling.joints().contains(&joint));
        Ok(own.map(|(slot, _)| couplings.handle(slot)))
    }

    /// Couplings that broke in the last step ([`CouplingDesc::with_break_force`]). Their handles are stale.
    pub fn broken_couplings(&self) -> &[CouplingHandle] {
        &self.joints.couplings.broken
    }

    /// A coupling as [`World::add_coupling`] takes it; its range is the one that it keeps.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn coupling(&self, coupling: CouplingHandle) -> Result<CouplingDesc, Error> {
        let coupling = self.coupling_of(coupling)?;
        let motion = |i: usize| {
            let Term { joint, motion, axes } = coupling.terms[i];
            let joint = JointHandle { slot: joint, generation: self.joints.slots.generation(joint) };
            CoupledMotion { joint, motion, axes, factor: coupling.factors[i] }
        };
        let desc = CouplingDesc::new([motion(0), motion(1)]).with_range(Some(coupling.range));
        Ok(desc.with_break_force(coupling.strength).with_user_data(coupling.user_data))
    }

    /// The displacements of the two motions of a coupling [m] or [rad], angles with the whole turns since it
    /// was added.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn coupling_positions(&self, coupling: CouplingHandle) -> Result<[f64; 2], Error> {
        let coupling = self.coupling_of(coupling)?;
        Ok(self.displacements_of(coupling))
    }

    /// The sum that a coupling keeps within its range: of the two displacements times their factors.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn coupling_sum(&self, coupling: CouplingHandle) -> Result<f64, Error> {
        let coupling = self.coupling_of(coupling)?;
        Ok(coupling.sum(self.displacements_of(coupling)))
    }

    /// Force or torque of a coupling on each of its two motions in the last substep [N] or [N m]: on the
    /// second body of the joint along or about the axis, and the opposite on the first.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn coupling_force(&self, coupling: CouplingHandle) -> Result<[f32; 2], Error> {
        Ok(self.coupling_of(coupling)?.load)
    }

    /// Sets the factors of a coupling where its motions are: shifts a gear. The range is moved with the sum,
    /// so that a rope has as much slack as before. Equal factors wake no body.
    ///
    /// # Errors
    /// If the handle is stale, or a factor or an end of the range is out of its range.
    pub fn set_coupling_factors(&mut self, coupling: CouplingHandle, factors: [f64; 2]) -> Result<(), Error> {
        let slot = self.coupling_slot(coupling)?;
        factors.into_iter().try_for_each(check_factor)?;
        let old = self.joints.couplings.all[slot as usize];
        if old.factors == factors {
            return Ok(());
        }
        let mut new = Coupling { factors, displacements: self.displacements_of(&old), ..old };
        let shift = new.sum(new.displacements) - old.sum(new.displacements);
        new.range = old.range.map(|end| end + shift);
        check_range(new.range)?;
        new.forget();
        self.note(Change::SetCouplingFactors(coupling, factors));
        self.replace_coupling(slot, new);
        Ok(())
    }

    /// Sets the range of the sum of a coupling; `None` keeps the present one.
    ///
    /// # Errors
    /// If the handle is stale or an end out of range.
    pub fn set_coupling_range(
        &mut self,
        coupling: CouplingHandle,
        range: Option<[f64; 2]>,
    ) -> Result<(), Error> {
        let slot = self.coupling_slot(coupling)?;
        range.map_or(Ok(()), check_range)?;
        let old = self.joints.couplings.all[slot as usize];
        let range_now = range.unwrap_or_else(|| [old.sum(self.displacements_of(&old)); 2]);
        if old.range == range_now {
            return Ok(());
        }
        self.note(Change::SetCouplingRange(coupling, range));
        let mut new = Coupling { range: range_now, ..old };
        if new.is_equality() != old.is_equality() {
            new.forget();
        }
        self.replace_coupling(slot, new);
        Ok(())
    }

    /// Sets the force or torque on either motion above which a coupling breaks [N] or [N m]; infinity for
    /// never. An equal one wakes no body.
    ///
    /// # Errors
    /// If the handle is stale or a number is negative.
    pub fn set_coupling_break_force(
        &mut self,
        coupling: CouplingHandle,
        strength: [f32; 2],
    ) -> Result<(), Error> {
        let slot = self.coupling_slot(coupling)?;
        check_loads(["coupling strength"; 2], strength)?;
        let old = self.joints.couplings.all[slot as usize];
        if old.strength == strength {
            return Ok(());
        }
        self.note(Change::SetCouplingBreakForce(coupling, strength));
        self.wake_coupled(&old);
        self.revisions.moving += 1;
        self.joints.couplings.all[slot as usize].strength = strength;
        Ok(())
    }

    /// Sets the caller's number of a coupling.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_coupling_user_data(&mut self, coupling: CouplingHandle, user_data: u64) -> Result<(), Error> {
        let slot = self.coupling_slot(coupling)?;
        self.note(Change::SetCouplingUserData(coupling, user_data));
        self.revisions.moving += 1;
        self.joints.couplings.all[slot as usize].user_data = user_data;
        Ok(())
    }

    /// Removes the couplings whose load exceeded their strength.
    pub(crate) fn break_couplings(&mut self) {
        for slot in 0..self.joints.couplings.all.len() as u32 {
            let coupling = &self.joints.couplings.all[slot as usize];
            if coupling.is_there() && coupling.is_overloaded() {
                let handle = self.joints.couplings.handle(slot);
                self.joints.couplings.broken.push(handle);
                self.drop_coupling(slot);
            }
        }
    }

    fn drop_coupling(&mut self, slot: u32) {
        let old = self.joints.couplings.all[slot as usize];
        self.wake_coupled(&old);
        self.revisions.moving += 1;
        self.joints.remove_coupling(slot);
    }

    /// Replaces a coupling by another one of the same joints. Its rows may be at another place of the order.
    fn replace_coupling(&mut self, slot: u32, new: Coupling) {
        self.wake_coupled(&new);
        self.revisions.moving += 1;
        let old = std::mem::replace(&mut self.joints.couplings.all[slot as usize], new);
        self.joints.changed |= old.is_equality() != new.is_equality();
    }

    fn wake_coupled(&mut self, coupling: &Coupling) {
        for joint in coupling.joints() {
            self.wake_joined(self.joints.all[joint as usize].bodies);
        }
    }

    fn coupling_slot(&self, coupling: CouplingHandle) -> Result<u32, Error> {
        let slot = self.joints.couplings.slots.get(coupling.slot, coupling.generation);
        slot.ok_or(Error::StaleCoupling)
    }

    fn coupling_of(&self, coupling: CouplingHandle) -> Result<&Coupling, Error> {
        Ok(&self.joints.couplings.all[self.coupling_slot(coupling)? as usize])
    }

    /// With whole turns.
    fn displacements_of(&self, coupling: &Coupling) -> [f64; 2] {
        let now = |i: usize| {
            let term = &coupling.terms[i];
            term.unwrapped(self.displacement_of(term), coupling.displacements[i])
        };
        [now(0), now(1)]
    }

    /// Without whole turns.
    fn displacement_of(&self, term: &Term) -> f32 {
        let joint = &self.joints.all[term.joint as usize];
        let poses = self.dense_bodies(joint).map(|body| &self.bodies.pose[body]);
        Placed::new(poses, &joint.frames).displacement(term.motion, term.axes)
    }
}
