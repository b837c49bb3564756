//! What entities say reaches the world, and goes with them.

use crate::common::*;
use backstop_bevy::backstop::{
    self, Axis, BodyKind, ContinuousMode, Error, Filter, Geometry, Limit, MassProperties, Motion,
    TriangleMesh, glam,
};
use backstop_bevy::prelude::*;
use bevy_ecs::prelude::*;
use bevy_math::{Quat, Vec3};
use bevy_transform::components::Transform;

fn handle(app: &bevy_app::App, entity: Entity) -> backstop::BodyHandle {
    physics(app).body(entity).expect("it is in the world")
}

/// Expected: the entity's body, shape and joint are gone at once, the other body is there; handles and
/// entities name each other until then.
#[test]
fn a_despawned_entity_leaves_the_world() {
    let mut app = app();
    let (a, b) = (ball(&mut app, 5.0), ball(&mut app, 7.0));
    let joint = app.world_mut().spawn(Joint::distance([a, b], 0.0, 3.0)).id();
    app.update();
    let world = physics(&app);
    let (body, shape) = (handle(&app, a), world.shape(a).unwrap());
    let joined = world.joint(joint).unwrap();
    assert_eq!((world.entity_of(body), world.entity_of_shape(shape)), (Some(a), Some(a)));
    assert_eq!(world.entity_of_joint(joined), Some(joint));
    assert_eq!((world.body_count(), world.joint_count()), (2, 1));

    app.world_mut().despawn(a);
    let world = physics(&app);
    assert_eq!((world.body_count(), world.joint_count()), (1, 0));
    assert_eq!((world.entity_of(body), world.entity_of_shape(shape)), (None, None));
    assert_eq!((world.body(a), world.shape(a), world.joint(joint)), (None, None, None));
    log::<PhysicsError>(&mut app);
    run(&mut app, 5);
    let problem = Problem::NoBody(a);
    assert_eq!(logged::<PhysicsError>(&app), [PhysicsError { entity: Some(joint), problem }], "once");
    app.world_mut().despawn(joint);
    app.world_mut().despawn(b);
    run(&mut app, 2);
    assert_eq!(physics(&app).body_count(), 0);
}

/// Expected: a joint whose component is removed is gone, and one whose entity names other bodies is between
/// these.
#[test]
fn joints_follow_their_component() {
    let mut app = app();
    let [a, b, c] = [5.0, 7.0, 9.0].map(|height| ball(&mut app, height));
    let hinge = Joint::hinge([a, b]).at(Vec3::new(0.0, 6.0, 0.0)).about(Vec3::Z);
    let joint = app.world_mut().spawn(hinge.clone()).id();
    app.update();
    let first = physics(&app).joint(joint).unwrap();
    let frames = physics(&app).joint_frames(first).unwrap();
    for (position, rotation) in frames {
        assert!((position - glam::DVec3::new(0.0, 6.0, 0.0)).length() < 0.01, "{position}");
        assert!((rotation * glam::Vec3::X - glam::Vec3::Z).length() < 1e-3, "its axis is z");
    }

    let limit = Limit::new(Motion::Angular, backstop::Axes::One(Axis::X), -1.0, 1.0);
    let motor = Motor::velocity(Motion::Angular, Axis::X, 2.0, 50.0);
    let changed = hinge.with_limit(limit).with_motor(motor).with_break_force(1e6, 1e5);
    app.world_mut().entity_mut(joint).insert(changed.clone());
    app.update();
    let world = physics(&app);
    assert_eq!(world.joint(joint), Some(first), "it is the same joint");
    assert_eq!(world.joint_limits(first).unwrap().count(), 3);
    assert_eq!(world.joint_motors(first).unwrap().next(), Some(motor));
    assert_eq!(world.joint_break_force(first).unwrap(), (1e6, 1e5));
    let slower = motor.with_target(0.0, 1.0);
    app.world_mut().get_mut::<Joint>(joint).unwrap().desc.motors[0] = slower;
    app.update();
    assert_eq!(physics(&app).joint_motors(first).unwrap().next(), Some(slower));

    app.world_mut().get_mut::<Joint>(joint).unwrap().bodies = [b, c];
    app.update();
    let second = physics(&app).joint(joint).unwrap();
    assert_eq!(physics(&app).joint_bodies(second).unwrap(), [b, c].map(|body| handle(&app, body)));
    assert!(!physics(&app).contains_joint(first));
    app.world_mut().entity_mut(joint).remove::<Joint>();
    assert_eq!(physics(&app).joint_count(), 0);
}

/// Expected: what the world says is what was set; and the default again once the component is removed.
#[test]
fn changed_components_reach_the_world() {
    let mut app = app();
    let body = ball(&mut app, 50.0);
    app.update();
    let own = MassProperties::of(&backstop::Geometry::sphere(0.5), 1000.0);
    let given = own.scaled_to(7.0);
    let material = ShapeMaterial::friction(0.1);
    let filter = ShapeFilter(Filter::default().with_category(4).with_mask(8));
    let damping = Damping { linear: 0.1, angular: 0.2 };
    let max_speeds = MaxSpeeds { linear: Some(30.0), angular: None };
    app.world_mut().entity_mut(body).insert((
        (Mass(given), GravityScale(0.5), damping, LockedAxes::ROTATION, Continuous(ContinuousMode::Volume)),
        (NeverSleeps, SolvedAfter(backstop::RowGroup::Joints), max_speeds),
        (material, filter, Density(500.0), ContactMessages, ContactHooked),
    ));
    app.update();
    let (world, b, s) = (physics(&app), handle(&app, body), physics(&app).shape(body).unwrap());
    assert!((world.mass(b).unwrap() - 7.0).abs() < 1e-5);
    assert_eq!(world.gravity_scale(b).unwrap(), 0.5);
    assert_eq!(world.damping(b).unwrap(), (0.1, 0.2));
    assert_eq!(world.max_speeds(b).unwrap(), [Some(30.0), None]);
    assert_eq!(world.locked_axes(b).unwrap(), ([false; 3], [true; 3]));
    assert_eq!(world.continuous(b).unwrap(), ContinuousMode::Volume);
    assert_eq!(world.body_solved_after(b).unwrap(), Some(backstop::RowGroup::Joints));
    assert!(!world.can_sleep(b).unwrap());
    assert_eq!(world.material(s).unwrap(), material.0);
    assert_eq!(world.filter(s).unwrap(), filter.0);
    assert_eq!(world.density(s).unwrap(), 500.0);
    assert!(world.has_events(s).unwrap() && world.has_hooks(s).unwrap());

    app.world_mut().entity_mut(body).remove::<(
        (Mass, GravityScale, Damping, LockedAxes, Continuous, NeverSleeps, SolvedAfter, MaxSpeeds),
        (ShapeMaterial, ShapeFilter, Density, ContactMessages, ContactHooked),
    )>();
    app.update();
    let world = physics(&app);
    assert!((world.mass(b).unwrap() - own.mass).abs() < 1e-3, "that of its shape again");
    assert_eq!(world.gravity_scale(b).unwrap(), 1.0);
    assert_eq!(world.damping(b).unwrap(), (0.0, 0.0));
    assert_eq!(world.max_speeds(b).unwrap(), [None, None]);
    assert_eq!(world.locked_axes(b).unwrap(), ([false; 3], [false; 3]));
    assert_eq!(
        (world.continuous(b).unwrap(), world.body_solved_after(b).unwrap()),
        (ContinuousMode::Segment, None)
    );
    assert!(world.can_sleep(b).unwrap());
    assert_eq!(world.material(s).unwrap(), backstop::Material::default());
    assert_eq!(world.filter(s).unwrap(), Filter::default());
    assert!(!world.has_events(s).unwrap() && !world.has_hooks(s).unwrap());

    // Another kind, a larger ball, at another speed, and out of the world.
    app.world_mut().entity_mut(body).insert((Shape::sphere(1.0), Velocity::linear(Vec3::X)));
    app.update();
    let world = physics(&app);
    assert!((world.mass(b).unwrap() / own.mass - 8.0).abs() < 1e-3);
    assert_eq!(world.linear_velocity(b).unwrap().x, 1.0);
    app.world_mut().entity_mut(body).insert((RigidBody::Kinematic, BodyDisabled));
    app.update();
    assert_eq!(physics(&app).kind(b).unwrap(), BodyKind::Kinematic);
    assert!(!physics(&app).is_enabled(b).unwrap());
    app.world_mut().entity_mut(body).remove::<BodyDisabled>();
    app.update();
    assert!(physics(&app).is_enabled(b).unwrap());
}

/// A dumb-bell: two balls of 0.2 m at x = -1 and 1 on a bar of 2 by 0.1 by 0.1 m, as three children, one of
/// them a grandchild. Expected: masses add up, and the inertia about the bar's centre is that of textbooks
/// with the theorem of parallel axes; what is added, moved and removed later counts too.
#[test]
fn children_make_a_compound() {
    let mut app = app();
    let at = |x| Transform::from_xyz(x, 0.0, 0.0);
    let body = app.world_mut().spawn((RigidBody::Dynamic, Transform::from_xyz(0.0, 90.0, 0.0))).id();
    app.world_mut().spawn((Shape::cuboid(1.0, 0.05, 0.05), ChildOf(body)));
    app.world_mut().spawn((Shape::sphere(0.2), at(-1.0), ChildOf(body)));
    let turned = Transform::from_rotation(Quat::from_rotation_y(std::f32::consts::FRAC_PI_2));
    let between = app.world_mut().spawn((turned, ChildOf(body))).id();
    // Turned by a quarter about y, local z is x.
    let end = app
        .world_mut()
        .spawn((Shape::sphere(0.2), Transform::from_xyz(0.0, 0.0, 1.0), ChildOf(between)))
        .id();
    app.update();
    let (ball, bar) = (1000.0 * 4.0 / 3.0 * std::f32::consts::PI * 0.008, 1000.0 * 2.0 * 0.01);
    let inertia = bar * (4.0 + 0.01) / 12.0 + 2.0 * ball * (0.4 * 0.04 + 1.0);
    let mass = |app: &bevy_app::App| physics(app).mass_properties(handle(app, body)).unwrap();
    let all = mass(&app);
    assert!((all.mass - (2.0 * ball + bar)).abs() < 1e-3 * all.mass, "{} kg", all.mass);
    let (moments, _) = all.principal();
    let largest = moments.x.max(moments.y).max(moments.z);
    assert!((largest - inertia).abs() < 1e-3 * inertia, "{largest} beside {inertia}");

    app.world_mut().get_mut::<Transform>(end).unwrap().translation.z = 3.0;
    app.update();
    let centre = all.mass.recip() * ball * 2.0;
    assert!((mass(&app).centre_of_mass.x - centre).abs() < 1e-3, "the ball is 2 m further out");
    app.world_mut().despawn(end);
    app.update();
    assert!((mass(&app).mass - (ball + bar)).abs() < 1e-3 * all.mass);
    app.world_mut().spawn((Shape::sphere(0.2), at(1.0), ChildOf(body)));
    app.update();
    assert!((mass(&app).mass - all.mass).abs() < 1e-3 * all.mass);
    assert_eq!(physics(&app).body_count(), 1);
}

/// Expected: a shape that gets another body is on that one; a body without its last shape keeps its mass, and
/// takes that of the next.
#[test]
fn shapes_move_from_body_to_body() {
    let mut app = app();
    let [a, b] = [0.0, 5.0].map(|x| ball_at(&mut app, x));
    let shape = app.world_mut().spawn((Shape::cuboid(0.1, 0.1, 0.1), ChildOf(a))).id();
    app.update();
    let of = |app: &bevy_app::App| physics(app).body_of(physics(app).shape(shape).unwrap()).unwrap();
    assert_eq!(of(&app), handle(&app, a));
    app.world_mut().entity_mut(shape).insert(ChildOf(b));
    app.update();
    assert_eq!(of(&app), handle(&app, b));

    let mass = |app: &bevy_app::App| physics(app).mass(handle(app, a)).unwrap();
    let whole = mass(&app);
    app.world_mut().entity_mut(a).remove::<Shape>();
    app.update();
    assert_eq!(physics(&app).shapes(handle(&app, a)).unwrap().count(), 0);
    assert!((mass(&app) - whole).abs() < 1e-3 * whole);
    app.world_mut().entity_mut(a).insert(Shape::cuboid(0.5, 0.5, 0.5));
    app.update();
    assert!((mass(&app) - 1000.0).abs() < 0.1);
}

/// A mesh with its surface at 1 m, twice as high and wide by its scale. Expected: a ball beyond its own edge
/// rests on it at 2 m.
#[test]
fn meshes_have_scales() {
    let mut app = app();
    let corners = [[-1.0, 1.0, -1.0], [1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]];
    let vertices = corners.map(backstop::glam::Vec3::from_array).to_vec();
    let mesh = TriangleMesh::new(vertices, vec![[0, 2, 1], [0, 3, 2]]).unwrap();
    let at = Transform::from_scale(Vec3::new(3.0, 2.0, 3.0));
    app.world_mut().spawn((RigidBody::Static, Shape(Geometry::mesh(mesh)), at));
    let at = Transform::from_xyz(2.0, 2.6, 2.0);
    let ball = app.world_mut().spawn((RigidBody::Dynamic, Shape::sphere(0.5), at)).id();
    run(&mut app, 120);
    assert!((get::<PhysicsPose>(&app, ball).position.y - 2.5).abs() < 1e-3);
}

fn ball_at(app: &mut bevy_app::App, x: f32) -> Entity {
    app.world_mut().spawn((RigidBody::Dynamic, Shape::sphere(0.5), Transform::from_xyz(x, 50.0, 0.0))).id()
}

/// Expected: each is refused with the engine's error and the entity, once; nothing panics; and it is made as
/// soon as it can be.
#[test]
fn bad_descriptions_are_reported() {
    let mut app = app();
    log::<PhysicsError>(&mut app);
    let spawn = |app: &mut bevy_app::App, shape: Shape, kind: RigidBody, at: Transform| {
        app.world_mut().spawn((kind, shape, at)).id()
    };
    let origin = Transform::IDENTITY;
    let negative = spawn(&mut app, Shape::sphere(-1.0), RigidBody::Static, origin);
    let moving_plane = spawn(&mut app, Shape::plane(), RigidBody::Dynamic, origin);
    let nowhere =
        spawn(&mut app, Shape::sphere(0.5), RigidBody::Static, Transform::from_xyz(f32::NAN, 0.0, 0.0));
    let squeezed = Transform::from_scale(Vec3::new(1.0, 2.0, 1.0));
    let egg = spawn(&mut app, Shape::sphere(0.5), RigidBody::Static, squeezed);
    let massless = app.world_mut().spawn(RigidBody::Dynamic).id();
    let loose = app.world_mut().spawn(Shape::sphere(0.5)).id();
    let alone = app.world_mut().spawn(Joint::ball([massless, massless])).id();
    run(&mut app, 10);
    let errors = logged::<PhysicsError>(&app);
    let of = |entity: Entity| -> Vec<&Problem> {
        errors.iter().filter(|error| error.entity == Some(entity)).map(|error| &error.problem).collect()
    };
    assert!(matches!(of(negative)[..], [Problem::Engine(Error::OutOfRange { what: "sphere radius", .. })]));
    assert!(matches!(of(moving_plane)[..], [Problem::Engine(Error::StaticOnly { .. })]));
    assert!(matches!(of(nowhere)[..], [Problem::Engine(Error::NotFinite { .. })]));
    assert!(matches!(of(egg)[..], [Problem::Scale { shape: "sphere", .. }]));
    assert_eq!(of(massless), [&Problem::Engine(Error::NoMass)]);
    assert_eq!(of(loose), [&Problem::NoBodyAbove]);
    assert_eq!(of(alone), [&Problem::NoBody(massless)]);
    assert_eq!(errors.len(), 7);
    assert_eq!(physics(&app).body_count(), 2, "static bodies need no shapes");

    app.world_mut().entity_mut(massless).insert(Shape::sphere(0.5));
    app.world_mut().entity_mut(loose).insert(RigidBody::Dynamic);
    app.world_mut().entity_mut(negative).insert(Shape::sphere(1.0));
    app.world_mut().entity_mut(moving_plane).insert(RigidBody::Static);
    app.update();
    assert!([massless, loose, moving_plane].iter().all(|&body| physics(&app).body(body).is_some()));
    assert!(physics(&app).shape(negative).is_some());

    // A bad value leaves the one before.
    app.world_mut().entity_mut(loose).insert((GravityScale(f32::NAN), ShapeMaterial::friction(-1.0)));
    run(&mut app, 3);
    assert_eq!(physics(&app).gravity_scale(handle(&app, loose)).unwrap(), 1.0);
    let shape = physics(&app).shape(loose).unwrap();
    assert_eq!(physics(&app).material(shape).unwrap(), backstop::Material::default());
    assert_eq!(logged::<PhysicsError>(&app).iter().filter(|error| error.entity == Some(loose)).count(), 3);
}

/// Expected: a scale makes a box as much larger along each axis, which its mass tells, also when it changes.
#[test]
fn scales_count() {
    let mut app = app();
    let at = Transform::from_xyz(0.0, 50.0, 0.0).with_scale(Vec3::new(1.0, 2.0, 3.0));
    let body = app.world_mut().spawn((RigidBody::Dynamic, Shape::cuboid(0.5, 0.5, 0.5), at)).id();
    app.update();
    let mass = |app: &bevy_app::App| physics(app).mass(handle(app, body)).unwrap();
    assert!((mass(&app) - 6000.0).abs() < 0.1);
    app.world_mut().get_mut::<Transform>(body).unwrap().scale = Vec3::ONE;
    app.update();
    assert!((mass(&app) - 1000.0).abs() < 0.1);
}

/// Two wheels on hinges about z, side by side, coupled as gears of 10 and 30 teeth; one turns by 3 rad/s
/// without friction. Expected: the other turns back at a third of that; with other teeth at that ratio; not
/// at all once the component is removed; and a coupling waits for its joints, is gone with them, and says
/// that it broke.
#[test]
fn couplings_follow_their_component() {
    let mut app = app();
    log::<CouplingBroke>(&mut app);
    log::<PhysicsError>(&mut app);
    let frame = app.world_mut().spawn(RigidBody::Static).id();
    let axle = |app: &mut bevy_app::App, x: f32| {
        let at = Transform::from_xyz(x, 0.0, 0.0);
        let wheel = app.world_mut().spawn((RigidBody::Dynamic, Shape::sphere(0.3), at)).id();
        let hinge = Joint::hinge([frame, wheel]).at(Vec3::new(x, 0.0, 0.0)).about(Vec3::Z);
        (wheel, app.world_mut().spawn(hinge).id())
    };
    let (driver, first) = axle(&mut app, 0.0);
    let (driven, second) = axle(&mut app, 1.0);
    let pair = app.world_mut().spawn(Coupling::gear([first, second], [10.0, 30.0])).id();
    app.world_mut().entity_mut(driver).insert(Velocity::angular(Vec3::Z * 3.0));
    let speeds = |app: &bevy_app::App| [driver, driven].map(|body| get::<Velocity>(app, body).angular.z);
    run(&mut app, 30);
    let [a, b] = speeds(&app);
    assert!(a > 1.0 && (a + 3.0 * b).abs() < 0.01 * a, "{a} and {b} rad/s");
    let handle = physics(&app).coupling_of(pair).unwrap();

    app.world_mut().entity_mut(pair).insert(Coupling::gear([first, second], [10.0, 20.0]));
    run(&mut app, 30);
    let [a, b] = speeds(&app);
    assert_eq!(physics(&app).coupling_of(pair), Some(handle), "it is the same coupling");
    assert!(a > 1.0 && (a + 2.0 * b).abs() < 0.01 * a, "{a} and {b} rad/s");

    app.world_mut().entity_mut(pair).remove::<Coupling>();
    app.world_mut().entity_mut(driver).insert(Velocity::angular(Vec3::Z * 9.0));
    run(&mut app, 10);
    assert!((speeds(&app)[1] - b).abs() < 1e-3);
    assert_eq!(physics(&app).coupling_count(), 0);

    // Half of the torque on the driver goes through the gears, which hold 1 N m.
    let weak = Coupling::gear([first, second], [1.0, 1.0]).with_break_force([1.0, 1.0]);
    app.world_mut().entity_mut(pair).insert(weak);
    let torque = Vec3::Z * 50.0;
    app.world_mut().entity_mut(driver).insert(ConstantForce { force: Vec3::ZERO, torque });
    run(&mut app, 3);
    assert_eq!(logged::<CouplingBroke>(&app), [CouplingBroke { coupling: pair }]);
    assert_eq!(physics(&app).coupling_of(pair), None);
    assert_eq!(logged::<PhysicsError>(&app), []);

    let strong = Coupling::gear([first, second], [1.0, 1.0]);
    app.world_mut().entity_mut(pair).insert(strong);
    run(&mut app, 2);
    assert_eq!(physics(&app).coupling_count(), 1);
    app.world_mut().despawn(second);
    run(&mut app, 3);
    let problem = Problem::NoJoint(second);
    assert_eq!(logged::<PhysicsError>(&app), [PhysicsError { entity: Some(pair), problem }], "once");
    assert_eq!(physics(&app).coupling_count(), 0);
}
