//! Where tests find data and put files.

use std::path::PathBuf;

/// A folder of the data beside the project; says so if there is none.
pub(super) fn data(folder: &str) -> Option<PathBuf> {
    match std::env::var_os("BACKSTOP_DATA") {
        Some(root) => Some(PathBuf::from(root).join(folder)),
        None => {
            println!("skipped: BACKSTOP_DATA is not set");
            None
        }
    }
}

/// A folder for one test's files.
pub(super) fn scratch(test: &str) -> PathBuf {
    let dir = std::env::temp_dir().join(format!("backstop_{}_{test}", std::process::id()));
    std::fs::create_dir_all(&dir).expect("a temporary folder");
    dir
}
