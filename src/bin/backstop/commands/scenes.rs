//! `scenes`: lists the builtin scenes, and writes those that are shipped as files.

use crate::report::output;
use backstop::scene;
use std::path::Path;

/// Lists all scenes with their numbers of dynamic bodies.
pub(crate) fn list() -> anyhow::Result<()> {
    let mut text = String::from("Builtin scenes, by their names:\n");
    for (name, scene) in scene::builtin::NAMES.iter().filter_map(|n| Some((n, scene::builtin::build(n)?))) {
        text += &format!("  {name:<20}{:>6} bodies that move\n", scene.dynamic_bodies());
    }
    text += "Scenes that `cargo backstop scenes write` writes as files:\n";
    for (file, scene) in scene::SHIPPED.iter().filter_map(|f| Some((f, scene::shipped(f)?))) {
        text += &format!("  {file:<20}{:>6} bodies that move\n", scene.dynamic_bodies());
    }
    output::print(&text)
}

/// Writes the shipped scenes into a folder.
pub(crate) fn write(folder: &Path) -> anyhow::Result<()> {
    let written = scene::write_shipped(folder)?;
    output::print(&written.iter().map(|p| format!("{}\n", p.display())).collect::<String>())
}
