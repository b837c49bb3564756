//! Mass, centre and inertia.

use crate::abi::guard::call;
use crate::abi::pointers::{Out, slice};
use crate::abi::status::BsStatus;
use crate::abi::values::{BsBody, BsQuat, BsVec3};
use crate::world::{BsWorld, changing, reading};
use backstop::MassProperties;
use backstop::glam::Mat3;

/// Mass, centre and inertia of a solid.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsMassProperties {
    /// [kg]
    pub mass: f32,
    /// In the frame of the shape or body [m].
    pub centre_of_mass: BsVec3,
    /// About the centre, in the axes of the shape or body [kg m²]: a symmetric matrix.
    pub inertia: [f32; 9],
}

impl BsMassProperties {
    pub(crate) fn to_engine(self) -> MassProperties {
        let inertia = Mat3::from_cols_array(&self.inertia);
        MassProperties { mass: self.mass, centre_of_mass: self.centre_of_mass.into(), inertia }
    }

    pub(crate) fn of_engine(mass: MassProperties) -> BsMassProperties {
        let inertia = mass.inertia.to_cols_array();
        BsMassProperties { mass: mass.mass, centre_of_mass: mass.centre_of_mass.into(), inertia }
    }
}

/// A solid that is turned and then moved [m], as from a shape's frame into its body's.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_mass_transformed(
    mass: BsMassProperties,
    position: BsVec3,
    rotation: BsQuat,
    out: *mut BsMassProperties,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let out = unsafe { Out::new("the place for the mass", out) }?;
        let moved = mass.to_engine().transformed(position.into(), rotation.into());
        out.set(BsMassProperties::of_engine(moved));
        Ok(())
    })
}

/// Several solids as one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_mass_combined(
    parts: *const BsMassProperties,
    count: usize,
    out: *mut BsMassProperties,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (out, parts) =
            unsafe { (Out::new("the place for the mass", out)?, slice("the parts", parts, count)?) };
        let parts: Vec<_> = parts.iter().map(|part| part.to_engine()).collect();
        out.set(BsMassProperties::of_engine(MassProperties::combine(&parts)));
        Ok(())
    })
}

/// Mass of a body [kg]; zero for static and kinematic bodies.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_mass(world: *const BsWorld, body: BsBody, mass: *mut f32) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Out::new("the place for the mass", mass)?) };
        out.set(content.mass(body.into())?);
        Ok(())
    })
}

/// Replaces the mass of a body; from now on it does not follow from the shapes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_set_mass(
    world: *mut BsWorld,
    body: BsBody,
    mass: BsMassProperties,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.set_mass(body.into(), mass.to_engine())?))
}

/// Position of a body's centre of mass in the world [m].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_centre_of_mass(
    world: *const BsWorld,
    body: BsBody,
    centre: *mut crate::abi::values::BsDVec3,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Out::new("the place for the centre", centre)?) };
        out.set(content.centre_of_mass(body.into())?.into());
        Ok(())
    })
}
