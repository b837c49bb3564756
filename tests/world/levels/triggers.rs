//! Sensors that notice static bodies: triggers of a level, and sensors that come into its ground.

use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::{
    BodyDesc, BodyHandle, BodyKind, ConvexHull, Geometry, HeightField, SensorEvent, Settings, ShapeDesc,
    ShapeHandle, Snapshot, TriangleMesh, World,
};

const DT: f32 = 1.0 / 60.0;

fn world_of(threads: usize) -> World {
    let settings = Settings::default().with_gravity(Vec3::ZERO).with_threads(threads).with_sleeping(true);
    World::new(settings).unwrap()
}

fn add(world: &mut World, body: BodyDesc, at: DVec3, shape: ShapeDesc) -> (BodyHandle, ShapeHandle) {
    let body = world.add_body(&body.with_position(at).with_shape(shape)).unwrap();
    (body, world.shapes(body).unwrap().next().unwrap())
}

fn trigger(half: f32) -> ShapeDesc {
    ShapeDesc::new(Geometry::cuboid(half, half, half)).as_sensor().with_senses_static(true)
}

fn door() -> ShapeDesc {
    ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5))
}

fn inside(world: &World, sensor: ShapeHandle) -> Vec<ShapeHandle> {
    let mut found = Vec::new();
    world.sensor_overlaps(sensor, &mut found).unwrap();
    found
}

/// How many began and ended in a step.
fn heard(world: &mut World) -> (usize, usize) {
    world.step(DT).unwrap();
    (world.sensor_begins().len(), world.sensor_ends().len())
}

/// A quad of 20 m at y = 0.
fn mesh() -> Geometry {
    let corners = [[-10.0, -10.0], [10.0, -10.0], [10.0, 10.0], [-10.0, 10.0]];
    let corners = corners.map(|[x, z]| Vec3::new(x, 0.0, z)).to_vec();
    Geometry::mesh(TriangleMesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap())
}

fn field() -> Geometry {
    Geometry::height_field(HeightField::new(21, 21, Vec2::ONE, vec![0.0; 21 * 21]).unwrap())
}

/// A door beside a static trigger that sees static shapes and one that does not. Expected: it enters when it
/// is put there and leaves when it is taken away, once each; a change of kind ends and begins; between
/// changes nothing is heard. The plain one hears of it only while it is kinematic.
#[test]
fn a_trigger_sees_a_door_that_is_placed_and_made_static() {
    let mut world = world_of(1);
    let (_, seeing) = add(&mut world, BodyDesc::fixed(), DVec3::ZERO, trigger(1.0));
    let plain = trigger(1.0).with_senses_static(false);
    let (_, plain) = add(&mut world, BodyDesc::fixed(), DVec3::ZERO, plain);
    assert!(world.senses_static(seeing).unwrap() && !world.senses_static(plain).unwrap());
    let (body, shape) = add(&mut world, BodyDesc::kinematic(), DVec3::ZERO, door());
    assert_eq!((heard(&mut world), inside(&world, seeing)), ((2, 0), vec![shape]));
    world.set_kind(body, BodyKind::Static).unwrap();
    assert_eq!(heard(&mut world), (1, 2));
    assert_eq!((inside(&world, seeing), inside(&world, plain)), (vec![shape], vec![]));
    for _ in 0..60 {
        assert_eq!(heard(&mut world), (0, 0));
    }
    world.set_pose(body, DVec3::X * 5.0, Quat::IDENTITY).unwrap();
    assert_eq!((heard(&mut world), inside(&world, seeing)), ((0, 1), vec![]));
    world.set_pose(body, DVec3::X, Quat::IDENTITY).unwrap();
    assert_eq!((heard(&mut world), inside(&world, seeing)), ((1, 0), vec![shape]));
    world.set_geometry(shape, mesh()).unwrap();
    assert_eq!(heard(&mut world), (1, 1));
    world.set_senses_static(seeing, false).unwrap();
    assert_eq!((heard(&mut world), inside(&world, seeing)), ((0, 1), vec![]));
    world.set_senses_static(seeing, true).unwrap();
    assert_eq!((heard(&mut world), inside(&world, seeing)), ((1, 0), vec![shape]));
    world.remove_body(body).unwrap();
    assert_eq!((heard(&mut world), heard(&mut world)), ((0, 1), (0, 0)));
    assert!(world.set_senses_static(shape, true).is_err());
}

/// Static shapes of every kind, within reach of a trigger and not, which is added before or after them.
/// Expected: those within reach, whatever was first. A half-space as a trigger sees the convex ones below it.
#[test]
fn a_static_trigger_sees_static_shapes_of_every_kind() {
    let hull = ConvexHull::new(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]).unwrap();
    let near = [
        (Geometry::sphere(0.5), DVec3::X * 1.4),
        (Geometry::capsule(0.5, 0.2), DVec3::Y * 1.6),
        (Geometry::cuboid(0.5, 0.5, 0.5), DVec3::Z * 1.4),
        (Geometry::cylinder(0.5, 0.5), DVec3::Y * -1.4),
        (Geometry::hull(hull), DVec3::splat(0.9)),
        (Geometry::plane(), DVec3::Y * -0.9),
        (mesh(), DVec3::Y * 0.9),
        (field(), DVec3::new(-5.0, 0.9, -5.0)),
    ];
    let far = [
        (Geometry::sphere(0.5), DVec3::splat(1.4)),
        (Geometry::plane(), DVec3::Y * -1.1),
        (mesh(), DVec3::Y * 1.1),
        (field(), DVec3::new(-5.0, 1.1, -5.0)),
    ];
    for first in [true, false] {
        for more in [0, 200] {
            let mut world = world_of(1);
            let early = first.then(|| add(&mut world, BodyDesc::fixed(), DVec3::ZERO, trigger(1.0)).1);
            if first {
                assert_eq!(heard(&mut world), (0, 0));
            }
            for i in 0..more {
                add(&mut world, BodyDesc::dynamic(), DVec3::X * f64::from(50 + 2 * i), door());
            }
            let shape = |(form, at): &(Geometry, DVec3)| (ShapeDesc::new(form.clone()), *at);
            let expected: Vec<ShapeHandle> = near
                .iter()
                .map(shape)
                .map(|(shape, at)| add(&mut world, BodyDesc::fixed(), at, shape).1)
                .collect();
            for (shape, at) in far.iter().map(shape) {
                add(&mut world, BodyDesc::fixed(), at, shape);
            }
            if !first {
                assert_eq!(heard(&mut world), (0, 0));
            }
            let sensor =
                early.unwrap_or_else(|| add(&mut world, BodyDesc::fixed(), DVec3::ZERO, trigger(1.0)).1);
            assert_eq!(heard(&mut world), (expected.len(), 0), "first: {first}, {more} more");
            assert_eq!(inside(&world, sensor), expected);
            assert_eq!(heard(&mut world), (0, 0));
        }
    }
    let mut world = world_of(1);
    let (_, below) = add(&mut world, BodyDesc::fixed(), DVec3::Y * -0.4, door());
    add(&mut world, BodyDesc::fixed(), DVec3::Y * 0.6, door());
    add(&mut world, BodyDesc::fixed(), DVec3::Y * -1.0, ShapeDesc::new(mesh()));
    assert_eq!(heard(&mut world), (0, 0));
    let half_space = ShapeDesc::new(Geometry::plane()).as_sensor().with_senses_static(true);
    let (_, sensor) = add(&mut world, BodyDesc::fixed(), DVec3::ZERO, half_space);
    assert_eq!((heard(&mut world), inside(&world, sensor)), ((1, 0), vec![below]));
}

/// The grounds that a sensor of 1 m comes into from 3 m above, and how far below the top it leaves [m].
fn grounds() -> [(Geometry, DVec3, Option<f64>); 4] {
    [
        (mesh(), DVec3::ZERO, Some(0.0)),
        (field(), DVec3::new(-10.0, 0.0, -10.0), Some(0.0)),
        (Geometry::cuboid(9.0, 0.25, 9.0), DVec3::Y * -0.25, Some(0.5)),
        (Geometry::plane(), DVec3::ZERO, None),
    ]
}

/// A ball of 1 m, a sensor, that moves down at an even speed through the ground. Expected: it enters once its
/// centre is 1 m above the top and leaves once it is 1 m below the bottom, in the step and at the fraction
/// that y = 3 - v t gives; so too if it does all of that within a step. Same events on two threads and from a
/// snapshot.
#[test]
fn a_sensor_enters_the_ground_and_leaves_it() {
    for (ground, at, depth) in grounds() {
        for (speed, kind) in
            [(6.3, BodyKind::Dynamic), (6.3, BodyKind::Kinematic), (6300.0, BodyKind::Dynamic)]
        {
            let run = |threads: usize, restored: bool| -> Vec<(u32, bool, SensorEvent)> {
                let mut world = world_of(threads);
                add(&mut world, BodyDesc::fixed(), at, ShapeDesc::new(ground.clone()));
                let ball = ShapeDesc::new(Geometry::sphere(1.0)).as_sensor().with_senses_static(true);
                let (body, _) = add(&mut world, BodyDesc::dynamic(), DVec3::Y * 3.0, ball);
                world.set_kind(body, kind).unwrap();
                world.set_velocity(body, Vec3::NEG_Y * speed, Vec3::ZERO).unwrap();
                let mut events = Vec::new();
                for step in 0..60 {
                    if restored && step % 7 == 3 {
                        let mut snapshot = Snapshot::new();
                        world.snapshot(&mut snapshot);
                        world.step(DT).unwrap();
                        world.restore(&snapshot).unwrap();
                    }
                    world.step(DT).unwrap();
                    events.extend(world.sensor_begins().iter().map(|event| (step, true, *event)));
                    events.extend(world.sensor_ends().iter().map(|event| (step, false, *event)));
                }
                events
            };
            let events = run(1, false);
            let moment = |way: f64| 60.0 * way / f64::from(speed);
            let enters = moment(2.0);
            assert_eq!((events[0].0, events[0].1), (enters as u32, true), "{ground:?}");
            assert!((f64::from(events[0].2.fraction) - enters.fract()).abs() < 1e-2, "{events:?}");
            let leaves = depth.map(|depth| (moment(4.0 + depth) as u32, false));
            assert_eq!(events.get(1).map(|event| (event.0, event.1)), leaves, "{ground:?}");
            assert!(events.len() <= 2);
            assert_eq!(events, run(2, false));
            assert_eq!(events, run(1, true));
        }
    }
}

/// A box with a sensor of 1 m around it rests on the ground and falls asleep. Expected: the ground enters
/// once; it is there while the box sleeps, after a snapshot's bytes and when the box wakes, and nothing is
/// heard; it leaves when it is removed, which wakes the box.
#[test]
fn a_sensor_keeps_the_ground_while_it_sleeps() {
    for (ground, at, _) in grounds() {
        let mut world = World::new(Settings::default().with_sleeping(true)).unwrap();
        let (floor, _) = add(&mut world, BodyDesc::fixed(), at, ShapeDesc::new(ground));
        let body = BodyDesc::dynamic().with_position(DVec3::Y * 0.5).with_shape(door());
        let body = world.add_body(&body.with_shape(trigger(1.0).with_density(0.0))).unwrap();
        let sensor = world.shapes(body).unwrap().nth(1).unwrap();
        let mut events = (0, 0);
        let mut run = |world: &mut World, steps: u32| {
            for _ in 0..steps {
                let (begins, ends) = heard(world);
                events = (events.0 + begins, events.1 + ends);
            }
            events
        };
        assert_eq!(run(&mut world, 120), (1, 0));
        assert!(world.is_sleeping(body).unwrap() && inside(&world, sensor).len() == 1);
        let mut snapshot = Snapshot::new();
        world.snapshot(&mut snapshot);
        world.restore(&Snapshot::from_bytes(&snapshot.to_whole_bytes()).unwrap()).unwrap();
        assert_eq!(run(&mut world, 10), (1, 0));
        assert!(world.is_sleeping(body).unwrap() && inside(&world, sensor).len() == 1);
        world.wake(body).unwrap();
        assert_eq!(run(&mut world, 10), (1, 0));
        world.sleep(body).unwrap();
        assert!(world.is_sleeping(body).unwrap());
        world.remove_body(floor).unwrap();
        assert!(!world.is_sleeping(body).unwrap());
        assert_eq!(run(&mut world, 10), (1, 1));
    }
}

/// A static sensor in a kinematic half-space and a static door, also if it no longer senses static bodies
/// when it is removed. Expected: whichever goes first, each begin has one end, with the same handles.
#[test]
fn what_a_removed_sensor_saw_ends_with_it() {
    for (asks, sensor_first) in [(true, true), (true, false), (false, true), (false, false)] {
        let mut world = world_of(1);
        let (own, sensor) = add(&mut world, BodyDesc::fixed(), DVec3::ZERO, trigger(1.0));
        let plane = ShapeDesc::new(Geometry::plane());
        let (plane, below) = add(&mut world, BodyDesc::kinematic(), DVec3::ZERO, plane);
        let (_, beside) = add(&mut world, BodyDesc::fixed(), DVec3::X, door());
        assert_eq!(heard(&mut world), (2, 0));
        world.set_senses_static(sensor, asks).unwrap();
        let (mut ends, mut begins) = (Vec::new(), vec![(sensor, below), (sensor, beside)]);
        for body in if sensor_first { [own, plane] } else { [plane, own] } {
            world.remove_body(body).unwrap();
            world.step(DT).unwrap();
            begins.extend(world.sensor_begins().iter().map(|event| (event.sensor, event.visitor)));
            ends.extend(world.sensor_ends().iter().map(|event| (event.sensor, event.visitor)));
        }
        begins.sort_unstable();
        ends.sort_unstable();
        assert_eq!(ends, begins, "{asks} {sensor_first}");
    }
}

/// Ground that is dug away under a sensor at rest, and filled again. Expected: an end, then a begin.
#[test]
fn a_sensor_notices_that_the_ground_changes() {
    let mut world = world_of(1);
    let (_, ground) = add(&mut world, BodyDesc::fixed(), DVec3::ZERO, ShapeDesc::new(field()));
    add(&mut world, BodyDesc::fixed(), DVec3::new(10.0, 0.9, 10.0), trigger(1.0));
    assert_eq!(heard(&mut world), (1, 0));
    world.set_heights(ground, [7, 7], [7, 7], &[-1.0; 49]).unwrap();
    assert_eq!((heard(&mut world), heard(&mut world)), ((0, 1), (0, 0)));
    world.set_heights(ground, [7, 7], [7, 7], &[0.0; 49]).unwrap();
    assert_eq!((heard(&mut world), heard(&mut world)), ((1, 0), (0, 0)));
}

/// Expected: a replay without divergence, with the same visitors at its end.
#[test]
fn a_recording_holds_what_sensors_see() {
    let buffer = backstop::replay::RecordingBuffer::default();
    let mut world = world_of(1);
    world.start_recording(buffer.clone()).unwrap();
    let (_, sensor) = add(&mut world, BodyDesc::fixed(), DVec3::ZERO, trigger(1.0));
    let (body, shape) = add(&mut world, BodyDesc::kinematic(), DVec3::X * 1.2, door());
    world.step(DT).unwrap();
    world.set_kind(body, BodyKind::Static).unwrap();
    world.step(DT).unwrap();
    world.set_senses_static(sensor, false).unwrap();
    world.step(DT).unwrap();
    world.set_senses_static(sensor, true).unwrap();
    world.step(DT).unwrap();
    world.stop_recording().unwrap();
    let bytes = buffer.bytes();
    let mut replay = backstop::replay::Replay::open(&bytes[..]).unwrap();
    assert_eq!(replay.run().unwrap().divergence, None);
    assert_eq!(inside(replay.world(), sensor), [shape]);
}
