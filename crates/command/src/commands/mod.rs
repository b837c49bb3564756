//! The subcommands, a file or a folder each.

mod cases;
pub(crate) mod compare;
mod extremes;
mod impacts;
mod methods;
mod plan;
mod profile;
mod replay;
mod run;
mod scenes;
mod shots;
mod simbench;
mod solve;
mod stability;
mod testbed;
mod tosses;
pub(crate) mod trade;

use crate::args::{Command, ScenesCommand};
use crate::interrupt;
use std::process::ExitCode;

/// Executes a command. The exit code of `solve` says more than whether it ran, that of others whether they
/// were stopped.
pub(crate) fn execute(command: Command) -> anyhow::Result<ExitCode> {
    match command {
        Command::Run(options) => run::run(&options),
        Command::Testbed(options) => testbed::testbed(&options),
        Command::Profile(options) => profile::profile(&options),
        Command::Plan(options) => plan::plan(&options),
        Command::Stability(options) => stability::stability_of(&options),
        Command::Extremes(options) => extremes::extremes(&options),
        Command::Replay(options) => replay::replay(&options),
        Command::Shots(options) => shots::shots(&options),
        Command::Methods(options) => methods::methods(&options),
        Command::Cases(options) => cases::cases(&options),
        Command::Simbench(options) => simbench::simbench(&options),
        Command::Impacts(options) => impacts::impacts(&options),
        Command::Tosses(options) => tosses::tosses(&options),
        Command::Trade(options) => trade::trade(&options),
        Command::Compare(options) => compare::print(&options),
        Command::Solve(options) => return solve::solve(&options),
        Command::Scenes { command: ScenesCommand::List } => scenes::list(),
        Command::Scenes { command: ScenesCommand::Write { folder } } => scenes::write(&folder),
    }?;
    Ok(interrupt::code())
}
