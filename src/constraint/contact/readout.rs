//! The rows and their impulses, read lane by lane, for the lab.

use super::batch::{Batch, BatchRef};
use super::friction::{FrictionRow, FrictionView};
use super::rows::{Views, with_batch};
use crate::constraint::articulation::rattle::Aside;
use crate::constraint::articulation::tree::TreePush;
use crate::constraint::joint::batch::{Report, RowImpulse};
use crate::constraint::joint::run::JointViews;
use crate::constraint::joint::store::{report_locks, report_motors};
use crate::constraint::schedule::part::Part;
use crate::lanes::Lanes;
use glam::Vec3;

/// A normal row.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PointLane {
    /// Arm x normal, of either body [m].
    pub(crate) arms: [Vec3; 2],
    /// At the start of the step [m].
    pub(crate) separation: f32,
    /// In the substep [N s].
    pub(crate) impulse: f32,
}

/// Friction of a manifold that touches.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrictionLane {
    pub(crate) tangent: Vec3,
    /// From the centres of mass to the middle of the points [m].
    pub(crate) arms: [Vec3; 2],
    pub(crate) coefficient: f32,
    /// Mean distance of the points from their middle [m].
    pub(crate) radius: f32,
    /// Velocity of the surfaces past each other, along both tangents [m/s].
    pub(crate) surface: [f32; 2],
    /// Along both tangents [N s], and about the normal [N m s].
    pub(crate) impulse: [f32; 3],
}

/// Friction against rolling and spinning of a manifold that touches.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RollingLane {
    /// Lever arms of the load [m]; one of them at least is positive.
    pub(crate) arm: f32,
    pub(crate) spin_arm: f32,
    /// On the second body, about both tangents of friction [N m s]. Spinning friction is in the twist of
    /// [`FrictionLane`].
    pub(crate) impulse: [f32; 2],
}

/// Friction of the impact of a manifold that doesn't touch yet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ImpactLane {
    pub(crate) coefficient: f32,
    /// The component of the arm of the first body along the normal [m].
    pub(crate) along: f32,
    /// From the arm of the first body to that of the second [m].
    pub(crate) to_b: Vec3,
}

/// The rows of a contact, or of one point of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactLane {
    pub(crate) part: Part,
    pub(crate) potential: bool,
    /// Points from the first body to the second, which is none where it is static. The contact itself may
    /// have them in the other order.
    pub(crate) normal: Vec3,
    pub(crate) bodies: (u32, Option<u32>),
    points: [PointLane; 4],
    count: usize,
    pub(crate) friction: Option<FrictionLane>,
    /// For one with friction, if its materials resist rolling or spinning.
    pub(crate) rolling: Option<RollingLane>,
    /// For a potential contact that will have friction once it touches.
    pub(crate) impact: Option<ImpactLane>,
}

impl ContactLane {
    pub(crate) fn points(&self) -> &[PointLane] {
        &self.points[..self.count]
    }
}

/// Impulses for the rows of a contact: of its points, then of friction along both tangents and about the
/// normal, then against rolling about both tangents.
pub(crate) type LaneImpulses = ([f32; 4], [f32; 3], [f32; 2]);

impl Views<'_> {
    /// Calls `f` with each lane that has a contact, in the order in which they are solved.
    ///
    /// # Safety
    /// No other thread works on the batches.
    pub(crate) unsafe fn each_lane(&self, f: &mut dyn FnMut(&ContactLane)) {
        // SAFETY: by the contract.
        unsafe {
            self.replace_impulses(&mut |lane| {
                f(lane);
                None
            });
        }
    }

    /// The same, and replaces the impulses of the lanes for which `f` returns others.
    ///
    /// # Safety
    /// As for [`Views::each_lane`].
    pub(crate) unsafe fn replace_impulses(&self, f: &mut dyn FnMut(&ContactLane) -> Option<LaneImpulses>) {
        for stage in self.stages {
            let potential = stage.group.is_potential();
            for &of in &self.schedule[stage.start as usize..stage.end as usize] {
                // SAFETY: by the contract.
                unsafe {
                    with_batch!(self, stage.group, of, |batch, friction| {
                        self.lanes_of(batch, friction, of, potential, f)
                    });
                }
            }
        }
    }

    /// # Safety
    /// As for [`Views::each_lane`].
    unsafe fn lanes_of<L: Lanes, const P: usize, const B: usize>(
        &self,
        batch: &mut Batch<L, P, B>,
        friction: &FrictionView<'_, L, B>,
        of: BatchRef,
        potential: bool,
        f: &mut dyn FnMut(&ContactLane) -> Option<LaneImpulses>,
    ) {
        // SAFETY: by the contract.
        let mut rows = if potential { None } else { unsafe { friction.touching(of) } };
        // SAFETY: by the contract.
        let impact = if potential { unsafe { friction.impact(of) } } else { None };
        // SAFETY: by the contract.
        let mut rolling = if potential { None } else { unsafe { self.rolling_of(batch) } };
        for lane in (0..L::N).filter(|&lane| batch.contact[lane] != Part::NONE) {
            let mut out = ContactLane { potential, ..ContactLane::of(batch, lane) };
            out.impact = impact.map(|row| ImpactLane {
                coefficient: row.coefficient.lane(lane),
                along: row.along.lane(lane),
                to_b: row.to_b.first().map_or(Vec3::ZERO, |to| to.lane(lane)),
            });
            let surface = self.surfaces.get(batch.surface as usize).map_or([0.0; 2], |s| s.map(|s| s[lane]));
            out.friction = rows.as_ref().map(|row| FrictionLane { surface, ..FrictionLane::of(row, lane) });
            let resists = rolling.as_ref().map(|row| RollingLane {
                arm: row.arm[lane],
                spin_arm: row.spin_arm[lane],
                impulse: row.impulse.map(|impulse| impulse[lane]),
            });
            out.rolling = resists.filter(|row| out.friction.is_some() && row.arm.max(row.spin_arm) > 0.0);
            let Some((normal, friction_impulses, rolls)) = f(&out) else { continue };
            let there = batch.points.iter_mut().filter(|point| point.separation.lane(lane).is_finite());
            for (point, impulse) in there.zip(normal) {
                point.impulse.set_lane(lane, impulse);
            }
            if let Some(friction) = &mut rows {
                friction.impulse[0].set_lane(lane, friction_impulses[0]);
                friction.impulse[1].set_lane(lane, friction_impulses[1]);
                friction.twist.set_lane(lane, friction_impulses[2]);
            }
            if let (Some(row), Some(_)) = (&mut rolling, out.rolling) {
                row.impulse.iter_mut().zip(rolls).for_each(|(impulse, new)| impulse[lane] = new);
            }
        }
    }
}

impl ContactLane {
    /// The normal rows of a lane.
    fn of<L: Lanes, const P: usize, const B: usize>(batch: &Batch<L, P, B>, lane: usize) -> ContactLane {
        let other = batch.b.first().map(|b| b.index[lane]);
        let mut out = ContactLane {
            part: batch.contact[lane],
            potential: false,
            normal: batch.normal.lane(lane),
            // A static body is replaced by the first one.
            bodies: (batch.a[lane], other.filter(|b| *b != batch.a[lane])),
            points: [PointLane::default(); 4],
            count: 0,
            friction: None,
            rolling: None,
            impact: None,
        };
        // A missing point has an infinite separation.
        for point in batch.points.iter().filter(|point| point.separation.lane(lane).is_finite()) {
            let arm_b = point.arm_b.first().map_or(Vec3::ZERO, |arm| arm.lane(lane));
            out.points[out.count] = PointLane {
                arms: [point.arm_a.lane(lane), arm_b],
                separation: point.separation.lane(lane),
                impulse: point.impulse.lane(lane),
            };
            out.count += 1;
        }
        out
    }
}

impl FrictionLane {
    /// The friction rows of a lane, on surfaces that do not move.
    fn of<L: Lanes, const B: usize>(row: &FrictionRow<L, B>, lane: usize) -> FrictionLane {
        FrictionLane {
            tangent: row.tangent.lane(lane),
            arms: [row.arm_a.lane(lane), row.arm_b.first().map_or(Vec3::ZERO, |arm| arm.lane(lane))],
            coefficient: row.coefficient.lane(lane),
            radius: row.radius.lane(lane),
            surface: [0.0; 2],
            impulse: [row.impulse[0].lane(lane), row.impulse[1].lane(lane), row.twist.lane(lane)],
        }
    }
}

impl JointViews<'_> {
    /// Calls `f` with each body of a tree and the impulses of its joints in the substep.
    ///
    /// # Safety
    /// No other thread works on the batches.
    pub(crate) unsafe fn each_tree_push(&self, f: &mut dyn FnMut(u32, TreePush)) {
        // SAFETY: by the contract.
        unsafe {
            self.trees.all().iter().for_each(|batch| batch.each_push(f));
            self.single_trees.all().iter().for_each(|batch| batch.each_push(f));
        }
    }

    /// Calls `lock` with each lock and its impulse, `row` with each other row and its own, and `coupling`
    /// with each coupling, its impulses at both ends, and force and torque on each of its joints per impulse;
    /// `push` with each body, an impulse on it by one of those outside trees, and the moment of that.
    /// `aside`: see [`TreeBatch::each_aside`](crate::constraint::articulation::tree::TreeBatch::each_aside).
    ///
    /// # Safety
    /// No other thread works on the batches.
    pub(crate) unsafe fn each_impulse(
        &self,
        lock: &mut dyn FnMut(u32, Vec3),
        row: &mut dyn FnMut(u32, RowImpulse),
        coupling: &mut dyn FnMut(u32, [f32; 2], [[Vec3; 2]; 2]),
        push: &mut dyn FnMut(u32, [Vec3; 2]),
        aside: &mut dyn FnMut(u32, Aside),
    ) {
        let mut to = Call { lock, row, push };
        // SAFETY: by the contract.
        unsafe {
            self.tables.report(true, &mut to);
            self.trees.all().iter().for_each(|batch| report_locks(batch, &mut to));
            self.single_trees.all().iter().for_each(|batch| report_locks(batch, &mut to));
            self.tables.report(false, &mut to);
            self.trees.all().iter().for_each(|batch| report_motors(batch, &mut to));
            self.single_trees.all().iter().for_each(|batch| report_motors(batch, &mut to));
            self.each_coupling(&mut to, coupling);
            self.trees.all().iter().for_each(|batch| batch.each_aside(aside));
            self.single_trees.all().iter().for_each(|batch| batch.each_aside(aside));
        }
    }
}

struct Call<'a> {
    lock: &'a mut dyn FnMut(u32, Vec3),
    row: &'a mut dyn FnMut(u32, RowImpulse),
    push: &'a mut dyn FnMut(u32, [Vec3; 2]),
}

impl Report for Call<'_> {
    fn lock(&mut self, owner: u32, impulse: Vec3) {
        (self.lock)(owner, impulse);
    }
    fn row(&mut self, owner: u32, impulse: RowImpulse) {
        (self.row)(owner, impulse);
    }
    fn push(&mut self, body: u32, push: [Vec3; 2]) {
        (self.push)(body, push);
    }
}
