//! Mass, centre and inertia out of shapes and densities, in f64 throughout: a moment is a difference of
//! products, and f32 would lose half of it.

mod moments;

use super::Geometry;
use crate::error::{Error, finite, positive, within};
use glam::{DMat3, DVec3, Mat3, Vec3};
pub(crate) use moments::Moments;
pub(super) use moments::{capsule, frustum, principal};

/// Mass, centre of mass and inertia about it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct MassProperties {
    /// [kg]
    pub mass: f32,
    /// In the frame of the shape or body [m].
    #[cfg_attr(feature = "serde", serde(alias = "center"))]
    pub centre_of_mass: Vec3,
    /// About the centre, in the axes of the shape or body [kg m²].
    pub inertia: Mat3,
}

impl MassProperties {
    /// No mass.
    pub const ZERO: Self = MassProperties { mass: 0.0, centre_of_mass: Vec3::ZERO, inertia: Mat3::ZERO };

    /// Moments of a solid of even density [kg/m³]. Planes, meshes and height fields have no mass.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// let ball = MassProperties::of(&Geometry::sphere(0.5), 1000.0);
    /// assert!((ball.mass - 523.6).abs() < 0.1);
    /// # Ok::<(), Error>(())
    /// ```
    pub fn of(geometry: &Geometry, density: f32) -> Self {
        Self::of_moments(geometry.moments(), density)
    }

    /// Of moments at a density of one.
    pub(super) fn of_moments(moments: Moments, density: f32) -> Self {
        moments.scaled(density.into()).rounded()
    }

    /// Those of a body with known principal moments [kg m²]; `axes`: the rotation from its principal axes
    /// into its own. The inverse of [`MassProperties::principal`].
    pub fn from_principal(
        mass: f32,
        centre_of_mass: Vec3,
        moments: Vec3,
        axes: impl Into<glam::Quat>,
    ) -> Self {
        let turn = DMat3::from_quat(axes.into().as_dquat().normalize());
        let inertia = turn * DMat3::from_diagonal(moments.as_dvec3()) * turn.transpose();
        MassProperties { mass, centre_of_mass, inertia: inertia.as_mat3() }
    }

    /// The same solid, turned and then moved: from a shape's frame into the body's.
    pub fn transformed(&self, position: Vec3, rotation: glam::Quat) -> Self {
        let turn = DMat3::from_quat(rotation.as_dquat().normalize());
        let m = Moments::from(*self);
        Moments {
            mass: m.mass,
            centre: turn * m.centre + position.as_dvec3(),
            inertia: turn * m.inertia * turn.transpose(),
        }
        .rounded()
    }

    /// All of them as one body. Parts without mass have no effect.
    pub fn combine(parts: &[MassProperties]) -> Self {
        Moments::combine(parts.iter().map(|&p| p.into())).rounded()
    }

    /// The same distribution with another mass [kg]. Without mass there is nothing to scale, and the inertia
    /// stays zero.
    pub fn scaled_to(&self, mass: f32) -> Self {
        if self.mass <= 0.0 {
            return MassProperties { mass, ..*self };
        }
        let mut scaled = Moments::from(*self).scaled(f64::from(mass) / f64::from(self.mass)).rounded();
        // Exactly the requested mass, without rounding.
        scaled.mass = mass;
        scaled
    }

    /// Checks that a solid could have these.
    ///
    /// # Errors
    /// If a number is not finite, the centre is beyond [`limits::MAX_LENGTH`](crate::limits::MAX_LENGTH)
    /// along an axis, the mass is not above zero, or the inertia is not symmetric (to 1e-4 of its size), not
    /// positive definite, or has a principal moment above the sum of the other two (by 1e-4 of it).
    pub fn validate(&self) -> Result<(), Error> {
        crate::limits::offset("centre of mass", self.centre_of_mass)?;
        for value in self.inertia.to_cols_array() {
            finite("inertia", value)?;
        }
        positive("mass", self.mass)?;
        let m = self.inertia;
        let size = m.x_axis.abs().max(m.y_axis.abs()).max(m.z_axis.abs()).max_element();
        let skew = (m.x_axis.y - m.y_axis.x)
            .abs()
            .max((m.x_axis.z - m.z_axis.x).abs())
            .max((m.y_axis.z - m.z_axis.y).abs());
        within("asymmetry of the inertia", skew, 0.0, 1e-4 * size, "at most 1e-4 of the inertia")?;
        let mut moments = self.principal().0.to_array();
        moments.sort_by(f32::total_cmp);
        let [small, middle, large] = moments;
        positive("smallest principal moment of inertia", small)?;
        let most = (f64::from(small) + f64::from(middle)) * 1.0001;
        within(
            "largest principal moment of inertia",
            large,
            0.0,
            most as f32,
            "at most the sum of the others",
        )
        .map(drop)
    }

    /// Principal moments [kg m²], and the rotation from principal axes into these axes: `inertia = R
    /// diag(moments) Rᵀ`. The axes are as near to x, y, z as they come, and not sorted by moment.
    pub fn principal(&self) -> (Vec3, glam::Quat) {
        let (moments, axes) = principal(Moments::from(*self).inertia);
        (moments.as_vec3(), axes.as_quat())
    }
}

impl From<MassProperties> for Moments {
    fn from(p: MassProperties) -> Self {
        Moments { mass: p.mass.into(), centre: p.centre_of_mass.as_dvec3(), inertia: p.inertia.as_dmat3() }
    }
}

impl Moments {
    fn scaled(self, factor: f64) -> Self {
        Moments { mass: self.mass * factor, centre: self.centre, inertia: self.inertia * factor }
    }

    /// In f32. A needle keeps at least [`THINNEST`] of its largest moment around its own axis: in turned axes
    /// f32 could not tell less from nothing, or from less than nothing.
    fn rounded(self) -> MassProperties {
        let Moments { mass, centre, mut inertia } = self;
        let (moments, axes) = principal(inertia);
        let least = THINNEST * moments.max_element();
        if moments.min_element() < least {
            let turn = DMat3::from_quat(axes);
            inertia = turn * DMat3::from_diagonal(moments.max(DVec3::splat(least))) * turn.transpose();
        }
        // Symmetric to the last bit, for any order of the products above.
        let inertia = (inertia + inertia.transpose()) * 0.5;
        MassProperties { mass: mass as f32, centre_of_mass: centre.as_vec3(), inertia: inertia.as_mat3() }
    }
}

// Rounding: of f32, sixteen times.
/// 16 roundings of f32: a needle a thousand times as long as it is thick still has its own.
const THINNEST: f64 = 16.0 * f32::EPSILON as f64 / 2.0;

#[cfg(test)]
mod tests;
