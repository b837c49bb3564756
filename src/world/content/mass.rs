//! Mass of the world's bodies: given by the caller, or computed from their shapes.

use crate::body::{BodyDetails, BodyKind, KeptMass, Mass, Pose, RareCounts};
use crate::error::Error;
use crate::handle::BodyHandle;
use crate::limits::MAX_LEFT_SPEED;
use crate::math::Quat;
use crate::shape::{MassProperties, ShapeDesc};
use crate::world::{Addition, Change, World};
use glam::Vec3;

/// # Mass
impl World {
    /// Mass of a body [kg]; zero for static and kinematic bodies.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn mass(&self, body: BodyHandle) -> Result<f32, Error> {
        Ok(self.bodies.details[self.index(body)?].mass)
    }

    /// Mass, centre of mass and inertia of a body in its own axes, as if no axis were locked. Of a static or
    /// kinematic body those that it would have as a dynamic one, all zero if it has none.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn mass_properties(&self, body: BodyHandle) -> Result<MassProperties, Error> {
        let index = self.index(body)?;
        let (details, moments) = (&self.bodies.details[index], self.bodies.mass[index].inertia);
        if self.bodies.kind[index] == BodyKind::Dynamic {
            let BodyDetails { mass, centre, axes, .. } = *details;
            return Ok(MassProperties::from_principal(mass, centre, moments, axes));
        }
        Ok(self.idle_mass(index))
    }

    /// Whether the mass of a body follows from its shapes and their densities, and was not given.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn has_mass_from_shapes(&self, body: BodyHandle) -> Result<bool, Error> {
        Ok(self.bodies.details[self.index(body)?].mass_from_shapes)
    }

    /// The mass that a static or kinematic body would have as a dynamic one.
    fn idle_mass(&self, index: usize) -> MassProperties {
        let details = &self.bodies.details[index];
        if details.mass_from_shapes {
            let parts: Vec<MassProperties> = self.parts_of(index).collect();
            return MassProperties::combine(&parts);
        }
        let kept = self.bodies.rare.kept_mass.get(self.bodies.slot[index]);
        kept.map_or(MassProperties::ZERO, |KeptMass { mass, moments }| {
            MassProperties::from_principal(mass, details.centre, moments, details.axes)
        })
    }

    /// The mass of a body that is to become dynamic.
    ///
    /// # Errors
    /// If it has none, or a shape that a dynamic body can't have.
    pub(in crate::world) fn mass_as_dynamic(&self, index: usize) -> Result<MassProperties, Error> {
        for &c in self.bodies.colliders[index].as_slice() {
            self.colliders.all[c as usize].geometry.require_convex()?;
        }
        let mass = self.idle_mass(index);
        if mass.mass <= 0.0 {
            return Err(Error::NoMass);
        }
        movable(&mass)?;
        Ok(mass)
    }

    /// Replaces the mass of a body; from now on it does not follow from the shapes. Mass that was given
    /// before and that [`World::mass_properties`] returns changes nothing.
    ///
    /// # Errors
    /// If the handle is stale or the properties are not those of a body.
    pub fn set_mass(&mut self, body: BodyHandle, mass: MassProperties) -> Result<(), Error> {
        let index = self.index(body)?;
        mass.validate()?;
        movable(&mass)?;
        if !self.bodies.details[index].mass_from_shapes && self.mass_properties(body)? == mass {
            return Ok(());
        }
        if self.bodies.kind[index] != BodyKind::Dynamic {
            self.reserve(Addition::Rare(RareCounts { kept_masses: 1, ..RareCounts::default() }))?;
        }
        self.note(Change::SetMass(body, mass));
        let index = self.wake_body(index);
        self.revise(index);
        self.bodies.details[index].mass_from_shapes = false;
        self.replace_mass(index, &mass);
        Ok(())
    }

    pub(in crate::world) fn refresh_mass(&mut self, index: usize) {
        let parts: Vec<MassProperties> = self.parts_of(index).collect();
        self.replace_mass(index, &MassProperties::combine(&parts));
    }

    /// Mass of each shape of a body, in the body's axes.
    pub(in crate::world) fn parts_of(&self, index: usize) -> impl Iterator<Item = MassProperties> + '_ {
        let details = self.bodies.details[index];
        self.bodies.colliders[index].as_slice().iter().map(move |&c| {
            let c = &self.colliders.all[c as usize];
            let (position, rotation) =
                (details.centre + details.axes * c.position, details.axes * c.rotation);
            MassProperties::of(&c.geometry, c.density).transformed(position, rotation.into())
        })
    }

    /// Moves the centre of mass and the principal axes; the colliders stay in place.
    pub(in crate::world) fn replace_mass(&mut self, index: usize, mass: &MassProperties) {
        let old = self.bodies.details[index];
        let MassColumns { details, mass: columns, kept } =
            columns_of(mass, self.bodies.kind[index], old.user_data, old.mass_from_shapes);
        self.bodies.rare.kept_mass.set(self.bodies.slot[index], kept);
        let pose = self.bodies.pose[index];
        let body = pose.rotation * old.axes.conjugate();
        let shift = body * (details.centre - old.centre);
        self.bodies.pose[index] =
            Pose { position: pose.position + shift.as_dvec3(), rotation: (body * details.axes).normalize() };
        let velocity = &mut self.bodies.velocity[index];
        let most = Vec3::splat(MAX_LEFT_SPEED);
        velocity.linear = (velocity.linear + velocity.angular.cross(shift)).clamp(-most, most);
        self.bodies.details[index] = details;
        self.bodies.set_mass(index, columns);
        // A body that can't rotate is in no tree.
        let joined = self.joints.of_body(self.bodies.slot[index]).next().is_some();
        self.joints.changed |= joined;
        self.recentre_joints(index, &old);
        self.note_move(index);
        for &c in self.bodies.colliders[index].as_slice() {
            let c = &mut self.colliders.all[c as usize];
            c.position = details.axes.conjugate() * (old.centre + old.axes * c.position - details.centre);
            c.rotation = (details.axes.conjugate() * old.axes * c.rotation).normalize();
        }
        for &c in self.bodies.colliders[index].as_slice() {
            let summaries = &mut self.colliders.summaries[c as usize];
            *summaries = self.colliders.all[c as usize].summaries(summaries.mode);
        }
    }
}

/// Checks that mass, inertia and their inverses are finite.
pub(in crate::world) fn movable(mass: &MassProperties) -> Result<(), Error> {
    let m = &mass.inertia;
    for (what, value) in [
        ("mass", mass.mass),
        ("moment of inertia", m.x_axis.x),
        ("moment of inertia", m.y_axis.y),
        ("moment of inertia", m.z_axis.z),
    ] {
        crate::limits::inertia(what, value)?;
    }
    Ok(())
}

pub(in crate::world) fn mass_of(shapes: &[ShapeDesc]) -> MassProperties {
    let parts: Vec<MassProperties> = shapes
        .iter()
        .map(|s| MassProperties::of(&s.geometry, s.density).transformed(s.position, s.rotation))
        .collect();
    MassProperties::combine(&parts)
}

/// The column entries for a body's mass.
pub(in crate::world) struct MassColumns {
    pub(in crate::world) details: BodyDetails,
    pub(in crate::world) mass: Mass,
    /// If it was given, and the body is not dynamic.
    pub(in crate::world) kept: Option<KeptMass>,
}

/// Computes the column entries for a body's mass.
pub(in crate::world) fn columns_of(
    mass: &MassProperties,
    kind: BodyKind,
    user_data: u64,
    mass_from_shapes: bool,
) -> MassColumns {
    // Rounding must not turn the axes of a body that is aligned with them already.
    let (m, tiny) =
        (mass.inertia, 1e-6 * mass.inertia.x_axis.x.max(mass.inertia.y_axis.y).max(mass.inertia.z_axis.z));
    let aligned = [m.x_axis.y, m.x_axis.z, m.y_axis.z].iter().all(|x| x.abs() <= tiny);
    let (moments, axes) = if aligned {
        (Vec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z), Quat::IDENTITY)
    } else {
        let (moments, axes) = mass.principal();
        (moments, axes.into())
    };
    let over = |x: f32| if x > 0.0 && x.is_finite() { 1.0 / x } else { 0.0 };
    let details =
        BodyDetails { centre: mass.centre_of_mass, axes, mass: mass.mass, mass_from_shapes, user_data };
    if kind != BodyKind::Dynamic {
        let kept = (!mass_from_shapes).then_some(KeptMass { mass: mass.mass, moments });
        return MassColumns { details: BodyDetails { mass: 0.0, ..details }, mass: Mass::default(), kept };
    }
    let inverse_inertia = Vec3::new(over(moments.x), over(moments.y), over(moments.z));
    let columns = Mass { inverse: over(mass.mass), inertia: moments, inverse_inertia };
    MassColumns { details, mass: columns, kept: None }
}
