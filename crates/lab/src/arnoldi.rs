//! Leading eigenvalues of a linear map that is known only by its images of vectors.

use backstop_scene::Rng;
use nalgebra::{Complex, DMatrix, DVector};

/// An approximate eigenvalue with its vector `re + i im`, whose length is 1.
#[derive(Clone, Debug)]
pub(super) struct Ritz {
    pub(super) value: Complex<f64>,
    /// Length of `A v - value v`.
    pub(super) residual: f64,
    pub(super) re: Vec<f64>,
    pub(super) im: Vec<f64>,
}

impl Ritz {
    pub(super) fn modulus(&self) -> f64 {
        self.value.norm()
    }
}

pub(super) fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Random numbers in -1..=1.
pub(super) fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut rng = Rng::new(seed);
    move || rng.bits() as i64 as f64 / i64::MAX as f64
}

/// Arnoldi's method (*The principle of minimized iterations*, 1951) with modified Gram-Schmidt, done twice:
/// an orthonormal basis of `first, A first, A A first, ...`, and the eigenvalues of `A` seen in it. The
/// eigenvalue of greatest modulus comes first. A new basis vector that is no longer than `floor` is rounding
/// noise and ends the iteration: eigenvalues in a space of noise would be noise.
pub(super) fn arnoldi<E>(
    mut first: Vec<f64>,
    dimension: usize,
    floor: f64,
    mut apply: impl FnMut(&[f64]) -> Result<Vec<f64>, E>,
) -> Result<Vec<Ritz>, E> {
    let size = first.len();
    let most = dimension.min(size);
    let length = norm(&first);
    if length == 0.0 {
        return Ok(Vec::new());
    }
    first.iter_mut().for_each(|x| *x /= length);
    let mut basis = vec![first];
    let mut h = DMatrix::<f64>::zeros(most + 1, most);
    let (mut count, mut largest) = (0, 0.0_f64);
    while count < most {
        let mut w = apply(&basis[count])?;
        largest = largest.max(norm(&w));
        for _ in 0..2 {
            for (i, v) in basis.iter().enumerate() {
                let along: f64 = v.iter().zip(&w).map(|(a, b)| a * b).sum();
                h[(i, count)] += along;
                w.iter_mut().zip(v).for_each(|(a, b)| *a -= along * b);
            }
        }
        let left = norm(&w);
        h[(count + 1, count)] = left;
        count += 1;
        // The space is closed: it holds its eigenvalues exactly.
        if left.is_nan() || left <= floor.max(1e-12 * largest) {
            break;
        }
        w.iter_mut().for_each(|x| *x /= left);
        basis.push(w);
    }
    let last = h[(count, count - 1)];
    let small = h.view((0, 0), (count, count)).into_owned();
    if small.iter().any(|x| !x.is_finite()) {
        return Ok(Vec::new());
    }
    let mut found: Vec<Ritz> = Vec::new();
    for &value in small.complex_eigenvalues().iter() {
        let y = eigenvector(&small, value);
        let part = |of: fn(&Complex<f64>) -> f64| {
            let mut out = vec![0.0; size];
            for (v, y) in basis.iter().zip(y.iter()) {
                out.iter_mut().zip(v).for_each(|(o, x)| *o += of(y) * x);
            }
            out
        };
        let residual = (last * y[count - 1].norm()).abs();
        found.push(Ritz { value, residual, re: part(|y| y.re), im: part(|y| y.im) });
    }
    found.sort_by(|a, b| b.modulus().total_cmp(&a.modulus()));
    Ok(found)
}

/// The eigenvector by inverse iteration, scaled to length 1 with its greatest component real.
fn eigenvector(h: &DMatrix<f64>, value: Complex<f64>) -> DVector<Complex<f64>> {
    let n = h.nrows();
    // A shift close to the eigenvalue, but not equal to it: the matrix must not be singular.
    let beside = value + Complex::new(1e-10, 1e-10) * (1.0 + h.norm());
    let mut shifted = h.map(|x| Complex::new(x, 0.0));
    for i in 0..n {
        shifted[(i, i)] -= beside;
    }
    let lu = shifted.lu();
    let mut random = noise(7);
    let mut y = DVector::from_fn(n, |_, _| Complex::new(random(), 0.0));
    for _ in 0..3 {
        if let Some(next) = lu.solve(&y) {
            let length = next.norm();
            if length.is_finite() && length > 0.0 {
                y = next.map(|x| x / length);
            }
        }
    }
    let greatest = y.iter().copied().max_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap_or_default();
    if greatest.norm() > 0.0 {
        let turn = greatest.conj() / greatest.norm();
        y = y.map(|x| x * turn);
    }
    let length = y.norm();
    if length > 0.0 { y.map(|x| x / length) } else { y }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random(size: usize) -> Vec<f64> {
        let mut random = noise(3);
        (0..size).map(|_| random()).collect()
    }

    /// 1.5, a pair of modulus 1.1 that turns by 0.3, and many from 0 to 0.9; every number also feeds the one
    /// before it, so the vectors are far from orthogonal.
    #[test]
    fn the_leading_eigenvalues_of_a_known_map_are_found() {
        const SIZE: usize = 60;
        let (c, s) = (1.1 * 0.3_f64.cos(), 1.1 * 0.3_f64.sin());
        let apply = |x: &[f64]| -> Result<Vec<f64>, ()> {
            let mut y: Vec<f64> = (0..SIZE).map(|i| x[i] * 0.9 * i as f64 / SIZE as f64).collect();
            y[0] = 1.5 * x[0];
            (y[1], y[2]) = (c * x[1] - s * x[2], s * x[1] + c * x[2]);
            (3..SIZE - 1).for_each(|i| y[i] += 0.3 * x[i + 1]);
            y[0] += x[1];
            y[2] += x[3];
            Ok(y)
        };
        let found = arnoldi(random(SIZE), 50, 0.0, apply).unwrap();
        assert!((found[0].value - Complex::new(1.5, 0.0)).norm() < 1e-8, "{}", found[0].value);
        assert!((found[1].modulus() - 1.1).abs() < 1e-6, "{}", found[1].value);
        assert!((found[1].value.arg().abs() - 0.3).abs() < 1e-6, "{}", found[1].value);
        assert!(found[3].modulus() < 0.95);
        // Its vector is an eigenvector of the map.
        let y = apply(&found[0].re).unwrap();
        let off: Vec<f64> = y.iter().zip(&found[0].re).map(|(y, x)| y - 1.5 * x).collect();
        assert!(norm(&off) < 1e-7, "{}", norm(&off));
    }

    /// A shift of three numbers has no eigenvalue but zero, and its space closes early.
    #[test]
    fn a_map_that_forgets_has_nothing_left() {
        let apply = |x: &[f64]| -> Result<Vec<f64>, ()> { Ok(vec![x[1], x[2], 0.0]) };
        assert!(arnoldi(random(3), 10, 0.0, apply).unwrap().iter().all(|r| r.modulus() < 1e-3));
        assert!(arnoldi(Vec::new(), 10, 0.0, |_| Ok::<_, ()>(Vec::new())).unwrap().is_empty());
    }
}
