//! The command keeps to the form that docs/json.md promises, and says what is wrong.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

mod documented;
mod files;
mod impacts;
mod measures;
mod problems;
mod runs;

use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};

fn backstop(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_backstop"))
        .args(arguments)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
        .output()
        .expect("the command starts")
}

/// The one document on standard output.
fn document(output: &Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON document")
}

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().map(|o| o.keys().map(String::as_str).collect()).unwrap_or_default()
}

/// Keys in any order.
fn has_keys(value: &Value, expected: &[&str]) {
    let (mut found, mut expected) = (keys(value), expected.to_vec());
    found.sort_unstable();
    expected.sort_unstable();
    assert_eq!(found, expected);
}

fn numbers(value: &Value, count: usize) {
    let list = value.as_array().expect("an array");
    assert!(list.len() == count && list.iter().all(Value::is_f64), "{value}");
}

/// A file or folder of this test run.
fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("command");
    std::fs::create_dir_all(&folder).expect("a folder for tests");
    folder.join(name)
}

fn refused(arguments: &[&str], code: i32, reason: &str) {
    let output = backstop(arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{errors}");
    assert!(errors.contains(reason), "{errors}");
    assert!(output.stdout.is_empty());
}
