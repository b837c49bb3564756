//! Descriptions with one number at a place of each.

use backstop::glam::{Mat3, Vec3};
use backstop::{
    Axes, Axis, CharacterSettings, Geometry, Limit, MassProperties, Material, Motion, Motor, Settings, Spring,
};

pub(super) fn mass() -> MassProperties {
    MassProperties { mass: 1.0, centre_of_mass: Vec3::ZERO, inertia: Mat3::IDENTITY }
}

/// The name of a number, and the object made of it.
type Of<T> = (&'static str, fn(f32) -> T);
/// The name of a number, and how it changes something.
type Changed<T> = (&'static str, fn(T, f32) -> T);

pub(super) fn masses() -> [Of<MassProperties>; 8] {
    [
        ("mass", |x| MassProperties { mass: x, ..mass() }),
        ("centre.x", |x| MassProperties { centre_of_mass: Vec3::new(x, 0.0, 0.0), ..mass() }),
        ("centre.y", |x| MassProperties { centre_of_mass: Vec3::new(0.0, x, 0.0), ..mass() }),
        ("centre.z", |x| MassProperties { centre_of_mass: Vec3::new(0.0, 0.0, x), ..mass() }),
        ("inertia", |x| MassProperties { inertia: Mat3::from_diagonal(Vec3::splat(x)), ..mass() }),
        ("inertia.xx", |x| MassProperties { inertia: Mat3::from_diagonal(Vec3::new(x, 1.0, 1.0)), ..mass() }),
        ("inertia.xy", |x| {
            let mut inertia = Mat3::IDENTITY;
            (inertia.x_axis.y, inertia.y_axis.x) = (x, x);
            MassProperties { inertia, ..mass() }
        }),
        ("all", |x| MassProperties {
            mass: x,
            centre_of_mass: Vec3::splat(x),
            inertia: Mat3::from_diagonal(Vec3::splat(x)),
        }),
    ]
}

pub(super) fn materials() -> [Of<Material>; 8] {
    [
        ("static friction", |x| Material::default().with_static_friction(x)),
        ("dynamic friction", |x| Material::default().with_dynamic_friction(x)),
        ("restitution", |x| Material::default().with_restitution(x)),
        ("rolling friction", |x| Material::default().with_rolling_friction(x)),
        ("spinning friction", |x| Material::default().with_spinning_friction(x)),
        ("surface velocity", |x| Material::default().with_surface_velocity(Vec3::new(x, 0.0, 0.0))),
        ("contact hertz", |x| Material::default().with_contact_hertz(x)),
        ("contact damping", |x| Material::default().with_contact_hertz(10.0).with_contact_damping(x)),
    ]
}

pub(super) fn forms() -> [Of<Geometry>; 10] {
    [
        ("sphere", Geometry::sphere),
        ("box.x", |x| Geometry::cuboid(x, 0.3, 0.3)),
        ("box.y", |x| Geometry::cuboid(0.3, x, 0.3)),
        ("box.z", |x| Geometry::cuboid(0.3, 0.3, x)),
        ("capsule height", |x| Geometry::capsule(x, 0.3)),
        ("capsule radius", |x| Geometry::tapered_capsule(0.3, x, 0.3)),
        ("capsule top", |x| Geometry::tapered_capsule(0.3, 0.3, x)),
        ("cylinder height", |x| Geometry::cylinder(x, 0.3)),
        ("cylinder radius", |x| Geometry::tapered_cylinder(0.3, x, 0.3)),
        ("cylinder top", |x| Geometry::tapered_cylinder(0.3, 0.3, x)),
    ]
}

pub(super) fn settings() -> [Changed<Settings>; 12] {
    [
        ("gravity.x", |s, x| s.with_gravity(Vec3::new(x, 0.0, 0.0))),
        ("gravity.y", |s, x| s.with_gravity(Vec3::new(0.0, x, 0.0))),
        ("length unit", |s, x| s.with_length_unit(x)),
        ("restitution threshold", |s, x| s.with_restitution_threshold(x)),
        ("slop", |s, x| s.with_slop(x)),
        ("contact hertz", |s, x| s.with_contact_hertz(x)),
        ("contact damping", |s, x| s.with_contact_damping(x)),
        ("push speed", |s, x| s.with_push_speed(x)),
        ("hit speed", |s, x| s.with_hit_speed(x)),
        ("sleep speed", |s, x| s.with_sleep_speed(x)),
        ("sleep time", |s, x| s.with_sleep_time(x)),
        ("substeps", |s, x| s.with_substeps(x as u32)),
    ]
}

pub(super) fn drives() -> [Of<Motor>; 9] {
    [
        ("velocity", |x| Motor::velocity(Motion::Angular, Axis::X, x, 10.0)),
        ("linear velocity", |x| Motor::velocity(Motion::Linear, Axis::Y, x, 10.0)),
        ("force", |x| Motor::velocity(Motion::Angular, Axis::X, 1.0, x)),
        ("position", |x| {
            let spring = Spring::Frequency { hertz: 2.0, ratio: 1.0 };
            Motor::position(Motion::Angular, Axis::X, x, spring)
        }),
        ("stiffness", |x| {
            let spring = Spring::Coefficients { stiffness: x, damping: 1.0 };
            Motor::position(Motion::Angular, Axis::X, 0.1, spring)
        }),
        ("damping", |x| {
            let spring = Spring::Coefficients { stiffness: 1.0, damping: x };
            Motor::position(Motion::Angular, Axis::X, 0.1, spring)
        }),
        ("acceleration", |x| {
            let spring = Spring::Acceleration { stiffness: x, damping: x };
            Motor::position(Motion::Angular, Axis::X, 0.1, spring)
        }),
        ("hertz", |x| {
            Motor::position(Motion::Angular, Axis::X, 0.1, Spring::Frequency { hertz: x, ratio: 1.0 })
        }),
        ("ratio", |x| {
            Motor::position(Motion::Angular, Axis::X, 0.1, Spring::Frequency { hertz: 2.0, ratio: x })
        }),
    ]
}

pub(super) fn limits() -> [Of<Limit>; 5] {
    [
        ("min", |x| Limit::new(Motion::Angular, Axes::One(Axis::X), x, 0.5)),
        ("max", |x| Limit::new(Motion::Angular, Axes::One(Axis::X), -0.5, x)),
        ("distance", |x| Limit::new(Motion::Linear, Axes::All, 0.0, x)),
        ("rod", |x| Limit::new(Motion::Linear, Axes::All, x, x)),
        ("spring", |x| {
            let spring = Spring::Coefficients { stiffness: x, damping: x };
            Limit::new(Motion::Angular, Axes::One(Axis::X), -0.1, 0.1).with_spring(spring)
        }),
    ]
}

pub(super) fn walkers() -> [Changed<CharacterSettings>; 10] {
    [
        ("radius", |s, x| CharacterSettings { radius: x, ..s }),
        ("half height", |s, x| CharacterSettings { half_height: x, ..s }),
        ("skin", |s, x| CharacterSettings { skin: x, ..s }),
        ("slope", |s, x| CharacterSettings { max_slope: x, ..s }),
        ("step", |s, x| CharacterSettings { step_height: x, ..s }),
        ("snap", |s, x| CharacterSettings { snap: x, ..s }),
        ("up.y", |s, x| CharacterSettings { up: Vec3::new(0.0, x, 0.0), ..s }),
        ("up.x", |s, x| CharacterSettings { up: Vec3::new(x, 1.0, 0.0), ..s }),
        ("mass", |s, x| CharacterSettings { mass: x, ..s }),
        ("strength", |s, x| CharacterSettings { strength: x, ..s }),
    ]
}
