//! A world with a clock, and bodies that many cases build in it.

use super::case::Setting;
use crate::retroactive::Retroactive;
use backstop::BodyDesc;
use backstop::BodyHandle;
use backstop::Error;
use backstop::Settings;
use backstop::World;
use backstop::{Combine, Geometry, MassProperties, Material, ShapeDesc};
use glam::{DQuat, DVec3, Mat3, Quat, Vec3};

/// Gravity [m/s²].
pub(super) const G: f64 = 9.81;
/// The same as a vector.
pub(super) const DOWN: Vec3 = Vec3::new(0.0, -9.81, 0.0);

/// A world that is stepped by a setting.
pub(super) struct Rig {
    pub(super) world: World,
    /// Length of a step [s].
    pub(super) dt: f32,
    /// Time since the start [s].
    pub(super) time: f64,
    retroactive: Option<Retroactive>,
}

impl Rig {
    pub(super) fn new(setting: &Setting, gravity: Vec3) -> Result<Rig, Error> {
        Rig::with(setting, Setting::settings(gravity))
    }

    /// A world with the case's own settings, overridden by those of `setting`.
    pub(super) fn with(setting: &Setting, settings: Settings) -> Result<Rig, Error> {
        let Setting { dt, retroactive, .. } = *setting;
        Ok(Rig { world: setting.world(settings)?, dt, time: 0.0, retroactive })
    }

    pub(super) fn add(&mut self, desc: &BodyDesc) -> Result<BodyHandle, Error> {
        self.world.add_body(desc)
    }

    /// A static half-space below y = 0.
    pub(super) fn floor(&mut self, material: Material) -> Result<BodyHandle, Error> {
        self.add(&BodyDesc::fixed().with_shape(shape(Geometry::Plane, material)))
    }

    pub(super) fn step(&mut self) -> Result<(), Error> {
        match self.retroactive {
            Some(way) => drop(way.step(&mut self.world, self.dt)?),
            None => drop(self.world.step(self.dt)?),
        }
        self.time += f64::from(self.dt);
        Ok(())
    }

    /// Steps until `time` [s] since the start, to the nearest step.
    pub(super) fn run_to(&mut self, time: f64) -> Result<(), Error> {
        while self.time + 0.5 * f64::from(self.dt) < time {
            self.step()?;
        }
        Ok(())
    }

    /// Steps until a condition holds; returns whether that was before `time` [s].
    pub(super) fn until(
        &mut self,
        time: f64,
        mut done: impl FnMut(&Rig) -> Result<bool, Error>,
    ) -> Result<bool, Error> {
        while self.time < time {
            self.step()?;
            if done(self)? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Position of the centre of mass [m].
    pub(super) fn place(&self, body: BodyHandle) -> Result<DVec3, Error> {
        self.world.centre_of_mass(body)
    }

    pub(super) fn turn(&self, body: BodyHandle) -> Result<DQuat, Error> {
        Ok(self.world.rotation(body)?.as_dquat().normalize())
    }

    /// Velocity of the centre of mass [m/s].
    pub(super) fn velocity(&self, body: BodyHandle) -> Result<DVec3, Error> {
        Ok(self.world.linear_velocity(body)?.as_dvec3())
    }

    /// Angular velocity about the world's axes [rad/s].
    pub(super) fn spin(&self, body: BodyHandle) -> Result<DVec3, Error> {
        Ok(self.world.angular_velocity(body)?.as_dvec3())
    }
}

/// A surface with Coulomb's coefficient of friction and Newton's restitution. Where two surfaces
/// meet, the one with less friction counts.
pub(super) fn surface(friction: f64, restitution: f64) -> Material {
    let material = Material::default().with_friction(friction as f32).with_restitution(restitution as f32);
    material.with_friction_combine(Combine::Minimum)
}

/// A surface without friction.
pub(super) fn smooth(restitution: f64) -> Material {
    surface(0.0, restitution)
}

pub(super) fn shape(geometry: Geometry, material: Material) -> ShapeDesc {
    ShapeDesc::new(geometry).with_material(material)
}

pub(super) fn dynamic(geometry: Geometry, material: Material, at: Vec3) -> BodyDesc {
    BodyDesc::dynamic().with_position(at).with_shape(shape(geometry, material))
}

/// A body with given mass [kg] and principal moments [kg m²], still without a shape.
pub(super) fn lump(mass: f64, inertia: DVec3) -> BodyDesc {
    let inertia = Mat3::from_diagonal(inertia.as_vec3());
    let mass = MassProperties { mass: mass as f32, centre_of_mass: Vec3::ZERO, inertia };
    BodyDesc::dynamic().with_mass(Some(mass))
}

/// A thin rod of 1 kg along y, still without a shape.
pub(super) fn rod(length: f64) -> BodyDesc {
    let across = length * length / 12.0;
    lump(1.0, DVec3::new(across, 1e-3 * across, across))
}

/// A rotation about a unit axis by an angle [rad].
pub(super) fn turned(axis: DVec3, angle: f64) -> DQuat {
    let (sin, cos) = libm::sincos(0.5 * angle);
    let v = axis * sin;
    DQuat::from_xyzw(v.x, v.y, v.z, cos)
}

/// The same in single precision.
pub(super) fn tilted(axis: DVec3, angle: f64) -> Quat {
    turned(axis, angle).as_quat().normalize()
}

/// Ratio of the period of a pendulum with amplitude `angle` [rad] to that of small swings, K(sin(angle / 2))
/// 2 / pi, by the arithmetic-geometric mean.
pub(super) fn stretch(angle: f64) -> f64 {
    1.0 / agm(1.0, libm::cos(0.5 * angle))
}

/// Complete elliptic integral of the first kind, by the square of its modulus.
pub(super) fn elliptic_k(k_squared: f64) -> f64 {
    std::f64::consts::FRAC_PI_2 / agm(1.0, (1.0 - k_squared).sqrt())
}

fn agm(mut a: f64, mut b: f64) -> f64 {
    // Each round doubles the digits.
    for _ in 0..8 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}
