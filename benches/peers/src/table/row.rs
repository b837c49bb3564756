//! A row of a record: results of an engine on a scene with a number of threads.

use crate::judge::Figures;
use crate::run::Outcome;

/// Time of a peer for an error no larger than backstop's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Equal {
    /// So many times its default number of substeps, at this time of a step [ms] and against backstop's.
    At { effort: u32, mean_ms: f64, ratio: f64 },
    /// More than was tried.
    None,
}

/// Results of an engine on a scene.
#[derive(Clone, Debug, Default)]
pub(crate) struct Row {
    pub(crate) scene: String,
    pub(crate) engine: String,
    pub(crate) threads: usize,
    /// A run for each round; none where the engine refused or crashed.
    pub(crate) timed: Vec<Option<Outcome>>,
    /// The run that was judged.
    pub(crate) judged: Option<Outcome>,
    /// A minute of a standing structure.
    pub(crate) minute: Option<Outcome>,
    /// The run with sleeping on.
    pub(crate) slept: Option<Outcome>,
    pub(crate) equal: Option<Equal>,
    /// Why there is nothing.
    pub(crate) failed: Option<String>,
}

impl Row {
    /// The median over the rounds.
    pub(crate) fn median(&self, of: impl Fn(&Outcome) -> f64) -> Option<f64> {
        median(self.timed.iter().flatten().map(of).collect())
    }

    /// The median over the rounds of a figure of this row against that of the base in the same round: both
    /// ran one after the other.
    pub(crate) fn ratio(&self, base: &Row, of: impl Fn(&Outcome) -> f64) -> Option<f64> {
        let rounds = self.timed.iter().zip(&base.timed);
        median(rounds.filter_map(|(own, base)| Some(of(own.as_ref()?) / of(base.as_ref()?))).collect())
    }

    /// Figures of the judged run, with those of the minute.
    pub(crate) fn figures(&self) -> Figures {
        let mut figures = self.judged.as_ref().map(|run| run.figures.clone()).unwrap_or_default();
        if let Some(minute) = &self.minute {
            (figures.top_60, figures.drift_60) = (minute.figures.top_60, minute.figures.drift_60);
        }
        figures
    }

    /// Growth of the resident set for each dynamic body [B].
    pub(crate) fn bytes_per_body(&self) -> Option<f64> {
        self.median(|run| run.grown_kib.unwrap_or_default() as f64 * 1024.0 / run.bodies.max(1) as f64)
    }

    fn any(&self) -> Option<&Outcome> {
        self.timed.iter().flatten().next().or(self.judged.as_ref())
    }
}

/// The middle of some numbers, or the mean of the two in the middle.
pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let (low, high) = (values.get(values.len().checked_sub(1)? / 2)?, values.get(values.len() / 2)?);
    Some(0.5 * (low + high))
}

/// Names of the columns.
pub(crate) const COLUMNS: &str = "scene,bodies,threads,engine,version,steps,rounds,\
mean_ms,median_ms,p95_ms,max_ms,ratio_mean,ratio_median,ratio_p95,build_ms,bytes_per_body,peak_mib,\
top_3s_m,drift_3s_m,top_60s_m,drift_60s_m,depth_m,depth_mean_m,joint_worst_m,joint_m,\
energy_start_j,energy_j,energy_gain_j,weight_n,lost,asleep_after_s,asleep,equal_effort,equal_ms,equal_ratio,hash,failed";

/// The row as a line of CSV; `base`: backstop's of the same scene and threads.
pub(crate) fn line(row: &Row, base: &Row) -> String {
    let number = |value: Option<f64>| value.map(|value| format!("{value:.6}")).unwrap_or_default();
    // What may be tiny or huge.
    let short = |value: Option<f64>| value.map(|value| format!("{value:.5e}")).unwrap_or_default();
    let count = |value: Option<usize>| value.map(|value| value.to_string()).unwrap_or_default();
    let (any, figures) = (row.any(), row.figures());
    let (effort, equal_ms, equal_ratio) = match row.equal {
        Some(Equal::At { effort, mean_ms, ratio }) => {
            (effort.to_string(), number(Some(mean_ms)), number(Some(ratio)))
        }
        Some(Equal::None) => ("none".into(), String::new(), String::new()),
        None => Default::default(),
    };
    let slept = row.slept.as_ref();
    let fields = [
        row.scene.clone(),
        count(any.map(|run| run.bodies)),
        row.threads.to_string(),
        row.engine.clone(),
        any.map(|run| run.version.replace(',', ";")).unwrap_or_default(),
        count(any.map(|run| run.steps as usize)),
        row.timed.iter().flatten().count().to_string(),
        number(row.median(|run| run.ms.mean)),
        number(row.median(|run| run.ms.median)),
        number(row.median(|run| run.ms.p95)),
        number(row.median(|run| run.ms.max)),
        number(row.ratio(base, |run| run.ms.mean)),
        number(row.ratio(base, |run| run.ms.median)),
        number(row.ratio(base, |run| run.ms.p95)),
        number(row.median(|run| run.build_ms)),
        row.bytes_per_body().map(|bytes| format!("{bytes:.0}")).unwrap_or_default(),
        number(row.median(|run| run.peak_kib.unwrap_or_default() as f64 / 1024.0)),
        short(figures.top_3),
        short(figures.drift_3),
        short(figures.top_60),
        short(figures.drift_60),
        short(figures.depth),
        short(figures.depth_mean),
        short(figures.joint_worst),
        short(figures.joint),
        short(figures.energy_start),
        short(figures.energy),
        short(figures.energy_gain),
        short(figures.weight),
        count(figures.lost),
        number(slept.and_then(|run| run.asleep_after)),
        count(slept.map(|run| run.asleep)),
        effort,
        equal_ms,
        equal_ratio,
        figures.hash,
        row.failed.as_deref().unwrap_or_default().replace([',', '\n', '"'], " "),
    ];
    fields.join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_as_many_fields_as_there_are_columns() {
        let row = Row { failed: Some("no, \"not\" this\none".into()), ..Row::default() };
        let count = |line: &str| line.split(',').count();
        assert_eq!(count(&line(&row, &row)), count(COLUMNS));
        assert_eq!(line(&row, &row).lines().count(), 1);
    }

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), Some(2.5));
        assert_eq!(median(Vec::new()), None);
    }
}
