//! Machine and programs of a record.

use std::process::{Command, Stdio};

/// Names and values, in the order in which records have them.
pub(crate) fn facts() -> Vec<(&'static str, String)> {
    let cores = std::thread::available_parallelism().map(|n| n.get().to_string());
    let flags = |name: &str| std::env::var(name).unwrap_or_default();
    vec![
        ("date", said("date", &["-u", "+%Y-%m-%d %H:%M UTC"])),
        ("commit", commit()),
        ("cpu", cpu()),
        ("cores", cores.unwrap_or_else(|_| "unknown".into())),
        ("system", said("uname", &["-srm"])),
        ("rustc", said("rustc", &["--version"])),
        ("rustflags", format!("{:?}", env!("PEERS_RUSTFLAGS"))),
        ("profile", env!("PEERS_PROFILE").into()),
        ("cc", said("cc", &["--version"])),
        ("c++", said("c++", &["--version"])),
        ("cflags", format!("CFLAGS={:?} CXXFLAGS={:?}", flags("CFLAGS"), flags("CXXFLAGS"))),
        ("load", std::fs::read_to_string("/proc/loadavg").unwrap_or_default().trim().into()),
    ]
}

/// The first line that a program writes.
fn said(program: &str, args: &[&str]) -> String {
    let output = Command::new(program).args(args).output();
    let text = output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    text.ok().and_then(|text| text.lines().next().map(str::to_owned)).unwrap_or_else(|| "unknown".into())
}

/// The commit of backstop, and whether its sources differ from it.
fn commit() -> String {
    let here = env!("CARGO_MANIFEST_DIR");
    let head = said("git", &["-C", here, "rev-parse", "HEAD"]);
    let changed = Command::new("git")
        .args(["-C", here, "diff", "--quiet", "HEAD", "--", "../../src", "../../crates", "."])
        .stderr(Stdio::null())
        .stdout(Stdio::null())
        .status();
    match changed.map(|status| status.success()) {
        Ok(true) => head,
        _ => format!("{head} and changes"),
    }
}

fn cpu() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    model.map_or_else(|| "unknown".into(), |(_, model)| model.trim().into())
}
