//! Description of a body.

use crate::abi::pointers::borrow;
use crate::abi::sized::read_all;
use crate::abi::status::{Outcome, Refusal};
use crate::abi::twin::{Twin, codes, record};
use crate::abi::values::{BsBool, BsDVec3, BsQuat, BsVec3};
use crate::mass::BsMassProperties;
use crate::settings::{BsContinuousMode, BsRowGroup};
use crate::shape::BsShapeDesc;
use backstop::{BodyDesc, BodyKind};
use std::ptr::null;

/// What moves a body, one of `BS_BODY_...`.
pub type BsBodyKind = u32;
/// Nothing: it has no velocity.
pub const BS_BODY_STATIC: BsBodyKind = 0;
/// Its velocity alone: it pushes and is not pushed.
pub const BS_BODY_KINEMATIC: BsBodyKind = 1;
/// Forces and contacts.
pub const BS_BODY_DYNAMIC: BsBodyKind = 2;

codes! { "kind of body", BodyKind {
    BS_BODY_STATIC = BodyKind::Static,
    BS_BODY_KINEMATIC = BodyKind::Kinematic,
    BS_BODY_DYNAMIC = BodyKind::Dynamic,
} }

/// Axes of the world that a body can't move along or turn about, as bits: x is 1, y is 2, z is 4.
pub type BsAxes = u8;
/// The x axis.
pub const BS_AXIS_BIT_X: BsAxes = 1;
/// The y axis.
pub const BS_AXIS_BIT_Y: BsAxes = 2;
/// The z axis.
pub const BS_AXIS_BIT_Z: BsAxes = 4;

record! {
    /// A body to be added.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsBodyDesc of desc: BodyDesc {
        /// Size of this struct; `bs_body_desc_default` fills it in.
        pub size: u32 = size_of::<BsBodyDesc>() as u32,
        /// What moves it. Default dynamic.
        pub kind: BsBodyKind,
        /// Where its origin is [m].
        pub position: BsDVec3,
        /// How its axes are turned.
        pub rotation: BsQuat,
        /// Velocity of its centre of mass [m/s].
        pub linear_velocity: BsVec3,
        /// About the world's axes [rad/s].
        pub angular_velocity: BsVec3,
        /// Its shapes; several make a compound. Each has the size that the first says.
        pub shapes: *const BsShapeDesc = null(),
        /// Number of shapes.
        pub shape_count: usize = 0,
        /// Mass, centre and inertia; null: from the shapes and their densities.
        pub mass: *const BsMassProperties = null(),
        /// Factor on gravity. Default 1.
        pub gravity_scale: f32,
        /// How it is kept from passing through others. Default `BS_CONTINUOUS_SEGMENT`.
        pub continuous: BsContinuousMode,
        /// Its rows are solved right after those of this group, if that is later. Default `BS_ROWS_NONE`.
        pub solved_after: BsRowGroup,
        /// World axes along which it can't move, as bits of `BS_AXIS_BIT_...`.
        pub lock_translation: BsAxes,
        /// World axes about which it can't turn.
        pub lock_rotation: BsAxes,
        /// Whether it may fall asleep. Default yes.
        pub can_sleep: BsBool,
        /// Zero.
        pub reserved: u8 = 0,
        /// Free for the caller.
        pub user_data: u64,
        /// Linear velocity decays as exp(-c t), at least zero [1/s]. Default 0.
        pub linear_damping: f32,
        /// The same of angular velocity [1/s]. Default 0.
        pub angular_damping: f32,
        /// No step leaves it faster, above zero [m/s]; infinity for no cap. Default infinity.
        pub max_linear_speed: f32,
        /// The same of angular speed [rad/s]. Default infinity.
        pub max_angular_speed: f32,
    }
    default bs_body_desc_default()
}

/// A dynamic body at the origin, at rest, without shapes.
#[unsafe(no_mangle)]
pub extern "C" fn bs_body_desc_default() -> BsBodyDesc {
    BsBodyDesc::of_engine(&BodyDesc::dynamic())
}

/// A cap on a speed; infinity is none.
impl Twin<Option<f32>> for f32 {
    fn read(self) -> Outcome<Option<f32>> {
        Ok((self != f32::INFINITY).then_some(self))
    }

    fn write(cap: &Option<f32>) -> f32 {
        cap.unwrap_or(f32::INFINITY)
    }
}

impl Twin<[bool; 3]> for BsAxes {
    fn read(self) -> Outcome<[bool; 3]> {
        if self > 7 {
            let what = "set of axes";
            return Err(Refusal::Constant { what, value: self.into() });
        }
        Ok([0, 1, 2].map(|axis| self >> axis & 1 == 1))
    }

    fn write(axes: &[bool; 3]) -> BsAxes {
        axes.iter().rev().fold(0, |bits, &set| bits << 1 | BsAxes::from(set))
    }
}

impl BsBodyDesc {
    /// # Safety
    /// Its pointers are null or valid, with those of its shapes.
    pub(crate) unsafe fn to_engine(self) -> Outcome<BodyDesc> {
        let mut desc = self.on(BodyDesc::dynamic())?;
        // SAFETY: as this function.
        for shape in unsafe { read_all(self.shapes, self.shape_count) }? {
            // SAFETY: as this function.
            desc.shapes.push(unsafe { shape.to_engine() }?);
        }
        if !self.mass.is_null() {
            // SAFETY: as this function.
            desc.mass = Some(unsafe { borrow("the mass", self.mass) }?.to_engine());
        }
        Ok(desc)
    }
}
