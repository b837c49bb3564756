//! Ctrl-C leaves whole files of the finished part.
#![cfg(unix)]

use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A file or folder of this test run, which is not there yet.
fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("stopped");
    std::fs::create_dir_all(&folder).expect("a folder for tests");
    let path = folder.join(name);
    let _ = std::fs::remove_file(&path);
    let _ = std::fs::remove_dir_all(&path);
    path
}

fn begin(arguments: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_backstop"));
    command.args(arguments).current_dir(scratch("nothing").parent().expect("a folder"));
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the command starts")
}

/// Sends the signal of Ctrl-C once something is true, and returns what the command says then; its exit code
/// is that of a shell for a program that the signal ended.
fn stop_when(child: Child, is_under_way: impl Fn() -> bool) -> (String, String) {
    stop_with("-INT", child, is_under_way)
}

fn stop_with(signal: &str, mut child: Child, is_under_way: impl Fn() -> bool) -> (String, String) {
    let start = Instant::now();
    while !is_under_way() {
        assert!(child.try_wait().expect("a process").is_none(), "it ended by itself");
        assert!(start.elapsed() < Duration::from_secs(300), "it does not begin");
        std::thread::sleep(Duration::from_millis(20));
    }
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill");
    assert!(sent.success());
    let output = child.wait_with_output().expect("its output");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    let (out, errors) = (text(output.stdout), text(output.stderr));
    assert_eq!(output.status.code(), Some(130), "{errors}");
    (out, errors)
}

/// Bytes of a recording that has more than its first steps.
const RECORDED: u64 = 1 << 15;

/// Files that are not whole yet.
fn left() -> Vec<PathBuf> {
    let folder = scratch("nothing").parent().expect("a folder").to_path_buf();
    let files = std::fs::read_dir(folder).expect("a folder").flatten().map(|file| file.path());
    files.filter(|file| file.extension().is_some_and(|ending| ending == "tmp")).collect()
}

fn length(file: &PathBuf) -> u64 {
    std::fs::metadata(file).map_or(0, |data| data.len())
}

#[test]
fn a_run_that_is_stopped_leaves_whole_files_of_its_steps() {
    for signal in ["-INT", "-TERM"] {
        let [record, film, page] = ["run.replay", "run.glb", "page"].map(scratch);
        let path = |path: &PathBuf| path.to_str().expect("a path").to_owned();
        let run = ["run", "tower_2", "--steps", "1000000", "--json"];
        let [record, film, page] = [&record, &film, &page].map(path);
        let more = ["--record", &record, "--out", &film, "--report", &page];
        let child = begin(&[&run[..], &more].concat());
        let (out, _) = stop_with(signal, child, || left().iter().any(|file| length(file) > RECORDED));
        let document: serde_json::Value = serde_json::from_str(&out).expect("one JSON document");
        let steps = document["steps"].as_u64().expect("a number");
        assert!((1..1_000_000).contains(&steps), "{steps}");

        let file = std::fs::File::open(&record).expect("a recording");
        let played =
            backstop::replay::Replay::open(std::io::BufReader::new(file)).expect("a recording").run();
        let played = played.expect("a whole recording");
        assert!(played.steps == steps && played.divergence.is_none(), "{played:?}");
        assert_eq!(backstop_scene::load(&film).expect("a whole film").name, "run");
        let html = std::fs::read_to_string(format!("{page}/index.html")).expect("a page");
        assert!(html.trim_end().ends_with("</html>"));
        let left = left();
        assert!(left.is_empty(), "{left:?}");
    }
}

/// Expected: whole lines, to which the same command adds.
#[test]
fn measurements_that_are_stopped_go_on() {
    let lines = |file: &PathBuf| std::fs::read_to_string(file).unwrap_or_default().lines().count();
    let results = scratch("cells.jsonl");
    let path = results.to_str().expect("a path");
    let cells = ["extremes", "--only", "/gravity", "--seconds", "20", "--jobs", "1", "--results", path];
    let (map, _) = stop_when(begin(&cells), || lines(&results) > 1);
    assert!(map.contains('?'), "{map}");
    let whole = |file: &PathBuf| {
        let text = std::fs::read_to_string(file).expect("results");
        assert!(text.ends_with('\n'));
        text.lines().for_each(|line| drop(serde_json::from_str::<serde_json::Value>(line).expect("JSON")));
        text
    };
    let kept = whole(&results);
    stop_when(begin(&cells), || lines(&results) > kept.lines().count());
    assert!(whole(&results).starts_with(&kept));

    let results = scratch("trade.jsonl");
    let path = results.to_str().expect("a path");
    let sweep = ["trade", "scenes/tower.gltf", "--seconds", "2", "--threads", "1", "--results", path];
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/tower.gltf");
    let sweep = sweep.map(|word| if word == "scenes/tower.gltf" { scenes } else { word });
    let (out, _) = stop_when(begin(&sweep), || lines(&results) > 2);
    assert!(out.is_empty() && lines(&results) > 2, "{out}");
    whole(&results);
}
