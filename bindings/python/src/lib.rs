//! The native part of the Python package `backstop`, which is in `python/backstop`.

mod body;
mod convert;
mod joint;
mod lab;
mod query;
mod scene;
mod shape;
mod snapshot;
mod trade;
mod world;

use pyo3::prelude::*;

pyo3::create_exception!(
    backstop,
    Error,
    pyo3::exceptions::PyValueError,
    "A call that the engine refuses, with its reason. It has changed nothing."
);

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::Error;
    #[pymodule_export]
    use super::body::Body;
    #[pymodule_export]
    use super::joint::{Joint, Motor};
    #[pymodule_export]
    use super::lab::{Problem, Solution, methods, solve};
    #[pymodule_export]
    use super::query::{Contact, RayHit};
    #[pymodule_export]
    use super::scene::{Scene, scene_names};
    #[pymodule_export]
    use super::shape::{Material, Shape};
    #[pymodule_export]
    use super::snapshot::Snapshot;
    #[pymodule_export]
    use super::trade::trade;
    #[pymodule_export]
    use super::world::World;

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
