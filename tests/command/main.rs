//! The command line.
#![cfg(feature = "cli")]

mod form;
mod trade;
mod view;
