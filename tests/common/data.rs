//! Scenes, meshes and measurements that are too large for the repository, and lie beside it
//! (`BACKSTOP_DATA`).
#![allow(dead_code, reason = "each test uses a part of it")]

use std::io::Write;
use std::path::PathBuf;

/// A folder of the data beside the project; where there is none, the test that asks says that it is skipped.
pub(crate) fn data(folder: &str) -> Option<PathBuf> {
    let Some(root) = std::env::var_os("BACKSTOP_DATA") else {
        skipped("BACKSTOP_DATA is not set");
        return None;
    };
    let path = PathBuf::from(root).join(folder);
    if !path.is_dir() {
        skipped(&format!("there is no folder {}", path.display()));
        return None;
    }
    Some(path)
}

/// Says that a test, or a part of it, is skipped. Written past what the harness captures, or nobody would see
/// it.
pub(crate) fn skipped(why: &str) {
    let test = std::thread::current();
    let _ = writeln!(std::io::stderr(), "SKIPPED: {}: {why}", test.name().unwrap_or("a test"));
}
