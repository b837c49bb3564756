//! Files of results: a header that describes the sweep, then a line of JSON for each measurement.

use crate::json_lines;
use anyhow::{Context, bail};
use backstop_lab::trade::{Errors, Grid, Measure};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fs::File;
use std::path::Path;

/// How lines of results begin.
pub(super) const STARTS: [&str; 2] = ["{\"trade\":", "{\"cell\":"];
/// Version of the format.
pub(super) const FORMAT: u32 = 3;

/// Identifies a sweep: results belong together if all of it is equal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Header {
    /// [`FORMAT`].
    pub(super) trade: u32,
    /// Version of backstop.
    pub(super) version: String,
    pub(super) scene: String,
    pub(super) frame_rate: u32,
    pub(super) frames: u32,
    pub(super) reference_hz: u32,
    /// Tells versions of the scene and of the engine apart.
    pub(super) reference_hash: String,
    /// The share of the run in which paths are compared.
    pub(super) share: f64,
    pub(super) uncertainty: Figures,
    /// None if a single file of settings was measured.
    pub(super) grid: Option<Grid>,
    pub(super) settings: Option<Map<String, Value>>,
}

impl Header {
    pub(super) fn seconds(&self) -> f64 {
        f64::from(self.frames) / f64::from(self.frame_rate)
    }

    /// Refuses results of another sweep, and tells the difference.
    pub(super) fn expect(&self, other: &Header) -> anyhow::Result<()> {
        let (own, other) = (serde_json::to_value(self)?, serde_json::to_value(other)?);
        let (Value::Object(own), Value::Object(other)) = (own, other) else { return Ok(()) };
        let differs = |(name, value): &(&String, &Value)| other.get(*name) != Some(value);
        // First the fields that explain other differences.
        let first = ["scene", "version", "grid"].into_iter().filter_map(|name| own.get_key_value(name));
        match first.chain(&own).find(differs) {
            Some((name, value)) => {
                let found = other.get(name).unwrap_or(&Value::Null);
                bail!("it is of another sweep: its {} is {found}, not {value}", name.replace('_', " "))
            }
            None => Ok(()),
        }
    }
}

/// [`Errors`] as a file has them: JSON has no infinity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub(super) struct Figures(BTreeMap<Measure, Option<f64>>);

impl Figures {
    /// Infinite if there is none.
    pub(super) fn of(&self, measure: Measure) -> f64 {
        self.0.get(&measure).copied().flatten().unwrap_or(f64::INFINITY)
    }
}

impl From<&Errors> for Figures {
    fn from(errors: &Errors) -> Figures {
        let of = |measure| (measure, Some(errors.of(measure)).filter(|error| error.is_finite()));
        Figures(Measure::ALL.into_iter().map(of).collect())
    }
}

/// The errors of a cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Measured {
    pub(super) cell: usize,
    pub(super) errors: Figures,
}

/// The time of a cell in a round, and that of the default setting beside it [us for 1/60 s].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Timed {
    pub(super) cell: usize,
    pub(super) round: u32,
    pub(super) us: f64,
    pub(super) default_us: f64,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(untagged)]
pub(super) enum Line {
    Header(Box<Header>),
    Measured(Measured),
    Timed(Timed),
}

/// The results of a sweep so far.
#[derive(Clone, Debug)]
pub(super) struct Results {
    pub(super) measured: Vec<Option<Figures>>,
    /// By cells, then rounds.
    pub(super) timed: Vec<Vec<Timed>>,
}

impl Results {
    pub(super) fn none(cells: usize) -> Results {
        Results { measured: vec![None; cells], timed: vec![Vec::new(); cells] }
    }

    /// Takes a line; the same cell measured twice must have the same errors.
    pub(super) fn take(&mut self, line: Line) -> anyhow::Result<()> {
        match line {
            Line::Header(_) => {}
            Line::Measured(Measured { cell, errors }) => {
                let known =
                    self.measured.get_mut(cell).with_context(|| format!("there is no cell {cell}"))?;
                if known.as_ref().is_some_and(|known| *known != errors) {
                    bail!("cell {cell} has other errors than before: results are of different programs");
                }
                *known = Some(errors);
            }
            Line::Timed(timed) => {
                let cell = timed.cell;
                let known = self.timed.get_mut(cell).with_context(|| format!("there is no cell {cell}"))?;
                known.push(timed);
            }
        }
        Ok(())
    }
}

/// A file that was read.
pub(super) struct Read {
    /// None if the file is empty.
    pub(super) header: Option<Header>,
    /// All others.
    pub(super) lines: Vec<Line>,
}

/// Reads a file. An incomplete last line is left out.
pub(super) fn read(file: &Path) -> anyhow::Result<Read> {
    let about = || format!("can't read {}", file.display());
    let text = json_lines::read(file).with_context(about)?;
    let (mut header, mut lines) = (None, Vec::new());
    for (number, line) in json_lines::whole(&text).split_inclusive(|&byte| byte == b'\n').enumerate() {
        let line: Line = serde_json::from_slice(line)
            .with_context(|| format!("line {} is no result of a trade", number + 1))
            .with_context(about)?;
        match line {
            Line::Header(found) if number == 0 && found.trade == FORMAT => header = Some(*found),
            Line::Header(found) if number == 0 => {
                bail!("{}: it is of format {}, not {FORMAT}", about(), found.trade)
            }
            _ if number == 0 => bail!("{}: it has no header", about()),
            line => lines.push(line),
        }
    }
    Ok(Read { header, lines })
}

/// Writes results as they come.
#[derive(Debug)]
pub(super) enum Sink {
    File(File),
    Stdout,
}

impl Sink {
    /// Writes a line at once, so that it is written whole or not at all.
    pub(super) fn put(&mut self, line: &Line) -> anyhow::Result<()> {
        match self {
            Sink::File(file) => json_lines::put(file, line),
            Sink::Stdout => json_lines::put(&mut std::io::stdout().lock(), line),
        }
    }
}
