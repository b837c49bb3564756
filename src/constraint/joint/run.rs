//! What the passes over batches of joints call: which kernel works on which batch, on several threads.

use super::arrange::{JointRows, JointStage, JointType};
use super::ends::{JointPass, Recovery};
use super::line::LineBatch;
use super::lock::{PointBatch, TurnBatch};
use super::measure::{Distance, Slide, Tilt, Turn, Twist};
use super::row::RowBatch;
use crate::constraint::articulation::close::Closing;
use crate::constraint::articulation::contacts::{Ask, Toured};
use crate::constraint::articulation::slots::{Seated, TreeRef};
use crate::constraint::articulation::tree::TreeBatch;
use crate::constraint::contact::row::{Motion, Pass};
use crate::constraint::contact::rows::Views;
use crate::lanes::f32x8;
use crate::threads::Shared;

/// All batches, for several threads.
pub(crate) struct JointViews<'a> {
    pub(crate) points: Shared<'a, PointBatch<f32x8>>,
    pub(crate) point: Shared<'a, PointBatch<f32>>,
    pub(crate) welds: Shared<'a, TurnBatch<f32x8, false>>,
    pub(crate) weld: Shared<'a, TurnBatch<f32, false>>,
    pub(crate) hinges: Shared<'a, TurnBatch<f32x8, true>>,
    pub(crate) hinge: Shared<'a, TurnBatch<f32, true>>,
    pub(crate) lines: Shared<'a, LineBatch<f32x8>>,
    pub(crate) line: Shared<'a, LineBatch<f32>>,
    pub(crate) slides: Shared<'a, RowBatch<f32x8, Slide<f32x8>>>,
    pub(crate) slide: Shared<'a, RowBatch<f32, Slide<f32>>>,
    pub(crate) distances: Shared<'a, RowBatch<f32x8, Distance<f32x8>>>,
    pub(crate) distance: Shared<'a, RowBatch<f32, Distance<f32>>>,
    pub(crate) twists: Shared<'a, RowBatch<f32x8, Twist<f32x8>>>,
    pub(crate) twist: Shared<'a, RowBatch<f32, Twist<f32>>>,
    pub(crate) tilts: Shared<'a, RowBatch<f32x8, Tilt<f32x8>>>,
    pub(crate) tilt: Shared<'a, RowBatch<f32, Tilt<f32>>>,
    pub(crate) turns: Shared<'a, RowBatch<f32x8, Turn<f32x8>>>,
    pub(crate) turn: Shared<'a, RowBatch<f32, Turn<f32>>>,
    pub(crate) trees: Shared<'a, TreeBatch<f32x8>>,
    pub(crate) tree: Shared<'a, TreeBatch<f32>>,
}

impl JointRows {
    /// For several threads.
    pub(crate) fn views(&mut self) -> JointViews<'_> {
        JointViews {
            points: Shared::new(&mut self.points.lanes),
            point: Shared::new(&mut self.points.single),
            welds: Shared::new(&mut self.welds.lanes),
            weld: Shared::new(&mut self.welds.single),
            hinges: Shared::new(&mut self.hinges.lanes),
            hinge: Shared::new(&mut self.hinges.single),
            lines: Shared::new(&mut self.lines.lanes),
            line: Shared::new(&mut self.lines.single),
            slides: Shared::new(&mut self.slides.lanes),
            slide: Shared::new(&mut self.slides.single),
            distances: Shared::new(&mut self.distances.lanes),
            distance: Shared::new(&mut self.distances.single),
            twists: Shared::new(&mut self.twists.lanes),
            twist: Shared::new(&mut self.twists.single),
            tilts: Shared::new(&mut self.tilts.lanes),
            tilt: Shared::new(&mut self.tilts.single),
            turns: Shared::new(&mut self.turns.lanes),
            turn: Shared::new(&mut self.turns.single),
            trees: Shared::new(&mut self.trees),
            tree: Shared::new(&mut self.tree),
        }
    }

    /// One batch of a stage: solves it or, without a pass, applies the impulses of the last step. Each kernel is a function of
    /// its own: two dozen of them in one is more than the compiler inlines helpers into (12 % of a net's step).
    ///
    /// # Safety
    /// No other thread writes the bodies of the batch.
    pub(crate) unsafe fn step(
        views: &JointViews<'_>,
        stage: &JointStage,
        i: usize,
        motion: &Motion<'_, '_>,
        pass: Option<&JointPass>,
        (along, touching): (&Views<'_>, &Pass<'_>),
    ) {
        macro_rules! go {
            ($lanes:expr, $single:expr) => {
                // SAFETY: by the contract; each batch is in one stage.
                unsafe {
                    match (stage.single, pass) {
                        (false, None) => $lanes.get(i).warm_start(motion),
                        (false, Some(pass)) => $lanes.get(i).solve(motion, pass),
                        (true, None) => $single.get(i).warm_start(motion),
                        (true, Some(pass)) => $single.get(i).solve(motion, pass),
                    }
                }
            };
        }
        match stage.kind {
            JointType::Point => go!(views.points, views.point),
            JointType::Weld => go!(views.welds, views.weld),
            JointType::Hinge => go!(views.hinges, views.hinge),
            JointType::Line => go!(views.lines, views.line),
            JointType::Slide => go!(views.slides, views.slide),
            JointType::Distance => go!(views.distances, views.distance),
            JointType::Twist => go!(views.twists, views.twist),
            JointType::Tilt => go!(views.tilts, views.tilt),
            JointType::Turn => go!(views.turns, views.turn),
            JointType::Tree => {
                // SAFETY: by the contract; each batch is in one stage, and contacts go along with one.
                unsafe {
                    match (stage.single, pass) {
                        (false, None) => views.trees.get(i).warm_start(motion),
                        (false, Some(pass)) => {
                            let touch = |seated: &Seated, body: &mut Toured<'_, f32x8>| {
                                along.tour(seated, Ask::Solve(touching), body, motion)
                            };
                            views.trees.get(i).solve(motion, pass, along.seated, touch);
                        }
                        (true, None) => views.tree.get(i).warm_start(motion),
                        (true, Some(pass)) => {
                            let touch = |seated: &Seated, body: &mut Toured<'_, f32>| {
                                along.tour_single(seated, Ask::Solve(touching), body, motion)
                            };
                            views.tree.get(i).solve(motion, pass, along.seated, touch);
                        }
                    }
                }
            }
        }
    }

    /// Closes the locks of a batch that is no tree, by no more than so much.
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
        unsafe {
            match (stage.kind, stage.single) {
                (JointType::Point, false) => views.points.get(i).close(motion, most.linear),
                (JointType::Point, true) => views.point.get(i).close(motion, most.linear),
                (JointType::Weld, false) => views.welds.get(i).close(motion, most.angular),
                (JointType::Weld, true) => views.weld.get(i).close(motion, most.angular),
                (JointType::Hinge, false) => views.hinges.get(i).close(motion, most.angular),
                (JointType::Hinge, true) => views.hinge.get(i).close(motion, most.angular),
                (JointType::Line, false) => views.lines.get(i).close(motion, most.linear),
                (JointType::Line, true) => views.line.get(i).close(motion, most.linear),
                _ => {}
            }
        }
    }

    /// What the joints of a batch of trees that keep their energy do before any row of the substep is solved.
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
                views.tree.get(tree.index()).predict(motion, pass);
            } else {
                views.trees.get(tree.index()).predict(motion, pass);
            }
        }
    }

    /// Moves the bodies of a batch of trees on by a substep, where they keep their energy, and closes what is open.
    ///
    /// # Safety
    /// No other thread works on them.
    pub(crate) unsafe fn go(
        views: &JointViews<'_>,
        tree: TreeRef,
        motion: &Motion<'_, '_>,
        closing: &Closing,
        along: &Views<'_>,
    ) {
        // SAFETY: by the contract; contacts go along with one batch.
        unsafe {
            if tree.is_single() {
                views.tree.get(tree.index()).go(motion, closing, along.seated, |seated, ask, body| {
                    along.tour_single(seated, ask, body, motion);
                });
            } else {
                views.trees.get(tree.index()).go(motion, closing, along.seated, |seated, ask, body| {
                    along.tour(seated, ask, body, motion);
                });
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
        along: &Views<'_>,
    ) {
        // SAFETY: by the contract; contacts go along with one batch.
        unsafe {
            if tree.is_single() {
                views.tree.get(tree.index()).close(motion, closing, along.seated, |seated, ask, body| {
                    along.tour_single(seated, ask, body, motion);
                });
            } else {
                views.trees.get(tree.index()).close(motion, closing, along.seated, |seated, ask, body| {
                    along.tour(seated, ask, body, motion);
                });
            }
        }
    }
}
