//! glTF out: scenes with both physics extensions, and recorded motion as an animation.

mod build;
mod document;
mod film;
mod joints;
mod visual;

#[cfg(test)]
mod tests;

use super::atomic::{refuse_input, write_file};
use super::resolve::{Resolver, scene_folder};
use crate::{Recorder, Scene, SceneError};
use document::Document;
use std::io::Write;
use std::path::Path;

/// Writes a scene with `KHR_physics_rigid_bodies` and `KHR_implicit_shapes`, and a visible mesh for every
/// shape. `.gltf`: text with its data inside; anything else: `.glb`.
///
/// # Errors
/// If the file can't be written; a file that was at `path` is then still there.
pub fn write_scene(scene: &Scene, path: impl AsRef<Path>) -> Result<(), SceneError> {
    let (document, _) = build::scene(scene, true);
    write(document, path.as_ref())
}

/// Writes a film of the recorded motion: for a scene from glTF its own nodes, meshes and materials with an
/// animation added in front, else a simple mesh for each shape. `.gltf`: text; anything else: `.glb`, which
/// any viewer plays.
///
/// # Errors
/// If the scene's file can't be read again, or the film can't be written, for instance because it would
/// replace that file or one that it refers to. A file that was at `path` is then still there.
pub fn write_animation(scene: &Scene, recorder: &Recorder, path: impl AsRef<Path>) -> Result<(), SceneError> {
    let folder = scene_folder(scene.source.as_deref().unwrap_or(Path::new("")));
    write_animation_with(scene, recorder, path, &folder)
}

/// The same with another [`Resolver`] for the uris of the scene's file. An image that it refuses stays a
/// reference.
///
/// # Errors
/// As [`write_animation`].
pub fn write_animation_with(
    scene: &Scene,
    recorder: &Recorder,
    path: impl AsRef<Path>,
    resolve: &Resolver<'_>,
) -> Result<(), SceneError> {
    let path = path.as_ref();
    // Not only would it be lost: the next run would read the film as its scene.
    scene
        .source
        .iter()
        .chain(&scene.parts)
        .try_for_each(|input| refuse_input(path, input))
        .map_err(|source| SceneError::Write { file: path.into(), source })?;
    write(film::document(scene, recorder, resolve)?, path)
}

fn write(document: Document, path: &Path) -> Result<(), SceneError> {
    let text = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gltf"));
    let bytes = if text { document.into_gltf() } else { document.into_glb() };
    write_file(path, |file| file.write_all(&bytes))
        .map_err(|source| SceneError::Write { file: path.into(), source })
}
