//! The testbed: samples, builtin scenes and files, run for a page that draws them.
//!
//! A [`Session`] takes requests of the page as JSON and answers with a frame: a header in JSON, and numbers
//! to be drawn. `cargo backstop testbed` serves both on the loopback address, and `bindings/web` has the
//! session in the page itself, as WebAssembly. The page is in [`page`].

mod catalogue;
mod command;
mod drawing;
mod frame;
mod history;
mod layers;
mod ledger;
pub mod page;
mod run;
mod session;
mod settings;
#[cfg(test)]
mod tests;
mod tools;

pub use catalogue::{FileScene, knows};
pub use session::Session;

/// Why a request is refused, in words for its reader.
#[derive(Debug, thiserror::Error)]
enum Refusal {
    #[error(transparent)]
    World(#[from] backstop::Error),
    #[error("{0}")]
    Told(String),
}

impl Refusal {
    fn told(text: impl Into<String>) -> Refusal {
        Refusal::Told(text.into())
    }
}
