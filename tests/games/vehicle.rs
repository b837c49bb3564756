//! Vehicles against what their numbers say.

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::vehicle::{AntiRollBar, Controls, Vehicle, VehicleDesc, WheelKind};
use backstop::{BodyDesc, BodyHandle, Geometry, MassProperties, Material, Settings, ShapeDesc, World};

const MASS: f32 = 1200.0;
const G: f32 = 9.81;
const KINDS: [WheelKind; 3] = [WheelKind::Ray, WheelKind::Sphere, WheelKind::Body];

/// A car on a plane that rises towards +z by an angle [rad].
fn car_on(slope: f32, change: impl Fn(VehicleDesc) -> VehicleDesc) -> (World, Vehicle) {
    let mut world = World::new(Settings::default()).unwrap();
    let rotation = Quat::from_rotation_x(-slope);
    let ground = ShapeDesc::new(Geometry::Plane).with_material(Material::default().with_friction(1.0));
    world.add_body(&BodyDesc::fixed().with_rotation(rotation).with_shape(ground)).unwrap();
    let chassis = add_chassis(&mut world, (rotation * (Vec3::Y * 0.75)).as_dvec3(), rotation);
    let desc = change(VehicleDesc::car(Vec3::Y * -0.2, [0.8, 1.3], MASS));
    let car = Vehicle::new(&mut world, chassis, &desc).unwrap();
    (world, car)
}

fn add_chassis(world: &mut World, at: DVec3, rotation: Quat) -> BodyHandle {
    let hull = Geometry::cuboid(0.8, 0.3, 2.0);
    let mass = MassProperties::of(&hull, 1.0).scaled_to(MASS);
    let hull = ShapeDesc::new(hull).with_position(Vec3::Y * 0.35);
    let chassis = BodyDesc::dynamic().with_position(at).with_rotation(rotation);
    world.add_body(&chassis.with_shape(hull).with_mass(mass)).unwrap()
}

fn drive(world: &mut World, car: &mut Vehicle, seconds: f32, rate: u32, controls: Controls) {
    let dt = 1.0 / rate as f32;
    for _ in 0..(seconds * rate as f32) as u32 {
        car.update(world, dt, &controls).unwrap();
        world.step(dt).unwrap();
    }
}

/// Straight on at a speed [m/s], wheels and all.
fn launch(world: &mut World, car: &Vehicle, speed: f32) {
    let all: Vec<BodyHandle> = world.bodies().collect();
    for body in all {
        world.set_linear_velocity(body, Vec3::Z * speed).unwrap();
    }
    for wheel in car.wheel_bodies() {
        world.set_angular_velocity(wheel, Vec3::X * (speed / 0.35)).unwrap();
    }
}

fn idle() -> Controls {
    Controls::default()
}

fn at(world: &World, car: &Vehicle) -> DVec3 {
    world.position(car.chassis()).unwrap()
}

/// Expected: the springs bear the weight, and with the hand brake the car stays within a millimetre, on
/// wheels of bodies within two, for a minute on a slope of 20 %, the right way up.
#[test]
fn it_stands_on_a_slope_with_the_hand_brake() {
    for kind in KINDS {
        for rate in [30, 60, 120] {
            let slope = 0.2_f32.atan();
            let (mut world, mut car) = car_on(slope, |desc| desc.with_wheel_kind(kind));
            let brake = Controls { hand_brake: 1.0, ..idle() };
            drive(&mut world, &mut car, 3.0, rate, brake);
            let (start, load) = (at(&world, &car), car.wheels().iter().map(|w| w.contact.unwrap().load));
            let (load, weight) = (load.sum::<f32>(), MASS * G * libm::cosf(slope));
            assert!((load - weight).abs() < 0.1 * weight, "{kind:?} {rate}: {load} N of {weight} N");
            drive(&mut world, &mut car, 60.0, rate, brake);
            let creep = at(&world, &car).distance(start);
            let most = if kind == WheelKind::Body { 2e-3 } else { 1e-3 };
            assert!(creep < most, "{kind:?} at {rate} Hz: {creep} m");
            assert!((world.rotation(car.chassis()).unwrap() * Vec3::Y).y > 0.97);
        }
    }
}

/// Expected: where `torque * ratio / radius = drag v^2`.
#[test]
fn the_top_speed_follows_from_torque_and_drag() {
    for rate in [30, 60, 120] {
        let (mut world, mut car) = car_on(0.0, |mut desc| {
            desc.engine.torque = vec![[0.0, 100.0], [9000.0, 100.0]];
            desc.gearbox.ratios = vec![1.0];
            desc.gearbox.final_drive = 5.0;
            desc.wheels.iter_mut().for_each(|wheel| wheel.rolling_resistance = 0.0);
            desc.with_drag(2.0)
        });
        drive(&mut world, &mut car, 60.0, rate, Controls { throttle: 1.0, ..idle() });
        let (speed, expected) = (car.speed(&world).unwrap(), (100.0_f32 * 5.0 / 0.35 / 2.0).sqrt());
        assert!((speed - expected).abs() < 0.03 * expected, "{rate} Hz: {speed}, not {expected} m/s");
        let rpm = speed / 0.35 * 5.0 * 60.0 / std::f32::consts::TAU;
        assert!((car.rpm() - rpm).abs() < 0.03 * rpm, "{} of {rpm} rpm", car.rpm());
    }
}

/// Expected: `v^2 / (2 mu g)` within 10 %, straight on.
#[test]
fn it_brakes_as_friction_allows() {
    for kind in [WheelKind::Ray, WheelKind::Sphere] {
        for rate in [30, 60, 120] {
            let (mut world, mut car) = car_on(0.0, |mut desc| {
                desc.wheels.iter_mut().for_each(|wheel| wheel.brake = 1e4);
                desc.with_wheel_kind(kind).with_drag(0.0)
            });
            drive(&mut world, &mut car, 2.0, rate, idle());
            launch(&mut world, &car, 25.0);
            drive(&mut world, &mut car, 0.2, rate, idle());
            let (start, speed) = (at(&world, &car), car.speed(&world).unwrap());
            drive(&mut world, &mut car, 6.0, rate, Controls { brake: 1.0, ..idle() });
            let way = at(&world, &car) - start;
            let expected = f64::from(speed * speed / (2.0 * G));
            assert!((way.z - expected).abs() < 0.1 * expected, "{kind:?} {rate}: {way}, not {expected}");
            assert!(way.x.abs() < 0.05 && car.speed(&world).unwrap().abs() < 1e-2, "{way}");
        }
    }
}

/// Expected: a circle of radius `base / tan(angle)`, that of the rear axle, as in the bicycle model.
#[test]
fn it_turns_as_a_bicycle_at_low_speed() {
    for kind in KINDS {
        for side in [-1.0, 1.0] {
            let (mut world, mut car) = car_on(0.0, |desc| desc.with_wheel_kind(kind).with_max_steer(0.4));
            drive(&mut world, &mut car, 2.0, 60, idle());
            launch(&mut world, &car, 2.0);
            let controls = Controls { throttle: 0.02, steer: side, ..idle() };
            drive(&mut world, &mut car, 2.0, 60, controls);
            let spin = world.angular_velocity(car.chassis()).unwrap().y;
            let radius = car.speed(&world).unwrap() / spin;
            let expected = side * 2.6 / libm::tanf(0.4);
            assert!(
                (radius - expected).abs() < 0.06 * expected.abs(),
                "{kind:?}: {radius}, not {expected} m"
            );
        }
    }
}

/// Expected: less roll in the same curve.
#[test]
fn bars_lower_the_roll() {
    for kind in KINDS {
        let roll = |stiffness: f32| {
            let bars = [[0, 1], [2, 3]].map(|wheels| AntiRollBar { wheels, stiffness });
            let (mut world, mut car) = car_on(0.0, |desc| {
                desc.with_wheel_kind(kind).with_anti_roll(bars.to_vec()).with_max_steer(0.08)
            });
            drive(&mut world, &mut car, 2.0, 60, idle());
            launch(&mut world, &car, 15.0);
            drive(&mut world, &mut car, 2.0, 60, Controls { throttle: 0.2, steer: 1.0, ..idle() });
            let left = world.rotation(car.chassis()).unwrap() * Vec3::X;
            // To the left the left side rises.
            left.y
        };
        let (without, with) = (roll(0.0), roll(20_000.0));
        assert!(without > 0.01 && with > 0.0 && with < 0.75 * without, "{kind:?}: {without}, {with}");
    }
}

/// Expected: 30, 60 and 120 Hz go the same way within 3 %.
#[test]
fn steps_of_any_length_agree() {
    let run = |rate: u32| {
        let (mut world, mut car) = car_on(0.0, |desc| desc);
        drive(&mut world, &mut car, 1.0, rate, idle());
        drive(&mut world, &mut car, 5.0, rate, Controls { throttle: 0.7, ..idle() });
        let speed = car.speed(&world).unwrap();
        drive(&mut world, &mut car, 3.0, rate, Controls { throttle: 0.2, steer: 0.05, ..idle() });
        (speed, at(&world, &car))
    };
    let (speed, place) = run(120);
    for rate in [30, 60] {
        let (other, there) = run(rate);
        assert!((other - speed).abs() < 0.03 * speed, "{rate} Hz: {other}, {speed} m/s");
        assert!(there.distance(place) < 0.04 * place.length(), "{rate} Hz: {there}, {place}");
    }
}

/// Parked for a minute with no brake at all on a plane: neither moves nor turns over.
#[test]
fn it_does_not_creep() {
    for kind in KINDS {
        let (mut world, mut car) = car_on(0.0, |desc| desc.with_wheel_kind(kind));
        drive(&mut world, &mut car, 3.0, 60, idle());
        let start = at(&world, &car);
        drive(&mut world, &mut car, 60.0, 60, idle());
        let creep = at(&world, &car).distance(start);
        assert!(creep < 1e-3, "{kind:?}: {creep} m");
    }
}

/// Throttle below zero brakes, and then goes backward.
#[test]
fn it_goes_backward() {
    for kind in KINDS {
        let (mut world, mut car) = car_on(0.0, |desc| desc.with_wheel_kind(kind));
        drive(&mut world, &mut car, 3.0, 60, Controls { throttle: 1.0, ..idle() });
        let speed = car.speed(&world).unwrap();
        assert!(
            speed > if kind == WheelKind::Body { 3.0 } else { 8.0 } && car.gear() > 0,
            "{kind:?}: {speed}"
        );
        drive(&mut world, &mut car, 6.0, 60, Controls { throttle: -1.0, ..idle() });
        assert!(car.speed(&world).unwrap() < -2.0 && car.gear() == -1, "{kind:?}");
    }
}

/// Expected: the load of the car on top of its own weight presses a raft down: a spring by a joint would do
/// the same.
#[test]
fn wheels_push_what_they_stand_on() {
    let mut world = World::new(Settings::default()).unwrap();
    let raft = ShapeDesc::new(Geometry::cuboid(3.0, 0.1, 4.0)).with_density(1000.0);
    let raft = world.add_body(&BodyDesc::dynamic().with_shape(raft)).unwrap();
    let lift = Vec3::Y * (G * (world.mass(raft).unwrap() + MASS));
    let chassis = add_chassis(&mut world, DVec3::Y * 0.85, Quat::IDENTITY);
    let desc = VehicleDesc::car(Vec3::Y * -0.2, [0.8, 1.3], MASS);
    let mut car = Vehicle::new(&mut world, chassis, &desc).unwrap();
    for _ in 0..120 {
        world.add_force(raft, lift).unwrap();
        car.update(&mut world, 1.0 / 60.0, &idle()).unwrap();
        world.step(1.0 / 60.0).unwrap();
    }
    // The lift is the weight of both: momentum is that of the beginning, none.
    let momentum = world.linear_velocity(raft).unwrap() * world.mass(raft).unwrap()
        + world.linear_velocity(chassis).unwrap() * MASS;
    assert!(momentum.length() < 0.02 * MASS, "{momentum}");
    assert!(car.wheels().iter().all(|wheel| wheel.contact.is_some_and(|at| at.body == raft)));
}

/// Expected: the same bits after a snapshot is restored with a copy of the vehicle.
#[test]
fn a_copy_of_it_goes_with_a_snapshot() {
    let (mut world, mut car) = car_on(0.0, |desc| desc);
    let controls = Controls { throttle: 1.0, steer: 0.1, ..idle() };
    drive(&mut world, &mut car, 1.0, 60, controls);
    let mut kept = (backstop::Snapshot::new(), car.clone());
    world.snapshot(&mut kept.0);
    drive(&mut world, &mut car, 2.0, 60, controls);
    let first = (world.state_hash(), car.clone());
    world.restore(&kept.0).unwrap();
    car = kept.1;
    drive(&mut world, &mut car, 2.0, 60, controls);
    assert_eq!((world.state_hash(), car), first);
}

#[test]
fn what_cannot_be_is_refused() {
    let mut world = World::new(Settings::default()).unwrap();
    let chassis = add_chassis(&mut world, DVec3::ZERO, Quat::IDENTITY);
    let good = VehicleDesc::car(Vec3::ZERO, [0.8, 1.3], MASS).with_wheel_kind(WheelKind::Body);
    let mut bad = vec![VehicleDesc::default(), good.clone().with_drag(f32::NAN), good.clone()];
    bad[2].wheels[3].radius = 0.0;
    bad.push(good.clone().with_anti_roll(vec![AntiRollBar { wheels: [0, 4], stiffness: 1.0 }]));
    bad.push(good.clone());
    bad[4].engine.torque = vec![[2000.0, 1.0], [1000.0, 1.0]];
    for desc in &bad {
        assert!(Vehicle::new(&mut world, chassis, desc).is_err(), "{desc:?}");
    }
    let still = world.add_body(&BodyDesc::fixed()).unwrap();
    assert!(Vehicle::new(&mut world, still, &good).is_err());
    assert_eq!((world.body_count(), world.joint_count()), (2, 0));
    let mut car = Vehicle::new(&mut world, chassis, &good).unwrap();
    let wild = Controls { throttle: 2.0, ..idle() };
    assert!(car.update(&mut world, 1.0 / 60.0, &wild).is_err());
    assert!(car.update(&mut world, 0.0, &idle()).is_err());
    assert!(car.wheel_pose(&world, 4).is_err());
    car.remove(&mut world).unwrap();
    assert_eq!((world.body_count(), world.joint_count()), (2, 0));
}
