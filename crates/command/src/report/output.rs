//! Output to the terminal, and checks of output files.

use crate::files::{self, Kind};
use crate::interrupt;
use anyhow::{Context, anyhow};
use backstop::Escaped;
use backstop::LoadLimits;
use backstop_scene::{self as scene, Scene, SceneError, refuse_input};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;
use std::time::Duration;

/// Prints a scene's notes, escaped because they quote its file.
pub(crate) fn notes(scene: &Scene) {
    scene.notes.iter().for_each(|note| eprintln!("note: {}", Escaped(note)));
}

/// Text with its line breaks, but with all other control characters escaped, as names from files may have
/// them.
fn escaped_lines(text: &str) -> String {
    text.split_inclusive('\n')
        .map(|line| match line.strip_suffix('\n') {
            Some(line) => format!("{}\n", Escaped(line)),
            None => Escaped(line).to_string(),
        })
        .collect()
}

/// Writes to standard output. A reader that stops early (`| head`) is not an error.
pub(crate) fn print(text: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(escaped_lines(text).as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(error).context("can't write to standard output")
        }
        _ => Ok(()),
    }
}

/// A value as one JSON document.
pub(crate) fn print_json(value: &impl serde::Serialize) -> anyhow::Result<()> {
    let mut text = serde_json::to_string_pretty(value).context("can't write JSON")?;
    text.push('\n');
    print(&text)
}

/// Makes a folder if it is not there.
pub(crate) fn make_folder(folder: &Path) -> anyhow::Result<()> {
    let about = || format!("can't make the folder {}", folder.display());
    if folder.exists() && !folder.is_dir() {
        return Err(anyhow!("there is a file of this name")).with_context(about);
    }
    std::fs::create_dir_all(folder).with_context(about)
}

/// Makes the folder of a report, unless it has a page or charts that are not of a report.
pub(crate) fn make_report(folder: &Path, charts: &[impl AsRef<str>]) -> anyhow::Result<()> {
    let charts = charts.iter().map(AsRef::as_ref);
    files::expect_places(folder, std::iter::once("index.html").chain(charts), Kind::Page)?;
    make_folder(folder)
}

/// The scene of this name. A name that is neither a file nor a builtin scene gets those that are like it.
pub(crate) fn open(name: &str, limits: &LoadLimits) -> anyhow::Result<Scene> {
    let like = |known: &&&str| strsim::jaro_winkler(name, known) > 0.8;
    scene::open_limited(name, limits).map_err(|error| {
        let mut known: Vec<&&str> = scene::builtin::NAMES.iter().filter(like).collect();
        known.sort_by(|a, b| strsim::jaro_winkler(name, b).total_cmp(&strsim::jaro_winkler(name, a)));
        match (error, known.first()) {
            (SceneError::UnknownFormat { .. }, Some(known)) => {
                anyhow!("there is no scene {name}; is it {known}?")
            }
            (SceneError::UnknownFormat { .. }, None) => anyhow!(
                "{name} is neither a .gltf, .glb or .obj file nor a builtin scene, which `scenes list` names"
            ),
            (error, _) => error.into(),
        }
    })
}

/// Makes the folder that a file will be in.
pub(crate) fn make_folder_of(file: &Path) -> anyhow::Result<()> {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).map_or(Ok(()), make_folder)
}

/// A line of a summary: a file that was written.
pub(crate) fn written<L: From<&'static str>>(path: &Path) -> (L, String) {
    ("written".into(), path.display().to_string())
}

/// Refuses outputs that would replace an input, or one another, before any work is done.
pub(crate) fn refuse_inputs<'a>(
    outputs: &[Option<&Path>],
    inputs: impl IntoIterator<Item = &'a Path> + Clone,
) -> anyhow::Result<()> {
    let outputs: Vec<&Path> = outputs.iter().copied().flatten().collect();
    for (i, output) in outputs.iter().enumerate() {
        let about = || format!("can't write {}", output.display());
        for input in inputs.clone() {
            refuse_input(output, input).with_context(about)?;
        }
        if outputs[..i].contains(output) {
            return Err(anyhow!("two outputs have this name")).with_context(about);
        }
    }
    Ok(())
}

/// A progress bar on standard error, if that is a terminal.
pub(crate) fn progress(wanted: bool, count: u64, what: &'static str) -> ProgressBar {
    if !wanted || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:32} {pos}/{len} {msg}, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    let bar = ProgressBar::new(count).with_style(style).with_message(what);
    // Keeps moving while a single step takes long.
    bar.enable_steady_tick(Duration::from_millis(200));
    interrupt::shows(&bar);
    bar
}

/// A number with its thousands separated.
pub(crate) fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// A value as JSON with numbers as short as they are told from their neighbours: `serde_json::to_value` turns
/// 1/60 as `f32` into 0.01666666753590107.
pub(crate) fn exact(value: &impl serde::Serialize) -> serde_json::Result<serde_json::Value> {
    serde_json::from_str(&serde_json::to_string(value)?)
}

/// A length of time, as a fraction where it is one: 1/60 s.
pub(crate) fn seconds(s: f32) -> String {
    let whole = (1.0 / s).round();
    if whole >= 2.0 && 1.0 / whole == s { format!("1/{whole} s") } else { format!("{s} s") }
}

/// The causes of an error, each once: some have their own in their text.
pub(crate) fn causes(error: &anyhow::Error) -> String {
    let mut told = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if !told.contains(&cause) {
            told = if told.is_empty() { cause } else { format!("{told}: {cause}") };
        }
    }
    told
}

/// How many of something: of one, or of several.
pub(crate) fn plural(n: u64, one: &str, several: &str) -> String {
    format!("{} {}", count(n), if n == 1 { one } else { several })
}

/// How many threads.
pub(crate) fn count_threads(n: usize) -> String {
    plural(n as u64, "thread", "threads")
}

/// Bytes in a suitable unit.
pub(crate) fn bytes(n: usize) -> String {
    match n as f64 {
        b if b < 1024.0 => format!("{b} B"),
        b if b < 1024.0 * 1024.0 => format!("{:.1} KiB", b / 1024.0),
        b => format!("{:.1} MiB", b / (1024.0 * 1024.0)),
    }
}

/// A time in a suitable unit.
pub(crate) fn micros(us: f64) -> String {
    if us < 1000.0 { format!("{us:.1} µs") } else { format!("{:.2} ms", us / 1000.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_are_readable() {
        assert_eq!(["7", "1 000", "1 234 567"], [7, 1000, 1_234_567].map(count).each_ref().map(|s| &s[..]));
        assert_eq!(bytes(1536), "1.5 KiB");
        assert_eq!(micros(2500.0), "2.50 ms");
        assert_eq!([plural(1, "step", "steps"), plural(2000, "step", "steps")], ["1 step", "2 000 steps"]);
        assert_eq!(
            [1.0 / 60.0, 0.02, 1.0 / 59.5, 2.0].map(seconds),
            ["1/60 s", "1/50 s", "0.016806724 s", "2 s"]
        );
        assert_eq!(exact(&(1.0f32 / 60.0)).unwrap().to_string(), "0.016666668");
    }

    #[test]
    fn a_cause_is_told_once() {
        let error = anyhow!("no such file").context("scene.glb: no such file").context("can't run");
        assert_eq!(causes(&error), "can't run: scene.glb: no such file");
    }
}
