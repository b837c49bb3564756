//! The command line.

mod form;
mod picks;
mod spared;
mod stopped;
mod testbed;
mod trade;
