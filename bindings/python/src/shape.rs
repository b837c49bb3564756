//! Shapes and materials.

use crate::convert::{Four, Three, description, plain, refused};
use backstop::glam::{Vec2, Vec3};
use backstop::{ConvexHull, Filter, Geometry, HeightField, ShapeDesc, TriangleMesh};
use numpy::{AllowTypeChange, PyArrayLike2, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Friction, restitution and other properties of a surface, by the names of the engine's fields. `friction`
/// is static and dynamic friction at once.
#[pyclass(frozen, eq, from_py_object, module = "backstop")]
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Material(pub(crate) backstop::Material);

#[pymethods]
impl Material {
    #[new]
    #[pyo3(signature = (**fields))]
    fn new(py: Python<'_>, fields: Option<&Bound<'_, PyDict>>) -> PyResult<Material> {
        let given = fields.map_or_else(|| Ok(PyDict::new(py)), |fields| fields.copy())?;
        if let Some(friction) = given.get_item("friction")? {
            given.del_item("friction")?;
            for name in ["static_friction", "dynamic_friction"] {
                if !given.contains(name)? {
                    given.set_item(name, &friction)?;
                }
            }
        }
        description(&given).map(Material)
    }

    /// All fields with their values.
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        plain(py, &self.0)
    }

    fn __repr__(&self) -> String {
        let backstop::Material { static_friction, dynamic_friction, restitution, .. } = self.0;
        format!(
            "Material(static_friction={static_friction}, dynamic_friction={dynamic_friction}, \
             restitution={restitution}, ...)"
        )
    }
}

/// A form with a place on its body, a material and a density. Lengths in metres.
#[pyclass(frozen, from_py_object, module = "backstop")]
#[derive(Clone)]
pub(crate) struct Shape(pub(crate) ShapeDesc);

/// A shape of this geometry with the fields that callers may give to any.
fn with_fields(geometry: Geometry, fields: Option<&Bound<'_, PyDict>>) -> PyResult<Shape> {
    geometry.validate().map_err(refused)?;
    let mut shape = ShapeDesc::new(geometry);
    for (name, value) in fields.into_iter().flatten() {
        let name: String = name.extract()?;
        match name.as_str() {
            "position" => shape.position = value.extract::<Three>()?.into(),
            "rotation" => shape.rotation = value.extract::<Four>()?.into(),
            "density" => shape.density = value.extract()?,
            "material" => shape.material = value.extract::<Material>()?.0,
            "filter" => shape.filter = description::<Filter>(value.cast::<PyDict>()?)?,
            "sensor" => shape.sensor = value.extract()?,
            "senses_static" => shape.senses_static = value.extract()?,
            "user_data" => shape.user_data = value.extract()?,
            _ => return Err(PyTypeError::new_err(format!("a shape has no field `{name}`"))),
        }
    }
    shape.validate().map_err(refused)?;
    Ok(Shape(shape))
}

/// Rows of three numbers as points.
fn points(rows: &PyArrayLike2<'_, f64, AllowTypeChange>, what: &str) -> PyResult<Vec<Vec3>> {
    if rows.shape()[1] != 3 {
        return Err(PyValueError::new_err(format!("{what} need three numbers in each row")));
    }
    let rows = rows.as_array();
    Ok(rows.rows().into_iter().map(|row| Vec3::new(row[0] as f32, row[1] as f32, row[2] as f32)).collect())
}

#[pymethods]
impl Shape {
    /// A ball.
    #[staticmethod]
    #[pyo3(signature = (radius, **fields))]
    fn sphere(radius: f32, fields: Option<&Bound<'_, PyDict>>) -> PyResult<Shape> {
        with_fields(Geometry::sphere(radius), fields)
    }

    /// A box by half of its sides.
    #[staticmethod]
    #[pyo3(name = "box", signature = (half_extents, **fields))]
    fn cuboid(half_extents: Three, fields: Option<&Bound<'_, PyDict>>) -> PyResult<Shape> {
        let Vec3 { x, y, z } = half_extents.into();
        with_fields(Geometry::cuboid(x, y, z), fields)
    }

    /// A capsule along y; `half_height` is half the distance of the centres of its two ends.
    #[staticmethod]
    #[pyo3(signature = (half_height, radius, radius_top=None, **fields))]
    fn capsule(
        half_height: f32,
        radius: f32,
        radius_top: Option<f32>,
        fields: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Shape> {
        let top = radius_top.unwrap_or(radius);
        with_fields(Geometry::tapered_capsule(half_height, radius, top), fields)
    }

    /// A cylinder along y, or a frustum if `radius_top` differs.
    #[staticmethod]
    #[pyo3(signature = (half_height, radius, radius_top=None, **fields))]
    fn cylinder(
        half_height: f32,
        radius: f32,
        radius_top: Option<f32>,
        fields: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Shape> {
        let top = radius_top.unwrap_or(radius);
        with_fields(Geometry::tapered_cylinder(half_height, radius, top), fields)
    }

    /// A cone along y with its tip up.
    #[staticmethod]
    #[pyo3(signature = (half_height, radius, **fields))]
    fn cone(half_height: f32, radius: f32, fields: Option<&Bound<'_, PyDict>>) -> PyResult<Shape> {
        with_fields(Geometry::cone(half_height, radius), fields)
    }

    /// The half-space y <= 0, for static and kinematic bodies.
    #[staticmethod]
    #[pyo3(signature = (**fields))]
    fn plane(fields: Option<&Bound<'_, PyDict>>) -> PyResult<Shape> {
        with_fields(Geometry::plane(), fields)
    }

    /// The convex hull of points, one a row.
    #[staticmethod]
    #[pyo3(signature = (points, **fields))]
    fn hull(
        points: PyArrayLike2<'_, f64, AllowTypeChange>,
        fields: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Shape> {
        let points = self::points(&points, "points of a hull")?;
        with_fields(Geometry::hull(ConvexHull::new(&points).map_err(refused)?), fields)
    }

    /// A mesh of triangles, for static and kinematic bodies: vertices, and three indices of them a row.
    #[staticmethod]
    #[pyo3(signature = (vertices, triangles, **fields))]
    fn mesh(
        vertices: PyArrayLike2<'_, f64, AllowTypeChange>,
        triangles: PyArrayLike2<'_, i64, AllowTypeChange>,
        fields: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Shape> {
        let vertices = points(&vertices, "vertices of a mesh")?;
        if triangles.shape()[1] != 3 {
            return Err(PyValueError::new_err("triangles need three indices in each row"));
        }
        let refuse = |_| refused("an index of a vertex is negative");
        let index = |index: &i64| u32::try_from(*index).map_err(refuse);
        let corners = triangles.as_array().iter().map(index).collect::<PyResult<Vec<_>>>()?;
        let triangles = corners.chunks_exact(3).map(|corner| [corner[0], corner[1], corner[2]]).collect();
        let mesh = TriangleMesh::new(vertices, triangles).map_err(refused)?;
        with_fields(Geometry::mesh(mesh), fields)
    }

    /// A grid of heights [m], for static and kinematic bodies: a row for each z, a column for each x, and the
    /// sides of a cell along x and z. The first height is at the origin.
    #[staticmethod]
    #[pyo3(signature = (heights, cell, **fields))]
    fn height_field(
        heights: PyArrayLike2<'_, f64, AllowTypeChange>,
        cell: (f32, f32),
        fields: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Shape> {
        let [rows, columns] = [0, 1].map(|axis| heights.shape()[axis]);
        let heights = heights.as_array().iter().map(|&height| height as f32).collect();
        let field = HeightField::new(columns, rows, Vec2::new(cell.0, cell.1), heights).map_err(refused)?;
        with_fields(Geometry::height_field(field), fields)
    }

    /// The name of its form.
    #[getter]
    fn kind(&self) -> &'static str {
        self.0.geometry.kind_name()
    }

    fn __repr__(&self) -> String {
        format!("<Shape: {}>", self.kind())
    }
}
