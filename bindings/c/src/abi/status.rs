//! Codes of all functions, and their meanings.

use backstop::Error;
use backstop::replay::ReplayError;
use std::cell::RefCell;
use std::ffi::{CStr, c_char};
use std::fmt;

/// Result of a call: `BS_OK`, or why it was refused. A refused call has changed nothing, unless it says so.
/// Numbers never change their meaning; new ones may come.
pub type BsStatus = i32;

/// The call did what it says.
pub const BS_OK: BsStatus = 0;
/// A pointer is null, or not aligned for what it points to.
pub const BS_ERROR_NULL: BsStatus = 1;
/// The `size` of a description is not one that any version of this header has had, or beyond this library's.
pub const BS_ERROR_SIZE: BsStatus = 2;
/// A buffer is too short. The number of elements that it needs was written, and nothing else.
pub const BS_ERROR_BUFFER: BsStatus = 3;
/// A number stands for none of the constants that it may be.
pub const BS_ERROR_CONSTANT: BsStatus = 4;
/// The object is in use by a call of another thread, or by the one whose callback this is.
pub const BS_ERROR_BUSY: BsStatus = 5;
/// A defect of this library: a call panicked, and what it had to change may be half done. If that was a
/// world, all calls but `bs_world_restore` and `bs_world_destroy` return this until it is restored.
pub const BS_ERROR_PANIC: BsStatus = 6;
/// The body handle is stale: its body was removed.
pub const BS_ERROR_STALE_BODY: BsStatus = 7;
/// The shape handle is stale: its shape or its body was removed.
pub const BS_ERROR_STALE_SHAPE: BsStatus = 8;
/// The joint handle is stale: it broke, or it or one of its bodies was removed.
pub const BS_ERROR_STALE_JOINT: BsStatus = 9;
/// A number is NaN or infinite where it must not be.
pub const BS_ERROR_NOT_FINITE: BsStatus = 10;
/// A number is outside of its range.
pub const BS_ERROR_OUT_OF_RANGE: BsStatus = 11;
/// A list leaves something out.
pub const BS_ERROR_INCOMPLETE: BsStatus = 12;
/// Points that span no volume, an empty mesh and the like.
pub const BS_ERROR_DEGENERATE: BsStatus = 13;
/// A shape that only a static or kinematic body may have.
pub const BS_ERROR_STATIC_ONLY: BsStatus = 14;
/// A shape of a query that is not convex and bounded.
pub const BS_ERROR_NOT_CONVEX: BsStatus = 15;
/// A dynamic body without mass.
pub const BS_ERROR_NO_MASS: BsStatus = 16;
/// A joint of a body with itself.
pub const BS_ERROR_JOINT_TO_ITSELF: BsStatus = 17;
/// A joint without a dynamic body.
pub const BS_ERROR_JOINT_OF_STILL: BsStatus = 18;
/// Too many of something.
pub const BS_ERROR_TOO_MANY: BsStatus = 19;
/// The memory budget is exceeded.
pub const BS_ERROR_BUDGET: BsStatus = 20;
/// Bytes that are no snapshot, or no longer.
pub const BS_ERROR_BROKEN_SNAPSHOT: BsStatus = 21;
/// A snapshot of another version of its format.
pub const BS_ERROR_SNAPSHOT_VERSION: BsStatus = 22;
/// A snapshot refers to what the world does not have.
pub const BS_ERROR_FOREIGN_SNAPSHOT: BsStatus = 23;
/// Refused for a reason that this header has no code for; `bs_last_error` has its words.
pub const BS_ERROR_OTHER: BsStatus = 24;
/// The character handle is stale: its character was removed.
pub const BS_ERROR_STALE_CHARACTER: BsStatus = 25;
/// Not returned: a world that is being recorded can be restored.
pub const BS_ERROR_RECORDED: BsStatus = 26;
/// A target for a motor that the joint does not have.
pub const BS_ERROR_NO_MOTOR: BsStatus = 27;
/// Bytes that are no baked shape, or no longer.
pub const BS_ERROR_BROKEN_SHAPE: BsStatus = 28;
/// A baked shape of another version of its format.
pub const BS_ERROR_SHAPE_VERSION: BsStatus = 29;
/// The coupling handle is stale: it broke, or it or one of its joints was removed.
pub const BS_ERROR_STALE_COUPLING: BsStatus = 30;
/// A motion that cannot be coupled.
pub const BS_ERROR_COUPLED_MOTION: BsStatus = 31;
/// A world that is being recorded already, or is not being recorded.
pub const BS_ERROR_RECORDING: BsStatus = 32;
/// Bytes that are no recording, or no longer, or not all of it.
pub const BS_ERROR_BROKEN_RECORDING: BsStatus = 33;
/// A recording of another version of its format.
pub const BS_ERROR_RECORDING_VERSION: BsStatus = 34;
/// A recording asks for more than its limits allow.
pub const BS_ERROR_LIMIT: BsStatus = 35;

/// Why a call is refused.
#[derive(Debug)]
pub(crate) enum Refusal {
    Engine(Error),
    Replay(ReplayError),
    Null(&'static str),
    Size { what: &'static str, given: u32, own: usize },
    Buffer { what: &'static str, capacity: usize, needed: usize },
    Constant { what: &'static str, value: u32 },
    Busy,
    Panicked,
}

pub(crate) type Outcome<T = ()> = Result<T, Refusal>;

impl From<Error> for Refusal {
    fn from(error: Error) -> Refusal {
        Refusal::Engine(error)
    }
}

impl From<ReplayError> for Refusal {
    fn from(error: ReplayError) -> Refusal {
        Refusal::Replay(error)
    }
}

impl Refusal {
    pub(crate) fn status(&self) -> BsStatus {
        match self {
            Refusal::Engine(error) => of_engine(error),
            Refusal::Replay(error) => of_replay(error),
            Refusal::Null(_) => BS_ERROR_NULL,
            Refusal::Size { .. } => BS_ERROR_SIZE,
            Refusal::Buffer { .. } => BS_ERROR_BUFFER,
            Refusal::Constant { .. } => BS_ERROR_CONSTANT,
            Refusal::Busy => BS_ERROR_BUSY,
            Refusal::Panicked => BS_ERROR_PANIC,
        }
    }
}

fn of_engine(error: &Error) -> BsStatus {
    match error.innermost() {
        Error::StaleBody => BS_ERROR_STALE_BODY,
        Error::StaleShape => BS_ERROR_STALE_SHAPE,
        Error::StaleJoint => BS_ERROR_STALE_JOINT,
        Error::StaleCharacter => BS_ERROR_STALE_CHARACTER,
        Error::NoMotor => BS_ERROR_NO_MOTOR,
        Error::StaleCoupling => BS_ERROR_STALE_COUPLING,
        Error::CoupledMotion { .. } => BS_ERROR_COUPLED_MOTION,
        Error::BrokenShape { .. } => BS_ERROR_BROKEN_SHAPE,
        Error::ShapeVersion { .. } => BS_ERROR_SHAPE_VERSION,
        Error::NotFinite { .. } => BS_ERROR_NOT_FINITE,
        Error::OutOfRange { .. } | Error::Count { .. } | Error::Index { .. } => BS_ERROR_OUT_OF_RANGE,
        Error::Incomplete { .. } => BS_ERROR_INCOMPLETE,
        Error::Degenerate(_) => BS_ERROR_DEGENERATE,
        Error::StaticOnly { .. } => BS_ERROR_STATIC_ONLY,
        Error::NotConvex { .. } => BS_ERROR_NOT_CONVEX,
        Error::NoMass => BS_ERROR_NO_MASS,
        Error::JointToItself => BS_ERROR_JOINT_TO_ITSELF,
        Error::JointOfStill => BS_ERROR_JOINT_OF_STILL,
        Error::TooMany { .. } => BS_ERROR_TOO_MANY,
        Error::Budget { .. } => BS_ERROR_BUDGET,
        Error::BrokenSnapshot { .. } => BS_ERROR_BROKEN_SNAPSHOT,
        Error::SnapshotVersion { .. } => BS_ERROR_SNAPSHOT_VERSION,
        Error::ForeignSnapshot { .. } => BS_ERROR_FOREIGN_SNAPSHOT,
        Error::Poisoned { .. } => BS_ERROR_PANIC,
        // Errors that the engine adds get codes here.
        _ => BS_ERROR_OTHER,
    }
}

fn of_replay(error: &ReplayError) -> BsStatus {
    match error {
        ReplayError::Recording | ReplayError::NotRecording => BS_ERROR_RECORDING,
        ReplayError::Poisoned => BS_ERROR_PANIC,
        ReplayError::Foreign | ReplayError::CutOff { .. } | ReplayError::Damaged { .. } => {
            BS_ERROR_BROKEN_RECORDING
        }
        ReplayError::Version { .. } => BS_ERROR_RECORDING_VERSION,
        ReplayError::Limit { .. } => BS_ERROR_LIMIT,
        ReplayError::Refused(error) => of_engine(error),
        _ => BS_ERROR_OTHER,
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Refusal::Engine(error) => error.fmt(f),
            Refusal::Replay(ReplayError::Refused(source)) => write!(f, "a recording's settings: {source}"),
            Refusal::Replay(ReplayError::Io(source)) => write!(f, "a recording: {source}"),
            Refusal::Replay(error) => error.fmt(f),
            Refusal::Null(what) => write!(f, "{what} is null or misaligned"),
            Refusal::Size { what, given, own } => {
                write!(f, "{what} has the size {given}, which no version had up to this one with {own}")
            }
            Refusal::Buffer { what, capacity, needed } => {
                write!(f, "the buffer for {what} has {capacity} elements and needs {needed}")
            }
            Refusal::Constant { what, value } => write!(f, "{value} is no {what}"),
            Refusal::Busy => f.write_str("the object is in use by another call"),
            Refusal::Panicked => {
                f.write_str("a call on this object panicked: restore a snapshot, or destroy it")
            }
        }
    }
}

thread_local! {
    /// Ends with a zero.
    static MESSAGE: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// Keeps the message of this thread's call; none if it succeeded.
pub(crate) fn keep_message(message: Option<&dyn fmt::Display>) {
    // A thread that ends has no message any more.
    let _ = MESSAGE.try_with(|kept| {
        let Ok(mut kept) = kept.try_borrow_mut() else { return };
        kept.clear();
        if let Some(message) = message {
            kept.extend(message.to_string().into_bytes().into_iter().filter(|&byte| byte != 0));
            kept.push(0);
        }
    });
}

/// The full message of this thread's last call that returned a status; empty if it succeeded. Valid until the
/// next call of this thread that returns a status. UTF-8.
#[unsafe(no_mangle)]
pub extern "C" fn bs_last_error() -> *const c_char {
    let empty = c"".as_ptr();
    let of = |kept: &RefCell<Vec<u8>>| match kept.try_borrow() {
        Ok(kept) if !kept.is_empty() => kept.as_ptr().cast(),
        _ => empty,
    };
    MESSAGE.try_with(of).unwrap_or(empty)
}

/// What a status means, in general; valid for ever. `bs_last_error` has the numbers.
#[unsafe(no_mangle)]
pub extern "C" fn bs_error_text(status: BsStatus) -> *const c_char {
    text_of(status).as_ptr()
}

fn text_of(status: BsStatus) -> &'static CStr {
    match status {
        BS_OK => c"no error",
        BS_ERROR_NULL => c"a pointer is null or misaligned",
        BS_ERROR_SIZE => c"a description has a size that this library does not know",
        BS_ERROR_BUFFER => c"a buffer is too short",
        BS_ERROR_CONSTANT => c"a number stands for no constant",
        BS_ERROR_BUSY => c"the object is in use by another call",
        BS_ERROR_PANIC => c"a call panicked; restore a snapshot, or destroy the object",
        BS_ERROR_STALE_BODY => c"the body was removed",
        BS_ERROR_STALE_SHAPE => c"the shape was removed",
        BS_ERROR_STALE_JOINT => c"the joint broke or was removed",
        BS_ERROR_NOT_FINITE => c"a number is not finite",
        BS_ERROR_OUT_OF_RANGE => c"a number is out of range",
        BS_ERROR_INCOMPLETE => c"a list leaves something out",
        BS_ERROR_DEGENERATE => c"the shape is degenerate",
        BS_ERROR_STATIC_ONLY => c"the shape can only be on a static or kinematic body",
        BS_ERROR_NOT_CONVEX => c"a query's shape must be convex and bounded",
        BS_ERROR_NO_MASS => c"a dynamic body needs mass",
        BS_ERROR_JOINT_TO_ITSELF => c"a joint can't join a body to itself",
        BS_ERROR_JOINT_OF_STILL => c"a joint needs a dynamic body",
        BS_ERROR_TOO_MANY => c"too many of something",
        BS_ERROR_BUDGET => c"the memory budget is exceeded",
        BS_ERROR_BROKEN_SNAPSHOT => c"the snapshot is broken",
        BS_ERROR_SNAPSHOT_VERSION => c"the snapshot is of another version",
        BS_ERROR_FOREIGN_SNAPSHOT => c"the snapshot refers to what the world does not have",
        BS_ERROR_OTHER => c"the call was refused",
        BS_ERROR_STALE_CHARACTER => c"the character was removed",
        BS_ERROR_RECORDED => c"not returned",
        BS_ERROR_NO_MOTOR => c"the joint has no such motor",
        BS_ERROR_BROKEN_SHAPE => c"the baked shape is broken",
        BS_ERROR_SHAPE_VERSION => c"the baked shape is of another version",
        BS_ERROR_STALE_COUPLING => c"the coupling broke or was removed",
        BS_ERROR_COUPLED_MOTION => c"the motion can't be coupled",
        BS_ERROR_RECORDING => c"the world is being recorded already, or is not being recorded",
        BS_ERROR_BROKEN_RECORDING => c"the recording is broken or cut off",
        BS_ERROR_RECORDING_VERSION => c"the recording is of another version",
        BS_ERROR_LIMIT => c"the recording asks for more than its limits allow",
        _ => c"no status of this library",
    }
}
