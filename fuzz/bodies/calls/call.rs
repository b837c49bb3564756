//! A call of a world as data: it can be left out, made of another world, and printed.

use super::forms::forms;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, BodyKind, CharacterSettings, ContinuousMode, CouplingDesc, Filter, Frame, Geometry,
    JointDesc, Limit, MassProperties, Material, Motion, Motor, RowGroup, Settings, ShapeDesc, Spring,
};
use std::fmt;

/// What the call that adds something names it by; calls that speak of what was never added do nothing.
pub type Id = u16;

/// A shape, by its body and its place among that body's shapes.
#[derive(Clone, Copy, Debug)]
pub struct ShapeId {
    pub body: Id,
    pub place: u8,
}

/// Where a joint sits.
#[derive(Clone, Debug)]
pub enum Anchor {
    /// At this share of the way between the two bodies, turned like this in the world.
    Between(f32, Quat),
    Frames([Frame; 2]),
}

/// A joint; the bodies and frames of `desc` are filled in when it is added.
#[derive(Clone, Debug)]
pub struct JointSpec {
    pub bodies: [Id; 2],
    pub anchor: Anchor,
    pub desc: JointDesc,
}

/// A coupling; the joints of `desc` are filled in when it is added.
#[derive(Clone, Debug)]
pub struct CouplingSpec {
    pub joints: [Id; 2],
    pub desc: CouplingDesc,
}

/// A setter or another call of a body.
#[derive(Clone, Debug)]
pub enum OfBody {
    Remove,
    Enable(bool),
    Pose(DVec3, Quat),
    /// To the pose that it has.
    SamePose,
    Velocity(Vec3, Vec3),
    LinearVelocity(Vec3),
    AngularVelocity(Vec3),
    MoveKinematic(DVec3, Quat, f32),
    Force(Vec3, Vec3),
    ForceAt(Vec3, DVec3),
    Impulse(Vec3, DVec3),
    AngularImpulse(Vec3),
    Mass(MassProperties),
    Kind(BodyKind),
    UserData(u64),
    GravityScale(f32),
    Damping(f32, f32),
    MaxSpeeds(Option<f32>, Option<f32>),
    Locks([bool; 3], [bool; 3]),
    Continuous(ContinuousMode),
    SolvedAfter(Option<RowGroup>),
    Wake,
    SendToSleep,
    CanSleep(bool),
    AddShape(ShapeDesc),
}

/// A call of a shape.
#[derive(Clone, Debug)]
pub enum OfShape {
    Remove,
    Material(Material),
    Filter(Filter),
    Listening(bool, bool),
    Sensor(bool),
    SensesStatic(bool),
    UserData(u64),
    Geometry(Geometry),
    Pose(Vec3, Quat),
    Density(f32),
    Heights([usize; 2], [usize; 2], Vec<f32>),
    Holes([usize; 2], [usize; 2], Vec<bool>),
}

/// A call of a joint.
#[derive(Clone, Debug)]
pub enum OfJoint {
    Remove,
    Limits(Vec<Limit>),
    Drives(Vec<Motor>),
    Limit(Limit),
    Motor(Motor),
    RemoveLimit(Motion, Axes),
    RemoveDrive(Motion, Axis),
    Target(Motion, Axis, f32, f32),
    Frames([Frame; 2]),
    Collide(bool),
    Strength(f32, f32),
    Thresholds(f32, f32),
    UserData(u64),
    SolvedAfter(Option<RowGroup>),
}

/// A call of a coupling.
#[derive(Clone, Debug)]
pub enum OfCoupling {
    Remove,
    Factors([f64; 2]),
    Range(Option<[f64; 2]>),
    Strength([f32; 2]),
    UserData(u64),
}

/// A call of a character.
#[derive(Clone, Debug)]
pub enum OfCharacter {
    Remove,
    Set(CharacterSettings, DVec3, Option<Geometry>),
    Walk { velocity: Vec3, dt: f32, push: bool },
}

/// A call of a ragdoll.
#[derive(Clone, Debug)]
pub enum OfRagdoll {
    Motor { pose: Vec<Quat>, spring: Spring, torque: f32 },
    Relax,
}

/// A query, of what is at a place.
#[derive(Clone, Copy, Debug)]
pub struct Query {
    pub at: DVec3,
    pub path: Vec3,
    pub spin: Vec3,
    pub distance: f32,
    pub rotation: Quat,
    pub sensors: bool,
}

/// To where a snapshot is restored once the sequence has ended.
#[derive(Clone, Copy, Debug)]
pub struct Ways {
    /// The world that went on.
    pub same: bool,
    /// A new one, by way of bytes.
    pub fresh: bool,
    /// One that was elsewhere.
    pub other: bool,
}

#[derive(Clone, Debug)]
pub enum Call {
    AddBody(Id, BodyDesc),
    AddBodies(Id, Vec<BodyDesc>),
    RemoveBodies([Id; 2]),
    Body(Id, OfBody),
    Shape(ShapeId, OfShape),
    AddJoint(Id, JointSpec),
    Joint(Id, OfJoint),
    AddCoupling(Id, CouplingSpec),
    Coupling(Id, OfCoupling),
    AddCharacter(Id, CharacterSettings, DVec3, Option<Geometry>),
    Character(Id, OfCharacter),
    /// The first so many bones of a humanoid.
    AddRagdoll {
        id: Id,
        bones: usize,
        at: DVec3,
        rotation: Quat,
        velocity: Vec3,
        friction: f32,
    },
    Ragdoll(Id, OfRagdoll),
    Settings(Settings),
    Origin(DVec3),
    /// So many steps; with hooks that do what follows from this number.
    Step {
        dt: f32,
        times: u8,
        hooks: Option<u8>,
    },
    Query(Query, Geometry),
    Draw,
    /// A snapshot: what follows is done again after it was restored.
    Save(Ways),
    /// A snapshot, so many steps, and the same again after it was restored.
    Twice(u8),
    /// To the last snapshot but so many, from which the sequence goes on.
    GoBack(u8),
}

/// Settings, then calls, as they were drawn or as they are left.
#[derive(Clone, Debug)]
pub struct Sequence {
    pub settings: Settings,
    /// Whether what is refused is looked at: the whole state before and after each call.
    pub strict: bool,
    /// Calls with their places in what was drawn.
    pub calls: Vec<(usize, Call)>,
}

impl fmt::Display for Sequence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = |text: String| shorten(&text);
        writeln!(f, "settings {}", differences(&self.settings))?;
        writeln!(f, "strict {}", self.strict)?;
        self.calls
            .iter()
            .try_for_each(|(place, call)| writeln!(f, "{place:4}  {}", named(format!("{call:?}"))))
    }
}

/// Settings that are not the default.
fn differences(settings: &Settings) -> String {
    let lines = |settings: &Settings| -> Vec<String> {
        format!("{settings:#?}").lines().map(|line| line.trim().to_owned()).collect()
    };
    let (own, usual) = (lines(settings), lines(&Settings::default()));
    let differ = own.iter().filter(|line| !usual.contains(line));
    differ.map(String::as_str).collect::<Vec<_>>().join(" ")
}

/// Text with what is shared by its name, and without what is the default of every shape.
fn shorten(text: &str) -> String {
    let forms = forms();
    let mut short = text.to_owned();
    for (name, list) in [("hull", &forms.hulls), ("mesh", &forms.meshes), ("field", &forms.fields)] {
        for (i, geometry) in list.iter().enumerate() {
            short = short.replace(&format!("{geometry:?}"), &format!("{name} {i}"));
        }
    }
    let usual = [
        format!("material: {:?}, ", Material::default()),
        format!("filter: {:?}, ", Filter::default()),
        format!("rotation: {:?}, ", Quat::IDENTITY),
        format!("position: {:?}, ", Vec3::ZERO),
        format!("linear_velocity: {:?}, ", Vec3::ZERO),
        format!("angular_velocity: {:?}, ", Vec3::ZERO),
        "sensor: false, ".into(),
        "senses_static: false, ".into(),
        "events: false, ".into(),
        "hooks: false, ".into(),
        "density: 1000.0, ".into(),
        "mass: None, ".into(),
        "gravity_scale: 1.0, ".into(),
        "linear_damping: 0.0, ".into(),
        "angular_damping: 0.0, ".into(),
        "max_linear_speed: None, ".into(),
        "max_angular_speed: None, ".into(),
        "lock_translation: [false, false, false], ".into(),
        "lock_rotation: [false, false, false], ".into(),
        "continuous: Segment, ".into(),
        "solved_after: None, ".into(),
        "can_sleep: true, ".into(),
        ", user_data: 0".into(),
        "break_force: inf, break_torque: inf, ".into(),
        "force_threshold: inf, torque_threshold: inf, ".into(),
        format!("bodies: {:?}, ", [backstop::BodyHandle::from_bits(0); 2]),
        format!("frames: {:?}, ", [Frame::default(); 2]).replace(&format!("rotation: {:?}, ", Quat::IDENTITY), ""),
        "frames: [Frame { rotation: Quat(0.0, 0.0, 0.0, 1.0) }, Frame { rotation: Quat(0.0, 0.0, 0.0, 1.0) }], ".into(),
        ", collide: false, force_threshold: inf, torque_threshold: inf".into(),
        ", rolling_friction: 0.0, spinning_friction: 0.0".into(),
        ", surface_velocity: Vec3(0.0, 0.0, 0.0)".into(),
        ", contact_hertz: 0.0, contact_damping: 1.0".into(),
        ", friction_combine: Average, restitution_combine: Average".into(),
        format!("joint: {:?}, ", backstop::JointHandle::from_bits(0)),
    ];
    usual.iter().for_each(|part| short = short.replace(part, ""));
    short
}
