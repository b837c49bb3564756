//! Buffers that stages pass on to each other.

use crate::constraint::{JointRows, PrepareScratch, Restitution, Rows};
use crate::forces::Forces;
use crate::memory::{Category, MemoryReport, bytes_of};
use crate::narrow_phase::Scratch;
use crate::statics::Statics;
use crate::{finish, movers, solver, time_of_impact};

/// Kept from step to step, so that a step allocates nothing.
#[derive(Debug, Default)]
pub(crate) struct Buffers {
    pub(crate) forces: Forces,
    pub(crate) broad: movers::Buffers,
    pub(crate) narrow: Scratch,
    pub(crate) restitution: Restitution,
    pub(crate) prepare: PrepareScratch,
    pub(crate) rows: Rows,
    pub(crate) joints: JointRows,
    pub(crate) statics: Statics,
    pub(crate) solver: solver::State,
    pub(crate) finish: finish::Buffers,
    pub(crate) impacts: time_of_impact::Buffers,
    /// Length of the step [s].
    pub(crate) dt: f32,
    /// Length of the last substep [s]: impulses are warm-started in proportion.
    pub(crate) last_h: f32,
    /// See `constraint::evenness`.
    pub(crate) evenness: f32,
}

impl Buffers {
    /// Leaves wrong values in all that a step makes anew; see [`spoil`](crate::memory::spoil).
    #[cfg(debug_assertions)]
    pub(crate) fn spoil(&mut self) {
        // Rows are made from nothing, trees of joints forget, and the buffers of `finish` contain state.
        let Buffers {
            forces, broad, narrow, restitution, prepare, rows: _, joints: _, statics, solver, ..
        } = self;
        forces.spoil();
        broad.spoil();
        narrow.spoil();
        restitution.spoil();
        prepare.spoil();
        statics.spoil();
        solver.spoil();
        self.impacts.spoil();
    }

    /// `continuous`: whether any body is. Discrete collision detection uses the predicted motion too, but no
    /// further than a margin.
    pub(crate) fn report(&self, report: &mut MemoryReport, continuous: bool) {
        let motion = if continuous { Category::Continuous } else { Category::Scratch };
        report.add(motion, bytes_of(&self.forces.motion));
        report.add(Category::Continuous, self.impacts.bytes());
        report.add(Category::Scratch, self.forces.bytes());
        report.add(Category::Scratch, self.broad.bytes());
        report.add(Category::Scratch, self.narrow.bytes());
        report.add(Category::Scratch, self.restitution.bytes());
        report.add(Category::Scratch, self.prepare.bytes());
        report.add(Category::Joints, self.joints.bytes());
        report.add(Category::Scratch, self.statics.bytes());
        report.add(Category::Scratch, self.solver.bytes());
        report.add(Category::Scratch, self.finish.bytes());
    }
}
