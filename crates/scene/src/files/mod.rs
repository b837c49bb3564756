//! Scenes from files and files from scenes: glTF and OBJ in, glTF out, and what both need to read and write
//! safely.

mod assets;
mod atomic;
mod error;
mod gltf_in;
mod gltf_out;
mod obj;
mod resolve;
#[cfg(test)]
mod testing;
mod whole;

pub use atomic::{AtomicFile, refuse_input, write_file};
pub use error::SceneError;
pub use gltf_out::{write_animation, write_animation_with, write_scene};
pub use resolve::{Resolver, scene_folder};

use super::{Scene, builtin};
use backstop::{LoadLimits, Tally};
use std::path::Path;
use whole::read_file;

/// Reads a scene: `.gltf` and `.glb` with or without physics, `.obj` as one static mesh. What a glTF file
/// refers to by `uri` must be a regular file in its own folder or below, see [`scene_folder`].
///
/// # Errors
/// Names the file, the node if it is about one, and what is wrong with it.
pub fn load(path: impl AsRef<Path>) -> Result<Scene, SceneError> {
    load_limited(path, &LoadLimits::default())
}

/// The same within other limits.
///
/// # Errors
/// As [`load`].
pub fn load_limited(path: impl AsRef<Path>, limits: &LoadLimits) -> Result<Scene, SceneError> {
    let path = path.as_ref();
    load_with(path, &scene_folder(path), limits)
}

/// The same with another [`Resolver`] for the uris of a glTF file; data URIs are read without it.
///
/// # Errors
/// As [`load`].
pub fn load_with(
    path: impl AsRef<Path>,
    resolve: &Resolver<'_>,
    limits: &LoadLimits,
) -> Result<Scene, SceneError> {
    let path = path.as_ref();
    let load = parser(path)?;
    let mut tally = Tally::new(limits);
    let bytes = read_file(path, &mut tally.bytes)?;
    let mut scene = load(path, &bytes, resolve, tally)?;
    scene.source = Some(path.into());
    Ok(scene)
}

/// The same of a file that is in memory. The name's extension gives its format, and errors mention the name.
///
/// # Errors
/// As [`load`].
pub fn from_bytes(
    name: impl AsRef<Path>,
    bytes: &[u8],
    resolve: &Resolver<'_>,
    limits: &LoadLimits,
) -> Result<Scene, SceneError> {
    let name = name.as_ref();
    let mut tally = Tally::new(limits);
    tally.bytes.take(bytes.len()).map_err(|source| SceneError::Limit { file: name.into(), source })?;
    parser(name)?(name, bytes, resolve, tally)
}

type Parser = fn(&Path, &[u8], &Resolver<'_>, Tally) -> Result<Scene, SceneError>;

/// The parser for a path's extension.
fn parser(path: &Path) -> Result<Parser, SceneError> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    match ending.as_str() {
        "gltf" | "glb" => Ok(gltf_in::read),
        "obj" => Ok(|path, bytes, _, tally| obj::read(path, bytes, tally)),
        _ => Err(SceneError::UnknownFormat { file: path.into() }),
    }
}

/// A builtin scene by its name, or else a file.
///
/// # Errors
/// As [`load`].
pub fn open(name: &str) -> Result<Scene, SceneError> {
    open_limited(name, &LoadLimits::default())
}

/// The same within other limits.
///
/// # Errors
/// As [`load`].
pub fn open_limited(name: &str, limits: &LoadLimits) -> Result<Scene, SceneError> {
    match builtin::build(name) {
        Some(scene) => Ok(scene),
        None => load_limited(name, limits),
    }
}
