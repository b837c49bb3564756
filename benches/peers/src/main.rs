//! backstop and other engines side by side: `run` runs one scene in one engine, `table` all of them in turn
//! and writes a record, `scale` sweeps a size, `envelope` runs the cells of backstop's envelope.
//!
//! `README.md` has the rules of the comparison and what each column means.

mod engines;
mod envelope;
mod judge;
mod machine;
mod memory;
mod programs;
mod run;
mod scale;
mod scenes;
mod table;

use clap::{Parser, Subcommand};
use std::ffi::OsString;

#[derive(Parser)]
#[command(about = "Runs backstop and other engines side by side: speed, quality of motion, memory")]
struct Options {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Lists engines and scenes.
    List,
    /// Runs one scene in one engine of this program, and prints a line of JSON.
    Run(run::Args),
    /// Runs engines in turn on scenes, and writes a record of it.
    Table(table::Args),
    /// Sweeps the number of bodies, or of triangles, and plots what a step costs.
    Scale(scale::Args),
    /// Runs the cells of backstop's envelope in another engine.
    Envelope(envelope::Args),
}

/// `ENGINE FILE` without a command is short for `envelope ENGINE FILE`.
fn arguments() -> Vec<OsString> {
    let mut args: Vec<OsString> = std::env::args_os().collect();
    if args.get(1).is_some_and(|first| engines::FEATURES.iter().any(|(name, _)| first == name)) {
        args.insert(1, "envelope".into());
    }
    args
}

fn main() -> anyhow::Result<()> {
    match Options::parse_from(arguments()).command {
        Command::List => list(),
        Command::Run(args) => run::main(&args)?,
        Command::Table(args) => table::main(&args)?,
        Command::Scale(args) => scale::main(&args)?,
        Command::Envelope(args) => envelope::main(&args)?,
    }
    Ok(())
}

fn list() {
    println!("engines:");
    for (name, feature) in engines::FEATURES {
        match engines::find(name) {
            Some(entry) => println!("  {name}: {}", entry.version),
            None => println!("  {name}: not in this program, needs the feature {feature}"),
        }
    }
    println!("scenes:");
    scenes::ALL.iter().for_each(|(name, about, _)| println!("  {name}: {about}"));
}
