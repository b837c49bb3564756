//! Files of others stay as they are, and files without an end are refused.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn backstop(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_backstop"))
        .args(arguments)
        .current_dir(scratch("."))
        .output()
        .expect("the command starts")
}

/// A file or folder of this test run.
fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("spared");
    std::fs::create_dir_all(&folder).expect("a folder for tests");
    folder.join(name)
}

/// Refused in one line with these words, without a word on standard output.
#[track_caller]
fn refused(arguments: &[&str], reason: &str) {
    let output = backstop(arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), errors.lines().count()), (Some(1), 1), "{arguments:?}: {errors}");
    assert!(errors.contains(reason) && output.stdout.is_empty(), "{arguments:?}: {errors}");
}

/// Everything after the last line break of the file was erased. Expected: not a byte of what is not of
/// results.
#[test]
fn results_are_added_to_no_file_of_something_else() {
    let texts: [&[u8]; 6] = [
        b"precious",
        b"precious\nand more",
        b"\n",
        b"\0\xff\x80",
        b"{\"engine\": \"other spacing\"}",
        b"{\"cells\":[]}",
    ];
    for (i, text) in texts.into_iter().enumerate() {
        let file = scratch(&format!("precious-{i}"));
        std::fs::write(&file, text).expect("a file");
        let path = file.to_str().expect("a path");
        refused(&["extremes", "--only", "ball/gravity", "--results", path], path);
        refused(&["trade", "tower_2", "--quick", "--quiet", "--results", path], path);
        assert_eq!(std::fs::read(&file).expect("a file"), text);
    }
    // Those of one command are not the other's.
    let file = scratch("swapped.jsonl");
    std::fs::write(&file, "{\"engine\":\"backstop\"").expect("a file");
    let path = file.to_str().expect("a path");
    refused(&["trade", "tower_2", "--quick", "--quiet", "--results", path], "it holds something else");
    refused(&["trade", "tower_2", "--quick", "--quiet", "--results", "."], "it is not a regular file");
}

/// A film was written under the name of an OBJ file. Expected: a name says what is in a file, and what is
/// there is replaced only by its kind.
#[test]
fn no_output_replaces_something_else() {
    let run = ["run", "chain", "--steps", "1", "--quiet"];
    let refused = |more: &[&str], reason: &str| refused(&[&run[..], more].concat(), reason);
    refused(&["--out", "film.obj"], "its name must end in .glb or .gltf");
    refused(&["--out", "film"], "its name must end in .glb or .gltf");
    refused(&["--export-problem", "1", "problem.txt"], "its name must end in .dat");
    assert!(!scratch("film.obj").exists() && !scratch("problem.txt").exists());
    let mine = |name: &str| {
        let file = scratch(name);
        std::fs::create_dir_all(file.parent().expect("a folder")).expect("a folder");
        std::fs::write(&file, "mine").expect("a file");
        file
    };
    let files = ["mine.glb", "mine.replay", "mine.dat", "site/index.html", "charts/times.svg"].map(mine);
    refused(&["--out", "mine.glb"], "which would be lost");
    refused(&["--record", "mine.replay"], "which would be lost");
    refused(&["--export-problem", "1", "mine.dat"], "which would be lost");
    refused(&["--report", "site"], "which would be lost");
    refused(&["--report", "charts"], "which would be lost");
    refused(&["--report", "mine.glb"], "there is a file of this name");
    for file in &files {
        assert_eq!(std::fs::read(file).expect("a file"), b"mine", "{}", file.display());
    }
    // Nothing of a run is written where one of its outputs is refused.
    refused(&["--record", "never.replay", "--report", "site"], "which would be lost");
    assert!(!scratch("never.replay").exists());
    let page = mine("mine.html");
    crate::spared::refused(
        &["extremes", "--only", "ball/gravity", "--page", "mine.html"],
        "which would be lost",
    );
    let settings = mine("mine.json");
    crate::spared::refused(&["trade", "tower_2", "--out", "mine.json", "--quiet"], "which would be lost");
    let scene = mine("shipped/tower.gltf");
    crate::spared::refused(&["scenes", "write", "shipped"], "another program made it");
    for file in [page, settings, scene] {
        assert_eq!(std::fs::read(&file).expect("a file"), b"mine", "{}", file.display());
    }
}

/// The command replaces files that it has written.
#[test]
fn outputs_are_replaced_by_their_kind() {
    let all = ["--out", "own.glb", "--record", "own.replay", "--report", "own"];
    let run = ["run", "chain", "--steps", "2", "--quiet"];
    for _ in 0..2 {
        let output = backstop(&[&run[..], &all, &["--export-problem", "2", "own.dat"]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(backstop(&["scenes", "write", "own-scenes"]).status.success());
    }
    let profile =
        ["profile", "chain", "--steps", "1", "--repeats", "1", "--threads", "1", "--no-compare", "--quiet"];
    for _ in 0..2 {
        let output = backstop(&[&profile[..], &["--csv", "own.csv", "--report", "own-profile"]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

/// A device without an end was read until the memory was full: the size of a file is not its length.
/// Expected: an error after the limit.
#[cfg(target_os = "linux")]
#[test]
fn files_without_an_end_are_refused() {
    let zero = "/dev/zero";
    assert!(Path::new(zero).exists());
    refused(&["run", "chain", "--settings", zero], "more than 1048576 bytes");
    refused(&["trade", "tower_2", "--settings", zero, "--quiet"], "more than 1048576 bytes");
    refused(&["replay", zero], "no recording");
    refused(&["extremes", "--only", "ball/gravity", "--beside", zero], "more than 268435456 bytes");
    refused(&["trade", "--merge", zero, "--quiet"], "more than 268435456 bytes");
    refused(&["extremes", "--only", "ball/gravity", "--results", zero], "not a regular file");
    refused(&["impacts", zero], "more than 67108864 bytes");
    let folder = scratch("tosses");
    std::fs::create_dir_all(&folder).expect("a folder");
    let link = folder.join("zero.csv");
    let _ = std::fs::remove_file(&link);
    std::os::unix::fs::symlink(zero, &link).expect("a link");
    refused(&["tosses", folder.to_str().expect("a path")], "more than 67108864 bytes");
}

/// Expected: one line that says what is meant, and no path of a source.
#[test]
fn what_a_newcomer_gets_wrong_is_told_in_a_line() {
    refused(&["run", "ragdols"], "there is no scene ragdols; is it ragdolls?");
    refused(&["plan", "Pile"], "is it pile?");
    refused(&["profile", "tallstack"], "is it tall_stack?");
    refused(&["trade", "nothing-like-it"], "neither a .gltf, .glb or .obj file nor a builtin scene");
    refused(&["run", "level.blend"], "`scenes list` names");
    refused(&["run", "none.glb"], "none.glb: ");
    refused(&["run", "."], "neither");
}
