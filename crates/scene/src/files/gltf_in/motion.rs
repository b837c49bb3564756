//! Mass and velocity of a node with `motion`.

use super::extension::Motion;
use backstop::Error;
use backstop::MassProperties;
use backstop::limits::{finite, finite3, unit_quat, within};
use backstop::math::Quat;
use backstop::{BodyDesc, BodyKind};
use glam::{DMat3, Mat3, Vec3};

/// Density that shapes have in a scene file, which can only give a mass [kg/m³].
const DENSITY: f32 = 1000.0;

/// Puts a motion on a body that has its pose and shapes. `scale`: linear map from the node's frame to the
/// body's. Returns notes about properties that are not supported exactly.
pub(super) fn apply(motion: &Motion, scale: DMat3, desc: &mut BodyDesc) -> Result<Vec<&'static str>, Error> {
    let mut notes = Vec::new();
    // Velocities are given along the node's axes, but in the world's units: not scaled.
    desc.linear_velocity = desc.rotation * finite3("linear velocity", motion.linear_velocity.into())?;
    desc.angular_velocity = desc.rotation * finite3("angular velocity", motion.angular_velocity.into())?;
    let extras = &motion.extras;
    (desc.max_linear_speed, desc.max_angular_speed) = (extras.max_linear_speed, extras.max_angular_speed);
    (desc.linear_damping, desc.angular_damping) = (extras.linear_damping, extras.angular_damping);
    desc.gravity_scale = finite("gravity factor", motion.gravity_factor.unwrap_or(1.0))?;
    if desc.kind == BodyKind::Kinematic {
        // Its mass never counts, but its centre moves at the linear velocity.
        desc.gravity_scale = 1.0;
    }

    let given = (motion.mass, motion.center_of_mass, motion.inertia_diagonal);
    if given == (None, None, None) && !desc.shapes.is_empty() {
        return Ok(notes);
    }
    if let Some(mass) = motion.mass {
        within("mass", mass, 0.0, f32::MAX, "at least zero")?;
    }
    let infinite_mass = motion.mass == Some(0.0);
    let mut mass = from_shapes(desc, motion.mass.filter(|&m| m > 0.0));
    if let Some(center) = motion.center_of_mass {
        let center = finite3("centre of mass", center.into())?;
        // Only the centre: the inertia about it stays that of the shapes about theirs, as if the shapes were
        // shifted to it.
        mass.centre_of_mass = (scale * center.as_dvec3()).as_vec3();
    }
    if let Some(diagonal) = motion.inertia_diagonal {
        let diagonal = finite3("inertia", diagonal.into())?;
        within("inertia", diagonal.min_element(), 0.0, f32::MAX, "at least zero")?;
        let turn = match motion.inertia_orientation {
            Some(q) => unit_quat("inertia orientation", Quat::from_array(q))?,
            None => Quat::IDENTITY,
        };
        if let Some(diagonal) = lock_infinite(diagonal, turn, desc, &mut notes) {
            let r = turn.matrix();
            mass.inertia = r * Mat3::from_diagonal(possible(diagonal, &mut notes)) * r.transpose();
        }
    }
    if infinite_mass {
        desc.lock_translation = [true; 3];
        if motion.inertia_diagonal.is_none() {
            // The inertia of an infinite mass is infinite too.
            desc.lock_rotation = [true; 3];
        }
        if desc.lock_rotation == [true; 3] && desc.kind == BodyKind::Dynamic {
            // Nothing can change the velocity of a kinematic body.
            desc.kind = BodyKind::Kinematic;
            (desc.lock_translation, desc.lock_rotation) = ([false; 3], [false; 3]);
        } else if desc.linear_velocity != Vec3::ZERO {
            notes.push("a body of infinite mass and finite inertia turns but stays where it is");
        }
    }
    if desc.kind == BodyKind::Kinematic && motion.center_of_mass.is_none() {
        return Ok(notes);
    }
    mass.validate()?;
    desc.mass = Some(mass);
    Ok(notes)
}

/// Mass, centre and inertia of all shapes together, scaled to `mass` if it is given.
fn from_shapes(desc: &BodyDesc, mass: Option<f32>) -> MassProperties {
    let of = |s: &backstop::ShapeDesc| {
        MassProperties::of(&s.geometry, DENSITY).transformed(s.position, s.rotation)
    };
    let total = MassProperties::combine(&desc.shapes.iter().map(of).collect::<Vec<_>>());
    if total.mass > 0.0 {
        return mass.map_or(total, |m| total.scaled_to(m));
    }
    // It has no shapes, so its inertia has no visible effect: take that of a mass 1 m away from the axis.
    let mass = mass.unwrap_or(1.0);
    MassProperties { mass, centre_of_mass: Vec3::ZERO, inertia: Mat3::from_diagonal(Vec3::splat(mass)) }
}

/// Axes of infinite inertia (zero in the file) can't turn: the body's lock is about the world's axes, so the
/// nearest are taken. Returns moments for the others, unless all are locked.
fn lock_infinite(
    diagonal: Vec3,
    turn: Quat,
    desc: &mut BodyDesc,
    notes: &mut Vec<&'static str>,
) -> Option<Vec3> {
    let fill = diagonal.max_element();
    if fill == 0.0 {
        desc.lock_rotation = [true; 3];
        return None;
    }
    let mut out = diagonal;
    for (i, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
        if diagonal[i] == 0.0 {
            let world = (Quat::from(desc.rotation) * turn * axis).abs();
            let nearest = world.max_position();
            if world[nearest] < 0.9999 {
                notes
                    .push("infinite inertia about an axis that is not the world's locks the nearest that is");
            }
            desc.lock_rotation[nearest] = true;
            out[i] = fill;
        }
    }
    Some(out)
}

/// No solid has a principal moment above the sum of the other two: raises those two if one is.
fn possible(mut diagonal: Vec3, notes: &mut Vec<&'static str>) -> Vec3 {
    let largest = diagonal.max_position();
    let missing = 2.0 * diagonal[largest] - diagonal.element_sum();
    if missing > 1e-4 * diagonal[largest] {
        notes.push("moments of inertia that no solid can have: the two smaller ones are raised");
        let kept = diagonal[largest];
        diagonal += Vec3::splat(0.5 * missing);
        diagonal[largest] = kept;
    }
    diagonal
}
