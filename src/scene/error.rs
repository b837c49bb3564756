//! Why a scene could not be read or written.

use crate::error::{Error, Escaped};
use std::path::PathBuf;

/// Why a scene could not be read or written: the file, the node if it is about one, and what is wrong.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The file can't be read.
    #[error("{}: {source}", file.display())]
    Read {
        /// The scene, or a file that it refers to.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file can't be written.
    #[error("can't write {}: {source}", file.display())]
    Write {
        /// Which file.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Neither the name of a builtin scene nor a known kind of file.
    #[error("{}: not a .gltf, .glb or .obj file, nor a builtin scene", file.display())]
    UnknownFormat {
        /// Which file.
        file: PathBuf,
    },
    /// The file breaks the rules of its format.
    #[error("{}: {what}", file.display())]
    Malformed {
        /// Which file.
        file: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// A `uri` of the scene names what may not or can't be read.
    #[error("{}, uri {}: {reason}", file.display(), Escaped(uri))]
    Uri {
        /// The scene.
        file: PathBuf,
        /// As it stands in the scene; escaped in the message.
        uri: String,
        /// Why, without any content.
        reason: String,
    },
    /// A node breaks the rules of its format, or asks for what can't be simulated.
    #[error("{}, node {node}: {what}", file.display())]
    Node {
        /// Which file.
        file: PathBuf,
        /// Its name and index.
        node: String,
        /// What is wrong.
        what: String,
    },
    /// The engine refuses the shape or body of a node.
    #[error("{}, node {node}: {source}", file.display())]
    Body {
        /// Which file.
        file: PathBuf,
        /// Its name and index.
        node: String,
        /// Why.
        source: Error,
    },
}
