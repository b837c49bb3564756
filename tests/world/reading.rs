//! Readings of bodies and shapes are the values that were set, and the results of the last step.

use crate::common::Floor;
use crate::common::random::Random;
use backstop::glam::{DVec3, Mat3, Quat, Vec3};
use backstop::{
    BodyContact, BodyDesc, BodyHandle, BodyKind, Combine, ContinuousMode, Error, Filter, Geometry, Material,
    RowGroup, Settings, ShapeDesc, Snapshot, World,
};

const DT: f32 = 1.0 / 60.0;

fn world() -> World {
    World::new(Settings::default().with_sleeping(true)).unwrap()
}

fn ball() -> ShapeDesc {
    ShapeDesc::new(Geometry::Sphere { radius: 0.5 })
}

fn cube() -> ShapeDesc {
    ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5))
}

fn steps(world: &mut World, count: u32) {
    for _ in 0..count {
        world.step(DT).unwrap();
    }
}

#[test]
fn each_field_of_a_body_is_read_as_it_was_written() {
    let mut world = world();
    let mut desc = BodyDesc::dynamic()
        .with_position(DVec3::new(1.0, 2.0, 3.0))
        .with_rotation(Quat::from_rotation_y(0.5))
        .with_velocity(Vec3::X, Vec3::Z)
        .with_shape(cube())
        .with_solved_after(RowGroup::Contacts);
    (desc.gravity_scale, desc.linear_damping, desc.angular_damping) = (0.5, 0.1, 0.2);
    (desc.max_linear_speed, desc.max_angular_speed) = (Some(50.0), Some(20.0));
    (desc.lock_translation, desc.lock_rotation) = ([true, false, false], [false, true, true]);
    (desc.continuous, desc.can_sleep, desc.user_data) = (ContinuousMode::Volume, false, 17);
    let body = world.add_body(&desc).unwrap();
    assert_eq!(world.kind(body), Ok(desc.kind));
    assert_eq!((world.position(body), world.rotation(body)), (Ok(desc.position), Ok(desc.rotation)));
    assert_eq!(world.linear_velocity(body), Ok(Vec3::X));
    assert_eq!(world.angular_velocity(body), Ok(Vec3::Z));
    assert_eq!(world.gravity_scale(body), Ok(0.5));
    assert_eq!(world.damping(body), Ok((0.1, 0.2)));
    assert_eq!(world.max_speeds(body), Ok([Some(50.0), Some(20.0)]));
    assert_eq!(world.locked_axes(body), Ok((desc.lock_translation, desc.lock_rotation)));
    assert_eq!(world.continuous(body), Ok(ContinuousMode::Volume));
    assert_eq!(world.body_solved_after(body), Ok(Some(RowGroup::Contacts)));
    assert_eq!((world.can_sleep(body), world.user_data(body)), (Ok(false), Ok(17)));
    // A cube of one metre: m / 6 about each axis.
    let mass = world.mass_properties(body).unwrap();
    assert_eq!((mass.mass, mass.centre_of_mass), (1000.0, Vec3::ZERO));
    assert!(mass.inertia.abs_diff_eq(Mat3::from_diagonal(Vec3::splat(1000.0 / 6.0)), 1e-3));
    assert_eq!(world.has_mass_from_shapes(body), Ok(true));
    world.set_user_data(body, 18).unwrap();
    world.set_can_sleep(body, true).unwrap();
    world.set_locked_axes(body, [false; 3], [true, false, false]).unwrap();
    assert_eq!((world.can_sleep(body), world.user_data(body)), (Ok(true), Ok(18)));
    assert_eq!(world.locked_axes(body), Ok(([false; 3], [true, false, false])));
    world.remove_body(body).unwrap();
    assert_eq!(world.locked_axes(body), Err(Error::StaleBody));
    assert_eq!(world.set_user_data(body, 1), Err(Error::StaleBody));
}

#[test]
fn each_field_of_a_shape_is_read_as_it_was_written() {
    let mut world = world();
    let filter = Filter::default().with_category(2).with_mask(7).with_group(-1);
    let material = Material::default().with_restitution_combine(Combine::Maximum);
    let (place, turn) = (Vec3::new(0.25, 0.5, -1.0), Quat::from_rotation_x(0.3));
    let shape = ball()
        .with_position(place)
        .with_rotation(turn)
        .with_density(0.0)
        .with_filter(filter)
        .with_material(material);
    let shape = shape.clone().with_sensor(true).with_events().with_user_data(5);
    let body = world.add_body(&BodyDesc::dynamic().with_shape(cube()).with_shape(shape)).unwrap();
    let shape = world.shapes(body).unwrap().nth(1).unwrap();
    assert_eq!(world.body_of(shape), Ok(body));
    assert_eq!((world.filter(shape), world.material(shape)), (Ok(filter), Ok(material)));
    assert_eq!((world.is_sensor(shape), world.density(shape)), (Ok(true), Ok(0.0)));
    assert_eq!((world.has_events(shape), world.has_hooks(shape)), (Ok(true), Ok(false)));
    assert_eq!((world.shape_pose(shape), world.shape_user_data(shape)), (Ok((place, turn)), Ok(5)));
    world.set_shape_user_data(shape, 6).unwrap();
    assert_eq!(world.shape_user_data(shape), Ok(6));
    world.remove_shape(shape).unwrap();
    assert_eq!(world.body_of(shape), Err(Error::StaleShape));
    assert_eq!(world.shape_pose(shape), Err(Error::StaleShape));
}

/// The mass is that of a body that was made so; earlier values are forgotten.
#[test]
fn a_shape_that_changes_gives_its_body_the_mass_of_the_new_one() {
    let mut world = world();
    let place = Vec3::new(1.0, 0.5, 0.0);
    let changed = world.add_body(&BodyDesc::dynamic().with_shape(cube()).with_shape(ball())).unwrap();
    let shape = world.shapes(changed).unwrap().nth(1).unwrap();
    world.set_geometry(shape, Geometry::capsule(0.5, 0.25)).unwrap();
    world.set_density(shape, 500.0).unwrap();
    world.set_shape_pose(shape, place, Quat::from_rotation_z(0.7)).unwrap();
    let (at, turn) = world.shape_pose(shape).unwrap();
    assert!((at - place).length() < 1e-6 && turn.dot(Quat::from_rotation_z(0.7)).abs() > 0.999_999);
    let mut other = ShapeDesc::new(Geometry::capsule(0.5, 0.25));
    (other.density, other.position, other.rotation) = (500.0, place, Quat::from_rotation_z(0.7));
    let made = world.add_body(&BodyDesc::dynamic().with_shape(cube()).with_shape(other)).unwrap();
    let [one, two] = [changed, made].map(|body| world.mass_properties(body).unwrap());
    assert!((one.mass - two.mass).abs() < 1e-3 * two.mass, "{one:?} {two:?}");
    assert!((one.centre_of_mass - two.centre_of_mass).length() < 1e-5, "{one:?} {two:?}");
    assert!(one.inertia.abs_diff_eq(two.inertia, 1e-4 * two.mass), "{one:?} {two:?}");
    assert!(world.position(changed).unwrap().length() < 1e-6, "the origin stays");
}

#[test]
fn a_form_that_a_body_can_not_have_is_refused() {
    let mut world = world();
    let body = world.add_body(&BodyDesc::dynamic().with_shape(cube())).unwrap();
    let shape = world.shapes(body).unwrap().next().unwrap();
    let before = world.mass_properties(body);
    assert_eq!(world.set_geometry(shape, Geometry::Plane), Err(Error::StaticOnly { shape: "plane" }));
    assert!(world.set_geometry(shape, Geometry::Sphere { radius: -1.0 }).is_err());
    assert!(world.set_shape_pose(shape, Vec3::splat(f32::NAN), Quat::IDENTITY).is_err());
    assert!(world.set_shape_pose(shape, Vec3::ZERO, Quat::from_xyzw(0.0, 0.0, 0.0, 3.0)).is_err());
    assert_eq!(world.set_density(shape, 0.0), Err(Error::NoMass));
    assert!(world.set_density(shape, -1.0).is_err());
    assert_eq!(world.mass_properties(body), before);
}

/// A body on a shape falls onto it when it shrinks: from 0.5 to 0.2 above the ground.
#[test]
fn what_lies_on_a_shape_wakes_when_it_changes() {
    let mut world = world();
    let table = world.add_body(&BodyDesc::fixed().with_shape(cube())).unwrap();
    let body = world.add_body(&BodyDesc::dynamic().with_position(DVec3::Y).with_shape(cube())).unwrap();
    let shape = world.shapes(table).unwrap().next().unwrap();
    steps(&mut world, 120);
    assert_eq!(world.is_sleeping(body), Ok(true));
    world.set_geometry(shape, Geometry::cuboid(0.5, 0.2, 0.5)).unwrap();
    assert_eq!(world.is_sleeping(body), Ok(false));
    steps(&mut world, 120);
    assert!((world.position(body).unwrap().y - 0.7).abs() < 0.002, "{:?}", world.position(body));
    world.set_shape_pose(shape, Vec3::NEG_Y, Quat::IDENTITY).unwrap();
    steps(&mut world, 120);
    assert!((world.position(body).unwrap().y + 0.3).abs() < 0.002, "{:?}", world.position(body));
}

#[test]
fn boxes_are_around_shapes_where_they_are() {
    let mut world = world();
    // Far away, where a box in f32 would be off by 0.06.
    let far = DVec3::new(1e6 + 0.125, 0.0, -3.0);
    let mut arm = ball();
    arm.position = Vec3::X * 2.0;
    let body = BodyDesc::dynamic()
        .with_position(far)
        .with_rotation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2));
    let body = world.add_body(&body.with_shape(cube()).with_shape(arm)).unwrap();
    let all = world.aabb(body).unwrap().unwrap();
    // Turned by a right angle, the arm points up.
    assert!((all.min - far + DVec3::splat(0.5)).length() < 1e-5, "{all:?}");
    assert!((all.max - far - DVec3::new(0.5, 2.5, 0.5)).length() < 1e-5, "{all:?}");
    let arm = world.shapes(body).unwrap().nth(1).unwrap();
    let one = world.shape_aabb(arm).unwrap();
    assert!((one.centre() - far - DVec3::Y * 2.0).length() < 1e-5, "{one:?}");
    assert!((one.half_extents() - 0.5).length() < 1e-5, "{one:?}");
    assert!(all.contains(one.centre()) && all.overlaps(&one));
    let (at, _) = world.shape_world_pose(arm).unwrap();
    assert!((at - one.centre()).length() < 1e-5);
    let bare = world.add_body(&BodyDesc::kinematic()).unwrap();
    assert_eq!(world.aabb(bare), Ok(None));
    let plane = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane))).unwrap();
    assert!(!world.aabb(plane).unwrap().unwrap().max.is_finite());
}

/// v + ω × r, and its counterparts.
#[test]
fn forces_and_velocities_at_a_point() {
    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
    let mut add = |desc: BodyDesc| world.add_body(&desc.with_shape(cube())).unwrap();
    let [moved, at, apart, spun] =
        [0.0, 5.0, 10.0, 15.0].map(|x| add(BodyDesc::dynamic().with_position(DVec3::X * x)));
    world.set_linear_velocity(moved, Vec3::Y).unwrap();
    world.set_angular_velocity(moved, Vec3::Z * 2.0).unwrap();
    assert_eq!(world.velocity_at(moved, DVec3::X * 0.5), Ok(Vec3::new(0.0, 2.0, 0.0)));
    let (force, arm) = (Vec3::new(100.0, 50.0, 0.0), Vec3::new(0.0, 0.5, 0.5));
    world.add_force_at(at, force, DVec3::X * 5.0 + arm.as_dvec3()).unwrap();
    world.add_force_and_torque(apart, force, arm.cross(force)).unwrap();
    // 1000 kg m² / 6 about each axis.
    world.apply_angular_impulse(spun, Vec3::Y * 1000.0).unwrap();
    assert!((world.angular_velocity(spun).unwrap() - Vec3::Y * 6.0).length() < 1e-4);
    world.step(DT).unwrap();
    assert_eq!(world.linear_velocity(at), world.linear_velocity(apart));
    assert_eq!(world.angular_velocity(at), world.angular_velocity(apart));
    assert!(world.angular_velocity(at).unwrap() != Vec3::ZERO);
    assert!(world.add_force_at(at, force, DVec3::splat(f64::NAN)).is_err());
    assert!(world.apply_angular_impulse(spun, Vec3::splat(f32::MAX)).is_err());
    assert!(world.set_angular_velocity(spun, Vec3::splat(1e7)).is_err());
}

/// The impulses of a body at rest are its weight times the substep; the normal points away from the body
/// that is asked for.
#[test]
fn contacts_of_a_body_bear_its_weight() {
    let mut world = World::new(Settings::default()).unwrap();
    let ground = world.add_body(&Floor::Mesh.desc(Material::default())).unwrap();
    let body = world
        .add_body(&BodyDesc::dynamic().with_position(DVec3::new(0.3, 0.5, 0.2)).with_shape(cube()))
        .unwrap();
    let flying =
        world.add_body(&BodyDesc::dynamic().with_position(DVec3::Y * 50.0).with_shape(ball())).unwrap();
    steps(&mut world, 60);
    let weight = 1000.0 * 9.81 * DT / world.settings().substeps as f32;
    for (asked, other, normal) in [(body, ground, Vec3::NEG_Y), (ground, body, Vec3::Y)] {
        let mut sum = 0.0;
        for contact in world.contacts_of(asked).unwrap() {
            assert_eq!(contact.bodies, [asked, other]);
            assert_eq!(contact.shapes.map(|shape| world.body_of(shape).unwrap()), [asked, other]);
            assert!(contact.normal.dot(normal) > 0.999, "{contact:?}");
            assert!(!contact.points().is_empty());
            for point in contact.points() {
                assert!(point.position.y.abs() < 0.01 && point.separation.abs() < 0.01, "{point:?}");
                let side = point.position - DVec3::new(0.3, 0.0, 0.2);
                assert!(side.x.abs() < 0.51 && side.z.abs() < 0.51, "{point:?}");
            }
            sum += contact.impulse();
        }
        assert!((sum - weight).abs() < 0.02 * weight, "{sum} for {weight}");
    }
    assert_eq!(world.contacts_of(flying).unwrap().count(), 0);
    world.remove_body(flying).unwrap();
    assert!(world.contacts_of(flying).is_err());
}

/// A body that falls asleep moved in its last step: a renderer needs its place of rest.
#[test]
fn what_moved_is_told_up_to_the_last_step_before_sleep() {
    let mut world = world();
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane))).unwrap();
    let add = |world: &mut World, x: f64, y: f64| {
        world.add_body(&BodyDesc::dynamic().with_position(DVec3::new(x, y, 0.0)).with_shape(cube())).unwrap()
    };
    let bodies: Vec<BodyHandle> =
        (0..4).map(|i| add(&mut world, 3.0 * f64::from(i), 0.5 + f64::from(i))).collect();
    let still =
        world.add_body(&BodyDesc::kinematic().with_position(DVec3::Z * 9.0).with_shape(cube())).unwrap();
    let lift = BodyDesc::kinematic().with_position(DVec3::Z * 20.0).with_velocity(Vec3::Y * 0.1, Vec3::ZERO);
    let lift = world.add_body(&lift.with_shape(cube())).unwrap();
    assert_eq!(world.body_moves().count(), 0, "nothing has moved yet");
    let mut seen: Vec<DVec3> = bodies.iter().map(|&body| world.position(body).unwrap()).collect();
    let mut slept = 0;
    for step in 0..400 {
        world.step(DT).unwrap();
        let moved: Vec<BodyHandle> = world.body_moves().map(|moved| moved.body).collect();
        for told in world.body_moves() {
            let body = told.body;
            assert_eq!(Ok(told.position), world.position(body));
            assert_eq!(Ok(told.rotation), world.rotation(body));
            assert_eq!(Ok(told.centre_of_mass), world.centre_of_mass(body));
            assert_eq!(Ok(told.linear_velocity), world.linear_velocity(body));
            assert_eq!(Ok(told.angular_velocity), world.angular_velocity(body));
            assert_eq!(Ok(told.user_data), world.user_data(body));
            assert_eq!(Ok(told.fell_asleep), world.is_sleeping(body));
            slept += u32::from(told.fell_asleep);
        }
        assert_eq!(slept as usize, world.sleeping_body_count(), "each is told once that it fell asleep");
        for (&body, seen) in bodies.iter().zip(&mut seen) {
            let at = world.position(body).unwrap();
            if moved.contains(&body) {
                *seen = at;
            }
            assert_eq!(*seen, at, "step {step}: it moved and nobody was told");
        }
        assert!(moved.contains(&lift) && !moved.contains(&still));
        let awake: Vec<BodyHandle> = world.awake_bodies().collect();
        assert!(awake.iter().all(|body| moved.contains(body) && !world.is_sleeping(*body).unwrap()));
        assert_eq!(awake.len() + world.sleeping_body_count(), 4);
    }
    assert_eq!((world.sleeping_body_count(), world.body_moves().count()), (4, 1));
    world.wake(bodies[0]).unwrap();
    assert_eq!(world.awake_bodies().collect::<Vec<_>>(), [bodies[0]]);
}

/// Two balls and a lift on a floor. Expected: dynamic bodies before the kinematic one, and no static one; a
/// world at rest lists nothing; a body that is put elsewhere wakes and is listed; a restored world lists the
/// same bodies, with the same bits, after the same step.
#[test]
fn moves_are_told_in_order_after_a_pose_and_after_a_restore() {
    let mut world = world();
    let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane))).unwrap();
    let lift = BodyDesc::kinematic().with_position(DVec3::Z * 20.0).with_shape(cube()).with_user_data(3);
    let lift = world.add_body(&lift).unwrap();
    let ball = BodyDesc::dynamic().with_shape(ShapeDesc::new(Geometry::sphere(0.5)));
    let balls = [(1, 0.0), (2, 5.0)].map(|(data, x)| {
        let at = DVec3::new(x, 0.5, 0.0);
        world.add_body(&ball.clone().with_position(at).with_user_data(data)).unwrap()
    });
    let told = |world: &World| world.body_moves().map(|moved| moved.user_data).collect::<Vec<u64>>();
    world.move_kinematic(lift, DVec3::new(0.0, 0.1, 20.0), Quat::IDENTITY, DT).unwrap();
    world.step(DT).unwrap();
    assert_eq!(told(&world), [1, 2, 3]);
    world.set_velocity(lift, Vec3::ZERO, Vec3::ZERO).unwrap();
    steps(&mut world, 200);
    assert_eq!(told(&world), [0; 0], "all is at rest");

    world.set_pose(ground, DVec3::Y * -1.0, Quat::IDENTITY).unwrap();
    world.set_pose(balls[1], DVec3::new(5.0, 2.0, 0.0), Quat::IDENTITY).unwrap();
    let mut snapshot = Snapshot::new();
    world.snapshot(&mut snapshot);
    world.step(DT).unwrap();
    let moves: Vec<_> = world.body_moves().collect();
    assert!(moves.iter().any(|moved| moved.body == balls[1] && moved.position.y < 2.0));
    assert!(moves.iter().all(|moved| moved.body != ground && moved.body != lift));
    steps(&mut world, 100);
    world.restore(&snapshot).unwrap();
    world.step(DT).unwrap();
    assert_eq!(world.body_moves().collect::<Vec<_>>(), moves);
}

/// Expected: each contact is in the lists of both of its bodies, static ones too.
#[test]
fn contacts_of_the_world_are_those_of_its_bodies() {
    let mut world = world();
    world.add_body(&Floor::Mesh.desc(Material::default())).unwrap();
    for i in 0..300_u16 {
        let at = DVec3::new(f64::from(i % 8), 0.5 + f64::from(i / 64), f64::from(i / 8 % 8)) * 0.99;
        world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(cube())).unwrap();
    }
    for asleep in [false, true] {
        let mut count = 60;
        while asleep && world.bodies().any(|body| world.is_sleeping(body) == Ok(false)) && count < 600 {
            steps(&mut world, 10);
            count += 10;
        }
        steps(&mut world, if asleep { 0 } else { 60 });
        let all: Vec<_> = world.contacts().collect();
        let bodies: Vec<BodyHandle> = world.bodies().collect();
        let start = std::time::Instant::now();
        let one_by_one: usize = bodies.iter().map(|&body| world.contacts_of(body).unwrap().count()).sum();
        let each = start.elapsed() / bodies.len() as u32;
        println!("{} contacts, asleep {asleep}: {each:?} to ask for those of one body", all.len());
        assert_eq!(one_by_one, 2 * all.len());
        assert!(all.len() > 300);
        for contact in all.iter().step_by(50) {
            let [a, b] = contact.bodies;
            assert!(world.contacts_of(a).unwrap().any(|own| own == *contact));
            let turned = [contact.shapes[1], contact.shapes[0]];
            assert!(world.contacts_of(b).unwrap().any(|own| own.shapes == turned));
        }
    }
}

/// The contacts of a body, by a search through [`World::contacts`].
fn looked_through(world: &World, body: BodyHandle) -> Vec<BodyContact> {
    world.contacts().filter(|contact| contact.bodies.contains(&body)).collect()
}

/// Expected: the list of a look through all contacts of the world, in the same order, for each body after
/// whatever happens between two questions: steps, removed and added and moved bodies, sleep, waking, a
/// snapshot, a plane, a floor with more neighbours than are looked up one by one, and fast bodies.
#[test]
fn contacts_of_a_body_are_those_of_the_whole_list() {
    for plane in [false, true] {
        let mut world = world();
        world.add_body(&if plane { Floor::Plane } else { Floor::Mesh }.desc(Material::default())).unwrap();
        let mut random = Random(11);
        for i in 0..200_u16 {
            let at = DVec3::new(f64::from(i % 6), 1.0 + f64::from(i / 36), f64::from(i / 6 % 6)) * 1.01;
            let body =
                BodyDesc::dynamic().with_position(at).with_shape(if i % 3 == 0 { ball() } else { cube() });
            let body = if i % 7 == 0 { body.with_shape(ball().with_position(Vec3::X * 0.8)) } else { body };
            world.add_body(&body).unwrap();
        }
        let lift = BodyDesc::kinematic()
            .with_position(DVec3::new(3.0, 0.5, -2.0))
            .with_velocity(Vec3::Z * 0.2, Vec3::ZERO);
        world.add_body(&lift.with_shape(cube())).unwrap();
        let (mut most, mut slept) = (0, false);
        for round in 0..60 {
            steps(&mut world, if round < 40 { 5 } else { 25 });
            let bodies: Vec<BodyHandle> = world.bodies().collect();
            let some = random.of(&bodies);
            match round % 8 {
                _ if round >= 40 => {}
                1 => world.remove_body(some).unwrap(),
                2 if world.kind(some) == Ok(BodyKind::Dynamic) => {
                    world.set_pose(some, DVec3::new(2.0, 1.0, 2.0), glam::Quat::IDENTITY).unwrap();
                }
                3 => {
                    let shot = BodyDesc::dynamic().with_position(DVec3::new(-9.0, 1.0, 3.0));
                    world
                        .add_body(&shot.with_velocity(Vec3::X * 80.0, Vec3::ZERO).with_shape(ball()))
                        .unwrap();
                }
                5 => {
                    let mut snapshot = Snapshot::new();
                    world.snapshot(&mut snapshot);
                    world.restore(&snapshot).unwrap();
                }
                6 => world.wake(some).unwrap(),
                _ => {}
            }
            for body in world.bodies().collect::<Vec<_>>() {
                slept |= world.is_sleeping(body) == Ok(true);
                let mut own: Vec<BodyContact> = world.contacts_of(body).unwrap().collect();
                most = most.max(own.len());
                assert!(own.iter().all(|contact| contact.bodies[0] == body));
                let all = looked_through(&world, body);
                for (contact, listed) in own.iter_mut().zip(&all) {
                    if contact.bodies != listed.bodies {
                        contact.bodies.reverse();
                        contact.shapes.reverse();
                        contact.normal = -contact.normal;
                    }
                }
                assert_eq!(own, all, "round {round}");
            }
        }
        assert!(most > 30 && slept, "{most} contacts of one body");
    }
}

/// Expected: a contact for each box on the floor, and for each that lies on another one a contact of both;
/// prints the time of one body (`--nocapture`).
#[test]
fn contacts_of_one_body_among_many() {
    let mut world = world();
    let floor = ShapeDesc::new(Geometry::cuboid(200.0, 1.0, 200.0));
    world.add_body(&BodyDesc::fixed().with_position(DVec3::NEG_Y).with_shape(floor)).unwrap();
    let boxes: Vec<BodyHandle> = (0..2000_u16)
        .map(|i| {
            let at =
                DVec3::new(f64::from(i % 40) * 1.5, 0.5 + f64::from(i / 1600), f64::from(i / 40 % 40) * 1.5);
            world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(cube())).unwrap()
        })
        .collect();
    steps(&mut world, 20);
    for _ in 0..3 {
        let start = std::time::Instant::now();
        let found: usize = boxes.iter().map(|&body| world.contacts_of(body).unwrap().count()).sum();
        println!("{:?} to ask for the contacts of one body", start.elapsed() / boxes.len() as u32);
        assert_eq!(found, 1600 + 2 * 400);
    }
}
