//! Contacts of the last step, and rays.

use crate::body::Body;
use crate::convert::{Three, aside, refused};
use crate::world::World;
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyContact, QueryFilter, Ray};
use numpy::{AllowTypeChange, PyArray1, PyArrayLike2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A contact of two bodies: up to four points with one normal.
#[pyclass(frozen, get_all, module = "backstop")]
pub(crate) struct Contact {
    /// The two bodies.
    bodies: (Body, Body),
    /// Unit vector from the first body to the second.
    normal: [f32; 3],
    /// Points, midway between the two surfaces [m].
    points: Vec<[f64; 3]>,
    /// Distance of the surfaces at each point, negative in overlap [m].
    separations: Vec<f32>,
    /// Normal impulse at each point in the last substep [N s].
    impulses: Vec<f32>,
}

impl From<BodyContact> for Contact {
    fn from(contact: BodyContact) -> Contact {
        let points = contact.points();
        Contact {
            bodies: (Body(contact.bodies[0]), Body(contact.bodies[1])),
            normal: contact.normal.to_array(),
            points: points.iter().map(|point| point.position.to_array()).collect(),
            separations: points.iter().map(|point| point.separation).collect(),
            impulses: points.iter().map(|point| point.impulse).collect(),
        }
    }
}

#[pymethods]
impl Contact {
    fn __repr__(&self) -> String {
        format!("<Contact: {} points, normal {:?}>", self.points.len(), self.normal)
    }
}

/// Where a ray meets a body.
#[pyclass(frozen, get_all, module = "backstop")]
pub(crate) struct RayHit {
    /// The body.
    body: Body,
    /// Share of the path, 0 to 1.
    fraction: f32,
    /// Where it is met [m].
    point: [f64; 3],
    /// Unit vector out of the shape.
    normal: [f32; 3],
}

#[pymethods]
impl RayHit {
    fn __repr__(&self) -> String {
        format!("<RayHit: {} of the path, at {:?}>", self.fraction, self.point)
    }
}

#[pymethods]
impl World {
    /// Contacts of the last step: all, or those of a body, which is then the first of each.
    #[pyo3(signature = (body=None))]
    fn contacts(&self, body: Option<Body>) -> PyResult<Vec<Contact>> {
        Ok(match body {
            Some(body) => self.world.contacts_of(body.0).map_err(refused)?.map(Contact::from).collect(),
            None => self.world.contacts().map(Contact::from).collect(),
        })
    }

    /// The first body that a ray from a point along a path [m] meets.
    #[pyo3(signature = (origin, path, *, exclude=None))]
    fn cast_ray(&self, origin: Three, path: Three, exclude: Option<Body>) -> PyResult<Option<RayHit>> {
        let filter = exclude.into_iter().fold(QueryFilter::new(), |filter, body| filter.excluding(body.0));
        let ray = Ray::new(DVec3::from(origin), path.into());
        let hit = self.world.cast_ray(&ray, &filter).map_err(refused)?;
        Ok(hit.map(|hit| RayHit {
            body: Body(hit.body),
            fraction: hit.fraction,
            point: hit.point.to_array(),
            normal: hit.normal.to_array(),
        }))
    }

    /// Shares of the paths of many rays, an origin and a path [m] a row, at which they first meet a body;
    /// infinity for those that meet none. Other threads of Python run meanwhile.
    fn cast_rays<'py>(
        &self,
        py: Python<'py>,
        origins: PyArrayLike2<'py, f64, AllowTypeChange>,
        paths: PyArrayLike2<'py, f64, AllowTypeChange>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        if origins.shape() != paths.shape() || origins.shape()[1] != 3 {
            return Err(PyValueError::new_err(
                "origins and paths need three numbers in each of as many rows",
            ));
        }
        let rows = |array: &PyArrayLike2<'py, f64, AllowTypeChange>| -> Vec<DVec3> {
            array.as_array().rows().into_iter().map(|row| DVec3::new(row[0], row[1], row[2])).collect()
        };
        let (origins, paths) = (rows(&origins), rows(&paths));
        let world = &self.world;
        let cast = || {
            let ray = |(origin, path): (&DVec3, &DVec3)| -> Result<f32, backstop::Error> {
                let path: Vec3 = path.as_vec3();
                let hit = world.cast_ray(&Ray::new(*origin, path), &QueryFilter::new())?;
                Ok(hit.map_or(f32::INFINITY, |hit| hit.fraction))
            };
            origins.iter().zip(&paths).map(ray).collect::<Result<Vec<_>, _>>()
        };
        Ok(PyArray1::from_vec(py, aside(py, cast)?.map_err(refused)?))
    }
}
