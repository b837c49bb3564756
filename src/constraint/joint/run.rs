//! Dispatch of passes to the kernels of joint batches, on several threads.

use super::arrange::{JointRows, JointStage};
use super::ends::{JointPass, Recovery};
use super::kinds::{JointType, TableViews};
use crate::constraint::articulation::close::Closing;
use crate::constraint::articulation::contacts::{Request, TreeBody};
use crate::constraint::articulation::slots::{TreeContacts, TreeRef};
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
}

/// Contacts between bodies of trees and static ones, which are solved along with the trees.
pub(crate) struct TouchInput<'a> {
    pub(crate) contacts: &'a Views<'a>,
    pub(crate) pass: &'a Pass<'a>,
}

impl JointRows {
    /// For several threads.
    pub(crate) fn views(&mut self) -> JointViews<'_> {
        JointViews {
            tables: self.tables.views(),
            trees: Shared::new(&mut self.trees),
            single_trees: Shared::new(&mut self.single_trees),
        }
    }

    /// Solves a batch of a stage or, without a pass, applies the impulses of the last step.
    ///
    /// # Safety
    /// No other thread writes the bodies of the batch.
    pub(crate) unsafe fn step(
        views: &JointViews<'_>,
        stage: &JointStage,
        i: usize,
        motion: &Motion<'_, '_>,
        pass: Option<&JointPass>,
        touching: &TouchInput<'_>,
    ) {
        let TouchInput { contacts, pass: contact_pass } = *touching;
        // SAFETY: by the contract; each batch is in one stage, and contacts go contacts with one.
        unsafe {
            if stage.kind != JointType::Tree {
                return views.tables.step(stage, i, motion, pass);
            }
            match (stage.single, pass) {
                (false, None) => views.trees.get(i).warm_start(motion),
                (false, Some(pass)) => {
                    let touch = |batch: &TreeContacts, body: &mut TreeBody<'_, f32x8>| {
                        contacts.solve_tree_contacts(batch, Request::Solve(contact_pass), body, motion)
                    };
                    views.trees.get(i).solve(motion, pass, contacts.tree_contacts, touch);
                }
                (true, None) => views.single_trees.get(i).warm_start(motion),
                (true, Some(pass)) => {
                    let touch = |batch: &TreeContacts, body: &mut TreeBody<'_, f32>| {
                        contacts.solve_single_tree_contacts(batch, Request::Solve(contact_pass), body, motion)
                    };
                    views.single_trees.get(i).solve(motion, pass, contacts.tree_contacts, touch);
                }
            }
        }
    }

    /// Closes the locks of a batch outside trees, by at most `most`.
    ///
    /// # Safety
    /// No other thread works on its bodies, and none writes their displacements.
    pub(crate) unsafe fn close_locks(
        views: &JointViews<'_>,
        stage: &JointStage,
        i: usize,
        motion: &Motion<'_, '_>,
        most: Recovery,
    ) {
        // SAFETY: by the contract.
        unsafe { views.tables.close(stage, i, motion, most) };
    }

    /// Lets the joints of trees that conserve energy act before any row of the substep is solved.
    ///
    /// # Safety
    /// No other thread works on its bodies.
    pub(crate) unsafe fn predict(
        views: &JointViews<'_>,
        tree: TreeRef,
        motion: &Motion<'_, '_>,
        pass: &JointPass,
    ) {
        // SAFETY: by the contract.
        unsafe {
            if tree.is_single() {
                views.single_trees.get(tree.index()).predict(motion, pass);
            } else {
                views.trees.get(tree.index()).predict(motion, pass);
            }
        }
    }

    /// Moves the bodies of trees that conserve energy on by a substep, and closes open joints of all trees.
    ///
    /// # Safety
    /// No other thread works on them.
    pub(crate) unsafe fn go(
        views: &JointViews<'_>,
        tree: TreeRef,
        motion: &Motion<'_, '_>,
        closing: &Closing,
        contacts: &Views<'_>,
    ) {
        // SAFETY: by the contract; contacts go contacts with one batch.
        unsafe {
            if tree.is_single() {
                views.single_trees.get(tree.index()).go(
                    motion,
                    closing,
                    contacts.tree_contacts,
                    |batch, request, body| {
                        contacts.solve_single_tree_contacts(batch, request, body, motion);
                    },
                );
            } else {
                views.trees.get(tree.index()).go(
                    motion,
                    closing,
                    contacts.tree_contacts,
                    |batch, request, body| {
                        contacts.solve_tree_contacts(batch, request, body, motion);
                    },
                );
            }
        }
    }

    /// Closes the joints of a batch of trees.
    ///
    /// # Safety
    /// No other thread works on its bodies, and none writes their displacements.
    pub(crate) unsafe fn close(
        views: &JointViews<'_>,
        tree: TreeRef,
        motion: &Motion<'_, '_>,
        closing: &Closing,
        contacts: &Views<'_>,
    ) {
        // SAFETY: by the contract; contacts go contacts with one batch.
        unsafe {
            if tree.is_single() {
                views.single_trees.get(tree.index()).close(
                    motion,
                    closing,
                    contacts.tree_contacts,
                    |batch, request, body| {
                        contacts.solve_single_tree_contacts(batch, request, body, motion);
                    },
                );
            } else {
                views.trees.get(tree.index()).close(
                    motion,
                    closing,
                    contacts.tree_contacts,
                    |batch, request, body| {
                        contacts.solve_tree_contacts(batch, request, body, motion);
                    },
                );
            }
        }
    }
}
