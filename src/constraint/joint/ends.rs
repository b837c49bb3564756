//! The two bodies of each lane, which all rows of joints have, and how these turn within a step.

use crate::constraint::contact::batch::unlocked;
use crate::constraint::contact::body_pair::Written;
use crate::constraint::contact::row::{BodyPair, Motion, Softness};
use crate::lanes::{GatherLanes, Lanes, Record, Sym3, Vec3, scatter};
use crate::threads::Shared;
use bytemuck::Zeroable;

/// Maximum speeds at which errors of joints are corrected.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Recovery {
    /// For lengths [m/s].
    pub(crate) linear: f32,
    /// For angles, with any length unit [rad/s].
    pub(crate) angular: f32,
}

/// Parameters of a pass over the rows of joints.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointPass {
    /// 1 / substep [1/s].
    pub(crate) inverse_h: f32,
    pub(crate) softness: Softness,
    pub(crate) recovery: Recovery,
    /// Bodies were moved since the rows were last looked at. Trees follow when their bodies are moved.
    pub(crate) moved: bool,
    /// No pass was solved since then: impulses of the last substep are turned with the bodies.
    pub(crate) fresh: bool,
    /// Remove the velocities that the correction of errors added.
    pub(crate) relax: bool,
}

impl JointPass {
    /// For velocities at the current positions.
    pub(crate) fn relaxing(inverse_h: f32) -> JointPass {
        let softness = Softness::RIGID;
        JointPass {
            inverse_h,
            softness,
            recovery: Recovery::default(),
            moved: false,
            fresh: false,
            relax: true,
        }
    }

    /// Speed per error [1/s], and which shares of an impulse are applied and given up.
    #[inline(always)]
    pub(crate) fn numbers<L: Lanes>(&self) -> (L, L, L) {
        let Softness { bias_rate, mass_scale, impulse_scale, .. } = self.softness;
        let (rate, scale, give) =
            if self.relax { (0.0, 1.0, 0.0) } else { (bias_rate, mass_scale, impulse_scale) };
        (L::splat(rate), L::splat(scale), L::splat(give))
    }
}

/// Instead of an index: an inert lane.
pub(crate) const NONE: u32 = u32::MAX;

/// The bodies of up to eight rows; no dynamic body occurs twice.
#[derive(Clone, Copy, Debug, Zeroable)]
#[repr(C)]
pub(crate) struct Ends<L> {
    /// [1/kg]
    pub(crate) inverse_mass: [L; 2],
    pub(crate) inverse_inertia: [Sym3<L>; 2],
    /// Indices of the records; an inert lane repeats lane 0.
    pub(crate) body: [[u32; 8]; 2],
    /// Bit per lane: the body may be written.
    pub(crate) write: [u32; 2],
    /// Axes along which the bodies are locked: see [`unlocked`].
    pub(crate) locks: [u32; 2],
    /// The locks or rows to which the impulses are written back.
    pub(crate) owner: [u32; 8],
}

impl<L: Lanes> Default for Ends<L> {
    #[inline(always)]
    fn default() -> Self {
        Ends {
            // Nonzero, so that inert lanes stay finite.
            inverse_mass: [L::one(), L::zero()],
            owner: [NONE; 8],
            ..Zeroable::zeroed()
        }
    }
}

impl<L: GatherLanes> Ends<L> {
    /// # Safety
    /// As for [`BodyPair::load`].
    #[inline(always)]
    pub(crate) unsafe fn load(&self, records: &Shared<'_, Record>) -> BodyPair<L> {
        // SAFETY: by the contract.
        unsafe { BodyPair::load_bodies(&self.body[0], Some(&self.body[1]), records) }
    }

    /// # Safety
    /// As for [`BodyPair::load`].
    #[inline(always)]
    pub(crate) unsafe fn save(&self, v: &BodyPair<L>, motion: &Motion<'_, '_>) {
        // SAFETY: by the contract.
        unsafe {
            let [a, b] = [0, 1].map(|i| Written { index: &self.body[i], lanes: self.write[i] });
            v.save_bodies(a, Some(b), motion.velocity)
        }
    }

    /// Writes displacements, but keeps the marks of their records.
    ///
    /// # Safety
    /// As for [`BodyPair::load`], of displacements.
    #[inline(always)]
    pub(crate) unsafe fn save_moved(&self, d: &BodyPair<L>, motion: &Motion<'_, '_>) {
        for (side, out) in [scatter(d.va, d.wa), scatter(d.vb, d.wb)].into_iter().enumerate() {
            for lane in (0..L::N).filter(|lane| self.write[side] >> lane & 1 != 0) {
                // SAFETY: by the contract.
                let to = unsafe { motion.delta.get(self.body[side][lane] as usize) };
                (to.linear, to.angular) = (out[lane].linear, out[lane].angular);
            }
        }
    }

    /// Applies an impulse to the second body and its opposite to the first, with the angular impulses `ta`
    /// (subtracted from the first) and `tb`.
    #[inline(always)]
    pub(crate) fn apply(&self, v: &mut BodyPair<L>, p: Vec3<L>, ta: Vec3<L>, tb: Vec3<L>) {
        let [on_a, on_b] = self.moving(p);
        v.va -= on_a * self.inverse_mass[0];
        v.wa -= self.inverse_inertia[0].mul(ta);
        v.vb += on_b * self.inverse_mass[1];
        v.wb += self.inverse_inertia[1].mul(tb);
    }

    /// The part of an impulse on both bodies that moves each of them.
    #[inline(always)]
    pub(crate) fn moving(&self, p: Vec3<L>) -> [Vec3<L>; 2] {
        if self.locks == [0; 2] { [p; 2] } else { [unlocked(self.locks[0], p), unlocked(self.locks[1], p)] }
    }

    /// Relative angular velocity of the second body per angular impulse [1/(kg m²)].
    #[inline(always)]
    pub(crate) fn turning(&self) -> Sym3<L> {
        let [a, b] = &self.inverse_inertia;
        // If rotation is locked, some directions may be missing.
        let tiny = (a.xx + a.yy + a.zz + b.xx + b.yy + b.zz) * L::splat(TINY);
        Sym3 {
            xx: a.xx + b.xx + tiny,
            yy: a.yy + b.yy + tiny,
            zz: a.zz + b.zz + tiny,
            xy: a.xy + b.xy,
            xz: a.xz + b.xz,
            yz: a.yz + b.yz,
        }
    }

    /// Change of the speed along a lever per impulse along it [1/kg] or [1/(kg m²)].
    #[inline(always)]
    pub(crate) fn mobility(&self, lever: &Lever<L>) -> L {
        let [ta, tb] = lever.moments();
        let [on_a, on_b] = self.moving(lever.force);
        on_a.length_squared() * self.inverse_mass[0]
            + on_b.length_squared() * self.inverse_mass[1]
            + ta.dot(self.inverse_inertia[0].mul(ta))
            + tb.dot(self.inverse_inertia[1].mul(tb))
    }

    /// Applies an angular impulse.
    #[inline(always)]
    pub(crate) fn turn(&self, v: &mut BodyPair<L>, t: Vec3<L>) {
        v.wa -= self.inverse_inertia[0].mul(t);
        v.wb += self.inverse_inertia[1].mul(t);
    }
}

/// A direction of relative motion and of impulses: a force on the second body at a point, the opposite one on
/// the first at the same point, and a torque.
#[derive(Clone, Copy, Debug, Zeroable)]
#[repr(C)]
pub(crate) struct Lever<L> {
    pub(crate) force: Vec3<L>,
    pub(crate) torque: Vec3<L>,
    /// From each centre of mass to the point, which belongs to the second body [m].
    pub(crate) arm: [Vec3<L>; 2],
}

impl<L: Lanes> Lever<L> {
    pub(crate) fn zero() -> Self {
        Lever { force: Vec3::zero(), torque: Vec3::zero(), arm: [Vec3::zero(); 2] }
    }
    /// Torques about the centres of mass, that of the first body negated.
    #[inline(always)]
    pub(crate) fn moments(&self) -> [Vec3<L>; 2] {
        let [a, b] = self.arm;
        [self.torque + a.cross(self.force), self.torque + b.cross(self.force)]
    }
}

impl<L: GatherLanes> Lever<L> {
    /// Relative speed along it.
    #[inline(always)]
    pub(crate) fn speed(&self, v: &BodyPair<L>) -> L {
        self.force.dot(seen(v, &self.arm, L::zero())) + self.torque.dot(v.wb - v.wa)
    }
}

/// Mean velocity of a point of a turning body over a time: the factor on its velocity, and that on its
/// acceleration [s].
///
/// Joints are to hold at the end of the substep: solved for the start, a point would be off by `(w h)² r / 2`
/// after each. Together with relaxing, which makes velocities fit the new positions, this is RATTLE
/// (Andersen, 1983): no energy is lost on a curved path. Rotations of a radian in a substep, which come from
/// rows whose requests can't be met, are linearised at the start.
#[inline(always)]
pub(crate) fn mean_of<L: Lanes>(w: Vec3<L>, h: L) -> (L, L) {
    let x = (w.length_squared() * (h * h)).min(L::splat(4.0));
    let some = (L::one() - x * x).max(L::zero());
    let sine = L::one() - x * some * L::splat(1.0 / 6.0);
    let cosine = some * (L::splat(0.5) - x * L::splat(1.0 / 24.0));
    (sine, cosine * h)
}

/// The mean velocity of a point at an arm over a time, less its current one, of a body that goes on turning.
#[inline(always)]
pub(crate) fn bend<L: Lanes>(w: Vec3<L>, arm: Vec3<L>, h: L) -> Vec3<L> {
    let (sine, cosine) = mean_of(w, h);
    let round = w.cross(arm);
    round * (sine - L::one()) + w.cross(round * cosine)
}

/// The mean velocity of a point at an arm over a time.
#[inline(always)]
pub(crate) fn mean<L: Lanes>(v: Vec3<L>, w: Vec3<L>, arm: Vec3<L>, h: L) -> Vec3<L> {
    let (sine, cosine) = mean_of(w, h);
    let round = w.cross(arm);
    v + round * sine + w.cross(round * cosine)
}

/// The mean velocity of the second body's point over a time, as seen from the first body, which turns; both
/// go on as they do. Both arms are to that point.
#[inline(always)]
pub(crate) fn seen<L: GatherLanes>(v: &BodyPair<L>, [at, rb]: &[Vec3<L>; 2], h: L) -> Vec3<L> {
    let (sine, cosine) = mean_of(v.wa, h);
    let speed = mean(v.vb, v.wb, *rb, h) - v.va;
    // Back from where the point will be, by the rotation of the first body.
    let (before, path) = (v.wa.cross(*at), v.wa.cross(speed * h));
    speed - (before + path) * sine + v.wa.cross((before + path) * cosine)
}

/// The mean motion of an axis over a time, beside that with the angular velocity of its body: a body also
/// spins about the axis, and two with different spins would leave a shared axis in different directions.
#[inline(always)]
pub(crate) fn swerve<L: Lanes>(w: Vec3<L>, axis: Vec3<L>, h: L) -> Vec3<L> {
    axis.cross(w) * (axis.dot(w) * mean_of(w, h).1)
}

impl JointPass {
    /// The time over which motion is predicted: none when relaxing, which is for velocities at the current
    /// positions.
    #[inline(always)]
    pub(crate) fn ahead<L: Lanes>(&self) -> L {
        L::splat(if self.relax { 0.0 } else { 1.0 / self.inverse_h })
    }

    /// The velocity that corrects an error of lengths.
    #[inline(always)]
    pub(crate) fn linear_bias<L: Lanes>(&self, apart: Vec3<L>, rate: L) -> Vec3<L> {
        bias(apart, rate, self.recovery.linear)
    }

    /// The angular velocity that corrects an error of angles.
    #[inline(always)]
    pub(crate) fn angular_bias<L: Lanes>(&self, error: Vec3<L>, rate: L) -> Vec3<L> {
        bias(error, rate, self.recovery.angular)
    }
}

#[inline(always)]
fn bias<L: Lanes>(error: Vec3<L>, rate: L, most: f32) -> Vec3<L> {
    let (speed, most) = (error.length() * rate, L::splat(most));
    error * (rate * L::select(speed.gt(most), most / speed, L::one()))
}

/// One over the power of two at or below the greatest element of a nonnegative diagonal; 1 if that is next to
/// zero. A matrix scaled by it has a finite determinant, for any scale of its masses, and is not rounded
/// otherwise.
#[inline(always)]
fn to_unit<L: Lanes>(most: L) -> L {
    let power = most.power_of_two();
    let some = power.gt(L::zero());
    L::select(some, L::one() / L::select(some, power, L::one()), L::one())
}

/// The inverse of a positive semidefinite matrix; zero if it is singular or nearly so.
#[inline(always)]
pub(crate) fn inverse<L: Lanes>(m: &Sym3<L>) -> Sym3<L> {
    let unit = to_unit(m.xx.max(m.yy).max(m.zz));
    let m = m.scaled(unit);
    let xx = m.yy * m.zz - m.yz * m.yz;
    let xy = m.xz * m.yz - m.xy * m.zz;
    let xz = m.xy * m.yz - m.xz * m.yy;
    let det = m.xx * xx + m.xy * xy + m.xz * xz;
    let some = det.gt(L::zero());
    let scale = L::select(some, L::one() / L::select(some, det, L::one()), L::zero());
    Sym3 {
        xx: xx * scale,
        yy: (m.xx * m.zz - m.xz * m.xz) * scale,
        zz: (m.xx * m.yy - m.xy * m.xy) * scale,
        xy: xy * scale,
        xz: xz * scale,
        yz: (m.xy * m.xz - m.xx * m.yz) * scale,
    }
    .scaled(unit)
}

/// The inverse of a symmetric matrix across an axis, zero along it.
#[inline(always)]
pub(crate) fn across<L: Lanes>(m: &Sym3<L>, axis: Vec3<L>) -> Sym3<L> {
    let (t, s) = axis.tangents();
    let (mt, ms) = (m.mul(t), m.mul(s));
    let (a, b, d) = (t.dot(mt), t.dot(ms), s.dot(ms));
    let unit = to_unit(a.max(d));
    let (a, b, d) = (a * unit, b * unit, d * unit);
    let det = a * d - b * b;
    let some = det.gt(L::zero());
    let over = L::select(some, unit / L::select(some, det, L::one()), L::zero());
    // inverse · (t, s), and the outer products of it with t and s.
    let (p, q) = ((t * d - s * b) * over, (s * a - t * b) * over);
    Sym3 {
        xx: p.x * t.x + q.x * s.x,
        yy: p.y * t.y + q.y * s.y,
        zz: p.z * t.z + q.z * s.z,
        xy: p.x * t.y + q.x * s.y,
        xz: p.x * t.z + q.x * s.z,
        yz: p.y * t.z + q.y * s.z,
    }
}

// Rounding: keeps a matrix with missing directions invertible.
/// Share of the trace of a matrix that is added to its diagonal: makes one with missing directions
/// invertible, and changes no other.
pub(crate) const TINY: f32 = 1e-6;
