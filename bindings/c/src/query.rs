//! Queries: rays, moving shapes, overlaps, nearest points. They change nothing, and may come from any number
//! of threads at once.

mod cast;
mod overlap;

pub use cast::*;
pub use overlap::*;

use crate::abi::guard::call;
use crate::abi::pointers::{Buffer, Out, borrow, slice};
use crate::abi::sized::read_or_default;
use crate::abi::status::{BsStatus, Outcome};
use crate::abi::twin::record;
use crate::abi::values::{BsBody, BsBool, BsDVec3, BsPose, BsShape, BsVec3};
use crate::shape::{BsFilter, BsGeometry, bs_filter_default};
use crate::world::{BsWorld, reading};
use backstop::{
    BodyHandle, ClosestPoint, Filter, Geometry, QueryFilter, QueryTarget, Ray, RayHit, ShapeCast,
    ShapeHandle, ShapeHit, World,
};
use std::ffi::c_void;
use std::ptr::null_mut;

/// The caller's own say whether a shape is seen: not zero if it is. It may read the world, and must not
/// change it, nor throw or jump out of the call.
pub type BsQueryPredicate =
    Option<unsafe extern "C" fn(user: *mut c_void, body: BsBody, shape: BsShape) -> BsBool>;

record! {
    /// Which shapes a query sees.
    #[repr(C)]
    #[derive(Clone, Copy, Debug)]
    pub struct BsQueryFilter of query: QueryFilter<'_> {
        /// Size of this struct; `bs_query_filter_default` fills it in.
        pub size: u32 = size_of::<BsQueryFilter>() as u32,
        /// Whether shapes of static bodies are seen. Default yes.
        pub statics: BsBool,
        /// Whether shapes of kinematic bodies are seen. Default yes.
        pub kinematic: BsBool,
        /// Whether shapes of dynamic bodies are seen. Default yes.
        pub dynamic: BsBool,
        /// Whether sensors are seen. Default no.
        pub sensors: BsBool,
        /// Whether what a ray starts in, or a moving shape overlaps at the start and moves out of, is not
        /// seen. Default no.
        pub skip_inside: BsBool,
        /// Whether only shapes are seen that would collide with one of `filter`. Default no.
        pub has_filter: BsBool = query.filter.is_some().into(),
        /// Zero.
        pub reserved: [u8; 6] = [0; 6],
        /// See `has_filter`.
        pub filter: BsFilter = query.filter.as_ref().map_or(bs_filter_default(), BsFilter::of_engine),
        /// A body whose shapes are not seen; all zeros for none.
        pub exclude_body: BsBody = BsBody::NONE,
        /// A shape that is not seen; all zeros for none.
        pub exclude_shape: BsShape = BsShape::NONE,
        /// The caller's own say, asked last, or null. It may be asked more than once about a shape.
        pub predicate: BsQueryPredicate = None,
        /// What the predicate is called with.
        pub user: *mut c_void = null_mut(),
        /// The only body whose shapes are seen; all zeros for any.
        pub only_body: BsBody = BsBody::NONE,
        /// The only shape that is seen, whatever `only_body` says; all zeros for any.
        pub only_shape: BsShape = BsShape::NONE,
    }
    default bs_query_filter_default()
}

/// All shapes but sensors.
#[unsafe(no_mangle)]
pub extern "C" fn bs_query_filter_default() -> BsQueryFilter {
    BsQueryFilter::of_engine(&QueryFilter::new())
}

/// Calls `work` with the engine's filter.
///
/// # Safety
/// The pointer is null or that of a filter, and its predicate may be called with its `user`.
pub(crate) unsafe fn with_filter(
    filter: *const BsQueryFilter,
    work: impl FnOnce(&QueryFilter<'_>) -> Outcome,
) -> Outcome {
    // SAFETY: as this function.
    let filter = unsafe { read_or_default(filter) }?;
    let allows = |body: BodyHandle, shape: ShapeHandle| match filter.predicate {
        // SAFETY: as this function.
        Some(predicate) => unsafe { predicate(filter.user, body.into(), shape.into()) != 0 },
        None => true,
    };
    let mut query = filter.on(QueryFilter::new())?;
    if filter.has_filter != 0 {
        query.filter = Some(filter.filter.on(Filter::default())?);
    }
    query.exclude_body = (filter.exclude_body != BsBody::NONE).then(|| filter.exclude_body.into());
    query.exclude_shape = (filter.exclude_shape != BsShape::NONE).then(|| filter.exclude_shape.into());
    if filter.only_shape != BsShape::NONE {
        query.only = Some(QueryTarget::Shape(filter.only_shape.into()));
    } else if filter.only_body != BsBody::NONE {
        query.only = Some(QueryTarget::Body(filter.only_body.into()));
    }
    if filter.predicate.is_some() {
        query.predicate = Some(&allows);
    }
    work(&query)
}

/// No triangle: the shape is no mesh and no height field.
pub const BS_NO_TRIANGLE: u32 = u32::MAX;

/// A ray.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsRay {
    /// Where it starts, in the world [m].
    pub from: BsDVec3,
    /// From its start to its end [m]: direction times length.
    pub path: BsVec3,
    /// Zero.
    pub reserved: u32,
}

impl BsRay {
    fn to_engine(self) -> Ray {
        Ray::new(self.from, self.path.into())
    }
}

/// What a ray or a moving shape meets.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsHit {
    /// Whose shape it is.
    pub body: BsBody,
    /// Which shape.
    pub shape: BsShape,
    /// Where, in the world [m].
    pub point: BsDVec3,
    /// Unit, out of the shape; towards the moving one. Zero if a ray starts inside.
    pub normal: BsVec3,
    /// Fraction of the path, 0..=1.
    pub fraction: f32,
    /// How far a moving shape that overlaps it at the start has to go along the normal to get out [m].
    pub depth: f32,
    /// Index of the triangle of a mesh or height field, or `BS_NO_TRIANGLE`.
    pub triangle: u32,
    /// Whether there is a hit at all. If not, all else is zero.
    pub hit: BsBool,
    /// Whether a ray starts inside of it.
    pub inside: BsBool,
    /// Zero.
    pub reserved: [u8; 6],
}

impl Default for BsHit {
    fn default() -> BsHit {
        BsHit::NONE
    }
}

impl BsHit {
    const NONE: BsHit = BsHit {
        body: BsBody::NONE,
        shape: BsShape::NONE,
        point: BsDVec3 { x: 0.0, y: 0.0, z: 0.0 },
        normal: BsVec3 { x: 0.0, y: 0.0, z: 0.0 },
        fraction: 0.0,
        depth: 0.0,
        triangle: BS_NO_TRIANGLE,
        hit: 0,
        inside: 0,
        reserved: [0; 6],
    };

    fn of_ray(hit: &RayHit) -> BsHit {
        BsHit {
            body: hit.body.into(),
            shape: hit.shape.into(),
            point: hit.point.into(),
            normal: hit.normal.into(),
            fraction: hit.fraction,
            triangle: hit.triangle.unwrap_or(BS_NO_TRIANGLE),
            hit: 1,
            inside: hit.inside.into(),
            ..BsHit::NONE
        }
    }

    fn of_shape(hit: &ShapeHit) -> BsHit {
        BsHit {
            body: hit.body.into(),
            shape: hit.shape.into(),
            point: hit.point.into(),
            normal: hit.normal.into(),
            fraction: hit.fraction,
            depth: hit.depth,
            triangle: hit.triangle.unwrap_or(BS_NO_TRIANGLE),
            hit: 1,
            ..BsHit::NONE
        }
    }
}

/// A query with one answer.
///
/// # Safety
/// As `with_filter`; the world is null or one that nobody destroys meanwhile, the place null or one.
unsafe fn ask<T>(
    world: *const BsWorld,
    filter: *const BsQueryFilter,
    place: *mut T,
    work: impl FnOnce(&World, &QueryFilter<'_>) -> Outcome<T>,
) -> BsStatus {
    call(|| {
        // SAFETY: as this function.
        let (content, out) = unsafe { (reading(world)?, Out::new("the place for the answer", place)?) };
        let answer = |filter: &QueryFilter<'_>| {
            out.set(work(&content, filter)?);
            Ok(())
        };
        // SAFETY: as this function.
        unsafe { with_filter(filter, answer) }
    })
}

/// A query with any number of answers, into a buffer of the caller.
///
/// # Safety
/// As `ask`, and as `Buffer::new`.
unsafe fn ask_all<T, I>(
    world: *const BsWorld,
    filter: *const BsQueryFilter,
    (at, capacity, count): (*mut T, usize, *mut usize),
    own: impl Fn(&I) -> T,
    work: impl FnOnce(&World, &QueryFilter<'_>, &mut Vec<I>) -> Outcome,
) -> BsStatus {
    call(|| {
        // SAFETY: as this function.
        let (content, out) = unsafe { (reading(world)?, Buffer::new("the answers", at, capacity, count)?) };
        let answer = |filter: &QueryFilter<'_>| {
            let mut found = Vec::new();
            work(&content, filter, &mut found)?;
            out.fill(found.iter().map(own))
        };
        // SAFETY: as this function.
        unsafe { with_filter(filter, answer) }
    })
}

/// The first shape that a ray meets; `hit->hit` says whether there is one. `filter` may be null: all but
/// sensors.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_cast_ray(
    world: *const BsWorld,
    ray: BsRay,
    filter: *const BsQueryFilter,
    hit: *mut BsHit,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        ask(world, filter, hit, |world, filter| {
            let hit = world.cast_ray(&ray.to_engine(), filter)?;
            Ok(hit.as_ref().map_or(BsHit::NONE, BsHit::of_ray))
        })
    }
}

/// Whether a ray meets anything at all.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_cast_ray_any(
    world: *const BsWorld,
    ray: BsRay,
    filter: *const BsQueryFilter,
    any: *mut BsBool,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        ask(world, filter, any, |world, filter| Ok(world.cast_ray_any(&ray.to_engine(), filter)?.into()))
    }
}

/// All shapes that a ray meets, each where it is met first, by fraction. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_cast_ray_all(
    world: *const BsWorld,
    ray: BsRay,
    filter: *const BsQueryFilter,
    hits: *mut BsHit,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        ask_all(world, filter, (hits, capacity, count), BsHit::of_ray, |world, filter, found| {
            Ok(world.cast_ray_all(&ray.to_engine(), filter, found)?)
        })
    }
}

/// The first shapes that many rays meet: the answer to `rays[i]` goes to `hits[i]`. Faster than one by one
/// where neighbours go about the same way.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_cast_rays(
    world: *const BsWorld,
    rays: *const BsRay,
    count: usize,
    filter: *const BsQueryFilter,
    hits: *mut BsHit,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        let mut written = 0;
        let own = |hit: &Option<RayHit>| hit.as_ref().map_or(BsHit::NONE, BsHit::of_ray);
        ask_all(world, filter, (hits, count, &mut written), own, |world, filter, found| {
            let rays: Vec<_> = slice("the rays", rays, count)?.iter().map(|ray| ray.to_engine()).collect();
            found.resize(rays.len(), None);
            Ok(world.cast_rays(&rays, filter, found)?)
        })
    }
}

/// # Safety
/// The pointer is null or that of a geometry.
unsafe fn geometry(geometry: *const BsGeometry) -> Outcome<Geometry> {
    // SAFETY: as this function.
    unsafe { borrow("the geometry", geometry)?.to_engine() }
}

fn cast_of(shape: &Geometry, pose: BsPose, path: BsVec3) -> ShapeCast<'_> {
    ShapeCast::new(shape, pose.position, path.into()).with_rotation(backstop::glam::Quat::from(pose.rotation))
}

/// The first shape that a convex one touches that moves from a pose along a path [m]; `hit->hit` says whether
/// there is one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_cast_shape(
    world: *const BsWorld,
    shape: *const BsGeometry,
    pose: BsPose,
    path: BsVec3,
    filter: *const BsQueryFilter,
    hit: *mut BsHit,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        ask(world, filter, hit, |world, filter| {
            let hit = world.cast_shape(&cast_of(&geometry(shape)?, pose, path), filter)?;
            Ok(hit.as_ref().map_or(BsHit::NONE, BsHit::of_shape))
        })
    }
}

/// Whether a moving shape touches anything at all.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_cast_shape_any(
    world: *const BsWorld,
    shape: *const BsGeometry,
    pose: BsPose,
    path: BsVec3,
    filter: *const BsQueryFilter,
    any: *mut BsBool,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        ask(world, filter, any, |world, filter| {
            Ok(world.cast_shape_any(&cast_of(&geometry(shape)?, pose, path), filter)?.into())
        })
    }
}

/// All shapes that a moving one would touch if none stopped it, by fraction. With a path of zero: all that it
/// overlaps, with depths. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_cast_shape_all(
    world: *const BsWorld,
    shape: *const BsGeometry,
    pose: BsPose,
    path: BsVec3,
    filter: *const BsQueryFilter,
    hits: *mut BsHit,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        ask_all(world, filter, (hits, capacity, count), BsHit::of_shape, |world, filter, found| {
            Ok(world.cast_shape_all(&cast_of(&geometry(shape)?, pose, path), filter, found)?)
        })
    }
}

/// The point of a shape that is nearest to a given one.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsClosestPoint {
    /// Whose shape it is.
    pub body: BsBody,
    /// Which shape.
    pub shape: BsShape,
    /// The nearest point, in the world [m]; inside a solid shape the given one.
    pub point: BsDVec3,
    /// Unit, from the nearest point towards the given one. Zero inside.
    pub normal: BsVec3,
    /// How far it is away [m]; zero inside.
    pub distance: f32,
    /// Index of the triangle of a mesh or height field, or `BS_NO_TRIANGLE`.
    pub triangle: u32,
    /// Whether there is one at all. If not, all else is zero.
    pub found: BsBool,
    /// Whether the given point is inside of it.
    pub inside: BsBool,
    /// Zero.
    pub reserved: [u8; 2],
}

impl Default for BsClosestPoint {
    fn default() -> BsClosestPoint {
        BsClosestPoint::NONE
    }
}

impl BsClosestPoint {
    const NONE: BsClosestPoint = BsClosestPoint {
        body: BsBody::NONE,
        shape: BsShape::NONE,
        point: BsDVec3 { x: 0.0, y: 0.0, z: 0.0 },
        normal: BsVec3 { x: 0.0, y: 0.0, z: 0.0 },
        distance: 0.0,
        triangle: BS_NO_TRIANGLE,
        found: 0,
        inside: 0,
        reserved: [0; 2],
    };

    fn of_engine(found: &ClosestPoint) -> BsClosestPoint {
        BsClosestPoint {
            body: found.body.into(),
            shape: found.shape.into(),
            point: found.point.into(),
            normal: found.normal.into(),
            distance: found.distance,
            triangle: found.triangle.unwrap_or(BS_NO_TRIANGLE),
            found: 1,
            inside: found.inside.into(),
            reserved: [0; 2],
        }
    }
}

/// The shape that is nearest to a point [m], within a distance [m]; `closest->found` says whether there is
/// one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_closest_point(
    world: *const BsWorld,
    point: BsDVec3,
    distance: f32,
    filter: *const BsQueryFilter,
    closest: *mut BsClosestPoint,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        ask(world, filter, closest, |world, filter| {
            let found = world.closest_point(point.into(), distance, filter)?;
            Ok(found.as_ref().map_or(BsClosestPoint::NONE, BsClosestPoint::of_engine))
        })
    }
}

/// Whether any shape is within a distance [m] of a point [m]; inside counts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_closest_point_any(
    world: *const BsWorld,
    point: BsDVec3,
    distance: f32,
    filter: *const BsQueryFilter,
    any: *mut BsBool,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        ask(world, filter, any, |world, filter| {
            Ok(world.closest_point_any(point.into(), distance, filter)?.into())
        })
    }
}

/// The nearest point of every shape within a distance [m], by distance. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_closest_point_all(
    world: *const BsWorld,
    point: BsDVec3,
    distance: f32,
    filter: *const BsQueryFilter,
    points: *mut BsClosestPoint,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        ask_all(
            world,
            filter,
            (points, capacity, count),
            BsClosestPoint::of_engine,
            |world, filter, found| Ok(world.closest_point_all(point.into(), distance, filter, found)?),
        )
    }
}
