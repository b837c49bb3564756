//! Why a scene could not be read or written.

use backstop::LimitExceeded;
use backstop::{Error, Escaped};
use std::fmt;
use std::path::PathBuf;

/// Why a scene could not be read or written, as text with whatever a file says [escaped](Escaped): the file,
/// the node if it is about one, and what is wrong.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The file can't be read.
    Read {
        /// The scene, or a file that it refers to.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file can't be written.
    Write {
        /// Which file.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Neither the name of a builtin scene nor a known kind of file.
    UnknownFormat {
        /// Which file.
        file: PathBuf,
    },
    /// The file breaks the rules of its format.
    Malformed {
        /// Which file.
        file: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// The file asks for more than its [`LoadLimits`](backstop::LoadLimits) allow.
    Limit {
        /// Which file.
        file: PathBuf,
        /// Which limit.
        source: LimitExceeded,
    },
    /// A `uri` of the scene names a file that may not or can't be read.
    Uri {
        /// The scene.
        file: PathBuf,
        /// The uri as in the scene; escaped in the message.
        uri: String,
        /// Why, without any content.
        reason: String,
    },
    /// A node breaks the rules of its format, or needs a feature that can't be simulated.
    Node {
        /// Which file.
        file: PathBuf,
        /// Its name and index.
        node: String,
        /// What is wrong.
        what: String,
    },
    /// The engine refuses the shape or body of a node.
    Body {
        /// Which file.
        file: PathBuf,
        /// Its name and index.
        node: String,
        /// Why.
        source: Error,
    },
}

/// The most characters of a uri or a name that a message shows.
const SHOWN: usize = 200;

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let short = |text: &str| text.chars().take(SHOWN).collect::<String>();
        let text = match self {
            Self::Read { file, source } => format!("{}: {source}", file.display()),
            Self::Write { file, source } => format!("can't write {}: {source}", file.display()),
            Self::UnknownFormat { file } => {
                format!("{}: not a .gltf, .glb or .obj file, nor a builtin scene", file.display())
            }
            Self::Malformed { file, what } => format!("{}: {what}", file.display()),
            Self::Limit { file, source } => format!("{}: {source}", file.display()),
            Self::Uri { file, uri, reason } => format!("{}, uri {}: {reason}", file.display(), short(uri)),
            Self::Node { file, node, what } => format!("{}, node {}: {what}", file.display(), short(node)),
            Self::Body { file, node, source } => {
                format!("{}, node {}: {source}", file.display(), short(node))
            }
        };
        // The one place: names, uris, words of a file in a parser's complaint, and the path itself.
        write!(f, "{}", Escaped(text))
    }
}
