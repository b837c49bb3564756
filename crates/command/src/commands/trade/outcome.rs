//! The outcome of a sweep: `--json` prints it, docs/json.md explains its fields.

use super::lines::{Figures, Header, Results, Timed};
use super::options::TradeOptions;
use super::sweep::Candidate;
use crate::settings_file;
use anyhow::{Context, bail};
use backstop_lab::trade::{Axis, Cell, Measure, best_within, cheapest_within, front};
use serde::Serialize;
use serde_json::{Map, Value};
use std::collections::BTreeMap;

#[derive(Debug, Serialize)]
pub(super) struct Outcome {
    #[serde(flatten)]
    pub(super) header: Header,
    pub(super) seconds: f64,
    pub(super) error: Measure,
    pub(super) unit: &'static str,
    /// The error of the reference [unit].
    pub(super) certain_to: f64,
    /// The greatest value of each condition.
    pub(super) limits: BTreeMap<Measure, f64>,
    /// What the reader is told first, if paths are compared for less than half of the run.
    pub(super) warning: Option<String>,
    pub(super) default: Row,
    /// Of the settings that keep all conditions.
    pub(super) front: Vec<Row>,
    /// Those that would be on the front if there were no conditions.
    pub(super) excluded: Vec<Row>,
    pub(super) picked: Option<Row>,
    /// The rule by which it was picked, in words.
    pub(super) rule: String,
    pub(super) axes: Vec<AxisValue>,
    pub(super) cells: Vec<Row>,
}

/// A setting and its results.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    pub(super) cell: usize,
    pub(super) name: String,
    pub(super) settings: Map<String, Value>,
    /// Time for 1/60 s [us]; none if it was not timed, because its run was not finite.
    pub(super) cost_us: Option<f64>,
    /// Relative to the default setting.
    pub(super) cost_ratio: Option<f64>,
    pub(super) error: Option<f64>,
    /// Whether the error is above that of the reference itself.
    pub(super) certain: bool,
    pub(super) errors: Figures,
    /// The conditions that it breaks.
    pub(super) breaks: Vec<Measure>,
    #[serde(skip)]
    pub(super) axes: Vec<String>,
}

/// The best results of settings with one value of an axis.
#[derive(Clone, Debug, Serialize)]
pub(super) struct AxisValue {
    #[serde(serialize_with = "axis_name")]
    pub(super) axis: Axis,
    pub(super) value: String,
    /// How many settings of the front have it.
    pub(super) on_front: usize,
    /// The least error of any setting that has it.
    pub(super) least_error: Option<f64>,
    /// Relative cost of the cheapest setting that is as accurate as the picked one.
    pub(super) cheapest_ratio: Option<f64>,
}

fn axis_name<S: serde::Serializer>(axis: &Axis, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(axis.name())
}

impl Row {
    fn cost(&self) -> f64 {
        self.cost_ratio.unwrap_or(f64::INFINITY)
    }

    fn error(&self) -> f64 {
        self.error.unwrap_or(f64::INFINITY)
    }
}

impl Outcome {
    /// The outcome of a complete sweep.
    pub(super) fn new(
        options: &TradeOptions,
        header: Header,
        candidates: &[Candidate],
        results: &Results,
    ) -> anyhow::Result<Outcome> {
        let measure = options.error;
        let certain_to = header.uncertainty.of(measure);
        let default_us = median(results.timed.iter().flatten().map(|timed| timed.default_us).collect());
        let mut cells = Vec::with_capacity(candidates.len());
        let mut missing = Vec::new();
        let limits = options.conditions.limits().all(|measure| header.uncertainty.of(measure));
        for (cell, candidate) in candidates.iter().enumerate() {
            match &results.measured[cell] {
                Some(errors) => {
                    let mut row = row(cell, candidate, errors, &results.timed[cell], default_us)?;
                    row.error = Some(errors.of(measure)).filter(|error| error.is_finite());
                    row.certain = row.error.is_some_and(|error| error > certain_to);
                    row.breaks =
                        limits.iter().filter(|(of, most)| errors.of(*of) > *most).map(|l| l.0).collect();
                    cells.push(row);
                }
                None => missing.push(cell),
            }
        }
        if let Some(first) = missing.first() {
            bail!("{} of {} cells are missing, {first} the first of them", missing.len(), candidates.len());
        }
        // Errors below that of the reference count as equal.
        let every: Vec<[f64; 2]> =
            cells.iter().map(|row| [row.cost(), row.error().max(certain_to)]).collect();
        // A setting that breaks a condition is on no front and is not picked: its error is infinite.
        let keeps = |points: Vec<[f64; 2]>| -> Vec<[f64; 2]> {
            let kept = |([cost, error], row): ([f64; 2], &Row)| {
                [cost, if row.breaks.is_empty() { error } else { f64::INFINITY }]
            };
            points.into_iter().zip(&cells).map(kept).collect()
        };
        let points = keeps(every.clone());
        let raw = keeps(cells.iter().map(|row| [row.cost(), row.error()]).collect());
        let on_front = front(&points);
        let warning = warning(header.share, measure);
        let (picked, rule) = match (options.max_error, options.budget_us, default_us) {
            (Some(most), ..) => {
                let rule = format!("the cheapest with an error of {most} {} at most", measure.unit());
                // What the error says nothing about can't be within it.
                (if warning.is_some() { None } else { cheapest_within(&raw, most) }, rule)
            }
            (None, Some(budget), Some(us)) => {
                (best_within(&points, budget / us), format!("the most accurate within {budget} us"))
            }
            (None, Some(_), None) => (None, "nothing was timed".into()),
            (None, None, _) => (
                cheapest_within(&points, every[0][1]),
                "the cheapest that is as accurate as the default".into(),
            ),
        };
        let bound = picked.map_or(every[0][1], |picked| raw[picked][1].max(certain_to));
        let axes = axes(&cells, &points, &on_front, bound);
        let row = |cell: usize| cells[cell].clone();
        let excluded = front(&every).into_iter().filter(|&cell| !cells[cell].breaks.is_empty());
        Ok(Outcome {
            seconds: header.seconds(),
            header,
            error: measure,
            unit: measure.unit(),
            certain_to,
            limits: limits.into_iter().collect(),
            warning,
            default: row(0),
            excluded: excluded.map(row).collect(),
            front: on_front.into_iter().map(row).collect(),
            picked: picked.map(row),
            rule,
            axes,
            cells,
        })
    }

    /// Why nothing was picked.
    pub(super) fn expect_pick(&self, max_error: bool) -> anyhow::Result<&Row> {
        if let Some(warning) = self.warning.as_ref().filter(|_| max_error) {
            bail!("no setting is {}: {warning}", self.rule);
        }
        let best = self.front.last().map_or_else(
            || "; none keeps all conditions: finer ones may, or other limits are needed".into(),
            |best| format!("; the most accurate has {:.3e} {} ({})", best.error(), self.unit, best.name),
        );
        let cheapest = self.front.first().and_then(|first| first.cost_us);
        let cheapest = cheapest.map_or(String::new(), |us| format!(", the cheapest takes {us:.1} us"));
        self.picked.as_ref().with_context(|| format!("no setting is {}{best}{cheapest}", self.rule))
    }
}

/// The share of the run of which paths have to be compared, for their errors to say something about it.
const ENOUGH: f64 = 0.5;

/// What to say if paths tell too little.
fn warning(share: f64, measure: Measure) -> Option<String> {
    (share < ENOUGH && measure.of_paths()).then(|| {
        format!(
            "paths can be compared for {:.0} % of the run only, so errors of {} say nothing about most of \
             it: judge it by --error heap, or take fewer --seconds",
            100.0 * share,
            measure.name()
        )
    })
}

fn row(
    cell: usize,
    candidate: &Candidate,
    errors: &Figures,
    timed: &[Timed],
    default_us: Option<f64>,
) -> anyhow::Result<Row> {
    let ratio = median(timed.iter().map(|timed| timed.us / timed.default_us).collect());
    let axes = |cell: &Cell| Axis::ALL.map(|axis| axis.value(cell)).to_vec();
    Ok(Row {
        cell,
        name: candidate.name.clone(),
        settings: settings_file::fields(candidate.hz, &candidate.settings, candidate.solver)?,
        cost_us: ratio.zip(default_us).map(|(ratio, us)| ratio * us),
        cost_ratio: ratio,
        error: None,
        certain: false,
        errors: errors.clone(),
        breaks: Vec::new(),
        axes: candidate.cell.as_ref().map_or(Vec::new(), axes),
    })
}

/// Each value of each axis that has several.
fn axes(cells: &[Row], points: &[[f64; 2]], on_front: &[usize], bound: f64) -> Vec<AxisValue> {
    let mut found = Vec::new();
    for (at, axis) in Axis::ALL.into_iter().enumerate() {
        let mut values: Vec<&str> = Vec::new();
        // In the order of the grid, which the default, the first cell, is put in front of.
        for value in cells[1..].iter().chain(&cells[..1]).filter_map(|row| row.axes.get(at)) {
            if !values.contains(&value.as_str()) {
                values.push(value);
            }
        }
        for value in values.iter().filter(|_| values.len() > 1) {
            let has = |i: usize| cells[i].axes.get(at).is_some_and(|own| own == value);
            let own: Vec<[f64; 2]> = (0..cells.len()).filter(|&i| has(i)).map(|i| points[i]).collect();
            let least = own.iter().map(|point| point[1]).fold(f64::INFINITY, f64::min);
            found.push(AxisValue {
                axis,
                value: (*value).into(),
                on_front: on_front.iter().filter(|&&i| has(i)).count(),
                least_error: Some(least).filter(|least| least.is_finite()),
                cheapest_ratio: cheapest_within(&own, bound).map(|i| own[i][0]),
            });
        }
    }
    found
}

/// The median; none if there are no values. For an even number, the mean of the middle two.
pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    let upper = *values.get(middle)?;
    Some(if values.len() % 2 == 1 { upper } else { 0.5 * (values[middle - 1] + upper) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(vec![]), None);
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![4.0, 1.0]), Some(2.5));
    }
}
