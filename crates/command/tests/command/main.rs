//! The command line.

mod form;
mod spared;
mod stopped;
mod trade;
mod view;
