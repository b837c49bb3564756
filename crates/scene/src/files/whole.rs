//! Files that are read whole, within a limit.

use super::error::SceneError;
use backstop::Count;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Reads a whole file, unless it exceeds its limit.
pub(super) fn read_file(path: &Path, bytes: &mut Count) -> Result<Vec<u8>, SceneError> {
    let failed = |source| SceneError::Read { file: path.into(), source };
    let file = File::open(path).map_err(failed)?;
    let mut content = Vec::new();
    // One byte more than allowed, to notice an excess.
    let most = bytes.left().saturating_add(1);
    file.take(most).read_to_end(&mut content).map_err(failed)?;
    bytes.take(content.len()).map_err(|source| SceneError::Limit { file: path.into(), source })?;
    Ok(content)
}
