//! The parts of the engine that a scene needs: for each optional part the number of objects that need it, its
//! bytes and its time, or "not needed".

use crate::body::BodyKind;
use crate::lanes::Record;
use crate::memory::bytes_of;
use crate::shape::Kind;
use crate::world::{Part, World};
use glam::Vec3;
use std::fmt;

/// Makes the enum of features from one list: for each its name in reports and JSON, the objects that need it,
/// and the stage that includes its time.
macro_rules! features {
    ($(#[$meta:meta])* pub enum Feature { $(
        $(#[$doc:meta])*
        $feature:ident $name:literal $asked_by:literal $stage:literal,
    )+ }) => {
        $(#[$meta])*
        pub enum Feature {
            $($(#[$doc])* $feature,)+
        }

        impl Feature {
            /// Every feature, in the order of reports.
            pub const ALL: [Feature; [$($name),+].len()] = [$(Feature::$feature),+];

            fn words(self) -> [&'static str; 3] {
                match self {
                    $(Feature::$feature => [$name, $asked_by, $stage],)+
                }
            }
        }
    };
}

features! {
    /// A part of the engine that not every scene needs.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
    #[cfg_attr(
        feature = "serde",
        derive(serde::Serialize, serde::Deserialize),
        serde(rename_all = "snake_case")
    )]
    #[non_exhaustive]
    pub enum Feature {
        /// Friction rows of contacts, and friction of impacts.
        Friction "friction" "shapes with friction or contact hooks" "solve",
        /// Moving surfaces, such as belts.
        SurfaceVelocities "surface_velocities" "shapes and contacts with a moving surface" "solve",
        /// Rows against rolling, and spinning friction.
        RollingFriction "rolling_friction" "shapes that resist rolling or spinning" "solve",
        /// Springs of soft contacts.
        SoftContacts "soft_contacts" "shapes whose contacts are soft" "solve",
        /// Velocities and displacements of the previous step, and sweeps over impacts.
        Restitution "restitution" "shapes with restitution or contact hooks" "prepare",
        /// Swept paths, casts, potential contacts, and the guard.
        ContinuousCollision "continuous_collision" "bodies that are not discrete" "narrow",
        /// Gravity and forces.
        Acceleration "acceleration" "dynamic bodies under gravity or forces" "broad",
        /// The column of applied forces.
        Forces "forces" "forces since the column was made" "broad",
        /// Locked axes of bodies.
        LockedAxes "locked_axes" "bodies with a locked axis" "broad",
        /// Torque-free rotation of bodies with unequal moments of inertia, whose axes change.
        GyroscopicTurning "gyroscopic_turning" "bodies with unequal moments of inertia" "finish",
        /// Kinematic bodies.
        KinematicBodies "kinematic_bodies" "kinematic bodies" "broad",
        /// Lists of bodies with more than one shape.
        Compounds "compounds" "bodies with more than one shape" "broad",
        /// Convex hulls.
        ConvexHulls "convex_hulls" "shapes" "narrow",
        /// Triangle meshes with their trees.
        Meshes "meshes" "shapes" "narrow",
        /// Height fields.
        HeightFields "height_fields" "shapes" "narrow",
        /// Joints of any kind.
        Joints "joints" "joints" "prepare",
        /// Joints in trees, solved exactly.
        JointTrees "joint_trees" "bodies in trees" "solve",
        /// Locks in loops: points, lines, hinges and welds that are in no tree.
        JointLocks "joint_locks" "locks outside of trees" "solve",
        /// Limits with a width.
        JointLimits "joint_limits" "limits with a width" "solve",
        /// Motors, and friction of joints.
        JointMotors "joint_motors" "motors" "solve",
        /// Springs, of limits and of motors.
        JointSprings "joint_springs" "springs of limits and drives" "solve",
        /// Couplings of two motions of joints: gears, racks, screws, pulleys.
        Couplings "couplings" "couplings" "solve",
        /// Joints that break.
        BreakableJoints "breakable_joints" "joints that can break" "solve",
        /// Rest times of bodies, islands, and the pairs of sleeping ones.
        Sleeping "sleeping" "dynamic bodies where sleeping is switched on" "finish",
        /// Events of contacts: begin, end and hit.
        ContactEvents "contact_events" "shapes that are listened to" "solve",
        /// Events of sensors.
        Sensors "sensors" "sensors" "finish",
        /// Changes of contacts by hooks.
        ContactHooks "contact_hooks" "shapes with contact hooks" "narrow",
        /// The tree that queries traverse.
        Queries "queries" "1 while queries are asked" "",
        /// The order of contacts and joints that are solved after a group.
        SolvedAfter "solved_after" "bodies and joints that are solved after a group" "prepare",
    }
}

impl Feature {
    /// The name in reports and JSON.
    pub fn name(self) -> &'static str {
        self.words()[0]
    }

    /// The objects that need it, which [`FeatureCost::count`] counts.
    pub fn asked_by(self) -> &'static str {
        self.words()[1]
    }

    /// The stage of [`StageTimes`](crate::StageTimes) that includes its time; `None` if it takes none in a
    /// step.
    pub fn stage(self) -> Option<&'static str> {
        Some(self.words()[2]).filter(|stage| !stage.is_empty())
    }
}

impl fmt::Display for Feature {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name().replace('_', " "))
    }
}

/// A feature in a world.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FeatureCost {
    /// The feature.
    pub feature: Feature,
    /// Number of objects that need it: [`Feature::asked_by`] names them. If zero, it is not needed.
    pub count: u32,
    /// Bytes that are reserved for it alone. After it was last needed they are released at the end of the
    /// next step; lists of events, once they can't be read any more.
    pub bytes: usize,
    /// Its time in the last step, as far as it can be separated from that of its [stage](Feature::stage)
    /// [us]; `None` if it can't, or if it was not needed.
    pub time_us: Option<f32>,
}

impl FeatureCost {
    /// Whether anything in the world needs it.
    pub fn is_needed(&self) -> bool {
        self.count > 0
    }
}

impl fmt::Display for FeatureCost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.is_needed() && self.bytes == 0 {
            return write!(f, "{}: not needed", self.feature);
        }
        let who = self.feature.asked_by();
        write!(f, "{}: {} ({who}), {} bytes", self.feature, self.count, self.bytes)?;
        match (self.time_us, self.feature.stage()) {
            (Some(time), _) => write!(f, ", {time:.1} us"),
            (None, Some(stage)) => write!(f, ", time in {stage}"),
            (None, None) => Ok(()),
        }
    }
}

/// The optional parts of a world.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FeatureReport {
    parts: Vec<FeatureCost>,
}

impl FeatureReport {
    /// One of the parts.
    pub fn part(&self, feature: Feature) -> FeatureCost {
        self.parts[feature as usize]
    }

    /// All parts, in the order of [`Feature::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = &FeatureCost> + '_ {
        self.parts.iter()
    }

    /// Features that nothing in the world needs.
    pub fn not_needed(&self) -> impl Iterator<Item = Feature> + '_ {
        self.parts.iter().filter(|part| !part.is_needed()).map(|part| part.feature)
    }
}

/// One line for each part.
impl fmt::Display for FeatureReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.parts.iter().try_for_each(|part| writeln!(f, "{part}"))
    }
}

/// Bytes of a kinematic body in buffers of steps: its motion, and its velocities and displacement in the
/// solver.
const OF_A_MOVER: usize = 4 * size_of::<Record>();

/// # Needs of the content
impl World {
    /// The optional parts of the engine that the world's content needs, by how many shapes, bodies or joints,
    /// and their cost. Needs are counted when content is added, changed or removed; how joints are solved is
    /// known after a step.
    pub fn feature_report(&self) -> FeatureReport {
        FeatureReport { parts: Feature::ALL.iter().map(|&feature| self.model_part(feature)).collect() }
    }

    fn model_part(&self, feature: Feature) -> FeatureCost {
        let World { bodies, needs, joints, buffers, events, .. } = self;
        let spent = |part: Part| Some(self.spent[part as usize]);
        let dynamic = || bodies.all_dynamic().count() as u32;
        let events = || events.parts(needs.events > 0);
        let [beside, trees, locks, rows] = buffers.joints.parts();
        let [in_trees, alone] = buffers.joints.counts();
        let [own, of_locks, of_rows] = joints.parts();
        // Limits, motors and springs share rows.
        let kinds = joints.kinds_of_rows();
        let shares = share_out(of_rows + rows, [kinds[0], kinds[1]]);
        let (count, bytes, time) = match feature {
            Feature::Friction => (needs.friction, buffers.rows.friction_bytes(), None),
            Feature::SurfaceVelocities => {
                let moving = self.events.tweaks.iter().filter(|tweak| tweak.surface != Vec3::ZERO).count();
                (needs.belts + moving as u32, bytes_of(&buffers.rows.surfaces).1, None)
            }
            Feature::RollingFriction => {
                let rows = bytes_of(&buffers.rows.rolling).1;
                (needs.rolling, rows + self.contacts.rolling_bytes().1, None)
            }
            Feature::SoftContacts => (needs.soft, buffers.rows.soft.bytes().1, None),
            Feature::Restitution => {
                (needs.restitution, buffers.restitution.bytes().1, spent(Part::Restitution))
            }
            Feature::ContinuousCollision => {
                let count = if self.is_continuous() { bodies.continuous } else { 0 };
                let (manifolds, rows) = buffers.prepare.ahead_bytes();
                let guard = buffers.finish.bytes().1;
                (count, self.broad.continuous_bytes().1 + manifolds.1 + rows.1 + guard, None)
            }
            Feature::Acceleration => {
                let count = if self.is_accelerated() { dynamic() } else { 0 };
                (count, bytes_of(&buffers.forces.acceleration).1, None)
            }
            Feature::Forces => (bodies.pushes, bytes_of(&bodies.force).1, None),
            Feature::LockedAxes => (bodies.locked, 0, None),
            Feature::GyroscopicTurning => (bodies.uneven, 0, None),
            Feature::KinematicBodies => {
                let count = bodies.kind.iter().filter(|&&kind| kind == BodyKind::Kinematic).count();
                (count as u32, (bodies.movers() - bodies.dynamic()) * OF_A_MOVER, None)
            }
            Feature::Compounds => (bodies.compounds, bodies.list_bytes(), None),
            Feature::ConvexHulls => (needs.hulls, self.assets.bytes_of(Kind::Hull), None),
            Feature::Meshes => (needs.meshes, self.assets.bytes_of(Kind::Mesh), None),
            Feature::HeightFields => (needs.height_fields, self.assets.bytes_of(Kind::HeightField), None),
            Feature::Joints => (joints.count as u32, own + beside, spent(Part::Joints)),
            Feature::JointTrees => (in_trees, trees, None),
            Feature::JointLocks => (alone, of_locks + locks, None),
            Feature::JointLimits => (kinds[0], shares[0], None),
            Feature::JointMotors => (kinds[1], shares[1], None),
            Feature::JointSprings => (kinds[2], 0, None),
            Feature::Couplings => {
                let bytes = joints.couplings.reserved() + buffers.joints.coupling_bytes();
                (joints.couplings.count as u32, bytes, None)
            }
            Feature::BreakableJoints => (joints.breakable, 0, None),
            Feature::Sleeping => {
                let (islands, kept) = (self.sleep.bytes(), self.sleep.kept_bytes());
                let count = if self.settings.sleeping { dynamic() } else { 0 };
                (count, bytes_of(&bodies.rest).1 + islands.1 + kept.1, spent(Part::Sleeping))
            }
            Feature::ContactEvents => (needs.events, events()[0], spent(Part::Events)),
            Feature::Sensors => (needs.sensors, events()[1], spent(Part::Sensors)),
            Feature::ContactHooks => (needs.hooks, events()[2], spent(Part::Hooks)),
            Feature::Queries => (u32::from(self.now.is_kept()), self.now.bytes().1, None),
            Feature::SolvedAfter => (
                bodies.solved_after_count() + joints.solved_after(),
                buffers.prepare.solved_after_bytes(),
                None,
            ),
        };
        FeatureCost { feature, count, bytes, time_us: time.filter(|_| count > 0) }
    }
}

/// Splits bytes in proportion to two counts; if both are zero, the first part gets all.
fn share_out(bytes: usize, [a, b]: [u32; 2]) -> [usize; 2] {
    let all = a as usize + b as usize;
    let first = (bytes * a as usize).checked_div(all).unwrap_or(bytes);
    [first, bytes - first]
}
