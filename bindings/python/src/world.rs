//! Worlds: settings, bodies, steps, and their state as arrays.

use crate::body::Body;
use crate::convert::{Four, Three, aside, description, filled, has_shape, plain, refused};
use crate::scene::Scene;
use crate::shape::Shape;
use backstop::{BodyDesc, BodyHandle, MassProperties, Settings};
use numpy::ndarray::{Dim, Ix2, Ix3};
use numpy::{Element, PyArray, PyArray2, PyArray3};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::time::{Duration, Instant};

/// How long steps run before signals, such as Ctrl-C, are looked at.
const UNSEEN: Duration = Duration::from_millis(100);

/// Bodies that move, collide and come to rest. All arrays are copies: none changes with the world.
#[pyclass(module = "backstop")]
pub(crate) struct World {
    pub(crate) world: backstop::World,
    /// The bodies in the order in which they were added: that of the rows of arrays.
    pub(crate) order: Vec<BodyHandle>,
}

/// Settings by their names, the others as `base` has them.
fn settings(base: Settings, fields: Option<&Bound<'_, PyDict>>) -> PyResult<Settings> {
    let Some(fields) = fields else { return Ok(base) };
    let whole = plain(fields.py(), &base)?;
    let whole = whole.cast::<PyDict>()?;
    for (name, value) in fields {
        if !whole.contains(&name)? {
            return Err(PyTypeError::new_err(format!("there is no setting `{name}`")));
        }
        whole.set_item(name, value)?;
    }
    description(whole)
}

impl World {
    /// An order of rows for a world of unknown history: rows that there were first, then by handles.
    pub(crate) fn find_order(&mut self) {
        let world = &self.world;
        self.order.retain(|&body| world.contains(body));
        let mut others: Vec<_> = world.bodies().filter(|body| !self.order.contains(body)).collect();
        others.sort_unstable();
        self.order.append(&mut others);
    }

    /// A row of numbers for each body.
    fn rows<'py, T: Element + Copy, const N: usize>(
        &self,
        py: Python<'py>,
        out: Option<Bound<'py, PyArray<T, Ix2>>>,
        row: impl Fn(&backstop::World, BodyHandle) -> Result<[T; N], backstop::Error>,
    ) -> PyResult<Bound<'py, PyArray2<T>>> {
        let mut values = Vec::with_capacity(self.order.len() * N);
        for &body in &self.order {
            values.extend(row(&self.world, body).map_err(refused)?);
        }
        filled(py, out, Dim([self.order.len(), N]), values)
    }
}

/// Steps until all are done, or signals are to be looked at: the number of steps that were done.
fn run(
    (world, order): (&mut backstop::World, &[BodyHandle]),
    (dt, most): (f32, usize),
    mut record: Option<&mut Vec<f64>>,
) -> Result<usize, backstop::Error> {
    let start = Instant::now();
    let mut done = 0;
    while done < most && (done == 0 || start.elapsed() < UNSEEN) {
        world.step(dt)?;
        done += 1;
        if let Some(record) = record.as_deref_mut() {
            for &body in order {
                record.extend(world.position(body)?.to_array());
            }
        }
    }
    Ok(done)
}

#[pymethods]
impl World {
    #[new]
    #[pyo3(signature = (**settings))]
    fn new(settings: Option<&Bound<'_, PyDict>>) -> PyResult<World> {
        let settings = self::settings(Settings::default(), settings)?;
        Ok(World { world: backstop::World::new(settings).map_err(refused)?, order: Vec::new() })
    }

    /// A world with the gravity and the contents of a scene.
    #[staticmethod]
    #[pyo3(signature = (scene, **settings))]
    fn from_scene(scene: &Scene, settings: Option<&Bound<'_, PyDict>>) -> PyResult<World> {
        let base = Settings::default().with_gravity(scene.0.gravity);
        let settings = self::settings(base, settings)?;
        let mut world = backstop::World::new(settings).map_err(refused)?;
        let order = scene.0.add_to(&mut world).map_err(refused)?.bodies;
        Ok(World { world, order })
    }

    /// Adds the contents of a scene: its bodies, in its order.
    fn add_scene(&mut self, scene: &Scene) -> PyResult<Vec<Body>> {
        let bodies = scene.0.add_to(&mut self.world).map_err(refused)?.bodies;
        self.order.extend(&bodies);
        Ok(bodies.into_iter().map(Body).collect())
    }

    /// All settings with their values.
    fn settings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        plain(py, self.world.settings())
    }

    /// Changes settings by their names.
    #[pyo3(signature = (**settings))]
    fn set_settings(&mut self, settings: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let settings = self::settings(self.world.settings().clone(), settings)?;
        self.world.set_settings(settings).map_err(refused)
    }

    /// Adds a body. `mass` [kg] takes the place of the densities of its shapes. Other fields have the names
    /// of the engine's: `linear_velocity`, `angular_velocity`, `gravity_scale`, `linear_damping`,
    /// `continuous` and so on.
    #[pyo3(signature = (kind="dynamic", position=None, rotation=None, shapes=Vec::new(), **fields))]
    fn add_body(
        &mut self,
        py: Python<'_>,
        kind: &str,
        position: Option<Three>,
        rotation: Option<Four>,
        shapes: Vec<Shape>,
        fields: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Body> {
        let fields = fields.map_or_else(|| Ok(PyDict::new(py)), |fields| fields.copy())?;
        let mass: Option<f32> = fields.get_item("mass")?.map(|mass| mass.extract()).transpose()?;
        if mass.is_some() {
            fields.del_item("mass")?;
        }
        fields.set_item("kind", kind)?;
        let mut desc: BodyDesc = description(&fields)?;
        if let Some(position) = position {
            desc.position = position.into();
        }
        if let Some(rotation) = rotation {
            desc.rotation = rotation.into();
        }
        desc.shapes = shapes.into_iter().map(|shape| shape.0).collect();
        if let Some(mass) = mass {
            let parts = desc.shapes.iter().map(|shape| {
                let own = MassProperties::of(&shape.geometry, shape.density);
                own.transformed(shape.position, shape.rotation)
            });
            desc.mass = Some(MassProperties::combine(&parts.collect::<Vec<_>>()).scaled_to(mass));
        }
        let body = self.world.add_body(&desc).map_err(refused)?;
        self.order.push(body);
        Ok(Body(body))
    }

    /// Removes a body with its shapes and joints.
    fn remove_body(&mut self, body: Body) -> PyResult<()> {
        self.world.remove_body(body.0).map_err(refused)?;
        self.order.retain(|&other| other != body.0);
        Ok(())
    }

    /// The bodies in the order in which they were added: that of the rows of arrays.
    #[getter]
    fn bodies(&self) -> Vec<Body> {
        self.order.iter().copied().map(Body).collect()
    }

    /// Moves the world on by `steps` steps of `dt` [s]. Other threads of Python run meanwhile; their calls of
    /// this world are refused with RuntimeError. `out`, an array of float64 with the shape (steps, bodies,
    /// 3), gets the positions after each step.
    #[pyo3(signature = (dt, steps=1, *, out=None))]
    fn step(
        &mut self,
        py: Python<'_>,
        dt: f32,
        steps: usize,
        out: Option<Bound<'_, PyArray3<f64>>>,
    ) -> PyResult<()> {
        let shape: Ix3 = Dim([steps, self.order.len(), 3]);
        if let Some(out) = &out {
            has_shape(out, &shape)?;
        }
        let mut record = out.as_ref().map(|_| Vec::new());
        let (world, order) = (&mut self.world, &self.order[..]);
        let mut left = steps;
        while left > 0 {
            let record = record.as_mut();
            left -= aside(py, || run((world, order), (dt, left), record))?.map_err(refused)?;
            py.check_signals()?;
        }
        if let Some(record) = record {
            filled(py, out, shape, record)?;
        }
        Ok(())
    }

    /// Positions of all bodies' origins [m]: float64, a row for each of `bodies`. `out` is filled and
    /// returned if it is given.
    #[pyo3(signature = (out=None))]
    fn positions<'py>(
        &self,
        py: Python<'py>,
        out: Option<Bound<'py, PyArray2<f64>>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.rows(py, out, |world, body| Ok(world.position(body)?.to_array()))
    }

    /// Rotations of all bodies as unit quaternions x, y, z, w: float32, a row for each of `bodies`.
    #[pyo3(signature = (out=None))]
    fn rotations<'py>(
        &self,
        py: Python<'py>,
        out: Option<Bound<'py, PyArray2<f32>>>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        self.rows(py, out, |world, body| Ok(world.rotation(body)?.to_array()))
    }

    /// Velocities of all bodies' centres of mass [m/s]: float32, a row for each of `bodies`.
    #[pyo3(signature = (out=None))]
    fn velocities<'py>(
        &self,
        py: Python<'py>,
        out: Option<Bound<'py, PyArray2<f32>>>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        self.rows(py, out, |world, body| Ok(world.linear_velocity(body)?.to_array()))
    }

    /// Angular velocities of all bodies about the world's axes [rad/s]: float32, a row for each of `bodies`.
    #[pyo3(signature = (out=None))]
    fn angular_velocities<'py>(
        &self,
        py: Python<'py>,
        out: Option<Bound<'py, PyArray2<f32>>>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        self.rows(py, out, |world, body| Ok(world.angular_velocity(body)?.to_array()))
    }

    /// Kinetic energy of all dynamic bodies plus their potential energy in the world's gravity [J].
    fn energy(&self) -> f64 {
        self.world.energy()
    }

    /// Hash of all poses and velocities, bit by bit: the same on every machine.
    fn state_hash(&self) -> u64 {
        self.world.state_hash()
    }

    /// Bytes of the world by category: `live`, `reserved`, and the `peak` of the latter.
    fn memory<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let found = PyDict::new(py);
        for (category, bytes) in self.world.memory().iter() {
            found.set_item(category.name(), plain(py, &bytes)?)?;
        }
        Ok(found)
    }

    /// Times [us] and counts of the last step.
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        plain(py, self.world.report())
    }

    fn __len__(&self) -> usize {
        self.order.len()
    }

    fn __repr__(&self) -> String {
        format!("<World: {} bodies, {} joints>", self.order.len(), self.world.joint_count())
    }
}
