//! Spatial vectors: velocities and impulses with a linear and an angular part, and the matrices between them.

use crate::constraint::joint::ends::inverse;
use crate::lanes::{Lanes, Sym3, Vec3};
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

/// A linear map of velocities or impulses.
pub(crate) trait Map<L> {
    fn of(&self, unit: Twist<L>) -> Twist<L>;
}

/// See [`Sym6::joined_at`].
struct Joined<'a, L> {
    mobility: &'a Sym6<L>,
    arm: Vec3<L>,
    joined: &'a Sym6<L>,
}

impl<L: Lanes> Map<L> for Joined<'_, L> {
    #[inline(always)]
    fn of(&self, unit: Twist<L>) -> Twist<L> {
        let mut left = self.mobility.mul(&unit);
        let push = self.joined.mul(&left.seen_at(self.arm)).moved(self.arm);
        left.subtract(self.mobility.mul(&push));
        left
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
pub(crate) fn scaled<L: Lanes>(m: &Sym3<L>, by: L) -> Sym3<L> {
    Sym3 { xx: m.xx * by, yy: m.yy * by, zz: m.zz * by, xy: m.xy * by, xz: m.xz * by, yz: m.yz * by }
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
    /// From a body's mobility, its velocity per impulse, that of a point at an arm.
    #[inline(always)]
    pub(crate) fn mobility_at(&self, arm: Vec3<L>) -> Self {
        let (x, y, z) = axes::<L>();
        let over = [arm.cross(x), arm.cross(y), arm.cross(z)];
        let (own, rows, turned) = (columns(&self.linear), self.transposed_mixed(), columns(&self.angular));
        // Columns: the effect there of an impulse at the point without a torque, and of a torque.
        let (mut linear, mut mixed) = ([Vec3::zero(); 3], [Vec3::zero(); 3]);
        for k in 0..3 {
            let own = own[k] + mul(&self.mixed, over[k]);
            linear[k] = own + (rows[k] + self.angular.mul(over[k])).cross(arm);
            mixed[k] = self.mixed[k] + turned[k].cross(arm);
        }
        Sym6 { linear: symmetric(&linear), mixed, angular: self.angular }
    }

    /// The mobility of a body after a point at an arm has been joined to something else. `joined`: the
    /// impulse there per velocity that the joint forbids, of both together.
    ///
    /// Computed as a subtraction from the mobility: in terms of inertia, what remains of a light body with a
    /// heavy load is a difference of large numbers.
    #[inline(always)]
    pub(crate) fn joined_at(&self, arm: Vec3<L>, joined: &Sym6<L>) -> Self {
        Self::by_columns(&Joined { mobility: self, arm, joined })
    }

    /// The matrix of a map that is symmetric, from its product with each unit vector.
    #[inline(always)]
    pub(crate) fn by_columns(map: &impl Map<L>) -> Self {
        let (x, y, z) = axes::<L>();
        let zero = Vec3::zero();
        let (mut linear, mut mixed, mut angular) = ([zero; 3], [zero; 3], [zero; 3]);
        for (k, axis) in [x, y, z].into_iter().enumerate() {
            linear[k] = map.of(Twist { linear: axis, angular: zero }).linear;
            Twist { linear: mixed[k], angular: angular[k] } = map.of(Twist { linear: zero, angular: axis });
        }
        Sym6 { linear: symmetric(&linear), mixed, angular: symmetric(&angular) }
    }

    pub(crate) fn zero() -> Self {
        Sym6 { linear: Sym3::default(), mixed: [Vec3::zero(); 3], angular: Sym3::default() }
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
        for (taken, row) in taken.iter_mut().zip(self.transposed_mixed()) {
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

    #[inline(always)]
    fn transposed_mixed(&self) -> Mat3<L> {
        let m = &self.mixed;
        [
            Vec3::new(m[0].x, m[1].x, m[2].x),
            Vec3::new(m[0].y, m[1].y, m[2].y),
            Vec3::new(m[0].z, m[1].z, m[2].z),
        ]
    }
}

#[inline(always)]
fn axes<L: Lanes>() -> (Vec3<L>, Vec3<L>, Vec3<L>) {
    let (zero, one) = (L::zero(), L::one());
    (Vec3::new(one, zero, zero), Vec3::new(zero, one, zero), Vec3::new(zero, zero, one))
}
