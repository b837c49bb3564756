//! Ragdolls: bodies and joints out of a skeleton.

use super::desc::JointDesc;
use super::motion::{Axes, Axis, Limit, Motion, Motor};
use crate::body::BodyDesc;
use crate::error::{Error, each, finite3, positive, within};
use crate::handle::{BodyHandle, JointHandle};
use crate::limits;
use crate::math::Quat;
use crate::shape::{Filter, Geometry, Material, ShapeDesc};
use glam::{DVec3, Vec3};
use std::f32::consts::PI;

/// How a bone moves on its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "lowercase", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum BoneJoint {
    /// Within a cone around the direction that it has in the skeleton, and with a bounded twist.
    Ball {
        /// Half the angle of the cone, 0..=pi [rad].
        swing: f32,
        /// To either side, 0..=pi [rad].
        twist: f32,
    },
    /// About an axis, from where it is in the skeleton.
    Hinge {
        /// In the skeleton's axes; its length is of no matter.
        axis: Vec3,
        /// At most zero [rad].
        min: f32,
        /// At least zero [rad].
        max: f32,
    },
    /// Not at all.
    Fixed,
}

/// A capsule from its joint to its other end.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Bone {
    /// A bone before this one; none for the root.
    pub parent: Option<usize>,
    /// Where it hangs on its parent [m].
    pub joint_at: Vec3,
    /// The two ends of the capsule, caps included [m].
    pub from: Vec3,
    /// See `from`.
    pub to: Vec3,
    /// [m]
    pub radius: f32,
    /// How it moves on its parent.
    pub joint: BoneJoint,
}

/// Bones in the pose in which no joint is bent, y up, with their density, material and filter.
///
/// ```
/// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
/// # let mut world = World::new(Settings::default())?;
/// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
/// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
/// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
/// # let body = world.add_body(&desc)?;
/// let skeleton = Skeleton::humanoid().with_friction(5.0);
/// let ragdoll = skeleton.add_to(&mut world, DVec3::X * 4.0, Quat::IDENTITY, Vec3::ZERO)?;
/// assert_eq!((ragdoll.bodies.len(), ragdoll.joints.len()), (11, 10));
/// # Ok::<(), Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[non_exhaustive]
pub struct Skeleton {
    /// Parents before children.
    pub bones: Vec<Bone>,
    /// [kg/m³]. Default 1000.
    #[cfg_attr(feature = "serde", serde(default = "ShapeDesc::default_density"))]
    pub density: f32,
    /// Material of all bones.
    #[cfg_attr(feature = "serde", serde(default))]
    pub material: Material,
    /// Filter of all bones. Neighbours never collide.
    #[cfg_attr(feature = "serde", serde(default))]
    pub filter: Filter,
    /// Torque of friction in each joint [N m]. Default 0.
    #[cfg_attr(feature = "serde", serde(default))]
    pub friction: f32,
}

/// A ragdoll in a world: handles in the order of the bones; the root has no joint.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Ragdoll {
    /// One a bone.
    pub bodies: Vec<BodyHandle>,
    /// One for each bone but the roots.
    pub joints: Vec<JointHandle>,
    /// The bodies of each joint.
    pub(crate) links: Vec<Link>,
    /// Torque of friction in each joint [N m].
    pub(crate) friction: f32,
}

/// The bodies of a ragdoll's joint, and its kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Link {
    pub(crate) bone: usize,
    pub(crate) parent: usize,
    /// The frames' axes in those of the skeleton.
    axes: Quat,
    joint: BoneJoint,
}

impl Link {
    pub(crate) fn new(bone: &Bone, index: usize, parent: usize) -> Link {
        Link { bone: index, parent, axes: bone.axes(), joint: bone.joint }
    }

    /// The axes that the joint turns about.
    pub(crate) fn free_axes(&self) -> &'static [Axis] {
        free_axes(self.joint)
    }

    /// The rotation of the second frame as seen from the first, if parent and bone are turned from where they
    /// are in the skeleton, in its axes.
    pub(crate) fn relative(&self, parent: Quat, bone: Quat) -> Quat {
        self.axes.conjugate() * parent.conjugate() * bone * self.axes
    }
}

impl Skeleton {
    /// A skeleton of ordinary flesh.
    pub fn new(bones: Vec<Bone>) -> Skeleton {
        Skeleton {
            bones,
            density: 1000.0,
            material: Material::default(),
            filter: Filter::default(),
            friction: 0.0,
        }
    }

    /// With another density [kg/m³].
    pub fn with_density(self, density: f32) -> Skeleton {
        Skeleton { density, ..self }
    }
    /// With another material of all bones.
    pub fn with_material(self, material: Material) -> Skeleton {
        Skeleton { material, ..self }
    }
    /// With another filter of all bones.
    pub fn with_filter(self, filter: Filter) -> Skeleton {
        Skeleton { filter, ..self }
    }
    /// With so much torque of friction in each joint [N m].
    pub fn with_friction(self, friction: f32) -> Skeleton {
        Skeleton { friction, ..self }
    }

    /// A figure of 1.85 m with spread arms that stands at the origin and looks along z: pelvis, torso and
    /// head, and upper and lower arms and legs. Six ball joints and four hinges.
    pub fn humanoid() -> Skeleton {
        let lying = |x: f32, y: f32, half: f32| [Vec3::new(x - half, y, 0.0), Vec3::new(x + half, y, 0.0)];
        let standing = |x: f32, y: f32, half: f32| [Vec3::new(x, y - half, 0.0), Vec3::new(x, y + half, 0.0)];
        let ball = |swing: f32, twist: f32| BoneJoint::Ball { swing, twist };
        let mut bones = Vec::new();
        let mut bone =
            |parent: Option<usize>, joint_at: Vec3, ends: [Vec3; 2], radius: f32, joint: BoneJoint| {
                bones.push(Bone { parent, joint_at, from: ends[0], to: ends[1], radius, joint });
                bones.len() - 1
            };
        let pelvis = bone(None, Vec3::Y, lying(0.0, 1.0, 0.2), 0.12, BoneJoint::Fixed);
        let torso =
            bone(Some(pelvis), Vec3::new(0.0, 1.14, 0.0), standing(0.0, 1.35, 0.3), 0.15, ball(0.6, 0.5));
        bone(Some(torso), Vec3::new(0.0, 1.63, 0.0), standing(0.0, 1.78, 0.15), 0.1, ball(0.7, 0.8));
        for side in [-1.0_f32, 1.0] {
            let at = |x: f32, y: f32| Vec3::new(side * x, y, 0.0);
            let upper =
                bone(Some(torso), at(0.17, 1.45), lying(side * 0.33, 1.45, 0.17), 0.05, ball(1.5, 0.8));
            // Elbows bend forwards, knees backwards.
            let elbow = BoneJoint::Hinge { axis: Vec3::new(0.0, -side, 0.0), min: 0.0, max: 2.4 };
            bone(Some(upper), at(0.48, 1.45), lying(side * 0.63, 1.45, 0.165), 0.045, elbow);
            let thigh =
                bone(Some(pelvis), at(0.1, 0.92), standing(side * 0.1, 0.7, 0.22), 0.07, ball(1.2, 0.5));
            let knee = BoneJoint::Hinge { axis: Vec3::X, min: 0.0, max: 2.4 };
            bone(Some(thigh), at(0.1, 0.49), standing(side * 0.1, 0.28, 0.21), 0.06, knee);
        }
        Skeleton::new(bones)
    }

    /// Checks every number.
    ///
    /// # Errors
    /// Names the first that is not finite or out of its range; a parent has to come before its children.
    pub fn validate(&self) -> Result<(), Error> {
        positive("skeleton density", self.density)?;
        limits::density(self.density)?;
        limits::amount("joint friction", self.friction)?;
        let mut before = 0..;
        each("bone", &self.bones, |bone| {
            let i = before.next().unwrap_or_default();
            limits::offset("bone joint", bone.joint_at)?;
            limits::offset("bone end", bone.from)?;
            limits::offset("bone end", bone.to)?;
            limits::length("bone radius", bone.radius)?;
            positive("bone length", (bone.to - bone.from).length())?;
            if let Some(parent) = bone.parent.filter(|&parent| parent >= i) {
                let value = parent as f64;
                return Err(Error::OutOfRange { what: "bone parent", expected: "a bone before it", value });
            }
            match bone.joint {
                BoneJoint::Ball { swing, twist } => {
                    within("bone swing", swing, 0.0, PI, "in 0..=pi")?;
                    within("bone twist", twist, 0.0, PI, "in 0..=pi")?;
                }
                BoneJoint::Hinge { axis, min, max } => {
                    finite3("bone axis", axis)?;
                    positive("length of a bone axis", axis.length())?;
                    within("bone angle", min, -PI, 0.0, "in -pi..=0")?;
                    within("bone angle", max, 0.0, PI, "in 0..=pi")?;
                }
                BoneJoint::Fixed => {}
            }
            Ok(())
        })
    }

    /// The body of a bone of a skeleton that stands somewhere [m], turned, and moves as one [m/s].
    pub fn body(&self, bone: &Bone, (position, rotation): (DVec3, Quat), velocity: Vec3) -> BodyDesc {
        let along = bone.to - bone.from;
        let half = (0.5 * along.length() - bone.radius).max(0.01 * bone.radius);
        let mut shape = ShapeDesc::new(Geometry::capsule(half, bone.radius));
        (shape.density, shape.material, shape.filter) = (self.density, self.material, self.filter);
        BodyDesc::dynamic()
            .with_position(position + (rotation * (bone.from + bone.to) * 0.5).as_dvec3())
            .with_rotation(rotation * arc(Vec3::Y, along.normalize()))
            .with_velocity(velocity, Vec3::ZERO)
            .with_shape(shape)
    }

    /// A joint with the limits of a bone's joint, about the frames' axes, and its friction.
    pub fn joint(&self, bone: &Bone, desc: JointDesc) -> JointDesc {
        let about_x = Axes::One(Axis::X);
        let desc = match bone.joint {
            BoneJoint::Ball { swing, twist } => desc
                .with_limit(Limit::new(Motion::Angular, Axes::Perpendicular(Axis::X), 0.0, swing))
                .with_limit(Limit::new(Motion::Angular, about_x, -twist, twist)),
            BoneJoint::Hinge { min, max, .. } => desc
                .with_limit(Limit::lock(Motion::Angular, Axes::Perpendicular(Axis::X)))
                .with_limit(Limit::new(Motion::Angular, about_x, min, max)),
            BoneJoint::Fixed => desc.with_limit(Limit::lock(Motion::Angular, Axes::All)),
        };
        if self.friction == 0.0 {
            return desc;
        }
        free_axes(bone.joint)
            .iter()
            .fold(desc, |desc, &axis| desc.with_motor(Motor::friction(Motion::Angular, axis, self.friction)))
    }
}

/// The axes of its frames that a joint turns about.
fn free_axes(joint: BoneJoint) -> &'static [Axis] {
    match joint {
        BoneJoint::Ball { .. } => &Axis::ALL,
        BoneJoint::Hinge { .. } => &[Axis::X],
        BoneJoint::Fixed => &[],
    }
}

impl Bone {
    /// The axes of its joint's frames: x is the hinge's axis, or the bone.
    pub fn axes(&self) -> Quat {
        let x = match self.joint {
            BoneJoint::Hinge { axis, .. } => axis.normalize(),
            _ => {
                // Away from the joint.
                let middle = (self.from + self.to) * 0.5;
                let along = (self.to - self.from).normalize();
                if along.dot(middle - self.joint_at) < 0.0 { -along } else { along }
            }
        };
        arc(Vec3::X, x)
    }
}

/// A rotation of one direction to another. Against each other glam would ask the platform for the sine of a
/// right angle.
fn arc(from: Vec3, to: Vec3) -> Quat {
    if from.dot(to) >= 0.0 {
        return Quat::from_rotation_arc(from, to);
    }
    let axis = from.any_orthonormal_vector();
    let half_turn = Quat::from_xyzw(axis.x, axis.y, axis.z, 0.0);
    Quat::from_rotation_arc(-from, to) * half_turn
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_leads_from_one_direction_to_the_other() {
        for from in [Vec3::X, Vec3::Y] {
            for to in [Vec3::X, Vec3::NEG_X, Vec3::NEG_Y, Vec3::new(-0.9999, 0.014, 0.002), Vec3::ONE] {
                let (to, turned) = (to.normalize(), arc(from, to.normalize()));
                assert!(
                    (turned * from - to).length() < 1e-6 && glam::Quat::from(turned).is_normalized(),
                    "{from} {to}"
                );
            }
        }
    }
}
