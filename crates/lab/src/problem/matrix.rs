//! A square sparse matrix by rows.

use nalgebra::DMatrix;

/// A square matrix, of which each row has its columns that are not zero in ascending order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Matrix {
    /// Where each row begins, and where the last one ends.
    start: Vec<usize>,
    column: Vec<usize>,
    value: Vec<f64>,
}

impl Matrix {
    /// From entries (row, column, value) in any order; entries at the same place are added up, and zeros are
    /// left out. Panics if an index is out of range.
    pub fn from_entries(size: usize, entries: impl IntoIterator<Item = (usize, usize, f64)>) -> Matrix {
        let mut entries: Vec<_> = entries.into_iter().filter(|entry| entry.2 != 0.0).collect();
        // A stable sort, so that entries are added up in the order given.
        entries.sort_by_key(|&(row, column, _)| (row, column));
        let mut matrix = Matrix { start: vec![0; size + 1], ..Matrix::default() };
        let mut last = None;
        for (row, column, value) in entries {
            assert!(row < size && column < size, "an entry outside of the matrix");
            if last == Some((row, column)) {
                *matrix.value.last_mut().expect("one was pushed") += value;
                continue;
            }
            last = Some((row, column));
            matrix.column.push(column);
            matrix.value.push(value);
            matrix.start[row + 1] = matrix.value.len();
        }
        for row in 0..size {
            matrix.start[row + 1] = matrix.start[row + 1].max(matrix.start[row]);
        }
        matrix
    }

    /// A dense matrix without its zeros.
    pub fn from_dense(dense: &DMatrix<f64>) -> Matrix {
        let size = dense.nrows();
        let entries = (0..size).flat_map(|i| (0..size).map(move |j| (i, j, dense[(i, j)])));
        Matrix::from_entries(size, entries.filter(|entry| entry.2 != 0.0))
    }

    /// Rows, and columns.
    pub fn size(&self) -> usize {
        self.start.len().saturating_sub(1)
    }

    /// Entries that are stored.
    pub fn entries(&self) -> usize {
        self.value.len()
    }

    /// Columns and values of a row.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + Clone + '_ {
        let range = self.start[i]..self.start[i + 1];
        self.column[range.clone()].iter().copied().zip(self.value[range].iter().copied())
    }

    /// The entry at a place, zero if there is none.
    pub fn at(&self, i: usize, j: usize) -> f64 {
        let range = self.start[i]..self.start[i + 1];
        let found = self.column[range.clone()].binary_search(&j);
        found.map_or(0.0, |k| self.value[range.start + k])
    }

    /// A row times a vector.
    pub fn dot(&self, i: usize, x: &[f64]) -> f64 {
        self.row(i).map(|(j, value)| value * x[j]).sum()
    }

    /// As a dense matrix.
    pub fn dense(&self) -> DMatrix<f64> {
        let mut dense = DMatrix::zeros(self.size(), self.size());
        for i in 0..self.size() {
            self.row(i).for_each(|(j, value)| dense[(i, j)] = value);
        }
        dense
    }

    pub(super) fn values(&self) -> &[f64] {
        &self.value
    }
}
