//! A table per scene, for a person.

use super::{Comparison, MethodResult, SceneResult};
use crate::report::output::{bytes, micros};
use crate::report::table::table;
use std::fmt::Write;

pub(crate) const HEAD: [&str; 13] = [
    "method",
    "median",
    "mean",
    "p95",
    "worst",
    "bytes",
    "continuous",
    "tunnelled",
    "ghosts",
    "energy lost",
    "off by",
    "distance",
    "joints open",
];

pub(crate) fn text(comparison: &Comparison) -> String {
    let mut text = String::new();
    for scene in &comparison.scenes {
        let impacts = scene.methods.first().map_or(0, |method| method.verdict.impacts);
        let _ = writeln!(text, "{}: {} steps, {impacts} first impacts", scene.scene, scene.steps);
        text += &table(&HEAD, 1, rows(scene));
        text.push('\n');
    }
    text
}

/// The cells of a scene's table, method by method.
pub(crate) fn rows(scene: &SceneResult) -> Vec<Vec<String>> {
    let row = |method: &MethodResult| {
        let (v, t) = (&method.verdict, &method.time_us);
        vec![
            method.name.to_owned(),
            micros(t.median),
            micros(t.mean),
            micros(t.p95),
            micros(t.max),
            bytes(v.bytes),
            bytes(v.continuous_bytes),
            v.tunnelled.to_string(),
            v.ghosts.to_string(),
            format!("{:.1}%", 100.0 * v.energy_lost),
            format!("{:.1}%", 100.0 * v.energy_error),
            metres(v.distance_lost),
            metres(v.joint_opening),
        ]
    };
    scene.methods.iter().map(row).collect()
}

/// A length in a suitable unit.
fn metres(m: f64) -> String {
    match m {
        m if m < 1e-3 => format!("{:.2} mm", 1e3 * m),
        m if m < 1.0 => format!("{:.1} mm", 1e3 * m),
        m => format!("{m:.2} m"),
    }
}
