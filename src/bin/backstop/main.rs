//! `cargo backstop`: runs scenes, plans their memory, replays recordings, measures tunnelling, the stability of rest, what holds at
//! the extremes and what exact cases are off by, trades speed for accuracy, solves problems of contact resolution, writes the shipped
//! scenes.

mod accuracy;
mod args;
mod cases;
mod charts;
mod compare;
mod document;
mod extremes;
mod html;
mod json_lines;
mod methods;
mod output;
mod page;
mod plan;
mod profile;
mod replay;
mod run;
mod settings_file;
mod shots;
mod simbench;
mod solve;
mod stability;
mod summary;
mod threads;
mod tosses;
mod trace;
mod trade;
mod view;

use args::{Command, Options, ScenesCommand};
use backstop::{Escaped, scene};
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let done = match Options::parse().command {
        Command::Run(options) => run::run(&options),
        Command::Profile(options) => profile::profile(&options),
        Command::Plan(options) => plan::plan(&options),
        Command::Stability(options) => stability::stability_of(&options),
        Command::Extremes(options) => extremes::extremes(&options),
        Command::Replay(options) => replay::replay(&options),
        Command::Shots(options) => shots::shots(&options),
        Command::Methods(options) => methods::methods(&options),
        Command::Cases(options) => cases::cases(&options),
        Command::Simbench(options) => simbench::simbench(&options),
        Command::Tosses(options) => tosses::tosses(&options),
        Command::Trade(options) => trade::trade(&options),
        Command::Compare(options) => compare::print(&options),
        // Alone in having more to say than whether it ran.
        Command::Solve(options) => match solve::solve(&options) {
            Ok(code) => return code,
            Err(error) => Err(error),
        },
        Command::Scenes { command: ScenesCommand::List } => list_scenes(),
        Command::Scenes { command: ScenesCommand::Write { folder } } => write_scenes(&folder),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // The whole chain of causes on one line.
            eprintln!("error: {}", Escaped(format!("{error:#}")));
            ExitCode::FAILURE
        }
    }
}

fn list_scenes() -> anyhow::Result<()> {
    let mut text = String::from("Builtin scenes, by their names:\n");
    for (name, scene) in scene::builtin::NAMES.iter().filter_map(|n| Some((n, scene::builtin::build(n)?))) {
        text += &format!("  {name:<20}{:>6} bodies that move\n", scene.dynamic_bodies());
    }
    text += "Scenes that `cargo backstop scenes write` writes as files:\n";
    for (file, scene) in scene::SHIPPED.iter().filter_map(|f| Some((f, scene::shipped(f)?))) {
        text += &format!("  {file:<20}{:>6} bodies that move\n", scene.dynamic_bodies());
    }
    output::print(&text)
}

fn write_scenes(folder: &std::path::Path) -> anyhow::Result<()> {
    let written = scene::write_shipped(folder)?;
    output::print(&written.iter().map(|p| format!("{}\n", p.display())).collect::<String>())
}
