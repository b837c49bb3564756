//! `replay`: a recorded run, played again and compared.

use crate::args::ReplayOptions;
use crate::report::output;
use crate::report::output::{bytes, count, count_threads, micros};
use crate::report::table::list;
use anyhow::{Context, bail};
use backstop::replay::{DivergedBody, Divergence, Played, Replay};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::time::{Duration, Instant};

/// What `replay --json` prints; docs/json.md says what its fields mean.
#[derive(Debug, Serialize)]
struct Document {
    file: String,
    bytes: u64,
    engine: String,
    threads: usize,
    steps: u64,
    calls: BTreeMap<&'static str, u64>,
    /// Duration of the whole replay, comparing included [s].
    seconds: f64,
    hash: String,
    divergence: Option<Diverged>,
}

#[derive(Debug, Serialize)]
struct Diverged {
    step: u64,
    stage: &'static str,
    body: Option<DivergedBody>,
    bodies: usize,
    refused: Option<Refused>,
    recorded: String,
    replayed: String,
}

#[derive(Debug, Serialize)]
struct Refused {
    call: &'static str,
    error: String,
}

pub(crate) fn replay(options: &ReplayOptions) -> anyhow::Result<()> {
    let name = options.file.display();
    let threads = options.threads;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().context("can't start threads")?;
    // Errors from here on name the file.
    let about = || format!("can't replay {name}");
    let file = File::open(&options.file).with_context(about)?;
    let size = file.metadata().with_context(about)?.len();
    let limits = options.common.limits();
    let bar = output::progress(!options.common.quiet && !options.common.json, size, "bytes");
    let file = BufReader::new(bar.wrap_read(file));
    let mut replay = Replay::open_limited(file, &limits, move |settings| settings.threads = threads)
        .with_context(about)?;
    if !options.common.quiet && replay.engine() != env!("CARGO_PKG_VERSION") {
        eprintln!("note: recorded by backstop {}; another version may go another way", replay.engine());
    }
    let (played, time) = pool.install(|| play(&mut replay)).with_context(about)?;
    bar.finish_and_clear();
    let document = Document {
        file: name.to_string(),
        bytes: size,
        engine: replay.engine().into(),
        threads,
        steps: played.steps,
        calls: played.calls,
        seconds: time.as_secs_f64(),
        hash: format!("{:016x}", replay.world().state_hash()),
        divergence: played.divergence.as_ref().map(diverged),
    };
    if options.common.json {
        output::print_json(&document)?;
    } else if !options.common.quiet {
        output::print(&text(&document))?;
    }
    match played.divergence {
        None => Ok(()),
        Some(divergence) => bail!("{name}: {divergence}"),
    }
}

fn play<R: std::io::Read>(replay: &mut Replay<R>) -> anyhow::Result<(Played, Duration)> {
    let start = Instant::now();
    let played = replay.run()?;
    Ok((played, start.elapsed()))
}

fn diverged(divergence: &Divergence) -> Diverged {
    let [recorded, replayed] = divergence.hashes.map(|hash| format!("{hash:016x}"));
    Diverged {
        step: divergence.step,
        stage: divergence.stage.name(),
        body: divergence.body.clone(),
        bodies: divergence.bodies,
        refused: divergence.refused.as_ref().map(|(call, error)| Refused { call, error: error.to_string() }),
        recorded,
        replayed,
    }
}

fn text(document: &Document) -> String {
    let Document { file, threads, steps, seconds, .. } = document;
    let rows = [
        ("recording", format!("{file}, {}, by backstop {}", bytes(document.bytes as usize), document.engine)),
        ("calls", count(document.calls.values().sum())),
        (
            "steps",
            format!(
                "{} in {seconds:.2} s, {} each, {}",
                count(*steps),
                micros(if *steps > 0 { seconds * 1e6 / *steps as f64 } else { 0.0 }),
                count_threads(*threads)
            ),
        ),
        ("hash", document.hash.clone()),
        (
            "replay",
            match &document.divergence {
                None => "ok: every step is the same to the bit".into(),
                Some(d) => format!("goes another way in step {}, stage {}", d.step, d.stage),
            },
        ),
    ];
    list(rows)
}
