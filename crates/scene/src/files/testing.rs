//! Where tests find data and put files.

use std::io::Write;
use std::path::PathBuf;

/// A folder of the test data, which lies outside of the repository (`BACKSTOP_DATA`). None, with a line on
/// standard error, if that is not set.
pub(super) fn data(folder: &str) -> Option<PathBuf> {
    let Some(root) = std::env::var_os("BACKSTOP_DATA") else {
        skipped("BACKSTOP_DATA is not set");
        return None;
    };
    Some(PathBuf::from(root).join(folder))
}

/// Says that the running test is skipped. Written to standard error itself: the test harness hides what
/// passing tests print by `println!` and `eprintln!`.
fn skipped(why: &str) {
    let thread = std::thread::current();
    let _ = writeln!(std::io::stderr(), "SKIPPED: {}: {why}", thread.name().unwrap_or("a test"));
}

/// A folder for one test's files.
pub(super) fn scratch(test: &str) -> PathBuf {
    let dir = std::env::temp_dir().join(format!("backstop_{}_{test}", std::process::id()));
    std::fs::create_dir_all(&dir).expect("a temporary folder");
    dir
}
