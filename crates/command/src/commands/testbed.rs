//! `testbed`: samples and builtin scenes on a page of the browser.

use crate::args::TestbedOptions;
use crate::testbed::serve;
use anyhow::bail;
use backstop_testbed::{Session, knows};

pub(crate) fn testbed(options: &TestbedOptions) -> anyhow::Result<()> {
    if let Some(name) = &options.scene
        && !knows(name)
    {
        bail!("there is no sample or builtin scene {name}; `run FILE --view` shows a file");
    }
    let threads = options.threads;
    serve(&options.serve, threads, options.scene.as_deref(), || Session::new().with_threads(threads))
}
