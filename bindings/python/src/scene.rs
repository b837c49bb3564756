//! Scenes: builtin ones and files.

use crate::convert::refused;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Bodies and joints that a world can be filled with.
#[pyclass(frozen, module = "backstop")]
pub(crate) struct Scene(pub(crate) backstop_scene::Scene);

#[pymethods]
impl Scene {
    /// Reads a glTF file (`.gltf`, `.glb`) with KHR_physics_rigid_bodies, a plain one, or an OBJ mesh.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Scene> {
        backstop_scene::load(path).map(Scene).map_err(refused)
    }

    /// A builtin scene; `scene_names` lists them. A structure too, such as `tower_30`.
    #[staticmethod]
    fn builtin(name: &str) -> PyResult<Scene> {
        let found = backstop_scene::builtin::build(name);
        found.map(Scene).ok_or_else(|| refused(format!("there is no builtin scene `{name}`")))
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Gravity [m/s²].
    #[getter]
    fn gravity(&self) -> [f32; 3] {
        self.0.gravity.to_array()
    }

    /// Names of its bodies, in the order in which a world adds them.
    #[getter]
    fn body_names(&self) -> Vec<&str> {
        self.0.bodies.iter().map(|body| body.name.as_str()).collect()
    }

    /// Number of its joints.
    #[getter]
    fn joint_count(&self) -> usize {
        self.0.joints.len()
    }

    /// What was left out or approximated when the file was read, in sentences.
    #[getter]
    fn notes(&self) -> Vec<&str> {
        self.0.notes.iter().map(String::as_str).collect()
    }

    /// Writes it as a glTF file with KHR_physics_rigid_bodies.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        backstop_scene::write_scene(&self.0, path).map_err(refused)
    }

    fn __repr__(&self) -> String {
        format!("<Scene {}: {} bodies, {} joints>", self.0.name, self.0.bodies.len(), self.0.joints.len())
    }
}

/// Names of the builtin scenes.
#[pyfunction]
pub(crate) fn scene_names() -> Vec<&'static str> {
    backstop_scene::builtin::NAMES.to_vec()
}
