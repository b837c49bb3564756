//! Which program runs which engine: this one if it can, else one that is built for it.

use crate::engines;
use crate::run::Outcome;
use anyhow::{Context, bail, ensure};
use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Programs by engine.
pub(crate) struct Programs {
    programs: BTreeMap<String, PathBuf>,
    /// How long a run may take.
    patience: Duration,
}

impl Programs {
    /// Finds or builds the programs of these engines; `given`: `ENGINE=PATH`.
    pub(crate) fn new(engines: &[String], given: &[String], patience: u64) -> anyhow::Result<Programs> {
        let mut programs = BTreeMap::new();
        for pair in given {
            let (engine, path) = pair.split_once('=').context("--program is ENGINE=PATH")?;
            programs.insert(engine.to_owned(), PathBuf::from(path));
        }
        let own = std::env::current_exe().context("this program has no path")?;
        for engine in engines {
            if programs.contains_key(engine) {
                continue;
            }
            let path = match engines::find(engine) {
                Some(_) => own.clone(),
                None => build(engine, &own)?,
            };
            programs.insert(engine.clone(), path);
        }
        Ok(Programs { programs, patience: Duration::from_secs(patience) })
    }

    /// Runs an engine on a scene, in a process of its own: it may crash or never come back.
    pub(crate) fn run(&self, engine: &str, scene: &str, options: &[String]) -> anyhow::Result<Outcome> {
        let program = self.programs.get(engine).context("no program for this engine")?;
        let mut child = Command::new(program)
            .args(["run", engine, scene])
            .args(options)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .with_context(|| format!("can't start {}", program.display()))?;
        let start = Instant::now();
        while child.try_wait()?.is_none() {
            if start.elapsed() > self.patience {
                child.kill()?;
                child.wait()?;
                bail!("not done after {} s", self.patience.as_secs());
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        let (mut out, mut error) = (String::new(), String::new());
        child.stdout.take().context("no output")?.read_to_string(&mut out)?;
        child.stderr.take().context("no output")?.read_to_string(&mut error)?;
        let line = out.lines().last().unwrap_or_default();
        let reason = error.lines().last().unwrap_or("crashed").to_owned();
        serde_json::from_str(line).with_context(|| reason)
    }
}

/// Builds the program that has an engine which this one lacks, beside it.
fn build(engine: &str, own: &Path) -> anyhow::Result<PathBuf> {
    let known = engines::FEATURES.iter().find(|(name, _)| *name == engine);
    let (_, feature) = known.with_context(|| format!("no engine \"{engine}\""))?;
    // The program is in `release` of the folder that cargo builds in.
    let target = own.ancestors().nth(2).context("this program is in no target folder")?;
    let folder = target.join("peers-others");
    eprintln!("building {engine} in {}", folder.display());
    let status = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(["build", "--release", "--quiet", "--no-default-features", "--features", feature])
        .args(["--manifest-path", concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml")])
        .arg("--target-dir")
        .arg(&folder)
        .status()
        .context("can't start cargo")?;
    ensure!(status.success(), "{engine} does not build");
    // The next one is built in the same folder, which has compiled most of it.
    let (built, kept) = (folder.join("release/peers"), folder.join(format!("peers-{feature}")));
    std::fs::copy(&built, &kept).with_context(|| format!("can't copy {}", built.display()))?;
    Ok(kept)
}
