//! Tests of the charts.

use super::*;
use backstop::StepReport;

#[test]
fn long_and_short_runs_are_drawn() {
    for steps in [1, 7, 5000] {
        let reports = vec![StepReport::default(); steps];
        let trace = Trace { energy: vec![1.0; steps], reports, accuracy: None, solver: None };
        for text in [
            svg(|a| times(a, &trace)).unwrap(),
            svg(|a| contacts(a, &trace)).unwrap(),
            svg(|a| energy(a, &trace, 0.01)).unwrap(),
        ] {
            assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>") && !text.contains("NaN"));
        }
    }
}

#[test]
fn columns_cover_every_step_once() {
    let columns = Columns::of(1000);
    let covered: Vec<usize> = columns.map(|r| r).flat_map(|(_, r)| r).collect();
    assert_eq!(covered, (0..1000).collect::<Vec<_>>());
}
