//! With any calls in any order a step neither panics nor leaves numbers that are not finite.
//!
//! Seeded sequences of calls over small crowded worlds in which much sleeps, with all kinds of bodies,
//! shapes, joints, sensors, listeners and hooks. The first findings were pairs of sleeping bodies with
//! kinematic ones at rest.

use crate::common::{self, random::Random};
use backstop::glam::Vec3;
use backstop::{
    Axis, BodyDesc, BodyHandle, BodyKind, ContinuousMethod, ContinuousMode, Filter, Frame, FrictionModel,
    Geometry, JointDesc, JointHandle, Limit, Material, Motion, Motor, Settings, ShapeDesc, ShapeHandle,
    Snapshot, World,
};

const DT: f32 = 1.0 / 60.0;

/// A world and the handles that its game holds; some of them are stale.
struct Game {
    world: World,
    rng: Random,
    bodies: Vec<BodyHandle>,
    shapes: Vec<ShapeHandle>,
    joints: Vec<JointHandle>,
    saved: Option<Snapshot>,
}

impl Game {
    fn new(seed: u64) -> Game {
        let mut rng = Random(seed);
        let methods = [
            ContinuousMethod::OnePass,
            ContinuousMethod::OnePass,
            ContinuousMethod::LinearCast,
            ContinuousMethod::Speculative,
            ContinuousMethod::Talk,
        ];
        let settings = Settings::default()
            .with_gravity(if rng.below(3) == 0 { Vec3::ZERO } else { Vec3::Y * -9.81 })
            .with_sleeping(rng.below(8) != 0)
            .with_sleep_time([0.0, 0.03, 0.5][rng.below(3)])
            .with_sleep_speed([0.05, 1.0, 100.0][rng.below(3)])
            .with_continuous_method(methods[rng.below(5)])
            .with_friction_model([FrictionModel::Patch, FrictionModel::Point][rng.below(2)])
            .with_substeps(1 + rng.below(4) as u32)
            .with_recycling(rng.below(5) != 0)
            .with_joint_trees(rng.below(5) != 0);
        let world = World::new(settings).unwrap();
        let mut game = Game { world, rng, bodies: vec![], shapes: vec![], joints: vec![], saved: None };
        if game.rng.below(3) != 0 {
            game.world.add_body(&common::Floor::ALL[game.rng.below(3)].desc(Material::default())).unwrap();
        }
        (0..2 + game.rng.below(6)).for_each(|_| game.add_body());
        game
    }

    fn shape(&mut self) -> ShapeDesc {
        let size = |rng: &mut Random| 0.1 + 0.5 * rng.unit();
        let rng = &mut self.rng;
        let geometry = match rng.below(6) {
            0 => Geometry::Sphere { radius: 2.0 * size(rng) },
            1 => Geometry::capsule(size(rng), size(rng)),
            2 => Geometry::cylinder(size(rng), size(rng)),
            _ => Geometry::cuboid(size(rng), size(rng), size(rng)),
        };
        let mut shape = ShapeDesc::new(geometry);
        shape.material.restitution = [0.0, 0.0, 0.6, 1.0][rng.below(4)];
        shape.position = if rng.below(4) == 0 { rng.cube() * 0.3 } else { Vec3::ZERO };
        shape.events = rng.below(3) == 0;
        shape.hooks = rng.below(4) == 0;
        shape.sensor = rng.below(10) == 0;
        shape
    }

    fn add_body(&mut self) {
        let mut desc = match self.rng.below(6) {
            0 => BodyDesc::kinematic(),
            1 => BodyDesc::fixed(),
            _ => BodyDesc::dynamic(),
        };
        desc = desc.with_position(self.rng.cube() * 1.5 + Vec3::Y).with_rotation(self.rng.rotation());
        if self.rng.below(3) == 0 {
            let fast = [1.0, 30.0, 1000.0][self.rng.below(3)];
            desc = desc.with_velocity(self.rng.cube() * fast, self.rng.cube() * 10.0);
        }
        desc.lock_rotation[0] = self.rng.below(10) == 0;
        desc.can_sleep = self.rng.below(10) != 0;
        for _ in 0..1 + self.rng.below(2) {
            desc = desc.with_shape(self.shape());
        }
        if let Ok(body) = self.world.add_body(&desc) {
            self.bodies.push(body);
            self.shapes.extend(self.world.shapes(body).unwrap());
        }
    }

    fn add_joint(&mut self) {
        let (Some(a), Some(b)) = (self.rng.some_of(&self.bodies), self.rng.some_of(&self.bodies)) else {
            return;
        };
        let frames = [Frame::at(self.rng.cube() * 0.3), Frame::at(self.rng.cube() * 0.3)];
        let limit = Limit::new(Motion::Linear, backstop::Axes::All, 0.0, 0.5);
        let desc = match self.rng.below(6) {
            0 => JointDesc::ball([a, b], frames),
            1 => JointDesc::hinge([a, b], frames).with_motor(Motor::velocity(
                Motion::Angular,
                Axis::X,
                3.0,
                10.0,
            )),
            2 => JointDesc::slider([a, b], frames).with_limit(limit),
            3 => JointDesc::distance([a, b], frames, 0.1, 2.0).with_break_force(1e4, 1e4),
            4 => JointDesc::ball([a, b], frames).with_collide(true),
            _ => JointDesc::fixed([a, b], frames),
        };
        self.joints.extend(self.world.add_joint(&desc));
    }

    /// A call on a body, which may be refused.
    fn call_on(&mut self, body: BodyHandle) -> Result<(), backstop::Error> {
        let (world, rng) = (&mut self.world, &mut self.rng);
        match rng.below(20) {
            0 => world.remove_body(body),
            1..4 => world.sleep(body),
            4 => world.wake(body),
            5 => world.set_pose(body, (rng.cube() * 1.5 + Vec3::Y).as_dvec3(), rng.rotation()),
            6 => {
                let fast = [0.0, 0.04, 5.0, 1000.0][rng.below(4)];
                world.set_velocity(body, rng.cube() * fast, rng.cube() * fast)
            }
            7 => world.set_velocity(body, Vec3::ZERO, Vec3::ZERO),
            8 => world.set_enabled(body, rng.below(2) == 0),
            9 => world.apply_impulse_at(body, rng.cube() * 1000.0, rng.cube().as_dvec3()),
            10 => {
                // Most are honest.
                let much = [1e4, 1e4, 1e4, 1e12, 9e17][rng.below(5)];
                world.add_force_and_torque(body, rng.cube() * much, rng.cube() * much)
            }
            11 => world.set_can_sleep(body, rng.below(2) == 0),
            12 => {
                let modes = [ContinuousMode::Discrete, ContinuousMode::Segment, ContinuousMode::Volume];
                world.set_continuous(body, modes[rng.below(3)])
            }
            13 | 14 => {
                let kinds = [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic];
                world.set_kind(body, kinds[rng.below(3)])
            }
            15 => {
                let (linear, angular) = ([0.0, 0.5, 1e6][rng.below(3)], [0.0, 0.5, 1e6][rng.below(3)]);
                let cap = |x: f32| Some(x).filter(|x| *x == 0.5);
                world
                    .set_damping(body, linear, angular)
                    .and_then(|()| world.set_max_speeds(body, cap(linear), cap(angular)))
            }
            16 => {
                let mut any = || [rng.below(3) == 0, rng.below(3) == 0, rng.below(3) == 0];
                let (translation, rotation) = (any(), any());
                world.set_locked_axes(body, translation, rotation)
            }
            17 => world.apply_angular_impulse(body, rng.cube() * 1000.0),
            _ => {
                let to = (rng.cube() + Vec3::Y).as_dvec3();
                world.move_kinematic(body, to, rng.rotation(), DT)
            }
        }
    }

    fn call_on_shape(&mut self, shape: ShapeHandle) -> Result<(), backstop::Error> {
        let (world, rng) = (&mut self.world, &mut self.rng);
        match rng.below(9) {
            5 | 6 => world.set_geometry(shape, Geometry::cuboid(0.1 + rng.unit(), 0.2, 0.1 + rng.unit())),
            7 => world.set_shape_pose(shape, rng.cube() * 0.3, rng.rotation()),
            8 => world.set_density(shape, 2000.0 * rng.unit()),
            0 => world.remove_shape(shape),
            1 => world.set_material(shape, Material::default().with_restitution(rng.unit())),
            2 => world.set_filter(shape, Filter::default().with_group(rng.below(3) as i32 - 1)),
            3 => world
                .set_events(shape, rng.below(2) == 0)
                .and_then(|()| world.set_hooks(shape, rng.below(2) == 0)),
            _ => world.set_sensor(shape, rng.below(4) == 0),
        }
    }

    fn call(&mut self) {
        match self.rng.below(24) {
            0 if self.bodies.len() < 30 => self.add_body(),
            1 => self.add_joint(),
            2 => {
                if let Some(joint) = self.rng.some_of(&self.joints) {
                    let _ = self.world.remove_joint(joint);
                }
            }
            3 | 4 => {
                if let Some(shape) = self.rng.some_of(&self.shapes) {
                    let _ = self.call_on_shape(shape);
                }
            }
            5 => {
                let desc = self.shape();
                if let Some(body) = self.rng.some_of(&self.bodies) {
                    self.shapes.extend(self.world.add_shape(body, &desc));
                }
            }
            6 => {
                let sleeping = self.rng.below(4) != 0;
                let gravity = self.world.settings().gravity * [1.0, 1.0, 0.0][self.rng.below(3)];
                let settings = self.world.settings().clone().with_sleeping(sleeping).with_gravity(gravity);
                self.world.set_settings(settings).unwrap();
            }
            7 => {
                let saved = self.saved.get_or_insert_default();
                self.world.snapshot(saved);
            }
            8 => {
                if let Some(saved) = &self.saved {
                    self.world.restore(saved).unwrap();
                }
            }
            9 => {
                // By bytes, whose every number is checked.
                let mut now = Snapshot::new();
                self.world.snapshot(&mut now);
                let bytes = if self.rng.below(2) == 0 { now.to_bytes() } else { now.to_whole_bytes() };
                self.world.restore(&Snapshot::from_bytes(&bytes).unwrap()).unwrap();
            }
            _ => {
                if let Some(body) = self.rng.some_of(&self.bodies) {
                    let _ = self.call_on(body);
                }
            }
        }
    }

    fn play(&mut self, frames: usize) {
        for frame in 0..frames {
            (0..self.rng.below(4)).for_each(|_| self.call());
            let dt = [DT, DT, DT, 0.001, 0.1][self.rng.below(5)];
            self.world.step(dt).unwrap();
            assert!(common::all_finite(&self.world), "frame {frame}");
        }
    }
}

fn play_all(seeds: std::ops::Range<u64>, frames: usize) {
    let mut wrong = Vec::new();
    for seed in seeds {
        let play = || Game::new(seed).play(frames);
        if std::panic::catch_unwind(play).is_err() {
            wrong.push(seed);
        }
    }
    assert!(wrong.is_empty(), "{} seeds: {wrong:?}", wrong.len());
}

#[test]
fn any_sequence_of_calls_can_be_stepped_on() {
    play_all(0..2000, 24);
}

/// As many more as one has time for: `CALLS=100000 cargo test --release --test world -- calls:: --ignored`.
#[test]
#[ignore = "runs as long as it is told to"]
fn many_sequences_of_calls_can_be_stepped_on() {
    let count = std::env::var("CALLS").map_or(20_000, |count| count.parse().unwrap());
    play_all(10_000..10_000 + count, 40);
}
