//! The scene with its motion on a page: a viewer in WebGL2 that needs nothing but the page itself.
//!
//! The testbed draws with the same modules: `crates/testbed/page/draw/`.

mod film;
mod motion;

pub(crate) use motion::Motion;

use crate::report::html::Part;
use anyhow::Context;
use askama::Template;
use backstop_scene::Scene;
use backstop_testbed::page;
use film::Film;

/// The modules of the renderer, each after those that it imports from. Put together they are one, with the
/// player's after them.
const MODULES: [&str; 9] =
    ["camera", "orbit", "shaders", "normals", "gl", "marks", "palette", "renderer", "view"];

const PLAYER: &str = include_str!("player.js");
const STYLE: &str = include_str!("player.css");

/// Text of these fields is put in as it is, but for the notes.
#[derive(Template)]
#[template(path = "viewer.html")]
struct Viewer<'a> {
    style: &'a str,
    notes: &'a [String],
    film: String,
    module: String,
}

/// The viewer as a part of a page, or a sentence that says why there is none.
pub(crate) fn part(scene: &Scene, motion: &Motion) -> anyhow::Result<Part> {
    let film = match Film::of(scene, motion) {
        Ok(film) => film,
        Err(reason) => return Ok(Part::Text(format!("No motion is shown: {reason}."))),
    };
    let viewer = Viewer { style: STYLE, notes: &film.notes, film: film.json(), module: module() };
    Ok(Part::Viewer(viewer.render().context("can't make the page")?))
}

/// Renderer and player as one module.
fn module() -> String {
    let renderer = MODULES.iter().map(|name| page::text(&format!("draw/{name}.js")));
    renderer.chain([PLAYER]).map(joined).collect()
}

/// A module without its imports and exports: a page that is opened from disk can load no other file.
fn joined(module: &str) -> String {
    let lines = module.lines().filter(|line| !line.starts_with("import "));
    lines.map(|line| format!("{}\n", line.strip_prefix("export ").unwrap_or(line))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modules_put_together_import_nothing_and_end_no_element() {
        let module = module();
        assert!(MODULES.iter().all(|name| !page::text(&format!("draw/{name}.js")).is_empty()));
        let imports = |line: &&str| line.starts_with("import") || line.starts_with("export");
        assert_eq!(module.lines().find(imports), None);
        // In a page these would end the script.
        assert!(!module.contains("</script") && !module.contains("<!--"));
        let mut names: Vec<&str> = module
            .lines()
            .filter_map(|line| {
                let rest =
                    ["const ", "function ", "class "].iter().find_map(|word| line.strip_prefix(word))?;
                rest.split(|c: char| !c.is_alphanumeric() && c != '_').next()
            })
            .collect();
        let all = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), all, "two modules declare one name");
    }
}
