//! The testbed: a page in the browser, and the server that runs what it shows.

mod server;

use crate::args::ServeOptions;
use crate::interrupt;
use crate::report::output;
use crate::threads::with_threads;
use backstop_testbed::Session;
use server::{Call, Listening};
use std::sync::mpsc::RecvTimeoutError;
use std::time::Duration;

/// How often it is looked whether the user ends it.
const PATIENCE: Duration = Duration::from_millis(50);

/// Serves a session until the user ends it. `scene`: the name of what the page opens first.
///
/// `threads`: of a step, unless the user says another number; the pool has one for each core.
pub(crate) fn serve(
    options: &ServeOptions,
    threads: usize,
    scene: Option<&str>,
    session: impl FnOnce() -> Session + Send,
) -> anyhow::Result<()> {
    let Listening { address, calls } = server::listen(options.port)?;
    let address = scene.map_or_else(|| address.clone(), |scene| format!("{address}#scene={scene}"));
    let _watch = interrupt::watch()?;
    output::print(&format!("{address}\n"))?;
    if options.open
        && let Err(error) = open::that_detached(&address)
    {
        eprintln!("note: no browser can be opened ({error}); the address is above");
    }
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    with_threads(threads.max(cores), move || {
        let mut session = session();
        loop {
            match calls.recv_timeout(PATIENCE) {
                Ok(Call { json, answer }) => {
                    let mut frame = Vec::new();
                    session.request(&json, &mut frame);
                    // Nobody waits any more if the page was closed.
                    let _ = answer.send(frame);
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
            }
            if interrupt::asked() {
                return Ok(());
            }
        }
    })
}
