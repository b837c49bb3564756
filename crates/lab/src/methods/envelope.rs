//! Cholesky's factor of a sparse symmetric matrix within its envelope.
//!
//! Each row of the factor is stored from its first entry to the diagonal; Cuthill and McKee's order,
//! reversed, keeps these short for matrices of contacts, where bodies touch their neighbours only. A full
//! matrix has a full triangle, at the cost of a dense factor.

use crate::problem::Matrix;

/// A gibibyte.
const LARGEST: usize = 1 << 27;

/// Where rows of the factor lie, for all matrices with the same entries.
#[derive(Clone, Debug)]
pub(super) struct Envelope {
    /// The row of the matrix at each place of the factor.
    order: Vec<usize>,
    place: Vec<usize>,
    /// The first column of each row of the factor, and where that is stored.
    first: Vec<usize>,
    start: Vec<usize>,
    /// The factor's rows, after each other.
    factor: Vec<f64>,
}

impl Envelope {
    /// The layout of a factor; the pattern of `matrix` counts as symmetric. None if the factor would have
    /// more than [`LARGEST`] numbers.
    pub(super) fn new(matrix: &Matrix) -> Option<Envelope> {
        let neighbours = neighbours(matrix);
        let order = reverse_cuthill_mckee(&neighbours);
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(k, &row)| place[row] = k);
        let least =
            |(k, &row): (usize, &usize)| neighbours[row].iter().map(|&j| place[j]).fold(k, usize::min);
        let first: Vec<usize> = order.iter().enumerate().map(least).collect();
        let mut start = vec![0];
        for (k, first) in first.iter().enumerate() {
            start.push(start[k] + k + 1 - first);
        }
        let size = start[order.len()];
        (size <= LARGEST).then(|| Envelope { order, place, first, start, factor: vec![0.0; size] })
    }

    /// Factors `D (A + Aᵀ)/2 D + shift I`, with `scale` as the diagonal D; false if it is not positive
    /// definite.
    pub(super) fn factorise(&mut self, matrix: &Matrix, scale: &[f64], shift: f64) -> bool {
        self.factor.fill(0.0);
        for row in 0..matrix.size() {
            for (column, value) in matrix.row(row) {
                let (i, j) =
                    (self.place[row].max(self.place[column]), self.place[row].min(self.place[column]));
                let half = if i == j { 1.0 } else { 0.5 };
                self.factor[self.start[i] + j - self.first[i]] += half * value * scale[row] * scale[column];
            }
        }
        for i in 0..self.order.len() {
            let (before, rest) = self.factor.split_at_mut(self.start[i]);
            let own = &mut rest[..i + 1 - self.first[i]];
            for j in self.first[i]..i {
                let from = self.first[i].max(self.first[j]);
                let other = &before[self.start[j] + from - self.first[j]..self.start[j + 1]];
                let (known, diagonal) = (&other[..other.len() - 1], other[other.len() - 1]);
                let sum = dot(&own[from - self.first[i]..j - self.first[i]], known);
                own[j - self.first[i]] = (own[j - self.first[i]] - sum) / diagonal;
            }
            let (known, diagonal) = own.split_at_mut(i - self.first[i]);
            let square = diagonal[0] + shift - dot(known, known);
            if !(square > 0.0 && square.is_finite()) {
                return false;
            }
            diagonal[0] = square.sqrt();
        }
        true
    }

    /// Solves with the factor, in place.
    pub(super) fn solve(&self, x: &mut [f64]) {
        let mut y: Vec<f64> = self.order.iter().map(|&row| x[row]).collect();
        let row = |i: usize| &self.factor[self.start[i]..self.start[i + 1]];
        for i in 0..y.len() {
            let (known, diagonal) = row(i).split_at(i - self.first[i]);
            y[i] = (y[i] - dot(known, &y[self.first[i]..i])) / diagonal[0];
        }
        for i in (0..y.len()).rev() {
            let (known, diagonal) = row(i).split_at(i - self.first[i]);
            y[i] /= diagonal[0];
            let own = y[i];
            y[self.first[i]..i].iter_mut().zip(known).for_each(|(y, l)| *y -= l * own);
        }
        self.order.iter().zip(y).for_each(|(&row, y)| x[row] = y);
    }
}

/// Four partial sums, which the processor can add in parallel; the order is always the same.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (fours, fours_b) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = fours.remainder().iter().zip(fours_b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in fours.zip(fours_b) {
        (0..4).for_each(|i| sums[i] += a[i] * b[i]);
    }
    sums[0] + sums[1] + (sums[2] + sums[3]) + rest
}

/// The other rows that each row has entries with, on either side of the diagonal.
fn neighbours(matrix: &Matrix) -> Vec<Vec<usize>> {
    let mut neighbours = vec![Vec::new(); matrix.size()];
    for i in 0..matrix.size() {
        for (j, _) in matrix.row(i).filter(|entry| entry.0 != i) {
            neighbours[i].push(j);
            neighbours[j].push(i);
        }
    }
    for list in &mut neighbours {
        list.sort_unstable();
        list.dedup();
    }
    neighbours
}

/// Breadth-first search in each component of the graph from a row at its edge, rows with few neighbours
/// first; then reversed.
fn reverse_cuthill_mckee(neighbours: &[Vec<usize>]) -> Vec<usize> {
    let mut order = Vec::with_capacity(neighbours.len());
    let mut seen = vec![false; neighbours.len()];
    for start in 0..neighbours.len() {
        if seen[start] {
            continue;
        }
        let begin = order.len();
        // The last row reached lies at an edge. The search is repeated from there, as the first path may have
        // been short.
        let mut from = start;
        for _ in 0..3 {
            for row in order.drain(begin..) {
                seen[row] = false;
            }
            breadth_first(neighbours, from, &mut seen, &mut order);
            from = order[order.len() - 1];
        }
    }
    order.reverse();
    order
}

fn breadth_first(neighbours: &[Vec<usize>], from: usize, seen: &mut [bool], order: &mut Vec<usize>) {
    let mut next = order.len();
    seen[from] = true;
    order.push(from);
    while next < order.len() {
        let level = order.len();
        for &j in &neighbours[order[next]] {
            if !seen[j] {
                seen[j] = true;
                order.push(j);
            }
        }
        order[level..].sort_by_key(|&j| (neighbours[j].len(), j));
        next += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of springs in a mixed-up order: entries at a distance of 7 rows, and back to itself.
    #[test]
    fn a_factor_solves_and_follows_the_chain() {
        let n = 60;
        let entries = (0..n).flat_map(|i| {
            let next = (i + 7) % n;
            [(i, i, 2.5), (i, next, -1.0), (next, i, -1.0)]
        });
        let matrix = Matrix::from_entries(n, entries);
        let mut envelope = Envelope::new(&matrix).unwrap();
        // Each row of a flattened ring reaches two rows back.
        assert!(envelope.factor.len() <= 3 * n, "{}", envelope.factor.len());
        assert!(envelope.factorise(&matrix, &vec![2.0; n], 0.5));
        let x: Vec<f64> = (0..n).map(|i| (i * i % 11) as f64 - 5.0).collect();
        let mut b: Vec<f64> = (0..n).map(|i| 4.0 * matrix.dot(i, &x) + 0.5 * x[i]).collect();
        envelope.solve(&mut b);
        assert!(x.iter().zip(&b).all(|(x, b)| (x - b).abs() < 1e-12));
        assert!(!envelope.factorise(&matrix, &vec![1.0; n], -1.0));
    }
}
