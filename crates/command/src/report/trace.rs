//! The trace of a run: the report of each step, and statistics.

use crate::report::accuracy::Course;
use backstop::StepReport;
use backstop_lab::SolverReport;
use serde::Serialize;

/// One stage's time in a report [us].
pub(crate) type Stage = fn(&StepReport) -> f32;

/// The stages in their order.
pub(crate) const STAGES: [(&str, Stage); 5] = [
    ("broad", |r| r.times.broad),
    ("narrow", |r| r.times.narrow),
    ("prepare", |r| r.times.prepare),
    ("solve", |r| r.times.solve),
    ("finish", |r| r.times.finish),
];

/// Reports of all steps.
#[derive(Debug, Default)]
pub(crate) struct Trace {
    pub(crate) reports: Vec<StepReport>,
    /// Energy after each step [J]; only if it was asked for.
    pub(crate) energy: Vec<f64>,
    /// If it was asked for.
    pub(crate) accuracy: Option<Course>,
    /// If a method of the lab solved it.
    pub(crate) solver: Option<SolverSum>,
}

/// Totals of a method of the lab over a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct SolverSum {
    pub(crate) method: &'static str,
    /// Islands, summed over all steps; those that it solved, and why it left the others to the engine's own
    /// solver.
    pub(crate) islands: u64,
    pub(crate) solved: u64,
    pub(crate) too_large: u64,
    pub(crate) refused: u64,
    pub(crate) iterations: u64,
    pub(crate) pivots: u64,
    /// The greatest unit-free residual.
    pub(crate) worst_residual: f64,
}

impl SolverSum {
    pub(crate) fn add(&mut self, report: &SolverReport) {
        self.islands += report.islands as u64;
        self.solved += report.solved as u64;
        self.too_large += report.too_large as u64;
        self.refused += report.refused as u64;
        self.iterations += report.iterations;
        self.pivots += report.pivots;
        self.worst_residual = self.worst_residual.max(report.residual);
    }

    /// As text.
    pub(crate) fn text(&self) -> String {
        let Self { method, islands, solved, too_large, refused, iterations, pivots, worst_residual } = self;
        format!(
            "{method}: {solved} of {islands} islands, {too_large} too large, {refused} refused; \
             {iterations} iterations, {pivots} pivots, residual up to {worst_residual:.1e}"
        )
    }
}

/// Times of a stage over a run [us].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Times {
    pub(crate) median: f64,
    pub(crate) mean: f64,
    pub(crate) p95: f64,
    pub(crate) max: f64,
}

impl Times {
    pub(crate) fn of(values: impl Iterator<Item = f32>) -> Times {
        let mut sorted: Vec<f64> = values.map(f64::from).collect();
        if sorted.is_empty() {
            return Times::default();
        }
        let (median, n) = (median(&mut sorted), sorted.len());
        // The smallest value that at least this share of all does not exceed.
        let quantile = |share: f64| sorted[((share * n as f64).ceil() as usize).clamp(1, n) - 1];
        let mean = sorted.iter().sum::<f64>() / n as f64;
        Times { median, mean, p95: quantile(0.95), max: sorted[n - 1] }
    }
}

/// The median of at least one value; sorts them.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let n = values.len();
    0.5 * (values[(n - 1) / 2] + values[n / 2])
}

impl Trace {
    pub(crate) fn step_times(&self) -> Times {
        Times::of(self.reports.iter().map(|r| r.times.step))
    }

    pub(crate) fn stage_times(&self, stage: Stage) -> Times {
        Times::of(self.reports.iter().map(stage))
    }

    /// Sum of a count over all steps.
    pub(crate) fn total(&self, what: fn(&StepReport) -> u32) -> u64 {
        self.reports.iter().map(|r| u64::from(what(r))).sum()
    }

    pub(crate) fn last(&self) -> StepReport {
        self.reports.last().copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_that_occurred() {
        let times = Times::of((1..=100).rev().map(|i| i as f32));
        assert_eq!(times, Times { median: 50.5, mean: 50.5, p95: 95.0, max: 100.0 });
        assert_eq!(Times::of([3.0].into_iter()), Times { median: 3.0, mean: 3.0, p95: 3.0, max: 3.0 });
        assert_eq!(Times::of([].into_iter()), Times::default());
    }
}
