//! The row types of joints, in one list.
//!
//! A new type is a file with a batch that implements [`JointBatch`], how it is filled and watched (`fill.rs`,
//! `nets/rates.rs`), a line here, and a case in [`JointType::of_row`] or [`JointType::of_lock`].

use super::batch::{JointBatch, Report, Watched};
use super::ends::{JointPass, Recovery};
use super::line::LineBatch;
use super::lock::{PointBatch, TurnBatch};
use super::measure::{Distance, Slide, Tilt, Turn, Twist};
use super::row::RowBatch;
use super::table::{AnyTable, Owners, Table, TableView};
use crate::constraint::articulation::cut::ROW_BYTES;
use crate::constraint::articulation::node::Node;
use crate::constraint::contact::row::Motion;
use crate::constraint::schedule::order::Place;
use crate::joint::{Axes, Lock, LockKind, Motion as Direction, Row};
use crate::lanes::{f32x8, with_best};

/// Batches of one type that may be solved at the same time: one colour of one group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointStage {
    pub(crate) place: Place,
    pub(crate) kind: JointType,
    /// Range of batches of this type; of its single ones, if `single`.
    pub(crate) start: u32,
    pub(crate) end: u32,
    /// Batches of one lane: rows that found no colour, one after another, or single trees.
    pub(crate) single: bool,
}

type SlideBatch<L> = RowBatch<L, Slide<L>>;
type DistanceBatch<L> = RowBatch<L, Distance<L>>;
type TwistBatch<L> = RowBatch<L, Twist<L>>;
type TiltBatch<L> = RowBatch<L, Tilt<L>>;
type AngleBatch<L> = RowBatch<L, Turn<L>>;
type WeldBatch<L> = TurnBatch<L, false>;
type HingeBatch<L> = TurnBatch<L, true>;

/// Makes the types, their tables, and the dispatch from a type to its kernels.
macro_rules! row_types {
    ($($(#[$doc:meta])* $kind:ident: $table:ident of $batch:ident,)*) => {
        /// A type of row. Rows at one place of the order are solved in this order.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub(crate) enum JointType {
            $($(#[$doc])* $kind,)*
            /// Two motions of joints that depend on each other.
            Coupling,
            /// Points that join bodies into trees, with the rotations locked about them.
            Tree,
        }

        impl JointType {
            /// Whether its directions change as its bodies move, and not only as they turn.
            pub(crate) fn slides(self) -> bool {
                match self {
                    $(JointType::$kind => <$batch<f32> as JointBatch<f32>>::SLIDES,)*
                    JointType::Coupling => true,
                    JointType::Tree => false,
                }
            }

            /// Whether it locks directions all at once, without bounds.
            pub(crate) fn is_lock(self) -> bool {
                match self {
                    $(JointType::$kind => <$batch<f32> as JointBatch<f32>>::IS_LOCK,)*
                    JointType::Coupling | JointType::Tree => false,
                }
            }
        }

        /// The batches of each type.
        #[derive(Debug, Default)]
        pub(crate) struct Tables {
            $(pub(crate) $table: Table<$batch<f32x8>, $batch<f32>>,)*
        }

        const COUNT: usize = [$(stringify!($kind)),*].len();

        impl Tables {
            pub(super) fn all(&self) -> [&dyn AnyTable; COUNT] {
                [$(&self.$table),*]
            }

            pub(super) fn all_mut(&mut self) -> [&mut dyn AnyTable; COUNT] {
                [$(&mut self.$table),*]
            }

            /// Owners of the lanes of a type that has batches of pairs.
            pub(super) fn owners(&mut self, kind: JointType) -> Option<&mut Owners> {
                match kind {
                    $(JointType::$kind => Some(self.$table.owners()),)*
                    JointType::Coupling | JointType::Tree => None,
                }
            }

            /// Reports the impulses of locks, or of all other rows.
            pub(super) fn report(&self, locks: bool, to: &mut impl Report) {
                $(if self.$table.is_lock() == locks {
                    self.$table.report(to);
                })*
            }

            /// For several threads.
            pub(super) fn views(&mut self) -> TableViews<'_> {
                TableViews { $($table: self.$table.view(),)* }
            }
        }

        /// The batches of each type, for several threads.
        pub(crate) struct TableViews<'a> {
            $($table: TableView<'a, $batch<f32x8>, $batch<f32>>,)*
        }

        impl TableViews<'_> {
            /// Solves a batch of a stage of pairs or, without a pass, applies the impulses of the
            /// last step.
            ///
            /// # Safety
            /// No other thread works on the batch, or writes its bodies.
            pub(super) unsafe fn step(
                &self,
                stage: &JointStage,
                i: usize,
                motion: &Motion<'_, '_>,
                pass: Option<&JointPass>,
            ) {
                // SAFETY: by the contract.
                unsafe {
                    match stage.kind {
                        $(JointType::$kind => with_best!(
                            Wide => self.$table.step::<Wide, $batch<Wide>>(stage.single, i, motion, pass)
                        ),)*
                        JointType::Coupling | JointType::Tree => {}
                    }
                }
            }

            /// Closes the locks of a batch.
            ///
            /// # Safety
            /// No other thread works on the bodies of the batch, and none writes their displacements.
            pub(super) unsafe fn close(
                &self,
                stage: &JointStage,
                i: usize,
                motion: &Motion<'_, '_>,
                most: Recovery,
            ) {
                // SAFETY: by the contract.
                unsafe {
                    match stage.kind {
                        $(JointType::$kind => with_best!(
                            Wide => self.$table.close::<Wide, $batch<Wide>>(stage.single, i, motion, most)
                        ),)*
                        JointType::Coupling | JointType::Tree => {}
                    }
                }
            }

            /// Calls `f` with a batch of a stage of pairs.
            ///
            /// # Safety
            /// No other thread works on the batch.
            pub(super) unsafe fn watch(
                &self,
                stage: &JointStage,
                i: usize,
                f: &mut dyn FnMut(&mut dyn Watched),
            ) {
                // SAFETY: by the contract.
                unsafe {
                    match stage.kind {
                        $(JointType::$kind => self.$table.watch(stage.single, i, f),)*
                        JointType::Coupling | JointType::Tree => {}
                    }
                }
            }

            /// Reports the impulses of locks, or of all other rows.
            ///
            /// # Safety
            /// No other thread works on the batches.
            #[cfg(feature = "observe")]
            pub(crate) unsafe fn report(&self, locks: bool, to: &mut impl Report) {
                $(if <$batch<f32> as JointBatch<f32>>::IS_LOCK == locks {
                    // SAFETY: by the contract.
                    unsafe { self.$table.report(to) };
                })*
            }
        }

        /// Bytes of the largest batch of eight lanes.
        const WIDEST_ROW: usize = {
            let (sizes, mut widest, mut i) = ([$(size_of::<$batch<f32x8>>()),*], 0, 0);
            while i < COUNT {
                if sizes[i] > widest {
                    widest = sizes[i];
                }
                i += 1;
            }
            widest
        };
    };
}

row_types! {
    /// A displacement along an axis.
    Slide: slides of SlideBatch,
    /// A distance from a point or an axis.
    Distance: distances of DistanceBatch,
    /// The twist about an axis.
    Twist: twists of TwistBatch,
    /// The angle between an axis of each body.
    Tilt: tilts of TiltBatch,
    /// The angle of all rotation.
    Turn: turns of AngleBatch,
    /// All rotation locked.
    Weld: welds of WeldBatch,
    /// Rotation locked but for that about an axis.
    Hinge: hinges of HingeBatch,
    /// A point locked to a line.
    Line: lines of LineBatch,
    /// A point locked to a point.
    Point: points of PointBatch,
}

impl JointType {
    pub(super) fn of_row(row: &Row) -> JointType {
        match (row.motion, row.axes) {
            (Direction::Linear, Axes::One(_)) => JointType::Slide,
            (Direction::Linear, _) => JointType::Distance,
            (Direction::Angular, Axes::One(_)) => JointType::Twist,
            (Direction::Angular, Axes::Perpendicular(_)) => JointType::Tilt,
            (Direction::Angular, Axes::All) => JointType::Turn,
        }
    }

    pub(super) fn of_lock(lock: &Lock) -> JointType {
        match lock.kind {
            LockKind::Point => JointType::Point,
            LockKind::Line(_) => JointType::Line,
            LockKind::Weld => JointType::Weld,
            LockKind::Hinge(_) => JointType::Hinge,
        }
    }
}

/// The most bytes that a row of a joint takes in the batches: a batch to itself, or half a node of two trees
/// of the same shape with the rows of a cut joint.
pub(crate) const WIDEST_JOINT_BATCH: usize = {
    let node = (size_of::<Node<f32x8>>() + 3 * ROW_BYTES) / 2;
    if WIDEST_ROW > node { WIDEST_ROW } else { node }
};

/// Bytes of a lock and of any other row in a batch that is full, and of a body in a tree of a shape of its
/// own.
pub(crate) const JOINT_BYTES: [usize; 3] = [
    size_of::<PointBatch<f32x8>>() / 8 + size_of::<u32>(),
    WIDEST_ROW / 8 + size_of::<u32>(),
    size_of::<Node<f32>>(),
];
