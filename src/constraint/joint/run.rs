//! Dispatch of passes to the kernels of joint batches, on several threads.

#[cfg(feature = "observe")]
use super::batch::Report;
use super::coupling::block::CouplingBlock;
use super::ends::{JointPass, Recovery};
use super::kinds::{JointStage, JointType, TableViews};
use crate::constraint::articulation::contacts::{Request, TreeLanes};
use crate::constraint::articulation::slots::TreeRef;
use crate::constraint::articulation::tree::TreeBatch;
use crate::constraint::contact::row::{Motion, Pass};
use crate::constraint::contact::rows::Views;
use crate::lanes::f32x8;
use crate::threads::Shared;

/// All batches, for several threads.
pub(crate) struct JointViews<'a> {
    pub(crate) tables: TableViews<'a>,
    pub(crate) trees: Shared<'a, TreeBatch<f32x8>>,
    pub(crate) single_trees: Shared<'a, TreeBatch<f32>>,
    pub(super) couplings: Shared<'a, CouplingBlock>,
}

/// Contacts between bodies of trees and static ones, which are solved along with the trees.
pub(crate) struct TouchInput<'a> {
    pub(crate) contacts: &'a Views<'a>,
    pub(crate) pass: &'a Pass<'a>,
}

/// Calls a method of a batch of eight trees, or of a single one.
macro_rules! on_trees {
    ($views:ident, $single:expr, $i:expr, $trees:ident => $call:expr) => {
        if $single {
            let $trees = $views.single_trees.get($i);
            $call
        } else {
            let $trees = $views.trees.get($i);
            $call
        }
    };
}

#[cfg(feature = "observe")]
impl JointViews<'_> {
    /// Reports the motors in blocks of couplings and the impulses on all their bodies, and calls `coupling`
    /// with each coupling by its slot, its impulses at both ends, and force and torque on each of its joints
    /// per impulse.
    ///
    /// # Safety
    /// No other thread works on the blocks.
    pub(crate) unsafe fn each_coupling(
        &self,
        drives: &mut impl Report,
        coupling: &mut dyn FnMut(u32, [f32; 2], [[glam::Vec3; 2]; 2]),
    ) {
        // SAFETY: by the contract.
        for block in unsafe { self.couplings.all() } {
            block.report_drives(drives);
            block.report_pushes(drives);
            block.report_levers(coupling);
        }
    }
}

impl JointViews<'_> {
    /// Solves a batch of a stage or, without a pass, applies the impulses of the last step.
    ///
    /// # Safety
    /// No other thread writes the bodies of the batch.
    pub(crate) unsafe fn step(
        &self,
        stage: &JointStage,
        i: usize,
        motion: &Motion<'_, '_>,
        pass: Option<&JointPass>,
        touching: &TouchInput<'_>,
    ) {
        let TouchInput { contacts, pass: contact_pass } = *touching;
        // SAFETY: by the contract; each batch is in one stage, and contacts go contacts with one.
        unsafe {
            if stage.kind == JointType::Coupling {
                let block = self.couplings.get(i);
                return match pass {
                    None => block.warm_start(motion),
                    Some(pass) => block.solve(motion, pass),
                };
            }
            if stage.kind != JointType::Tree {
                return self.tables.step(stage, i, motion, pass);
            }
            on_trees!(self, stage.single, i, trees => match pass {
                None => trees.warm_start(motion),
                Some(pass) => trees.solve(motion, pass, contacts.tree_contacts, |batch, body| {
                    TreeLanes::solve_contacts(contacts, batch, Request::Solve(contact_pass), body, motion)
                }),
            });
        }
    }

    /// Closes the locks of a batch outside trees, by at most `most`.
    ///
    /// # Safety
    /// No other thread works on its bodies, and none writes their displacements.
    pub(crate) unsafe fn close_locks(
        &self,
        stage: &JointStage,
        i: usize,
        motion: &Motion<'_, '_>,
        most: Recovery,
    ) {
        // SAFETY: by the contract.
        unsafe { self.tables.close(stage, i, motion, most) };
    }

    /// Lets the joints of trees that conserve energy act before any row of the substep is solved.
    ///
    /// # Safety
    /// No other thread works on its bodies.
    pub(crate) unsafe fn predict(&self, tree: TreeRef, motion: &Motion<'_, '_>, pass: &JointPass) {
        // SAFETY: by the contract.
        unsafe { on_trees!(self, tree.is_single(), tree.index(), trees => trees.predict(motion, pass)) }
    }

    /// Moves the bodies of trees that conserve energy on by a substep, and closes open joints of all trees.
    ///
    /// # Safety
    /// No other thread works on them.
    pub(crate) unsafe fn go(&self, tree: TreeRef, motion: &Motion<'_, '_>, slop: f32, contacts: &Views<'_>) {
        // SAFETY: by the contract; contacts go contacts with one batch.
        unsafe {
            on_trees!(self, tree.is_single(), tree.index(), trees => {
                trees.go(motion, slop, contacts.tree_contacts, |batch, request, body| {
                    TreeLanes::solve_contacts(contacts, batch, request, body, motion)
                })
            });
        }
    }

    /// Closes the joints of a batch of trees.
    ///
    /// # Safety
    /// No other thread works on its bodies, and none writes their displacements.
    pub(crate) unsafe fn close(
        &self,
        tree: TreeRef,
        motion: &Motion<'_, '_>,
        slop: f32,
        contacts: &Views<'_>,
    ) {
        // SAFETY: by the contract; contacts go contacts with one batch.
        unsafe {
            on_trees!(self, tree.is_single(), tree.index(), trees => {
                trees.close(motion, slop, contacts.tree_contacts, |batch, request, body| {
                    TreeLanes::solve_contacts(contacts, batch, request, body, motion)
                })
            });
        }
    }
}
