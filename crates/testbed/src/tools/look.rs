//! What is known of the body that the user looks at.

use super::first_hit;
use crate::Refusal;
use crate::drawing::Drawing;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyHandle, BodyKind, Ray, ShapeHandle, World};
use serde_json::{Value, json};

/// A body that is looked at, and the point of it.
#[derive(Clone, Debug)]
pub(crate) struct Inspected {
    pub(crate) body: BodyHandle,
    shape: ShapeHandle,
    /// Point and normal in the axes of the body.
    point: Vec3,
    normal: Vec3,
}

/// The body that a ray hits first, if any.
pub(crate) fn look_at(world: &World, ray: &Ray) -> Result<Option<Inspected>, Refusal> {
    let Some(hit) = first_hit(world, ray)? else { return Ok(None) };
    let back = world.rotation(hit.body)?.conjugate();
    let point = back * (hit.point - world.position(hit.body)?).as_vec3();
    Ok(Some(Inspected { body: hit.body, shape: hit.shape, point, normal: back * hit.normal }))
}

impl Inspected {
    /// All of it in words and numbers; none once the shape is gone.
    pub(crate) fn told(&self, world: &World, drawing: &Drawing, name: Option<&str>) -> Option<Value> {
        self.try_told(world, drawing, name).ok()
    }

    fn try_told(
        &self,
        world: &World,
        drawing: &Drawing,
        name: Option<&str>,
    ) -> Result<Value, backstop::Error> {
        let (body, origin) = (self.body, world.origin());
        let (position, rotation): (DVec3, Quat) = (world.position(body)?, world.rotation(body)?);
        let kind = match world.kind(body)? {
            BodyKind::Static => "static",
            BodyKind::Kinematic => "kinematic",
            BodyKind::Dynamic => "dynamic",
        };
        let material = world.material(self.shape)?;
        let shapes: Vec<usize> = world.shapes(body)?.filter_map(|shape| drawing.place(shape)).collect();
        Ok(json!({
            "body": name.map_or_else(|| format!("{body:?}"), str::to_owned),
            "kind": kind,
            "mass": world.mass(body)?,
            "position": (position - origin).to_array(),
            "velocity": world.linear_velocity(body)?.to_array(),
            "spin": world.angular_velocity(body)?.to_array(),
            "asleep": world.is_sleeping(body)?,
            "shape": world.geometry(self.shape)?.kind_name(),
            "friction": material.dynamic_friction,
            "restitution": material.restitution,
            "density": world.density(self.shape)?,
            "contacts": world.contacts_of(body)?.count(),
            "joints": world.joints_of(body)?.count(),
            "point": (position - origin + (rotation * self.point).as_dvec3()).to_array(),
            "normal": (rotation * self.normal).to_array(),
            "shapes": shapes,
        }))
    }
}
