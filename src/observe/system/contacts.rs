//! Rows of contacts, from the batches.
//!
//! Rolling and spinning friction is a patch of its own: rows about both tangents and the normal, as
//! velocities at the distance of the surface from the centre of mass, whose bounds are lever arms over that
//! distance times the load. Where a contact has friction and only resists spinning, that widens the bound of
//! its twist.

use super::*;
use crate::constraint::{ContactLane, FrictionLane, tweak_of};
use glam::Vec3;

// Rounding: of an arm that is none.
/// Lever arm against rolling of a contact without friction that only resists spinning, as a share of that:
/// the law of a patch has the bound of its twist as a multiple of the other.
const NO_ROLL: f64 = 1e-9;

impl System {
    pub(super) fn take_contacts(&mut self, world: &World, views: &Views<'_>) {
        // SAFETY: between stages there is no other thread.
        unsafe { views.each_lane(&mut |lane| self.take_contact(world, lane)) };
    }

    fn take_contact(&mut self, world: &World, lane: &ContactLane) {
        let contact = world.contacts.at(lane.part.slot() as u32);
        let [x, y] = [contact.a, contact.b].map(|c| &world.colliders.all[c as usize]);
        let tweak = tweak_of(&world.events.tweaks, lane.part.slot());
        let restitution = tweak.restitution_or(x.material.restitution_with(&y.surface(contact.material)));
        let (a, b) = lane.bodies;
        let (own, other) = if x.body == a { (x.body, y.body) } else { (y.body, x.body) };
        let owner = Owner::Contact([own, other].map(|body| world.handle_of(body as usize)));
        let law = SystemLaw {
            potential: lane.potential,
            restitution: restitution.into(),
            resists: lane.rolling.is_some(),
            size: x.thickness().min(y.thickness()).into(),
            ..SystemLaw::new(Law::AT_LEAST_ZERO, owner)
        };
        let bodies = [self.mover(a as usize), b.and_then(|b| self.mover(b as usize))];
        let n = lane.normal.as_dvec3();
        let along = |d: DVec3, arms: [DVec3; 2], bias: f64| SystemRow {
            bias,
            angle: false,
            ..SystemRow::of_two(bodies, [-d, d], [-arms[0], arms[1]])
        };
        let friction = lane.friction.filter(|f| f.coefficient > 0.0);
        // Warm starting impulses are those of a substep.
        let substeps = f64::from(world.settings.substeps);
        let tangents = |f: &FrictionLane| {
            let t = [f.tangent, lane.normal.cross(f.tangent)].map(|t| t.as_dvec3());
            let arms = f.arms.map(|arm| arm.as_dvec3());
            [0, 1].map(|i| SystemRow {
                impulse: f64::from(f.impulse[i]) * substeps,
                ..along(t[i], arms.map(|arm| arm.cross(t[i])), f.surface[i].into())
            })
        };
        let normal = |i: usize| SystemRow {
            impulse: f64::from(lane.points()[i].impulse) * substeps,
            ..along(n, lane.points()[i].arms.map(|arm| arm.as_dvec3()), 0.0)
        };
        let gap = |i: usize| Some(f64::from(lane.points()[i].separation));
        if let (Some(f), [_], None) = (&friction, lane.points(), &lane.rolling) {
            // A single point has no arm against twist, so this is exactly Coulomb's cone.
            let [t, s] = tangents(f);
            let mu = f.coefficient.into();
            self.push(SystemLaw { law: Law::Contact { mu }, gap: gap(0), ..law }, &[normal(0), t, s]);
            return;
        }
        let first = self.rows.len();
        let impact = |i: usize| {
            let impact = lane.impact.filter(|impact| impact.coefficient > 0.0)?;
            // n x (r x n) is r without its part along n.
            let arm = n.cross(lane.points()[i].arms[0].as_dvec3()) + n * f64::from(impact.along);
            Some((impact.coefficient.into(), [arm, arm + impact.to_b.as_dvec3()]))
        };
        for i in 0..lane.points().len() {
            self.push(SystemLaw { gap: gap(i), impact: impact(i), ..law }, &[normal(i)]);
        }
        if let Some(f) = &friction {
            let [t, s] = tangents(f);
            let twist = SystemRow {
                linear: [DVec3::ZERO; SIDES],
                angle: true,
                impulse: LaneRows::twists(lane)[0] * substeps,
                ..along(n, [n; 2], 0.0)
            };
            let arm = LaneRows::twist_arm(lane);
            let (mu, count) = (f.coefficient.into(), lane.points().len());
            self.push(SystemLaw { law: Law::Patch { mu, arm, first, count }, ..law }, &[t, s, twist]);
        }
        self.take_rolling(lane, law, (bodies, first), substeps);
    }

    /// Adds the rows against rolling of a contact whose normals begin at a row.
    fn take_rolling(
        &mut self,
        lane: &ContactLane,
        law: SystemLaw,
        (bodies, first): ([Option<usize>; 2], usize),
        substeps: f64,
    ) {
        let rolling = lane.rolling.filter(|_| !LaneRows::only_spins(lane));
        let (Some(f), Some(rolling)) = (&lane.friction, rolling) else { return };
        let reach = LaneRows::reach(lane);
        let about = |axis: Vec3, impulse: f64| SystemRow {
            impulse: impulse / reach * substeps,
            angle: false,
            ..SystemRow::of_two(
                bodies,
                [DVec3::ZERO; 2],
                [-axis.as_dvec3(), axis.as_dvec3()].map(|axis| axis * reach),
            )
        };
        let rows = [
            about(f.tangent, rolling.impulse[0].into()),
            about(lane.normal.cross(f.tangent), rolling.impulse[1].into()),
            about(lane.normal, LaneRows::twists(lane)[1]),
        ];
        let [roll, spin] = [rolling.arm, rolling.spin_arm].map(f64::from);
        let roll = roll.max(spin * NO_ROLL);
        let patch = Law::Patch { mu: roll / reach, arm: spin / roll, first, count: lane.points().len() };
        self.push(SystemLaw { law: patch, ..law }, &rows);
    }
}
