//! Conversions between Python and the engine.

use crate::Error;
use backstop::glam::{DVec3, Quat, Vec3};
use numpy::ndarray::Dimension;
use numpy::{Element, PyArray, PyArrayMethods};
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The exception for a call that the engine, the scenes or the lab refuse.
pub(crate) fn refused(error: impl Display) -> PyErr {
    Error::new_err(error.to_string())
}

/// Numbers of a list, a tuple, an array or anything else that yields as many.
#[derive(Clone, Copy)]
pub(crate) struct Numbers<const N: usize>(pub(crate) [f64; N]);

impl<'py, const N: usize> FromPyObject<'_, 'py> for Numbers<N> {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let mut values = Vec::with_capacity(N);
        for value in object.try_iter()?.take(N + 1) {
            values.push(value?.extract::<f64>()?);
        }
        let wrong = |values: Vec<f64>| {
            let more = if values.len() > N { "more" } else { "fewer" };
            PyValueError::new_err(format!("{N} numbers are needed, and there are {more}"))
        };
        values.try_into().map(Numbers).map_err(wrong)
    }
}

pub(crate) type Three = Numbers<3>;
pub(crate) type Four = Numbers<4>;

impl From<Three> for Vec3 {
    fn from(Numbers(values): Three) -> Vec3 {
        Vec3::from_array(values.map(|x| x as f32))
    }
}

impl From<Three> for DVec3 {
    fn from(Numbers(values): Three) -> DVec3 {
        DVec3::from_array(values)
    }
}

impl From<Four> for Quat {
    fn from(Numbers(values): Four) -> Quat {
        Quat::from_array(values.map(|x| x as f32))
    }
}

/// Named fields as a description of the engine. Arrays count as lists.
pub(crate) fn description<T: DeserializeOwned>(fields: &Bound<'_, PyDict>) -> PyResult<T> {
    let plain = PyDict::new(fields.py());
    for (name, value) in fields {
        let value = if value.hasattr("tolist")? { value.call_method0("tolist")? } else { value };
        plain.set_item(name, value)?;
    }
    pythonize::depythonize(&plain).map_err(|error| PyTypeError::new_err(error.to_string()))
}

/// A report of the engine as dictionaries, lists and numbers.
pub(crate) fn plain<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    pythonize::pythonize(py, value).map_err(|error| PyTypeError::new_err(error.to_string()))
}

/// Fills an array of the caller, or a new one, with numbers in the order of its rows.
pub(crate) fn filled<'py, T: Element + Copy, D: Dimension>(
    py: Python<'py>,
    out: Option<Bound<'py, PyArray<T, D>>>,
    shape: D,
    values: Vec<T>,
) -> PyResult<Bound<'py, PyArray<T, D>>> {
    let Some(out) = out else {
        let made = numpy::ndarray::Array::from_shape_vec(shape, values);
        return Ok(PyArray::from_owned_array(py, made.map_err(refused)?));
    };
    has_shape(&out, &shape)?;
    {
        let mut target = out.try_readwrite()?;
        target.as_array_mut().iter_mut().zip(values).for_each(|(to, value)| *to = value);
    }
    Ok(out)
}

/// Refuses an array of another shape.
pub(crate) fn has_shape<T: Element, D: Dimension>(out: &Bound<'_, PyArray<T, D>>, shape: &D) -> PyResult<()> {
    use numpy::PyUntypedArrayMethods;
    if out.shape() == shape.slice() {
        return Ok(());
    }
    let (found, needed) = (out.shape(), shape.slice());
    Err(PyValueError::new_err(format!("`out` has the shape {found:?} and needs {needed:?}")))
}

/// Computes something while other threads of Python run. A panic, which would be a defect of the engine,
/// becomes an exception.
pub(crate) fn aside<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let done = py.detach(|| catch_unwind(AssertUnwindSafe(work)));
    done.map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
        PyRuntimeError::new_err(format!("a defect of backstop: {text}"))
    })
}
