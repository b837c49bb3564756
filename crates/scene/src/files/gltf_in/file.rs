//! A glTF file taken apart: its JSON, its validated document, its buffers. Nothing here trusts a length or an
//! offset.

use crate::SceneError;
use crate::files::resolve::{Resolver, find, folder_of};
use crate::files::whole::read_file;
use backstop::{LimitExceeded, Tally};
use base64::Engine;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A file as it was read.
pub(crate) struct Parts {
    pub(crate) path: PathBuf,
    /// The whole of it, known parts or not.
    pub(crate) json: Value,
    /// The same, with every index checked.
    pub(crate) document: gltf::Document,
    pub(crate) buffers: Vec<Vec<u8>>,
    /// Extensions that the file requires and this loader doesn't know.
    pub(crate) unknown_required: Vec<String>,
}

/// Extensions that may be required: ours, and those that don't change where a triangle is.
const KNOWN: &[&str] = &[super::extension::RIGID_BODIES, super::extension::SHAPES];

impl Parts {
    pub(crate) fn read(path: &Path, resolve: &Resolver<'_>, tally: &mut Tally) -> Result<Parts, SceneError> {
        let bytes = read_file(path, &mut tally.bytes)?;
        Self::parse(path, &bytes, resolve, tally)
    }

    pub(super) fn parse(
        path: &Path,
        bytes: &[u8],
        resolve: &Resolver<'_>,
        tally: &mut Tally,
    ) -> Result<Parts, SceneError> {
        let malformed = |what: String| SceneError::Malformed { file: path.into(), what };
        let (text, blob) = match bytes.starts_with(b"glTF") {
            true => split_glb(bytes).map_err(|what| malformed(what.into()))?,
            false => (bytes, None),
        };
        let json: Value =
            serde_json::from_slice(text).map_err(|e| malformed(format!("not a glTF file: {e}")))?;
        // A node takes three bytes of a file, and a hundred times as many in the crate's tree.
        let nodes = json["nodes"].as_array().map_or(0, Vec::len);
        tally.nodes.allow(nodes).map_err(|source| SceneError::Limit { file: path.into(), source })?;
        let mut root: gltf::json::Root =
            gltf::json::deserialize::from_slice(text).map_err(|e| malformed(format!("not glTF 2.0: {e}")))?;
        if !root.asset.version.starts_with("2.") {
            return Err(malformed(format!("glTF {} instead of 2.0", root.asset.version)));
        }
        // The validation below refuses every extension that it doesn't know; some are supported here.
        let required = std::mem::take(&mut root.extensions_required);
        let unknown_required = required.into_iter().filter(|e| !KNOWN.contains(&e.as_str())).collect();
        // The crate's own check looks at the accessor of positions before it has checked the index (gltf-json
        // 1.4.1).
        let accessors = root.accessors.len();
        let primitives = root.meshes.iter().flat_map(|m| &m.primitives);
        if primitives.flat_map(|p| p.attributes.values()).any(|a| a.value() >= accessors) {
            return Err(malformed("a mesh refers to an accessor that does not exist".into()));
        }
        let document = gltf::Document::from_json(root).map_err(|e| malformed(validation_text(e)))?;
        let buffers = read_buffers(path, &document, blob, resolve, tally)?;
        Ok(Parts { path: path.into(), json, document, buffers, unknown_required })
    }
}

/// The first complaint: the rest often follows from it.
fn validation_text(error: gltf::Error) -> String {
    match error {
        gltf::Error::Validation(list) => match list.first() {
            Some((path, what)) => format!("{path}: {what}"),
            None => "not valid glTF".into(),
        },
        other => other.to_string(),
    }
}

/// JSON and binary chunk of a `.glb` (glTF 2.0 specification, section 4.4).
fn split_glb(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), &'static str> {
    const TRUNCATED: &str = "a binary glTF file that was cut off";
    let word = |at: usize| {
        let word = bytes.get(at..at + 4).and_then(|w| w.try_into().ok());
        word.map(u32::from_le_bytes).ok_or(TRUNCATED)
    };
    if word(4)? != 2 {
        return Err("a binary glTF file of another version than 2");
    }
    let total = word(8)? as usize;
    if total > bytes.len() {
        return Err(TRUNCATED);
    }
    let chunk = |at: usize| {
        let length = word(at)? as usize;
        let data = bytes[..total].get(at + 8..).and_then(|rest| rest.get(..length)).ok_or(TRUNCATED)?;
        Ok::<_, &str>((word(at + 4)?, data))
    };
    let (kind, json) = chunk(12)?;
    if kind != u32::from_le_bytes(*b"JSON") {
        return Err("a binary glTF file without JSON");
    }
    let next = (20 + json.len()).next_multiple_of(4);
    if next + 8 > total {
        return Ok((json, None));
    }
    match chunk(next)? {
        (kind, data) if kind == u32::from_le_bytes(*b"BIN\0") => Ok((json, Some(data))),
        _ => Ok((json, None)),
    }
}

fn read_buffers(
    path: &Path,
    document: &gltf::Document,
    blob: Option<&[u8]>,
    resolve: &Resolver<'_>,
    tally: &mut Tally,
) -> Result<Vec<Vec<u8>>, SceneError> {
    let malformed = |what: String| SceneError::Malformed { file: path.into(), what };
    let mut buffers = Vec::new();
    for buffer in document.buffers() {
        let data = match buffer.source() {
            gltf::buffer::Source::Bin => {
                // Only the first may be in it (glTF 2.0, section 3.6.1.2); each would be a copy of all of it.
                let blob = blob.filter(|_| buffer.index() == 0);
                let blob = blob.ok_or_else(|| malformed("its binary chunk is missing".into()))?;
                blob[..buffer.length().min(blob.len())].to_vec()
            }
            gltf::buffer::Source::Uri(uri) => read_uri(path, uri, buffer.length() as u64, resolve, tally)?,
        };
        if data.len() < buffer.length() {
            let (index, is, says) = (buffer.index(), data.len(), buffer.length());
            return Err(malformed(format!("buffer {index} has {is} bytes instead of {says}")));
        }
        buffers.push(data);
    }
    Ok(buffers)
}

/// The bytes behind a data URI, or else those that the resolver finds; at most `most` of them.
pub(crate) fn read_uri(
    scene: &Path,
    uri: &str,
    most: u64,
    resolve: &Resolver<'_>,
    tally: &mut Tally,
) -> Result<Vec<u8>, SceneError> {
    let malformed = |what: String| SceneError::Malformed { file: scene.into(), what };
    if let Some(data) = uri.strip_prefix("data:") {
        let Some((_, text)) = data.split_once(";base64,") else {
            return Err(malformed("a data URI that is not base64".into()));
        };
        let engine = base64::engine::general_purpose::STANDARD;
        return engine.decode(text).map_err(|e| malformed(format!("a data URI: {e}")));
    }
    // The same file may be named again and again. One more than is left, to see that there is more.
    let asked = most.min(tally.bytes.left().saturating_add(1));
    let failed = |reason| SceneError::Uri { file: scene.into(), uri: uri.into(), reason };
    let bytes = resolve(uri, asked).map_err(failed)?;
    let beyond = |source: LimitExceeded| SceneError::Limit { file: scene.into(), source };
    tally.bytes.take(bytes.len()).map_err(beyond)?;
    Ok(bytes)
}

/// The files that a scene's uris name, buffers and images, as far as they are there.
pub(crate) fn referred(scene: &Path, json: &Value) -> Vec<PathBuf> {
    let folder = folder_of(scene);
    let uris = ["buffers", "images"].into_iter().filter_map(|list| json[list].as_array()).flatten();
    let uris = uris.filter_map(|one| one["uri"].as_str()).filter(|uri| !uri.starts_with("data:"));
    uris.filter_map(|uri| find(&folder, uri).ok()).collect()
}
