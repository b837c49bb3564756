//! Cells of a height field that are not there.

use super::HeightField;
use crate::error::{Error, index};
use crate::shape::mesh::edges::Fold;

/// Set beside the folds of a cell that is a hole.
pub(super) const HOLE: u8 = 1 << 6;

impl HeightField {
    /// The same field without some cells, by column and row: bodies fall through there, and the edges of the
    /// rest are borders. Indices of triangles stay. Holes take no memory; those that are there stay.
    ///
    /// # Errors
    /// A cell is beyond the last, which has a column and a row less than the samples have.
    pub fn with_holes(mut self, cells: impl IntoIterator<Item = [usize; 2]>) -> Result<HeightField, Error> {
        for [column, row] in cells {
            for (what, place, cells) in
                [("column of a cell", column, self.columns - 1), ("row of a cell", row, self.rows - 1)]
            {
                index(what, place, cells)?;
            }
            self.cut(column, row);
        }
        Ok(self)
    }

    /// Whether a cell is a hole; all beyond the last are.
    pub fn is_hole_at(&self, column: usize, row: usize) -> bool {
        column >= self.columns - 1 || row >= self.rows - 1 || self.is_hole(column, row)
    }

    #[inline(always)]
    pub(super) fn is_hole(&self, column: usize, row: usize) -> bool {
        self.has_holes && self.folds[row * (self.columns - 1) + column] & HOLE != 0
    }

    /// Makes a hole of a cell, and borders of the edges around it.
    fn cut(&mut self, column: usize, row: usize) {
        let open = |edge: usize| (Fold::Open as u8) << (2 * edge);
        let at = row * (self.columns - 1) + column;
        self.has_holes = true;
        self.folds[at] |= HOLE | open(1) | open(2);
        if row + 2 < self.rows {
            self.folds[at + self.columns - 1] |= open(1);
        }
        if column + 2 < self.columns {
            self.folds[at + 1] |= open(2);
        }
    }

    /// Places of the holes among the cells.
    pub(crate) fn holes(&self) -> impl Iterator<Item = u32> + '_ {
        let cells = if self.has_holes { &self.folds[..] } else { &[] };
        (0..).zip(cells).filter(|(_, bits)| **bits & HOLE != 0).map(|(cell, _)| cell)
    }
}
