//! Moving shapes: the first shape that a convex shape touches on a straight path, whether it touches any, and
//! all that it would touch.

use super::advance::{Course, Touch, first_touch, first_touch_plane};
use super::candidates::{Candidate, turn};
use super::filter::QueryFilter;
use super::probe::Probe;
use super::ray::check_path;
use super::turning::{Turning, first_touch_plane_turning, first_touch_turning};
use crate::error::{Error, within};
use crate::handle::{BodyHandle, ShapeHandle};
use crate::math::Quat;
use crate::narrow_phase::{Support, SupportPose};
use crate::shape::{Geometry, Kind};
use crate::world::World;
use glam::{DQuat, DVec3, Vec3};

// Guard: beyond that many radians f32 has no angle left.
/// The most that a component of a spin may be [rad].
const MAX_SPIN: f32 = 1e3;

/// A convex shape that moves straight ahead, and may turn on its way.
#[derive(Clone, Copy, Debug)]
pub struct ShapeCast<'a> {
    /// Its form: a sphere, capsule, box, cylinder (cone, frustum) or hull.
    pub shape: &'a Geometry,
    /// Where its origin is at the start, in the world [m].
    pub position: DVec3,
    /// Its rotation; a unit quaternion.
    pub rotation: glam::Quat,
    /// From its start to its end [m]. It may be zero: then it touches the shapes that it overlaps.
    pub path: Vec3,
    /// Its rotation on the way, about a fixed axis: a rotation vector in the world, within 1000 [rad], which
    /// may be several turns. Default: zero, it does not turn.
    pub spin: Vec3,
    /// The point of the shape that moves straight along the path while the shape turns about it, in the
    /// shape's frame [m]. Without spin all points do. Default: zero, its origin.
    pub pivot: Vec3,
}

impl<'a> ShapeCast<'a> {
    /// A shape that moves from a point along a path [m].
    pub fn new(shape: &'a Geometry, position: impl Into<DVec3>, path: Vec3) -> ShapeCast<'a> {
        ShapeCast {
            shape,
            position: position.into(),
            rotation: glam::Quat::IDENTITY,
            path,
            spin: Vec3::ZERO,
            pivot: Vec3::ZERO,
        }
    }
    /// A shape that moves from one pose to another: its origin straight, its rotation the shorter way about
    /// one axis. The rotations are unit quaternions.
    pub fn between(shape: &'a Geometry, from: (DVec3, glam::Quat), to: (DVec3, glam::Quat)) -> ShapeCast<'a> {
        let spin = Quat::from(from.1).turn_to(to.1.into());
        ShapeCast::new(shape, from.0, (to.0 - from.0).as_vec3()).with_rotation(from.1).with_spin(spin)
    }
    /// A shape that moves for `dt` [s] with a linear [m/s] and an angular velocity [rad/s].
    pub fn moving(
        shape: &'a Geometry,
        position: impl Into<DVec3>,
        linear: Vec3,
        angular: Vec3,
        dt: f32,
    ) -> ShapeCast<'a> {
        ShapeCast::new(shape, position, linear * dt).with_spin(angular * dt)
    }
    /// Turning on the way by a rotation vector in the world [rad].
    pub fn with_spin(mut self, spin: Vec3) -> ShapeCast<'a> {
        self.spin = spin;
        self
    }
    /// Turning about a point of the shape, in its frame [m].
    pub fn with_pivot(mut self, pivot: Vec3) -> ShapeCast<'a> {
        self.pivot = pivot;
        self
    }
    /// Turned by a unit quaternion.
    pub fn with_rotation(mut self, rotation: impl Into<glam::Quat>) -> ShapeCast<'a> {
        self.rotation = rotation.into();
        self
    }
    /// Where its origin is at a fraction of the path [m].
    pub fn position_at(&self, fraction: f32) -> DVec3 {
        let straight = self.position + self.path.as_dvec3() * f64::from(fraction);
        if self.spin == Vec3::ZERO || self.pivot == Vec3::ZERO {
            return straight;
        }
        let arm = turn(self.rotation.into(), self.pivot.as_dvec3());
        let turned = spun(self.spin.as_dvec3() * f64::from(fraction));
        straight + arm - turned * arm
    }
    /// How it is turned at a fraction of the path.
    pub fn rotation_at(&self, fraction: f32) -> glam::Quat {
        if self.spin == Vec3::ZERO {
            return self.rotation;
        }
        let start = Quat::from(self.rotation).as_dquat().normalize();
        Quat::from(spun(self.spin.as_dvec3() * f64::from(fraction)) * start).into()
    }
}

/// The rotation of a rotation vector [rad].
fn spun(vector: DVec3) -> DQuat {
    let angle = vector.length();
    if angle == 0.0 {
        return DQuat::IDENTITY;
    }
    let v = vector * (libm::sin(0.5 * angle) / angle);
    DQuat::from_xyzw(v.x, v.y, v.z, libm::cos(0.5 * angle))
}

/// A touch of a moving shape.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ShapeHit {
    /// Whose shape it is.
    pub body: BodyHandle,
    /// Which shape.
    pub shape: ShapeHandle,
    /// Fraction of the path, 0..=1, at which they touch; zero if they overlap at the start.
    pub fraction: f32,
    /// Where they touch, on the surface of the shape that is touched, in the world [m].
    pub point: DVec3,
    /// Unit vector from the touched shape towards the moving one. For an overlap, the direction of the
    /// shortest way out.
    pub normal: Vec3,
    /// How far the moving shape has to go along the normal to get out of an overlap at the start [m]; zero
    /// without one.
    pub depth: f32,
    /// Index of the triangle, for a triangle mesh or a height field.
    pub triangle: Option<u32>,
}

/// A touch with a shape.
#[derive(Clone, Copy, Debug)]
struct Found {
    touch: Touch,
    triangle: Option<u32>,
}

impl Found {
    fn fraction(&self) -> f32 {
        round_down(self.touch.fraction)
    }
}

/// # Queries: moving shapes
impl World {
    /// The first shape that a moving one touches.
    ///
    /// The fraction is early, by a gap of at most a hundred-thousandth of the smaller shape and at most 5 µm
    /// (of the larger: the resolution of `f32` over it), and never late: moved up to there, the shape
    /// overlaps nothing that it did not overlap at the start. Shapes that it overlaps at the start are
    /// touched at the fraction 0, with [`ShapeHit::depth`] and the direction out, for any path; with
    /// [`QueryFilter::skip_inside`] only if it goes deeper. Adjacent shapes without overlap count if the path
    /// leads into them, not along them. Triangles of meshes and height fields are touched from both sides,
    /// each on its own: overlap refers to single triangles. If several overlap at the start, the deepest is
    /// reported. Among shapes at the same fraction the one with the lower [`ShapeHandle`] is reported, among
    /// triangles the one with the lower index.
    ///
    /// A shape that turns ([`ShapeCast::spin`]) is touched by the same rules, at the first fraction of its
    /// motion, not of a path in small steps; one that only slides along while it turns may be touched where
    /// the gap is below the tolerance.
    ///
    /// When, where and how often it may be asked: as [`World::cast_ray`].
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// // A sphere of 0.3 m which sweeps 10 m downwards meets the cube after 2.2 m.
    /// let sphere = Geometry::sphere(0.3);
    /// let cast = ShapeCast::new(&sphere, DVec3::Y * 5.0, Vec3::NEG_Y * 10.0);
    /// let hit = world.cast_shape(&cast, &QueryFilter::default())?.expect("the cube is below");
    /// assert_eq!(hit.body, body);
    /// assert!((hit.fraction - 0.22).abs() < 1e-4);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// The shape is not convex or has no size, the rotation is not a unit quaternion, a number is not finite
    /// or beyond 1e15, or the budget does not allow the tree of movable bodies (see [`World::cast_ray`]).
    pub fn cast_shape(
        &self,
        cast: &ShapeCast<'_>,
        filter: &QueryFilter<'_>,
    ) -> Result<Option<ShapeHit>, Error> {
        self.first_on_way(&check(cast)?, &Motion::of(cast)?, filter)
    }

    /// Whether a moving shape touches anything at all: less work than [`World::cast_shape`], whose rules it
    /// follows.
    ///
    /// # Errors
    /// As there.
    pub fn cast_shape_any(&self, cast: &ShapeCast<'_>, filter: &QueryFilter<'_>) -> Result<bool, Error> {
        let probe = check(cast)?;
        let mut any = false;
        self.on_way(&probe, &Motion::of(cast)?, filter, true, |_, _, _| {
            any = true;
            -1.0
        })?;
        Ok(any)
    }

    /// All shapes that a moving one would touch if none stopped it, each where it is touched first, by
    /// fraction and then by [`ShapeHandle`]. They replace the content of `hits`, which alone may grow. With a
    /// path of zero: all that it overlaps, with depths. The rules are those of [`World::cast_shape`].
    ///
    /// # Errors
    /// As there; then `hits` is as it was.
    pub fn cast_shape_all(
        &self,
        cast: &ShapeCast<'_>,
        filter: &QueryFilter<'_>,
        hits: &mut Vec<ShapeHit>,
    ) -> Result<(), Error> {
        let (probe, motion) = (check(cast)?, Motion::of(cast)?);
        self.ready(filter)?;
        hits.clear();
        self.on_way(&probe, &motion, filter, false, |candidate, found, _| {
            hits.push(self.shape_hit(&probe, candidate.index, found));
            1.0
        })?;
        hits.sort_unstable_by(|a, b| a.fraction.total_cmp(&b.fraction).then(a.shape.cmp(&b.shape)));
        Ok(())
    }

    /// [`World::cast_shape`] of a shape that was checked.
    ///
    /// # Errors
    /// As there, of the path and the budget.
    pub(crate) fn cast_probe(
        &self,
        probe: &Probe<'_>,
        path: Vec3,
        filter: &QueryFilter<'_>,
    ) -> Result<Option<ShapeHit>, Error> {
        check_path("shape path", path)?;
        self.first_on_way(probe, &Motion::straight(path), filter)
    }

    fn first_on_way(
        &self,
        probe: &Probe<'_>,
        motion: &Motion,
        filter: &QueryFilter<'_>,
    ) -> Result<Option<ShapeHit>, Error> {
        let mut first: Option<(f32, u32, Found)> = None;
        self.on_way(probe, motion, filter, false, |candidate, found, fraction| {
            let key = (fraction, candidate.index);
            if first.as_ref().is_none_or(|f| key < (f.0, f.1)) {
                first = Some((key.0, key.1, *found));
            }
            first.as_ref().map_or(fraction, |f| f.0)
        })?;
        Ok(first.map(|(_, index, found)| self.shape_hit(probe, index, &found)))
    }

    /// Calls `f` with each shape that a convex one overlaps, in no particular order; for a mesh with its
    /// deepest triangle.
    pub(crate) fn each_overlap(
        &self,
        probe: &Probe<'_>,
        filter: &QueryFilter<'_>,
        mut f: impl FnMut(ShapeHit),
    ) -> Result<(), Error> {
        let filter = QueryFilter { skip_inside: false, ..*filter };
        self.on_way(probe, &Motion::straight(Vec3::ZERO), &filter, false, |candidate, found, _| {
            f(self.shape_hit(probe, candidate.index, found));
            1.0
        })?;
        Ok(())
    }

    /// Calls `f` with all that a moving shape touches up to the fraction that `f` last returned.
    fn on_way<'a>(
        &'a self,
        probe: &Probe<'_>,
        motion: &Motion,
        filter: &QueryFilter<'_>,
        any: bool,
        mut f: impl FnMut(&Candidate<'a>, &Found, f32) -> f32,
    ) -> Result<(), Error> {
        let local = probe.local(motion.path);
        let turning = (motion.spin != Vec3::ZERO)
            .then(|| Turning::new(&probe.support, local, probe.local(motion.spin), motion.pivot.as_dvec3()));
        let (from, half) = match &turning {
            None => (probe.position, probe.half),
            Some(turning) => swept_box(probe, turning),
        };
        self.along(from, motion.path, half, filter, 1.0, |candidate, most| {
            let course = Course {
                path: local,
                tolerance: probe.tolerance(candidate.shape),
                skip_inside: filter.skip_inside,
            };
            let found = match &turning {
                None => touch(probe, candidate, &course, most, any),
                Some(turning) => touch_turning(probe, candidate, turning, &course, most, any),
            };
            match found {
                Some(found) if found.fraction() <= most => f(candidate, &found, found.fraction()),
                _ => most,
            }
        })
    }

    fn shape_hit(&self, probe: &Probe<'_>, index: u32, found: &Found) -> ShapeHit {
        let (body, shape) = self.handles(index);
        let touch = &found.touch;
        ShapeHit {
            body,
            shape,
            fraction: found.fraction(),
            point: probe.position + probe.global(touch.point),
            normal: -probe.global(touch.normal).as_vec3(),
            depth: touch.depth as f32,
            triangle: found.triangle,
        }
    }
}

/// Translation and rotation of a cast: see [`ShapeCast`].
struct Motion {
    path: Vec3,
    spin: Vec3,
    pivot: Vec3,
}

impl Motion {
    fn straight(path: Vec3) -> Motion {
        Motion { path, spin: Vec3::ZERO, pivot: Vec3::ZERO }
    }

    /// # Errors
    /// A number is not finite, or beyond its range.
    fn of(cast: &ShapeCast<'_>) -> Result<Motion, Error> {
        let ShapeCast { path, spin, pivot, .. } = *cast;
        check_path("shape pivot", pivot)?;
        for value in spin.to_array() {
            within("shape spin", value, -MAX_SPIN, MAX_SPIN, "within 1000")?;
        }
        Ok(Motion { path, spin, pivot })
    }
}

/// The pivot of a turning shape in the world, and half extents of a box around all that it sweeps about it.
fn swept_box(probe: &Probe<'_>, turning: &Turning) -> (DVec3, Vec3) {
    let from = probe.position + probe.global(turning.pivot);
    let along = |axis: Vec3| turning.swept(&probe.support, probe.local(axis)) as f32;
    let whole = Vec3::new(along(Vec3::X), along(Vec3::Y), along(Vec3::Z));
    // No point of it gets further than its arc from where it starts.
    let arc = (turning.reach * turning.angle) as f32;
    let start = probe.half + (probe.position - from).as_vec3().abs() + Vec3::splat(arc);
    (from, whole.min(start) * (1.0 + 8.0 * f32::EPSILON))
}

fn check<'a>(cast: &ShapeCast<'a>) -> Result<Probe<'a>, Error> {
    check_path("shape path", cast.path)?;
    Probe::new(cast.shape, cast.position, cast.rotation.into())
}

/// The number itself or the next below in `f32`: never late.
fn round_down(fraction: f64) -> f32 {
    let near = fraction.min(1.0) as f32;
    if f64::from(near) > fraction { near.next_down() } else { near }
}

/// A fraction that may come out a little larger than another one that rounds to the same number.
fn limit(most: f32) -> f64 {
    (f64::from(most) * (1.0 + 1e-6)).min(1.0)
}

fn touch(
    probe: &Probe<'_>,
    candidate: &Candidate<'_>,
    course: &Course,
    most: f32,
    any: bool,
) -> Option<Found> {
    let pose = probe.pose_of(candidate);
    let touch = match candidate.shape.kind {
        Kind::Plane => first_touch_plane(&probe.support, &pose, course, limit(most)),
        kind if kind.is_ground() => return touch_triangles(probe, candidate, &pose, course, most, any),
        _ => {
            let other = candidate.shape.geometry.support()?;
            first_touch(&probe.support, &other, &pose, pose.position, course, limit(most))
        }
    }?;
    Some(Found { touch, triangle: None })
}

/// [`touch`] of a shape that turns.
fn touch_turning(
    probe: &Probe<'_>,
    candidate: &Candidate<'_>,
    turning: &Turning,
    course: &Course,
    most: f32,
    any: bool,
) -> Option<Found> {
    let (a, pose) = (&probe.support, probe.pose_of(candidate));
    let touch = match candidate.shape.kind {
        Kind::Plane => first_touch_plane_turning(a, &pose, turning, course, limit(most)),
        kind if kind.is_ground() => {
            let to_mesh = pose.rotation.transpose();
            let along = |axis: DVec3| turning.swept(a, axis);
            let whole = DVec3::from_array(pose.rotation.to_cols_array_2d().map(|axis| along(axis.into())));
            let half = whole + 2.0 * course.tolerance;
            let sweep = (to_mesh * (turning.pivot - pose.position), to_mesh * course.path, half);
            return each_triangle(candidate, sweep, most, any, |corners, most| {
                let normal = reaches_turning(a, &pose, corners, turning, course)?;
                let triangle = Support::triangle(corners);
                first_touch_turning(a, &triangle, &pose, normal, turning, course, limit(most))
            });
        }
        _ => {
            let other = candidate.shape.geometry.support()?;
            first_touch_turning(a, &other, &pose, pose.position, turning, course, limit(most))
        }
    }?;
    Some(Found { touch, triangle: None })
}

/// [`reaches`] of a shape that turns.
fn reaches_turning(
    a: &Support,
    pose: &SupportPose,
    corners: [Vec3; 3],
    turning: &Turning,
    course: &Course,
) -> Option<DVec3> {
    let [p, q, r] = corners.map(|v| pose.rotation * v.as_dvec3() + pose.position);
    let normal = (q - p).cross(r - p).normalize_or_zero();
    let height = normal.dot(p);
    let toward = if height < 0.0 { -normal } else { normal };
    let (height, moved) = (height.abs() - toward.dot(turning.pivot), toward.dot(course.path));
    let around = turning.swept(a, toward) + course.tolerance;
    (height <= around + moved.max(0.0) && height >= moved.min(0.0) - around).then_some(toward)
}

fn touch_triangles(
    probe: &Probe<'_>,
    candidate: &Candidate<'_>,
    pose: &SupportPose,
    course: &Course,
    most: f32,
    any: bool,
) -> Option<Found> {
    let to_mesh = pose.rotation.transpose();
    let (from, path) = (to_mesh * -pose.position, to_mesh * course.path);
    let half = probe.support.half_extents(to_mesh) + 2.0 * course.tolerance;
    each_triangle(candidate, (from, path, half), most, any, |corners, most| {
        let normal = reaches(&probe.support, pose, corners, course)?;
        let triangle = Support::triangle(corners);
        first_touch(&probe.support, &triangle, pose, normal, course, limit(most))
    })
}

/// The first touch with triangles that a box meets on its way. In the mesh's frame: where it starts, its
/// path, and its half extents.
#[inline(always)]
fn each_triangle(
    candidate: &Candidate<'_>,
    (from, path, half): (DVec3, DVec3, DVec3),
    most: f32,
    any: bool,
    first: impl Fn([Vec3; 3], f32) -> Option<Touch>,
) -> Option<Found> {
    let inflate = half.as_vec3() * (1.0 + 1e-6);
    let mut best: Option<(f32, u32, Touch)> = None;
    let mut look = |index: u32, corners: [Vec3; 3], most: f32| {
        let Some(touch) = first(corners, most) else { return most };
        let fraction = round_down(touch.fraction);
        // The deeper one first, then the lower index.
        let better =
            |other: &(f32, u32, Touch)| (fraction, -touch.depth, index) < (other.0, -other.2.depth, other.1);
        if fraction <= most && best.as_ref().is_none_or(better) {
            best = Some((fraction, index, touch));
        }
        if any && best.is_some() { -1.0 } else { best.as_ref().map_or(most, |b| most.min(b.0)) }
    };
    candidate.shape.geometry.ground()?.visit_path(from, path.as_vec3(), inflate, most, &mut look);
    best.map(|(_, index, touch)| Found { touch, triangle: Some(index) })
}

/// Whether the moving shape reaches the plane of a triangle, and about the direction there; most that are
/// near it don't.
fn reaches(a: &Support, pose: &SupportPose, corners: [Vec3; 3], course: &Course) -> Option<DVec3> {
    let [p, q, r] = corners.map(|v| pose.rotation * v.as_dvec3() + pose.position);
    let normal = (q - p).cross(r - p).normalize_or_zero();
    let height = normal.dot(p);
    let toward = if height < 0.0 { -normal } else { normal };
    let (height, moved) = (height.abs(), toward.dot(course.path));
    let ahead = a.support(toward).dot(toward) + a.radius + moved.max(0.0) + course.tolerance;
    let behind = a.support(-toward).dot(toward) - a.radius + moved.min(0.0) - course.tolerance;
    (height <= ahead && height >= behind).then_some(toward)
}
