//! What a world tells, to be compared with what another tells at the same moment.

use super::play::Handles;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Axes, Axis, BodyContact, BodyHandle, BodyMove, ContactEnd, ContactEvent, CouplingHandle, JointEvent,
    JointHandle, Motion, SensorEvent, ShapeHandle, Snapshot, StageTimes, StepReport, World,
};
use std::fmt::Debug;

/// All that a world tells after a call.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    /// How the call ended.
    pub result: Result<(), String>,
    pub hash: u64,
    /// What a step tells; none before the first one after a restore, which brings none of it back.
    pub step: Option<OfStep>,
}

impl Told {
    /// Whether the budget refused something or left something out.
    pub fn is_tight(&self) -> bool {
        let refused = self.result.as_ref().is_err_and(|error| error.starts_with("the budget"));
        refused || self.step.as_ref().is_some_and(|step| step.tight)
    }
}

/// What the last step tells.
#[derive(Clone, Debug, PartialEq)]
pub struct OfStep {
    bodies: Vec<(BodyHandle, DVec3, Quat, Vec3, Vec3)>,
    begins: Vec<ContactEvent>,
    ends: Vec<ContactEnd>,
    hits: Vec<ContactEvent>,
    entered: Vec<SensorEvent>,
    left: Vec<SensorEvent>,
    broken: Vec<JointHandle>,
    strained: Vec<JointEvent>,
    uncoupled: Vec<CouplingHandle>,
    stopped: Vec<BodyHandle>,
    report: StepReport,
    /// Whether there is a budget, and whether it left contacts or events out.
    limited: bool,
    tight: bool,
    awake: Vec<BodyHandle>,
    moved: Vec<BodyMove>,
    joints: Vec<[f32; 6]>,
    couplings: Vec<[f32; 2]>,
    contacts: Vec<BodyContact>,
    visitors: Vec<ShapeHandle>,
    /// The words of a snapshot without its checksums.
    state: Vec<u32>,
}

impl OfStep {
    pub fn of(world: &World, handles: &Handles) -> OfStep {
        let mut report = *world.report();
        report.times = StageTimes::default();
        let limited = !world.settings().budget.is_none();
        let forces = handles.joints.values().filter_map(|&joint| world.joint_force(joint).ok());
        let couplings = handles.couplings.values().filter_map(|&c| world.coupling_force(c).ok());
        let motion = |body: BodyHandle| {
            let (linear, angular) = (world.linear_velocity(body).ok()?, world.angular_velocity(body).ok()?);
            Some((body, world.position(body).ok()?, world.rotation(body).ok()?, linear, angular))
        };
        OfStep {
            bodies: bodies(world).into_iter().filter_map(motion).collect(),
            begins: world.contact_begins().into(),
            ends: world.contact_ends().into(),
            hits: world.contact_hits().into(),
            entered: world.sensor_begins().into(),
            left: world.sensor_ends().into(),
            broken: world.broken_joints().into(),
            strained: world.strained_joints().into(),
            uncoupled: world.broken_couplings().into(),
            stopped: world.faulted_bodies().into(),
            limited,
            tight: report.shed > 0 || (report.events_lost > 0 && limited),
            report,
            awake: world.awake_bodies().collect(),
            moved: world.body_moves().collect(),
            joints: forces
                .map(|(force, torque)| {
                    let ([a, b, c], [d, e, f]) = (force.to_array(), torque.to_array());
                    [a, b, c, d, e, f]
                })
                .collect(),
            couplings: couplings.collect(),
            contacts: world.contacts().collect(),
            visitors: visitors(world),
            state: state(world),
        }
    }
}

/// By their handles: static ones may come in another order.
fn bodies(world: &World) -> Vec<BodyHandle> {
    let mut all: Vec<_> = world.bodies().collect();
    all.sort_unstable();
    all
}

/// Who is in each sensor, one after the other.
fn visitors(world: &World) -> Vec<ShapeHandle> {
    let shapes = bodies(world).into_iter().filter_map(|body| world.shapes(body).ok()).flatten();
    let (mut all, mut inside) = (Vec::new(), Vec::new());
    for sensor in shapes.filter(|&shape| world.is_sensor(shape).unwrap_or_default()) {
        if world.sensor_overlaps(sensor, &mut inside).is_ok() {
            all.push(sensor);
            all.append(&mut inside);
        }
    }
    all
}

/// Words of a snapshot's head that follow from all others.
const SUMS: std::ops::Range<usize> = 4..14;
/// The word with the number of words before those lists.
const LENGTH: usize = 2;

fn state(world: &World) -> Vec<u32> {
    let mut snapshot = Snapshot::new();
    world.snapshot(&mut snapshot);
    let bytes = snapshot.to_whole_bytes();
    let words = bytes.as_chunks::<4>().0.iter().map(|&four| u32::from_le_bytes(four));
    words.enumerate().map(|(i, word)| if SUMS.contains(&i) { 0 } else { word }).collect()
}

/// Where the states after a step differ; or the lists of bodies, shapes and joints, which follow them.
pub fn different_state(one: &Told, two: &Told) -> Option<(&'static str, String)> {
    let (one, two) = (&one.step.as_ref()?.state, &two.step.as_ref()?.state);
    let length = one[LENGTH] as usize;
    let part = if one.get(..length) == two.get(..length) { "lists" } else { "state" };
    let differ = one.iter().zip(two).enumerate().filter(|(_, (one, two))| one != two);
    let some: Vec<_> = differ.take(8).map(|(i, (one, two))| format!("{i}: {one:#x} {two:#x}")).collect();
    (one != two).then(|| (part, format!("{} and {} words; {}", one.len(), two.len(), some.join(", "))))
}

fn differ<T: PartialEq + Debug>(name: &str, one: &T, two: &T) -> Option<String> {
    (one != two).then(|| format!("{name} differ: {one:?} and {two:?}"))
}

/// The first of two lists that differs.
fn lists<T: PartialEq + Debug>(name: &str, one: &[T], two: &[T]) -> Option<String> {
    let place = (0..one.len().max(two.len())).find(|&i| one.get(i) != two.get(i))?;
    let (first, second) = (one.get(place), two.get(place));
    Some(format!(
        "{name} differ: {} and {}, of which {place}: {first:?} and {second:?}",
        one.len(),
        two.len()
    ))
}

/// The first thing that two of them tell differently.
pub fn difference(one: &Told, two: &Told) -> Option<String> {
    let of_step = || {
        let (one, two) = (one.step.as_ref()?, two.step.as_ref()?);
        // Within a budget rows are packed as its memory allows.
        let limited = one.limited || two.limited;
        let packed = |of: &OfStep| {
            let mut report = of.report;
            if limited {
                (report.batches, report.uncoloured) = (0, 0);
            }
            report
        };
        lists("bodies", &one.bodies, &two.bodies)
            .or_else(|| lists("broken joints", &one.broken, &two.broken))
            .or_else(|| lists("broken couplings", &one.uncoupled, &two.uncoupled))
            .or_else(|| lists("strained joints", &one.strained, &two.strained))
            .or_else(|| lists("contact begins", &one.begins, &two.begins))
            .or_else(|| lists("contact ends", &one.ends, &two.ends))
            .or_else(|| lists("contact hits", &one.hits, &two.hits))
            .or_else(|| lists("sensor begins", &one.entered, &two.entered))
            .or_else(|| lists("sensor ends", &one.left, &two.left))
            .or_else(|| lists("stopped bodies", &one.stopped, &two.stopped))
            .or_else(|| differ("reports", &packed(one), &packed(two)))
            .or_else(|| lists("awake bodies", &one.awake, &two.awake))
            .or_else(|| lists("moved bodies", &one.moved, &two.moved))
            .or_else(|| lists("joint forces", &one.joints, &two.joints))
            .or_else(|| lists("coupling forces", &one.couplings, &two.couplings))
            .or_else(|| lists("visitors", &one.visitors, &two.visitors))
            .or_else(|| lists("contacts", &one.contacts, &two.contacts))
    };
    differ("results", &one.result, &two.result)
        .or_else(of_step)
        .or_else(|| differ("hashes", &one.hash, &two.hash))
}

/// What is no number in what is told of bodies, joints, couplings, contacts and events.
pub fn not_finite(world: &World, handles: &Handles) -> Option<String> {
    for body in world.bodies() {
        let (at, rotation) = (world.position(body).ok()?, world.rotation(body).ok()?);
        let (linear, angular) = (world.linear_velocity(body).ok()?, world.angular_velocity(body).ok()?);
        if !(at.is_finite() && rotation.is_finite() && linear.is_finite() && angular.is_finite()) {
            return Some(format!("{body:?} at {at} {rotation}, moving {linear} {angular}"));
        }
    }
    for &joint in handles.joints.values().filter(|&&joint| world.contains_joint(joint)) {
        let (force, torque) = world.joint_force(joint).ok()?;
        let frames = world.joint_frames(joint).ok()?;
        let mut finite = force.is_finite() && torque.is_finite();
        finite &= frames.iter().all(|(at, rotation)| at.is_finite() && rotation.is_finite());
        for (motion, axis) in
            [Motion::Linear, Motion::Angular].into_iter().flat_map(|m| Axis::ALL.map(|a| (m, a)))
        {
            finite &= world.joint_position(joint, motion, Axes::One(axis)).ok()?.is_finite();
            finite &= world.joint_velocity(joint, motion, axis).ok()?.is_finite();
        }
        if !finite {
            return Some(format!("{joint:?}: {force} {torque} {frames:?}"));
        }
    }
    for &coupling in handles.couplings.values().filter(|&&coupling| world.contains_coupling(coupling)) {
        let (force, at) = (world.coupling_force(coupling).ok()?, world.coupling_positions(coupling).ok()?);
        let sum = world.coupling_sum(coupling).ok()?;
        if !(force.iter().all(|x| x.is_finite()) && at.iter().all(|x| x.is_finite()) && sum.is_finite()) {
            return Some(format!("{coupling:?}: {force:?} {at:?} {sum}"));
        }
    }
    let events = [world.contact_begins(), world.contact_hits()];
    let mut events = events.into_iter().flatten();
    let wrong = events.find(|e| {
        !(e.point.is_finite()
            && e.normal.is_finite()
            && e.approach_speed.is_finite()
            && e.impulse.is_finite())
    });
    if let Some(event) = wrong {
        return Some(format!("{event:?}"));
    }
    let wrong = world.contacts().find(|contact| {
        let points = contact.points().iter();
        let points =
            points.map(|p| p.position.is_finite() && p.separation.is_finite() && p.impulse.is_finite());
        !(contact.normal.is_finite()
            && contact.impulse().is_finite()
            && points.fold(true, |all, one| all & one))
    });
    wrong.map(|contact| format!("{contact:?}"))
}
