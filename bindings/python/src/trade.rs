//! Speed against accuracy, measured over a grid of settings.

use crate::convert::{aside, description, plain, refused};
use crate::scene::Scene;
use backstop::Error;
use backstop_lab::trade::{Cell, Errors, Grid, Measure, Reference, Span, Track, cost};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// A setting, its errors, and its cost [us].
type Row = (Cell, Errors, f64);

/// All cells of a grid on a scene.
fn measure(
    scene: &backstop_scene::Scene,
    grid: &Grid,
    (seconds, reference_hz): (f64, u32),
) -> Result<Vec<Row>, Error> {
    let frame_rate = grid.frame_rate()?;
    let frames = (seconds * f64::from(frame_rate)).round().clamp(1.0, f64::from(u32::MAX)) as u32;
    let span = Span { frame_rate, frames };
    let members = (0..Track::MEMBERS).map(|member| Track::member(scene, span, reference_hz, member));
    let reference = Reference::new(members.collect::<Result<_, _>>()?)?;
    let mut rows = Vec::new();
    for cell in grid.cells() {
        let settings = cell.settings(scene);
        let errors = reference.measure(scene, &settings, cell.world_solver(), cell.hz)?;
        let cost = cost(scene, &settings, cell.world_solver(), cell.hz, span)?;
        rows.push((cell, errors, cost));
    }
    Ok(rows)
}

fn named(py: Python<'_>, errors: &Errors) -> PyResult<Py<PyDict>> {
    let named = PyDict::new(py);
    for measure in Measure::ALL {
        named.set_item(measure.name(), errors.of(measure))?;
    }
    Ok(named.unbind())
}

/// Runs a scene with all combinations of settings and compares each run with a finely resolved one. Returns a
/// dictionary for each: the setting, `errors` by name, and `cost_us`, the time of a simulated sixtieth of a
/// second [us]. Axes of the grid, such as `hz`, `substeps`, `iterations` and `friction`, are lists; those
/// left out are those of the quick grid of the command. `reference_hz` and its half are multiples of all
/// rates. Other threads of Python run meanwhile.
#[pyfunction]
#[pyo3(signature = (scene, seconds=1.0, *, reference_hz=1920, **axes))]
pub(crate) fn trade<'py>(
    py: Python<'py>,
    scene: &Scene,
    seconds: f64,
    reference_hz: u32,
    axes: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyList>> {
    let quick = plain(py, &Grid::quick(!scene.0.joints.is_empty()))?;
    let quick = quick.cast::<PyDict>()?;
    for (name, values) in axes.into_iter().flatten() {
        if !quick.contains(&name)? {
            return Err(PyTypeError::new_err(format!("a grid has no axis `{name}`")));
        }
        quick.set_item(name, values)?;
    }
    let grid: Grid = description(quick)?;
    let rows = aside(py, || measure(&scene.0, &grid, (seconds, reference_hz)))?.map_err(refused)?;
    let found = PyList::empty(py);
    for (cell, errors, cost) in rows {
        let row = plain(py, &cell)?;
        let row = row.cast::<PyDict>()?;
        row.set_item("name", cell.name())?;
        row.set_item("errors", named(py, &errors)?)?;
        row.set_item("cost_us", cost)?;
        found.append(row)?;
    }
    Ok(found)
}
