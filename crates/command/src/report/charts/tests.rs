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

/// 400 steps of 10 µs, of which four, that is 1 %, took 1 ms. Expected: the axis suits the others, and four
/// are marked.
#[test]
fn what_is_beyond_the_99th_percentile_is_cut_off_marked_and_counted() {
    let mut reports = vec![StepReport::default(); 400];
    for (i, report) in reports.iter_mut().enumerate() {
        report.times.solve = if i % 100 == 50 { 1000.0 } else { 10.0 };
    }
    let heights: Vec<f64> = reports.iter().map(|report| f64::from(report.times.solve)).collect();
    assert_eq!(clipped_at(&heights), 10.0);
    let trace = Trace { energy: Vec::new(), reports, accuracy: None, solver: None };
    let text = svg(|area| times(area, &trace)).unwrap();
    assert!(text.contains("4 columns beyond 10.0 µs"), "{text}");
    assert_eq!(clipped_at(&[]), 1e-3);
}
