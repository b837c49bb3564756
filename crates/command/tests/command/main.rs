//! The command line.

mod form;
mod spared;
mod stopped;
mod testbed;
mod trade;
