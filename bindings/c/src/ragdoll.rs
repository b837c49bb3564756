//! Ragdolls: bodies and joints out of a skeleton.

mod driven;

pub use driven::*;

use crate::abi::guard::call;
use crate::abi::pointers::Buffer;
use crate::abi::sized::{read, read_all};
use crate::abi::status::{BsStatus, Outcome, Refusal};
use crate::abi::twin::record;
use crate::abi::values::{BsBody, BsJoint, BsPose, BsVec3};
use crate::shape::{BsFilter, BsMaterial, BsSurface, bs_filter_default, bs_material_default};
use crate::world::{BsWorld, changing};
use backstop::glam::Quat;
use backstop::{Bone, BoneJoint, Filter, Skeleton};
use std::ptr::null;

/// How a bone moves on its parent, one of `BS_BONE_...`.
pub type BsBoneKind = u32;
/// Not at all.
pub const BS_BONE_FIXED: BsBoneKind = 0;
/// Within a cone of `swing`, with a twist of up to `twist` to either side.
pub const BS_BONE_BALL: BsBoneKind = 1;
/// About `axis`, from `min` to `max`.
pub const BS_BONE_HINGE: BsBoneKind = 2;

/// No parent: a root.
pub const BS_NO_BONE: u32 = u32::MAX;

record! {
    /// A bone: a capsule on its parent.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsBoneDesc {
        /// Size of this struct; `bs_bone_desc_default` fills it in.
        pub size: u32,
        /// A bone before this one, or `BS_NO_BONE`.
        pub parent: u32,
        /// Where it hangs on its parent [m].
        pub joint_at: BsVec3,
        /// One end of the capsule, cap included [m].
        pub from: BsVec3,
        /// The other end.
        pub to: BsVec3,
        /// [m]
        pub radius: f32,
        /// How it moves on its parent.
        pub joint: BsBoneKind,
        /// Half the angle of the cone of a ball, 0..=pi [rad].
        pub swing: f32,
        /// To either side, of a ball, 0..=pi [rad].
        pub twist: f32,
        /// Hinges: the axis, in the skeleton's axes; its length does not matter.
        pub axis: BsVec3,
        /// Hinges: the least angle, at most zero [rad].
        pub min: f32,
        /// Hinges: the greatest angle, at least zero [rad].
        pub max: f32,
    }
    default bs_bone_desc_default()
}

const ZERO: BsVec3 = BsVec3 { x: 0.0, y: 0.0, z: 0.0 };

/// A root without length, which is refused.
#[unsafe(no_mangle)]
pub extern "C" fn bs_bone_desc_default() -> BsBoneDesc {
    BsBoneDesc {
        size: size_of::<BsBoneDesc>() as u32,
        parent: BS_NO_BONE,
        joint_at: ZERO,
        from: ZERO,
        to: ZERO,
        radius: 0.0,
        joint: BS_BONE_FIXED,
        swing: 0.0,
        twist: 0.0,
        axis: BsVec3 { x: 1.0, y: 0.0, z: 0.0 },
        min: 0.0,
        max: 0.0,
    }
}

record! {
    /// Bones with what they are made of.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsSkeletonDesc {
        /// Size of this struct; `bs_skeleton_desc_default` fills it in.
        pub size: u32,
        /// [kg/m³]. Default 1000.
        pub density: f32,
        /// Parents before children. Each has the size that the first says.
        pub bones: *const BsBoneDesc,
        /// Number of bones.
        pub bone_count: usize,
        /// Material of all bones.
        pub material: BsMaterial,
        /// Filter of all bones. Neighbours never collide.
        pub filter: BsFilter,
        /// Torque of friction in each joint [N m]. Default 0.
        pub friction: f32,
        /// Zero.
        pub reserved: u32,
        /// Friction against rolling and spinning of all bones, and a belt. Default none.
        pub surface: BsSurface,
    }
    default bs_skeleton_desc_default()
}

/// A skeleton of ordinary flesh without bones.
#[unsafe(no_mangle)]
pub extern "C" fn bs_skeleton_desc_default() -> BsSkeletonDesc {
    BsSkeletonDesc {
        size: size_of::<BsSkeletonDesc>() as u32,
        density: 1000.0,
        bones: null(),
        bone_count: 0,
        material: bs_material_default(),
        filter: bs_filter_default(),
        friction: 0.0,
        reserved: 0,
        surface: BsSurface::NONE,
    }
}

impl BsBoneDesc {
    fn to_engine(self) -> Outcome<Bone> {
        let joint = match self.joint {
            BS_BONE_FIXED => BoneJoint::Fixed,
            BS_BONE_BALL => BoneJoint::Ball { swing: self.swing, twist: self.twist },
            BS_BONE_HINGE => BoneJoint::Hinge { axis: self.axis.into(), min: self.min, max: self.max },
            value => return Err(Refusal::Constant { what: "kind of bone", value }),
        };
        Ok(Bone {
            parent: (self.parent != BS_NO_BONE).then_some(self.parent as usize),
            joint_at: self.joint_at.into(),
            from: self.from.into(),
            to: self.to.into(),
            radius: self.radius,
            joint,
        })
    }

    fn of_engine(bone: &Bone) -> BsBoneDesc {
        let desc = BsBoneDesc {
            parent: bone.parent.map_or(BS_NO_BONE, |parent| parent as u32),
            joint_at: bone.joint_at.into(),
            from: bone.from.into(),
            to: bone.to.into(),
            radius: bone.radius,
            ..bs_bone_desc_default()
        };
        match bone.joint {
            BoneJoint::Ball { swing, twist } => BsBoneDesc { joint: BS_BONE_BALL, swing, twist, ..desc },
            BoneJoint::Hinge { axis, min, max } => {
                BsBoneDesc { joint: BS_BONE_HINGE, axis: axis.into(), min, max, ..desc }
            }
            // Fixed; other kinds have no constants yet.
            _ => desc,
        }
    }
}

/// The bones of a figure of 1.85 m with spread arms that stands at the origin and looks along z: pelvis,
/// torso and head, and upper and lower arms and legs. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_humanoid_bones(
    bones: *mut BsBoneDesc,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let out = unsafe { Buffer::new("bones", bones, capacity, count) }?;
        out.fill(Skeleton::humanoid().bones.iter().map(BsBoneDesc::of_engine))
    })
}

/// The engine's skeleton.
///
/// # Safety
/// The pointer is null or that of a description, which has as many bones as it says.
unsafe fn skeleton_of(desc: *const BsSkeletonDesc) -> Outcome<Skeleton> {
    // SAFETY: as this function.
    let desc = unsafe { read(desc) }?;
    // SAFETY: as this function.
    let bones = unsafe { read_all(desc.bones, desc.bone_count) }?;
    let bones = bones.into_iter().map(BsBoneDesc::to_engine).collect::<Outcome<_>>()?;
    Ok(Skeleton::new(bones)
        .with_density(desc.density)
        .with_material(desc.surface.with(desc.material)?)
        .with_filter(desc.filter.on(Filter::default())?)
        .with_friction(desc.friction))
}

/// Adds a skeleton that stands somewhere, turned, and moves [m/s]: a body for each bone, and a joint for each
/// that has a parent, in their order. `bodies` has a place for each bone; `joints` has `joint_capacity` of
/// them, and `joint_count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_add_ragdoll(
    world: *mut BsWorld,
    desc: *const BsSkeletonDesc,
    pose: BsPose,
    velocity: BsVec3,
    bodies: *mut BsBody,
    joints: *mut BsJoint,
    joint_capacity: usize,
    joint_count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, skeleton) = unsafe { (changing(world)?, skeleton_of(desc)?) };
        let bones = &skeleton.bones;
        let mut body_count = 0;
        // SAFETY: the caller keeps to the header.
        let (bodies, joints) = unsafe {
            let bodies = Buffer::new("bodies", bodies, bones.len(), &mut body_count)?;
            (bodies, Buffer::new("joints", joints, joint_capacity, joint_count)?)
        };
        joints.reserve(bones.iter().filter(|bone| bone.parent.is_some()).count())?;
        let (position, rotation) = (pose.position.into(), Quat::from(pose.rotation));
        let ragdoll = skeleton.add_to(&mut content.world, position, rotation, velocity.into())?;
        bodies.fill(ragdoll.bodies.into_iter().map(Into::into))?;
        joints.fill(ragdoll.joints.into_iter().map(Into::into))
    })
}
