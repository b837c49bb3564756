//! Contacts and sensors are heard of, once each, however fast; hooks change contacts before they are solved.

use crate::common;

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Category, ContactHook, ContactHooks, Error, FrictionModel, Geometry, Material,
    QueryFilter, Ray, Settings, ShapeDesc, ShapeHandle, TriangleMesh, World,
};
use backstop_scene::builtin;
use std::collections::BTreeMap;
use std::sync::Arc;

const DT: f32 = 1.0 / 60.0;

fn cube() -> ShapeDesc {
    ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5))
}

fn ball(radius: f32) -> ShapeDesc {
    ShapeDesc::new(Geometry::Sphere { radius })
}

fn weightless() -> World {
    World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap()
}

fn shape(world: &World, body: BodyHandle) -> ShapeHandle {
    world.shapes(body).unwrap().next().unwrap()
}

fn add(world: &mut World, at: DVec3, shape: ShapeDesc) -> BodyHandle {
    world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(shape)).unwrap()
}

fn fixed(world: &mut World, at: DVec3, shape: ShapeDesc) -> BodyHandle {
    world.add_body(&BodyDesc::fixed().with_position(at).with_shape(shape)).unwrap()
}

/// How a cube lands that falls by 5 m: speed by energy, impulse by momentum.
#[test]
fn who_lands_is_heard_of_once_with_its_speed_and_impulse() {
    for per_point in [false, true] {
        let friction_model = [FrictionModel::Patch, FrictionModel::Point][usize::from(per_point)];
        // Above the speed of an edge that comes down second.
        let settings = Settings::default().with_friction_model(friction_model).with_hit_speed(2.0);
        let mut world = World::new(settings).unwrap();
        let floor = fixed(&mut world, DVec3::ZERO, ShapeDesc::new(Geometry::Plane));
        let body = add(&mut world, DVec3::Y * 5.5, cube().with_events());
        let (mut begins, mut hits, mut ends) = (Vec::new(), Vec::new(), 0);
        for _ in 0..180 {
            world.step(DT).unwrap();
            begins.extend_from_slice(world.contact_begins());
            hits.extend_from_slice(world.contact_hits());
            ends += world.contact_ends().len();
        }
        assert_eq!((begins.len(), hits.len(), ends), (1, 1, 0), "{begins:?} {hits:?}");
        let (speed, mass) = ((2.0 * 9.81 * 5.0_f32).sqrt(), 1000.0);
        let hit = hits[0];
        assert!((hit.approach_speed - speed).abs() < 9.81 * DT, "{hit:?}");
        assert!((hit.impulse / (mass * speed) - 1.0).abs() < 0.02, "{hit:?}");
        assert_eq!(hit.shapes, [shape(&world, floor), shape(&world, body)]);
        assert_eq!(hit.bodies, [floor, body]);
        assert!(hit.normal.distance(Vec3::Y) < 1e-3 && hit.point.y.abs() < 0.3, "{hit:?}");
        // Lifted, it no longer touches; put back, it begins anew; removed, it ends.
        let back = world.position(body).unwrap();
        world.set_pose(body, DVec3::Y * 9.0, Quat::IDENTITY).unwrap();
        world.set_velocity(body, Vec3::ZERO, Vec3::ZERO).unwrap();
        world.step(DT).unwrap();
        assert_eq!((world.contact_begins().len(), world.contact_ends().len()), (0, 1));
        world.set_pose(body, back, Quat::IDENTITY).unwrap();
        world.step(DT).unwrap();
        assert_eq!((world.contact_begins().len(), world.contact_ends().len()), (1, 0));
        let gone = shape(&world, body);
        world.remove_body(body).unwrap();
        world.step(DT).unwrap();
        assert_eq!(world.contact_ends()[0].shapes, [shape(&world, floor), gone]);
        world.step(DT).unwrap();
        assert!(world.contact_ends().is_empty());
    }
}

/// A shape that loses its events gets no end, not even when it is removed; with events again it gets a begin.
#[test]
fn a_shape_may_listen_now_and_then() {
    let mut world = World::new(Settings::default().with_sleeping(true)).unwrap();
    fixed(&mut world, DVec3::ZERO, ShapeDesc::new(Geometry::Plane));
    let body = add(&mut world, DVec3::Y * 0.5, cube());
    let shape = shape(&world, body);
    let heard = |world: &mut World, steps: u32| {
        let (mut begins, mut ends) = (0, 0);
        for _ in 0..steps {
            world.step(DT).unwrap();
            (begins, ends) = (begins + world.contact_begins().len(), ends + world.contact_ends().len());
        }
        (begins, ends)
    };
    assert_eq!(heard(&mut world, 10), (0, 0));
    for wait in [10, 120] {
        world.set_events(shape, true).unwrap();
        world.wake(body).unwrap();
        assert_eq!(heard(&mut world, wait), (1, 0));
        assert_eq!(world.is_sleeping(body).unwrap(), wait == 120);
        world.set_events(shape, false).unwrap();
        assert_eq!(heard(&mut world, 10), (0, 0));
    }
    world.remove_body(body).unwrap();
    assert_eq!(heard(&mut world, 2), (0, 0));
}

/// A ball of 0.1 m at 300 m/s, 5 m a step, bounces off a mesh without thickness.
#[test]
fn who_is_fast_is_heard_of_when_it_strikes_and_when_it_is_off_again() {
    let mut world = weightless();
    let corners = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]].map(|[y, z]| Vec3::new(0.0, y, z));
    let wall = TriangleMesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let material = Material::default().with_friction(0.0).with_restitution(1.0);
    let wall = ShapeDesc::new(Geometry::Mesh(Arc::new(wall))).with_material(material);
    let wall = fixed(&mut world, DVec3::ZERO, wall);
    let bullet = ball(0.1).with_events().with_material(material);
    let bullet = BodyDesc::dynamic().with_position(DVec3::NEG_X * 33.0).with_shape(bullet);
    let bullet = world.add_body(&bullet.with_velocity(Vec3::X * 300.0, Vec3::ZERO)).unwrap();
    let mass = world.mass(bullet).unwrap();
    let (mut begins, mut hits, mut ends) = (Vec::new(), Vec::new(), Vec::new());
    for step in 0..20 {
        world.step(DT).unwrap();
        begins.extend(world.contact_begins().iter().map(|&event| (step, event)));
        hits.extend(world.contact_hits().iter().map(|&event| (step, event)));
        ends.extend(world.contact_ends().iter().map(|event| (step, event.shapes)));
    }
    assert_eq!((begins.len(), ends.len()), (1, 1), "{begins:?} {ends:?}");
    let (step, hit) = hits[0];
    // 32.9 m at 5 m a step.
    assert_eq!((step, begins[0].0), (6, 6));
    assert!(hit.normal.x.abs() > 0.999 && (hit.approach_speed - 300.0).abs() < 0.01, "{hit:?}");
    // (1 + e) m v: it is stopped and sent back in the one step.
    assert!((hit.impulse / (mass * 300.0) - 2.0).abs() < 1e-3, "{hit:?}");
    assert_eq!(ends[0].1, [shape(&world, wall), shape(&world, bullet)]);
    assert!(world.linear_velocity(bullet).unwrap().x < -299.0);
}

#[test]
fn listening_changes_nothing_and_not_to_listen_takes_no_bytes() {
    let mut scene = builtin::pile();
    scene.bodies.truncate(200);
    let run = |listen: bool| {
        let mut scene = scene.clone();
        let shapes = scene.bodies.iter_mut().flat_map(|body| &mut body.desc.shapes);
        shapes.for_each(|shape| shape.events = listen);
        let (mut world, _) = common::world_of(&scene, Settings::default());
        let (mut begins, mut ends) = (0, 0);
        for _ in 0..300 {
            world.step(DT).unwrap();
            begins += world.contact_begins().len();
            ends += world.contact_ends().len();
        }
        (world.state_hash(), begins, ends, world.memory().category(Category::Events).reserved)
    };
    let (deaf, heard) = (run(false), run(true));
    println!("{heard:?}");
    assert_eq!((deaf.1, deaf.2, deaf.3), (0, 0, 0));
    assert_eq!(deaf.0, heard.0);
    // Each body touches something in the end.
    assert!(heard.1 > 200 && heard.1 > heard.2 + 100);
}

#[test]
fn what_there_is_no_place_for_is_counted() {
    let settings = Settings::default().with_event_capacity(3);
    let mut world = World::new(settings).unwrap();
    fixed(&mut world, DVec3::ZERO, ShapeDesc::new(Geometry::Plane).with_events());
    for i in 0..10 {
        add(&mut world, DVec3::new(f64::from(i) * 2.0, 0.5, 0.0), cube());
    }
    world.step(DT).unwrap();
    assert_eq!((world.contact_begins().len(), world.report().events_lost), (3, 7));
}

/// Two thousand balls at 50 to 500 m/s, each through a hundred sensors of 1 cm, of every convex shape: some
/// cross ninety in a step.
#[test]
fn every_crossing_of_a_sensor_is_reported_once() {
    for threads in [1, 2] {
        let settings =
            Settings::default().with_gravity(Vec3::ZERO).with_event_capacity(1 << 20).with_threads(threads);
        let mut world = World::new(settings).unwrap();
        let sensors: BTreeMap<ShapeHandle, f64> = (0..100)
            .map(|i| {
                let x = 10.0 + f64::from(i) * 0.1;
                let geometry = match i % 3 {
                    0 => Geometry::cuboid(0.005, 60.0, 60.0),
                    1 => Geometry::Cylinder { half_height: 0.005, radius_bottom: 90.0, radius_top: 90.0 },
                    _ => Geometry::cuboid(0.02, 50.0, 50.0),
                };
                // The axis of a cylinder is y.
                let turn = if i % 3 == 1 { Quat::from_rotation_z(-1.570_796_4) } else { Quat::IDENTITY };
                let desc = BodyDesc::fixed().with_position(DVec3::X * x).with_rotation(turn);
                let body = world.add_body(&desc.with_shape(ShapeDesc::new(geometry).as_sensor())).unwrap();
                (shape(&world, body), x)
            })
            .collect();
        let descs: Vec<BodyDesc> = (0..2000)
            .map(|i| {
                let at = DVec3::new(0.0, f64::from(i % 50) - 25.0, f64::from(i / 50) - 20.0);
                let speed = 50.0 + 450.0 * (i * 7 % 2000) as f32 / 2000.0;
                let body = BodyDesc::dynamic().with_position(at).with_shape(ball(0.05));
                body.with_velocity(Vec3::X * speed, Vec3::Y * 20.0)
            })
            .collect();
        let balls = world.add_bodies(&descs).unwrap();
        let mut seen: BTreeMap<(ShapeHandle, ShapeHandle), [u32; 2]> = BTreeMap::new();
        for _ in 0..40 {
            let before: Vec<f64> = balls.iter().map(|&b| world.position(b).unwrap().x).collect();
            world.step(DT).unwrap();
            assert_eq!(world.report().events_lost, 0);
            for event in world.sensor_begins() {
                seen.entry((event.sensor, event.visitor)).or_default()[0] += 1;
                assert!((0.0..=1.0).contains(&event.fraction));
            }
            for event in world.sensor_ends() {
                seen.entry((event.sensor, event.visitor)).or_default()[1] += 1;
            }
            // When it came: with its surface at that of the sensor.
            if let Some(event) = world.sensor_begins().first() {
                let i = balls.iter().position(|&b| shape(&world, b) == event.visitor).unwrap();
                let now = world.position(balls[i]).unwrap().x;
                let at = before[i] + (now - before[i]) * f64::from(event.fraction);
                assert!((sensors[&event.sensor] - at - 0.06).abs() < 0.02, "{event:?}: {at}");
            }
        }
        assert!(balls.iter().all(|&b| world.position(b).unwrap().x > 21.0));
        assert_eq!(seen.len(), 200_000);
        assert!(seen.values().all(|&counts| counts == [1, 1]));
        // They push nothing.
        assert!(world.linear_velocity(balls[0]).unwrap() == Vec3::X * 50.0);
    }
}

#[test]
fn a_sensor_knows_who_is_in_it() {
    let settings = Settings::default().with_sleeping(true);
    let mut world = World::new(settings).unwrap();
    fixed(&mut world, DVec3::ZERO, ShapeDesc::new(Geometry::Plane));
    let sensor = fixed(&mut world, DVec3::Y, ShapeDesc::new(Geometry::cuboid(2.0, 2.0, 2.0)).as_sensor());
    let sensor = shape(&world, sensor);
    let inside = |world: &World| {
        let mut all = Vec::new();
        world.sensor_overlaps(sensor, &mut all).unwrap();
        all
    };
    let (one, other) = (add(&mut world, DVec3::Y * 4.0, cube()), add(&mut world, DVec3::Y * 0.5, cube()));
    let [a, b] = [one, other].map(|body| shape(&world, body));
    world.step(DT).unwrap();
    assert_eq!((world.sensor_begins().len(), inside(&world)), (1, vec![b]));
    let mut begins = 0;
    for _ in 0..120 {
        world.step(DT).unwrap();
        begins += world.sensor_begins().len();
        assert!(world.sensor_ends().is_empty());
    }
    assert_eq!((begins, inside(&world)), (1, vec![a.min(b), a.max(b)]));
    // Asleep they are still there, and come to no end when they wake.
    for _ in 0..120 {
        world.step(DT).unwrap();
    }
    assert!(world.is_sleeping(one).unwrap() && inside(&world).len() == 2);
    world.wake(one).unwrap();
    world.step(DT).unwrap();
    assert!(world.sensor_begins().is_empty() && world.sensor_ends().is_empty());
    // One walks out, one is removed.
    world.set_pose(one, DVec3::new(20.0, 1.0, 0.0), Quat::IDENTITY).unwrap();
    world.step(DT).unwrap();
    assert_eq!((world.sensor_ends().len(), inside(&world)), (1, vec![b]));
    world.remove_body(other).unwrap();
    world.step(DT).unwrap();
    assert_eq!((world.sensor_ends().len(), inside(&world).len()), (1, 0));
    // A shape that becomes a sensor lets go of the bodies on it; one that is solid again bears.
    let floor = fixed(&mut world, DVec3::new(20.0, -1.0, 0.0), cube());
    let floor = shape(&world, floor);
    assert!(world.set_sensor(floor, true).is_ok() && world.set_sensor(floor, false).is_ok());
    let mesh = TriangleMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Z], vec![[0, 1, 2]]).unwrap();
    let mesh = ShapeDesc::new(Geometry::Mesh(Arc::new(mesh)));
    let body = fixed(&mut world, DVec3::X * 90.0, mesh.clone());
    let stale = shape(&world, body);
    assert!(world.set_sensor(stale, true).is_err());
    assert!(world.add_body(&BodyDesc::fixed().with_shape(mesh.as_sensor())).is_err());
    world.remove_body(body).unwrap();
    assert!(matches!(world.set_sensor(stale, false), Err(Error::StaleShape)));
    assert!(matches!(world.set_events(stale, true), Err(Error::StaleShape)));
}

/// A sensor on a body that moves past others, and around a small body that the guard watches over.
#[test]
fn a_sensor_may_be_on_a_body_that_moves() {
    let mut world = weightless();
    let post = add(&mut world, DVec3::X * 5.0, cube());
    let wall =
        fixed(&mut world, DVec3::new(12.0, 0.0, 0.0), ShapeDesc::new(Geometry::cuboid(0.01, 9.0, 9.0)));
    let scout = BodyDesc::dynamic().with_position(DVec3::Y * 1.0).with_shape(ball(0.1));
    let scout = ball(2.0).as_sensor().with_density(0.0).into_body(scout);
    let scout = world.add_body(&scout.with_velocity(Vec3::X * 200.0, Vec3::ZERO)).unwrap();
    let (mut begins, mut ends) = (Vec::new(), Vec::new());
    for _ in 0..30 {
        world.step(DT).unwrap();
        begins.extend(world.sensor_begins().iter().map(|event| event.visitor));
        ends.extend(world.sensor_ends().iter().map(|event| event.visitor));
    }
    // The wall is static and not noticed, but it stops the ball.
    assert_eq!((begins, ends), (vec![shape(&world, post)], vec![shape(&world, post)]));
    assert!(world.position(scout).unwrap().x < world.position(wall).unwrap().x);
}

trait IntoBody {
    fn into_body(self, body: BodyDesc) -> BodyDesc;
}

impl IntoBody for ShapeDesc {
    fn into_body(self, body: BodyDesc) -> BodyDesc {
        body.with_shape(self)
    }
}

/// Lets bodies through that are below, or come from there.
struct OneWay {
    platform: ShapeHandle,
    /// Height of a standing body above the platform itself [m].
    height: f64,
}

impl ContactHooks for OneWay {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        let Some(side) = contact.side_of(self.platform) else { return };
        let (world, other) = (contact.world(), contact.bodies()[1 - side]);
        let own = world.position(contact.bodies()[side]).unwrap();
        let rises = world.linear_velocity(other).unwrap().y > 0.01;
        if rises || world.position(other).unwrap().y < own.y + self.height - 0.05 {
            contact.veto();
        }
    }
}

/// A cube thrown up through a platform lands on it: slowly, and so fast that it passes it within a step.
#[test]
fn a_platform_may_be_passed_from_below() {
    for (speed, thickness) in [(8.0, 0.1), (60.0, 0.1), (60.0, 0.01)] {
        let mut world = World::new(Settings::default()).unwrap();
        let plate = ShapeDesc::new(Geometry::cuboid(3.0, thickness, 3.0)).with_hooks();
        let platform = fixed(&mut world, DVec3::Y * 2.0, plate);
        let body = BodyDesc::dynamic().with_position(DVec3::Y * 0.6).with_shape(cube());
        let body = world.add_body(&body.with_velocity(Vec3::Y * speed, Vec3::ZERO)).unwrap();
        let hooks = OneWay { platform: shape(&world, platform), height: 0.5 + f64::from(thickness) };
        let mut highest = 0.0_f64;
        for _ in 0..900 {
            world.step_with(DT, &hooks).unwrap();
            highest = highest.max(world.position(body).unwrap().y);
        }
        let rise = 0.6 + f64::from(speed * speed) / (2.0 * 9.81);
        assert!((highest / rise - 1.0).abs() < 0.02, "{speed}: {highest} of {rise}");
        let rest = 2.0 + f64::from(thickness) + 0.5;
        assert!(
            (world.position(body).unwrap().y - rest).abs() < 0.01,
            "{speed}: {}",
            world.position(body).unwrap()
        );
    }
}

/// A belt that runs at 2 m/s along x.
struct Belt {
    belt: ShapeHandle,
}

impl ContactHooks for Belt {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        if let Some(side) = contact.side_of(self.belt) {
            contact.set_surface_velocity(side, Vec3::X * 2.0).unwrap();
        }
    }
}

/// Friction brings a cube to the belt's speed within v / (mu g), and leaves it there, without a turn; as many
/// on a belt as fill lanes, and on a belt that can move itself.
#[test]
fn a_belt_carries_what_is_on_it() {
    for points in [false, true] {
        let friction_model = [FrictionModel::Patch, FrictionModel::Point][usize::from(points)];
        let mut world = World::new(Settings::default().with_friction_model(friction_model)).unwrap();
        let belt = ShapeDesc::new(Geometry::cuboid(100.0, 0.5, 20.0)).with_hooks();
        let belt = fixed(&mut world, DVec3::Y * -0.5, belt);
        let cubes: Vec<BodyHandle> = (0..11)
            .map(|i| add(&mut world, DVec3::new(0.0, 0.5, f64::from(i) * 1.5 - 8.0), cube()))
            .collect();
        let beside =
            fixed(&mut world, DVec3::new(0.0, -0.5, 40.0), ShapeDesc::new(Geometry::cuboid(9.0, 0.5, 9.0)));
        let still = add(&mut world, DVec3::new(0.0, 0.5, 40.0), cube());
        assert!(world.contains(beside));
        let hooks = Belt { belt: shape(&world, belt) };
        let run = |world: &mut World, seconds: f32| {
            for _ in 0..(seconds / DT).round() as u32 {
                world.step_with(DT, &hooks).unwrap();
            }
        };
        // Half of the time that it takes: half of the speed, by Coulomb's law.
        run(&mut world, 1.0 / (0.6 * 9.81));
        for &cube in &cubes {
            let v = world.linear_velocity(cube).unwrap();
            assert!((v.x - 1.0).abs() < 0.1, "{v}");
        }
        run(&mut world, 2.0);
        for &cube in &cubes {
            let (v, w) = (world.linear_velocity(cube).unwrap(), world.angular_velocity(cube).unwrap());
            assert!(v.distance(Vec3::X * 2.0) < 0.01 && w.length() < 0.01, "{v} {w}");
        }
        assert!(world.position(still).unwrap().x.abs() < 1e-3);
        // Without the hooks it stands still again.
        for _ in 0..120 {
            world.step(DT).unwrap();
        }
        assert!(world.linear_velocity(cubes[0]).unwrap().length() < 0.01);
    }
}

/// By the hook, with any materials: ice, glue, and a trampoline.
struct Ground {
    friction: f32,
    restitution: f32,
}

impl ContactHooks for Ground {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        contact.set_friction(self.friction, self.friction).unwrap();
        contact.set_restitution(self.restitution).unwrap();
        assert!(contact.set_friction(-1.0, 0.0).is_err() && contact.set_restitution(f32::NAN).is_err());
        assert!(contact.set_surface_velocity(0, Vec3::NAN).is_err());
        assert!(contact.set_surface_velocity(2, Vec3::X).is_err());
        assert_eq!(contact.user_data(), [7, 0]);
        assert!(contact.points().all(|(at, apart)| at.is_finite() && apart < 5.0));
        if contact.approach_speed() > 1.0 {
            let estimate = contact.estimated_impulse();
            assert!(estimate > 0.0 && estimate.is_finite());
        }
    }
}

#[test]
fn hooks_change_friction_and_restitution() {
    let slide = |friction: f32| {
        let mut world = World::new(Settings::default()).unwrap();
        let plane = ShapeDesc::new(Geometry::Plane).with_user_data(0);
        fixed(&mut world, DVec3::ZERO, plane);
        let body = cube().with_hooks().with_user_data(7);
        let body = BodyDesc::dynamic().with_position(DVec3::Y * 0.5).with_shape(body);
        let body = world.add_body(&body.with_velocity(Vec3::X * 4.0, Vec3::ZERO)).unwrap();
        for _ in 0..240 {
            world.step_with(DT, &Ground { friction, restitution: 0.0 }).unwrap();
        }
        world.position(body).unwrap().x
    };
    // v² / (2 mu g), and a body that nothing stops.
    for friction in [0.2_f32, 0.5] {
        let way = f64::from(16.0 / (2.0 * friction * 9.81));
        assert!((slide(friction) / way - 1.0).abs() < 0.05, "{friction}: {} of {way}", slide(friction));
    }
    assert!((slide(0.0) - 16.0).abs() < 0.01);
    let bounce = |restitution: f32| {
        let mut world = World::new(Settings::default()).unwrap();
        fixed(&mut world, DVec3::ZERO, ShapeDesc::new(Geometry::Plane));
        let body = ball(0.5).with_hooks().with_user_data(7);
        let body = add(&mut world, DVec3::Y * 5.5, body);
        let (mut highest, mut landed) = (0.0_f64, false);
        for _ in 0..150 {
            world.step_with(DT, &Ground { friction: 0.0, restitution }).unwrap();
            let v = world.linear_velocity(body).unwrap();
            landed |= v.y > 0.1;
            if landed {
                highest = highest.max(world.position(body).unwrap().y - 0.5);
            }
        }
        highest
    };
    // e² of the height.
    assert!((bounce(0.8) / (0.64 * 5.0) - 1.0).abs() < 0.03, "{}", bounce(0.8));
    assert!(bounce(0.0) < 0.01);
}

/// Asks the world in the middle of the step.
struct Asks;

impl ContactHooks for Asks {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        let ray = Ray::between(DVec3::Y * 20.0, DVec3::Y * -1.0);
        assert!(contact.world().cast_ray(&ray, &QueryFilter::only_dynamic()).unwrap().is_some());
    }
}

/// Queries by a hook see bodies at the start of a step, and queries after the step see their later places.
#[test]
fn a_query_in_a_hook_leaves_none_behind_that_is_out_of_date() {
    let mut world = World::new(Settings::default()).unwrap();
    fixed(&mut world, DVec3::ZERO, ShapeDesc::new(Geometry::Plane));
    let body = BodyDesc::dynamic().with_position(DVec3::Y * 3.5).with_shape(cube().with_hooks());
    let body = world.add_body(&body.with_velocity(Vec3::Y * -120.0, Vec3::ZERO)).unwrap();
    for _ in 0..10 {
        world.step_with(DT, &Asks).unwrap();
        // Through where it is, and past where it was.
        let at = world.position(body).unwrap();
        let ray = Ray::between(at - DVec3::X * 9.0, at + DVec3::X * 9.0);
        let hit = world.cast_ray(&ray, &QueryFilter::only_dynamic()).unwrap();
        assert!(hit.is_some_and(|hit| (hit.point.x + 0.5).abs() < 1e-3), "{at}: {hit:?}");
    }
}
