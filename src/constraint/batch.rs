//! Rows of contacts, packed in lanes.

use super::arrange::Part;
use super::friction::{Friction, FrictionRow, ImpactRow};
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
    /// Of points (0,1), (0,2), (1,2), (0,3), (1,3), (2,3) [1/kg]: the first as many as there are points, which is enough
    /// for three, and what is left of four.
    coupling: ([L; P], [L; 2]),
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
            coupling: ([L::default(); P], [L::default(); 2]),
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

impl<L: Lanes, const P: usize> Batch<L, P> {
    /// By how much an impulse at point `i` changes the normal velocity of point `k`, and the other way round [1/kg]; `i < k`.
    #[inline(always)]
    pub(crate) fn coupling(&self, i: usize, k: usize) -> L {
        let at = couple(i, k);
        if at < P { self.coupling.0[at] } else { self.coupling.1[at - P] }
    }

    #[inline(always)]
    pub(crate) fn couple(&mut self, i: usize, k: usize, coupling: L) {
        let at = couple(i, k);
        if at < P {
            self.coupling.0[at] = coupling;
        } else {
            self.coupling.1[at - P] = coupling;
        }
    }
}

/// Index of a pair of points in [`Batch::coupling`]; `i < k`.
const fn couple(i: usize, k: usize) -> usize {
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
    /// Its place in the buffers of friction, if there is any: among those that touch or that may touch, of its width.
    pub(crate) friction: u32,
}

/// How many there are: batches of one to four points and of one lane; friction rows of eight lanes and of one; what the
/// friction of impacts takes, of eight lanes and of one.
pub(crate) type Tally = [usize; 9];

/// All batches of a step.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    pub(crate) p1: Vec<Batch<f32x8, 1>>,
    pub(crate) p2: Vec<Batch<f32x8, 2>>,
    pub(crate) p3: Vec<Batch<f32x8, 3>>,
    pub(crate) p4: Vec<Batch<f32x8, 4>>,
    /// Contacts that found no colour.
    pub(crate) single: Vec<Batch<f32, 4>>,
    pub(crate) friction: Friction,
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
    /// Bytes of each that [`Tally`] counts.
    pub(crate) const SIZES: Tally = [
        size_of::<Batch<f32x8, 1>>(),
        size_of::<Batch<f32x8, 2>>(),
        size_of::<Batch<f32x8, 3>>(),
        size_of::<Batch<f32x8, 4>>(),
        size_of::<Batch<f32, 4>>(),
        size_of::<FrictionRow<f32x8>>(),
        size_of::<FrictionRow<f32>>(),
        size_of::<ImpactRow<f32x8>>(),
        size_of::<ImpactRow<f32>>(),
    ];

    /// Calls `f` with each buffer that has an entry for what is counted, and what it counts.
    fn each(&mut self, f: &mut dyn FnMut(&mut dyn Filled, usize)) {
        let Rows { p1, p2, p3, p4, single, friction, .. } = self;
        let Friction { lanes, single: alone, .. } = friction;
        let all: [&mut dyn Filled; 9] = [
            p1,
            p2,
            p3,
            p4,
            single,
            &mut lanes.rows,
            &mut alone.rows,
            &mut lanes.impacts,
            &mut alone.impacts,
        ];
        all.into_iter().enumerate().for_each(|(i, buffer)| f(buffer, i));
    }

    /// Makes exactly the place that is lacking for so many; if need be, out of what others don't need now. Says whether
    /// there is room for all.
    pub(crate) fn make_place(&mut self, wanted: &Tally, room: &mut Room) -> bool {
        let (mut lacking, mut spare) = (0, 0);
        self.each(&mut |buffer, i| {
            let has = buffer.capacity();
            lacking += wanted[i].saturating_sub(has) * Self::SIZES[i];
            spare += has.saturating_sub(wanted[i]) * Self::SIZES[i];
        });
        if lacking > room.left().saturating_add(spare) {
            return false;
        }
        if lacking > room.left() {
            // Nothing is kept in them from step to step.
            room.give(spare);
            self.each(&mut |buffer, i| buffer.fit(wanted[i]));
        }
        room.take(lacking);
        self.each(&mut |buffer, i| buffer.widen(wanted[i]));
        true
    }

    /// Makes so many, for which there is place or room without end.
    pub(crate) fn resize(&mut self, wanted: &Tally, room: &mut Room) {
        self.each(&mut |buffer, i| buffer.resize(wanted[i], room));
    }

    /// Bytes that so many batches of one to four points take in stages, where there are none yet.
    pub(crate) fn missing(&self, batches: [usize; 4], stages: usize, friction: bool) -> usize {
        let rub = if friction { Self::SIZES[5] } else { 0 };
        let rows = (0..4).map(|i| batches[i] * (Self::SIZES[i] + rub)).sum::<usize>();
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
            self.friction.bytes(),
            bytes_of(&self.schedule),
            bytes_of(&self.stages),
            bytes_of(&self.seated),
            bytes_of(&self.surfaces),
        ]
        .into_iter()
        .fold((0, 0), |s, b| (s.0 + b.0, s.1 + b.1))
    }
}

/// A buffer whose entries are all filled anew in each step.
trait Filled: Buffer {
    fn resize(&mut self, len: usize, room: &mut Room);
    /// Gives up place for more than so many.
    fn fit(&mut self, len: usize);
}

impl<T: Default> Filled for Vec<T> {
    fn resize(&mut self, len: usize, room: &mut Room) {
        room.fit(self, len);
        self.resize_with(len, T::default);
    }
    fn fit(&mut self, len: usize) {
        self.truncate(len);
        self.shrink_to(len);
    }
}
