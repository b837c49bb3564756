//! The command line.
#![cfg(feature = "cli")]

mod form;
mod spared;
mod stopped;
mod trade;
mod view;
