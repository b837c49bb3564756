//! Calls of a world, in any order and with any numbers.

use super::check;
use super::input::Input;
use backstop::{
    Axes, Axis, BodyHandle, Continuous, Drive, Frame, JointDesc, JointHandle, Limit, Motion, QueryFilter,
    Ray, RowGroup, Settings, ShapeHandle, Snapshot, Spring, World,
};

/// Bodies, joints and steps that a run has at most: it is to be quick.
const MOST: [usize; 3] = [24, 16, 24];

pub fn run(bytes: &[u8]) {
    let input = &mut Input::new(bytes);
    let settings = Settings::default().with_sleeping(input.bool()).with_substeps(1 + input.below(4) as u32);
    let mut world = World::new(settings).expect("usual settings");
    let (mut bodies, mut joints, mut steps) = (Vec::new(), Vec::new(), 0);
    let mut saved = None;
    while !input.is_empty() && steps < MOST[2] {
        // What is refused has changed nothing; which calls are is of no interest here.
        let call = input.below(32);
        match call {
            0..=5 if bodies.len() < MOST[0] => bodies.extend(world.add_body(&input.body())),
            6..=7 if joints.len() < MOST[1] && !bodies.is_empty() => {
                joints.extend(world.add_joint(&joint(input, &bodies)))
            }
            8..=15 => {
                let dt = if input.byte() < 16 { input.number() } else { 1.0 / 60.0 };
                if world.step(dt).is_ok() {
                    steps += 1;
                    check(&world);
                }
            }
            16 => {
                let snapshot = saved.get_or_insert_with(Snapshot::new);
                world.snapshot(snapshot);
                twice(&mut world, snapshot);
                steps += 2;
            }
            17 => drop(saved.as_ref().map(|snapshot| world.restore(snapshot))),
            _ => other(&mut world, call, input, (&bodies, &joints)),
        }
    }
}

/// Two steps after a snapshot, and the same after it was restored.
fn twice(world: &mut World, snapshot: &Snapshot) {
    let go = |world: &mut World| {
        (0..2).for_each(|_| drop(world.step(1.0 / 60.0)));
        world.hash()
    };
    let first = go(world);
    world.restore(snapshot).expect("the world's own snapshot");
    assert_eq!(go(world), first, "a snapshot went another way");
}

fn one<T: Copy>(input: &mut Input<'_>, of: &[T]) -> Option<T> {
    (!of.is_empty()).then(|| of[input.below(of.len())])
}

fn joint(input: &mut Input<'_>, bodies: &[BodyHandle]) -> JointDesc {
    let body = |input: &mut Input<'_>| bodies[input.below(bodies.len())];
    let frame = |input: &mut Input<'_>| Frame { position: input.vector(), rotation: input.rotation() };
    let mut joint = JointDesc::new([body(input), body(input)], [frame(input), frame(input)]);
    joint.collide = input.bool();
    for _ in 0..input.below(4) {
        joint = joint.with_limit(limit(input));
    }
    for _ in 0..input.below(3) {
        joint = joint.with_drive(drive(input));
    }
    joint
}

fn limit(input: &mut Input<'_>) -> Limit {
    let motion = input.pick(&[Motion::Linear, Motion::Angular]);
    let axes = input.pick(&[Axes::All, Axes::One(Axis::X), Axes::One(Axis::Y), Axes::Around(Axis::Z)]);
    let (min, max) = if input.bool() { (0.0, 0.0) } else { (input.number(), input.number()) };
    let limit = Limit::new(motion, axes, min, max);
    if input.byte() < 64 { limit.with_spring(spring(input)) } else { limit }
}

fn spring(input: &mut Input<'_>) -> Spring {
    let (stiffness, damping) = (input.size() * 10.0, input.size());
    match input.below(3) {
        0 => Spring::Frequency { hertz: stiffness, ratio: damping },
        1 => Spring::Coefficients { stiffness, damping },
        _ => Spring::Acceleration { stiffness, damping },
    }
}

fn drive(input: &mut Input<'_>) -> Drive {
    let (motion, axis) = (input.pick(&[Motion::Linear, Motion::Angular]), input.pick(&[Axis::X, Axis::Z]));
    let spring = spring(input);
    Drive::spring(motion, axis, input.number(), spring)
}

fn other(
    world: &mut World,
    call: usize,
    input: &mut Input<'_>,
    (bodies, joints): (&[BodyHandle], &[JointHandle]),
) {
    let Some(body) = one(input, bodies) else { return };
    let shape = |world: &World| -> Option<ShapeHandle> { world.shapes(body).ok()?.next() };
    let group = |input: &mut Input<'_>| input.bool().then_some(RowGroup::Contacts);
    match call {
        18 => drop(world.remove_body(body)),
        19 => drop(world.add_shape(body, &input.shape())),
        20 => drop(shape(world).map(|shape| world.remove_shape(shape))),
        21 => drop(world.set_pose(body, input.place(), input.rotation())),
        22 => drop(world.set_velocity(body, input.vector() * 10.0, input.vector())),
        23 => drop(world.add_force(body, input.vector() * 100.0, input.vector())),
        24 => drop(world.apply_impulse(body, input.vector() * 10.0, input.place())),
        25 => drop(if input.bool() { world.wake(body) } else { world.send_to_sleep(body) }),
        26 => drop(world.set_enabled(body, input.bool())),
        27 => drop(world.solve_body_after(body, group(input))),
        28 => drop(one(input, joints).map(|joint| world.remove_joint(joint))),
        29 => {
            let (limits, drives) = ([limit(input)], [drive(input)]);
            let Some(joint) = one(input, joints) else { return };
            drop(world.set_joint_limits(joint, &limits));
            drop(world.set_joint_drives(joint, &drives));
            let (limit, drive) = (limit(input), drive(input));
            drop(world.set_joint_limit(joint, limit));
            drop(world.set_joint_drive(joint, drive));
            drop(world.set_joint_target(joint, drive.motion, drive.axis, drive.velocity, drive.position));
            drop(world.set_joint_thresholds(joint, drive.max_force, drive.max_force));
            drop(world.set_joint_strength(joint, drive.position, drive.velocity));
            drop(world.set_joint_collide(joint, input.bool()));
            drop(world.remove_joint_limit(joint, limit.motion, limit.axes));
            drop(world.remove_joint_drive(joint, drive.motion, drive.axis));
        }
        30 => {
            let (sensor, listening) = (input.byte() < 64, input.bool());
            drop(shape(world).map(|shape| world.set_sensor(shape, sensor)));
            drop(shape(world).map(|shape| world.set_listening(shape, listening, sensor)));
            drop(world.set_continuous(body, Continuous::Volume));
            drop(world.set_can_sleep(body, listening));
        }
        _ => {
            let ray = Ray::new(input.place(), input.vector());
            if let Ok(Some(hit)) = world.cast_ray(&ray, &QueryFilter::default()) {
                assert!((0.0..=1.0).contains(&hit.fraction) && hit.normal.is_finite());
            }
        }
    }
}
