//! `cargo backstop`: runs scenes, plans their memory, replays recordings, measures tunnelling, the stability
//! of rest, results at the extremes and the errors of cases with known answers, trades speed for accuracy,
//! solves problems of contact resolution, and writes the shipped scenes.

mod args;
mod commands;
mod files;
mod interrupt;
mod json_lines;
mod report;
mod settings_file;
mod testbed;
mod threads;

use backstop::Escaped;
use std::process::ExitCode;

fn main() -> ExitCode {
    match commands::execute(args::Options::of_process().command) {
        Ok(code) => code,
        Err(error) => {
            // On one line.
            eprintln!("error: {}", Escaped(report::output::causes(&error)));
            ExitCode::FAILURE
        }
    }
}
