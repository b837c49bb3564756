//! Files of results: a line of JSON for each cell, of any engine.

use crate::json_lines;
use anyhow::Context;
use backstop_lab::envelope::{Figure, Verdict};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// How lines of results begin.
pub(crate) const STARTS: [&str; 1] = ["{\"engine\":"];
/// The name of this engine.
pub(crate) const OURS: &str = "backstop";

/// A cell that was run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Run {
    pub(crate) engine: String,
    /// Tells builds of the program apart; zero if it does not matter.
    #[serde(default)]
    pub(crate) build: u32,
    /// Simulated time [s].
    pub(crate) seconds: f32,
    pub(crate) cell: String,
    /// The worst first.
    pub(crate) figures: Vec<Value>,
}

/// [`Figure`] as a file has it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Value {
    pub(crate) measure: String,
    /// JSON has no infinity.
    pub(crate) value: Option<f64>,
    pub(crate) verdict: Verdict,
}

impl From<Figure> for Value {
    fn from(figure: Figure) -> Self {
        let value = Some(figure.value).filter(|value| value.is_finite());
        Value { measure: figure.measure.into(), value, verdict: figure.verdict }
    }
}

impl Value {
    /// The measure and its value.
    pub(crate) fn text(&self) -> String {
        match self.value {
            Some(value) if self.measure == "through" => format!("{value} through"),
            Some(_) if self.measure == "finite" => "not finite".into(),
            Some(value) => format!("{} {value:.1e}", self.measure),
            // A value of another engine, or an infinite one.
            None => self.measure.clone(),
        }
    }
}

/// The results of one engine.
#[derive(Clone, Debug, Default)]
pub(crate) struct Results {
    pub(crate) engine: String,
    pub(crate) runs: Vec<Run>,
}

impl Results {
    /// Reads a file. An incomplete last line is left out.
    pub(crate) fn read(file: &Path) -> anyhow::Result<Results> {
        let about = || format!("can't read {}", file.display());
        let text = json_lines::read(file).with_context(about)?;
        let mut results = Results::default();
        for (number, line) in json_lines::whole(&text).split_inclusive(|&byte| byte == b'\n').enumerate() {
            let run: Run = serde_json::from_slice(line)
                .with_context(|| format!("line {} is no result", number + 1))
                .with_context(about)?;
            results.engine.clone_from(&run.engine);
            results.runs.push(run);
        }
        Ok(results)
    }

    /// The runs of one build with this simulated time.
    pub(crate) fn of_build(self, build: u32, seconds: f32) -> Vec<Run> {
        self.runs.into_iter().filter(|run| run.build == build && run.seconds == seconds).collect()
    }

    /// The worst figure of the last run of a cell.
    pub(crate) fn worst(&self, cell: &str) -> Option<&Value> {
        self.runs.iter().rev().find(|run| run.cell == cell)?.figures.first()
    }

    /// The verdict of that figure.
    pub(crate) fn verdict(&self, cell: &str) -> Option<Verdict> {
        self.worst(cell).map(|figure| figure.verdict)
    }
}

/// A checksum of this program.
pub(crate) fn build_number() -> anyhow::Result<u32> {
    let about = "can't read the program itself";
    let path = std::env::current_exe().context(about)?;
    Ok(crc32fast::hash(&std::fs::read(path).context(about)?))
}
