//! Parts of a joint: limits, motors, frames.

use crate::abi::sized::read_all;
use crate::abi::status::{Outcome, Refusal};
use crate::abi::twin::{Twin, codes, record};
use crate::abi::values::{BsBody, BsBool, BsQuat, BsVec3};
use crate::settings::BsRowGroup;
use backstop::{Axes, Axis, BodyHandle, Frame, JointDesc, Limit, Motion, Motor, Spring};
use std::ptr::null;

/// Sliding or turning, one of `BS_MOTION_...`.
pub type BsMotion = u32;
/// [m]
pub const BS_MOTION_LINEAR: BsMotion = 0;
/// [rad]
pub const BS_MOTION_ANGULAR: BsMotion = 1;

/// Which axes of a joint's first frame, one of `BS_AXIS_...`, `BS_AROUND_...` and `BS_AXES_ALL`.
pub type BsJointAxes = u32;
/// Along or about x: a signed distance [m], or the twist [rad].
pub const BS_AXIS_X: BsJointAxes = 0;
/// Along or about y.
pub const BS_AXIS_Y: BsJointAxes = 1;
/// Along or about z.
pub const BS_AXIS_Z: BsJointAxes = 2;
/// The two others than x: the distance from the line along it [m], or the angle between the two frames' x, a
/// cone [rad].
pub const BS_AROUND_X: BsJointAxes = 3;
/// The two others than y.
pub const BS_AROUND_Y: BsJointAxes = 4;
/// The two others than z.
pub const BS_AROUND_Z: BsJointAxes = 5;
/// The distance of the two frames [m], or the angle of the whole rotation between them [rad].
pub const BS_AXES_ALL: BsJointAxes = 6;

codes! { "motion", Motion {
    BS_MOTION_LINEAR = Motion::Linear,
    BS_MOTION_ANGULAR = Motion::Angular,
} }

codes! { "axis of a joint", Axis {
    BS_AXIS_X = Axis::X,
    BS_AXIS_Y = Axis::Y,
    BS_AXIS_Z = Axis::Z,
} }

impl Twin<Axes> for BsJointAxes {
    fn read(self) -> Outcome<Axes> {
        match self {
            BS_AXIS_X..=BS_AXIS_Z => Twin::read(self).map(Axes::One),
            BS_AROUND_X..=BS_AROUND_Z => Twin::read(self - BS_AROUND_X).map(Axes::Perpendicular),
            BS_AXES_ALL => Ok(Axes::All),
            value => Err(Refusal::Constant { what: "set of axes of a joint", value }),
        }
    }

    fn write(axes: &Axes) -> BsJointAxes {
        match axes {
            Axes::One(axis) => *axis as u32,
            Axes::Perpendicular(axis) => BS_AROUND_X + *axis as u32,
            Axes::All => BS_AXES_ALL,
        }
    }
}

/// What a spring's numbers are, one of `BS_SPRING_...`.
pub type BsSpringKind = u32;
/// No spring: rigid. A motor must have one.
pub const BS_SPRING_NONE: BsSpringKind = 0;
/// Force or torque per displacement and per speed: [N/m] and [N s/m], or [N m/rad] and [N m s/rad]. Infinite
/// damping holds the speed exactly.
pub const BS_SPRING_COEFFICIENTS: BsSpringKind = 1;
/// `stiffness` is the undamped frequency [Hz], `damping` the ratio: 1 is critical. Whatever the mass.
pub const BS_SPRING_FREQUENCY: BsSpringKind = 2;
/// Acceleration per displacement [1/s²] and per speed [1/s].
pub const BS_SPRING_ACCELERATION: BsSpringKind = 3;

/// A spring with a damper.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsSpring {
    /// What its numbers are.
    pub kind: BsSpringKind,
    /// By its kind.
    pub stiffness: f32,
    /// By its kind.
    pub damping: f32,
}

impl BsSpring {
    const NONE: BsSpring = BsSpring { kind: BS_SPRING_NONE, stiffness: 0.0, damping: 0.0 };

    pub(crate) fn needed(self) -> Outcome<Spring> {
        let none = Refusal::Constant { what: "kind of spring of a motor", value: self.kind };
        Twin::<Option<Spring>>::read(self)?.ok_or(none)
    }
}

impl Twin<Option<Spring>> for BsSpring {
    fn read(self) -> Outcome<Option<Spring>> {
        let BsSpring { kind, stiffness, damping } = self;
        Ok(match kind {
            BS_SPRING_NONE => None,
            BS_SPRING_COEFFICIENTS => Some(Spring::Coefficients { stiffness, damping }),
            BS_SPRING_FREQUENCY => Some(Spring::Frequency { hertz: stiffness, ratio: damping }),
            BS_SPRING_ACCELERATION => Some(Spring::Acceleration { stiffness, damping }),
            value => return Err(Refusal::Constant { what: "kind of spring", value }),
        })
    }

    fn write(spring: &Option<Spring>) -> BsSpring {
        let (kind, stiffness, damping) = match *spring {
            None => return BsSpring::NONE,
            Some(Spring::Coefficients { stiffness, damping }) => (BS_SPRING_COEFFICIENTS, stiffness, damping),
            Some(Spring::Frequency { hertz, ratio }) => (BS_SPRING_FREQUENCY, hertz, ratio),
            Some(Spring::Acceleration { stiffness, damping }) => (BS_SPRING_ACCELERATION, stiffness, damping),
            // A kind without a constant yet: no call takes it back.
            Some(_) => (u32::MAX, 0.0, 0.0),
        };
        BsSpring { kind, stiffness, damping }
    }
}

/// Of a motor, which must have one.
impl Twin<Spring> for BsSpring {
    fn read(self) -> Outcome<Spring> {
        self.needed()
    }

    fn write(spring: &Spring) -> BsSpring {
        Twin::write(&Some(*spring))
    }
}

record! {
    /// Keeps a displacement within a range. A range of no width locks.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsLimitDesc of limit: Limit {
        /// Size of this struct; `bs_limit_desc` fills it in.
        pub size: u32 = size_of::<BsLimitDesc>() as u32,
        /// Sliding or turning.
        pub motion: BsMotion,
        /// Along or about which axes.
        pub axes: BsJointAxes,
        /// Least allowed [m] or [rad]; minus infinity for none.
        pub min: f32,
        /// Most allowed, not below `min`; infinity for none.
        pub max: f32,
        /// What pushes back beyond the range. Default none: rigid.
        pub spring: BsSpring,
    }
    default bs_limit_desc(BS_MOTION_LINEAR, BS_AXES_ALL, 0.0, 0.0)
}

/// A rigid limit.
#[unsafe(no_mangle)]
pub extern "C" fn bs_limit_desc(motion: BsMotion, axes: BsJointAxes, min: f32, max: f32) -> BsLimitDesc {
    let size = size_of::<BsLimitDesc>() as u32;
    BsLimitDesc { size, motion, axes, min, max, spring: BsSpring::NONE }
}

record! {
    /// Pulls a displacement to a target position, a target velocity, or both, with a bounded force.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsMotorDesc of motor: Motor {
        /// Size of this struct; `bs_motor_desc` and others fill it in.
        pub size: u32 = size_of::<BsMotorDesc>() as u32,
        /// Sliding or turning.
        pub motion: BsMotion,
        /// `BS_AXIS_X`, `BS_AXIS_Y` or `BS_AXIS_Z`.
        pub axis: BsJointAxes,
        /// [m] or [rad]
        pub position: f32,
        /// [m/s] or [rad/s]
        pub velocity: f32,
        /// How hard it pulls.
        pub spring: BsSpring,
        /// The most force [N] or torque [N m]; infinity for no bound.
        pub max_force: f32,
    }
    default bs_motor_desc(BS_MOTION_ANGULAR, BS_AXIS_X, 0.0, 0.0)
}

/// Holds a speed [m/s] or [rad/s] with at most so much force [N] or torque [N m]; friction at speed zero.
#[unsafe(no_mangle)]
pub extern "C" fn bs_motor_desc(
    motion: BsMotion,
    axis: BsJointAxes,
    velocity: f32,
    max_force: f32,
) -> BsMotorDesc {
    let spring = BsSpring { kind: BS_SPRING_COEFFICIENTS, stiffness: 0.0, damping: f32::INFINITY };
    let size = size_of::<BsMotorDesc>() as u32;
    BsMotorDesc { size, motion, axis, position: 0.0, velocity, spring, max_force }
}

/// A spring towards a position [m] or [rad].
#[unsafe(no_mangle)]
pub extern "C" fn bs_spring_desc(
    motion: BsMotion,
    axis: BsJointAxes,
    position: f32,
    spring: BsSpring,
) -> BsMotorDesc {
    let size = size_of::<BsMotorDesc>() as u32;
    BsMotorDesc { size, motion, axis, position, velocity: 0.0, spring, max_force: f32::INFINITY }
}

impl BsLimitDesc {
    pub(super) fn to_engine(self) -> Outcome<Limit> {
        self.on(Limit::new(Motion::Linear, Axes::All, 0.0, 0.0))
    }
}

impl BsMotorDesc {
    pub(super) fn to_engine(self) -> Outcome<Motor> {
        self.on(Motor::velocity(Motion::Linear, Axis::X, 0.0, 0.0))
    }
}

/// What a joint locks before its own limits and motors, one of `BS_JOINT_...`.
pub type BsJointKind = u32;
/// Nothing.
pub const BS_JOINT_FREE: BsJointKind = 0;
/// All motion.
pub const BS_JOINT_FIXED: BsJointKind = 1;
/// The frames' origins stay together.
pub const BS_JOINT_BALL: BsJointKind = 2;
/// Turns about the frames' x only.
pub const BS_JOINT_HINGE: BsJointKind = 3;
/// Slides along the frames' x only.
pub const BS_JOINT_SLIDER: BsJointKind = 4;
/// The frames' origins stay at a distance of `range_min` to `range_max` [m].
pub const BS_JOINT_DISTANCE: BsJointKind = 5;
/// A wheel (second body) on a car (first): its hub moves along y by up to `range_max` [m] to either side,
/// held by `spring`; it turns about x.
pub const BS_JOINT_WHEEL: BsJointKind = 6;

/// Where a joint sits on a body, in the body's own axes and from its origin.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsFrame {
    /// [m]
    pub position: BsVec3,
    /// The joint's x, y and z in the body's axes.
    pub rotation: BsQuat,
}

impl BsFrame {
    pub(super) fn of_engine(frame: Frame) -> BsFrame {
        BsFrame { position: frame.position.into(), rotation: frame.rotation.into() }
    }

    pub(super) fn to_engine(self) -> Frame {
        Frame { position: self.position.into(), rotation: self.rotation.into() }
    }
}

record! {
    /// A joint to be added. The relative motion is that of the second frame as seen from the first.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsJointDesc of desc: JointDesc {
        /// Size of this struct; `bs_joint_desc_default` fills it in.
        pub size: u32 = size_of::<BsJointDesc>() as u32,
        /// What it locks.
        pub kind: BsJointKind = BS_JOINT_FREE,
        /// The two bodies, at least one of them dynamic.
        pub bodies: [BsBody; 2] = desc.bodies.map(Into::into),
        /// Where the joint sits on each; `bs_joint_frames_at` makes them from a point of the world.
        pub frames: [BsFrame; 2] = desc.frames.map(BsFrame::of_engine),
        /// Distance joints: the least distance [m].
        pub range_min: f32 = 0.0,
        /// Distance joints: the greatest distance; wheels: the travel [m].
        pub range_max: f32 = 0.0,
        /// Wheels alone.
        pub spring: BsSpring = BsSpring::NONE,
        /// The joint breaks above this force [N]. Default infinity.
        pub break_force: f32,
        /// The joint breaks above this torque [N m]. Default infinity.
        pub break_torque: f32,
        /// Its rows are solved right after those of this group, if that is later. Default `BS_ROWS_NONE`.
        pub solved_after: BsRowGroup,
        /// Whether the two bodies collide with each other. Default no.
        pub collide: BsBool,
        /// Zero.
        pub reserved: [u8; 7] = [0; 7],
        /// What is kept within a range, beside what the kind locks. Each has the size that the first says.
        pub limits: *const BsLimitDesc = null(),
        /// Number of limits.
        pub limit_count: usize = 0,
        /// What is driven.
        pub motors: *const BsMotorDesc = null(),
        /// Number of motors.
        pub motor_count: usize = 0,
        /// Free for the caller.
        pub user_data: u64,
        /// Above this force [N] the joint is in `bs_world_strained_joints`. Default infinity.
        pub force_threshold: f32,
        /// The same of its torque [N m]. Default infinity.
        pub torque_threshold: f32,
    }
    default bs_joint_desc_default(BS_JOINT_FREE, BsBody::NONE, BsBody::NONE)
}

/// A joint of a kind between the origins of two bodies.
#[unsafe(no_mangle)]
pub extern "C" fn bs_joint_desc_default(kind: BsJointKind, a: BsBody, b: BsBody) -> BsJointDesc {
    let desc = JointDesc::new([a, b].map(Into::into), [Frame::default(); 2]);
    BsJointDesc { kind, ..BsJointDesc::of_engine(&desc) }
}

impl BsJointDesc {
    /// # Safety
    /// Its pointers are null or valid.
    pub(super) unsafe fn to_engine(self) -> Outcome<JointDesc> {
        let bodies: [BodyHandle; 2] = self.bodies.map(Into::into);
        let frames = self.frames.map(BsFrame::to_engine);
        let mut desc = match self.kind {
            BS_JOINT_FREE => JointDesc::new(bodies, frames),
            BS_JOINT_FIXED => JointDesc::fixed(bodies, frames),
            BS_JOINT_BALL => JointDesc::ball(bodies, frames),
            BS_JOINT_HINGE => JointDesc::hinge(bodies, frames),
            BS_JOINT_SLIDER => JointDesc::slider(bodies, frames),
            BS_JOINT_DISTANCE => JointDesc::distance(bodies, frames, self.range_min, self.range_max),
            BS_JOINT_WHEEL => JointDesc::wheel(bodies, frames, self.range_max, self.spring.needed()?),
            value => return Err(Refusal::Constant { what: "kind of joint", value }),
        };
        // SAFETY: as this function.
        let (limits, motors) =
            unsafe { (read_all(self.limits, self.limit_count)?, read_all(self.motors, self.motor_count)?) };
        for limit in limits {
            desc.limits.push(limit.to_engine()?);
        }
        for motor in motors {
            desc.motors.push(motor.to_engine()?);
        }
        self.on(desc)
    }
}
