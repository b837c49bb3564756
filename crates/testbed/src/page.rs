//! The page's files, each as it is served.

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

/// Lists files of the page with their media types.
macro_rules! files {
    ($($name:literal: $kind:ident),* $(,)?) => {
        &[$(($name, $kind, include_bytes!(concat!("../page/", $name)))),*]
    };
}

/// Name, media type and bytes of each file. The first is the page itself.
pub const FILES: &[(&str, &str, &[u8])] = files! {
    "index.html": HTML,
    "style.css": CSS,
    "app.js": SCRIPT,
    "bars.js": SCRIPT,
    "engine.js": SCRIPT,
    "hand.js": SCRIPT,
    "highlight.js": SCRIPT,
    "hook.js": SCRIPT,
    "keys.js": SCRIPT,
    "ledger.js": SCRIPT,
    "loop.js": SCRIPT,
    "page.js": SCRIPT,
    "panel.js": SCRIPT,
    "permalink.js": SCRIPT,
    "samples.js": SCRIPT,
    "slow.js": SCRIPT,
    "transport.js": SCRIPT,
    "worker.js": SCRIPT,
    "draw/camera.js": SCRIPT,
    "draw/gl.js": SCRIPT,
    "draw/marks.js": SCRIPT,
    "draw/normals.js": SCRIPT,
    "draw/orbit.js": SCRIPT,
    "draw/palette.js": SCRIPT,
    "draw/renderer.js": SCRIPT,
    "draw/shaders.js": SCRIPT,
    "draw/view.js": SCRIPT,
};

/// The file of a name; the page itself for an empty one.
pub fn file(name: &str) -> Option<&'static (&'static str, &'static str, &'static [u8])> {
    if name.is_empty() { FILES.first() } else { FILES.iter().find(|file| file.0 == name) }
}

/// The text of a file, such as a module of the renderer; empty if there is none of that name.
pub fn text(name: &str) -> &'static str {
    file(name).and_then(|(_, _, bytes)| std::str::from_utf8(bytes).ok()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn every_file_of_the_page_is_listed() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("page");
        let count = |folder: &Path| {
            let entries = std::fs::read_dir(folder).expect("a folder");
            entries.filter(|entry| entry.as_ref().expect("an entry").path().is_file()).count()
        };
        assert_eq!(count(&root) + count(&root.join("draw")), FILES.len());
        for (name, _, bytes) in FILES {
            let text = std::str::from_utf8(bytes).expect("text");
            let lines = text.lines().count();
            assert!((1..=300).contains(&lines), "{name} has {lines} lines");
            assert_eq!(self::text(name), text);
        }
    }
}
