//! Height fields.

pub(crate) mod edit;
mod holes;
pub(crate) mod rays;

use super::corners::beyond;
use super::slabs::Near;
use crate::error::{self, Error, each, positive, within};
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, f32x4};
use crate::limits::{self, MAX_COORDINATE};
use crate::memory::{bytes_of, sum_bytes};
use crate::shape::mesh::bvh::Path;
use crate::shape::mesh::edges::{Edges, Fold};
use crate::shape::mesh::rays::take;
use crate::shape::mesh::segment_triangle::SegmentTest;
use crate::shape::{Material, Surfaces};
use glam::{Vec2, Vec3};

/// Cells, or boxes of the level below, along a side of a box of the pyramid.
pub(super) const SIDE: usize = 4;
/// Most boxes that wait: 15 for each of 14 levels, which is a side of 4^14 cells.
pub(super) const STACK: usize = 224;

/// A static grid of heights, shared by the shapes that use it.
///
/// Sample (column, row) lies at x = column · cell.x and z = row · cell.y. A cell is two triangles whose
/// common edge runs from (column + 1, row) to (column, row + 1), with their fronts up; triangle 2 c is the
/// one at the cell's own sample, 2 c + 1 the other. It is touched from both sides. Cells may be holes
/// ([`HeightField::with_holes`]). About 5.6 bytes a sample.
#[derive(Clone, Debug)]
pub struct HeightField {
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) cell: Vec2,
    pub(super) heights: Vec<f32>,
    /// Folds of a cell's three own edges, two bits each: the diagonal, the edge along x and the edge along z
    /// that start at the cell's own sample. Above them a bit that makes the cell a hole.
    pub(super) folds: Vec<u8>,
    /// Whether any cell is a hole.
    pub(super) has_holes: bool,
    /// Least and largest heights, from boxes of 4 x 4 cells up to one of everything.
    levels: Vec<Level>,
    /// Materials of cells.
    pub(crate) surfaces: Option<Box<Surfaces>>,
}

#[derive(Clone, Debug)]
struct Level {
    columns: usize,
    rows: usize,
    bounds: Vec<(f32, f32)>,
}

/// A box of the pyramid; level 0 are cells.
#[derive(Clone, Copy, Default)]
pub(super) struct Square {
    pub(super) level: u32,
    column: u32,
    row: u32,
    pub(super) entry: f32,
}

impl Square {
    /// One of its 4 x 4 children.
    #[inline(always)]
    pub(super) fn child(&self, column: u32, row: u32, entry: f32) -> Square {
        let (column, row) = (SIDE as u32 * self.column + column, SIDE as u32 * self.row + row);
        Square { level: self.level - 1, column, row, entry }
    }
}

fn check_heights(heights: &[f32]) -> Result<(), Error> {
    each("sample", heights, |&height| limits::coordinate("height", height))
}

impl HeightField {
    /// A field of `columns` times `rows` heights [m], row by row, with cells of `cell` along x and z [m].
    ///
    /// # Errors
    /// Fewer than two columns or rows, a number of heights that isn't their product, a height that is not
    /// finite or beyond 1e7, cells without size, or more than 2^31 triangles.
    pub fn new(columns: usize, rows: usize, cell: Vec2, heights: Vec<f32>) -> Result<HeightField, Error> {
        HeightField::with_folds(columns, rows, cell, heights, Vec::new())
    }

    /// The same with known folds of edges; none: they are found.
    pub(super) fn with_folds(
        columns: usize,
        rows: usize,
        cell: Vec2,
        heights: Vec<f32>,
        folds: Vec<u8>,
    ) -> Result<HeightField, Error> {
        let count = columns
            .checked_mul(rows)
            .filter(|&n| n < 1 << 30)
            .ok_or(Error::TooMany { what: "samples of a height field", most: 1 << 30 })?;
        within("height field columns", columns as f32, 2.0, f32::MAX, "at least 2")?;
        within("height field rows", rows as f32, 2.0, f32::MAX, "at least 2")?;
        positive("height field cell", cell.x)?;
        positive("height field cell", cell.y)?;
        within("height field width", cell.x * (columns - 1) as f32, 0.0, MAX_COORDINATE, "at most 1e7")?;
        within("height field depth", cell.y * (rows - 1) as f32, 0.0, MAX_COORDINATE, "at most 1e7")?;
        error::count("heights", "columns times rows", count, heights.len())?;
        check_heights(&heights)?;
        if !folds.is_empty() {
            error::count("folds", "one for each cell", (columns - 1) * (rows - 1), folds.len())?;
        }
        let has_holes = folds.iter().any(|&bits| bits & holes::HOLE != 0);
        let (levels, surfaces) = (Vec::new(), None);
        let mut field = HeightField { columns, rows, cell, heights, folds, has_holes, levels, surfaces };
        if field.folds.is_empty() {
            field.folds = field.find_folds();
        }
        field.levels = field.find_levels();
        // However it was made, it takes the same memory: a replay keeps to the same budget.
        field.heights.shrink_to_fit();
        field.folds.shrink_to_fit();
        field.levels.shrink_to_fit();
        Ok(field)
    }

    /// Corners of its bounding box [m].
    pub fn aabb(&self) -> (Vec3, Vec3) {
        let (low, high) = self.levels.last().map_or((0.0, 0.0), |top| top.bounds[0]);
        let far = self.corner(self.columns - 1, self.rows - 1);
        (Vec3::new(0.0, low, 0.0), Vec3::new(far.x, high, far.z))
    }

    /// How many triangles there are.
    pub fn triangle_count(&self) -> usize {
        2 * (self.columns - 1) * (self.rows - 1)
    }

    /// Bytes live and reserved.
    pub fn bytes(&self) -> (usize, usize) {
        let own = size_of::<Self>();
        let levels = self.levels.iter().map(|level| bytes_of(&level.bounds));
        let lists = [bytes_of(&self.heights), bytes_of(&self.folds), bytes_of(&self.levels)];
        sum_bytes(levels.chain(lists).chain([Surfaces::bytes(&self.surfaces), (own, own)]))
    }

    #[inline(always)]
    fn corner(&self, column: usize, row: usize) -> Vec3 {
        let height = self.heights[row * self.columns + column];
        Vec3::new(column as f32 * self.cell.x, height, row as f32 * self.cell.y)
    }

    /// Column and row of a triangle's cell, and which of the two it is.
    #[inline(always)]
    fn place(&self, i: u32) -> (usize, usize, bool) {
        let cell = i as usize / 2;
        (cell % (self.columns - 1), cell / (self.columns - 1), i & 1 == 1)
    }

    #[inline(always)]
    pub(crate) fn triangle(&self, i: u32) -> [Vec3; 3] {
        let (column, row, second) = self.place(i);
        let (v10, v01) = (self.corner(column + 1, row), self.corner(column, row + 1));
        if second {
            [v10, v01, self.corner(column + 1, row + 1)]
        } else {
            [self.corner(column, row), v01, v10]
        }
    }

    pub(crate) fn edges(&self, i: u32) -> Edges {
        let (column, row, second) = self.place(i);
        let fold = |column: usize, row: usize, edge: usize| {
            // Past the last cell lies the border.
            if column >= self.columns - 1 || row >= self.rows - 1 {
                return Fold::Open;
            }
            Fold::from_bits(u32::from(self.folds[row * (self.columns - 1) + column]) >> (2 * edge))
        };
        let diagonal = fold(column, row, 0);
        if second {
            Edges::new([diagonal, fold(column, row + 1, 1), fold(column + 1, row, 2)])
        } else {
            Edges::new([fold(column, row, 2), diagonal, fold(column, row, 1)])
        }
    }

    fn find_folds(&self) -> Vec<u8> {
        let mut folds = Vec::with_capacity((self.columns - 1) * (self.rows - 1));
        for row in 0..self.rows - 1 {
            for column in 0..self.columns - 1 {
                folds.push(self.cell_folds(column, row));
            }
        }
        folds
    }

    /// Folds of a cell's own edges, as if there were no holes.
    fn cell_folds(&self, column: usize, row: usize) -> u8 {
        let at = |dx: usize, dz: usize| self.corner(column + dx, row + dz);
        let diagonal = Fold::between(at(0, 1), at(1, 0), at(0, 0), at(1, 1));
        let along_x = if row == 0 {
            Fold::Open
        } else {
            Fold::between(at(1, 0), at(0, 0), at(0, 1), self.corner(column + 1, row - 1))
        };
        let along_z = if column == 0 {
            Fold::Open
        } else {
            Fold::between(at(0, 0), at(0, 1), at(1, 0), self.corner(column - 1, row + 1))
        };
        diagonal as u8 | (along_x as u8) << 2 | (along_z as u8) << 4
    }

    fn find_levels(&self) -> Vec<Level> {
        let mut levels: Vec<Level> = Vec::new();
        let (mut columns, mut rows) = (self.columns - 1, self.rows - 1);
        while levels.is_empty() || columns > 1 || rows > 1 {
            (columns, rows) = (columns.div_ceil(SIDE), rows.div_ceil(SIDE));
            let mut bounds = Vec::with_capacity(columns * rows);
            for row in 0..rows {
                for column in 0..columns {
                    bounds.push(self.square_bounds(&levels, column, row));
                }
            }
            levels.push(Level { columns, rows, bounds });
        }
        levels
    }

    /// Least and largest height of a box of the level above some levels.
    fn square_bounds(&self, below: &[Level], column: usize, row: usize) -> (f32, f32) {
        let level = below.last();
        let (columns, rows) = level.map_or((self.columns - 1, self.rows - 1), |l| (l.columns, l.rows));
        let mut all = (f32::MAX, f32::MIN);
        for r in row * SIDE..((row + 1) * SIDE).min(rows) {
            for c in column * SIDE..((column + 1) * SIDE).min(columns) {
                let (low, high) = level.map_or_else(|| self.cell_bounds(c, r), |l| l.bounds[r * columns + c]);
                all = (all.0.min(low), all.1.max(high));
            }
        }
        all
    }

    /// Least and largest height of a cell.
    #[inline(always)]
    fn cell_bounds(&self, column: usize, row: usize) -> (f32, f32) {
        let first = row * self.columns + column;
        let (near, far) = (&self.heights[first..first + 2], &self.heights[first + self.columns..][..2]);
        (near[0].min(near[1]).min(far[0].min(far[1])), near[0].max(near[1]).max(far[0].max(far[1])))
    }

    /// See [`Ground::visit_box`](super::Ground::visit_box).
    #[inline]
    pub(crate) fn visit_box(&self, min: Vec3, max: Vec3, f: &mut (impl FnMut(u32, [Vec3; 3]) + ?Sized)) {
        // The cells under the box are known; only their heights are to be looked at. A cell more on either
        // side, for the rounding; triangles are tested themselves.
        let cells = |low: f32, high: f32, size: f32, count: usize| {
            let first = (low / size - 1.0).clamp(0.0, count as f32) as usize;
            let last = (high / size + 2.0).clamp(0.0, count as f32) as usize;
            first..last
        };
        let columns = cells(min.x, max.x, self.cell.x, self.columns - 1);
        for row in cells(min.z, max.z, self.cell.y, self.rows - 1) {
            for column in columns.clone() {
                let (low, high) = self.cell_bounds(column, row);
                if low > max.y || high < min.y || self.is_hole(column, row) {
                    continue;
                }
                let first = 2 * (row * (self.columns - 1) + column) as u32;
                for i in [first, first + 1] {
                    let [a, b, c] = self.triangle(i);
                    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
                    if low.cmple(max).all() && high.cmpge(min).all() {
                        f(i, [a, b, c]);
                    }
                }
            }
        }
    }

    /// See [`Ground::visit_segment`](super::Ground::visit_segment).
    pub(crate) fn visit_segment(
        &self,
        from: Vec3,
        to: Vec3,
        inflate: Vec3,
        f: &mut (impl FnMut(u32, [Vec3; 3], f32) -> f32 + ?Sized),
    ) {
        self.along(&self.path(from, to, inflate), 1.0, &mut |i, corners, _, most| f(i, corners, most));
    }

    /// A path to be walked along in this field.
    pub(super) fn path(&self, from: Vec3, to: Vec3, inflate: Vec3) -> Path {
        let (min, max) = self.aabb();
        Path::new(from, to, inflate, 1e-6 * min.abs().max(max.abs()).max_element())
    }

    /// Calls `f(triangle, corners, entry, most)` with the triangles whose boxes a path enters before the
    /// fraction `most`, about the nearest first; it returns the new `most`.
    fn along(&self, path: &Path, most: f32, f: &mut impl FnMut(u32, [Vec3; 3], f32, f32) -> f32) {
        let four = |low, high| {
            let (meets, entry) = path.meets::<f32x4>(low, high);
            (meets.bits(), entry.to_array())
        };
        let one = |low, high| path.meets_one(low, high);
        self.nearest_first(most, &four, &one, f);
    }

    /// The top of the pyramid.
    pub(super) fn root(&self) -> Square {
        Square { level: self.levels.len() as u32, ..Square::default() }
    }

    /// The two triangles of a cell; none of a hole.
    pub(super) fn triangles_of(&self, cell: &Square) -> std::ops::Range<u32> {
        let (column, row) = (cell.column as usize, cell.row as usize);
        let first = 2 * (row * (self.columns - 1) + column) as u32;
        first..if self.is_hole(column, row) { first } else { first + 2 }
    }

    /// Walks down the pyramid, about the nearest first. `four` and `one` say of boxes, given by their lowest
    /// and highest corners, whether they matter and how near they are; `f` gets a triangle, how near its box
    /// is and the most that still matters, and returns the new most.
    fn nearest_first(
        &self,
        mut most: f32,
        four: &impl Fn(LaneVec3<f32x4>, LaneVec3<f32x4>) -> (u32, [f32; 4]),
        one: &impl Fn(Vec3, Vec3) -> Option<f32>,
        f: &mut impl FnMut(u32, [Vec3; 3], f32, f32) -> f32,
    ) {
        let mut stack = [Square::default(); STACK];
        stack[0] = self.root();
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let square = stack[waiting];
            if square.entry > most {
                continue;
            }
            if square.level == 0 {
                for i in self.triangles_of(&square) {
                    let [a, b, c] = self.triangle(i);
                    let entry = one(a.min(b).min(c), a.max(b).max(c));
                    if let Some(entry) = entry.filter(|&entry| entry <= most) {
                        most = f(i, [a, b, c], entry, most);
                    }
                }
                continue;
            }
            let base = waiting;
            for row in 0..SIDE as u32 {
                let (low, high, here) = self.row_of_four(&square, row);
                if here == 0 {
                    break;
                }
                let (bits, entry) = four(low, high);
                let bits = bits & here;
                for i in (0..SIDE as u32).filter(|i| bits >> i & 1 != 0) {
                    let entry = entry[i as usize];
                    if entry > most || waiting == STACK {
                        continue;
                    }
                    // The nearest on top.
                    let mut at = waiting;
                    while at > base && stack[at - 1].entry < entry {
                        stack[at] = stack[at - 1];
                        at -= 1;
                    }
                    stack[at] = square.child(i, row, entry);
                    waiting += 1;
                }
            }
        }
    }

    /// The boxes of four children of a square along x, their lowest and their highest corners, and which
    /// there are.
    #[inline]
    pub(super) fn row_of_four(&self, square: &Square, row: u32) -> (LaneVec3<f32x4>, LaneVec3<f32x4>, u32) {
        let level = square.level as usize - 1;
        let (columns, rows) = match level {
            0 => (self.columns - 1, self.rows - 1),
            _ => (self.levels[level - 1].columns, self.levels[level - 1].rows),
        };
        let (column, row) = (SIDE * square.column as usize, SIDE * square.row as usize + row as usize);
        if row >= rows {
            return (LaneVec3::zero(), LaneVec3::zero(), 0);
        }
        let here = (columns - column).min(SIDE);
        let bounds: [(f32, f32); 4] = std::array::from_fn(|i| {
            let column = column + i.min(here - 1);
            match level {
                0 => self.cell_bounds(column, row),
                _ => self.levels[level - 1].bounds[row * columns + column],
            }
        });
        let span = SIDE.pow(level as u32);
        let x = |i: usize| ((column + i) * span).min(self.columns - 1) as f32 * self.cell.x;
        let z = |row: usize| f32x4::splat((row * span).min(self.rows - 1) as f32 * self.cell.y);
        let low = LaneVec3::new(f32x4::from_fn(x), f32x4::from_fn(|i| bounds[i].0), z(row));
        let high = LaneVec3::new(f32x4::from_fn(|i| x(i + 1)), f32x4::from_fn(|i| bounds[i].1), z(row + 1));
        (low, high, (1 << here) - 1)
    }

    /// The triangles of [`Ground::ray`](super::Ground::ray).
    pub(super) fn ray(
        &self,
        test: &SegmentTest,
        from: Vec3,
        path: Vec3,
        any: bool,
        nearest: &mut (f32, u32),
    ) {
        self.along(&self.path(from, from + path, Vec3::ZERO), nearest.0, &mut |i, corners, entry, _| {
            if let Some(t) = test.hit(corners) {
                take(nearest, Lanes::max(t, entry), i);
            }
            if any && nearest.1 != u32::MAX { -1.0 } else { nearest.0 }
        });
    }

    /// See [`Ground::visit_path`](super::Ground::visit_path).
    pub(crate) fn visit_path(
        &self,
        from: glam::DVec3,
        path: Vec3,
        half: Vec3,
        most: f32,
        f: &mut impl FnMut(u32, [Vec3; 3], f32) -> f32,
    ) {
        let start = from.as_vec3();
        let path = self.path(start, start + path, half + (from - start.as_dvec3()).abs().as_vec3());
        self.along(&path, most, &mut |i, corners, _, most| f(i, corners, most));
    }

    /// See [`Ground::visit_near`](super::Ground::visit_near).
    pub(crate) fn visit_near(
        &self,
        at: glam::DVec3,
        most: f32,
        f: &mut impl FnMut(u32, [Vec3; 3], f32) -> f32,
    ) {
        let (near, nears) = (Near::<f32>::new(at), Near::<f32x4>::new(at));
        let four = |low, high| (0b1111, nears.squared(&low, &high).to_array());
        let one = |low, high| Some(near.squared(&LaneVec3::splat(low), &LaneVec3::splat(high)));
        self.nearest_first(most, &four, &one, &mut |i, corners, _, most| f(i, corners, most));
    }

    /// See [`Ground::any_in_box`](super::Ground::any_in_box).
    pub(crate) fn any_in_box(
        &self,
        min: Vec3,
        max: Vec3,
        f: &mut impl FnMut(u32, [Vec3; 3]) -> bool,
    ) -> bool {
        let mut any = false;
        self.visit_box(min, max, &mut |i, corners| any = any || f(i, corners));
        any
    }

    /// See [`Ground::nears`](super::Ground::nears).
    pub(crate) fn nears(&self, from: Vec3, to: Vec3, reach: f32) -> bool {
        self.any_in_box(from.min(to) - reach, from.max(to) + reach, &mut |_, corners| {
            !beyond::<f32>(corners.map(LaneVec3::splat), from, to, reach)
        })
    }

    /// Corners of a triangle [m], in the order of its winding, by the index that queries report; nothing if
    /// there is no such triangle.
    pub fn corners(&self, triangle: u32) -> Option<[Vec3; 3]> {
        ((triangle as usize) < self.triangle_count()).then(|| self.triangle(triangle))
    }

    /// The same field with materials of its cells, row by row: zero for that of the shape
    /// ([`ShapeDesc::material`](crate::ShapeDesc::material)), `i` for `materials[i - 1]`. A contact has the
    /// material of the cell that it is on. A byte a cell; the materials that it had are replaced.
    ///
    /// # Errors
    /// The number of cells isn't that of `of_cells`, which have a column and a row less than the samples; a
    /// number is beyond the table, which has at most 255 materials; or one of these is out of range.
    pub fn with_materials(mut self, of_cells: &[u8], materials: &[Material]) -> Result<HeightField, Error> {
        let cells = (self.columns - 1) * (self.rows - 1);
        self.surfaces = Some(Surfaces::new(cells, of_cells.to_vec(), materials.to_vec())?);
        Ok(self)
    }

    /// The table of materials; empty if all cells have that of the shape.
    pub fn materials(&self) -> &[Material] {
        Surfaces::table(&self.surfaces)
    }

    /// Which material a triangle has, by the index that queries report: zero for that of the shape, `i` for
    /// `materials()[i - 1]`.
    pub fn material_of(&self, triangle: u32) -> u8 {
        Surfaces::part(&self.surfaces, triangle as usize / 2)
    }
}

#[cfg(test)]
mod tests;
