//! Plain values: numbers, vectors, handles.

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{Aabb, BodyHandle, CharacterHandle, CouplingHandle, JointHandle, ShapeHandle};

/// Yes or no: zero is no, all else is yes. No C `bool`, whose other bytes would be undefined behaviour.
pub type BsBool = u8;

/// A vector, in single precision.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BsVec3 {
    /// To the right.
    pub x: f32,
    /// Up.
    pub y: f32,
    /// Towards the viewer.
    pub z: f32,
}

/// A position in the world [m].
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BsDVec3 {
    /// To the right.
    pub x: f64,
    /// Up.
    pub y: f64,
    /// Towards the viewer.
    pub z: f64,
}

/// A rotation, as a unit quaternion: (0, 0, 0, 1) is none.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsQuat {
    /// Imaginary.
    pub x: f32,
    /// Imaginary.
    pub y: f32,
    /// Imaginary.
    pub z: f32,
    /// Real.
    pub w: f32,
}

impl BsQuat {
    /// No rotation.
    pub(crate) const IDENTITY: BsQuat = BsQuat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
}

/// Defines a handle and its conversions.
macro_rules! convert_handle {
    ($own:ident, $engine:ident) => {
        impl From<$engine> for $own {
            fn from(handle: $engine) -> $own {
                let bits = handle.to_bits();
                $own { slot: bits as u32, generation: (bits >> 32) as u32 }
            }
        }

        impl From<$own> for $engine {
            fn from(handle: $own) -> $engine {
                $engine::from_bits(u64::from(handle.generation) << 32 | u64::from(handle.slot))
            }
        }

        impl $own {
            /// A handle of nothing.
            pub const NONE: $own = $own { slot: 0, generation: 0 };
        }
    };
}

/// A body of a world. Stale once the body is removed: a stale handle is an error, never another body. All
/// zeros is no body. Of which world it is nobody knows.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BsBody {
    /// Place in the world.
    pub slot: u32,
    /// How often the place was taken.
    pub generation: u32,
}

/// A shape on a body. Stale once it or its body is removed. All zeros is no shape.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BsShape {
    /// Place in the world.
    pub slot: u32,
    /// How often the place was taken.
    pub generation: u32,
}

/// A joint between two bodies. Stale once it breaks, or it or one of its bodies is removed. All zeros is no
/// joint.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BsJoint {
    /// Place in the world.
    pub slot: u32,
    /// How often the place was taken.
    pub generation: u32,
}

/// A coupling of two motions of joints. Stale once it breaks, or it or one of its joints is removed. All
/// zeros is no coupling.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BsCoupling {
    /// Place in the world.
    pub slot: u32,
    /// How often the place was taken.
    pub generation: u32,
}

/// A character that lives in a world. Stale once it is removed. All zeros is no character.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BsWorldCharacter {
    /// Place in the world.
    pub slot: u32,
    /// How often the place was taken.
    pub generation: u32,
}

convert_handle!(BsBody, BodyHandle);
convert_handle!(BsShape, ShapeHandle);
convert_handle!(BsJoint, JointHandle);
convert_handle!(BsCoupling, CouplingHandle);
convert_handle!(BsWorldCharacter, CharacterHandle);

/// Where a body is and how it is turned.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsPose {
    /// Position of the origin [m].
    pub position: BsDVec3,
    /// Rotation of the axes.
    pub rotation: BsQuat,
}

/// A box along the axes of the world.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BsAabb {
    /// Its low corner [m].
    pub min: BsDVec3,
    /// Its high corner [m].
    pub max: BsDVec3,
}

impl From<BsAabb> for Aabb {
    fn from(aabb: BsAabb) -> Aabb {
        Aabb { min: aabb.min.into(), max: aabb.max.into() }
    }
}

impl From<Aabb> for BsAabb {
    fn from(aabb: Aabb) -> BsAabb {
        BsAabb { min: aabb.min.into(), max: aabb.max.into() }
    }
}

impl From<(DVec3, Quat)> for BsPose {
    fn from((position, rotation): (DVec3, Quat)) -> BsPose {
        BsPose { position: position.into(), rotation: rotation.into() }
    }
}

impl From<BsVec3> for Vec3 {
    fn from(v: BsVec3) -> Vec3 {
        Vec3::new(v.x, v.y, v.z)
    }
}

impl From<Vec3> for BsVec3 {
    fn from(v: Vec3) -> BsVec3 {
        BsVec3 { x: v.x, y: v.y, z: v.z }
    }
}

impl From<BsDVec3> for DVec3 {
    fn from(v: BsDVec3) -> DVec3 {
        DVec3::new(v.x, v.y, v.z)
    }
}

impl From<DVec3> for BsDVec3 {
    fn from(v: DVec3) -> BsDVec3 {
        BsDVec3 { x: v.x, y: v.y, z: v.z }
    }
}

impl From<BsQuat> for Quat {
    fn from(q: BsQuat) -> Quat {
        Quat::from_xyzw(q.x, q.y, q.z, q.w)
    }
}

impl From<Quat> for BsQuat {
    fn from(q: Quat) -> BsQuat {
        BsQuat { x: q.x, y: q.y, z: q.z, w: q.w }
    }
}
