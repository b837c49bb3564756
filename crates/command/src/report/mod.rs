//! The output of commands: text for the terminal, JSON documents, and pages with charts.

pub(crate) mod accuracy;
pub(crate) mod charts;
pub(crate) mod document;
pub(crate) mod html;
pub(crate) mod output;
pub(crate) mod page;
pub(crate) mod summary;
pub(crate) mod table;
pub(crate) mod trace;
pub(crate) mod viewer;
