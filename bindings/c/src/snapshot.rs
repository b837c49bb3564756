//! Snapshots: the state of a world, from which it goes on to the same bits.

mod recording;

pub use recording::*;

use crate::abi::guard::{call, value_or};
use crate::abi::lock::{Changing, Reading, Shared};
use crate::abi::pointers::{Buffer, Out, borrow, slice};
use crate::abi::status::{BsStatus, Outcome};
use crate::world::{BsWorld, mending, reading};
use backstop::{Snapshot, World};

/// The state of a world. It may be used by several threads as long as none of them writes it.
pub struct BsSnapshot {
    snapshot: Shared<Snapshot>,
}

fn give(out: Out<*mut BsSnapshot>, snapshot: Snapshot) {
    out.set(Box::into_raw(Box::new(BsSnapshot { snapshot: Shared::new(snapshot) })));
}

/// # Safety
/// The pointer is null or that of a snapshot that nobody destroys meanwhile.
unsafe fn read<'a>(snapshot: *const BsSnapshot) -> Outcome<Reading<'a, Snapshot>> {
    // SAFETY: as this function.
    unsafe { borrow("the snapshot", snapshot) }?.snapshot.read()
}

/// # Safety
/// As `read`.
unsafe fn writing<'a>(snapshot: *const BsSnapshot) -> Outcome<Changing<'a, Snapshot>> {
    // SAFETY: as this function.
    unsafe { borrow("the snapshot", snapshot) }?.snapshot.change()
}

/// An empty snapshot, to be filled by `bs_world_snapshot`, again and again without new memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_snapshot_create(snapshot: *mut *mut BsSnapshot) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        give(unsafe { Out::new("the place for the snapshot", snapshot) }?, Snapshot::new());
        Ok(())
    })
}

/// Destroys a snapshot. Null is none, and fine.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_snapshot_destroy(snapshot: *mut BsSnapshot) {
    value_or((), || {
        if !snapshot.is_null() {
            // SAFETY: it came from here, and nobody else has it.
            drop(unsafe { Box::from_raw(snapshot) });
        }
    });
}

/// Writes the state of the world into a snapshot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_snapshot(world: *const BsWorld, snapshot: *mut BsSnapshot) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, mut into) = unsafe { (reading(world)?, writing(snapshot)?) };
        content.snapshot(&mut into);
        Ok(())
    })
}

/// Takes the world back to the time of a snapshot: its next steps give the same bits as then, with any number
/// of threads. What was added since is removed, what was removed is back with the same handles. Threads,
/// budget and reports stay as they are. A world that a panic broke is whole again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_restore(world: *mut BsWorld, snapshot: *const BsSnapshot) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let snapshot = unsafe { read(snapshot) }?;
        let restore = |content: &mut crate::world::Content, broken: bool| {
            let rebuilt = || -> Result<World, backstop::Error> {
                let mut fresh = World::new(content.world.settings().clone())?;
                fresh.restore(&snapshot)?;
                Ok(fresh)
            };
            // A broken world is not relied on, unless the snapshot needs what only it has.
            match broken.then(rebuilt) {
                Some(Ok(fresh)) => content.world = fresh,
                _ => content.world.restore(&snapshot)?,
            }
            content.read_events();
            Ok(())
        };
        // SAFETY: the caller keeps to the header.
        unsafe { mending(world, restore) }
    })
}

/// Bytes of the state, and of the parts that snapshots of the same content share; each pointer may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_snapshot_size(
    snapshot: *const BsSnapshot,
    own: *mut usize,
    shared: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (snapshot, own, shared) = unsafe {
            let own = Out::optional("the place for the size", own)?;
            (read(snapshot)?, own, Out::optional("the place for the shared size", shared)?)
        };
        if let Some(own) = own {
            own.set(snapshot.size());
        }
        if let Some(shared) = shared {
            shared.set(snapshot.shared_size());
        }
        Ok(())
    })
}

/// The state as bytes, for a world that has the same bodies, shapes and joints by the same calls. `count`
/// becomes the number of bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_snapshot_to_bytes(
    snapshot: *const BsSnapshot,
    bytes: *mut u8,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    let buffer = || unsafe { Buffer::new("bytes", bytes, capacity, count) };
    // SAFETY: the caller keeps to the header.
    call(|| buffer()?.fill(unsafe { read(snapshot) }?.to_bytes().into_iter()))
}

/// The state and what snapshots share as bytes, for any world that has the same hulls, meshes and height
/// fields on some of its shapes. All other content of that world goes when it is restored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_snapshot_to_whole_bytes(
    snapshot: *const BsSnapshot,
    bytes: *mut u8,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    let buffer = || unsafe { Buffer::new("bytes", bytes, capacity, count) };
    // SAFETY: the caller keeps to the header.
    call(|| buffer()?.fill(unsafe { read(snapshot) }?.to_whole_bytes().into_iter()))
}

/// A snapshot from bytes of `bs_snapshot_to_bytes` or `bs_snapshot_to_whole_bytes`. Whether it fits a world
/// is checked when it is restored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_snapshot_from_bytes(
    bytes: *const u8,
    count: usize,
    snapshot: *mut *mut BsSnapshot,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (out, bytes) =
            unsafe { (Out::new("the place for the snapshot", snapshot)?, slice("the bytes", bytes, count)?) };
        give(out, Snapshot::from_bytes(bytes)?);
        Ok(())
    })
}
