//! A setter changes nothing if the value is already set, and a call that makes no sense for a kind of body
//! has no effect.

use crate::common::{self, Floor};
use backstop::glam::{DVec3, Mat3, Quat, Vec2, Vec3};
use backstop::{
    Axis, BodyDesc, BodyHandle, BodyKind, CouplingDesc, CouplingHandle, Error, Geometry, HeightField,
    JointDesc, JointHandle, Limit, MassProperties, Material, Motion, Motor, Settings, ShapeHandle, Snapshot,
    World,
};

const DT: f32 = 1.0 / 60.0;

/// A world with a heap, a swing with a motor, gears and a field; at most some of it asleep.
struct Content {
    world: World,
    bodies: Vec<BodyHandle>,
    shapes: Vec<ShapeHandle>,
    hinges: [JointHandle; 2],
    gear: CouplingHandle,
    field: ShapeHandle,
}

impl Content {
    fn new(steps: u32) -> Content {
        let mut world = World::new(Settings::default().with_sleeping(true)).unwrap();
        world.add_body(&Floor::Box.desc(Material::default())).unwrap();
        for i in 0..6 {
            let at = Vec3::new(0.03 * i as f32, 0.26 + 0.5 * i as f32, 0.0);
            let mut desc = common::dynamic(Geometry::cuboid(0.3, 0.25, 0.2), Material::default(), at);
            // Centre of mass and principal axes are not those of the body.
            desc.shapes[0].position = Vec3::new(0.05, 0.0, 0.02);
            desc.shapes[0].rotation = Quat::from_rotation_y(0.4);
            desc.rotation = Quat::from_rotation_y(0.2 * i as f32);
            world.add_body(&desc).unwrap();
        }
        let post = world.add_body(&BodyDesc::fixed().with_position(DVec3::X * 4.0)).unwrap();
        let hinges = [2.0, 3.0].map(|y| {
            let wheel = Geometry::cuboid(0.2, 0.3, 0.1);
            let wheel = common::dynamic(wheel, Material::default(), Vec3::new(4.0, y, 0.0));
            let wheel = world.add_body(&wheel).unwrap();
            let at = DVec3::new(4.0, f64::from(y) + 0.1, 0.0);
            let frames = world.frames_at([post, wheel], at, Quat::from_rotation_z(0.3)).unwrap();
            let joint = JointDesc::hinge([post, wheel], frames)
                .with_limit(Limit::new(Motion::Angular, backstop::Axes::One(Axis::X), -2.0, 2.0))
                .with_motor(Motor::velocity(Motion::Angular, Axis::X, 1.0, 5.0));
            world.add_joint(&joint).unwrap()
        });
        let gear = world.add_coupling(&CouplingDesc::gear(hinges, [1.0, 2.0])).unwrap();
        let field = HeightField::new(5, 5, Vec2::ONE, (0..25).map(|i| 0.01 * i as f32).collect()).unwrap();
        let field = field.with_holes([[1, 1]]).unwrap();
        let field = backstop::ShapeDesc::new(Geometry::height_field(field));
        let field = BodyDesc::fixed().with_position(DVec3::new(-9.0, 0.0, 0.0)).with_shape(field);
        let ground = world.add_body(&field).unwrap();
        let field = world.shapes(ground).unwrap().next().unwrap();
        let ball = common::dynamic(Geometry::sphere(0.3), Material::default(), Vec3::new(-7.5, 0.5, 2.5));
        let ball = world.add_body(&ball).unwrap();
        let mass = MassProperties { mass: 7.0, centre_of_mass: Vec3::X * 0.1, inertia: Mat3::IDENTITY };
        world.set_mass(ball, mass).unwrap();
        let mut cart = common::dynamic(Geometry::cuboid(0.5, 0.1, 0.5), Material::default(), Vec3::Z * 4.0);
        (cart.kind, cart.linear_velocity) = (BodyKind::Kinematic, Vec3::X * 0.1);
        world.add_body(&cart).unwrap();
        common::steps(&mut world, steps, DT);
        let bodies: Vec<BodyHandle> = world.bodies().collect();
        let shapes = bodies.iter().flat_map(|&body| world.shapes(body).unwrap()).collect();
        Content { world, bodies, shapes, hinges, gear, field }
    }
}

/// Gives everything the value that it has.
type Same = fn(&mut Content) -> Result<(), Error>;

fn each_body(
    c: &mut Content,
    call: impl Fn(&mut World, BodyHandle) -> Result<(), Error>,
) -> Result<(), Error> {
    c.bodies.iter().try_for_each(|&body| call(&mut c.world, body))
}

fn each_shape(
    c: &mut Content,
    call: impl Fn(&mut World, ShapeHandle) -> Result<(), Error>,
) -> Result<(), Error> {
    c.shapes.iter().try_for_each(|&shape| call(&mut c.world, shape))
}

fn each_hinge(
    c: &mut Content,
    call: impl Fn(&mut World, JointHandle) -> Result<(), Error>,
) -> Result<(), Error> {
    c.hinges.iter().try_for_each(|&joint| call(&mut c.world, joint))
}

const BODIES: [(&str, Same); 19] = [
    ("set_pose", |c| each_body(c, |w, body| w.set_pose(body, w.position(body)?, w.rotation(body)?))),
    ("set_velocity", |c| {
        each_body(c, |w, body| w.set_velocity(body, w.linear_velocity(body)?, w.angular_velocity(body)?))
    }),
    ("set_linear_velocity", |c| {
        each_body(c, |w, body| w.set_linear_velocity(body, w.linear_velocity(body)?))
    }),
    ("set_angular_velocity", |c| {
        each_body(c, |w, body| w.set_angular_velocity(body, w.angular_velocity(body)?))
    }),
    ("set_gravity_scale", |c| each_body(c, |w, body| w.set_gravity_scale(body, w.gravity_scale(body)?))),
    ("set_damping", |c| {
        each_body(c, |w, body| {
            w.damping(body).and_then(|(linear, angular)| w.set_damping(body, linear, angular))
        })
    }),
    ("set_max_speeds", |c| {
        each_body(c, |w, body| w.max_speeds(body).and_then(|[one, other]| w.set_max_speeds(body, one, other)))
    }),
    ("set_locked_axes", |c| {
        each_body(c, |w, body| {
            w.locked_axes(body).and_then(|(one, other)| w.set_locked_axes(body, one, other))
        })
    }),
    ("set_continuous", |c| each_body(c, |w, body| w.set_continuous(body, w.continuous(body)?))),
    ("set_body_solved_after", |c| {
        each_body(c, |w, body| w.set_body_solved_after(body, w.body_solved_after(body)?))
    }),
    ("set_can_sleep", |c| each_body(c, |w, body| w.set_can_sleep(body, w.can_sleep(body)?))),
    ("set_enabled", |c| each_body(c, |w, body| w.set_enabled(body, w.is_enabled(body)?))),
    ("set_kind", |c| each_body(c, |w, body| w.set_kind(body, w.kind(body)?))),
    ("set_user_data", |c| each_body(c, |w, body| w.set_user_data(body, w.user_data(body)?))),
    ("set_mass", |c| {
        each_body(c, |w, body| {
            // Of others it would be new that it is given.
            if w.has_mass_from_shapes(body)? || w.mass(body)? == 0.0 {
                return Ok(());
            }
            w.set_mass(body, w.mass_properties(body)?)
        })
    }),
    ("set_settings", |c| c.world.set_settings(c.world.settings().clone())),
    ("set_origin", |c| c.world.set_origin(c.world.origin())),
    ("set_heights", |c| {
        let heights = [6.0f32, 7.0, 11.0, 12.0].map(|i| 0.01 * i);
        c.world.set_heights(c.field, [1, 1], [2, 2], &heights)
    }),
    ("set_holes", |c| c.world.set_holes(c.field, [1, 1], [2, 1], &[true, false])),
];

const SHAPES: [(&str, Same); 10] = [
    ("set_material", |c| each_shape(c, |w, shape| w.set_material(shape, w.material(shape)?))),
    ("set_filter", |c| each_shape(c, |w, shape| w.set_filter(shape, w.filter(shape)?))),
    ("set_events", |c| each_shape(c, |w, shape| w.set_events(shape, w.has_events(shape)?))),
    ("set_hooks", |c| each_shape(c, |w, shape| w.set_hooks(shape, w.has_hooks(shape)?))),
    ("set_sensor", |c| each_shape(c, |w, shape| w.set_sensor(shape, w.is_sensor(shape)?))),
    ("set_senses_static", |c| each_shape(c, |w, shape| w.set_senses_static(shape, w.senses_static(shape)?))),
    ("set_shape_user_data", |c| {
        each_shape(c, |w, shape| w.set_shape_user_data(shape, w.shape_user_data(shape)?))
    }),
    ("set_geometry", |c| each_shape(c, |w, shape| w.set_geometry(shape, w.geometry(shape)?.clone()))),
    ("set_shape_pose", |c| {
        each_shape(c, |w, shape| {
            w.shape_pose(shape).and_then(|(at, turned)| w.set_shape_pose(shape, at, turned))
        })
    }),
    ("set_density", |c| each_shape(c, |w, shape| w.set_density(shape, w.density(shape)?))),
];

const JOINTS: [(&str, Same); 16] = [
    ("set_joint_motor", |c| {
        each_hinge(c, |w, joint| {
            let drive = w.joint_motors(joint)?.next().unwrap();
            w.set_joint_motor(joint, drive)
        })
    }),
    ("set_joint_motors", |c| {
        each_hinge(c, |w, joint| {
            let drives: Vec<Motor> = w.joint_motors(joint)?.collect();
            w.set_joint_motors(joint, &drives)
        })
    }),
    ("set_joint_target", |c| {
        each_hinge(c, |w, joint| {
            let drive = w.joint_motors(joint)?.next().unwrap();
            w.set_joint_target(joint, drive.motion, drive.axis, drive.position, drive.velocity)
        })
    }),
    ("remove_joint_motor", |c| {
        each_hinge(c, |w, joint| w.remove_joint_motor(joint, Motion::Linear, Axis::Z).map(drop))
    }),
    ("set_joint_limit", |c| {
        each_hinge(c, |w, joint| {
            let limit = w.joint_limits(joint)?.last().unwrap();
            w.set_joint_limit(joint, limit)
        })
    }),
    ("set_joint_limits", |c| {
        each_hinge(c, |w, joint| {
            let limits: Vec<Limit> = w.joint_limits(joint)?.collect();
            w.set_joint_limits(joint, &limits)
        })
    }),
    ("remove_joint_limit", |c| {
        each_hinge(c, |w, joint| {
            w.remove_joint_limit(joint, Motion::Linear, backstop::Axes::One(Axis::Z)).map(drop)
        })
    }),
    ("set_joint_frames", |c| {
        each_hinge(c, |w, joint| w.set_joint_frames(joint, w.joint_local_frames(joint)?))
    }),
    ("set_joint_collide", |c| each_hinge(c, |w, joint| w.set_joint_collide(joint, w.joint_collide(joint)?))),
    ("set_joint_break_force", |c| {
        each_hinge(c, |w, joint| {
            w.joint_break_force(joint)
                .and_then(|(force, torque)| w.set_joint_break_force(joint, force, torque))
        })
    }),
    ("set_joint_thresholds", |c| {
        each_hinge(c, |w, joint| {
            w.joint_thresholds(joint).and_then(|(force, torque)| w.set_joint_thresholds(joint, force, torque))
        })
    }),
    ("set_joint_solved_after", |c| each_hinge(c, |w, joint| w.set_joint_solved_after(joint, None))),
    ("set_coupling_factors", |c| {
        let factors = c.world.coupling(c.gear)?.motions.map(|motion| motion.factor);
        c.world.set_coupling_factors(c.gear, factors)
    }),
    ("set_coupling_range", |c| {
        let range = c.world.coupling(c.gear)?.range;
        c.world.set_coupling_range(c.gear, range)
    }),
    ("set_coupling_break_force", |c| {
        let strength = c.world.coupling(c.gear)?.break_force;
        c.world.set_coupling_break_force(c.gear, strength)
    }),
    ("set_coupling_user_data", |c| {
        let user_data = c.world.coupling(c.gear)?.user_data;
        c.world.set_coupling_user_data(c.gear, user_data)
    }),
];

/// Expected: the hash after each step is that of a world without the call, whenever it is called, and who
/// sleeps goes on sleeping. Before the first step nothing sleeps, after 12 the heap slides into place, after
/// 200 it sleeps.
#[test]
fn a_value_that_is_no_other_changes_no_bit_of_the_run() {
    for steps in [0, 12, 200] {
        let mut without = Content::new(steps);
        let asleep = without.world.sleeping_body_count();
        assert_eq!(asleep > 0, steps == 200, "{asleep} after {steps}");
        let hashes: Vec<u64> = (0..90)
            .map(|_| {
                without.world.step(DT).unwrap();
                without.world.state_hash()
            })
            .collect();
        for (name, call) in BODIES.iter().chain(&SHAPES).chain(&JOINTS) {
            let mut with = Content::new(steps);
            let before = with.world.state_hash();
            call(&mut with).unwrap();
            assert_eq!(
                (with.world.state_hash(), with.world.sleeping_body_count()),
                (before, asleep),
                "{name} after {steps} steps"
            );
            for (step, hash) in hashes.iter().enumerate() {
                if step % 7 == 3 {
                    call(&mut with).unwrap();
                }
                with.world.step(DT).unwrap();
                assert_eq!(with.world.state_hash(), *hash, "{name} after {steps} and {step} steps");
            }
        }
    }
}

/// Expected: bytes and hashes of a world without the calls, and no memory taken; numbers that are out of
/// range are refused all the same.
#[test]
fn forces_and_velocities_have_no_effect_on_what_they_cannot_move() {
    let mut content = Content::new(30);
    let [fixed, moved] = [BodyKind::Static, BodyKind::Kinematic].map(|kind| of_kind(&content.world, kind));
    let bytes = |world: &World| {
        let mut snapshot = Snapshot::new();
        world.snapshot(&mut snapshot);
        (snapshot.to_whole_bytes(), world.memory())
    };
    let before = bytes(&content.world);
    let w = &mut content.world;
    for body in [fixed, moved] {
        w.add_force_and_torque(body, Vec3::ONE, Vec3::ONE).unwrap();
        w.add_force_at(body, Vec3::ONE, DVec3::ONE).unwrap();
        w.apply_impulse_at(body, Vec3::ONE, DVec3::ONE).unwrap();
        w.apply_angular_impulse(body, Vec3::ONE).unwrap();
        w.sleep(body).unwrap();
        assert!(w.add_force(body, Vec3::NAN).is_err());
        assert!(w.apply_impulse_at(body, Vec3::ONE * 1e30, DVec3::ONE).is_err());
        assert!(w.apply_angular_impulse(body, Vec3::INFINITY).is_err());
    }
    w.set_velocity(fixed, Vec3::ONE, Vec3::ONE).unwrap();
    w.set_linear_velocity(fixed, Vec3::ONE).unwrap();
    w.set_angular_velocity(fixed, Vec3::ONE).unwrap();
    w.move_kinematic(fixed, DVec3::ONE, Quat::IDENTITY, DT).unwrap();
    w.move_kinematic_and_stop(fixed, DVec3::ONE, Quat::IDENTITY, DT).unwrap();
    assert!(w.set_velocity(fixed, Vec3::NAN, Vec3::ZERO).is_err());
    assert!(w.move_kinematic(fixed, DVec3::NAN, Quat::IDENTITY, DT).is_err());
    assert!(bytes(w) == before);
    // A dynamic body just gets the velocity: 0.1 m in a step.
    let ball = of_kind(w, BodyKind::Dynamic);
    let to = w.position(ball).unwrap() + DVec3::Y * 0.1;
    w.move_kinematic(ball, to, w.rotation(ball).unwrap(), DT).unwrap();
    assert!((w.linear_velocity(ball).unwrap() - Vec3::Y * 6.0).length() < 1e-3);
}

fn of_kind(world: &World, kind: BodyKind) -> BodyHandle {
    world.bodies().find(|&body| world.kind(body) == Ok(kind)).unwrap()
}
