//! The scene with its motion on a page: a viewer in WebGL2 that needs nothing but the page itself.
//!
//! `bindings/web` draws with the same modules. They are here because a package holds no file of another.

mod film;
mod motion;

pub(crate) use motion::Motion;

use backstop::scene::Scene;
use film::Film;

/// The modules, each after those that it imports from. Put together they are one.
const MODULES: [&str; 6] = [
    include_str!("camera.js"),
    include_str!("normals.js"),
    include_str!("shaders.js"),
    include_str!("renderer.js"),
    include_str!("view.js"),
    include_str!("player.js"),
];

const STYLE: &str = include_str!("player.css");

const CONTROLS: &str = "
<canvas aria-label=\"The scene. Drag to orbit, two fingers or shift to pan, wheel to zoom, double-click to frame.\"></canvas>
<div>
<button>Play</button>
<input type=\"range\" min=\"0\" value=\"0\" step=\"any\" aria-label=\"Time\">
<output>0.00 s</output>
<select aria-label=\"Speed\">
<option value=\"0.1\">1/10</option><option value=\"0.25\">1/4</option><option value=\"1\" selected>real time</option>
</select>
</div>
";

/// The viewer as a part of a page, or a sentence that says why there is none.
pub(crate) fn html(scene: &Scene, motion: &Motion) -> String {
    let film = match Film::of(scene, motion) {
        Ok(film) => film,
        Err(reason) => return format!("<p>No motion is shown: {reason}.</p>\n"),
    };
    let module: String = MODULES.iter().map(|module| joined(module)).collect();
    let notes: String = film.notes.iter().map(|note| format!(" {note}")).collect();
    let film = film.json();
    format!(
        "<style>\n{STYLE}</style>\n<figure class=\"player\">{CONTROLS}<figcaption>Colours tell shapes apart; \
         what is asleep is dim. Drag to orbit, wheel to zoom, double-click to frame what moves.{notes}\
         </figcaption></figure>\n<script type=\"application/json\" id=\"film\">{film}</script>\n\
         <script type=\"module\">\n{module}</script>\n"
    )
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
        let module: String = MODULES.iter().map(|module| joined(module)).collect();
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
