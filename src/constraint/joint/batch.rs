//! The interface of the batches of all row types: filling, solving and reporting.

use super::ends::{Ends, JointPass, Recovery};
use crate::constraint::contact::input::PrepareInput;
use crate::constraint::contact::row::{BodyPair, Motion};
use crate::lanes::GatherLanes;
#[cfg(feature = "observe")]
use crate::lanes::Vec3 as Vec3Lanes;
use glam::Vec3;

/// Makes the batch of the locks or rows `owners` of this step's joints.
pub(crate) trait Filled {
    fn fill(&mut self, owners: &[u32], input: &PrepareInput<'_>);
}

/// A batch of one row type: the same lock or row of up to eight joints, a lane each.
///
/// Every type is solved in the same steps, which are written once, here: the bodies are loaded, directions
/// follow their rotation, the rows are solved, the bodies are saved. A type supplies the differences. Its
/// helpers are inlined into the steps, and the steps are kernels: two dozen of them in one function is more
/// than the compiler inlines helpers into (12 % of the step of a net of joints).
pub(crate) trait JointBatch<L: GatherLanes>: Filled + Watched + Default {
    /// Whether it locks directions all at once, without bounds.
    const IS_LOCK: bool;
    /// Whether its directions change as its bodies move, and not only as they turn.
    const SLIDES: bool;

    fn ends(&self) -> &Ends<L>;
    /// Updates directions, errors and effective masses to displacements of the bodies since the start of the
    /// step.
    fn follow(&mut self, moved: &BodyPair<L>);
    /// Applies the impulses of the last substep.
    fn apply(&self, v: &mut BodyPair<L>);
    /// One Gauss-Seidel step.
    fn sweep(&mut self, v: &mut BodyPair<L>, pass: &JointPass);
    /// Reduces the error of a lock by at most `most`, by displacements.
    fn correct(&self, _moved: &mut BodyPair<L>, _most: Recovery) {}
    /// Reports the impulse of a lane.
    fn report(&self, lane: usize, to: &mut impl Report);
    /// The impulse of the last substep on the second body, and its moments about both centres of mass, that
    /// of the first body negated: as its parts acted, while directions turned [N s], [N m s].
    #[cfg(feature = "observe")]
    fn acted(&self) -> (Vec3Lanes<L>, [Vec3Lanes<L>; 2]);
}

/// The indices of two joined bodies, and which of them can be pushed.
pub(crate) struct Link {
    pub(crate) bodies: [u32; 2],
    pub(crate) moves: [bool; 2],
}

/// A batch of joints.
pub(crate) trait Watched {
    fn links(&self, f: &mut dyn FnMut(Link));
    /// Calls `f` with a body of each joint with a direction that turns too far in a substep.
    fn turning(&mut self, motion: &Motion<'_, '_>, h: f32, f: &mut dyn FnMut(u32));
    /// Calls `f` with a body of each tree whose rotation was not followed in the substep.
    fn lost(&mut self, _motion: &Motion<'_, '_>, _h: f32, _f: &mut dyn FnMut(u32)) {}
    /// Calls `f` with a body of each lock whose error still grows after velocities were relaxed: its rows did
    /// not converge.
    fn unsolved(&self, _motion: &Motion<'_, '_>, _f: &mut dyn FnMut(u32)) {}
    /// Clears the impulses of the joints of some bodies.
    fn forget(&mut self, of: &dyn Fn(u32) -> bool);
    /// Calls `f` with a body of each spring or motor, the energy it can give back and the energy it gives in
    /// a substep [J].
    fn stored(&self, _h: f32, _f: &mut dyn FnMut(u32, [f32; 2])) {}
}

/// Takes the impulses of locks and rows, lane by lane.
pub(crate) trait Report {
    /// The impulse of a lock, on the second body.
    fn lock(&mut self, owner: u32, impulse: Vec3);
    /// The impulse of another row.
    fn row(&mut self, owner: u32, impulse: RowImpulse);
    /// The impulse on a body, and its moment about the centre of mass, of a lock or another row.
    #[cfg(feature = "observe")]
    fn push(&mut self, _body: u32, _push: [Vec3; 2]) {}
}

/// Result of a row in the last substep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowImpulse {
    /// At the lower and the upper end of its range [N s] or [N m s].
    pub(crate) ends: [f32; 2],
    /// Directions of force and torque on the second body at its point.
    pub(crate) force: Vec3,
    pub(crate) torque: Vec3,
    /// The displacement after it, if the row measures one [m] or [rad].
    pub(crate) now: Option<f32>,
}
