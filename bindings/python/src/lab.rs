//! Contact problems and the methods that solve them.

use crate::convert::{aside, refused};
use crate::world::World;
use backstop_lab::LabWorld;
use backstop_lab::methods::{Effort, Friction, Method, Status};
use backstop_lab::problem::{File, Form, Law, Matrix, read_problem};
use backstop_lab::system::SystemProblems;
use numpy::{AllowTypeChange, PyArray1, PyArray2, PyArrayLike1, PyArrayLike2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::time::Instant;

/// Find impulses r and velocities u = W r + q that obey the law of each contact, or z and w of a linear
/// complementarity problem.
#[pyclass(frozen, module = "backstop.lab")]
pub(crate) struct Problem(File);

/// A square matrix, and as many numbers.
fn square(
    w: &PyArrayLike2<'_, f64, AllowTypeChange>,
    q: &PyArrayLike1<'_, f64, AllowTypeChange>,
) -> PyResult<(Matrix, Vec<f64>)> {
    let rows = w.shape()[0];
    if w.shape()[1] != rows || q.shape()[0] != rows {
        return Err(PyValueError::new_err("a problem needs a square matrix and a vector of as many rows"));
    }
    let entries = w.as_array();
    let entries = entries.indexed_iter().filter(|(_, value)| **value != 0.0);
    let w = Matrix::from_entries(rows, entries.map(|((i, j), &value)| (i, j, value)));
    Ok((w, q.as_array().to_vec()))
}

#[pymethods]
impl Problem {
    /// Contacts with friction: W [1/kg], q [m/s], and a coefficient for each contact. A contact has three
    /// rows (normal, two tangents), or two rows in a plane.
    #[staticmethod]
    fn contacts(
        w: PyArrayLike2<'_, f64, AllowTypeChange>,
        q: PyArrayLike1<'_, f64, AllowTypeChange>,
        mu: Vec<f64>,
    ) -> PyResult<Problem> {
        let (w, q) = square(&w, &q)?;
        let dimensions = if q.len() == 2 * mu.len() { 2 } else { 3 };
        File::of_contacts(dimensions, w, q, &mu).map(Problem).map_err(refused)
    }

    /// A linear complementarity problem: z >= 0, M z + q >= 0, and z (M z + q) = 0.
    #[staticmethod]
    fn lcp(
        m: PyArrayLike2<'_, f64, AllowTypeChange>,
        q: PyArrayLike1<'_, f64, AllowTypeChange>,
    ) -> PyResult<Problem> {
        let (m, q) = square(&m, &q)?;
        let problem = backstop_lab::problem::Problem::lcp(m, q).map_err(refused)?;
        Ok(Problem(File { problem, form: Form::Complementarity }))
    }

    /// Reads a problem as Siconos writes it.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Problem> {
        let bytes = std::fs::read(&path)?;
        let text = String::from_utf8_lossy(&bytes);
        read_problem(&text).map(Problem).map_err(|error| refused(format!("{}: {error}", path.display())))
    }

    /// W as a dense array [1/kg]. Contacts in a plane have a second tangent, on which nothing acts.
    #[getter]
    fn w<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let matrix = self.0.problem.w();
        let size = matrix.size();
        PyArray2::from_owned_array(
            py,
            numpy::ndarray::Array2::from_shape_fn((size, size), |(i, j)| matrix.at(i, j)),
        )
    }

    /// Velocities without impulses [m/s].
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.0.problem.q())
    }

    /// Coefficients of friction of its contacts.
    #[getter]
    fn mu(&self) -> Vec<f64> {
        let laws = self.0.problem.laws();
        laws.filter_map(|(_, law)| if let Law::Contact { mu } = law { Some(mu) } else { None }).collect()
    }

    fn __len__(&self) -> usize {
        self.0.problem.rows()
    }
}

/// What a method found.
#[pyclass(frozen, get_all, module = "backstop.lab")]
pub(crate) struct Solution {
    /// `solved`, `ray`, `no_solution` or `limit`.
    status: &'static str,
    /// Sweeps or iterations.
    iterations: u32,
    /// Pivots, of methods that pivot.
    pivots: u32,
    /// Natural-map residual, without a unit.
    residual: f64,
    /// Time of the call [s].
    seconds: f64,
    /// Impulses [N s] or z, in the rows of the problem: the best that were found.
    r: Py<PyArray1<f64>>,
}

#[pymethods]
impl Solution {
    fn __repr__(&self) -> String {
        let Solution { status, iterations, residual, .. } = self;
        format!("<Solution: {status}, {iterations} iterations, residual {residual:.3e}>")
    }
}

/// A method by its name.
fn method(name: &str) -> PyResult<&'static Method> {
    let found = Method::ALL.iter().find(|method| method.name == name);
    found.ok_or_else(|| refused(format!("there is no method `{name}`; backstop.lab.methods() lists them")))
}

/// Methods by their names, each with what it does.
#[pyfunction]
pub(crate) fn methods() -> Vec<(&'static str, &'static str)> {
    Method::ALL.iter().map(|method| (method.name, method.about)).collect()
}

/// Solves a problem. Other threads of Python run meanwhile.
#[pyfunction]
#[pyo3(signature = (problem, method, *, tolerance=1e-10, iterations=10_000, friction="cone", relaxation=1.3))]
pub(crate) fn solve(
    py: Python<'_>,
    problem: &Problem,
    method: &str,
    tolerance: f64,
    iterations: u32,
    friction: &str,
    relaxation: f64,
) -> PyResult<Solution> {
    let friction = match friction {
        "cone" => Friction::Cone,
        "pyramid" => Friction::Pyramid,
        "box" => Friction::Box,
        _ => return Err(PyValueError::new_err("friction is `cone`, `pyramid` or `box`")),
    };
    let effort = Effort { tolerance, iterations, friction, relaxation, ..Effort::default() };
    let solve = self::method(method)?.solve;
    let start = Instant::now();
    let found = aside(py, || solve(&problem.0.problem, &effort))?;
    Ok(Solution {
        status: match found.status {
            Status::Solved => "solved",
            Status::Ray => "ray",
            Status::NoSolution => "no_solution",
            Status::Limit => "limit",
        },
        iterations: found.iterations,
        pivots: found.pivots,
        residual: found.residual,
        seconds: start.elapsed().as_secs_f64(),
        r: PyArray1::from_vec(py, problem.0.unknowns(&found.r)).unbind(),
    })
}

#[pymethods]
impl World {
    /// Keeps the rows of each step from now on, or no longer, for `contact_problem`. Steps take a multiple of
    /// their time.
    fn observe(&mut self, on: bool) {
        self.world.measure_accuracy(on);
    }

    /// The contacts of the last step as a problem, with joints eliminated. `observe` must be on.
    fn contact_problem(&self) -> PyResult<Problem> {
        let system = self.world.system();
        let system = system.ok_or_else(|| refused("no step was observed: call observe(True) before it"))?;
        let (problem, _) = system.contact_problem().map_err(refused)?;
        Ok(Problem(File { problem, form: Form::Contacts }))
    }
}
