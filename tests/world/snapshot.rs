//! What is restored goes on to the bits of the run that never stopped.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]
use crate::common;
use crate::common::random::Random;

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::scene::{Scene, builtin};
use backstop::{
    BodyDesc, BodyHandle, Continuous, Drive, Error, Filter, Frame, Geometry, JointDesc, JointHandle, Limit,
    Material, Motion, Settings, ShapeDesc, ShapeHandle, Snapshot, World,
};

const DT: f32 = 1.0 / 60.0;

fn pile_of(bodies: usize) -> Scene {
    let mut scene = builtin::pile();
    scene.bodies.truncate(5 + bodies);
    scene
}

fn bouncing() -> Scene {
    let mut scene = builtin::bullets(true);
    scene.bodies.truncate(100 + 200);
    for body in &mut scene.bodies {
        body.desc.shapes.iter_mut().for_each(|s| s.material.restitution = 0.5);
    }
    scene
}

fn fewer_bullets() -> Scene {
    let mut scene = builtin::bullets(false);
    scene.bodies.truncate(301);
    scene
}

/// What the caller does before a step.
type Act = fn(&mut World, &[BodyHandle], u32);

fn nothing(_: &mut World, _: &[BodyHandle], _: u32) {}

/// A table tilts under what lies on it.
fn tilt(world: &mut World, bodies: &[BodyHandle], step: u32) {
    let angle = 0.2 * libm::sinf(step as f32 * 0.05);
    world.move_kinematic(bodies[0], DVec3::Y, Quat::from_rotation_z(angle), DT).unwrap();
    world.add_force(bodies[5], Vec3::new(3.0, 20.0, 0.0), Vec3::Y).unwrap();
}

fn table() -> Scene {
    let mut scene = pile_of(40);
    let table = ShapeDesc::new(Geometry::cuboid(4.0, 0.2, 4.0));
    scene.bodies.remove(0);
    let table = BodyDesc::kinematic().at(DVec3::Y).with_shape(table);
    scene.bodies.insert(0, scene.bodies[0].clone());
    scene.bodies[0].desc = table;
    scene.bodies.iter_mut().skip(5).for_each(|body| body.desc.position.y += 0.5);
    scene
}

/// A scene, its settings, what the caller does, when snapshots are taken, and steps to go on from there.
struct Case {
    name: &'static str,
    scene: Scene,
    sleeping: bool,
    act: Act,
    /// Length of the step with a number [s].
    dt: fn(u32) -> f32,
    at: &'static [u32],
    on: u32,
}

fn cases() -> Vec<Case> {
    let case = |name, scene, at, on| Case { name, scene, sleeping: false, act: nothing, dt: |_| DT, at, on };
    vec![
        // All hit the terrain between the steps 20 and 33.
        case("talk", builtin::talk(), &[0, 10, 24, 30, 60], 40),
        case("pile", pile_of(300), &[1, 40, 75, 110], 30),
        case("bullets", fewer_bullets(), &[1, 5, 12, 40], 25),
        case("pyramid", builtin::large_pyramid(12), &[3, 60], 30),
        case("bounce", bouncing(), &[2, 4, 6, 9, 20], 25),
        case("chain", builtin::chain(true), &[0, 10, 50], 40),
        case("joint_grid", builtin::joint_grid(8), &[0, 10, 30], 30),
        Case { sleeping: true, ..case("sleep", pile_of(120), &[100, 200, 280, 400], 120) },
        Case { act: tilt, ..case("table", table(), &[0, 1, 30, 90], 60) },
        // Mean forces are kept once the steps vary, from the 30th on, and the springs are between two lengths.
        Case {
            dt: |step| if step > 30 && step % 3 == 0 { 0.04 } else { DT },
            ..case("varying", pile_of(100), &[29, 31, 34, 90], 40)
        },
    ]
}

fn world_of(case: &Case, threads: usize) -> (World, Vec<BodyHandle>) {
    let settings = Settings { threads, sleeping: case.sleeping, ..Settings::default() };
    common::world_of(&case.scene, settings)
}

fn advance(world: &mut World, bodies: &[BodyHandle], case: &Case, from: u32, count: u32) -> Vec<u64> {
    (from..from + count)
        .map(|step| {
            (case.act)(world, bodies, step);
            world.step((case.dt)(step)).unwrap();
            world.hash()
        })
        .collect()
}

/// Takes snapshots on the way of a run, goes on, restores each in an order that jumps to and fro, and compares every step.
fn goes_on(case: &Case, threads: usize) {
    let (mut world, bodies) = world_of(case, 1);
    let end = case.at.last().unwrap() + case.on;
    let mut snapshots = Vec::new();
    let mut hashes = Vec::new();
    for step in 0..end {
        if case.at.contains(&step) {
            let mut snapshot = Snapshot::new();
            world.snapshot(&mut snapshot);
            snapshots.push((step, world.hash(), snapshot));
        }
        hashes.extend(advance(&mut world, &bodies, case, step, 1));
    }
    assert!(!case.sleeping || world.asleep() > 0, "{}: something is to sleep", case.name);
    let (mut other, _) = world_of(case, threads);
    for (step, hash, snapshot) in snapshots.iter().rev().chain(&snapshots) {
        for (which, world) in [(0, &mut world), (1, &mut other)] {
            let world: &mut World = world;
            let threads = world.settings().threads;
            world.restore(snapshot).unwrap();
            assert_eq!(world.hash(), *hash, "{} at {step}", case.name);
            assert_eq!(world.settings().threads, threads);
            let mut again = Snapshot::new();
            world.snapshot(&mut again);
            assert_eq!(again.size(), snapshot.size(), "{} at {step}", case.name);
            let from = *step as usize;
            for (i, hash) in advance(world, &bodies, case, *step, case.on).into_iter().enumerate() {
                assert_eq!(
                    hash,
                    hashes[from + i],
                    "{}, world {which}: restored at {step}, differs after {} steps",
                    case.name,
                    i + 1
                );
            }
        }
    }
}

#[test]
fn what_is_restored_goes_on_to_the_same_bits() {
    for case in cases() {
        let start = std::time::Instant::now();
        goes_on(&case, 1);
        println!("{}: {:.1} s", case.name, start.elapsed().as_secs_f32());
    }
}

#[cfg(feature = "parallel")]
#[test]
fn another_number_of_threads_goes_on_to_the_same_bits() {
    for threads in [2, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        for case in cases().iter().filter(|case| ["pile", "bullets", "bounce", "sleep"].contains(&case.name))
        {
            pool.install(|| goes_on(case, threads));
        }
    }
}

/// A world and what a game remembers of it: part of what is rolled back.
#[derive(Default)]
struct Game {
    world: World,
    bodies: Vec<BodyHandle>,
    joints: Vec<JointHandle>,
}

impl Game {
    fn new(sleeping: bool, threads: usize) -> Game {
        let settings = Settings { sleeping, threads, sleep_time: 0.2, ..Settings::default() };
        let mut game = Game { world: World::new(settings).unwrap(), ..Game::default() };
        game.world.add_body(&common::Floor::Mesh.desc(Material::default())).unwrap();
        let wall = ShapeDesc::new(Geometry::cuboid(0.2, 1.0, 4.0));
        game.bodies.push(game.world.add_body(&BodyDesc::fixed().at(Vec3::X * 4.0).with_shape(wall)).unwrap());
        let mut rng = Random(7);
        for _ in 0..40 {
            game.add(&mut rng);
        }
        game
    }

    fn geometry(rng: &mut Random) -> Geometry {
        match rng.below(5) {
            0 => Geometry::Sphere { radius: 0.2 + 0.2 * rng.unit() },
            1 => Geometry::capsule(0.2, 0.15 + 0.1 * rng.unit()),
            2 => Geometry::cylinder(0.2, 0.2),
            _ => Geometry::cuboid(0.2, 0.15 + 0.1 * rng.unit(), 0.25),
        }
    }

    fn add(&mut self, rng: &mut Random) {
        let mut shape = ShapeDesc::new(Game::geometry(rng));
        shape.material.restitution = if rng.below(4) == 0 { 0.6 } else { 0.0 };
        let at = rng.cube() * 3.0 + Vec3::Y * 4.0;
        let desc = match rng.below(12) {
            0 => BodyDesc::kinematic().at(at).with_shape(shape).moving(rng.cube(), rng.cube()),
            1 => BodyDesc::fixed().at(at - Vec3::Y * 3.5).with_shape(shape),
            2 => BodyDesc::dynamic().at(at).with_shape(shape).moving(rng.cube() * 300.0, rng.cube() * 20.0),
            3 => {
                let mut second = ShapeDesc::new(Game::geometry(rng));
                second.position = rng.cube() * 0.3;
                BodyDesc::dynamic().at(at).with_shape(shape).with_shape(second)
            }
            _ => BodyDesc::dynamic().at(at).with_shape(shape),
        };
        self.bodies.push(self.world.add_body(&desc).unwrap());
    }

    fn some(&self, rng: &mut Random) -> BodyHandle {
        self.bodies[rng.below(self.bodies.len())]
    }

    /// Any call that a game may make. What is refused must be refused again.
    fn call(&mut self, rng: &mut Random) {
        let body = self.some(rng);
        let world = &mut self.world;
        match rng.below(24) {
            0..=2 => self.add(rng),
            3 | 4 if self.bodies.len() > 20 => {
                let gone = self.bodies.swap_remove(rng.below(self.bodies.len()));
                world.remove_body(gone).unwrap();
                self.joints.retain(|&joint| world.contains_joint(joint));
            }
            5 => {
                let other = self.bodies[rng.below(self.bodies.len())];
                let frames = [Frame::at(rng.cube() * 0.4), Frame::at(rng.cube() * 0.4)];
                let desc = match rng.below(4) {
                    0 => JointDesc::ball([body, other], frames),
                    1 => JointDesc::hinge([body, other], frames).breaking(3000.0, 3000.0),
                    2 => JointDesc::distance([body, other], frames, 0.1, 1.0),
                    _ => JointDesc::slider([body, other], frames).colliding(true),
                };
                self.joints.extend(world.add_joint(&desc));
            }
            6 if !self.joints.is_empty() => {
                let gone = self.joints.swap_remove(rng.below(self.joints.len()));
                let _ = world.remove_joint(gone);
            }
            7 if !self.joints.is_empty() => {
                let joint = self.joints[rng.below(self.joints.len())];
                let limit = Limit::new(Motion::Linear, backstop::Axes::All, 0.0, 0.5);
                let drive = Drive::friction(Motion::Angular, backstop::Axis::X, 0.5);
                let _ = world.set_joint(joint, &[limit], &[drive]);
            }
            8 => {
                // What joints have thrown beyond all speeds takes none.
                let _ = world.apply_impulse(body, rng.cube() * 100.0, DVec3::Y);
            }
            9 => world.add_force(body, rng.cube() * 500.0, rng.cube()).unwrap(),
            10 => world.set_velocity(body, rng.cube() * 5.0, rng.cube()).unwrap(),
            11 => {
                let at = (rng.cube() * 3.0 + Vec3::Y * 2.0).as_dvec3();
                world.set_pose(body, at, Quat::IDENTITY).unwrap();
            }
            12 => world.wake(body).unwrap(),
            13 => world.send_to_sleep(body).unwrap(),
            14 => {
                let shape = world.shapes(body).unwrap().next();
                if let Some(shape) = shape {
                    let material = Material::default().with_restitution(0.5 * rng.unit());
                    world.set_material(shape, material).unwrap();
                }
            }
            15 => {
                let _ = world.add_shape(body, &ShapeDesc::new(Game::geometry(rng)));
            }
            16 => {
                let shapes: Vec<ShapeHandle> = world.shapes(body).unwrap().collect();
                if shapes.len() > 1 {
                    let _ = world.remove_shape(shapes[0]);
                }
            }
            17 => {
                let shape = world.shapes(body).unwrap().next();
                if let Some(shape) = shape {
                    let group = rng.below(3) as i32 - 1;
                    world.set_filter(shape, Filter { group, ..Filter::default() }).unwrap();
                }
            }
            18 => world.set_gravity_scale(body, rng.unit()).unwrap(),
            19 => {
                let modes = [Continuous::Discrete, Continuous::Segment, Continuous::Volume];
                world.set_continuous(body, modes[rng.below(3)]).unwrap();
            }
            20 => world.set_can_sleep(body, rng.below(2) == 0).unwrap(),
            21 => {
                let settings = world.settings().clone();
                let substeps = 1 + rng.below(5) as u32;
                let length_unit = [1.0, 0.5, 2.0][rng.below(3)];
                let sleeping = if rng.below(4) == 0 { !settings.sleeping } else { settings.sleeping };
                let gravity = Vec3::Y * (-9.0 - rng.unit());
                world
                    .set_settings(Settings { substeps, length_unit, sleeping, gravity, ..settings })
                    .unwrap();
            }
            22 => world.raise_body(body, None).unwrap(),
            _ => world.set_origin(rng.cube().as_dvec3()).unwrap(),
        }
        let world = &self.world;
        self.joints.retain(|&joint| world.contains_joint(joint));
    }

    fn frame(&mut self, rng: &mut Random) -> u64 {
        for _ in 0..rng.below(4) {
            self.call(rng);
        }
        self.world.step(DT).unwrap();
        let world = &self.world;
        self.joints.retain(|&joint| world.contains_joint(joint));
        self.world.hash()
    }
}

/// Random calls, and at random frames back to an earlier one, from where all goes on as it did before.
fn random_calls(seed: u64, frames: usize, sleeping: bool) {
    let mut game = Game::new(sleeping, 1);
    let inputs: Vec<u64> = (0..frames as u64).map(|frame| seed.wrapping_mul(977) + frame).collect();
    let mut saved = Vec::new();
    let mut hashes = Vec::new();
    for &input in &inputs {
        let mut rng = Random(input);
        // Between the calls of a frame, not only before them.
        for _ in 0..rng.below(3) {
            game.call(&mut rng);
        }
        let mut snapshot = Snapshot::new();
        game.world.snapshot(&mut snapshot);
        saved.push((snapshot, game.bodies.clone(), game.joints.clone(), rng.clone()));
        hashes.push(game.frame(&mut rng));
    }
    let mut other = Game::new(sleeping, 1);
    let mut rng = Random(seed);
    for round in 0..12 {
        let game = if round % 3 == 2 { &mut other } else { &mut game };
        let from = rng.below(frames);
        let (snapshot, bodies, joints, state) = &saved[from];
        game.world.restore(snapshot).unwrap();
        // Bytes with numbers that are none are refused, should joints that contradict each other have come to that.
        if round % 2 == 1 && common::all_finite(&game.world) {
            let away = &saved[(from + 7) % frames].0;
            game.world.restore(away).unwrap();
            let bytes = snapshot.to_whole_bytes();
            game.world.restore(&Snapshot::from_bytes(&bytes).unwrap()).unwrap();
        }
        (game.bodies, game.joints) = (bodies.clone(), joints.clone());
        let mut state = state.clone();
        for frame in from..frames.min(from + 25) {
            if frame > from {
                state = Random(inputs[frame]);
                for _ in 0..state.below(3) {
                    game.call(&mut state);
                }
            }
            let hash = game.frame(&mut state);
            assert_eq!(hash, hashes[frame], "seed {seed}, round {round}: from {from}, differs at {frame}");
        }
    }
}

#[test]
fn random_calls_give_the_same_bits_again() {
    for seed in 1..=12 {
        random_calls(seed, 90, seed % 3 == 0);
    }
}

#[test]
fn handles_are_those_of_the_time() {
    let mut world = World::new(Settings::default()).unwrap();
    world.add_body(&common::Floor::Box.desc(Material::default())).unwrap();
    let ball = |x: f32, user_data: u64| {
        let mut desc =
            common::dynamic(Geometry::Sphere { radius: 0.2 }, Material::default(), Vec3::new(x, 1.0, 0.0));
        desc.user_data = user_data;
        desc
    };
    let (a, b) = (world.add_body(&ball(0.0, 1)).unwrap(), world.add_body(&ball(1.0, 2)).unwrap());
    let joint = world.add_joint(&JointDesc::ball([a, b], [Frame::default(), Frame::at(Vec3::X)])).unwrap();
    common::steps(&mut world, 3, DT);
    let mut snapshot = Snapshot::new();
    world.snapshot(&mut snapshot);
    let hash = world.hash();
    world.remove_body(a).unwrap();
    let c = world.add_body(&ball(2.0, 3)).unwrap();
    let d = world.add_body(&ball(3.0, 4)).unwrap();
    common::steps(&mut world, 2, DT);
    world.restore(&snapshot).unwrap();
    assert_eq!((world.hash(), world.body_count(), world.joint_count()), (hash, 3, 1));
    assert_eq!((world.user_data(a), world.user_data(b)), (Ok(1), Ok(2)));
    assert_eq!(world.user_data(c), Err(Error::StaleBody));
    assert_eq!(world.user_data(d), Err(Error::StaleBody));
    assert_eq!(world.joint_bodies(joint), Ok([a, b]));
    // The same calls give the same handles again.
    world.remove_body(a).unwrap();
    assert_eq!(world.add_body(&ball(2.0, 3)), Ok(c));
}

fn snapshot_of(world: &World) -> Snapshot {
    let mut snapshot = Snapshot::new();
    world.snapshot(&mut snapshot);
    snapshot
}

#[test]
fn bytes_go_to_a_world_that_was_made_by_the_same_calls() {
    for case in cases() {
        let (mut world, bodies) = world_of(&case, 1);
        advance(&mut world, &bodies, &case, 0, 30);
        let bytes = snapshot_of(&world).to_bytes();
        let expected = advance(&mut world, &bodies, &case, 30, 20);
        // One that has not been stepped yet, and one that has.
        for steps in [0, 7] {
            let (mut other, bodies) = world_of(&case, 1);
            advance(&mut other, &bodies, &case, 0, steps);
            other.restore(&Snapshot::from_bytes(&bytes).unwrap()).unwrap();
            assert_eq!(advance(&mut other, &bodies, &case, 30, 20), expected, "{}", case.name);
        }
    }
}

#[test]
fn whole_bytes_go_to_a_world_that_has_the_geometry() {
    let scene = pile_of(60);
    let (mut world, _) = common::world_of(&scene, Settings::default());
    common::steps(&mut world, 60, DT);
    let bytes = snapshot_of(&world).to_whole_bytes();
    common::steps(&mut world, 20, DT);
    let snapshot = Snapshot::from_bytes(&bytes).unwrap();
    // Its four hulls are on the first bodies.
    let mut fewer = scene.clone();
    fewer.bodies.truncate(5 + 20);
    let (mut other, _) = common::world_of(&fewer, Settings::default());
    other.restore(&snapshot).unwrap();
    common::steps(&mut other, 20, DT);
    assert_eq!(other.hash(), world.hash());
    // An empty world lacks them, and stays empty.
    let mut empty = World::new(Settings::default()).unwrap();
    assert!(matches!(empty.restore(&snapshot), Err(Error::ForeignSnapshot { .. })));
    assert_eq!(empty.body_count(), 0);
}

#[test]
fn a_snapshot_of_another_world_is_refused_and_changes_nothing() {
    let (mut world, _) = common::world_of(&pile_of(30), Settings::default());
    common::steps(&mut world, 30, DT);
    let bytes = snapshot_of(&world).to_bytes();
    let (mut other, _) = common::world_of(&pile_of(31), Settings::default());
    common::steps(&mut other, 10, DT);
    let before = (other.hash(), snapshot_of(&other).to_bytes());
    assert!(matches!(
        other.restore(&Snapshot::from_bytes(&bytes).unwrap()),
        Err(Error::ForeignSnapshot { .. })
    ));
    assert!(matches!(other.restore(&Snapshot::new()), Err(Error::BrokenSnapshot { .. })));
    assert_eq!((other.hash(), snapshot_of(&other).to_bytes()), before);
    let mut newer = bytes.clone();
    newer[4] += 1;
    assert!(matches!(Snapshot::from_bytes(&newer), Err(Error::SnapshotVersion { .. })));
    let mut flipped = bytes.clone();
    *flipped.last_mut().unwrap() ^= 1;
    assert!(matches!(Snapshot::from_bytes(&flipped), Err(Error::BrokenSnapshot { .. })));
}

/// Whatever bytes say, a world refuses them or can go on: with the checksum wrong, and with it put right.
#[test]
fn any_bytes_are_refused_or_can_be_stepped_on() {
    let mut game = Game::new(true, 1);
    let mut rng = Random(3);
    for _ in 0..150 {
        game.frame(&mut rng);
    }
    for whole in [false, true] {
        let snapshot = snapshot_of(&game.world);
        let good = if whole { snapshot.to_whole_bytes() } else { snapshot.to_bytes() };
        let (mut refused, mut taken) = (0, 0);
        for round in 0..3000 {
            let mut bytes = good.clone();
            for _ in 0..1 + rng.below(3) {
                // Counts come first, and break most.
                let place =
                    if round % 2 == 0 { rng.below(bytes.len()) } else { rng.below(bytes.len().min(400)) };
                match rng.below(4) {
                    0 => bytes[place] ^= 1 << rng.below(8),
                    1 => bytes[place] = rng.bits() as u8,
                    2 => bytes[place] = 0xff,
                    _ if round % 7 == 0 => bytes.truncate(place),
                    _ => bytes[place] = bytes[place].wrapping_add(1),
                }
                if bytes.is_empty() {
                    break;
                }
            }
            assert!(bytes == good || Snapshot::from_bytes(&bytes).is_err());
            common::snapshots::fix_checksum(&mut bytes);
            let before = game.world.hash();
            let restored = Snapshot::from_bytes(&bytes).and_then(|snapshot| game.world.restore(&snapshot));
            if restored.is_ok() {
                taken += 1;
                for _ in 0..2 {
                    game.world.step(DT).unwrap();
                }
                game.world.restore(&snapshot).unwrap();
            } else {
                refused += 1;
            }
            assert_eq!(game.world.hash(), before);
        }
        println!("whole {whole}: {refused} refused, {taken} taken");
        assert!(refused > 500 && taken > 100);
    }
}

/// What the issue asks for: below 200 bytes for a free body, and below 400 for one in a pile.
#[test]
fn a_body_takes_few_bytes() {
    let mut free = World::new(Settings::default()).unwrap();
    let floor = common::Floor::Box.desc(Material::default());
    free.add_body(&floor).unwrap();
    for i in 0..1000 {
        let at = Vec3::new((i % 10) as f32, 50.0 + (i / 100) as f32, (i / 10 % 10) as f32) * 3.0;
        let bouncy = Material::default().with_restitution(0.5);
        free.add_body(&common::dynamic(Geometry::cuboid(0.3, 0.2, 0.4), bouncy, at)).unwrap();
    }
    common::steps(&mut free, 30, DT);
    let of_free = snapshot_of(&free).size() / 1000;
    let (mut pile, _) = common::world_of(&pile_of(600), Settings::default());
    common::steps(&mut pile, 150, DT);
    let of_pile = snapshot_of(&pile).size() / 600;
    println!("free: {of_free} bytes, pile: {of_pile} bytes");
    assert!(of_free < 200, "{of_free}");
    assert!(of_pile < 400, "{of_pile}");
}

/// What events, sensors and disabled bodies need to go on: who touched whom, what shapes are for, who is not there.
#[test]
fn events_go_on_where_they_were() {
    use backstop::{Geometry, ShapeDesc};
    for bytes in [false, true] {
        let build = || {
            let mut world = World::new(Settings { sleeping: true, ..Settings::default() }).unwrap();
            let cube = || ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5)).with_events();
            world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane))).unwrap();
            let sensor = ShapeDesc::new(Geometry::cuboid(9.0, 2.0, 9.0)).sensing();
            world.add_body(&BodyDesc::fixed().with_shape(sensor)).unwrap();
            let away = world.add_body(&BodyDesc::fixed().at(DVec3::X * 3.0).with_shape(cube())).unwrap();
            let bodies: Vec<_> = (0..6)
                .map(|i| {
                    let at = DVec3::new(f64::from(i % 3) * 1.5, 0.6 + f64::from(i) * 0.9, 0.0);
                    world.add_body(&BodyDesc::dynamic().at(at).with_shape(cube())).unwrap()
                })
                .collect();
            let lift = world.add_body(&BodyDesc::kinematic().at(DVec3::Z * 3.0).with_shape(cube())).unwrap();
            for body in [away, lift, bodies[4]] {
                world.set_enabled(body, false).unwrap();
            }
            (world, bodies, lift)
        };
        let heard = |world: &World| {
            let ids = |events: &[backstop::ContactEvent]| events.iter().map(|e| e.shapes).collect::<Vec<_>>();
            let crossed = |events: &[backstop::SensorEvent]| {
                events.iter().map(|e| (e.sensor, e.visitor)).collect::<Vec<_>>()
            };
            let ends = world.contact_ends().to_vec();
            (ids(world.contact_begins()), ends, crossed(world.sensor_begins()), crossed(world.sensor_ends()))
        };
        let act = |world: &mut World, bodies: &[backstop::BodyHandle], lift, step: u32| {
            match step {
                70 => world.set_enabled(bodies[4], true).unwrap(),
                90 => world.set_enabled(lift, true).unwrap(),
                120 => world.set_enabled(bodies[1], false).unwrap(),
                140 => world.set_velocity(bodies[2], Vec3::Y * 9.0, Vec3::ZERO).unwrap(),
                _ => {}
            }
            world.step(1.0 / 60.0).unwrap();
        };
        for at in [5, 30, 60, 80, 110, 130] {
            let (mut world, bodies, lift) = build();
            (0..at).for_each(|step| act(&mut world, &bodies, lift, step));
            let mut snapshot = Snapshot::new();
            world.snapshot(&mut snapshot);
            let run = |world: &mut World| {
                let one = |step| {
                    act(world, &bodies, lift, step);
                    (world.hash(), heard(world), world.asleep())
                };
                (at..220).map(one).collect::<Vec<_>>()
            };
            let expected = run(&mut world);
            if bytes {
                // Into a world that the same calls made.
                let (mut other, bodies, lift) = build();
                (0..at).for_each(|step| act(&mut other, &bodies, lift, step));
                (0..3).for_each(|_| assert!(other.step(0.01).is_ok()));
                other.restore(&Snapshot::from_bytes(&snapshot.to_bytes()).unwrap()).unwrap();
                assert_eq!(run(&mut other), expected, "{at}");
            } else {
                world.restore(&snapshot).unwrap();
                assert_eq!(run(&mut world), expected, "{at}");
            }
        }
    }
}
