//! When a moving convex shape first touches a mesh or a height field.

use super::mesh_cast::MeshCast;
use super::motion::Motion;
use super::path::{BoxPath, ShapePath};
use super::sweep::MeshSweep;
use super::{Other, Placed, Sweep, Touch};
use crate::lanes::ones;
use crate::narrow_phase::Relative;
use crate::narrow_phase::convex::gjk::{Accuracy, core_gap};
use crate::narrow_phase::convex::simplex::Simplex;
use crate::narrow_phase::mesh::nearby::{Eight, Nearby};
use crate::shape::Collider;
use crate::shape::support::Support;
use glam::{DVec3, Vec3};

/// Called with a triangle, its corners and the largest fraction that still matters; returns the largest that
/// matters from then on.
pub(crate) type Visit<'a> = dyn FnMut(u32, [Vec3; 3], f32) -> f32 + 'a;

/// Result of a cast.
#[derive(Clone, Copy, Debug)]
pub(crate) enum CastResult {
    /// A triangle may be near at the start: the kernel has to run there first.
    Near,
    /// No triangle is touched.
    Free,
    First(Touch),
}

/// First touch of a convex shape with a triangle of a mesh or height field, other than those it rests on; see
/// [`MeshCast`]. `rel`: pose of the mesh in the shape's frame at the start. `nearby`: buffer for the
/// triangles, if there is memory.
pub(crate) fn cast_mesh(
    a: &Collider,
    mesh: &Collider,
    rel: &Relative,
    motion: &Motion,
    cast: MeshCast,
    mut nearby: Option<&mut Nearby>,
) -> CastResult {
    let Some(ground) = mesh.geometry.ground() else { return CastResult::Free };
    let Some(shape) = a.geometry.support() else { return CastResult::Free };
    let turns = motion.b.spin != Vec3::ZERO;
    if turns && cast.alone >= 0.0 {
        return CastResult::Near;
    }
    let path = (!turns).then(|| ShapePath::new(a, rel, motion, &cast));
    if let (Some(path), Some(nearby)) = (&path, &mut nearby)
        && let Some(extent) = path.in_box().as_box()
    {
        let mut passes = true;
        nearby.gather(&ground, extent, &mut |found| {
            passes = passes && found.each().all(|(eight, lanes)| path.passes(eight, lanes));
        });
        if passes {
            return CastResult::Free;
        }
    }
    let mut search = Search::new(shape, motion, cast);
    let path = search.prepare(a, rel, path);
    match (nearby, path.as_box()) {
        (Some(nearby), Some(extent)) => nearby.gather(&ground, extent, &mut |found| {
            found.each().for_each(|(eight, lanes)| search.look(eight, lanes));
        }),
        _ => search.go_along(|f| ground.visit_segment(path.from, path.to, path.inflate, f)),
    }
    search.finish()
}

/// Whether a convex shape overlaps a triangle of a mesh or height field, or is within `tolerance` of one [m].
/// `rel`: pose of the mesh in the shape's frame.
pub(crate) fn touches_mesh(a: &Collider, mesh: &Collider, rel: &Relative, tolerance: f32) -> bool {
    let (Some(ground), Some(shape)) = (mesh.geometry.ground(), a.geometry.support()) else { return false };
    let pose = rel.exact();
    let (to_mesh, tolerance) = (pose.rotation.transpose(), f64::from(tolerance));
    let at = to_mesh * -pose.position;
    let half = shape.half_extents(to_mesh) + DVec3::splat(tolerance);
    // `f32` rounds the box.
    let half = half + 1e-6 * (at.abs() + half);
    let (min, max) = ((at - half).as_vec3(), (at + half).as_vec3());
    let accuracy = Accuracy { absolute: 0.1 * tolerance, relative: 1e-3 };
    let mut near = |_: u32, corners: [Vec3; 3]| {
        let triangle = Support::triangle(corners);
        let hint = pose.rotation * corners[0].as_dvec3() + pose.position;
        let gap = core_gap(&shape, &triangle, &pose, hint, &mut Simplex::empty(), accuracy);
        gap.lower - shape.radius - triangle.radius <= tolerance
    };
    ground.any_in_box(min, max, &mut near)
}

/// A cast that is under way.
///
/// Triangles are examined in lanes, eight at a time; the planes of most are not reached. The others wait
/// until there are eight of them; a closer look in lanes then keeps those that may be touched, and says when
/// at the earliest. At the end the one that may be touched first is searched exactly. A touch ends the motion
/// for all others, few of which can be touched before it, as the same look tells.
struct Search<'a> {
    shape: Support<'a>,
    motion: &'a Motion,
    cast: MeshCast,
    /// Made when the first triangle is searched exactly.
    exact: Option<Exact<'a>>,
    /// Present if the mesh doesn't turn.
    filter: Option<MeshSweep<'a>>,
    /// Triangles whose planes are reached.
    waiting: Eight,
    /// Those that may be touched, though not before these fractions of the step.
    sifted: Eight,
    earliest: [f32; 8],
    first: Option<Touch>,
    /// Fraction of the step beyond which a touch doesn't matter.
    limit: f64,
    near: bool,
}

/// Input of an exact search.
struct Exact<'a> {
    sweep: Sweep<'a>,
    start: Placed,
    /// Poses in the middle and at the end of the step, computed when first needed.
    later: Option<(Placed, Placed)>,
}

// Rounding: of a fraction of the step.
/// Rounding error of an earliest fraction.
const EARLY: f64 = 1e-5;

impl<'a> Search<'a> {
    fn new(shape: Support<'a>, motion: &'a Motion, cast: MeshCast) -> Search<'a> {
        Search {
            shape,
            motion,
            cast,
            exact: None,
            filter: None,
            waiting: Eight::default(),
            sifted: Eight::default(),
            earliest: [0.0; 8],
            first: None,
            limit: 1.0,
            near: false,
        }
    }

    /// Prepares the examination of triangles along the path, and returns that. `path`: of a mesh that doesn't
    /// turn.
    fn prepare(&mut self, a: &'a Collider, rel: &Relative, path: Option<ShapePath>) -> BoxPath {
        let (motion, tolerance) = (self.motion, self.cast.tolerance);
        if let Some(path) = path {
            self.filter = Some(MeshSweep::new(a, rel, motion, tolerance));
            return path.in_box();
        }
        self.exact().sweep.path_in_b(motion)
    }

    fn exact(&mut self) -> &mut Exact<'a> {
        let Search { shape, motion, cast, .. } = self;
        self.exact.get_or_insert_with(|| {
            let nothing = Support::triangle([Vec3::ZERO; 3]);
            let sweep = Sweep::new(*shape, Other::Convex(nothing), motion, cast.tolerance);
            Exact { start: sweep.placed(0.0), sweep, later: None }
        })
    }

    /// Examines the triangles along a path, nearer ones first. `along`: calls its argument with each.
    fn go_along(&mut self, along: impl FnOnce(&mut Visit<'_>)) {
        let mut seen = Eight::default();
        let mut visit = |index: u32, corners: [Vec3; 3], _: f32| -> f32 {
            seen.push(index, corners);
            if seen.is_full() {
                self.look(&seen, seen.lanes());
                seen.clear();
            }
            self.limit as f32
        };
        along(&mut visit);
        self.look(&seen, seen.lanes());
    }

    fn finish(&mut self) -> CastResult {
        if self.limit >= 0.0 && self.waiting.lanes() != 0 {
            self.sift();
        }
        if self.limit >= 0.0 {
            self.settle();
        }
        match self.first {
            _ if self.near => CastResult::Near,
            Some(touch) => CastResult::First(touch),
            None => CastResult::Free,
        }
    }

    /// Keeps those of eight triangles whose planes are reached.
    fn look(&mut self, eight: &Eight, lanes: u32) {
        if self.limit < 0.0 {
            return;
        }
        let mut left = lanes;
        if let Some(filter) = &self.filter {
            let reached = filter.by_planes(eight, lanes, &self.cast);
            if reached.near {
                (self.near, self.limit) = (true, -1.0);
                return;
            }
            left = reached.lanes;
        }
        for lane in ones(left) {
            if !self.cast.known.has(eight.index[lane]) {
                if self.waiting.is_full() {
                    self.sift();
                }
                self.waiting.push(eight.index[lane], eight.corners.triangle(lane));
            }
        }
    }

    /// Keeps those of the waiting triangles that may be touched.
    fn sift(&mut self) {
        let lanes = self.waiting.lanes();
        let (left, earliest) = match &self.filter {
            Some(filter) => filter.sift(&self.waiting, lanes, &self.cast),
            None => (lanes, [0.0; 8]),
        };
        for lane in ones(left) {
            if f64::from(earliest[lane]) < self.limit {
                if self.sifted.is_full() {
                    self.settle();
                }
                self.earliest[self.sifted.count()] = earliest[lane];
                self.sifted.push(self.waiting.index[lane], self.waiting.corners.triangle(lane));
            }
        }
        self.waiting.clear();
    }

    /// Searches the remaining triangles exactly, the earliest first.
    fn settle(&mut self) {
        let mut left = self.sifted.lanes();
        while let Some(next) = ones(left).min_by(|&a, &b| self.earliest[a].total_cmp(&self.earliest[b]))
            && f64::from(self.earliest[next]) < self.limit
        {
            left &= !(1 << next);
            let Some(touch) = self.touch(self.sifted.corners.triangle(next), f64::from(self.earliest[next]))
            else {
                continue;
            };
            self.first = Some(touch);
            if self.cast.any {
                self.limit = -1.0;
                break;
            }
            self.limit = f64::from(touch.fraction);
            if let Some(filter) = &mut self.filter {
                filter.end_at(touch.fraction);
                if left != 0 {
                    (left, self.earliest) = filter.sift(&self.sifted, left, &self.cast);
                }
            }
        }
        self.sifted.clear();
    }

    /// The first touch with a triangle before the limit. It is not before `earliest`; zero means that the
    /// shape may rest on the triangle.
    fn touch(&mut self, corners: [Vec3; 3], earliest: f64) -> Option<Touch> {
        let (motion, limit) = (self.motion, self.limit);
        let (tolerance, resting) = (f64::from(self.cast.tolerance), f64::from(self.cast.resting));
        let Exact { sweep, start, later } = self.exact();
        let triangle = Support::triangle(corners);
        let [p, q, r] = corners.map(Vec3::as_dvec3);
        let up = start.rotation_b * (q - p).cross(r - p).normalize_or_zero();
        let corner = start.rotation_b * p + start.offset;
        // From the shape's origin to the plane.
        let down = if up.dot(corner) > 0.0 { up } else { -up };
        sweep.set_triangle(triangle, motion, down);
        let mut from = (0.0, *start);
        if !sweep.b_spins() {
            let height = sweep.gap_along(start, down);
            if earliest > EARLY {
                let t = earliest - EARLY;
                from = (t, sweep.placed(t));
            } else if height.abs() <= resting {
                let (middle, end) = later.get_or_insert_with(|| (sweep.placed(0.5), sweep.placed(1.0)));
                if [middle, end].iter().all(|placed| sweep.gap_along(placed, down) >= -resting) {
                    return None;
                }
            }
            let height = if from.0 > 0.0 { sweep.gap_along(&from.1, down) } else { height };
            if height > if from.0 > 0.0 { tolerance } else { resting.max(tolerance) } {
                // The plane is touched before the triangle, and mostly at a point of the triangle.
                let (t, placed) = sweep.reach_plane(from.0, from.1, height, down, limit)?;
                let point = sweep.furthest(&placed, down) - placed.offset;
                let corners = [p, q, r].map(|v| placed.rotation_b * v);
                let inside = |i: usize| {
                    let (from, to) = (corners[i], corners[(i + 1) % 3]);
                    (to - from).cross(point - from).dot(up) >= 0.0
                };
                if inside(0) && inside(1) && inside(2) {
                    return Some(Touch { fraction: t as f32, normal: down.as_vec3() });
                }
                from = (t, placed);
            }
        }
        let (t, placed) = from;
        let mut simplex = Simplex::empty();
        let gap = sweep.gap(&placed, &mut simplex);
        if t == 0.0 && gap.lower <= resting {
            return None;
        }
        sweep.touch_after(t, placed, gap, simplex, limit)
    }
}

#[cfg(test)]
mod tests;
