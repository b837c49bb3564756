//! All that a caller can do, at random, plays again.

use super::*;

/// All that a caller can do, at random.
struct Churn {
    random: Random,
    world: World,
    bodies: Vec<BodyHandle>,
    shapes: Vec<ShapeHandle>,
    joints: Vec<JointHandle>,
    shared: Vec<Geometry>,
    hooks: Moody,
    saved: Option<Snapshot>,
}

fn hull(points: usize, random: &mut Random) -> Arc<ConvexHull> {
    let points: Vec<Vec3> = (0..points).map(|_| random.cube() * 0.4).collect();
    Arc::new(ConvexHull::new(&points).unwrap())
}

impl Churn {
    fn new(settings: Settings, seed: u64) -> (Churn, RecordingBuffer) {
        let (world, buffer) = recorded(settings);
        let mut random = Random(seed);
        let (vertices, triangles) = Terrain::bumpy(16, 1.0).mesh();
        let mesh = Arc::new(TriangleMesh::new(vertices, triangles).unwrap());
        let heights = (0..81).map(|_| random.unit()).collect();
        let field = Arc::new(HeightField::new(9, 9, Vec2::splat(1.5), heights).unwrap());
        let (one, other) = (hull(20, &mut random), hull(9, &mut random));
        // The third has the content of the first and memory of its own.
        let again = Arc::new((*one).clone());
        let shared = vec![
            Geometry::Mesh(mesh),
            Geometry::HeightField(field),
            Geometry::Hull(one),
            Geometry::Hull(other),
            Geometry::Hull(again),
        ];
        let (bodies, shapes, joints) = Default::default();
        (
            Churn { random, world, bodies, shapes, joints, shared, hooks: Moody::default(), saved: None },
            buffer,
        )
    }

    fn geometry(&mut self, convex: bool) -> Geometry {
        let r = &mut self.random;
        match r.below(if convex { 7 } else { 10 }) {
            0 => Geometry::Sphere { radius: 0.2 + 0.3 * r.unit() },
            1 => Geometry::capsule(0.3, 0.2),
            2 => Geometry::Capsule { half_height: 0.4, radius_bottom: 0.3, radius_top: 0.1 },
            3 => Geometry::cuboid(0.2 + 0.3 * r.unit(), 0.3, 0.25),
            4 => Geometry::Cylinder { half_height: 0.3, radius_bottom: 0.3, radius_top: 0.2 },
            5 | 6 => self.shared[2 + r.below(3)].clone(),
            7 => Geometry::Plane,
            n => self.shared[n - 8].clone(),
        }
    }

    fn shape(&mut self, convex: bool) -> ShapeDesc {
        let mut shape = ShapeDesc::new(self.geometry(convex));
        let r = &mut self.random;
        shape.position = r.cube() * 0.1;
        shape.rotation = if convex { r.rotation() } else { Quat::IDENTITY };
        shape.material.restitution = if r.below(4) == 0 { 0.5 } else { 0.0 };
        shape.sensor = convex && r.below(8) == 0;
        (shape.events, shape.hooks, shape.user_data) = (r.below(3) == 0, r.below(3) == 0, r.bits());
        shape.material.rolling_friction = if shape.user_data & 3 == 0 { 0.02 } else { 0.0 };
        shape.material.surface_velocity = if shape.user_data & 28 == 0 { Vec3::X } else { Vec3::ZERO };
        shape.material.contact_hertz = if shape.user_data & 96 == 0 { 8.0 } else { 0.0 };
        shape.material.contact_damping = if shape.user_data & 32 == 0 { 0.5 } else { 1.0 };
        shape
    }

    fn body(&mut self) -> BodyDesc {
        let kind = match self.random.below(8) {
            0 => BodyKind::Static,
            1 => BodyKind::Kinematic,
            _ => BodyKind::Dynamic,
        };
        let shapes = (0..1 + self.random.below(2)).map(|_| self.shape(kind != BodyKind::Static)).collect();
        let r = &mut self.random;
        let mut desc = BodyDesc::new(kind)
            .with_position((r.cube() * 4.0 + Vec3::Y * 5.0).as_dvec3())
            .with_rotation(if kind == BodyKind::Static { Quat::IDENTITY } else { r.rotation() })
            .with_velocity(r.cube() * 10.0, r.cube() * 5.0);
        (desc.shapes, desc.user_data, desc.can_sleep) = (shapes, r.bits(), r.below(10) > 0);
        if r.below(6) == 0 {
            desc.lock_rotation = [r.chance(0.5), r.chance(0.5), r.chance(0.5)];
        }
        if kind == BodyKind::Static {
            desc.position.y -= 6.0;
        }
        desc
    }

    /// Shapes of new bodies, and bodies that are gone.
    fn look_up(&mut self) {
        // Also those that a restored snapshot brought back.
        self.bodies = self.world.bodies().collect();
        self.joints.retain(|&joint| self.world.contains_joint(joint));
        self.shapes = self.bodies.iter().flat_map(|&b| self.world.shapes(b).unwrap()).collect();
    }

    fn settings(&mut self) -> Settings {
        let r = &mut self.random;
        let order = if r.chance(0.5) { Order::default() } else { Order::default().reversed() };
        self.world
            .settings()
            .clone()
            .with_substeps(1 + r.below(5) as u32)
            .with_iterations(1 + r.below(3) as u32)
            .with_warm_starting(r.below(4) > 0)
            .with_recycling(r.below(4) > 0)
            .with_sleeping(r.below(8) > 0)
            .with_gravity(Vec3::NEG_Y * (9.0 + r.unit()))
            .with_continuous(r.of(&[
                ContinuousMode::Segment,
                ContinuousMode::Segment,
                ContinuousMode::Volume,
            ]))
            .with_order(order)
            .with_joint_trees(r.below(4) > 0)
            .with_guard(r.below(4) > 0)
    }

    fn joint(&mut self) -> JointDesc {
        let pair = [self.random.of(&self.bodies), self.random.of(&self.bodies)];
        let r = &mut self.random;
        let frames = [Frame::at(r.cube() * 0.3), Frame::at(r.cube() * 0.3)];
        let joint = match r.below(4) {
            0 => JointDesc::ball(pair, frames),
            1 => JointDesc::hinge(pair, frames).with_motor(Motor::velocity(
                Motion::Angular,
                Axis::X,
                r.unit() * 3.0,
                20.0,
            )),
            2 => JointDesc::distance(pair, frames, 0.0, 3.0),
            _ => JointDesc::fixed(pair, frames),
        };
        joint.with_break_force(if r.chance(0.5) { 2000.0 } else { f32::INFINITY }, f32::INFINITY)
    }

    /// One call, refused or not.
    fn call(&mut self) {
        if self.bodies.len() < 20 {
            let desc = self.body();
            self.bodies.extend(self.world.add_body(&desc));
            return self.look_up();
        }
        let (body, what) = (self.random.of(&self.bodies), self.random.below(47));
        let shape = self.shapes.get(self.random.below(self.shapes.len())).copied();
        let Some(shape) = shape else { return };
        let joint = self.joints.get(self.random.below(self.joints.len().max(1))).copied();
        let above = self.random.of(&[None, Some(RowGroup::Contacts), Some(RowGroup::StaticContacts)]);
        let (v, w, q) = (self.random.cube(), self.random.cube(), self.random.rotation());
        let (yes, also) = (self.random.chance(0.5), self.random.chance(0.5));
        let world = &mut self.world;
        // Errors are for calls that make no sense, and are not in the recording.
        let _ = match what {
            0 if self.bodies.len() < 90 => {
                let descs = [self.body(), self.body()];
                self.world.add_bodies(&descs).map(|new| self.bodies.extend(new))
            }
            1 => world.remove_body(body),
            2 => {
                let desc = self.shape(true);
                self.world.add_shape(body, &desc).map(drop)
            }
            3 => world.remove_shape(shape),
            4 => world.set_material(shape, Material::default().with_friction(v.x.abs())),
            5 => world.set_filter(shape, Filter::default().with_category(1 + u64::from(yes))),
            6 => world.set_events(shape, yes).and_then(|()| world.set_hooks(shape, also)),
            7 => world.set_sensor(shape, yes && also),
            8 => world.set_pose(body, (v * 4.0 + Vec3::Y * 4.0).as_dvec3(), q),
            9 => world.set_velocity(body, v * 20.0, w * 10.0),
            10 if yes => world.move_kinematic_and_stop(body, (v * 3.0).as_dvec3(), q, DT),
            10 => world.move_kinematic(body, (v * 3.0).as_dvec3(), q, DT),
            11..=13 => world.add_force_and_torque(body, v * 1e4, w * 100.0),
            14 => world.apply_impulse_at(body, v * 500.0, (w * 3.0).as_dvec3()),
            15 => world.set_gravity_scale(body, v.x),
            16 => world
                .set_continuous(body, if yes { ContinuousMode::Volume } else { ContinuousMode::Discrete }),
            17 => world.set_body_solved_after(body, above),
            18 => {
                let mass =
                    MassProperties { mass: 50.0, centre_of_mass: v * 0.1, inertia: Mat3::IDENTITY * 5.0 };
                world.set_mass(body, mass)
            }
            19 => {
                let desc = self.joint();
                self.world.add_joint(&desc).map(|joint| self.joints.push(joint))
            }
            20 => {
                let descs = [self.joint(), self.joint()];
                self.world.add_joints(&descs).map(|joints| self.joints.extend(joints))
            }
            21 => joint.map_or(Ok(()), |joint| world.remove_joint(joint)),
            22 => joint.map_or(Ok(()), |joint| {
                let limit = Limit::new(Motion::Linear, Axes::All, 0.0, 1.0 + v.x.abs());
                let drive = Motor::velocity(Motion::Angular, Axis::X, w.x, 20.0);
                change_joint(world, joint, (limit, drive), self.random.below(12))
            }),
            23 => joint.map_or(Ok(()), |joint| world.set_joint_solved_after(joint, above)),
            24 => world.wake(body),
            25 => world.sleep(body),
            26 => world.set_can_sleep(body, yes),
            30 => world.set_enabled(body, yes || also),
            27 => world.set_origin((v * 1000.0).as_dvec3()),
            28 => {
                let settings = self.settings();
                self.world.set_settings(settings)
            }
            31.. => return self.call_on([v, w], [yes, also], q, body, shape, what),
            _ => {
                world.name_recorded(body, "one of many");
                let ray = Ray::new(DVec3::new(0.0, 9.0, 0.0), Vec3::NEG_Y * 20.0);
                let _ = world.cast_ray(&ray, &QueryFilter::default());
                Ok(())
            }
        };
        self.look_up();
    }

    /// A call on a body or a shape of it that changes what its description said.
    fn call_on(
        &mut self,
        [v, w]: [Vec3; 2],
        [yes, also]: [bool; 2],
        q: Quat,
        body: BodyHandle,
        shape: ShapeHandle,
        what: usize,
    ) {
        let world = &mut self.world;
        let _ = match what {
            31 => {
                let kinds = [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic, BodyKind::Dynamic];
                world.set_kind(body, kinds[usize::from(yes) + 2 * usize::from(also)])
            }
            32 => world.set_user_data(body, v.x.to_bits().into()),
            33 => {
                let caps = [yes.then_some(20.0 * v.y.abs()), also.then_some(20.0 * w.y.abs())];
                world
                    .set_damping(body, if yes { v.x.abs() } else { 0.0 }, w.x.abs())
                    .and_then(|()| world.set_max_speeds(body, caps[0], caps[1]))
            }
            34 => world.set_locked_axes(body, [false, yes && also, false], [yes, false, also]),
            35 => world.set_linear_velocity(body, v * 10.0),
            36 => world.set_angular_velocity(body, w * 10.0),
            37 => world.apply_angular_impulse(body, w * 20.0),
            38 => world.set_shape_user_data(shape, w.x.to_bits().into()),
            39 => {
                let geometry = self.geometry(yes || also);
                self.world.set_geometry(shape, geometry)
            }
            40 => world.set_shape_pose(shape, v * 0.1, q),
            41 => world.set_density(shape, if yes && also { 0.0 } else { 1000.0 * (1.0 + v.x) }),
            43 => world.set_senses_static(shape, yes),
            44 | 45 => {
                let is_field = |shape: &&ShapeHandle| {
                    matches!(world.geometry(**shape).unwrap(), Geometry::HeightField(_))
                };
                let Some(&field) = self.shapes.iter().find(is_field) else { return };
                let first = [4.0 + 4.0 * v.x, 4.0 + 4.0 * w.x].map(|x| x as usize);
                if what == 44 {
                    world.set_heights(field, first, [2, 1], &[v.y, w.y])
                } else {
                    world.set_holes(field, first, [1, 2], &[yes, also])
                }
            }
            46 => self.saved.as_ref().map_or(Ok(()), |saved| world.restore(saved)),
            _ => world.add_force_at(body, v * 1e4, w.as_dvec3()),
        };
        self.look_up();
    }

    /// A call on a character, or one more of them.
    fn call_on_character(&mut self) {
        let at = (self.random.cube() * 4.0 + Vec3::Y * 4.0).as_dvec3();
        let mut made = Character::new(CharacterSettings::default(), at).unwrap();
        if self.random.chance(0.5) {
            made.set_shape(Some(self.geometry(true))).unwrap();
        }
        let there: Vec<_> = self.world.characters().collect();
        let (what, velocity) = (self.random.below(12), self.random.cube() * 5.0 - Vec3::Y);
        let world = &mut self.world;
        let Some(&character) = there.get(what % there.len().max(1)).filter(|_| what > 0) else {
            world.add_character(&made).unwrap();
            return;
        };
        match what {
            1 => world.remove_character(character).unwrap(),
            2 => world.set_character(character, &made).unwrap(),
            _ => drop(world.walk_character(character, &QueryFilter::new(), velocity, DT).unwrap()),
        }
    }

    fn step(&mut self) {
        let dt = self.random.of(&[DT, DT, DT, 1.0 / 120.0, 1.0 / 30.0]);
        self.world.step_with(dt, &self.hooks).unwrap();
        self.look_up();
        if self.random.below(10) == 0 {
            self.world.snapshot(self.saved.get_or_insert_default());
        }
    }

    /// The bodies stay where numbers make sense.
    fn run(&mut self, steps: u32, calls_a_step: usize) {
        Skeleton::humanoid().add_to(&mut self.world, DVec3::Y * 4.0, Quat::IDENTITY, Vec3::X).unwrap();
        self.bodies = self.world.bodies().collect();
        self.look_up();
        for step in 0..steps {
            // Now and then nothing is called for long enough to fall asleep.
            if step % 200 < 120 {
                (0..calls_a_step).for_each(|_| self.call());
                self.call_on_character();
            }
            self.step();
            let far = |body: &BodyHandle| {
                let at = self.world.position(*body).unwrap();
                (at.length() < 60.0).then_some(()).is_none()
            };
            let gone: Vec<BodyHandle> = self.bodies.iter().copied().filter(far).collect();
            gone.into_iter().for_each(|body| self.world.remove_body(body).unwrap());
            self.look_up();
        }
    }
}

/// One of the changes of a joint.
fn change_joint(
    world: &mut World,
    joint: JointHandle,
    (limit, drive): (Limit, Motor),
    what: usize,
) -> Result<(), Error> {
    let v = drive.velocity;
    match what {
        0 => world.set_joint_motor(joint, drive),
        1 => world.remove_joint_motor(joint, drive.motion, drive.axis).map(drop),
        2 => {
            world.set_joint_motor(joint, drive)?;
            world.set_joint_target(joint, drive.motion, drive.axis, 0.5, v)
        }
        3 => world.set_joint_limit(joint, limit),
        4 => world.remove_joint_limit(joint, limit.motion, limit.axes).map(drop),
        5 => world.set_joint_limits(joint, &[limit]),
        6 => world.set_joint_motors(joint, &[drive, drive]),
        7 => world.set_joint_frames(joint, [Frame::at(Vec3::X * v), Frame::at(Vec3::Y * v)]),
        8 => world.set_joint_collide(joint, v > 0.0),
        9 => world.set_joint_break_force(joint, 1000.0, 1e4),
        10 => world.set_joint_thresholds(joint, 100.0, 10.0),
        _ => world.set_joint_user_data(joint, 7),
    }
}

/// Names of calls that are in any recording of a churn.
const CALLS: [&str; 69] = [
    "add_bodies",
    "add_body",
    "add_character",
    "remove_character",
    "set_character",
    "walk_character",
    "add_force_and_torque",
    "add_joint",
    "add_joints",
    "add_shape",
    "again",
    "apply_angular_impulse",
    "apply_impulse_at",
    "height_field",
    "hull",
    "mesh",
    "move_kinematic",
    "move_kinematic_and_stop",
    "name_recorded",
    "part",
    "restore",
    "set_body_solved_after",
    "set_joint_solved_after",
    "remove_body",
    "remove_joint",
    "remove_shape",
    "sleep",
    "set_angular_velocity",
    "set_can_sleep",
    "set_continuous",
    "set_damping",
    "set_density",
    "set_enabled",
    "set_filter",
    "set_geometry",
    "set_gravity_scale",
    "set_heights",
    "set_holes",
    "set_joint_motor",
    "remove_joint_motor",
    "set_joint_target",
    "set_joint_limit",
    "remove_joint_limit",
    "set_joint_limits",
    "set_joint_motors",
    "set_joint_frames",
    "set_joint_collide",
    "set_joint_break_force",
    "set_joint_thresholds",
    "set_joint_user_data",
    "set_kind",
    "set_linear_velocity",
    "set_listening",
    "set_locked_axes",
    "set_mass",
    "set_material",
    "set_max_speeds",
    "set_origin",
    "set_pose",
    "set_senses_static",
    "set_sensor",
    "set_settings",
    "set_shape_pose",
    "set_shape_user_data",
    "set_user_data",
    "set_velocity",
    "step",
    "wake",
    "asked",
];

#[test]
fn thousands_of_calls_at_random_play_again() {
    // The drawn calls depend on the world, so no single run need have all of them.
    let mut drawn = BTreeSet::new();
    for seed in 1..=3 {
        let settings = Settings::default().with_sleeping(true);
        let (mut churn, buffer) = Churn::new(settings, seed);
        churn.run(600, 8);
        let hash = churn.world.state_hash();
        let recorded = churn.world.stop_recording().unwrap();
        println!(
            "churn {seed}: {} calls in {} steps, {} bytes a step",
            recorded.calls,
            recorded.steps,
            recorded.bytes / recorded.steps
        );
        assert!(recorded.calls > 3000);
        let played = plays_again(&buffer.bytes(), hash);
        drawn.extend(played.calls.keys().copied());
    }
    assert_eq!(drawn, CALLS.into_iter().filter(|&name| name != "asked").collect());
}

/// A budget counts all that the world holds: bytes that depend on queries, and on worlds that share geometry,
/// have to be the same too.
#[test]
fn a_run_within_a_budget_plays_again() {
    // As above: the calls depend on the world.
    let mut drawn = BTreeSet::new();
    for seed in [6, 7] {
        let settings = Settings::default().with_sleeping(true).with_budget(Budget::total(1_400_000));
        let (mut churn, buffer) = Churn::new(settings, seed);
        churn.run(1200, 6);
        let (hash, memory) = (churn.world.state_hash(), churn.world.memory().total());
        churn.world.stop_recording().unwrap();
        let played = plays_again(&buffer.bytes(), hash);
        drawn.extend(played.calls.keys().copied());
        let bytes = buffer.bytes();
        let mut replay = Replay::open(&bytes[..]).unwrap();
        replay.run().unwrap();
        assert_eq!(replay.world().memory().total(), memory);
    }
    assert_eq!(drawn, CALLS.into_iter().collect());
}

/// Every public method that changes a world is recorded, or stands here with the reason why it is not.
#[test]
fn no_method_is_forgotten() {
    const OTHERS: [(&str, &str); 21] = [
        ("remove_bodies", "calls remove_body"),
        ("restore", "has restore_recorded note it, once the snapshot was taken"),
        ("move_kinematic", "has aim note it"),
        ("move_kinematic_and_stop", "has aim note it"),
        ("add_force_at", "calls add_force_and_torque"),
        ("add_force_and_torque", "notes Change::AddForce, the name that recordings had"),
        ("add_force", "calls add_force_and_torque"),
        ("add_torque", "calls add_force_and_torque"),
        ("apply_impulse", "calls apply_impulse_at"),
        ("apply_impulse_at", "notes Change::ApplyImpulse, the name that recordings had"),
        ("apply_explosion", "calls apply_impulse and apply_angular_impulse"),
        ("set_events", "calls set_listening"),
        ("set_hooks", "calls set_listening"),
        ("step", "calls step_with"),
        ("step_with", "step_taped writes it"),
        ("start_recording", "is not of the run"),
        ("stop_recording", "is not of the run"),
        ("name_recorded", "is recorded in replay/tape.rs, by the path of the macro"),
        ("allow", "changes nothing"),
        ("observe", "is for measuring, and a recording has no word for it"),
        ("observer_mut", "is for measuring, too"),
    ];
    let mut found = BTreeSet::new();
    let mut folders = vec![std::path::PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../src")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            // The text between `impl World {` and the `}` at the start of a line.
            for block in text.split("\nimpl World {").skip(1) {
                let block = &block[..block.find("\n}").unwrap()];
                for method in block.split("\n    pub fn ").skip(1) {
                    let (head, body) = method.split_once('{').unwrap();
                    let name = head.split(['(', '<']).next().unwrap();
                    if !head.contains("&mut self") {
                        continue;
                    }
                    found.insert(name.to_owned());
                    let body = &body[..body.find("\n    }").unwrap()];
                    let camel = |name: &str| -> String {
                        let part = |p: &str| p[..1].to_uppercase() + &p[1..];
                        name.split('_').map(part).collect()
                    };
                    // The name of a body in a recording is no change: that call writes itself.
                    let is_recorded = ["Change::", "Call::"]
                        .iter()
                        .any(|note| body.contains(&format!("{note}{}(", camel(name))));
                    assert!(
                        is_recorded || OTHERS.iter().any(|other| other.0 == name),
                        "World::{name} in {} is not recorded: docs/replay.md says how",
                        path.display()
                    );
                }
            }
        }
    }
    // The parser finds the methods. What `set_events` and `set_hooks` share is not public.
    const NO_METHODS: [&str; 8] =
        ["again", "height_field", "hull", "mesh", "part", "asked", "step", "set_listening"];
    for name in CALLS.into_iter().filter(|name| !NO_METHODS.contains(name)) {
        assert!(found.contains(name), "{name}");
    }
    assert!(found.len() >= CALLS.len() - 6 + 4, "{found:?}");
}
