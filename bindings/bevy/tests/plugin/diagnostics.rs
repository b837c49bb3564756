//! Bevy's diagnostics (feature `diagnostics`).

use crate::common::*;
use backstop_bevy::prelude::*;
use bevy_diagnostic::{DiagnosticsPlugin, DiagnosticsStore};

/// Five balls in a heap. Expected: each step is measured; counts are the world's, times are above zero and
/// those of the stages are within that of the step; the text has a line for each.
#[test]
fn steps_are_measured() {
    let mut app = app();
    app.add_plugins((DiagnosticsPlugin, BackstopDiagnosticsPlugin));
    floor(&mut app);
    for i in 0..5 {
        ball(&mut app, 0.5 + 1.05 * i as f32);
    }
    run(&mut app, 60);
    type P = BackstopDiagnosticsPlugin;
    let store = app.world().resource::<DiagnosticsStore>();
    let value = |path| store.get(&path).and_then(|diagnostic| diagnostic.value()).expect("it is measured");
    assert_eq!(value(P::BODIES), 6.0);
    assert_eq!((value(P::JOINTS), value(P::SLEEPING)), (0.0, 0.0));
    assert_eq!(value(P::CONTACTS), f64::from(physics(&app).report().manifolds));
    assert_eq!(value(P::BYTES), physics(&app).memory().total() as f64);
    let stages = [P::BROAD, P::NARROW, P::PREPARE, P::SOLVE, P::FINISH].map(value);
    let step = value(P::STEP);
    assert!(step > 0.0 && stages.iter().sum::<f64>() <= 1.01 * step, "{stages:?} of {step}");
    assert!(store.get(&P::STEP).unwrap().history_len() >= 59);
    let text = P::text(store);
    assert!(text.lines().count() == 11 && text.contains("bodies: 6\n"), "{text}");
}
