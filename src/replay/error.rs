//! Why a run can't be recorded, or a file not be played.

use crate::error::Error;
use crate::load_limits::LimitExceeded;

/// Why a run can't be recorded, or a file not be played.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// A step of the world panicked.
    #[error(
        "a world of which a step panicked has no state that a recording could begin with: restore a snapshot"
    )]
    Poisoned,
    /// The world records already.
    #[error("the world is being recorded already")]
    Recording,
    /// The world does not record.
    #[error("the world is not being recorded")]
    NotRecording,
    /// The file is of another kind.
    #[error("this is no recording of backstop")]
    Foreign,
    /// Written by another version of the format.
    #[error("the recording has format {found}, but this version of backstop plays format {known}")]
    Version {
        /// Version of the file.
        found: u16,
        /// Version that this build reads.
        known: u16,
    },
    /// The file ends before the recording does. The part before was played.
    #[error("the recording is cut off after step {steps}")]
    CutOff {
        /// Steps that are there.
        steps: u64,
    },
    /// The file is damaged.
    #[error("the recording is damaged after step {steps}: {what}")]
    Damaged {
        /// Steps before.
        steps: u64,
        /// The defect.
        what: &'static str,
    },
    /// It asks for more than its [`LoadLimits`](crate::LoadLimits) allow.
    #[error("after step {steps}: {source}")]
    Limit {
        /// Steps before.
        steps: u64,
        /// Which limit.
        source: LimitExceeded,
    },
    /// It starts with something that no world accepts.
    #[error("the recording starts with settings that are refused")]
    Refused(#[from] Error),
    /// Reading or writing failed.
    #[error("a recording can't be read or written")]
    Io(#[from] std::io::Error),
}
