//! `scenes`: lists the builtin scenes, and writes those that are shipped as files.

use crate::files;
use crate::report::output;
use crate::report::table::table;
use anyhow::{Context, anyhow};
use backstop_scene::{self as scene, Scene};
use std::path::Path;

/// Bytes of the largest scene that may be one of the shipped.
const LARGEST: u64 = 1 << 26;

/// Lists all scenes with their numbers of dynamic bodies.
pub(crate) fn list() -> anyhow::Result<()> {
    let row = |name: &str, scene: Scene| vec![name.to_owned(), scene.dynamic_bodies().to_string()];
    let builtin = scene::builtin::NAMES.iter().filter_map(|n| Some(row(n, scene::builtin::build(n)?)));
    let files = scene::SHIPPED.iter().filter_map(|f| Some(row(f, scene::shipped(f)?)));
    output::print(&format!(
        "Builtin scenes, by their names:\n{}\
         Scenes that `scenes write` writes as files:\n{}",
        table(&["scene", "bodies that move"], 1, builtin),
        table(&["file", "bodies that move"], 1, files),
    ))
}

/// Writes the shipped scenes into a folder.
pub(crate) fn write(folder: &Path) -> anyhow::Result<()> {
    for file in scene::SHIPPED.iter().map(|name| folder.join(name)).filter(|file| file.exists()) {
        let about = || format!("can't write {}", file.display());
        let text =
            String::from_utf8_lossy(&files::read(&file, LARGEST).with_context(about)?).replace(' ', "");
        if !text.contains(r#""generator":"backstop""#) {
            return Err(anyhow!("another program made it, and it would be lost")).with_context(about);
        }
    }
    let written = scene::write_shipped(folder)?;
    output::print(&written.iter().map(|p| format!("{}\n", p.display())).collect::<String>())
}
