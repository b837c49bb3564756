//! Errors of a node, and how a caller is told.

use super::file::Parts;
use super::tree;
use crate::SceneError;
use backstop::Error;
use backstop::LimitExceeded;

/// An error of a geometry.
pub(super) enum Problem {
    Text(String),
    Engine(Error),
    Limit(LimitExceeded),
}

impl From<Error> for Problem {
    fn from(e: Error) -> Self {
        Problem::Engine(e)
    }
}

impl From<LimitExceeded> for Problem {
    fn from(e: LimitExceeded) -> Self {
        Problem::Limit(e)
    }
}

pub(super) fn text<T>(what: impl Into<String>) -> Result<T, Problem> {
    Err(Problem::Text(what.into()))
}

/// The error of a node.
pub(super) fn problem(parts: &Parts, node: usize, problem: Problem) -> SceneError {
    let label = parts.document.nodes().nth(node).map_or_else(|| node.to_string(), |n| tree::label(&n));
    match problem {
        Problem::Text(what) => SceneError::Node { file: parts.path.clone(), node: label, what },
        Problem::Engine(source) => SceneError::Body { file: parts.path.clone(), node: label, source },
        Problem::Limit(source) => SceneError::Limit { file: parts.path.clone(), source },
    }
}
