//! A game that makes random calls.

use super::*;

/// A world and the state of a game about it, which is rolled back too.
#[derive(Default)]
pub(super) struct Game {
    pub(super) world: World,
    pub(super) bodies: Vec<BodyHandle>,
    pub(super) joints: Vec<JointHandle>,
}

impl Game {
    pub(super) fn new(sleeping: bool, threads: usize) -> Game {
        let settings = Settings::default().with_sleeping(sleeping).with_threads(threads).with_sleep_time(0.2);
        let mut game = Game { world: World::new(settings).unwrap(), ..Game::default() };
        game.world.add_body(&common::Floor::Mesh.desc(Material::default())).unwrap();
        let wall = ShapeDesc::new(Geometry::cuboid(0.2, 1.0, 4.0));
        game.bodies.push(
            game.world.add_body(&BodyDesc::fixed().with_position(Vec3::X * 4.0).with_shape(wall)).unwrap(),
        );
        let mut rng = Random(7);
        for _ in 0..40 {
            game.add(&mut rng);
        }
        game
    }

    pub(super) fn geometry(rng: &mut Random) -> Geometry {
        match rng.below(5) {
            0 => Geometry::Sphere { radius: 0.2 + 0.2 * rng.unit() },
            1 => Geometry::capsule(0.2, 0.15 + 0.1 * rng.unit()),
            2 => Geometry::cylinder(0.2, 0.2),
            _ => Geometry::cuboid(0.2, 0.15 + 0.1 * rng.unit(), 0.25),
        }
    }

    pub(super) fn add(&mut self, rng: &mut Random) {
        let mut shape = ShapeDesc::new(Game::geometry(rng));
        shape.material.restitution = if rng.below(4) == 0 { 0.6 } else { 0.0 };
        let at = rng.cube() * 3.0 + Vec3::Y * 4.0;
        let desc = match rng.below(12) {
            0 => BodyDesc::kinematic()
                .with_position(at)
                .with_shape(shape)
                .with_velocity(rng.cube(), rng.cube()),
            1 => BodyDesc::fixed().with_position(at - Vec3::Y * 3.5).with_shape(shape),
            2 => BodyDesc::dynamic()
                .with_position(at)
                .with_shape(shape)
                .with_velocity(rng.cube() * 300.0, rng.cube() * 20.0),
            3 => {
                let mut second = ShapeDesc::new(Game::geometry(rng));
                second.position = rng.cube() * 0.3;
                BodyDesc::dynamic().with_position(at).with_shape(shape).with_shape(second)
            }
            _ => BodyDesc::dynamic().with_position(at).with_shape(shape),
        };
        self.bodies.push(self.world.add_body(&desc).unwrap());
    }

    pub(super) fn some(&self, rng: &mut Random) -> BodyHandle {
        self.bodies[rng.below(self.bodies.len())]
    }

    /// Any call that a game may make. Refused calls must be refused again.
    pub(super) fn call(&mut self, rng: &mut Random) {
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
                    1 => JointDesc::hinge([body, other], frames).with_break_force(3000.0, 3000.0),
                    2 => JointDesc::distance([body, other], frames, 0.1, 1.0),
                    _ => JointDesc::slider([body, other], frames).with_collide(true),
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
                let drive = Motor::friction(Motion::Angular, backstop::Axis::X, 0.5);
                let _ = world.set_joint_limits(joint, &[limit]);
                let _ = world.set_joint_motor(joint, drive);
                let _ = world.set_joint_target(joint, drive.motion, drive.axis, 0.0, rng.unit());
                let _ = world.set_joint_thresholds(joint, rng.unit() * 1000.0, f32::INFINITY);
            }
            what => Game::change(world, body, what, rng),
        }
        let world = &self.world;
        self.joints.retain(|&joint| world.contains_joint(joint));
    }

    /// Changes one thing about a body, or about the world.
    fn change(world: &mut World, body: BodyHandle, what: usize, rng: &mut Random) {
        match what {
            8 => {
                // A body that joints have thrown beyond all speeds takes none.
                let _ = world.apply_impulse_at(body, rng.cube() * 100.0, DVec3::Y);
            }
            9 => world.add_force_and_torque(body, rng.cube() * 500.0, rng.cube()).unwrap(),
            10 => world.set_velocity(body, rng.cube() * 5.0, rng.cube()).unwrap(),
            11 => {
                let at = (rng.cube() * 3.0 + Vec3::Y * 2.0).as_dvec3();
                world.set_pose(body, at, Quat::IDENTITY).unwrap();
            }
            12 => world.wake(body).unwrap(),
            13 => world.sleep(body).unwrap(),
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
                    world.set_filter(shape, Filter::default().with_group(group)).unwrap();
                }
            }
            18 => world.set_gravity_scale(body, rng.unit()).unwrap(),
            19 => {
                let modes = [ContinuousMode::Discrete, ContinuousMode::Segment, ContinuousMode::Volume];
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
                    .set_settings(
                        settings
                            .with_substeps(substeps)
                            .with_length_unit(length_unit)
                            .with_sleeping(sleeping)
                            .with_gravity(gravity),
                    )
                    .unwrap();
            }
            22 => world.set_body_solved_after(body, None).unwrap(),
            _ => world.set_origin(rng.cube().as_dvec3()).unwrap(),
        }
    }

    pub(super) fn frame(&mut self, rng: &mut Random) -> u64 {
        for _ in 0..rng.below(4) {
            self.call(rng);
        }
        self.world.step(DT).unwrap();
        let world = &self.world;
        self.joints.retain(|&joint| world.contains_joint(joint));
        self.world.state_hash()
    }
}
