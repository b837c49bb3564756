//! The world: its creation, its steps, and access to it.

use crate::abi::guard::{call, value_or};
use crate::abi::lock::{Changing, Reading, Shared};
use crate::abi::pointers::{Buffer, Out, borrow};
use crate::abi::sized::{read_or_default, write};
use crate::abi::status::{BsStatus, Outcome};
use crate::abi::values::{BsBody, BsDVec3};
use crate::events::Events;
use crate::report::{BsFeatureCost, BsMemoryReport, BsStepReport, features};
use crate::settings::BsSettings;
use backstop::replay::RecordingBuffer;
use backstop::{Error, World};
use std::ops::{Deref, DerefMut};

/// Bodies that move, collide and come to rest. Calls that take it as `const` may come from any number of
/// threads at once. One that changes it waits up to a second for those under way, and is refused with
/// `BS_ERROR_BUSY` beside another that changes it, and within a callback. Calls that begin beside a change,
/// or while one waits, are refused with `BS_ERROR_BUSY`: try again.
pub struct BsWorld {
    content: Shared<Content>,
}

/// The world, and what callers read of it as arrays.
pub(crate) struct Content {
    pub(crate) world: World,
    pub(crate) events: Events,
    /// The bytes of the last recording.
    pub(crate) recording: RecordingBuffer,
}

impl Deref for Content {
    type Target = World;

    fn deref(&self) -> &World {
        &self.world
    }
}

impl DerefMut for Content {
    fn deref_mut(&mut self) -> &mut World {
        &mut self.world
    }
}

/// A world that is read.
///
/// # Safety
/// The pointer is null or that of a world that nobody destroys meanwhile.
pub(crate) unsafe fn reading<'a>(world: *const BsWorld) -> Outcome<Reading<'a, Content>> {
    // SAFETY: as this function.
    unsafe { borrow("the world", world) }?.content.read()
}

/// A world that is changed.
///
/// # Safety
/// As `reading`.
pub(crate) unsafe fn changing<'a>(world: *const BsWorld) -> Outcome<Changing<'a, Content>> {
    // SAFETY: as this function.
    unsafe { borrow("the world", world) }?.content.change()
}

/// A call that reads one value of a world.
///
/// # Safety
/// As `reading`, and the place is null or one for a value.
pub(crate) unsafe fn get<T>(
    world: *const BsWorld,
    what: &'static str,
    place: *mut T,
    read: impl FnOnce(&Content) -> Outcome<T>,
) -> BsStatus {
    call(|| {
        // SAFETY: as this function.
        let (content, out) = unsafe { (reading(world)?, Out::new(what, place)?) };
        out.set(read(&content)?);
        Ok(())
    })
}

/// A call that reads two values of a world; either place may be null.
///
/// # Safety
/// As `get`.
pub(crate) unsafe fn get_two<A, B>(
    world: *const BsWorld,
    places: (*mut A, *mut B),
    read: impl FnOnce(&Content) -> Outcome<(A, B)>,
) -> BsStatus {
    call(|| {
        // SAFETY: as this function.
        let (content, first, second) = unsafe {
            let first = Out::optional("the first place", places.0)?;
            (reading(world)?, first, Out::optional("the second place", places.1)?)
        };
        let found = read(&content)?;
        if let Some(out) = first {
            out.set(found.0);
        }
        if let Some(out) = second {
            out.set(found.1);
        }
        Ok(())
    })
}

/// A call that reads a list of a world into a buffer of the caller.
///
/// # Safety
/// As `Buffer::new`.
pub(crate) unsafe fn get_all<T, I>(
    world: *const BsWorld,
    what: &'static str,
    (at, capacity, count): (*mut T, usize, *mut usize),
    read: impl FnOnce(&Content) -> Outcome<Vec<I>>,
) -> BsStatus
where
    I: Into<T>,
{
    call(|| {
        // SAFETY: as this function.
        let (content, out) = unsafe { (reading(world)?, Buffer::new(what, at, capacity, count)?) };
        out.fill(read(&content)?.into_iter().map(Into::into))
    })
}

/// A call that changes a world.
///
/// # Safety
/// As `reading`.
pub(crate) unsafe fn change(
    world: *mut BsWorld,
    work: impl FnOnce(&mut World) -> Result<(), Error>,
) -> BsStatus {
    // SAFETY: as this function.
    call(|| Ok(work(unsafe { changing(world) }?.deref_mut())?))
}

/// Changes a world as a whole, which a panic may have left half changed. If that succeeds it is whole again.
///
/// # Safety
/// As `reading`.
pub(crate) unsafe fn mending(
    world: *const BsWorld,
    mend: impl FnOnce(&mut Content, bool) -> Outcome,
) -> Outcome {
    // SAFETY: as this function.
    unsafe { borrow("the world", world) }?.content.mend(mend)
}

/// An empty world. `settings` may be null: the defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_create(settings: *const BsSettings, world: *mut *mut BsWorld) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (out, settings) =
            unsafe { (Out::new("the place for the world", world)?, read_or_default(settings)?) };
        let world = World::new(settings.to_engine()?)?;
        let content =
            Shared::new(Content { world, events: Events::default(), recording: RecordingBuffer::default() });
        out.set(Box::into_raw(Box::new(BsWorld { content })));
        Ok(())
    })
}

/// Destroys a world; its handles mean nothing any more. Null is no world, and fine. No other call may use it
/// meanwhile or after.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_destroy(world: *mut BsWorld) {
    value_or((), || {
        if !world.is_null() {
            // SAFETY: it came from `bs_world_create`, and nobody else has it.
            drop(unsafe { Box::from_raw(world) });
        }
    });
}

/// Moves the world on by `dt` seconds, 1e-6 to 10. Events and reports are then those of this step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_step(world: *mut BsWorld, dt: f32) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let mut content = unsafe { changing(world) }?;
        content.step(dt)?;
        content.read_events();
        Ok(())
    })
}

/// The settings. `settings->size` says how much of them is wanted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_settings(world: *const BsWorld, settings: *mut BsSettings) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| unsafe { write(settings, BsSettings::of_engine(reading(world)?.settings())) })
}

/// Replaces the settings; the next step uses them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_set_settings(world: *mut BsWorld, settings: *const BsSettings) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, settings) = unsafe { (changing(world)?, read_or_default(settings)?) };
        Ok(content.set_settings(settings.to_engine()?)?)
    })
}

/// The point that single-precision positions are relative to [m].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_origin(world: *const BsWorld, origin: *mut BsDVec3) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Out::new("the place for the origin", origin)?) };
        out.set(content.origin().into());
        Ok(())
    })
}

/// Moves the point that single-precision positions are relative to [m]. Bodies stay where they are.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_set_origin(world: *mut BsWorld, origin: BsDVec3) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.set_origin(origin.into())?))
}

/// Hash of all poses and velocities, bit by bit: the same on every machine for the same calls.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_state_hash(world: *const BsWorld, hash: *mut u64) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Out::new("the place for the hash", hash)?) };
        out.set(content.state_hash());
        Ok(())
    })
}

/// Kinetic energy of all dynamic bodies plus their potential energy in the world's gravity [J].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_energy(world: *const BsWorld, energy: *mut f64) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Out::new("the place for the energy", energy)?) };
        out.set(content.energy());
        Ok(())
    })
}

/// Counts and times of the last step. `report->size` says how much of it is wanted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_report(world: *const BsWorld, report: *mut BsStepReport) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| unsafe { write(report, BsStepReport::of_engine(reading(world)?.report())) })
}

/// Bytes that the world holds, by category. `report->size` says how much of it is wanted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_memory(world: *const BsWorld, report: *mut BsMemoryReport) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| unsafe { write(report, BsMemoryReport::of_engine(&reading(world)?.memory())) })
}

/// The optional parts of the engine that the world's content needs, and their cost, by their numbers.
/// `count` becomes the number of parts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_feature_report(
    world: *const BsWorld,
    parts: *mut BsFeatureCost,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Buffer::new("parts", parts, capacity, count)?) };
        let model = content.feature_report();
        let parts = features().into_iter().enumerate();
        out.fill(parts.map(|(number, feature)| BsFeatureCost::of_engine(number, &model.part(feature))))
    })
}

/// Bodies that the last step had to stop, because their motion was no number or out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_faulted_bodies(
    world: *const BsWorld,
    bodies: *mut BsBody,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Buffer::new("bodies", bodies, capacity, count)?) };
        out.fill(content.faulted_bodies().iter().map(|&body| body.into()))
    })
}

/// Numbers of bodies and joints, and of bodies and islands that are asleep; each pointer may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_counts(
    world: *const BsWorld,
    bodies: *mut usize,
    joints: *mut usize,
    sleeping_bodies: *mut usize,
    sleeping_islands: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe {
            let out =
                [bodies, joints, sleeping_bodies, sleeping_islands].map(|at| Out::optional("a count", at));
            (reading(world)?, out)
        };
        let counts = [
            content.body_count(),
            content.joint_count(),
            content.sleeping_body_count(),
            content.sleeping_island_count(),
        ];
        for (out, count) in out.into_iter().zip(counts) {
            if let Some(out) = out? {
                out.set(count);
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::abi::status::{BS_ERROR_BUSY, BS_ERROR_PANIC, BS_OK};
    use crate::snapshot::*;
    use std::ptr::{null, null_mut};

    fn create() -> *mut BsWorld {
        let mut world = null_mut();
        // SAFETY: the place is one.
        assert_eq!(unsafe { bs_world_create(null(), &mut world) }, BS_OK);
        world
    }

    /// What a defect of the engine would do: panics while the world is changed.
    unsafe extern "C" fn defect(world: *mut BsWorld) -> BsStatus {
        call(|| {
            // SAFETY: the test has a world.
            let content = unsafe { changing(world) }?;
            panic!("with {} bodies", content.body_count())
        })
    }

    #[test]
    fn a_panic_breaks_the_world_until_it_is_restored() {
        let (world, mut snapshot, mut hash) = (create(), null_mut(), 0);
        // SAFETY: all objects are alive, and all places are.
        unsafe {
            assert_eq!(bs_snapshot_create(&mut snapshot), BS_OK);
            assert_eq!(bs_world_step(world, 0.01), BS_OK);
            assert_eq!(bs_world_snapshot(world, snapshot), BS_OK);
            assert_eq!(defect(world), BS_ERROR_PANIC);
            assert_eq!(bs_world_step(world, 0.01), BS_ERROR_PANIC);
            assert_eq!(bs_world_state_hash(world, &mut hash), BS_ERROR_PANIC);
            assert_eq!(bs_world_restore(world, snapshot), BS_OK);
            assert_eq!(bs_world_state_hash(world, &mut hash), BS_OK);
            assert_eq!(bs_world_step(world, 0.01), BS_OK);
            bs_snapshot_destroy(snapshot);
            bs_world_destroy(world);
        }
    }

    /// Readers that never pause kept the one that steps out: 0 of 600. Expected: all of 600, as each waits
    /// for the reads under way; a read beside a step is busy or right.
    #[test]
    fn readers_that_never_pause_keep_no_step_out() {
        use std::sync::atomic::{AtomicBool, Ordering};
        let (world, done) = (create() as usize, AtomicBool::new(false));
        std::thread::scope(|scope| {
            let read = || {
                let mut hash = 0;
                while !done.load(Ordering::Relaxed) {
                    // SAFETY: the world outlives the scope, and the place is one.
                    let status = unsafe { bs_world_state_hash(world as *const BsWorld, &mut hash) };
                    assert!([BS_OK, BS_ERROR_BUSY].contains(&status), "{status}");
                }
            };
            (0..3).for_each(|_| drop(scope.spawn(read)));
            // SAFETY: as above.
            let step = |_| unsafe { bs_world_step(world as *mut BsWorld, 1.0 / 60.0) };
            let steps = (0..600).map(step).filter(|&status| status == BS_OK).count();
            done.store(true, Ordering::Relaxed);
            assert_eq!(steps, 600);
        });
        // SAFETY: nobody else has it any more.
        unsafe { bs_world_destroy(world as *mut BsWorld) };
    }

    #[test]
    fn a_world_in_use_is_busy_for_those_who_change_it() {
        let (world, mut hash) = (create(), 0);
        // SAFETY: the world is alive, and all places are.
        unsafe {
            let reader = reading(world);
            assert_eq!(bs_world_state_hash(world, &mut hash), BS_OK);
            assert_eq!(bs_world_step(world, 0.01), BS_ERROR_BUSY);
            drop(reader);
            let writer = changing(world);
            assert_eq!(bs_world_state_hash(world, &mut hash), BS_ERROR_BUSY);
            drop(writer);
            assert_eq!(bs_world_step(world, 0.01), BS_OK);
            bs_world_destroy(world);
        }
    }
}
