//! `solve`: a problem of contact resolution out of a file, by one of the lab's methods.

use crate::args::SolveOptions;
use crate::files;
use crate::report::{output, table};
use anyhow::Context;
use backstop_lab::methods::{Effort, Method, Solution, Status};
use backstop_lab::problem::{File, Form, read_problem};
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Exit code of a run that did not solve the problem.
const UNSOLVED: u8 = 3;
/// The first bytes of an HDF5 file.
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";
/// Bytes of the largest file that is read.
const LARGEST: u64 = 1 << 30;

/// What is printed; docs/json.md says what its fields mean.
#[derive(Debug, Serialize)]
struct Document {
    status: &'static str,
    iterations: u32,
    pivots: u32,
    residual: f64,
    time_us: f64,
    solution: Vec<f64>,
}

pub(crate) fn solve(options: &SolveOptions) -> anyhow::Result<ExitCode> {
    if options.list {
        output::print(&list())?;
        return Ok(ExitCode::SUCCESS);
    }
    let path = options.file.as_deref().context("a file is needed")?;
    let method = options.method.context("a method is needed")?;
    let file = read(path).with_context(|| format!("can't read {}", path.display()))?;
    let effort = Effort {
        tolerance: options.tolerance,
        iterations: options.iterations,
        friction: options.friction,
        start: guess(&options.guess, &file)?,
        relaxation: options.relaxation,
        ..Effort::default()
    };
    let (found, times) = timed(|| (method.solve)(&file.problem, &effort));
    let document = Document {
        status: match found.status {
            Status::Solved => "solved",
            Status::Ray => "ray",
            Status::NoSolution => "no_solution",
            Status::Limit => "limit",
        },
        iterations: found.iterations,
        pivots: found.pivots,
        residual: found.residual,
        time_us: times[times.len() / 2],
        solution: file.unknowns(&found.r),
    };
    if options.json {
        output::print_json(&document)?;
    } else {
        output::print(&text(&document, file.form, method.name, times.len()))?;
    }
    let solved = found.status == Status::Solved;
    Ok(if solved { ExitCode::SUCCESS } else { ExitCode::from(UNSOLVED) })
}

/// The part of a document of `solve --json` that another run starts from.
#[derive(Deserialize)]
struct Guess {
    solution: Vec<f64>,
}

/// Impulses to start from, by rows of the problem; none: zero.
fn guess(path: &Path, file: &File) -> anyhow::Result<Option<Vec<f64>>> {
    if path == Path::new("zero") {
        return Ok(None);
    }
    let about = || format!("can't start from {}", path.display());
    let bytes = files::read(path, LARGEST).with_context(about)?;
    let guess: Guess = serde_json::from_slice(&bytes).with_context(about)?;
    let rows = file.rows_of(&guess.solution).context("it is the solution of another problem");
    Ok(Some(rows.with_context(about)?))
}

/// The solution, and the times of some runs in ascending order [us]: up to five, as many as begin within half
/// a second.
fn timed(run: impl Fn() -> Solution) -> (Solution, Vec<f64>) {
    let begin = Instant::now();
    let mut times = Vec::new();
    loop {
        let start = Instant::now();
        let found = run();
        times.push(start.elapsed().as_secs_f64() * 1e6);
        if times.len() == 5 || begin.elapsed() > Duration::from_millis(500) {
            times.sort_by(f64::total_cmp);
            return (found, times);
        }
    }
}

fn read(path: &Path) -> anyhow::Result<File> {
    let bytes = files::read(path, LARGEST)?;
    if bytes.starts_with(HDF5) {
        return read_hdf5(bytes);
    }
    // Text after the numbers need not be UTF-8.
    Ok(read_problem(&String::from_utf8_lossy(&bytes))?)
}

#[cfg(feature = "hdf5")]
fn read_hdf5(bytes: Vec<u8>) -> anyhow::Result<File> {
    Ok(backstop_lab::problem::read_fclib(bytes)?)
}

#[cfg(not(feature = "hdf5"))]
fn read_hdf5(_: Vec<u8>) -> anyhow::Result<File> {
    anyhow::bail!("it is HDF5, for which backstop has to be built with the feature `hdf5` (--features hdf5)")
}

fn text(document: &Document, form: Form, method: &str, runs: usize) -> String {
    let Document { status, iterations, pivots, residual, time_us, solution } = document;
    let runs = if runs == 1 { "one run".into() } else { format!("median of {runs} runs") };
    let rows = [
        ("residual", format!("{residual:.3e}")),
        ("iterations", output::count((*iterations).into())),
        ("pivots", output::count((*pivots).into())),
        ("time", format!("{} ({runs})", output::micros(*time_us))),
    ];
    let mut text = format!("{method}: {}\n{}", status.replace('_', " "), table::list(rows));
    let (title, width) = match form {
        Form::Complementarity => ("z", 1),
        Form::PlaneContacts => ("impulses of each contact: normal, tangent", 2),
        Form::Contacts => ("impulses of each contact: normal, two tangents", 3),
        Form::RollingContacts => ("impulses of each contact: normal, two tangents, two moments", 5),
    };
    let _ = writeln!(text, "{title}");
    for (number, contact) in solution.chunks(width).enumerate() {
        let _ = write!(text, "{number:>6}");
        contact.iter().for_each(|x| {
            let _ = write!(text, " {x:>23.15e}");
        });
        text.push('\n');
    }
    text
}

fn list() -> String {
    let row = |method: &Method| (method.name, format!("{}\nexact for {}", method.about, method.laws));
    table::list(Method::ALL.iter().map(row))
}
