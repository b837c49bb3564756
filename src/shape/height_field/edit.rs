//! Heights and holes that change.

use super::{HeightField, SIDE, check_heights, holes::HOLE};
use crate::error::{Error, count, index};
use crate::shape::mesh::edges::Fold;

/// New heights of a rectangle of samples, row by row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Patch<'a> {
    /// Column and row of the first sample.
    pub(crate) first: [usize; 2],
    /// Columns and rows.
    pub(crate) size: [usize; 2],
    /// One for each sample [m].
    pub(crate) heights: &'a [f32],
}

/// Which cells of a rectangle are holes, row by row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HolePatch<'a> {
    /// Column and row of the first cell.
    pub(crate) first: [usize; 2],
    /// Columns and rows.
    pub(crate) size: [usize; 2],
    /// One for each cell.
    pub(crate) holes: &'a [bool],
}

impl HolePatch<'_> {
    /// Whether a cell will be a hole, if it is one of them.
    fn at(&self, column: usize, row: usize) -> Option<bool> {
        let (x, z) = (column.wrapping_sub(self.first[0]), row.wrapping_sub(self.first[1]));
        (x < self.size[0] && z < self.size[1]).then(|| self.holes[z * self.size[0] + x])
    }

    /// The samples at the corners of its cells, without heights: for [`HeightField::box_of`].
    pub(crate) fn samples(&self) -> Patch<'static> {
        Patch { first: self.first, size: self.size.map(|n| n + 1), heights: &[] }
    }
}

impl Patch<'_> {
    /// The new height of a sample, if it is one of them [m].
    fn at(&self, column: usize, row: usize) -> Option<f32> {
        let (x, z) = (column.wrapping_sub(self.first[0]), row.wrapping_sub(self.first[1]));
        (x < self.size[0] && z < self.size[1]).then(|| self.heights[z * self.size[0] + x])
    }
}

impl HeightField {
    /// Changes the heights [m] of `size[0]` times `size[1]` samples from column `first[0]` and row `first[1]`
    /// on, row by row. The field is then the one that [`HeightField::new`] makes of all heights; holes stay.
    /// It allocates nothing, and costs time for the region, not for the field.
    ///
    /// # Errors
    /// The region is empty or goes beyond the field, the number of heights isn't that of its samples, or a
    /// height is not finite or beyond 1e7.
    pub fn set_heights(&mut self, first: [usize; 2], size: [usize; 2], heights: &[f32]) -> Result<(), Error> {
        let patch = Patch { first, size, heights };
        self.check(&patch)?;
        self.edit(&patch);
        Ok(())
    }

    pub(crate) fn check(&self, patch: &Patch<'_>) -> Result<(), Error> {
        check_region(patch.first, patch.size, [self.columns, self.rows])?;
        let rule = "columns times rows of the region";
        count("heights", rule, patch.size[0] * patch.size[1], patch.heights.len())?;
        check_heights(patch.heights)
    }

    /// Whether it has the heights of a patch that was checked.
    pub(crate) fn has_heights(&self, patch: &Patch<'_>) -> bool {
        let [column, row] = patch.first;
        patch.heights.chunks_exact(patch.size[0]).enumerate().all(|(z, line)| {
            let from = (row + z) * self.columns + column;
            self.heights[from..from + line.len()] == *line
        })
    }

    /// Changes heights that were checked, with the folds and the boxes that depend on them.
    pub(crate) fn edit(&mut self, patch: &Patch<'_>) {
        let Patch { first: [column, row], size: [width, depth], heights } = *patch;
        for (z, line) in heights.chunks_exact(width).enumerate() {
            let from = (row + z) * self.columns + column;
            self.heights[from..from + width].copy_from_slice(line);
        }
        // A cell's folds depend on its own samples and on those a column and a row before them.
        let (columns, rows) = (self.columns - 1, self.rows - 1);
        let (left, top) = (column.saturating_sub(1), row.saturating_sub(1));
        self.find_folds_of([left, top], [column + width + 1, row + depth + 1]);
        let (mut x, mut z) = ([left, (column + width).min(columns)], [top, (row + depth).min(rows)]);
        for level in 0..self.levels.len() {
            for side in [&mut x, &mut z] {
                *side = [side[0] / SIDE, side[1].div_ceil(SIDE)];
            }
            for r in z[0]..z[1] {
                for c in x[0]..x[1] {
                    let bounds = self.square_bounds(&self.levels[..level], c, r);
                    let columns = self.levels[level].columns;
                    self.levels[level].bounds[r * columns + c] = bounds;
                }
            }
        }
    }

    /// Finds the folds of the cells from one up to another anew.
    fn find_folds_of(&mut self, from: [usize; 2], to: [usize; 2]) {
        let (columns, rows) = (self.columns - 1, self.rows - 1);
        for r in from[1]..to[1].min(rows) {
            for c in from[0]..to[0].min(columns) {
                let folds = self.cell_folds(c, r) | self.hole_bits(c, r);
                self.folds[r * columns + c] = folds;
            }
        }
    }

    /// Makes holes of `size[0]` times `size[1]` cells from column `first[0]` and row `first[1]` on where
    /// `holes` says so, row by row, and fills the others. The field is then the one that
    /// [`HeightField::with_holes`] makes of all holes. It allocates nothing, and costs time for the region,
    /// not for the field.
    ///
    /// # Errors
    /// The region is empty or goes beyond the last cell, or the number of `holes` isn't that of its cells.
    pub fn set_holes(&mut self, first: [usize; 2], size: [usize; 2], holes: &[bool]) -> Result<(), Error> {
        let patch = HolePatch { first, size, holes };
        self.check_holes(&patch)?;
        self.edit_holes(&patch);
        Ok(())
    }

    pub(crate) fn check_holes(&self, patch: &HolePatch<'_>) -> Result<(), Error> {
        check_region(patch.first, patch.size, [self.columns - 1, self.rows - 1])?;
        let rule = "columns times rows of the region";
        count("holes", rule, patch.size[0] * patch.size[1], patch.holes.len())
    }

    /// Whether it has the holes of a patch that was checked.
    pub(crate) fn has_holes_as(&self, patch: &HolePatch<'_>) -> bool {
        let [column, row] = patch.first;
        let mut lines = patch.holes.chunks_exact(patch.size[0]).enumerate();
        lines.all(|(z, line)| (0..line.len()).all(|x| self.is_hole_at(column + x, row + z) == line[x]))
    }

    /// Cuts and fills holes that were checked, with the folds around them.
    pub(crate) fn edit_holes(&mut self, patch: &HolePatch<'_>) {
        let HolePatch { first: [column, row], size: [width, depth], holes } = *patch;
        let columns = self.columns - 1;
        for (z, line) in holes.chunks_exact(width).enumerate() {
            for (x, &hole) in line.iter().enumerate() {
                let bits = &mut self.folds[(row + z) * columns + column + x];
                *bits = *bits & !HOLE | if hole { HOLE } else { 0 };
                self.has_holes |= hole;
            }
        }
        // Edges that a cell shares with the one before it are its own.
        self.find_folds_of([column, row], [column + width + 1, row + depth + 1]);
    }

    /// The bit of a hole, and open edges if the cell is one or is next to one.
    fn hole_bits(&self, column: usize, row: usize) -> u8 {
        let own = self.is_hole(column, row);
        let open = |edge: usize, other: bool| if own || other { (Fold::Open as u8) << (2 * edge) } else { 0 };
        let above = open(1, row > 0 && self.is_hole(column, row - 1));
        let before = open(2, column > 0 && self.is_hole(column - 1, row));
        above | before | if own { HOLE } else { 0 }
    }

    /// Height of the surface over a place [m], and its height after a patch; nothing beyond the field or in a
    /// hole.
    pub(crate) fn heights_at(&self, x: f32, z: f32, patch: &Patch<'_>) -> Option<[f32; 2]> {
        let place = self.cell_at(x, z).filter(|&([column, row], _)| !self.is_hole(column, row))?;
        let old = |c: usize, r: usize| self.heights[r * self.columns + c];
        Some([on(place, &old), on(place, &|c, r| patch.at(c, r).unwrap_or_else(|| old(c, r)))])
    }

    /// Height of the surface over a place in a hole that a patch fills [m].
    pub(crate) fn filled_at(&self, x: f32, z: f32, patch: &HolePatch<'_>) -> Option<f32> {
        let fills = |&([c, r], _): &Place| self.is_hole(c, r) && patch.at(c, r) == Some(false);
        let place = self.cell_at(x, z).filter(fills)?;
        Some(on(place, &|c, r| self.heights[r * self.columns + c]))
    }

    /// The cell at a place [m], and where in it; nothing beyond the field.
    fn cell_at(&self, x: f32, z: f32) -> Option<Place> {
        let (u, v) = (x / self.cell.x, z / self.cell.y);
        if !(u >= 0.0 && v >= 0.0 && u < (self.columns - 1) as f32 && v < (self.rows - 1) as f32) {
            return None;
        }
        let (column, row) = (u as usize, v as usize);
        Some(([column, row], [u - column as f32, v - row as f32]))
    }

    /// Corners of a box around the cells that a patch changes, as they are and as they will be [m].
    pub(crate) fn box_of(&self, patch: &Patch<'_>) -> (glam::Vec3, glam::Vec3) {
        let [from, to] = [
            patch.first.map(|k| k.saturating_sub(1)),
            [
                (patch.first[0] + patch.size[0]).min(self.columns - 1),
                (patch.first[1] + patch.size[1]).min(self.rows - 1),
            ],
        ];
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for row in from[1]..=to[1] {
            let line = &self.heights[row * self.columns..][from[0]..=to[0]];
            line.iter().for_each(|&y| (low, high) = (low.min(y), high.max(y)));
        }
        patch.heights.iter().for_each(|&y| (low, high) = (low.min(y), high.max(y)));
        let corner = |at: [usize; 2], y: f32| {
            glam::Vec3::new(at[0] as f32 * self.cell.x, y, at[1] as f32 * self.cell.y)
        };
        (corner(from, low), corner(to, high))
    }
}

/// Column and row of a cell, and a place in it, as shares of its sides.
type Place = ([usize; 2], [f32; 2]);

/// The height at a place, of the triangle there [m]; `height` is that of a sample.
fn on(([column, row], [u, v]): Place, height: &dyn Fn(usize, usize) -> f32) -> f32 {
    let (v10, v01) = (height(column + 1, row), height(column, row + 1));
    if u + v <= 1.0 {
        let v00 = height(column, row);
        v00 + u * (v10 - v00) + v * (v01 - v00)
    } else {
        let v11 = height(column + 1, row + 1);
        v11 + (1.0 - u) * (v01 - v11) + (1.0 - v) * (v10 - v11)
    }
}

/// Whether a region is not empty, and within so many columns and rows.
fn check_region(first: [usize; 2], size: [usize; 2], all: [usize; 2]) -> Result<(), Error> {
    let columns = ("columns of the region", "the region's last column");
    let rows = ("rows of the region", "the region's last row");
    for (k, what) in [columns, rows].into_iter().enumerate() {
        let (what, last) = what;
        if size[k] == 0 {
            return Err(Error::OutOfRange { what, expected: "at least one", value: 0.0 });
        }
        index(last, first[k].saturating_add(size[k] - 1), all[k])?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use glam::Vec2;

    /// Expected: heights, folds, holes and boxes of the field that is built anew from all heights.
    #[test]
    fn an_edited_field_is_the_one_that_is_built_anew() {
        let mut random = Random(7);
        let (columns, rows) = (39, 22);
        let mut heights: Vec<f32> = (0..columns * rows).map(|_| random.range(-1.0, 1.0)).collect();
        let built = |heights: &[f32]| {
            let field = HeightField::new(columns, rows, Vec2::new(0.5, 0.7), heights.to_vec()).unwrap();
            field.with_holes([[3, 4], [4, 4], [0, 0], [37, 20], [20, 0]]).unwrap()
        };
        let mut field = built(&heights);
        for _ in 0..300 {
            let first = [random.below(columns), random.below(rows)];
            let size = [1 + random.below(columns - first[0]), 1 + random.below(rows - first[1])];
            let new: Vec<f32> = (0..size[0] * size[1]).map(|_| random.range(-2.0, 2.0)).collect();
            for (i, &y) in new.iter().enumerate() {
                heights[(first[1] + i / size[0]) * columns + first[0] + i % size[0]] = y;
            }
            field.set_heights(first, size, &new).unwrap();
            let expected = built(&heights);
            assert_eq!((&field.heights, &field.folds), (&expected.heights, &expected.folds));
            for (own, other) in field.levels.iter().zip(&expected.levels) {
                assert_eq!(own.bounds, other.bounds);
            }
        }
        assert!(field.set_heights([38, 0], [2, 1], &[0.0; 2]).is_err());
        assert!(field.set_heights([0, 0], [0, 1], &[]).is_err());
        assert!(field.set_heights([0, 0], [2, 1], &[0.0]).is_err());
        assert!(field.set_heights([0, 0], [1, 1], &[f32::NAN]).is_err());
    }
    /// Expected: folds and holes of the field that is built anew with all holes.
    #[test]
    fn a_field_with_edited_holes_is_the_one_that_is_built_anew() {
        let mut random = Random(3);
        let (columns, rows) = (17, 12);
        let heights: Vec<f32> = (0..columns * rows).map(|_| random.range(-1.0, 1.0)).collect();
        let flat = HeightField::new(columns, rows, Vec2::new(0.5, 0.7), heights).unwrap();
        let (mut field, mut all) = (flat.clone(), vec![false; (columns - 1) * (rows - 1)]);
        for _ in 0..300 {
            let first = [random.below(columns - 1), random.below(rows - 1)];
            let size = [1 + random.below(columns - 1 - first[0]), 1 + random.below(rows - 1 - first[1])];
            let holes: Vec<bool> = (0..size[0] * size[1]).map(|_| random.below(4) == 0).collect();
            for (i, &hole) in holes.iter().enumerate() {
                all[(first[1] + i / size[0]) * (columns - 1) + first[0] + i % size[0]] = hole;
            }
            field.set_holes(first, size, &holes).unwrap();
            let cells = (0..all.len()).filter(|&i| all[i]).map(|i| [i % (columns - 1), i / (columns - 1)]);
            let expected = flat.clone().with_holes(cells).unwrap();
            assert_eq!(field.folds, expected.folds);
        }
        assert!(field.set_holes([15, 0], [2, 1], &[true; 2]).is_err());
        assert!(field.set_holes([0, 0], [0, 1], &[]).is_err());
        assert!(field.set_holes([0, 0], [2, 1], &[true]).is_err());
    }
}
