//! The convex shape of a query: checked, placed, and related to the shapes that it may meet.

use super::candidates::{Candidate, turn, turn_back};
use super::ray::check_start;
use crate::error::{Error, within};
use crate::limits::unit_quat;
use crate::math::Quat;
use crate::narrow_phase::{Support, SupportPose};
use crate::shape::{Collider, Geometry};
use glam::{DMat3, DVec3, Vec3};

/// See the module.
pub(crate) struct Probe<'a> {
    pub(super) support: Support<'a>,
    pub(super) position: DVec3,
    rotation: Quat,
    axes: DMat3,
    /// Half extents of a box around it, in the axes of the world [m].
    pub(super) half: Vec3,
    radius: f32,
}

impl<'a> Probe<'a> {
    pub(crate) fn new(geometry: &'a Geometry, position: DVec3, rotation: Quat) -> Result<Probe<'a>, Error> {
        geometry.validate()?;
        let Some(support) = geometry.support() else {
            return Err(Error::NotConvex { shape: geometry.kind_name() });
        };
        check_start("shape position", position)?;
        let radius = within("shape size", geometry.radius(), 0.0, 1e15, "at most 1e15")?;
        let rotation = unit_quat("shape rotation", rotation)?;
        let axes = matrix(rotation);
        let half = support.half_extents(axes).as_vec3() * (1.0 + 4.0 * f32::EPSILON);
        Ok(Probe { support, position, rotation, axes, half, radius })
    }

    /// With a skin of this thickness around it [m].
    pub(crate) fn with_skin(mut self, skin: f32) -> Probe<'a> {
        if skin > 0.0 {
            self.support.radius += f64::from(skin);
            self.half = (self.half + skin) * (1.0 + 4.0 * f32::EPSILON);
            self.radius += skin;
        }
        self
    }

    /// How far it reaches from its origin along a unit vector of the world [m].
    pub(crate) fn reach(&self, along: DVec3) -> f64 {
        let local = turn_back(self.rotation, along);
        self.support.support(local).dot(local) + self.support.radius
    }

    /// The pose of a shape in the probe's frame.
    pub(super) fn pose_of(&self, candidate: &Candidate<'_>) -> SupportPose {
        let to_probe = self.axes.transpose();
        SupportPose {
            rotation: to_probe * matrix(candidate.place.rotation),
            position: to_probe * (candidate.place.position - self.position),
        }
    }

    /// A vector of the world in the probe's frame.
    pub(super) fn local(&self, v: Vec3) -> DVec3 {
        turn_back(self.rotation, v.as_dvec3())
    }
    /// A vector of the probe's frame in the axes of the world.
    pub(super) fn global(&self, v: DVec3) -> DVec3 {
        turn(self.rotation, v)
    }

    /// How near counts as a touch [m]: a hundred-thousandth of the smaller shape, at most 5 µm, and no less
    /// than the precision of the `f32` corners of a large hull.
    pub(super) fn tolerance(&self, other: &Collider) -> f64 {
        let other = if other.kind.is_convex() { other.radius } else { self.radius };
        let (small, large) = (self.radius.min(other), self.radius.max(other));
        f64::from((1e-5 * small).min(5e-6).max(f32::EPSILON * large))
    }
}

fn matrix(rotation: Quat) -> DMat3 {
    DMat3::from_quat(rotation.as_dquat().normalize())
}
