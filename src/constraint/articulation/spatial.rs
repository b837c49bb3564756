//! Spatial vectors: velocities and impulses with a linear and an angular part, and the matrices between them.

use crate::constraint::joint::ends::inverse;
use crate::lanes::{Lanes, Sym3, Vec3, kernel};
use bytemuck::{Pod, Zeroable};

/// A matrix by its columns.
pub(crate) type Mat3<L> = [Vec3<L>; 3];

/// A linear and an angular part.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Twist<L> {
    pub(crate) linear: Vec3<L>,
    pub(crate) angular: Vec3<L>,
}

impl<L: Lanes> Twist<L> {
    pub(crate) fn zero() -> Self {
        Twist { linear: Vec3::zero(), angular: Vec3::zero() }
    }
    #[inline(always)]
    pub(crate) fn add(&mut self, o: Twist<L>) {
        self.linear += o.linear;
        self.angular += o.angular;
    }
    #[inline(always)]
    pub(crate) fn subtract(&mut self, o: Twist<L>) {
        self.linear -= o.linear;
        self.angular -= o.angular;
    }
    /// `yes` in some lanes, `no` in the others.
    #[inline(always)]
    pub(crate) fn select(lanes: L::Mask, yes: Self, no: Self) -> Self {
        Twist {
            linear: Vec3::select(lanes, yes.linear, no.linear),
            angular: Vec3::select(lanes, yes.angular, no.angular),
        }
    }
    #[inline(always)]
    pub(crate) fn scaled(self, by: L) -> Self {
        Twist { linear: self.linear * by, angular: self.angular * by }
    }
    #[inline(always)]
    pub(crate) fn dot(&self, o: &Twist<L>) -> L {
        self.linear.dot(o.linear) + self.angular.dot(o.angular)
    }
    /// Moves a force and a torque from a point at an arm to the centre.
    #[inline(always)]
    pub(crate) fn moved(self, arm: Vec3<L>) -> Self {
        Twist { linear: self.linear, angular: self.angular + arm.cross(self.linear) }
    }
    /// The velocity of a body as seen at a point at an arm.
    #[inline(always)]
    pub(crate) fn seen_at(&self, arm: Vec3<L>) -> Self {
        Twist { linear: self.at(arm), angular: self.angular }
    }
    /// Velocity of the point at an arm.
    #[inline(always)]
    pub(crate) fn at(&self, arm: Vec3<L>) -> Vec3<L> {
        self.linear + self.angular.cross(arm)
    }
}

/// A symmetric 6x6 matrix: linear, mixed (linear rows, angular columns) and angular blocks.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Sym6<L> {
    pub(crate) linear: Sym3<L>,
    pub(crate) mixed: Mat3<L>,
    pub(crate) angular: Sym3<L>,
}

// SAFETY: zero is a value of every field.
unsafe impl<L: Zeroable> Zeroable for Twist<L> {}
// SAFETY: it is nothing but lanes, of which any bits are numbers, in the order of C.
unsafe impl<L: Pod> Pod for Twist<L> {}
// SAFETY: as for `Twist`.
unsafe impl<L: Zeroable> Zeroable for Sym6<L> {}
// SAFETY: as for `Twist`.
unsafe impl<L: Pod> Pod for Sym6<L> {}

/// Response of a body to impulses at a point: its velocities per impulse along each axis, by columns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Through<L> {
    linear: Mat3<L>,
    angular: Mat3<L>,
}

impl<L: Lanes> Through<L> {
    /// The velocity of the point, which is at an arm, per impulse there.
    #[inline(always)]
    pub(crate) fn at(&self, arm: Vec3<L>) -> Sym3<L> {
        let ([x, y, z], [u, v, w]) = (self.linear, self.angular);
        Sym3 {
            xx: x.x + (u.y * arm.z - u.z * arm.y),
            yy: y.y + (v.z * arm.x - v.x * arm.z),
            zz: z.z + (w.x * arm.y - w.y * arm.x),
            xy: y.x + (v.y * arm.z - v.z * arm.y),
            xz: z.x + (w.y * arm.z - w.z * arm.y),
            yz: z.y + (w.z * arm.x - w.x * arm.z),
        }
    }
}

#[inline(always)]
fn mul<L: Lanes>(m: &Mat3<L>, v: Vec3<L>) -> Vec3<L> {
    m[0] * v.x + m[1] * v.y + m[2] * v.z
}

#[inline(always)]
fn mul_transposed<L: Lanes>(m: &Mat3<L>, v: Vec3<L>) -> Vec3<L> {
    Vec3::new(m[0].dot(v), m[1].dot(v), m[2].dot(v))
}

#[inline(always)]
fn columns<L: Lanes>(m: &Sym3<L>) -> Mat3<L> {
    [Vec3::new(m.xx, m.xy, m.xz), Vec3::new(m.xy, m.yy, m.yz), Vec3::new(m.xz, m.yz, m.zz)]
}

/// Reads a matrix that is symmetric except for rounding.
#[inline(always)]
fn symmetric<L: Lanes>(m: &Mat3<L>) -> Sym3<L> {
    Sym3 { xx: m[0].x, yy: m[1].y, zz: m[2].z, xy: m[1].x, xz: m[2].x, yz: m[2].y }
}

#[inline(always)]
fn transposed<L: Lanes>(m: &Mat3<L>) -> Mat3<L> {
    [Vec3::new(m[0].x, m[1].x, m[2].x), Vec3::new(m[0].y, m[1].y, m[2].y), Vec3::new(m[0].z, m[1].z, m[2].z)]
}

/// The product of a matrix and the matrix of the cross product with an arm.
#[inline(always)]
fn times_cross<L: Lanes>(m: &Mat3<L>, arm: Vec3<L>) -> Mat3<L> {
    [m[1] * arm.z - m[2] * arm.y, m[2] * arm.x - m[0] * arm.z, m[0] * arm.y - m[1] * arm.x]
}

/// The product of two matrices.
#[inline(always)]
fn times<L: Lanes>(a: &Mat3<L>, b: &Mat3<L>) -> Mat3<L> {
    [mul(a, b[0]), mul(a, b[1]), mul(a, b[2])]
}

/// The product of a matrix and the transpose of another, if it is symmetric.
#[inline(always)]
fn outer<L: Lanes>(a: &Mat3<L>, b: &Mat3<L>) -> Sym3<L> {
    Sym3 {
        xx: a[0].x * b[0].x + a[1].x * b[1].x + a[2].x * b[2].x,
        yy: a[0].y * b[0].y + a[1].y * b[1].y + a[2].y * b[2].y,
        zz: a[0].z * b[0].z + a[1].z * b[1].z + a[2].z * b[2].z,
        xy: a[0].x * b[0].y + a[1].x * b[1].y + a[2].x * b[2].y,
        xz: a[0].x * b[0].z + a[1].x * b[1].z + a[2].x * b[2].z,
        yz: a[0].y * b[0].z + a[1].y * b[1].z + a[2].y * b[2].z,
    }
}

/// `s - s k s`.
#[inline(always)]
pub(crate) fn less_sandwich<L: Lanes>(s: &Sym3<L>, k: &Sym3<L>) -> Sym3<L> {
    let s = columns(s);
    minus(&symmetric(&s), &outer(&times(&s, &columns(k)), &s))
}

#[inline(always)]
fn minus<L: Lanes>(a: &Sym3<L>, b: &Sym3<L>) -> Sym3<L> {
    Sym3 {
        xx: a.xx - b.xx,
        yy: a.yy - b.yy,
        zz: a.zz - b.zz,
        xy: a.xy - b.xy,
        xz: a.xz - b.xz,
        yz: a.yz - b.yz,
    }
}

#[inline(always)]
pub(crate) fn plus<L: Lanes>(a: &Sym3<L>, b: &Sym3<L>) -> Sym3<L> {
    Sym3 {
        xx: a.xx + b.xx,
        yy: a.yy + b.yy,
        zz: a.zz + b.zz,
        xy: a.xy + b.xy,
        xz: a.xz + b.xz,
        yz: a.yz + b.yz,
    }
}

impl<L: Lanes> Sym6<L> {
    /// The response to impulses at a point at an arm, from a body's mobility (its velocity per impulse).
    #[inline(always)]
    pub(crate) fn through(&self, arm: Vec3<L>) -> Through<L> {
        let linear = times_cross(&self.mixed, arm);
        let angular = times_cross(&columns(&self.angular), arm);
        let (own, rows) = (columns(&self.linear), transposed(&self.mixed));
        Through {
            linear: [own[0] + linear[0], own[1] + linear[1], own[2] + linear[2]],
            angular: [rows[0] + angular[0], rows[1] + angular[1], rows[2] + angular[2]],
        }
    }

    /// The mobility of the point at an arm.
    #[inline(always)]
    pub(crate) fn mobility_at(&self, arm: Vec3<L>) -> Self {
        let through = self.through(arm);
        Sym6 { linear: through.at(arm), mixed: transposed(&through.angular), angular: self.angular }
    }

    /// The mobility of a body after a point of it has been joined to something else, which it turns about
    /// freely. `joined`: the impulse there per velocity of the point.
    ///
    /// Computed as a subtraction from the mobility: in terms of inertia, the rest of a light body with a
    /// heavy load is a difference of large numbers.
    #[inline(always)]
    pub(crate) fn pinned(&self, through: &Through<L>, joined: &Sym3<L>) -> Self {
        let joined = columns(joined);
        let Through { linear, angular } = through;
        let more = times(linear, &joined);
        let mut mixed = self.mixed;
        let rows = transposed(angular);
        for (mixed, row) in mixed.iter_mut().zip(rows) {
            *mixed -= mul(&more, row);
        }
        Sym6 {
            linear: minus(&self.linear, &outer(&more, linear)),
            mixed,
            angular: minus(&self.angular, &outer(&times(angular, &joined), angular)),
        }
    }

    /// The same, joined in rotations too. `joined`: the impulse there per velocity that the joint forbids.
    #[inline(always)]
    pub(crate) fn joined_at(&self, arm: Vec3<L>, joined: &Sym6<L>) -> Self {
        less(self, &self.through(arm), joined)
    }

    /// `s - s k s`.
    #[inline(always)]
    pub(crate) fn less_sandwich(&self, k: &Sym6<L>) -> Self {
        less(self, &Through { linear: columns(&self.linear), angular: transposed(&self.mixed) }, k)
    }

    #[inline(always)]
    pub(crate) fn add(&mut self, o: &Sym6<L>) {
        (self.linear, self.angular) = (plus(&self.linear, &o.linear), plus(&self.angular, &o.angular));
        for (own, column) in self.mixed.iter_mut().zip(o.mixed) {
            *own += column;
        }
    }

    #[inline(always)]
    pub(crate) fn mul(&self, t: &Twist<L>) -> Twist<L> {
        Twist {
            linear: self.linear.mul(t.linear) + mul(&self.mixed, t.angular),
            angular: mul_transposed(&self.mixed, t.linear) + self.angular.mul(t.angular),
        }
    }

    /// The inverse by the Schur complement of the angular block, of which `r` is the inverse. Directions that
    /// `r` leaves out give zero.
    #[inline(always)]
    pub(crate) fn inverse_with(&self, r: Sym3<L>) -> Self {
        // mixed · r, column by column.
        let (mut qr, mut taken) = ([Vec3::zero(); 3], [Vec3::zero(); 3]);
        for (qr, column) in qr.iter_mut().zip(columns(&r)) {
            *qr = mul(&self.mixed, column);
        }
        for (taken, row) in taken.iter_mut().zip(transposed(&self.mixed)) {
            *taken = mul(&qr, row);
        }
        let linear = inverse(&minus(&self.linear, &symmetric(&taken)));
        // r + (mixed r)ᵀ linear (mixed r)
        let (mut mixed, mut more) = ([Vec3::zero(); 3], [Vec3::zero(); 3]);
        for k in 0..3 {
            mixed[k] = -linear.mul(qr[k]);
            more[k] = -mul_transposed(&qr, mixed[k]);
        }
        Sym6 { linear, mixed, angular: plus(&r, &symmetric(&more)) }
    }
}

kernel! {
    /// A mobility less that of a body joined at a point: `joined` is the impulse there per velocity.
    fn less<'a, L: Lanes>(of: &'a Sym6<L>, through: &'a Through<L>, joined: &'a Sym6<L>) -> Sym6<L> {
        let Through { linear, angular } = through;
        let (mixed, own) = (&of.mixed, columns(&of.angular));
        let (along, about, across) = (columns(&joined.linear), columns(&joined.angular), &joined.mixed);
        // Velocities per velocity of the point: by impulses there, and by torques.
        let back = transposed(across);
        let mut more = [times(linear, &along), times(angular, &along)];
        let mut turned = [times(linear, across), times(angular, across)];
        for k in 0..3 {
            more[0][k] += mul(mixed, back[k]);
            more[1][k] += mul(&own, back[k]);
            turned[0][k] += mul(mixed, about[k]);
            turned[1][k] += mul(&own, about[k]);
        }
        let mut left = *mixed;
        let rows = transposed(angular);
        for k in 0..3 {
            left[k] -= mul(&more[0], rows[k]) + mul(&turned[0], own[k]);
        }
        Sym6 {
            linear: minus(&of.linear, &plus(&outer(&more[0], linear), &outer(&turned[0], mixed))),
            mixed: left,
            angular: minus(&of.angular, &plus(&outer(&more[1], angular), &outer(&turned[1], &own))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    type Dense = [[f64; 6]; 6];

    fn rows(of: &Sym6<f32>) -> Dense {
        let mixed = transposed(&of.mixed);
        let block = |m: &Mat3<f32>, i: usize, k: usize| f64::from(m[k].lane(0)[i]);
        std::array::from_fn(|i| {
            std::array::from_fn(|k| match (i < 3, k < 3) {
                (true, true) => block(&columns(&of.linear), i, k),
                (true, false) => block(&of.mixed, i, k - 3),
                (false, true) => block(&mixed, i - 3, k),
                (false, false) => block(&columns(&of.angular), i - 3, k - 3),
            })
        })
    }

    fn product(a: &Dense, b: &Dense) -> Dense {
        std::array::from_fn(|i| std::array::from_fn(|k| (0..6).map(|j| a[i][j] * b[j][k]).sum()))
    }

    fn turned(a: &Dense) -> Dense {
        std::array::from_fn(|i| std::array::from_fn(|k| a[k][i]))
    }

    fn difference(a: &Dense, b: &Dense) -> Dense {
        std::array::from_fn(|i| std::array::from_fn(|k| a[i][k] - b[i][k]))
    }

    /// A symmetric matrix with positive eigenvalues.
    fn positive(random: &mut Random) -> Sym6<f32> {
        let a: Dense = std::array::from_fn(|_| std::array::from_fn(|_| f64::from(random.signed())));
        let mut m = product(&a, &turned(&a));
        (0..6).for_each(|i| m[i][i] += 0.3);
        let at = |i: usize, k: usize| m[i][k] as f32;
        let block = |o: usize| Sym3 {
            xx: at(o, o),
            yy: at(o + 1, o + 1),
            zz: at(o + 2, o + 2),
            xy: at(o, o + 1),
            xz: at(o, o + 2),
            yz: at(o + 1, o + 2),
        };
        let mixed = std::array::from_fn(|k| Vec3::new(at(0, k + 3), at(1, k + 3), at(2, k + 3)));
        Sym6 { linear: block(0), mixed, angular: block(3) }
    }

    /// From velocities of a body to those of its point at an arm.
    fn seen_at(arm: Vec3<f32>) -> Dense {
        let [x, y, z] = [arm.x, arm.y, arm.z].map(f64::from);
        let mut m = [[0.0; 6]; 6];
        (0..6).for_each(|i| m[i][i] = 1.0);
        (m[0][4], m[0][5], m[1][3], m[1][5], m[2][3], m[2][4]) = (z, -y, -z, x, y, -x);
        m
    }

    fn check(what: &str, found: &Dense, expected: &Dense, size: f64) {
        let off = difference(found, expected);
        let most = off.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
        assert!(most < 1e-6 * size, "{what}: off by {most} at sizes of {size}");
    }

    /// Beside the products of dense matrices in `f64`.
    #[test]
    fn matrices_are_what_their_dense_ones_give() {
        for seed in 0..200 {
            let mut random = Random(seed);
            let (m, k, arm) = (positive(&mut random), positive(&mut random), Vec3::splat(random.cube()));
            let (dense, joined, to) = (rows(&m), rows(&k), seen_at(arm));
            let back = turned(&to);
            // The largest entries are below 15.
            let there = product(&to, &product(&dense, &back));
            check("at a point", &rows(&m.mobility_at(arm)), &there, 100.0);
            let pushed = product(&dense, &back);
            let less = |j: &Dense| difference(&dense, &product(&pushed, &product(j, &turned(&pushed))));
            check("joined", &rows(&m.joined_at(arm, &k)), &less(&joined), 1e4);
            let mut point = [[0.0; 6]; 6];
            (0..3).for_each(|i| point[i][..3].copy_from_slice(&joined[i][..3]));
            check("pinned", &rows(&m.pinned(&m.through(arm), &k.linear)), &less(&point), 1e4);
            let sandwich = difference(&dense, &product(&dense, &product(&joined, &dense)));
            check("sandwich", &rows(&m.less_sandwich(&k)), &sandwich, 1e4);
            let own = less_sandwich(&m.linear, &k.linear);
            let padded = |linear| Sym6 { linear, mixed: [Vec3::zero(); 3], angular: Sym3::default() };
            let [s, k] = [m.linear, k.linear].map(|linear| rows(&padded(linear)));
            let expected = difference(&s, &product(&s, &product(&k, &s)));
            check("small sandwich", &rows(&padded(own)), &expected, 1e4);
            let one = product(&dense, &rows(&m.inverse_with(inverse(&m.angular))));
            check("inverse", &one, &seen_at(Vec3::zero()), 1e3);
        }
    }
}
