//! The problem of one contact alone, solved exactly: three rows with Coulomb's law, or two with friction of a
//! given size.
//!
//! Where the point slides, `u_t = -k r_t` with some `k >= 0`, so that `(S + k I) r_t = -c`, with S the
//! tangents' block and, of a contact, the normal row eliminated by `u_n = 0`. What is left is one equation
//! for k: that `|r_t|` is as long as friction may be. (Bonnefon and Daviet 2011 bring it to a polynomial of
//! degree four; Bertails-Descoubes et al. 2011 compare solvers of it.)

/// A prepared block of three rows, normal first.
#[derive(Clone, Debug)]
pub(super) struct ContactBlock {
    w: [[f64; 3]; 3],
    mu: f64,
    /// Added to the diagonal if the block is not positive definite [1/kg]: the impulses then move towards the
    /// solution of the block, and still are at rest at that solution.
    proximal: f64,
    inverse: [[f64; 3]; 3],
    /// The block of the tangents, with the normal row eliminated.
    schur: [[f64; 2]; 2],
}

impl ContactBlock {
    /// `scale` [1/kg]: the magnitude of the block's numbers if its diagonal is zero. `hold`: the proximal
    /// term as a share of the mean of the diagonal, if it need not be greater.
    pub(super) fn new(w: [[f64; 3]; 3], mu: f64, scale: f64, hold: f64) -> ContactBlock {
        let trace = w[0][0].max(0.0) + w[1][1].max(0.0) + w[2][2].max(0.0);
        let least = 1e-6 * if trace > 0.0 { trace } else { scale };
        let mut proximal = hold * trace / 3.0;
        for _ in 0..64 {
            if let Some(block) = ContactBlock::with_proximal(w, mu, proximal, 1e-3 * least) {
                return block;
            }
            proximal = (4.0 * proximal).max(least);
        }
        // Numbers close to overflow: only a diagonal is kept.
        let w = [[scale, 0.0, 0.0], [0.0, scale, 0.0], [0.0, 0.0, scale]];
        let inverse = w.map(|row| row.map(|x| if x > 0.0 { 1.0 / x } else { 0.0 }));
        ContactBlock { w, mu, proximal: 0.0, inverse, schur: [[scale, 0.0], [0.0, scale]] }
    }

    /// None if the symmetric part of the reduced block of the tangents has an eigenvalue below `least`.
    fn with_proximal(w: [[f64; 3]; 3], mu: f64, proximal: f64, least: f64) -> Option<ContactBlock> {
        let mut m = w;
        (0..3).for_each(|i| m[i][i] += proximal);
        let normal = m[0][0];
        let schur = [1, 2].map(|i| [1, 2].map(|j| m[i][j] - m[i][0] * m[0][j] / normal));
        let (half, b) = (0.5 * (schur[0][0] - schur[1][1]), 0.5 * (schur[0][1] + schur[1][0]));
        let smallest = 0.5 * (schur[0][0] + schur[1][1]) - (half * half + b * b).sqrt();
        if normal.partial_cmp(&least)?.is_lt() || smallest.partial_cmp(&least)?.is_lt() {
            return None;
        }
        let inverse = inverse(&m)?;
        Some(ContactBlock { w, mu, proximal, inverse, schur })
    }

    /// The impulses that solve it while all others stay. `old`: its present impulses, with which its
    /// velocities are `u`.
    pub(super) fn solve(&self, old: [f64; 3], u: [f64; 3]) -> [f64; 3] {
        let b = [0, 1, 2].map(|i| u[i] - dot3(self.w[i], old) - self.proximal * old[i]);
        if b[0] >= 0.0 {
            return [0.0; 3];
        }
        let normal = self.w[0][0] + self.proximal;
        if self.mu == 0.0 {
            return [-b[0] / normal, 0.0, 0.0];
        }
        let stuck = self.inverse.map(|row| -dot3(row, b));
        if length([stuck[1], stuck[2]]) <= self.mu * stuck[0] {
            return stuck;
        }
        let c = [1, 2].map(|i| b[i] - self.w[i][0] * b[0] / normal);
        let coupling = [self.w[0][1] / normal, self.w[0][2] / normal];
        let radius = Radius { base: -self.mu * b[0] / normal, slope: coupling.map(|x| -self.mu * x) };
        let [x, y] = slide(self.schur, c, radius);
        let n = (-b[0] / normal - coupling[0] * x - coupling[1] * y).max(0.0);
        let share = self.mu * n / length([x, y]);
        // Rounding must not lead out of the cone.
        if share < 1.0 { [n, x * share, y * share] } else { [n, x, y] }
    }
}

/// The bound of friction [N s]: `base + slope . r_t`.
#[derive(Clone, Copy)]
struct Radius {
    base: f64,
    slope: [f64; 2],
}

/// Friction of at most `radius` on two rows with the block `w`, by the same law; `old` and `u` as for a
/// contact.
pub(super) fn solve_disc(w: [[f64; 2]; 2], radius: f64, old: [f64; 2], u: [f64; 2]) -> [f64; 2] {
    if radius <= 0.0 {
        return [0.0; 2];
    }
    let b = [0, 1].map(|i| u[i] - w[i][0] * old[0] - w[i][1] * old[1]);
    if let Some(stuck) = solve2(w, b).filter(|r| length(*r) <= radius) {
        return stuck.map(|x| -x);
    }
    let x = slide(w, b, Radius { base: radius, slope: [0.0; 2] });
    let share = radius / length(x);
    if share < 1.0 { x.map(|x| x * share) } else { x }
}

/// The tangential impulses `-(s + k I)^-1 c` with that `k >= 0` for which they are as long as `radius` says:
/// Newton's method on `radius / length - 1`, which is nearly linear in k, kept in a bracket by bisection.
fn slide(s: [[f64; 2]; 2], c: [f64; 2], radius: Radius) -> [f64; 2] {
    let at = |k: f64| {
        let shifted = [[s[0][0] + k, s[0][1]], [s[1][0], s[1][1] + k]];
        let r = solve2(shifted, c)?.map(|x| -x);
        let slower = solve2(shifted, r)?.map(|x| -x);
        let (size, rate) = (length(r), dot2(r, slower) / length(r));
        let most = radius.base + dot2(radius.slope, r);
        let value = most / size - 1.0;
        value.is_finite().then(|| (r, value, (dot2(radius.slope, slower) - (value + 1.0) * rate) / size))
    };
    let (mut low, mut high) = (0.0, s[0][0].abs() + s[1][1].abs() + s[0][1].abs() + s[1][0].abs());
    // Friction falls as k grows, and the normal impulse does not.
    for _ in 0..200 {
        match at(high) {
            Some((_, value, _)) if value < 0.0 => (low, high) = (high, 4.0 * high),
            _ => break,
        }
    }
    let mut k = if low > 0.0 { low } else { 0.25 * high };
    let mut found = [0.0; 2];
    for _ in 0..80 {
        let Some((r, value, rate)) = at(k) else { break };
        found = r;
        if value.abs() <= 4.0 * f64::EPSILON {
            break;
        }
        if value < 0.0 {
            low = k
        } else {
            high = k
        }
        let newton = k - value / rate;
        let middle = if low > 0.0 { (low * high).sqrt() } else { 1e-3 * high };
        let next = if newton > low && newton < high { newton } else { middle };
        if next == k || high - low <= f64::EPSILON * high {
            break;
        }
        k = next;
    }
    found
}

fn solve2(m: [[f64; 2]; 2], b: [f64; 2]) -> Option<[f64; 2]> {
    let determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    let size = (m[0][0] * m[1][1]).abs() + (m[0][1] * m[1][0]).abs();
    let x = [m[1][1] * b[0] - m[0][1] * b[1], m[0][0] * b[1] - m[1][0] * b[0]].map(|x| x / determinant);
    (determinant.abs() > 1e-14 * size && x.iter().all(|x| x.is_finite())).then_some(x)
}

fn inverse(m: &[[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let cofactor = |i: usize, j: usize| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
    let inverse = [0, 1, 2].map(|j| [0, 1, 2].map(|i| cofactor(i, j) / determinant));
    inverse.iter().flatten().all(|x| x.is_finite()).then_some(inverse)
}

fn dot2(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn dot3(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(x: [f64; 2]) -> f64 {
    dot2(x, x).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Law, Matrix, Problem};

    fn residual(w: [[f64; 3]; 3], q: [f64; 3], mu: f64, r: [f64; 3]) -> f64 {
        let entries = (0..9).map(|k| (k / 3, k % 3, w[k / 3][k % 3]));
        let problem =
            Problem::new(vec![Law::Contact { mu }], Matrix::from_entries(3, entries), q.to_vec()).unwrap();
        problem.residual(&r).relative
    }

    /// Blocks `A Aᵀ + d I` of random A, well and badly conditioned, and q from all around: the residual of
    /// the law is rounding.
    #[test]
    fn a_contact_alone_is_solved_to_rounding() {
        let mut random = crate::random::Random(1);
        let mut random = || random.range64(-1.0, 1.0);
        let mut worst = 0.0_f64;
        for trial in 0..20_000 {
            let a = [[(); 3]; 3].map(|row| row.map(|()| random()));
            let add = [1.0, 1e-2, 1e-4][trial % 3];
            let w = [0, 1, 2].map(|i| [0, 1, 2].map(|j| dot3(a[i], a[j]) + if i == j { add } else { 0.0 }));
            let q = [random(), random(), random()];
            let mu = [0.0, 0.1, 0.7, 2.0][trial % 4];
            let r = ContactBlock::new(w, mu, 1.0, 0.0).solve([0.0; 3], q);
            let found = residual(w, q, mu, r);
            worst = worst.max(found);
            assert!(found < 1e-10, "{w:?} {q:?} {mu}: {r:?} {found}");
        }
        assert!(worst > 0.0);
    }

    #[test]
    fn numbers_stay_finite_whatever_the_block_is() {
        let blocks = [
            [[0.0; 3]; 3],
            [[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0; 3]],
            [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            [[1e200; 3]; 3],
            [[1e-300, 0.0, 0.0], [0.0, 1e300, 0.0], [0.0, 0.0, 1.0]],
        ];
        for w in blocks {
            let r = ContactBlock::new(w, 0.5, 1.0, 0.0).solve([0.0; 3], [-1.0, 1.0, 2.0]);
            assert!(r.iter().all(|x| x.is_finite()), "{w:?}: {r:?}");
        }
        assert_eq!(solve_disc([[0.0; 2]; 2], 1.0, [0.0; 2], [0.0; 2]), [0.0; 2]);
    }
}
