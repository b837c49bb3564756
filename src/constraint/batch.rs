//! Rows of contacts, packed in lanes.

use super::arrange::Part;
use super::order::Stage;
use super::seats::Seated;
use crate::lanes::{Lanes, Sym3, Vec3, f32x8};
use crate::memory::{Buffer, Room, bytes_of};

/// One normal row per lane.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(crate) struct PointRow<L> {
    /// Arm x normal, of either body: the angular part of the row [m].
    pub(crate) arm_a: Vec3<L>,
    pub(crate) arm_b: Vec3<L>,
    /// At the start of the step [m]; infinite in a lane without a point.
    pub(crate) separation: L,
    /// The same after the displacements of the last substep, as relaxing found it.
    pub(crate) now: L,
    /// Effective mass [kg]; zero in a lane without a point.
    pub(crate) mass: L,
    /// [N s]
    pub(crate) impulse: L,
    /// The part of the impulse that does not yield [N s].
    pub(crate) held: L,
    /// 1 / mass of the row [1/kg].
    pub(crate) stiffness: L,
    /// 1 for a real point, whose impulse bounds friction; 0 for a potential one.
    pub(crate) real: L,
}

/// Friction of a manifold, at its centre: two rows along the tangents and one against twist.
///
/// A potential manifold has none of these rows, only what the friction of an impact takes (`rub`): arms and coefficient.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(crate) struct FrictionRow<L> {
    pub(crate) tangent: Vec3<L>,
    pub(crate) arm_a: Vec3<L>,
    pub(crate) arm_b: Vec3<L>,
    /// Inverse of the 2x2 matrix of the tangential rows [kg]: (11, 12, 22).
    pub(crate) mass: [L; 3],
    /// The smaller eigenvalue of that inverse [kg]: a step against the slip that never overshoots.
    pub(crate) slide_mass: L,
    pub(crate) twist_mass: L,
    /// Mean distance of the points from the centre: the lever of twist [m].
    pub(crate) radius: L,
    pub(crate) coefficient: L,
    /// [N s]
    pub(crate) impulse: [L; 2],
    /// [N m s]
    pub(crate) twist: L,
}

/// Up to `L::N` manifolds of at most `P` points that share no dynamic body.
///
/// Normal rows of a manifold have one direction, so they are solved in row space: `coupling` says by how much an
/// impulse at one point changes the normal velocity of another, and the bodies' velocities are touched once.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Batch<L, const P: usize> {
    pub(crate) normal: Vec3<L>,
    pub(crate) inverse_mass_a: L,
    pub(crate) inverse_mass_b: L,
    pub(crate) inverse_inertia_a: Sym3<L>,
    pub(crate) inverse_inertia_b: Sym3<L>,
    pub(crate) points: [PointRow<L>; P],
    /// Of points (0,1), (0,2), (1,2), (0,3), (1,3), (2,3) [1/kg].
    pub(crate) coupling: [L; 6],
    pub(crate) friction: FrictionRow<L>,
    /// Of potential points: the largest impulse in any substep [N s]. One that hits something at rest in space pushes
    /// in the substep of the impact, and has nothing to bear in those that follow.
    pub(crate) peak: L,
    /// Dense indices of the bodies; an inert lane repeats lane 0.
    pub(crate) a: [u32; 8],
    pub(crate) b: [u32; 8],
    /// Where the impulses go back to.
    pub(crate) contact: [Part; 8],
    /// Bit per lane: body `b` (and `a`) may be written.
    pub(crate) write_a: u32,
    pub(crate) write_b: u32,
    /// Bit per lane: the contact's `a` is this batch's `b`.
    pub(crate) swapped: u32,
    /// Bit per lane: someone listens to the contact.
    pub(crate) heard: u32,
    /// Place in [`Rows::surfaces`], or beyond them.
    pub(crate) surface: u32,
}

impl<L: Lanes, const P: usize> Default for Batch<L, P> {
    fn default() -> Self {
        Batch {
            normal: Vec3::default(),
            inverse_mass_a: L::default(),
            inverse_mass_b: L::default(),
            inverse_inertia_a: Sym3::default(),
            inverse_inertia_b: Sym3::default(),
            points: [PointRow::default(); P],
            coupling: [L::default(); 6],
            friction: FrictionRow::default(),
            peak: L::default(),
            a: [0; 8],
            b: [0; 8],
            contact: [Part::NONE; 8],
            write_a: 0,
            write_b: 0,
            swapped: 0,
            heard: 0,
            surface: u32::MAX,
        }
    }
}

/// Index of a pair of points in [`Batch::coupling`]; `i < k`.
#[inline(always)]
pub(crate) const fn couple(i: usize, k: usize) -> usize {
    k * (k - 1) / 2 + i
}

/// A batch by its number of points and its place among those.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BatchRef {
    /// 1 to 4; 0 of one lane.
    pub(crate) points: u8,
    /// Its contacts are those of a node of a batch of trees, each in the lane of its tree.
    pub(crate) seated: bool,
    pub(crate) index: u32,
}

/// All batches of a step.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    pub(crate) p1: Vec<Batch<f32x8, 1>>,
    pub(crate) p2: Vec<Batch<f32x8, 2>>,
    pub(crate) p3: Vec<Batch<f32x8, 3>>,
    pub(crate) p4: Vec<Batch<f32x8, 4>>,
    /// Contacts that found no colour.
    pub(crate) single: Vec<Batch<f32, 4>>,
    pub(crate) schedule: Vec<BatchRef>,
    pub(crate) stages: Vec<Stage>,
    /// Batches that go along with trees, sorted by these and their nodes.
    pub(crate) seated: Vec<Seated>,
    /// For each batch of the schedule; empty unless some move.
    pub(crate) surfaces: Vec<Surface>,
}

/// By which the surfaces of each lane move past each other, along the two tangents of friction [m/s].
pub(crate) type Surface = [[f32; 8]; 2];

impl Rows {
    /// Bytes of a batch of one to four points, and of one lane.
    pub(crate) const SIZES: [usize; 5] = [
        size_of::<Batch<f32x8, 1>>(),
        size_of::<Batch<f32x8, 2>>(),
        size_of::<Batch<f32x8, 3>>(),
        size_of::<Batch<f32x8, 4>>(),
        size_of::<Batch<f32, 4>>(),
    ];

    fn capacities(&self) -> [usize; 5] {
        let lanes = [self.p1.capacity(), self.p2.capacity(), self.p3.capacity(), self.p4.capacity()];
        [lanes[0], lanes[1], lanes[2], lanes[3], self.single.capacity()]
    }

    /// Makes exactly the place that is lacking for so many batches; if need be, out of what others don't need now. Says
    /// whether there is room for all.
    pub(crate) fn make_place(&mut self, batches: [usize; 5], room: &mut Room) -> bool {
        let (mut lacking, mut spare) = (0, 0);
        for ((wanted, has), size) in batches.into_iter().zip(self.capacities()).zip(Self::SIZES) {
            lacking += wanted.saturating_sub(has) * size;
            spare += has.saturating_sub(wanted) * size;
        }
        if lacking > room.left().saturating_add(spare) {
            return false;
        }
        if lacking > room.left() {
            // Nothing is kept in them from step to step.
            room.give(spare);
            fit(&mut self.p1, batches[0]);
            fit(&mut self.p2, batches[1]);
            fit(&mut self.p3, batches[2]);
            fit(&mut self.p4, batches[3]);
            fit(&mut self.single, batches[4]);
        }
        room.take(lacking);
        self.p1.widen(batches[0]);
        self.p2.widen(batches[1]);
        self.p3.widen(batches[2]);
        self.p4.widen(batches[3]);
        self.single.widen(batches[4]);
        true
    }

    pub(crate) fn resize(&mut self, batches: [usize; 5]) {
        self.p1.resize_with(batches[0], Batch::default);
        self.p2.resize_with(batches[1], Batch::default);
        self.p3.resize_with(batches[2], Batch::default);
        self.p4.resize_with(batches[3], Batch::default);
        self.single.resize_with(batches[4], Batch::default);
    }

    /// Bytes that are lacking for so many batches of one to four points in stages.
    pub(crate) fn missing(&self, batches: [usize; 4], stages: usize) -> usize {
        let of = self.capacities();
        let rows = (0..4).map(|i| batches[i].saturating_sub(of[i]) * Self::SIZES[i]).sum::<usize>();
        rows + self.schedule.missing(batches.iter().sum()) + self.stages.missing(stages)
    }

    /// Live and reserved bytes.
    pub(crate) fn bytes(&self) -> (usize, usize) {
        [
            bytes_of(&self.p1),
            bytes_of(&self.p2),
            bytes_of(&self.p3),
            bytes_of(&self.p4),
            bytes_of(&self.single),
            bytes_of(&self.schedule),
            bytes_of(&self.stages),
            bytes_of(&self.seated),
            bytes_of(&self.surfaces),
        ]
        .into_iter()
        .fold((0, 0), |s, b| (s.0 + b.0, s.1 + b.1))
    }
}

/// Gives up place for more than so many.
fn fit<T>(buffer: &mut Vec<T>, wanted: usize) {
    buffer.truncate(wanted);
    buffer.shrink_to(wanted);
}
