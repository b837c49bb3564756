//! A world that has every part of the engine at once, and a game that uses them in every step.

use super::{ALLOCATIONS, common, one_at_a_time};
use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::{
    Axis, BodyDesc, BodyHandle, Character, CharacterHandle, CharacterSettings, ContactHook, ContactHooks,
    ContinuousMode, ConvexHull, CouplingDesc, Geometry, HeightField, JointDesc, JointHandle, Material,
    Motion, Motor, QueryFilter, Ragdoll, RowGroup, Settings, ShapeDesc, ShapeHandle, Skeleton, Snapshot,
    Spring, TriangleMesh, World,
};
use std::sync::Arc;
use std::sync::atomic::Ordering;

const DT: f32 = 1.0 / 60.0;
/// Until everything has fallen, met and slept once.
const STEPS: u32 = 400;

/// Lets every eighth contact pass and changes others.
struct Hooks;

impl ContactHooks for Hooks {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        let choice = contact.points().next().map_or(0, |(at, _)| at.x.to_bits() % 8);
        match choice {
            0 => contact.veto(),
            1 => contact.set_friction(0.1, 0.1).unwrap(),
            2 => contact.set_restitution(0.5).unwrap(),
            3 => contact.set_surface_velocity(0, Vec3::X).unwrap(),
            _ => {}
        }
    }
}

struct Everything {
    world: World,
    figure: Ragdoll,
    walker: CharacterHandle,
    table: BodyHandle,
    balls: Vec<BodyHandle>,
    door: JointHandle,
    zone: ShapeHandle,
    visitors: Vec<ShapeHandle>,
    heard: [usize; 5],
    slept: usize,
    /// In steps: poses of a figure are checked in a list of their own.
    allocations: usize,
}

fn materials() -> Vec<Material> {
    let plain = Material::default();
    vec![
        plain.with_restitution(0.7),
        plain.with_rolling_friction(0.05).with_spinning_friction(0.02),
        plain.with_surface_velocity(Vec3::new(1.0, 0.0, 0.3)),
        plain.with_contact_hertz(6.0).with_contact_damping(0.4),
    ]
}

/// A field of 20 m with a hole in it and materials, over a mesh of the same size, over a plane.
fn ground(world: &mut World) {
    let heights = (0..441).map(|i| 0.2 * ((i % 21) as f32 * 0.9).sin() * ((i / 21) as f32 * 0.7).cos());
    let of: Vec<u8> = (0..400).map(|cell| (cell % 5) as u8).collect();
    let field = HeightField::new(21, 21, Vec2::ONE, heights.collect()).unwrap();
    let field = field.with_materials(&of, &materials()).unwrap().with_holes([[12, 12], [13, 12]]).unwrap();
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::height_field(field)))).unwrap();
    let corners: Vec<Vec3> = [[-10.0, -10.0], [10.0, -10.0], [10.0, 10.0], [-10.0, 10.0]]
        .map(|[x, z]: [f32; 2]| Vec3::new(x, -2.0, z))
        .into();
    let triangles = vec![[0, 2, 1], [0, 3, 2]];
    let mesh = TriangleMesh::with_materials(corners, triangles, &[1, 3], &materials()).unwrap();
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::mesh(mesh)))).unwrap();
    let plane = ShapeDesc::new(Geometry::Plane);
    world.add_body(&BodyDesc::fixed().with_position(DVec3::Y * -4.0).with_shape(plane)).unwrap();
}

/// Bodies of every form and material over the field, a compound among them.
fn bodies(world: &mut World) -> Vec<BodyHandle> {
    let corners = [[0.3, -0.2, 0.1], [-0.3, -0.2, 0.2], [0.0, -0.2, -0.3], [0.0, 0.3, 0.0], [0.2, 0.2, 0.2]];
    let hull = Arc::new(ConvexHull::new(&corners.map(Vec3::from)).unwrap());
    let forms = [
        Geometry::sphere(0.25),
        Geometry::capsule(0.2, 0.15),
        Geometry::tapered_capsule(0.2, 0.2, 0.1),
        Geometry::cuboid(0.3, 0.15, 0.2),
        Geometry::cylinder(0.2, 0.2),
        Geometry::cone(0.25, 0.2),
        Geometry::hull(hull),
    ];
    let add = |world: &mut World, i: usize| {
        let mut shape = common::shape(forms[i % 7].clone(), materials()[i % 4]);
        (shape.events, shape.hooks) = (i.is_multiple_of(2), i.is_multiple_of(5));
        let at = DVec3::new((i % 9) as f64 - 4.0, 1.0 + 0.8 * (i / 27) as f64, (i / 9 % 3) as f64 - 1.0);
        let mut body = BodyDesc::dynamic()
            .with_position(at)
            .with_velocity(Vec3::X * (i % 4) as f32, Vec3::Y)
            .with_shape(shape);
        if i.is_multiple_of(6) {
            let knob = ShapeDesc::new(Geometry::sphere(0.1)).with_position(Vec3::Y * 0.3);
            body = body.with_shape(knob);
        }
        body.continuous = [ContinuousMode::Segment, ContinuousMode::Volume, ContinuousMode::Discrete][i % 3];
        body.linear_damping = if i.is_multiple_of(8) { 0.5 } else { 0.0 };
        body.max_linear_speed = i.is_multiple_of(10).then_some(5.0);
        body.lock_rotation = [i.is_multiple_of(11); 3];
        body.solved_after = i.is_multiple_of(13).then_some(RowGroup::Contacts);
        world.add_body(&body).unwrap()
    };
    (0..60).map(|i| add(world, i)).collect()
}

/// A train of three gears with a motor, a rack, two weights on a rope over a pulley, and a door that is to
/// swing. Returns the door's joint.
fn machines(world: &mut World) -> JointHandle {
    let frame = world.add_body(&BodyDesc::fixed().with_position(DVec3::new(0.0, 4.0, 7.0))).unwrap();
    let mut hang = |x: f32, make: &dyn Fn([BodyHandle; 2], [backstop::Frame; 2]) -> JointDesc| {
        let at = Vec3::new(x, 4.0, 7.0);
        let wheel = common::dynamic(Geometry::cuboid(0.1, 0.3, 0.1), Material::default(), at);
        // Joints are arranged anew when their bodies fall asleep or wake, and that does allocate.
        let wheel = wheel.with_can_sleep(false);
        let pair = [frame, world.add_body(&wheel).unwrap()];
        let frames = world.frames_at(pair, at.as_dvec3() + DVec3::Y * 0.3, Quat::IDENTITY).unwrap();
        world.add_joint(&make(pair, frames)).unwrap()
    };
    let gears = [0.0, 1.0, 2.0].map(|x| hang(x, &JointDesc::hinge));
    let slider = hang(3.0, &JointDesc::slider);
    let ropes = [4.0, 5.0].map(|x| hang(x, &|pair, frames| JointDesc::new(pair, frames)));
    let spring = Spring::Frequency { hertz: 3.0, ratio: 0.5 };
    hang(6.0, &|pair, frames| JointDesc::wheel(pair, frames, 0.2, spring).with_thresholds(0.1, 0.1));
    hang(7.0, &|pair, frames| JointDesc::fixed(pair, frames).with_break_force(1e6, 1e6));
    hang(-2.0, &|pair, frames| JointDesc::distance(pair, frames, 0.0, 0.5));
    let door = hang(-1.0, &|pair, frames| {
        JointDesc::hinge(pair, frames).with_motor(Motor::position(Motion::Angular, Axis::X, 0.0, spring))
    });
    world.set_joint_motor(gears[0], Motor::velocity(Motion::Angular, Axis::X, 3.0, 5.0)).unwrap();
    world.add_coupling(&CouplingDesc::gear([gears[0], gears[1]], [10.0, 11.0])).unwrap();
    world.add_coupling(&CouplingDesc::gear([gears[1], gears[2]], [11.0, 7.0])).unwrap();
    world.add_coupling(&CouplingDesc::rack(gears[2], slider, 0.2)).unwrap();
    world.add_coupling(&CouplingDesc::pulley(ropes, 2.0, 2.0).with_break_force([1e6; 2])).unwrap();
    door
}

impl Everything {
    fn new() -> Everything {
        let settings = Settings::default().with_sleeping(true).with_sleep_time(0.3);
        let mut world = World::new(settings).unwrap();
        ground(&mut world);
        let balls = bodies(&mut world);
        let door = machines(&mut world);
        let top = ShapeDesc::new(Geometry::cuboid(2.0, 0.1, 2.0)).with_events();
        let table = BodyDesc::kinematic().with_position(DVec3::new(-5.0, 1.0, 4.0)).with_shape(top);
        let table = world.add_body(&table).unwrap();
        let zone = ShapeDesc::new(Geometry::cuboid(3.0, 0.6, 3.0)).as_sensor().with_senses_static(true);
        let zone = world.add_body(&BodyDesc::fixed().with_shape(zone)).unwrap();
        let zone = world.shapes(zone).unwrap().next().unwrap();
        let (at, still) = (DVec3::new(0.0, 1.5, -4.0), Vec3::ZERO);
        let figure = Skeleton::humanoid().with_friction(2.0);
        let figure = figure.add_to(&mut world, at, Quat::IDENTITY, still).unwrap();
        figure.bodies.iter().for_each(|&bone| world.set_can_sleep(bone, false).unwrap());
        let walker = Character::new(CharacterSettings::default(), DVec3::new(3.0, 1.5, 3.0)).unwrap();
        let walker = world.add_character(&walker).unwrap();
        let (visitors, heard) = (Vec::with_capacity(200), [0; 5]);
        Everything {
            world,
            figure,
            walker,
            table,
            balls,
            door,
            zone,
            visitors,
            heard,
            slept: 0,
            allocations: 0,
        }
    }

    /// A frame of the game: everything is driven, then stepped, then listened to.
    fn frame(&mut self, frame: u32, poses: &[Vec<Quat>]) {
        let Everything { world, figure, walker, table, balls, door, .. } = self;
        let time = frame as f32 * DT;
        let tilt = Quat::from_rotation_z(0.2 * (2.0 * time).sin());
        world.move_kinematic(*table, DVec3::new(-5.0, 1.0, 4.0), tilt, DT).unwrap();
        let servo = Spring::Frequency { hertz: 4.0, ratio: 1.0 };
        figure.drive_to(world, &poses[frame as usize / 30 % poses.len()], servo, 100.0).unwrap();
        let wish = Vec3::new(2.0 * time.cos(), -2.0, 2.0 * time.sin());
        let walked = world.walk_character(*walker, &QueryFilter::new(), wish, DT).unwrap();
        walked.push(world).unwrap();
        world.set_joint_target(*door, Motion::Angular, Axis::X, time.sin(), 0.0).unwrap();
        if frame.is_multiple_of(20) {
            let ball = balls[frame as usize / 20 % balls.len()];
            let centre = world.centre_of_mass(ball).unwrap();
            world.apply_impulse_at(ball, Vec3::Y * 100.0, centre).unwrap();
            world.add_force_and_torque(ball, Vec3::X * 50.0, Vec3::Y).unwrap();
        }
        let before = ALLOCATIONS.load(Ordering::Relaxed);
        world.step_with(DT, &Hooks).unwrap();
        self.allocations += ALLOCATIONS.load(Ordering::Relaxed) - before;
        world.sensor_overlaps(self.zone, &mut self.visitors).unwrap();
        let heard = [
            world.contact_begins().len(),
            world.contact_hits().len(),
            world.sensor_begins().len(),
            world.strained_joints().len(),
            self.visitors.len(),
        ];
        self.heard = std::array::from_fn(|i| self.heard[i] + heard[i]);
        self.slept = self.slept.max(world.sleeping_body_count());
    }
}

/// The same frames a second time, from a snapshot: every buffer was as large as it has to be once before. The
/// same bits come out, and each allocation in a step is counted.
#[test]
fn a_world_of_everything_allocates_nothing() {
    let _alone = one_at_a_time();
    let mut all = Everything::new();
    let bones = all.figure.bodies.len();
    let poses = [0.0, 0.3, -0.4].map(|angle| vec![Quat::from_rotation_x(angle); bones]);
    let mut saved = Snapshot::new();
    // The first frame makes the figure's motors.
    all.frame(0, &poses);
    all.world.snapshot(&mut saved);
    let run = |all: &mut Everything| {
        let before = all.allocations;
        (1..STEPS).for_each(|frame| all.frame(frame, &poses));
        all.allocations - before
    };
    let first = run(&mut all);
    let hash = all.world.state_hash();
    all.world.restore(&saved).unwrap();
    let second = run(&mut all);
    assert_eq!(all.world.state_hash(), hash);
    assert!(first > 0, "nothing was counted");
    assert_eq!(second, 0);
    // All of it took part.
    assert!(all.heard.iter().all(|&count| count > 50), "{:?}", all.heard);
    assert!(all.slept > 0 && all.world.feature_report().not_needed().next().is_none(), "{}", all.slept);
}
