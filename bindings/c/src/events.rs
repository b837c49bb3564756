//! Events of the last step, as arrays.

use crate::abi::guard::call;
use crate::abi::pointers::{Buffer, Out};
use crate::abi::status::{BsStatus, Outcome};
use crate::abi::values::{BsBody, BsDVec3, BsJoint, BsShape, BsVec3};
use crate::world::{BsWorld, Content, reading};
use backstop::{ContactEvent, SensorEvent};

/// Two shapes that began to touch, or hit each other.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsContactEvent {
    /// The shapes, the one with the lower handle first.
    pub shapes: [BsShape; 2],
    /// Their bodies.
    pub bodies: [BsBody; 2],
    /// Midway between the surfaces, at the point with the greatest impulse, at the start of the step [m].
    pub point: BsDVec3,
    /// Unit, from the first shape to the second.
    pub normal: BsVec3,
    /// Approach speed there before anything was solved [m/s]; negative if they separate.
    pub approach_speed: f32,
    /// Normal impulse of the whole step, over all points [N s].
    pub impulse: f32,
    /// Zero.
    pub reserved: u32,
}

/// Two shapes that no longer touch, or of which one was removed.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsContactEnd {
    /// The shapes, the one with the lower handle first.
    pub shapes: [BsShape; 2],
}

/// A shape that entered or left a sensor.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsSensorEvent {
    /// The sensor.
    pub sensor: BsShape,
    /// The shape that crossed its surface.
    pub visitor: BsShape,
    /// When, as a fraction of the step.
    pub fraction: f32,
}

/// The engine's events in the layout of this interface.
#[derive(Default)]
pub(crate) struct Events {
    begins: Vec<BsContactEvent>,
    ends: Vec<BsContactEnd>,
    hits: Vec<BsContactEvent>,
    sensor_begins: Vec<BsSensorEvent>,
    sensor_ends: Vec<BsSensorEvent>,
    broken: Vec<BsJoint>,
}

fn of_contact(event: &ContactEvent) -> BsContactEvent {
    BsContactEvent {
        shapes: event.shapes.map(Into::into),
        bodies: event.bodies.map(Into::into),
        point: event.point.into(),
        normal: event.normal.into(),
        approach_speed: event.approach_speed,
        impulse: event.impulse,
        reserved: 0,
    }
}

fn of_sensor(event: &SensorEvent) -> BsSensorEvent {
    BsSensorEvent { sensor: event.sensor.into(), visitor: event.visitor.into(), fraction: event.fraction }
}

fn renew<T, U>(own: &mut Vec<T>, engine: &[U], convert: impl FnMut(&U) -> T) {
    own.clear();
    own.extend(engine.iter().map(convert));
}

impl Content {
    /// Takes over the events of a step. Its buffers grow to the most events of a step, and then no more.
    pub(crate) fn read_events(&mut self) {
        let Content { world, events, .. } = self;
        renew(&mut events.begins, world.contact_begins(), of_contact);
        let of_end = |end: &backstop::ContactEnd| BsContactEnd { shapes: end.shapes.map(Into::into) };
        renew(&mut events.ends, world.contact_ends(), of_end);
        renew(&mut events.hits, world.contact_hits(), of_contact);
        renew(&mut events.sensor_begins, world.sensor_begins(), of_sensor);
        renew(&mut events.sensor_ends, world.sensor_ends(), of_sensor);
        renew(&mut events.broken, world.broken_joints(), |&joint| joint.into());
    }
}

/// # Safety
/// The pointers are null or what their types say.
unsafe fn list<T>(
    world: *const BsWorld,
    events: *mut *const T,
    count: *mut usize,
    of: impl FnOnce(&Events) -> &Vec<T>,
) -> Outcome {
    // SAFETY: as this function.
    let (content, events, count) = unsafe {
        let events = Out::new("the place for events", events)?;
        (reading(world)?, events, Out::new("the count", count)?)
    };
    let list = of(&content.events);
    // It outlives the lock: what changes it, a step, is what the header says ends it.
    events.set(list.as_ptr());
    count.set(list.len());
    Ok(())
}

/// Pairs that began to touch in the last step, of which one shape asks for events. The array is valid until
/// the world is next stepped, restored or destroyed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_contact_begins(
    world: *const BsWorld,
    events: *mut *const BsContactEvent,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| unsafe { list(world, events, count, |events| &events.begins) })
}

/// Pairs that no longer touch since the last step. The array is valid until the world is next stepped,
/// restored or destroyed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_contact_ends(
    world: *const BsWorld,
    events: *mut *const BsContactEnd,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| unsafe { list(world, events, count, |events| &events.ends) })
}

/// Pairs that hit each other in the last step, at `BsSettings::hit_speed` or faster. The array is valid until
/// the world is next stepped, restored or destroyed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_contact_hits(
    world: *const BsWorld,
    events: *mut *const BsContactEvent,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| unsafe { list(world, events, count, |events| &events.hits) })
}

/// Shapes that entered sensors in the last step. The array is valid until the world is next stepped, restored
/// or destroyed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_sensor_begins(
    world: *const BsWorld,
    events: *mut *const BsSensorEvent,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| unsafe { list(world, events, count, |events| &events.sensor_begins) })
}

/// Shapes that left sensors in the last step. The array is valid until the world is next stepped, restored or
/// destroyed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_sensor_ends(
    world: *const BsWorld,
    events: *mut *const BsSensorEvent,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| unsafe { list(world, events, count, |events| &events.sensor_ends) })
}

/// Joints that broke in the last step; their handles are stale. The array is valid until the world is next
/// stepped, restored or destroyed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_broken_joints(
    world: *const BsWorld,
    joints: *mut *const BsJoint,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| unsafe { list(world, joints, count, |events| &events.broken) })
}

/// The shapes that are in a sensor as of the last step, in the order of their handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_sensor_overlaps(
    world: *const BsWorld,
    sensor: BsShape,
    visitors: *mut BsShape,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) =
            unsafe { (reading(world)?, Buffer::new("visitors", visitors, capacity, count)?) };
        let mut found = Vec::new();
        content.sensor_overlaps(sensor.into(), &mut found)?;
        out.fill(found.into_iter().map(Into::into))
    })
}
