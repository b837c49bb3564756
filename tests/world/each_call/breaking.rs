//! Breaking and waking in a step take effect once its bodies have moved.
//!
//! Seen: a coupling between sleeping bodies was weakened below what it bore; it broke in the next step, after
//! motions were predicted, and woke bodies of which the step then read motions that nobody had predicted.

use crate::common::{self, random::Random};
use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::{
    Axis, BodyDesc, BodyHandle, BodyKind, Character, CharacterHandle, CharacterSettings, ContactHook,
    ContactHooks, ContinuousMethod, ContinuousMode, CouplingDesc, CouplingHandle, Error, Frame, Geometry,
    HeightField, JointDesc, JointHandle, Limit, Motion, Motor, QueryFilter, Settings, ShapeDesc, ShapeHandle,
    Skeleton, World,
};

const DT: f32 = 1.0 / 60.0;

fn block(half: Vec3, at: DVec3) -> BodyDesc {
    BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(Geometry::cuboid(half.x, half.y, half.z)))
}

/// Two blocks on a rope over two pulleys.
struct Pulley {
    world: World,
    bodies: [BodyHandle; 2],
    ropes: [JointHandle; 2],
    rope: CouplingHandle,
}

impl Pulley {
    fn new(settings: Settings, half: Vec3) -> Pulley {
        let mut world = World::new(settings.with_sleeping(true)).unwrap();
        let beam = world.add_body(&BodyDesc::fixed().with_position(DVec3::Y * 9.0)).unwrap();
        let sides = [-1.0, 1.0];
        let bodies = sides.map(|x| world.add_body(&block(half, DVec3::new(x, 4.0, 0.0))).unwrap());
        let ropes = [0, 1].map(|i| {
            let frames = [Frame::at(Vec3::X * sides[i] as f32), Frame::default()];
            world.add_joint(&JointDesc::new([beam, bodies[i]], frames)).unwrap()
        });
        let rope = world.add_coupling(&CouplingDesc::pulley(ropes, 1.0, 10.0)).unwrap();
        Pulley { world, bodies, ropes, rope }
    }
}

const HALVES: [Vec3; 2] = [Vec3::splat(0.3), Vec3::new(0.1, 0.3, 0.6)];
const MODES: [ContinuousMode; 3] =
    [ContinuousMode::Discrete, ContinuousMode::Segment, ContinuousMode::Volume];

/// Expected: a strength wakes the bodies of a coupling, as that of a joint does; the rope bears the weight of
/// one block on either side, far more than 1 N, so it breaks in the next step, in which both still hang; then
/// they fall freely, by g t² / 2.
#[test]
fn a_rope_that_is_weakened_while_its_blocks_sleep_breaks_in_the_next_step() {
    for (mode, half) in MODES.into_iter().flat_map(|mode| HALVES.map(|half| (mode, half))) {
        let Pulley { mut world, bodies, rope, .. } =
            Pulley::new(Settings::default().with_continuous(mode), half);
        common::steps(&mut world, 60, DT);
        world.sleep(bodies[0]).unwrap();
        assert_eq!(world.sleeping_body_count(), 2);
        let strength = world.coupling(rope).unwrap().break_force;
        world.set_coupling_break_force(rope, strength).unwrap();
        assert_eq!(world.sleeping_body_count(), 2, "a strength that is no other");
        world.set_coupling_break_force(rope, [1.0, 1.0]).unwrap();
        assert_eq!(world.sleeping_body_count(), 0);
        world.step(DT).unwrap();
        assert_eq!((world.broken_couplings(), world.coupling_count()), (&[rope][..], 0));
        let from = bodies.map(|body| world.position(body).unwrap().y);
        common::steps(&mut world, 30, DT);
        let fallen = 0.5 * 9.81 * 0.25;
        for (body, from) in bodies.into_iter().zip(from) {
            let fell = from - world.position(body).unwrap().y;
            assert!((fell - fallen).abs() < 0.005, "{mode:?} {half}: {fell} of {fallen}");
        }
    }
}

/// A body that hangs on a kinematic body sleeps, and the latter begins to turn: 30 rad/s at an arm of 1 m are
/// 900 m/s², which take 58 kN of 64 kg, more than the joint bears. Expected: it breaks in that step; the
/// sleeper is awake after it, and from then on falls, by g dt a step.
#[test]
fn a_joint_of_a_sleeping_body_breaks_by_what_it_hangs_on() {
    for mode in MODES {
        let mut world = World::new(Settings::default().with_sleeping(true).with_continuous(mode)).unwrap();
        let swing = world.add_body(&block(Vec3::splat(0.2), DVec3::new(1.0, 5.0, 0.0))).unwrap();
        let hand = world.add_body(&BodyDesc::kinematic().with_position(DVec3::Y * 5.2)).unwrap();
        let frames = world.frames_at([hand, swing], DVec3::new(1.0, 5.2, 0.0), Quat::IDENTITY).unwrap();
        let joint = JointDesc::ball([hand, swing], frames).with_break_force(5e3, f32::INFINITY);
        let joint = world.add_joint(&joint).unwrap();
        common::steps(&mut world, 30, DT);
        world.sleep(swing).unwrap();
        assert_eq!(world.is_sleeping(swing), Ok(true));
        world.set_velocity(hand, Vec3::ZERO, Vec3::Z * 30.0).unwrap();
        world.step(DT).unwrap();
        assert_eq!(world.broken_joints(), [joint]);
        assert_eq!(world.is_sleeping(swing), Ok(false));
        let from = world.linear_velocity(swing).unwrap().y;
        world.step(DT).unwrap();
        let gained = world.linear_velocity(swing).unwrap().y - from;
        assert!((gained + 9.81 * DT).abs() < 1e-3, "{gained}");
    }
}

/// A world of everything that may break, wake or be woken.
struct Everything {
    world: World,
    rng: Random,
    bodies: Vec<BodyHandle>,
    shapes: Vec<ShapeHandle>,
    joints: Vec<JointHandle>,
    couplings: Vec<CouplingHandle>,
    characters: Vec<CharacterHandle>,
    ground: ShapeHandle,
}

impl Everything {
    fn new(seed: u64) -> Everything {
        let mut rng = Random(seed);
        let methods =
            [ContinuousMethod::OnePass, ContinuousMethod::LinearCast, ContinuousMethod::Speculative];
        let settings = Settings::default()
            .with_continuous_method(methods[rng.below(3)])
            .with_continuous(MODES[rng.below(3)])
            .with_sleep_time([0.0, 0.1, 0.5][rng.below(3)])
            .with_sleep_speed([0.05, 10.0][rng.below(2)])
            .with_substeps([1, 4][rng.below(2)])
            .with_joint_trees(rng.below(4) != 0)
            .with_warm_starting(rng.below(6) != 0);
        let Pulley { mut world, bodies, ropes, rope } = Pulley::new(settings, HALVES[rng.below(2)]);
        let field = HeightField::new(9, 9, Vec2::splat(1.0), vec![0.0; 81]).unwrap();
        let field = ShapeDesc::new(Geometry::height_field(field)).with_position(Vec3::new(-4.0, 0.0, -4.0));
        let field = world.add_body(&BodyDesc::fixed().with_shape(field)).unwrap();
        let ground = world.shapes(field).unwrap().next().unwrap();
        let (mut bodies, mut joints) = (bodies.to_vec(), ropes.to_vec());
        bodies.push(field);
        for i in 0..4 {
            let at = DVec3::new(2.0, 0.3 + 0.6 * f64::from(i), 2.0);
            let mut desc = block(Vec3::splat(0.3), at);
            (desc.shapes[0].hooks, desc.shapes[0].events) = (i == 1, i == 2);
            bodies.push(world.add_body(&desc).unwrap());
        }
        // A chain from a kinematic body.
        let mut last =
            world.add_body(&BodyDesc::kinematic().with_position(DVec3::new(-2.0, 4.0, 2.0))).unwrap();
        bodies.push(last);
        for i in 0..3 {
            let at = DVec3::new(-2.0, 3.5 - f64::from(i), 2.0);
            let next = world.add_body(&block(Vec3::splat(0.2), at)).unwrap();
            let frames = world.frames_at([last, next], at + DVec3::Y * 0.5, Quat::IDENTITY).unwrap();
            let hinge = JointDesc::hinge([last, next], frames).with_break_force(1e5, 1e5);
            joints.push(world.add_joint(&hinge).unwrap());
            bodies.push(next);
            last = next;
        }
        let gear = CouplingDesc::gear([joints[2], joints[4]], [2.0, 1.0]).with_break_force([1e6, 1e6]);
        let couplings = vec![rope, world.add_coupling(&gear).unwrap()];
        let doll = Skeleton::humanoid();
        let at = DVec3::new(0.0, 0.1, -2.0);
        let doll = doll.add_to(&mut world, at, Quat::IDENTITY, Vec3::ZERO).unwrap();
        bodies.extend(doll.bodies.iter().copied());
        joints.extend(doll.joints.iter().copied());
        let character = Character::new(CharacterSettings::default(), DVec3::new(3.0, 1.0, -3.0)).unwrap();
        let characters = vec![world.add_character(&character).unwrap()];
        let shapes = bodies.iter().flat_map(|&body| world.shapes(body).unwrap()).collect();
        Everything { world, rng, bodies, shapes, joints, couplings, characters, ground }
    }

    fn strengths(&mut self) -> [f32; 2] {
        let some = [0.0, 1.0, 1e3, 1e5, f32::INFINITY];
        [some[self.rng.below(5)], some[self.rng.below(5)]]
    }

    /// One call that may wake something or have it break.
    fn disturb(&mut self) -> Result<(), Error> {
        let strengths = self.strengths();
        let Everything { world, rng, bodies, shapes, joints, couplings, characters, ground } = self;
        let (Some(body), Some(shape), Some(joint), Some(coupling)) =
            (rng.some_of(bodies), rng.some_of(shapes), rng.some_of(joints), rng.some_of(couplings))
        else {
            return Ok(());
        };
        let axis = [Axis::X, Axis::Y, Axis::Z][rng.below(3)];
        let motion = [Motion::Linear, Motion::Angular][rng.below(2)];
        match rng.below(28) {
            0..4 => world.set_coupling_break_force(coupling, strengths),
            4..7 => world.set_joint_break_force(joint, strengths[0], strengths[1]),
            7 => world.set_joint_motor(joint, Motor::velocity(motion, axis, rng.unit() * 40.0, 1e6)),
            8 => {
                world.set_joint_limit(joint, Limit::new(motion, backstop::Axes::One(axis), -rng.unit(), 0.1))
            }
            9 => world.set_coupling_factors(coupling, [1.0, f64::from(rng.unit()) - 0.5]),
            10 => world.set_coupling_range(coupling, Some([-5.0, 9.0])),
            11 => world.remove_joint(joint),
            12 => world.remove_coupling(coupling),
            13 => world.remove_body(body),
            14 => world.remove_shape(shape),
            15 => {
                let kinds = [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic];
                world.set_kind(body, kinds[rng.below(3)])
            }
            16 => world.set_enabled(body, rng.below(2) == 0),
            17 => world.set_geometry(shape, Geometry::cuboid(0.1 + rng.unit(), 0.3, 0.2)),
            18 => world.set_heights(*ground, [3, 3], [2, 2], &[rng.unit() - 0.5; 4]),
            19 => world.set_holes(*ground, [5, 5], [2, 1], &[rng.below(2) == 0; 2]),
            20 => world.set_velocity(body, rng.cube() * 300.0, rng.cube() * 30.0),
            21 => world.move_kinematic(body, (rng.cube() * 3.0).as_dvec3(), rng.rotation(), DT),
            22 => world.set_joint_frames(joint, [Frame::at(rng.cube()), Frame::default()]),
            23 => world.add_force(body, rng.cube() * 1e9),
            24 => world.set_pose(body, (rng.cube() * 3.0 + Vec3::Y).as_dvec3(), rng.rotation()),
            25 => {
                let (wish, character) = (rng.cube() * 5.0, characters[0]);
                world.walk_character(character, &QueryFilter::new(), wish, DT).map(drop)
            }
            _ => world.sleep(body),
        }
    }
}

/// Vetoes some contacts, so that supports vanish within a step.
struct Veto;

impl ContactHooks for Veto {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        if contact.normal().x > -0.1 {
            contact.veto();
        }
    }
}

/// Expected: no step panics (with the check that nothing is rearranged between the prediction and the end of
/// a step, as assertions are on), and all poses are finite.
#[test]
fn nothing_that_breaks_or_wakes_disturbs_a_step() {
    let mut broken = 0;
    for seed in 0..1500 {
        let mut all = Everything::new(seed);
        for step in 0..24 {
            for _ in 0..all.rng.below(3) {
                let _ = all.disturb();
            }
            if all.rng.below(3) == 0 {
                for place in 0..all.bodies.len() {
                    let _ = all.world.sleep(all.bodies[place]);
                }
            }
            for _ in 0..all.rng.below(3) {
                // Refused or not, all sleep when it happens.
                let _ = all.disturb();
            }
            let dt = [DT, DT, 0.001, 0.1][all.rng.below(4)];
            match all.rng.below(2) {
                0 => drop(all.world.step(dt).unwrap()),
                _ => drop(all.world.step_with(dt, &Veto).unwrap()),
            }
            broken += all.world.broken_joints().len() + all.world.broken_couplings().len();
            assert!(common::all_finite(&all.world), "seed {seed}, step {step}");
        }
    }
    assert!(broken > 1000, "{broken} breaks are too few to tell");
}
