//! Times, counts and bytes of the last step in Bevy's diagnostics (feature `diagnostics`), and as a text in a
//! corner of the window (feature `overlay`).

use crate::plugin::PhysicsSystems;
use crate::world::PhysicsWorld;
use bevy_app::prelude::*;
use bevy_diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, DiagnosticsStore, RegisterDiagnostic};
use bevy_ecs::prelude::*;

/// Measures each step in Bevy's `DiagnosticsStore`. Needs [`BackstopPlugin`](crate::BackstopPlugin) before
/// it, in `FixedPostUpdate`, and Bevy's `DiagnosticsPlugin`, or its `FrameCountPlugin` at least, which
/// `DefaultPlugins` has.
#[derive(Clone, Copy, Debug, Default)]
pub struct BackstopDiagnosticsPlugin;

/// What is measured: the path, what an overlay calls it, and its unit.
type Measure = (DiagnosticPath, &'static str, &'static str);

macro_rules! measures {
    ($($(#[$doc:meta])* $name:ident = $path:literal, $label:literal, $unit:literal;)*) => {
        impl BackstopDiagnosticsPlugin {
            $($(#[$doc])* pub const $name: DiagnosticPath = DiagnosticPath::const_new($path);)*

            const ALL: &'static [Measure] = &[$((Self::$name, $label, $unit)),*];
        }
    };
}

measures! {
    /// The whole step [ms].
    STEP = "physics/step", "step", " ms";
    /// Its forces, bounds and pairs [ms].
    BROAD = "physics/broad", "broad phase", " ms";
    /// Its contacts [ms].
    NARROW = "physics/narrow", "narrow phase", " ms";
    /// Its preparation of rows [ms].
    PREPARE = "physics/prepare", "prepare", " ms";
    /// Its solver [ms].
    SOLVE = "physics/solve", "solve", " ms";
    /// What it ends with [ms].
    FINISH = "physics/finish", "finish", " ms";
    /// Bodies of the world.
    BODIES = "physics/bodies", "bodies", "";
    /// Dynamic bodies that are asleep.
    SLEEPING = "physics/sleeping", "asleep", "";
    /// Joints of the world.
    JOINTS = "physics/joints", "joints", "";
    /// Manifolds of the last step: pairs of shapes that touch or are about to.
    CONTACTS = "physics/contacts", "contacts", "";
    /// Memory of the world.
    BYTES = "physics/bytes", "memory", " bytes";
}

impl Plugin for BackstopDiagnosticsPlugin {
    fn build(&self, app: &mut App) {
        for (path, _, unit) in Self::ALL {
            app.register_diagnostic(Diagnostic::new(path.clone()).with_suffix(*unit));
        }
        app.add_systems(FixedPostUpdate, measure.after(PhysicsSystems::Report));
    }
}

impl BackstopDiagnosticsPlugin {
    /// The latest measurements, one a line: what an overlay shows.
    pub fn text(store: &DiagnosticsStore) -> String {
        let mut text = String::new();
        for (path, label, unit) in Self::ALL {
            let Some(diagnostic) = store.get(path) else { continue };
            let Some(value) = diagnostic.smoothed().filter(|_| unit.contains("ms")).or(diagnostic.value())
            else {
                continue;
            };
            let digits = if unit.contains("ms") { 3 } else { 0 };
            text += &format!("{label}: {value:.digits$}{unit}\n");
        }
        text
    }
}

fn measure(physics: Option<Res<PhysicsWorld>>, mut diagnostics: Diagnostics) {
    let Some(physics) = physics else { return };
    type P = BackstopDiagnosticsPlugin;
    let report = physics.report();
    let times = &report.times;
    let stages = [
        (P::STEP, times.step),
        (P::BROAD, times.broad),
        (P::NARROW, times.narrow),
        (P::PREPARE, times.prepare),
        (P::SOLVE, times.solve),
        (P::FINISH, times.finish),
    ];
    for (path, time) in stages {
        // The engine tells microseconds.
        diagnostics.add_measurement(&path, || 1e-3 * f64::from(time));
    }
    diagnostics.add_measurement(&P::BODIES, || physics.body_count() as f64);
    diagnostics.add_measurement(&P::SLEEPING, || physics.sleeping_body_count() as f64);
    diagnostics.add_measurement(&P::JOINTS, || physics.joint_count() as f64);
    diagnostics.add_measurement(&P::CONTACTS, || f64::from(report.manifolds));
    diagnostics.add_measurement(&P::BYTES, || physics.memory().total() as f64);
}

/// Shows what [`BackstopDiagnosticsPlugin`] measures, which it adds if it is not there, as a text in the
/// upper left corner. Needs Bevy's `UiPlugin` and a renderer. Despawn the entity with [`PhysicsOverlay`], or
/// hide it, to have it gone.
#[cfg(feature = "overlay")]
#[derive(Clone, Copy, Debug, Default)]
pub struct BackstopOverlayPlugin;

/// The text of the overlay.
#[cfg(feature = "overlay")]
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct PhysicsOverlay;

#[cfg(feature = "overlay")]
impl Plugin for BackstopOverlayPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<BackstopDiagnosticsPlugin>() {
            app.add_plugins(BackstopDiagnosticsPlugin);
        }
        app.add_systems(Startup, spawn_overlay).add_systems(Update, write_overlay);
    }
}

#[cfg(feature = "overlay")]
fn spawn_overlay(mut commands: Commands) {
    use bevy_ui::prelude::*;
    let corner = Node {
        position_type: PositionType::Absolute,
        top: Val::Px(8.0),
        left: Val::Px(8.0),
        ..Node::default()
    };
    commands.spawn((PhysicsOverlay, Text::default(), corner));
}

#[cfg(feature = "overlay")]
fn write_overlay(
    store: Res<DiagnosticsStore>,
    mut texts: Query<&mut bevy_ui::prelude::Text, With<PhysicsOverlay>>,
) {
    for mut text in &mut texts {
        let new = BackstopDiagnosticsPlugin::text(&store);
        if text.0 != new {
            text.0 = new;
        }
    }
}
