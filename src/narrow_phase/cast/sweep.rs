//! Which of eight triangles a moving shape can't touch within the step, in lanes.
//!
//! The exact search for a first touch ([`cast`](super)) costs a microsecond a triangle. Most triangles near
//! the path lie behind a plane that the shape never reaches: their own. Along a fixed direction the path of
//! every point of a turning shape lies within the sagitta of its arc from the chord, so two heights over the
//! plane, at the start and at the end, bound all in between. Half an arc has a quarter of the sagitta, so a
//! fast spin is examined in two or four parts.

use super::mesh_cast::MeshCast;
use super::motion::{Motion, turn};
use super::spin::Spin;
use crate::config::tuning::SAGITTA_SHARE;
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, kernel, with_best};
use crate::narrow_phase::Relative;
use crate::narrow_phase::convex::polytope::Pose;
use crate::narrow_phase::mesh::nearby::Eight;
use crate::narrow_phase::mesh::reach::{Bounds, bounds};
use crate::narrow_phase::mesh::sphere::nearest;
use crate::narrow_phase::mesh::triangles::{Triangles, nearest_corner};
use crate::shape::Collider;
use glam::{DQuat, Mat3, Vec3};
use std::cell::OnceCell;

/// A shape's motion against a mesh that doesn't turn, in the shape's frame at the start of the step.
pub(crate) struct MeshSweep<'a> {
    shape: &'a Collider,
    /// The box around the shape.
    bounds: Bounds,
    /// Pose of the mesh at the start.
    pose: Pose,
    /// Fraction of the step at which the motion ends.
    until: f32,
    /// The ends of the parts of the motion, computed when first needed.
    moments: OnceCell<Moments>,
    way: Vec3,
    lever: Vec3,
    /// Rotation vector over the step [rad].
    spin: Vec3,
    /// Angle times extent across the axis [m]. Times the share of the spin across a direction, it bounds the
    /// change of velocity along that direction within the step.
    bend: f32,
    /// A gap up to this counts as closed [m]: the tolerance and the allowance for rounding. Once a touch is
    /// known, only the allowance: merely coming within the tolerance by then changes nothing.
    least: f32,
    /// Allowance for rounding [m].
    slack: f32,
}

/// Which of eight triangles may be touched, by their planes.
pub(crate) struct Reached {
    /// One bit for each triangle that needs a closer look.
    pub(crate) lanes: u32,
    /// One of them may be close at the start already.
    pub(crate) near: bool,
}

/// Where the shape is.
#[derive(Clone, Copy, Debug)]
struct Moment {
    /// Displacement of its origin since the start.
    moved: Vec3,
    turned: Mat3,
}

/// The ends of equal parts of the motion.
#[derive(Debug)]
struct Moments {
    ends: [Moment; PARTS],
    count: usize,
}

/// Most parts of a motion.
const PARTS: usize = 4;

impl<'a> MeshSweep<'a> {
    /// `rel`: pose of the mesh in the shape's frame at the start.
    pub(crate) fn new(shape: &'a Collider, rel: &Relative, motion: &Motion, tolerance: f32) -> MeshSweep<'a> {
        let to_local = motion.a.rotation.conjugate();
        let way = to_local * motion.displacement;
        let lever = to_local * motion.a.lever;
        let Spin { vector, reach } = Spin::of(shape, to_local * motion.a.spin, lever, tolerance);
        let slack = 2e-6 * (rel.position.length() + way.length() + shape.radius + lever.length());
        MeshSweep {
            shape,
            bounds: bounds(shape).unwrap_or(Bounds::of_ball(shape.radius)),
            pose: Pose::new(rel.position, rel.rotation),
            until: 1.0,
            moments: OnceCell::new(),
            way,
            lever,
            spin: vector,
            bend: vector.length() * reach,
            least: tolerance + slack,
            slack,
        }
    }

    /// Ends the motion at this fraction of the step, where a touch is known: only triangles entered before it
    /// still matter.
    pub(crate) fn end_at(&mut self, fraction: f32) {
        (self.until, self.least) = (fraction, self.slack);
        self.moments = OnceCell::new();
    }

    fn moment(&self, t: f32, turned: DQuat) -> Moment {
        let turned = Mat3::from_quat(turned.as_quat());
        Moment { moved: self.way * (t * self.until) + turned * self.lever - self.lever, turned }
    }

    /// How far arcs are from their chords over the whole motion, per radian of the spin across the direction
    /// [m].
    fn sagitta(&self) -> f32 {
        self.bend / 8.0 * self.until * self.until
    }

    fn moments(&self) -> &Moments {
        self.moments.get_or_init(|| {
            let turned = |t: f64| turn(self.spin.as_dvec3() * (t * f64::from(self.until)));
            let flat = SAGITTA_SHARE * self.shape.radius;
            let sagitta = self.sagitta() * self.spin.length();
            if sagitta <= flat {
                return Moments { ends: [self.moment(1.0, turned(1.0)); PARTS], count: 1 };
            }
            if sagitta <= 4.0 * flat {
                let half = turned(0.5);
                let ends = [self.moment(0.5, half), self.moment(1.0, half * half)];
                return Moments { ends: [ends[0], ends[1], ends[1], ends[1]], count: 2 };
            }
            let quarter = turned(0.25);
            let half = quarter * quarter;
            let ends = [(0.25, quarter), (0.5, half), (0.75, half * quarter), (1.0, half * half)];
            Moments { ends: ends.map(|(t, turned)| self.moment(t, turned)), count: PARTS }
        })
    }

    /// The triangles, of eight, whose planes come into reach. Left out are triangles that come no nearer than
    /// the tolerance, and those that the shape rests on: triangles whose planes are within `resting` and stay
    /// so.
    pub(crate) fn by_planes(&self, eight: &Eight, lanes: u32, cast: &MeshCast) -> Reached {
        with_best!(Wide => by_planes::<Wide>(self, eight, lanes, cast))
    }

    /// The remaining triangles that may be touched, and the earliest fraction of the step at which they may
    /// be; zero for those that may be within the resting distance at the start.
    pub(crate) fn sift(&self, eight: &Eight, lanes: u32, cast: &MeshCast) -> (u32, [f32; 8]) {
        with_best!(Wide => sift::<Wide>(self, eight, lanes, cast))
    }

    #[inline(always)]
    fn by_planes_in<L: Lanes>(&self, eight: &Eight, lanes: u32, cast: &MeshCast) -> Reached {
        let &MeshCast { resting, alone, .. } = cast;
        let triangles = Triangles::<L>::new(eight, lanes, &self.pose, Vec3::ZERO);
        let hidden = cast.known.hides(&triangles.corners, cast.lip);
        // Degenerate triangles have no plane.
        let flat = !triangles.valid & lanes;
        if (!hidden).bits() & triangles.valid == 0 && alone < 0.0 {
            return Reached { lanes: flat, near: false };
        }
        let (start, path) = self.above(&triangles, |_, _| {});
        let alone = L::splat(alone);
        let mut close = start.le(alone);
        if close.bits() & triangles.valid != 0 {
            let (_, axis, _) = triangles.separate(self.bounds.middle, self.bounds.half);
            close = close & axis.le(alone);
        }
        let mut away = path.least.gt(L::splat(self.least)) | hidden;
        let resting = L::splat(resting);
        let level = start.abs().le(resting);
        if (level & !away).any() {
            let (mut lowest, down) = (path.lowest, -triangles.front);
            if self.moments().count == 1 {
                let middle = self.moment(0.5, turn(self.spin.as_dvec3() * (0.5 * f64::from(self.until))));
                lowest = Lanes::min(lowest, self.gap(triangles.height, down, &middle));
            }
            away = away | (level & lowest.ge(-resting));
            // Its lowest point is over the triangle itself: the shape rests on it at the start, however it
            // moves then.
            let (_, feature) = nearest(&triangles, self.shape.geometry.lane_support(down));
            away = away | (level & feature.eq(L::zero()));
        }
        let left = triangles.valid & !away.bits();
        Reached { lanes: left | flat, near: close.bits() & triangles.valid != 0 }
    }

    /// The gaps to the planes at the start, and how they change; `each` gets every part, and where its gap
    /// lasts.
    #[inline(always)]
    fn above<L: Lanes>(
        &self,
        triangles: &Triangles<L>,
        mut each: impl FnMut(usize, L::Mask),
    ) -> (L, Gaps<L>) {
        let down = -triangles.front;
        let start = triangles.height - self.shape.geometry.lane_reach(down);
        let mut path = self.gaps(start, down);
        for (part, end) in self.moments().ends().enumerate() {
            let least = path.go_on(self.gap(triangles.height, down, end));
            each(part, least.gt(path.closed));
        }
        (start, path)
    }

    #[inline(always)]
    fn sift_in<L: Lanes>(&self, eight: &Eight, lanes: u32, cast: &MeshCast) -> (u32, [f32; 8]) {
        let triangles = Triangles::<L>::new(eight, lanes, &self.pose, Vec3::ZERO);
        let flat = !triangles.valid & lanes;
        let mut kept = Kept::new(self.moments().count);
        let (mut apart, path) = self.above(&triangles, |part, lasts| kept.parts[part] = lasts);
        kept.first = path.open;
        if (!kept.always()).bits() & triangles.valid != 0 {
            self.search(&triangles, &mut kept, &mut apart);
        }
        let share = L::splat(self.until / self.moments().count as f32);
        let first = Lanes::max(kept.first, kept.leading()) * share;
        let first = Lanes::select(apart.gt(L::splat(cast.resting)), first, L::zero());
        (triangles.valid & !kept.always().bits() | flat, first.eight())
    }

    /// Beside a triangle the shape may cross its plane without touching it. So for each part of the motion
    /// this looks for other directions along which the gap lasts. The first points to the point of the
    /// triangle that is nearest to the shape halfway. If the path overlaps the triangle along one direction,
    /// the next is its reflection at the line between the points that overlap the most (Chung and Wang,
    /// *Quick collision detection of polytopes in virtual environments*, 1996).
    #[inline(always)]
    fn search<L: Lanes>(&self, triangles: &Triangles<L>, kept: &mut Kept<L>, apart: &mut L) {
        let moments = self.moments();
        let moved = LaneVec3::splat(0.5 * moments.ends[moments.count - 1].moved);
        let (point, _) = nearest(triangles, moved);
        let (mut u, mut known) = unit(point - moved);
        for _ in 0..ROUNDS {
            let mut before = self.shape.geometry.lane_support(u);
            let mut reached = before.dot(u);
            let (near, far) = nearest_corner(triangles, u);
            let mut path = self.gaps(far - reached, u);
            *apart = Lanes::select(known, Lanes::max(*apart, path.last), *apart);
            // The point that overlaps the most, among the remaining parts.
            let (mut furthest, mut along) = (before, L::splat(f32::MIN));
            for (part, end) in moments.ends().enumerate() {
                let point = end.point(self.shape.geometry.lane_support(end.seen(u)));
                let then = point.dot(u);
                let least = path.go_on(far - then);
                kept.parts[part] = kept.parts[part] | (known & least.gt(path.closed));
                let left = !kept.parts[part];
                for (point, then) in [(before, reached), (point, then)] {
                    let further = left & then.gt(along);
                    furthest = LaneVec3::select(further, point, furthest);
                    along = Lanes::select(further, then, along);
                }
                (before, reached) = (point, then);
            }
            kept.first = Lanes::max(kept.first, Lanes::select(known, path.open, L::zero()));
            if (!kept.always()).bits() & triangles.valid == 0 {
                return;
            }
            let (line, some) = unit(near - furthest);
            (u, known) = (u - line * (L::splat(2.0) * line.dot(u)), known & some);
        }
    }

    /// The gap along a direction at the start [m].
    #[inline(always)]
    fn gaps<L: Lanes>(&self, start: L, direction: LaneVec3<L>) -> Gaps<L> {
        let across = LaneVec3::<L>::splat(self.spin).cross(direction).length();
        let parts = self.moments().count;
        let sagitta = across * L::splat(self.sagitta() / (parts * parts) as f32);
        Gaps::new(start, sagitta, L::splat(self.least))
    }

    /// The gap along directions to points that are `far` from the origin along them [m].
    #[inline(always)]
    fn gap<L: Lanes>(&self, far: L, direction: LaneVec3<L>, moment: &Moment) -> L {
        far - LaneVec3::splat(moment.moved).dot(direction)
            - self.shape.geometry.lane_reach(moment.seen(direction))
    }
}

kernel! {
    /// See [`MeshSweep::by_planes`].
    fn by_planes<'a, L: Lanes>(
        sweep: &'a MeshSweep<'a>,
        eight: &'a Eight,
        lanes: u32,
        cast: &'a MeshCast,
    ) -> Reached {
        sweep.by_planes_in::<L>(eight, lanes, cast)
    }
}

kernel! {
    /// See [`MeshSweep::sift`].
    fn sift<'a, L: Lanes>(
        sweep: &'a MeshSweep<'a>,
        eight: &'a Eight,
        lanes: u32,
        cast: &'a MeshCast,
    ) -> (u32, [f32; 8]) {
        sweep.sift_in::<L>(eight, lanes, cast)
    }
}

/// A vector at unit length, and whether it has a direction.
#[inline(always)]
fn unit<L: Lanes>(v: LaneVec3<L>) -> (LaneVec3<L>, L::Mask) {
    let length = v.length();
    let some = length.gt(L::splat(f32::MIN_POSITIVE));
    (v * (L::one() / Lanes::select(some, length, L::one())), some)
}

/// How gaps along directions change over the parts of the motion.
///
/// Between two moments a gap is no less than its chord less a parabola as high as the sagitta in the middle.
struct Gaps<L> {
    last: L,
    /// A lower bound of all gaps up to now, and the least of those at the ends of parts.
    least: L,
    lowest: L,
    sagitta: L,
    /// Gap that counts as closed [m].
    closed: L,
    /// Number of parts that surely pass before the gap is closed.
    open: L,
    /// One while the gap is still open.
    going: L,
}

impl<L: Lanes> Gaps<L> {
    #[inline(always)]
    fn new(start: L, sagitta: L, closed: L) -> Self {
        Gaps { last: start, least: start, lowest: start, sagitta, closed, open: L::zero(), going: L::one() }
    }

    /// Advances to the end of the next part; returns a lower bound of the gaps in it.
    #[inline(always)]
    fn go_on(&mut self, next: L) -> L {
        let (zero, one, four) = (L::zero(), L::one(), L::splat(4.0));
        // last + u (next - last) - u (1 - u) curve
        let curve = four * self.sagitta;
        let grows = next - self.last;
        let steep = grows.abs().ge(curve);
        let some = Lanes::select(steep, one, curve);
        let dip = (self.last + next) * L::splat(0.5) - self.sagitta - grows * grows / (four * some);
        let least = Lanes::select(steep, Lanes::min(self.last, next), dip);
        self.least = Lanes::min(self.least, least);
        // The first u at which that counts as closed.
        let (falls, over) = (curve - grows, self.last - self.closed);
        let root = falls * falls - four * curve * over;
        let sum = falls + Lanes::max(root, zero).sqrt();
        let meets = root.ge(zero) & falls.gt(zero);
        let lasts = (over + over) / Lanes::select(meets, sum, one);
        let lasts = Lanes::select(meets, Lanes::min(lasts, one), one);
        let lasts = Lanes::select(over.gt(zero), lasts, zero);
        self.open += self.going * lasts;
        self.going = Lanes::select(lasts.lt(one), zero, self.going);
        self.lowest = Lanes::min(self.lowest, next);
        self.last = next;
        least
    }
}

/// In which parts of the motion the shape stays clear of each of eight triangles.
struct Kept<L: Lanes> {
    parts: [L::Mask; PARTS],
    count: usize,
    /// Number of parts that surely pass before the triangle is reached, by a single direction.
    first: L,
}

impl<L: Lanes> Kept<L> {
    #[inline(always)]
    fn new(count: usize) -> Self {
        let never = L::one().lt(L::zero());
        Kept { parts: [never; PARTS], count, first: L::zero() }
    }

    #[inline(always)]
    fn always(&self) -> L::Mask {
        let mut all = self.parts[0];
        for part in &self.parts[1..self.count] {
            all = all & *part;
        }
        all
    }

    /// How many parts, from the start on, stay clear.
    #[inline(always)]
    fn leading(&self) -> L {
        let (mut sum, mut going) = (L::zero(), L::one());
        for part in &self.parts[..self.count] {
            going = Lanes::select(*part, going, L::zero());
            sum += going;
        }
        sum
    }
}

/// Directions that are tried.
const ROUNDS: usize = 4;

impl Moments {
    fn ends(&self) -> impl Iterator<Item = &Moment> {
        self.ends[..self.count].iter()
    }
}

impl Moment {
    /// A direction in the frame of the turned shape.
    #[inline(always)]
    fn seen<L: Lanes>(&self, d: LaneVec3<L>) -> LaneVec3<L> {
        let m = &self.turned;
        LaneVec3::new(
            LaneVec3::splat(m.x_axis).dot(d),
            LaneVec3::splat(m.y_axis).dot(d),
            LaneVec3::splat(m.z_axis).dot(d),
        )
    }

    /// The position at that moment of a point of the shape.
    #[inline(always)]
    fn point<L: Lanes>(&self, p: LaneVec3<L>) -> LaneVec3<L> {
        let m = &self.turned;
        LaneVec3::splat(m.x_axis) * p.x
            + LaneVec3::splat(m.y_axis) * p.y
            + LaneVec3::splat(m.z_axis) * p.z
            + LaneVec3::splat(self.moved)
    }
}

#[cfg(test)]
mod tests;
