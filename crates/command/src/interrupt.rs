//! Ctrl-C, and the signal that ends a process: the loops of commands end early, and what was done until then
//! is written as if it had been all.

use indicatif::ProgressBar;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, Once, PoisonError};

/// Exit code of a command that was stopped: that of a shell for a process which SIGINT has ended.
const CODE: u8 = 130;

/// Whether a loop looks at [`asked`] now. Otherwise the process ends at once.
static WATCHED: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);
/// The progress bar that is shown: it goes before the process does.
static BAR: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// While it lives a loop looks at [`asked`].
pub(crate) struct Watch(());

/// Before a loop that looks at [`asked`].
pub(crate) fn watch() -> anyhow::Result<Watch> {
    static LISTENS: Once = Once::new();
    let mut listens = Ok(());
    LISTENS.call_once(|| listens = ctrlc::set_handler(stop));
    listens?;
    WATCHED.store(true, Ordering::SeqCst);
    Ok(Watch(()))
}

impl Drop for Watch {
    fn drop(&mut self) {
        WATCHED.store(false, Ordering::SeqCst);
    }
}

/// Whether the user asked to end early.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}

/// The exit code of a command that has written its partial results.
pub(crate) fn code() -> ExitCode {
    if asked() { ExitCode::from(CODE) } else { ExitCode::SUCCESS }
}

/// Notes which bar is shown.
pub(crate) fn shows(bar: &ProgressBar) {
    *BAR.lock().unwrap_or_else(PoisonError::into_inner) = Some(bar.clone());
}

/// On the handler's own thread, where anything may be called.
fn stop() {
    let again = ASKED.swap(true, Ordering::SeqCst);
    let bar = BAR.lock().unwrap_or_else(PoisonError::into_inner);
    if again || !WATCHED.load(Ordering::SeqCst) {
        bar.iter().for_each(ProgressBar::finish_and_clear);
        std::process::exit(CODE.into());
    }
    let tell = || eprintln!("note: stops after what is under way; once more stops at once");
    match &*bar {
        Some(bar) => bar.suspend(tell),
        None => tell(),
    }
}
