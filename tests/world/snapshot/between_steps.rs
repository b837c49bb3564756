//! A snapshot at any moment: of bodies on joints in every step, and between a change and the step that tells
//! of it.

use super::*;
use backstop::{BodyKind, CouplingDesc};

/// Two bodies on a ball joint over a floor, of random shapes, densities and velocities.
fn pair_on_a_joint(seed: u64) -> World {
    let mut random = Random(1 + seed);
    let mut world = World::new(Settings::default()).unwrap();
    let floor = ShapeDesc::new(Geometry::cuboid(50.0, 0.5, 50.0));
    world.add_body(&BodyDesc::fixed().with_position(DVec3::Y * -0.5).with_shape(floor)).unwrap();
    let mut bodies = Vec::new();
    let mut places = Vec::new();
    for _ in 0..2 {
        let size = random.range(0.15, 0.4);
        let shape = match random.below(4) {
            0 => Geometry::Sphere { radius: size },
            1 => Geometry::capsule(size, 0.5 * size),
            2 => Geometry::cuboid(size, 0.5 * size, 0.7 * size),
            _ => Geometry::cylinder(0.5 * size, size),
        };
        let at = Vec3::new(random.range(-2.0, 2.0), random.range(1.0, 4.0), random.range(-2.0, 2.0));
        let mut shape = ShapeDesc::new(shape);
        shape.density = 100.0 * 50.0_f32.powf(random.range(0.0, 1.0));
        let mut vector = |most: f32| Vec3::from_array([0; 3].map(|_| random.range(-most, most)));
        let body = BodyDesc::dynamic()
            .with_position(at.as_dvec3())
            .with_velocity(vector(30.0), vector(15.0))
            .with_shape(shape);
        bodies.push(world.add_body(&body).unwrap());
        places.push(at);
    }
    let (own, point) = ([bodies[0], bodies[1]], (places[0] + places[1]) * 0.5);
    let frames = world.frames_at(own, point.as_dvec3(), Quat::IDENTITY).unwrap();
    let mut joint = JointDesc::ball(own, frames);
    joint.collide = true;
    world.add_joint(&joint).unwrap();
    world
}

/// Of 300 such pairs 8 once went another way: nodes of trees had kept numbers of earlier steps, which a new
/// world does not have.
#[test]
fn bodies_on_a_joint_go_on_from_any_step_in_any_world() {
    let (mut snapshot, mut then) = (Snapshot::new(), [Snapshot::new(), Snapshot::new()]);
    let mut elsewhere = World::new(Settings::default()).unwrap();
    for seed in 0..100 {
        let mut world = pair_on_a_joint(seed);
        let rate = [30.0, 60.0, 120.0][seed as usize % 3];
        for step in 0..(2.0 * rate) as usize {
            world.snapshot(&mut snapshot);
            let mut new = World::new(Settings::default()).unwrap();
            new.restore(&snapshot).unwrap();
            elsewhere.restore(&snapshot).unwrap();
            for world in [&mut world, &mut new, &mut elsewhere] {
                world.step(1.0 / rate).unwrap();
            }
            world.snapshot(&mut then[0]);
            new.snapshot(&mut then[1]);
            assert_eq!(then[0].hash(), then[1].hash(), "seed {seed}, step {step}: the whole state");
            assert_eq!(world.state_hash(), new.state_hash(), "seed {seed}, step {step}: in a new world");
            assert_eq!(
                world.state_hash(),
                elsewhere.state_hash(),
                "seed {seed}, step {step}: in one with another past"
            );
        }
    }
}

/// A ball that lies on a box, both within a sensor, and all of them ask for events.
fn in_a_sensor() -> (World, [BodyHandle; 3], [ShapeHandle; 3]) {
    let mut world = World::new(Settings::default()).unwrap();
    let with_events = |geometry| ShapeDesc::new(geometry).with_events();
    let room = ShapeDesc::new(Geometry::cuboid(3.0, 3.0, 3.0)).with_sensor(true);
    let floor = with_events(Geometry::cuboid(2.0, 0.5, 2.0));
    let ball = with_events(Geometry::Sphere { radius: 0.5 });
    let bodies = [
        BodyDesc::fixed().with_shape(room),
        BodyDesc::kinematic().with_position(DVec3::Y * -0.5).with_shape(floor),
        BodyDesc::dynamic().with_position(DVec3::Y * 0.499).with_shape(ball),
    ]
    .map(|body| world.add_body(&body).unwrap());
    let shapes = bodies.map(|body| world.shapes(body).unwrap().next().unwrap());
    for _ in 0..5 {
        world.step(DT).unwrap();
    }
    let mut inside = Vec::new();
    world.sensor_overlaps(shapes[0], &mut inside).unwrap();
    assert_eq!(inside, [shapes[1], shapes[2]], "both are in the sensor");
    (world, bodies, shapes)
}

type Change = fn(&mut World, &[BodyHandle; 3], &[ShapeHandle; 3]);

/// Changes between steps by which something ends, and how many contacts and visits end by them: the ball's
/// contact with the box, and the visits of either.
const CHANGES: [(&str, Change, [usize; 2]); 8] = [
    ("the ball is removed", |w, b, _| w.remove_body(b[2]).unwrap(), [1, 1]),
    ("the box loses its shape", |w, _, s| w.remove_shape(s[1]).unwrap(), [1, 1]),
    ("it is disabled", |w, b, _| w.set_enabled(b[2], false).unwrap(), [1, 1]),
    ("it becomes static", |w, b, _| w.set_kind(b[2], BodyKind::Static).unwrap(), [1, 1]),
    ("the sensor is removed", |w, b, _| w.remove_body(b[0]).unwrap(), [0, 2]),
    ("the sensor becomes solid", |w, _, s| w.set_sensor(s[0], false).unwrap(), [0, 2]),
    ("the box is removed", |w, b, _| w.remove_body(b[1]).unwrap(), [1, 1]),
    // It becomes part of another tree, and its pair with the ball is made anew.
    ("the box becomes static", |w, b, _| w.set_kind(b[1], BodyKind::Static).unwrap(), [1, 1]),
];

/// Contacts that ended before the snapshot are reported by the step after it.
#[test]
fn a_snapshot_between_a_change_and_its_step_keeps_what_ended() {
    for (name, change, expected) in CHANGES {
        let (mut world, bodies, shapes) = in_a_sensor();
        change(&mut world, &bodies, &shapes);
        let mut snapshot = Snapshot::new();
        world.snapshot(&mut snapshot);
        let mut new = World::new(Settings::default()).unwrap();
        new.restore(&Snapshot::from_bytes(&snapshot.to_whole_bytes()).unwrap()).unwrap();
        let (mut same, ..) = in_a_sensor();
        same.restore(&snapshot).unwrap();
        for world in [&mut world, &mut new, &mut same] {
            world.step(DT).unwrap();
        }
        let told = [world.contact_ends().len(), world.sensor_ends().len()];
        assert_eq!(told, expected, "{name}: contacts and visits that ended");
        for (other, which) in [(&new, "a new world"), (&same, "another world")] {
            assert_eq!(world.contact_ends(), other.contact_ends(), "{name}: ends of contacts in {which}");
            assert_eq!(world.sensor_ends(), other.sensor_ends(), "{name}: ends of visits in {which}");
            assert_eq!(world.contact_begins(), other.contact_begins(), "{name}: begins in {which}");
        }
    }
}

/// A lower strength is valid: a joint that bears more breaks in the next step, in the restored world too.
#[test]
fn a_world_takes_its_own_snapshot_after_a_strength_was_lowered() {
    let mut world = World::new(Settings::default()).unwrap();
    let ceiling = world.add_body(&BodyDesc::fixed().with_position(DVec3::Y * 9.0)).unwrap();
    let cube = ShapeDesc::new(Geometry::cuboid(0.3, 0.3, 0.3));
    let joints = [-1.0, 1.0].map(|x| {
        let body =
            BodyDesc::dynamic().with_position(DVec3::new(f64::from(x), 4.0, 0.0)).with_shape(cube.clone());
        let body = world.add_body(&body).unwrap();
        let frames = [Frame::at(Vec3::X * x), Frame::default()];
        world.add_joint(&JointDesc::new([ceiling, body], frames)).unwrap()
    });
    let pulley = world.add_coupling(&CouplingDesc::pulley(joints, 1.0, 10.0)).unwrap();
    for _ in 0..60 {
        world.step(DT).unwrap();
    }
    // Each cube weighs 2,119 N.
    world.set_coupling_break_force(pulley, [100.0, 100.0]).unwrap();
    let mut snapshot = Snapshot::new();
    world.snapshot(&mut snapshot);
    let mut new = World::new(Settings::default()).unwrap();
    new.restore(&Snapshot::from_bytes(&snapshot.to_whole_bytes()).unwrap()).unwrap();
    for _ in 0..3 {
        world.step(DT).unwrap();
        new.step(DT).unwrap();
        assert_eq!(world.state_hash(), new.state_hash());
    }
    assert_eq!([world.coupling_count(), new.coupling_count()], [0, 0], "it broke in both");
}
