//! Global problems: with masses and velocities of bodies, which are eliminated.

use super::Matrix;
use nalgebra::{DMatrix, DVector};

/// The most velocities that the mass matrix may couple, as each coupled block is inverted densely.
pub(super) const COUPLED: usize = 3000;

/// The entries (row, column, value) of a matrix that need not be square, all of them inside of it.
pub(super) struct Sparse {
    pub(super) rows: usize,
    pub(super) columns: usize,
    pub(super) entries: Vec<(usize, usize, f64)>,
}

/// `W = Hᵀ M⁻¹ H` and `q = w + Hᵀ M⁻¹ f`, a group of coupled velocities (a body, as a rule) at a time.
pub(super) fn eliminate(
    mass: &Sparse,
    h: &Sparse,
    f: &[f64],
    mut q: Vec<f64>,
) -> Result<(Matrix, Vec<f64>), String> {
    let mut entries = Vec::new();
    let by_row = |sparse: &Sparse| {
        let mut rows = vec![Vec::new(); sparse.rows];
        // Zeros that are stored couple nothing.
        sparse.entries.iter().filter(|e| e.2 != 0.0).for_each(|&(i, j, x)| rows[i].push((j, x)));
        rows
    };
    let (mass_rows, h_rows) = (by_row(mass), by_row(h));
    for velocities in coupled(mass) {
        let size = velocities.len();
        if size > COUPLED {
            return Err(format!(
                "the mass matrix couples {size} velocities, and at most {COUPLED} are supported"
            ));
        }
        let mut m = DMatrix::zeros(size, size);
        for (i, &velocity) in velocities.iter().enumerate() {
            for &(column, x) in &mass_rows[velocity] {
                let j = velocities.binary_search(&column).expect("coupled velocities are in one group");
                m[(i, j)] += x;
            }
        }
        let factor = m.cholesky().ok_or("the mass matrix must be positive definite")?;
        let mut columns: Vec<usize> =
            velocities.iter().flat_map(|&v| h_rows[v].iter().map(|e| e.0)).collect();
        columns.sort_unstable();
        columns.dedup();
        let mut part = DMatrix::zeros(size, columns.len());
        for (i, &velocity) in velocities.iter().enumerate() {
            for &(column, x) in &h_rows[velocity] {
                part[(i, columns.binary_search(&column).expect("it was listed"))] += x;
            }
        }
        let force = DVector::from_iterator(size, velocities.iter().map(|&v| f[v]));
        let free = part.tr_mul(&factor.solve(&force));
        // By way of L⁻¹ H, whose Gram matrix is symmetric to the last bit.
        let root = factor.l_dirty().solve_lower_triangular(&part).expect("a Cholesky factor is regular");
        for (a, &i) in columns.iter().enumerate() {
            q[i] += free[a];
            entries.extend(
                columns.iter().enumerate().map(|(b, &j)| (i, j, root.column(a).dot(&root.column(b)))),
            );
        }
    }
    Ok((Matrix::from_entries(h.columns, entries), q))
}

/// Groups of rows that entries couple, each in ascending order.
fn coupled(matrix: &Sparse) -> Vec<Vec<usize>> {
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    let mut parent: Vec<usize> = (0..matrix.rows).collect();
    for &(i, j, x) in &matrix.entries {
        let (a, b) = (root(&mut parent, i), root(&mut parent, j));
        if x != 0.0 {
            parent[a.max(b)] = a.min(b);
        }
    }
    let mut groups = vec![Vec::new(); matrix.rows];
    for i in 0..matrix.rows {
        groups[root(&mut parent, i)].push(i);
    }
    groups.retain(|group| !group.is_empty());
    groups
}
