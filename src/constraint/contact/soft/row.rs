//! Data of the soft lanes of a batch besides their normal rows.

use super::super::batch::Batch;
use super::super::batch::GONE;
use super::super::columns::{SpringColumns, vec3};
use crate::config::tuning::{LEAST_SOFT_DAMPING, SOFT_TURN};
use crate::lanes::{GatherLanes, Vec3, kernel};

/// Data of the soft lanes of a batch besides their normal rows.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SoftRow {
    /// One in soft lanes, zero in others.
    pub(super) soft: [f32; 8],
    /// Share of the velocity at the start of a substep in the one that moves the bodies.
    pub(super) start_share: [f32; 8],
    /// Depth from which on the surfaces are rigid [m].
    pub(super) stop: [f32; 8],
    /// For each point: impulse of the spring in a substep per depth [N s/m], and force per speed [N s/m].
    pub(super) rate: [[f32; 8]; 4],
    pub(super) drag: [[f32; 8]; 4],
    /// Normal velocity that acceleration adds in a substep [m/s].
    pub(super) pull: [[f32; 8]; 4],
    /// One for points that the stop held in the last pass.
    pub(super) held: [[f32; 8]; 4],
}

kernel! {
    /// Fills the springs of a batch, whose normal rows are filled, for substeps of `h` seconds. `along`: by
    /// how much a unit impulse at both centres changes the normal velocity [1/kg].
    ///
    /// The points share a spring of the frequency that the two bodies would have on it if they did not
    /// rotate, so the depth at which a body rests does not depend on its shape. Each has the share that it
    /// has where the contact has as many points as the two kinds of shape can have: a share by the number of
    /// points that there are would change the energy of the spring whenever one comes or goes. A spring is at
    /// most so stiff that its phase turns by [`SOFT_TURN`] in a substep.
    pub(in crate::constraint::contact) fn fill_soft<'a, L: GatherLanes, const P: usize, const B: usize>(
        row: &'a mut SoftRow,
        batch: &'a Batch<L, P, B>,
        columns: &'a SpringColumns,
        along: L,
        h: f32,
    ) {
        *row = SoftRow { soft: columns.soft, start_share: columns.start_share, ..SoftRow::default() };
        row.stop = columns.stop;
        let (n, time) = (batch.normal, L::splat(h));
        let most = L::splat(SOFT_TURN / h);
        let omega = (L::load(&columns.hertz) * L::splat(std::f32::consts::TAU)).min(most);
        let zeta = L::load(&columns.zeta).max(L::splat(LEAST_SOFT_DAMPING));
        let share = L::load(&columns.point_share);
        let pull: [Vec3<L>; 3] = [0, 1, 2].map(|i| vec3(&columns.pull[i]));
        for i in 0..P {
            let point = &batch.points[i];
            let (own, whole) = (point.mass, along.gt(point.stiffness * L::splat(GONE)));
            // The mass that the point carries; that of its row if the bodies can only turn.
            let carried = L::select(whole, share / along, own);
            let stiffness = (carried * omega * omega).min(own * most * most);
            // No more than stops a body that moves by the mean of its velocities: that would throw it back.
            let drag = (L::splat(2.0) * zeta * (carried * stiffness).sqrt()).min(own * L::splat(2.0 / h));
            let turned = if B > 0 { point.arm_b[0].dot(pull[2]) } else { L::zero() };
            let gained = n.dot(pull[0]) + turned - point.arm_a.dot(pull[1]);
            (stiffness * time).store(&mut row.rate[i]);
            drag.store(&mut row.drag[i]);
            (gained * time).store(&mut row.pull[i]);
        }
    }
}
