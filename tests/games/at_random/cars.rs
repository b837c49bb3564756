//! Cars of 1 kg to 40 t on two to ten wheels.

use super::ground::Ground;
use super::random::Random;
use super::{G, RATES, judge, require};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::vehicle::{Controls, EngineDesc, GearboxDesc, Vehicle, VehicleDesc, WheelDesc, WheelKind};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, MassProperties, Settings, ShapeDesc, World};
use std::f32::consts::TAU;

const KINDS: [WheelKind; 3] = [WheelKind::Ray, WheelKind::Sphere, WheelKind::Body];

/// A car by its numbers.
struct Car {
    mass: f32,
    /// Length of a car of this mass by that of one of 1,200 kg.
    scale: f32,
    half: Vec3,
    half_track: f32,
    /// Places of the axles along the car, from the front [m].
    axles: Vec<f32>,
    /// Height of the centre of mass above the hubs while springs are extended [m].
    centre: f32,
    desc: VehicleDesc,
    substeps: u32,
}

impl Car {
    /// With so many axles, at least; two wheels on each.
    fn any(random: &mut Random, fewest: usize) -> Car {
        let mass = random.log_range(1.0, 40_000.0);
        let scale = libm::cbrtf(mass / 1200.0);
        let length = random.range(1.6, 3.0) * scale;
        let count = fewest + random.below(6 - fewest);
        let half_base = 0.65 * length;
        let axles: Vec<f32> = match count {
            1 => vec![0.0],
            n => (0..n).map(|i| half_base * (1.0 - 2.0 * i as f32 / (n - 1) as f32)).collect(),
        };
        // Wheels of one side do not meet.
        let space = if count > 1 { 2.0 * half_base / (count - 1) as f32 } else { length };
        let radius = (0.35 * scale * random.range(0.7, 1.3)).min(0.45 * space);
        let friction = random.range(0.4, 1.2);
        let travel = random.range(0.4, 1.0) * radius;
        // Under a share of its load a wheel's spring yields by a share of its travel.
        let load = mass * G / (2 * count) as f32;
        let stiffness = load / (travel * random.range(0.25, 0.5));
        let damping = 2.0 * random.range(0.3, 1.0) * (stiffness * load / G).sqrt();
        let ratio = random.log_range(4.0, 200.0);
        let brake = 4.0 * friction * load * radius;
        let half_track = random.range(0.6, 1.1) * scale;
        let centre = random.range(0.0, 0.5) * scale;
        let wheel = WheelDesc::default()
            .with_radius(radius)
            .with_width(0.4 * radius)
            .with_mass(mass / ratio)
            .with_travel(travel)
            .with_stiffness(stiffness)
            .with_damping(damping)
            .with_friction(friction)
            .with_brake(brake)
            .with_hand_brake(brake);
        let wheels = axles.iter().enumerate().flat_map(|(i, &z)| {
            [1.0, -1.0].map(|side| {
                let wheel = wheel.with_position([side * half_track, -centre, z]);
                wheel.with_steered(i == 0 && count > 1).with_drive(if i > 0 || count == 1 {
                    1.0
                } else {
                    0.0
                })
            })
        });
        let desc = VehicleDesc::default()
            .with_wheels(wheels.collect())
            // Toys on wheels that are bodies of some grams take 120 Hz.
            .with_wheel_kind(random.of(if mass < 100.0 { &KINDS[..2] } else { &KINDS }))
            .with_engine(EngineDesc::default().with_torque(vec![[0.0, 0.0]]).with_braking(0.0))
            .with_gearbox(GearboxDesc::default().with_ratios(vec![1.0]).with_final_drive(1.0))
            .with_drag(0.0)
            .with_max_steer(0.5);
        let half = Vec3::new(0.8 * half_track, 0.25 * scale, length);
        // Wheels that are bodies of a hundredth of the mass above them need substeps of 1/120 s.
        let least = if desc.wheel_kind == WheelKind::Body { 4 } else { 1 };
        let substeps = least + random.below(9 - least as usize) as u32;
        Car { mass, scale, half, half_track, axles, centre, desc, substeps }
    }

    fn wheel(&self) -> &WheelDesc {
        &self.desc.wheels[0]
    }

    /// Height of the centre of mass above the ground at rest [m].
    fn height(&self) -> f32 {
        self.centre + self.wheel().radius - self.yielding()
    }

    /// Compression under its weight [m]: of each spring, as the centre of mass is in the middle.
    fn yielding(&self) -> f32 {
        let wheel = self.wheel();
        self.mass * G / (wheel.stiffness * self.desc.wheels.len() as f32)
    }

    fn base(&self) -> f32 {
        self.axles[0] - self.axles[self.axles.len() - 1]
    }

    /// Into a world with the centre of mass at a height above the ground at rest [m].
    fn add_to(&self, world: &mut World, ground: Ground, turned: Quat, above: f32) -> Result<Vehicle, Error> {
        let rotation = ground.rotation() * turned;
        let up = ground.rotation() * Vec3::Y;
        self.add_at(world, (up * (self.height() + above)).as_dvec3(), rotation)
    }

    fn add_at(&self, world: &mut World, at: DVec3, rotation: Quat) -> Result<Vehicle, Error> {
        let hull = Geometry::cuboid(self.half.x, self.half.y, self.half.z);
        let mass = MassProperties::of(&hull, 1.0).scaled_to(self.mass);
        let hull = ShapeDesc::new(hull).with_position(Vec3::Y * (self.half.y + 0.05 * self.scale));
        let body = BodyDesc::dynamic().with_position(at).with_rotation(rotation);
        let chassis = world.add_body(&body.with_shape(hull).with_mass(mass))?;
        Vehicle::new(world, chassis, &self.desc)
    }

    fn world(&self) -> Result<World, Error> {
        World::new(Settings::default().with_substeps(self.substeps))
    }

    fn text(&self) -> String {
        let wheel = self.wheel();
        format!(
            "{:?} {:.3} kg, {} wheels of {:.3} kg, r {:.3} mu {:.2}, k {:.3} c {:.3} travel {:.3}, {} steps",
            self.desc.wheel_kind,
            self.mass,
            self.desc.wheels.len(),
            wheel.mass,
            wheel.radius,
            wheel.friction,
            wheel.stiffness,
            wheel.damping,
            wheel.travel,
            self.substeps
        )
    }

    /// All of its mass [kg].
    fn total(&self) -> f32 {
        match self.desc.wheel_kind {
            WheelKind::Body => self.mass + self.desc.wheels.iter().map(|wheel| wheel.mass).sum::<f32>(),
            _ => self.mass,
        }
    }
}

fn drive(
    world: &mut World,
    car: &mut Vehicle,
    seconds: f32,
    rate: u32,
    controls: Controls,
) -> Result<(), Error> {
    let dt = 1.0 / rate as f32;
    for _ in 0..(seconds * rate as f32) as u32 {
        car.update(world, dt, &controls)?;
        world.step(dt)?;
    }
    Ok(())
}

/// All bodies at a velocity [m/s] along z of the chassis, wheels rolling.
fn launch(world: &mut World, car: &Vehicle, speed: f32) -> Result<(), Error> {
    let rotation = world.rotation(car.chassis())?;
    let bodies: Vec<BodyHandle> = world.bodies().filter(|&b| world.mass(b).is_ok_and(|m| m > 0.0)).collect();
    for body in bodies {
        world.set_linear_velocity(body, rotation * Vec3::Z * speed)?;
    }
    for (wheel, desc) in car.wheel_bodies().zip(&car.desc().wheels) {
        world.set_angular_velocity(wheel, rotation * Vec3::X * (speed / desc.radius))?;
    }
    Ok(())
}

fn brakes() -> Controls {
    Controls { brake: 1.0, hand_brake: 1.0, ..Controls::default() }
}

/// Time until springs are at rest [s].
const SETTLE: f32 = 4.0;

/// Expected: on the level each spring yields by its load over its stiffness, and the loads are the weight.
#[test]
fn springs_yield_by_load_over_stiffness() {
    judge(8, |random| {
        let (car, rate) = (Car::any(random, 2), random.of(&RATES));
        let mut world = car.world()?;
        let ground = Ground::Plane;
        ground.add_to(&mut world, car.wheel().friction)?;
        let mut vehicle = car.add_to(&mut world, ground, Quat::IDENTITY, 0.0)?;
        drive(&mut world, &mut vehicle, SETTLE, rate, brakes())?;
        let text = car.text();
        let (mut load, weight) = (0.0, car.total() * G);
        for wheel in vehicle.wheels() {
            load += wheel.contact.map_or(0.0, |at| at.load);
            let (x, expected) = (wheel.compression, car.yielding());
            let off = (x - expected).abs() / car.wheel().travel;
            require!(
                off < 0.03,
                "yields by {x:.4} m, not {expected:.4} ({off:.3} of travel); {rate} Hz {text}"
            );
        }
        require!((load / weight - 1.0).abs() < 0.03, "load {load} of {weight} N; {rate} Hz {text}");
        Ok(())
    });
}

/// Expected: with its brakes on it stands still on a slope of up to 0.7 of what its friction holds, across it
/// or along it, if it does not tip.
#[test]
pub(super) fn brakes_hold_on_slopes() {
    judge(5, |random| {
        let (car, rate) = (Car::any(random, 2), random.of(&RATES));
        let tips = car.half_track.min(0.5 * car.base()) / (car.height() + car.wheel().radius);
        let most = (0.7 * car.wheel().friction).min(0.5 * tips);
        let angle = libm::atanf(random.range(0.0, most));
        let turned = Quat::from_rotation_y(random.range(0.0, TAU));
        let mut world = car.world()?;
        let ground = Ground::Tilted(angle);
        ground.add_to(&mut world, car.wheel().friction)?;
        let mut vehicle = car.add_to(&mut world, ground, turned, 0.0)?;
        drive(&mut world, &mut vehicle, SETTLE, rate, brakes())?;
        let start = world.position(vehicle.chassis())?;
        drive(&mut world, &mut vehicle, 20.0, rate, brakes())?;
        let creep = world.position(vehicle.chassis())? - start;
        let share = creep.length() / f64::from(car.scale);
        require!(
            share < 1e-3,
            "creeps by {:.5} m in 20 s, {creep:.5}, slope {angle:.3}; {rate} Hz {}",
            creep.length(),
            car.text()
        );
        Ok(())
    });
}

/// Expected: with its brakes on it goes along with a platform that moves evenly, as it stands on one that
/// rests.
#[test]
fn brakes_hold_on_a_moving_platform() {
    judge(4, |random| {
        let (car, rate) = (Car::any(random, 2), random.of(&RATES));
        let mut world = car.world()?;
        let platform = Ground::Platform.add_to(&mut world, car.wheel().friction)?;
        let velocity = random.direction() * random.range(0.0, 10.0);
        let mut vehicle = car.add_to(&mut world, Ground::Platform, Quat::IDENTITY, 0.0)?;
        for body in world.bodies().collect::<Vec<_>>() {
            world.set_linear_velocity(body, velocity)?;
        }
        drive(&mut world, &mut vehicle, SETTLE, rate, brakes())?;
        let chassis = vehicle.chassis();
        let place = |world: &World| -> Result<DVec3, Error> {
            Ok(world.position(chassis)? - world.position(platform)?)
        };
        let start = place(&world)?;
        drive(&mut world, &mut vehicle, 10.0, rate, brakes())?;
        let creep = place(&world)?.distance(start);
        let share = creep / f64::from(car.scale);
        require!(share < 2e-3, "creeps by {creep:.5} m in 10 s, {velocity:.2}; {rate} Hz {}", car.text());
        Ok(())
    });
}

/// Expected: a box on its roof counts as a part of it: springs yield by the weight of both, and brakes hold
/// both on a slope.
#[test]
fn it_carries_a_load() {
    judge(6, |random| {
        let (mut car, rate) = (Car::any(random, 2), random.of(&RATES));
        car.desc.wheel_kind = random.of(&KINDS[..2]);
        let load = car.mass * random.range(0.1, 0.6);
        let slope = random.range(0.0, 0.15);
        let mut world = car.world()?;
        let ground = Ground::Tilted(slope);
        ground.add_to(&mut world, 1.0)?;
        let mut vehicle = car.add_to(&mut world, ground, Quat::IDENTITY, 0.0)?;
        let half = Vec3::new(0.5 * car.half.x, 0.1 * car.scale, 0.5 * car.half.z);
        let top = 2.0 * car.half.y + 0.05 * car.scale + half.y;
        let at = world.position(vehicle.chassis())? + (ground.rotation() * Vec3::Y * top).as_dvec3();
        let shape = ShapeDesc::new(Geometry::cuboid(half.x, half.y, half.z));
        let shape = shape.with_density(load / (8.0 * half.x * half.y * half.z));
        let body = BodyDesc::dynamic().with_position(at).with_rotation(ground.rotation()).with_shape(shape);
        world.add_body(&body)?;
        drive(&mut world, &mut vehicle, SETTLE, rate, brakes())?;
        let start = world.position(vehicle.chassis())?;
        let mean = vehicle.wheels().iter().map(|wheel| wheel.compression).sum::<f32>()
            / vehicle.wheels().len() as f32;
        let expected = car.yielding() * (1.0 + load / car.mass) * libm::cosf(slope);
        let off = (mean - expected) / car.wheel().travel;
        require!(
            off.abs() < 0.05,
            "yields by {mean:.4}, not {expected:.4} m ({off:.3}); {rate} Hz {}",
            car.text()
        );
        drive(&mut world, &mut vehicle, 10.0, rate, brakes())?;
        let creep = world.position(vehicle.chassis())?.distance(start);
        let share = creep / f64::from(car.scale);
        require!(
            share < 1e-3,
            "creeps by {creep:.5} m in 10 s, slope {slope:.3}, load {load}; {rate} Hz {}",
            car.text()
        );
        Ok(())
    });
}

/// Expected: without brakes it stands on the level.
#[test]
fn it_stands_on_the_level_without_brakes() {
    judge(4, |random| {
        let (car, rate) = (Car::any(random, 2), random.of(&RATES));
        let mut world = car.world()?;
        let ground = if random.chance(0.5) { Ground::Plane } else { Ground::Tiles };
        ground.add_to(&mut world, car.wheel().friction)?;
        let mut vehicle = car.add_to(&mut world, ground, Quat::IDENTITY, 0.0)?;
        drive(&mut world, &mut vehicle, SETTLE, rate, Controls::default())?;
        let start = world.position(vehicle.chassis())?;
        drive(&mut world, &mut vehicle, 20.0, rate, Controls::default())?;
        let creep = world.position(vehicle.chassis())? - start;
        let share = creep.length() / f64::from(car.scale);
        require!(
            share < 1e-3,
            "creeps by {:.5} m in 20 s, {creep:.5} {ground:?}; {rate} Hz {}",
            creep.length(),
            car.text()
        );
        Ok(())
    });
}

/// Expected: acceleration by the engine's force over the mass, with that of turning wheels; well below what
/// the friction of the driven wheels holds.
#[test]
fn it_accelerates_by_force_over_mass() {
    judge(8, |random| {
        let (mut car, rate) = (Car::any(random, 2), random.of(&RATES));
        let wheel = *car.wheel();
        let driven = car.desc.wheels.iter().filter(|wheel| wheel.drive > 0.0).count() as f32;
        let share = driven / car.desc.wheels.len() as f32;
        let force = 0.3 * wheel.friction * car.mass * G * share * random.range(0.3, 1.0);
        car.desc.engine.torque = vec![[0.0, force * wheel.radius], [1e6, force * wheel.radius]];
        car.desc.wheels.iter_mut().for_each(|wheel| wheel.rolling_resistance = 0.0);
        let mut world = car.world()?;
        Ground::Plane.add_to(&mut world, wheel.friction)?;
        let mut vehicle = car.add_to(&mut world, Ground::Plane, Quat::IDENTITY, 0.0)?;
        drive(&mut world, &mut vehicle, SETTLE, rate, Controls::default())?;
        let throttle = Controls { throttle: 1.0, ..Controls::default() };
        drive(&mut world, &mut vehicle, 0.5, rate, throttle)?;
        let before = vehicle.speed(&world)?;
        drive(&mut world, &mut vehicle, 2.0, rate, throttle)?;
        let found = (vehicle.speed(&world)? - before) / 2.0;
        // The inertia of a disc is half of its mass at the radius.
        let expected = force / (car.total() + 0.5 * wheel.mass * car.desc.wheels.len() as f32);
        let off = found / expected - 1.0;
        require!(
            off.abs() < 0.04,
            "accelerates by {found}, not {expected} ({off:.3}); {rate} Hz {}",
            car.text()
        );
        Ok(())
    });
}

/// Expected: with locked brakes `v² / (2 mu g)`; tyres that slide keep their share of the grip.
#[test]
fn it_stops_as_friction_allows() {
    judge(5, |random| {
        let (mut car, rate) = (Car::any(random, 2), random.of(&RATES));
        let wheel = *car.wheel();
        // A short and high one would go over its front wheels.
        if wheel.friction * car.height() > 0.4 * car.base() {
            return Ok(());
        }
        let locks = random.chance(0.5);
        car.desc.anti_lock = !locks;
        for wheel in &mut car.desc.wheels {
            (wheel.brake, wheel.hand_brake) = (20.0 * wheel.brake, 0.0);
        }
        let mut world = car.world()?;
        Ground::Plane.add_to(&mut world, wheel.friction)?;
        let mut vehicle = car.add_to(&mut world, Ground::Plane, Quat::IDENTITY, 0.0)?;
        drive(&mut world, &mut vehicle, SETTLE, rate, Controls::default())?;
        launch(&mut world, &vehicle, random.range(5.0, 20.0) + 0.85 * G * wheel.friction)?;
        // Wheels that are casts get to their speed; heavy ones take some seconds.
        drive(&mut world, &mut vehicle, 6.0, rate, Controls::default())?;
        let (start, speed) = (world.position(vehicle.chassis())?, vehicle.speed(&world)?);
        drive(&mut world, &mut vehicle, 8.0, rate, Controls { brake: 1.0, ..Controls::default() })?;
        let way = world.position(vehicle.chassis())? - start;
        let sliding = if locks && car.desc.wheel_kind != WheelKind::Body { wheel.sliding } else { 1.0 };
        let expected = speed * speed / (2.0 * wheel.friction * sliding * G);
        let off = way.length() as f32 / expected - 1.0;
        require!(
            off.abs() < 0.1,
            "stops in {way:.3}, not {expected} m ({off:.3}) from {speed} m/s, locks {locks}; {rate} Hz {}",
            car.text()
        );
        Ok(())
    });
}

/// Expected: at low speed a circle of `base / tan(angle)`, with the fixed axles in their middle.
#[test]
fn it_turns_around_the_centre_of_ackermann() {
    judge(8, |random| {
        let (mut car, rate) = (Car::any(random, 2), random.of(&RATES));
        car.desc.wheels.retain(|wheel| {
            wheel.position.z == car.axles[0] || wheel.position.z == car.axles[car.axles.len() - 1]
        });
        let angle = random.range(0.1, 0.5) * if random.chance(0.5) { 1.0 } else { -1.0 };
        car.desc.wheels.iter_mut().for_each(|wheel| {
            wheel.rolling_resistance = 0.0;
            wheel.stiffness *= car.axles.len() as f32 / 2.0;
        });
        let mut world = car.world()?;
        Ground::Plane.add_to(&mut world, car.wheel().friction)?;
        let mut vehicle = car.add_to(&mut world, Ground::Plane, Quat::IDENTITY, 0.0)?;
        drive(&mut world, &mut vehicle, SETTLE, rate, Controls::default())?;
        let expected = car.base() / libm::tanf(angle);
        // Sideways a twentieth of the grip.
        let speed = (0.05 * car.wheel().friction * G * expected.abs()).sqrt();
        let controls = Controls { steer: angle / 0.5, ..Controls::default() };
        drive(&mut world, &mut vehicle, 0.5, rate, controls)?;
        launch(&mut world, &vehicle, speed)?;
        drive(&mut world, &mut vehicle, 2.0, rate, controls)?;
        let from = (world.rotation(vehicle.chassis())? * Vec3::X, vehicle.speed(&world)?);
        drive(&mut world, &mut vehicle, 0.5, rate, controls)?;
        let to = (world.rotation(vehicle.chassis())? * Vec3::X, vehicle.speed(&world)?);
        let turned = libm::asinf(from.0.cross(to.0).dot(Vec3::Y));
        let radius = 0.5 * (from.1 + to.1) * 0.5 / turned;
        let off = radius / expected - 1.0;
        require!(
            off.abs() < 0.06,
            "goes round {radius}, not {expected} m ({off:.3}), {} of {speed} m/s; {rate} Hz {}",
            to.1,
            car.text()
        );
        Ok(())
    });
}

/// Expected: no chassis and no wheel goes through any ground at up to 80 m/s; without an engine nothing gains
/// energy on a ground that rests.
#[test]
fn nothing_goes_through_the_ground() {
    judge(12, |random| {
        let (car, rate) = (Car::any(random, 1), random.of(&RATES));
        let ground = Ground::any(random, car.wheel().radius);
        let mut world = car.world()?;
        ground.add_to(&mut world, car.wheel().friction)?;
        let turned = Quat::from_rotation_y(random.range(-0.1, 0.1));
        let mut vehicle = car.add_to(&mut world, ground, turned, 0.05 * car.scale)?;
        let speed = random.range(0.0, 80.0);
        launch(&mut world, &vehicle, speed)?;
        let before = world.energy();
        let steer = random.signed() * 0.2;
        let dt = 1.0 / rate as f32;
        for i in 0..(4 * rate) {
            let controls =
                Controls { steer, brake: if i > 3 * rate { 1.0 } else { 0.0 }, ..Controls::default() };
            vehicle.update(&mut world, dt, &controls)?;
            world.step(dt)?;
            let at = world.position(vehicle.chassis())?;
            if at.z.abs() > 450.0 || at.x.abs() > 115.0 {
                break;
            }
            let deep = -ground.above(at) / f64::from(car.scale);
            require!(
                deep < 0.0,
                "chassis {deep:.3} below {ground:?} after {i} at {speed}; {rate} Hz {}",
                car.text()
            );
            for wheel in vehicle.wheel_bodies() {
                let deep = -ground.above(world.position(wheel)?) / f64::from(car.wheel().radius);
                require!(
                    deep < 0.0,
                    "wheel {deep:.3} below {ground:?} after {i} at {speed}; {rate} Hz {}",
                    car.text()
                );
            }
            let fell = (world.energy() - before) / f64::from(car.total() * G);
            let scale = f64::from(speed * speed / (2.0 * G) + car.height());
            require!(
                fell < 0.01 * scale,
                "gains {:.4} of {scale:.3} m on {ground:?} after {i} at {speed}; {rate} Hz {}",
                fell,
                car.text()
            );
        }
        Ok(())
    });
}

/// Expected: thrown in any pose with any spin, it loses energy from then on and stays above the ground.
#[test]
fn a_car_that_was_turned_over_does_not_explode() {
    judge(10, |random| {
        let (car, rate) = (Car::any(random, 1), random.of(&RATES));
        let mut world = car.world()?;
        Ground::Plane.add_to(&mut world, car.wheel().friction)?;
        let at = DVec3::Y * f64::from(4.0 * car.scale);
        let mut vehicle = car.add_at(&mut world, at, random.rotation())?;
        let (spin, velocity) = (random.direction() * random.range(0.0, 8.0), random.cube() * 5.0);
        world.set_linear_velocity(vehicle.chassis(), velocity)?;
        world.set_angular_velocity(vehicle.chassis(), spin)?;
        let arm = |world: &World, body| world.position(body).map(|p| (p - at).as_vec3());
        for wheel in vehicle.wheel_bodies().collect::<Vec<_>>() {
            let arm = arm(&world, wheel)?;
            world.set_linear_velocity(wheel, velocity + spin.cross(arm))?;
            world.set_angular_velocity(wheel, spin)?;
        }
        let before = world.energy() + f64::from(car.total() * G * car.scale);
        let dt = 1.0 / rate as f32;
        for i in 0..8 * rate {
            vehicle.update(&mut world, dt, &Controls::default())?;
            world.step(dt)?;
            let share = world.energy() / before;
            require!(share < 1.02, "energy {share:.3} after {i}; {rate} Hz {}", car.text());
            let low = world.position(vehicle.chassis())?.y / f64::from(car.scale);
            require!(low > 0.0, "{low:.3} below after {i}; {rate} Hz {}", car.text());
        }
        Ok(())
    });
}

/// Expected: on a table that is tilted sideways it stands up to `half track / height`, and falls over beyond;
/// with springs, which lean, a little earlier.
#[test]
fn it_rolls_over_at_track_by_height() {
    judge(6, |random| {
        let (mut car, rate) = (Car::any(random, 2), random.of(&RATES));
        let stiff = 10.0;
        for wheel in &mut car.desc.wheels {
            (wheel.friction, wheel.stiffness, wheel.damping) =
                (4.0, stiff * wheel.stiffness, 3.0 * wheel.damping);
            (wheel.brake, wheel.hand_brake) = (10.0 * wheel.brake, 10.0 * wheel.hand_brake);
        }
        let wide = if car.desc.wheel_kind == WheelKind::Body { 0.5 * car.wheel().width } else { 0.0 };
        let limit = libm::atanf((car.half_track + wide) / car.height());
        for (share, over) in [(0.85, false), (1.2, true)] {
            let angle = limit * share;
            if angle > 1.2 {
                continue;
            }
            let mut world = car.world()?;
            Ground::Plane.add_to(&mut world, 4.0)?;
            let mut vehicle = car.add_to(&mut world, Ground::Plane, Quat::IDENTITY, 0.0)?;
            // It may go over and over.
            let mut up = 1.0_f32;
            for i in 0..100 {
                // Gravity is tilted instead, after two seconds and within three.
                let tilt = angle * (i as f32 / 30.0 - 2.0 / 3.0).clamp(0.0, 1.0);
                let gravity = Vec3::new(libm::sinf(tilt), -libm::cosf(tilt), 0.0) * G;
                world.set_settings(world.settings().clone().with_gravity(gravity))?;
                drive(&mut world, &mut vehicle, 0.1, rate, brakes())?;
                up = up.min((world.rotation(vehicle.chassis())? * Vec3::Y).y);
            }
            require!((up < 0.9) == over, "up {up:.3} at {share} of {limit:.3}; {rate} Hz {}", car.text());
        }
        Ok(())
    });
}

/// Expected: 30, 60 and 120 Hz take the same car the same way.
#[test]
fn rates_agree() {
    judge(3, |random| {
        let mut car = Car::any(random, 2);
        car.substeps = 4;
        let wheel = *car.wheel();
        let force = 0.15 * wheel.friction * car.mass * G;
        car.desc.engine.torque = vec![[0.0, force * wheel.radius], [1e6, force * wheel.radius]];
        let steer = 0.06 * random.signed();
        let run = |rate: u32| -> Result<(f32, DVec3), Error> {
            let mut world = car.world()?;
            Ground::Plane.add_to(&mut world, wheel.friction)?;
            let mut vehicle = car.add_to(&mut world, Ground::Plane, Quat::IDENTITY, 0.0)?;
            drive(&mut world, &mut vehicle, 1.0, rate, Controls::default())?;
            drive(&mut world, &mut vehicle, 4.0, rate, Controls { throttle: 1.0, ..Controls::default() })?;
            drive(&mut world, &mut vehicle, 2.0, rate, Controls { steer, ..Controls::default() })?;
            Ok((vehicle.speed(&world)?, world.position(vehicle.chassis())?))
        };
        let (speed, place) = run(120)?;
        for rate in [30, 60] {
            let (other, there) = run(rate)?;
            let off = [(other / speed - 1.0).abs(), (there.distance(place) / place.length()) as f32];
            require!(
                off[0] < 0.03 && off[1] < 0.04,
                "{other} of {speed} m/s, {there:.2} of {place:.2} at {rate} Hz; {}",
                car.text()
            );
        }
        Ok(())
    });
}
