//! A car of bodies and joints, with springs, steering and an engine at all wheels: on a plain, and over
//! hills.
//!
//!     cargo run --release --example vehicle

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, BodyHandle, Error, Filter, Geometry, JointDesc, JointHandle, Limit, MassProperties,
    Material, Motion, Motor, QueryFilter, Settings, ShapeDesc, Spring, TriangleMesh, World,
};
use backstop_scene::builtin;
use std::sync::Arc;

pub(crate) const DT: f32 = 1.0 / 60.0;
/// What the springs bear [kg], and how stiff each of the four is [N/m].
pub(crate) const MASS: f32 = 1000.0;
pub(crate) const STIFFNESS: f32 = 15_000.0;
const SPRING: Spring = Spring::Coefficients { stiffness: STIFFNESS, damping: 2_500.0 };
/// How far a spring gives way to either side [m].
const TRAVEL: f32 = 0.25;
/// Radius of a wheel [m].
pub(crate) const RADIUS: f32 = 0.4;
/// Place of a wheel on the chassis without load [m]: to the side, up, ahead.
pub(crate) const HUB: Vec3 = Vec3::new(0.85, -0.3, 1.3);

pub(crate) struct Car {
    pub(crate) chassis: BodyHandle,
    /// Front left and right, rear left and right. The front is at +z, and left at +x.
    pub(crate) wheels: [BodyHandle; 4],
    steering: Vec<JointHandle>,
    engine: Vec<JointHandle>,
}

impl Car {
    /// With the middle of its chassis at a point.
    pub(crate) fn add_to(world: &mut World, at: DVec3) -> Result<Car, Error> {
        // The middle of the box is above that of the mass. Parts of a car don't touch each other.
        let part = |geometry: Geometry, position: Vec3, rotation: Quat, mass: f32, at: DVec3| {
            let inertia =
                MassProperties::of(&geometry, 1.0).scaled_to(mass).transformed(Vec3::ZERO, rotation);
            let filter = Filter::default().with_group(-1);
            let material = Material::default().with_friction(1.0);
            let shape = ShapeDesc::new(geometry)
                .with_position(position)
                .with_rotation(rotation)
                .with_filter(filter)
                .with_material(material);
            BodyDesc::dynamic().with_position(at).with_shape(shape).with_mass(Some(inertia))
        };
        let body = Geometry::cuboid(0.7, 0.3, 1.9);
        let chassis = world.add_body(&part(body, Vec3::Y * 0.2, Quat::IDENTITY, MASS, at))?;
        let mut car = Car { chassis, wheels: [chassis; 4], steering: Vec::new(), engine: Vec::new() };
        for i in 0..4 {
            let (side, end) = (1.0 - 2.0 * (i % 2) as f32, if i < 2 { 1.0 } else { -1.0 });
            let hub = at + (HUB * Vec3::new(side, 1.0, end)).as_dvec3();
            // Its axle is x; that of a cylinder is y.
            let turned = Quat::from_xyzw(0.0, 0.0, 0.5_f32.sqrt(), 0.5_f32.sqrt());
            let tyre = Geometry::cylinder(0.1, RADIUS);
            let wheel = world.add_body(&part(tyre, Vec3::ZERO, turned, 25.0, hub))?;
            car.wheels[i] = wheel;
            if i >= 2 {
                let frames = world.frames_at([chassis, wheel], hub, Quat::IDENTITY)?;
                let wheel = JointDesc::wheel([chassis, wheel], frames, TRAVEL, SPRING);
                car.engine.push(world.add_joint(&wheel)?);
                continue;
            }
            // In front a knuckle between the two slides on the spring and turns about it; the wheel spins on
            // the knuckle.
            let mass = MassProperties::of(&Geometry::cuboid(0.1, 0.1, 0.1), 1.0).scaled_to(15.0);
            let knuckle = world.add_body(&BodyDesc::dynamic().with_position(hub).with_mass(Some(mass)))?;
            let frames = world.frames_at([chassis, knuckle], hub, Quat::IDENTITY)?;
            let mut strut = JointDesc::new([chassis, knuckle], frames);
            (strut.limits, strut.motors) = steered(0.0);
            car.steering.push(world.add_joint(&strut)?);
            let frames = world.frames_at([knuckle, wheel], hub, Quat::IDENTITY)?;
            car.engine.push(world.add_joint(&JointDesc::hinge([knuckle, wheel], frames))?);
        }
        Ok(car)
    }

    /// Engine and steering: a speed to reach [m/s] with at most so much torque at each wheel [N m], and an
    /// angle to the left [rad].
    pub(crate) fn drive(&self, world: &mut World, speed: f32, torque: f32, angle: f32) -> Result<(), Error> {
        let motor = Motor::velocity(Motion::Angular, Axis::X, speed / RADIUS, torque);
        for &joint in &self.engine {
            world.set_joint_motor(joint, motor)?;
        }
        for &joint in &self.steering {
            world.set_joint_target(joint, Motion::Angular, Axis::Y, angle, 0.0)?;
        }
        Ok(())
    }

    /// How many wheels touch something static.
    pub(crate) fn wheels_down(&self, world: &World) -> Result<usize, Error> {
        let mut down = 0;
        for &wheel in &self.wheels {
            let near = RADIUS + 0.03;
            down += usize::from(world.closest_point_any(
                world.position(wheel)?,
                near,
                &QueryFilter::only_static(),
            )?);
        }
        Ok(down)
    }
}

/// A strut: slides along y on a spring and turns about y to an angle [rad].
fn steered(angle: f32) -> (Vec<Limit>, Vec<Motor>) {
    let servo = Spring::Coefficients { stiffness: 30_000.0, damping: 1_000.0 };
    let limits = vec![
        Limit::lock(Motion::Linear, Axes::Perpendicular(Axis::Y)),
        Limit::lock(Motion::Angular, Axes::Perpendicular(Axis::Y)),
        Limit::new(Motion::Linear, Axes::One(Axis::Y), -TRAVEL, TRAVEL),
    ];
    let drives = vec![
        Motor::position(Motion::Linear, Axis::Y, 0.0, SPRING),
        Motor::position(Motion::Angular, Axis::Y, angle, servo),
    ];
    (limits, drives)
}

/// Drives for some seconds, with a torque at each wheel [N m]; returns speed [m/s], distance as the crow
/// flies [m], and the share of steps with all wheels down.
pub(crate) fn run(
    world: &mut World,
    car: &Car,
    seconds: f32,
    speed: f32,
    torque: f32,
    angle: f32,
) -> Result<[f64; 3], Error> {
    let start = world.position(car.chassis)?;
    let (mut down, steps) = (0, (seconds / DT) as u32);
    car.drive(world, speed, torque, angle)?;
    for _ in 0..steps {
        world.step(DT)?;
        down += u32::from(car.wheels_down(world)? == 4);
    }
    let way = world.position(car.chassis)? - start;
    let now = world.linear_velocity(car.chassis)?.length();
    Ok([now.into(), way.length(), f64::from(down) / f64::from(steps)])
}

/// The builtin terrain; returns its height at (0, -50).
pub(crate) fn hills(world: &mut World) -> Result<f32, Error> {
    let terrain = builtin::talk_terrain();
    let (vertices, triangles) = terrain.mesh();
    let mesh = Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles)?));
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(mesh)))?;
    Ok(terrain.height(0.0, -50.0))
}

fn main() -> Result<(), Error> {
    for rough in [false, true] {
        let mut world = World::new(Settings::default())?;
        let (name, ground, speed) = if rough {
            ("hills", hills(&mut world)?, 8.0)
        } else {
            world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane)))?;
            ("plain", 0.0, 20.0)
        };
        let height = f64::from(ground + RADIUS - HUB.y) + 1.0;
        // Where the first hill does not overturn it.
        let aside = if rough { -5.0 } else { 0.0 };
        let car = Car::add_to(&mut world, DVec3::new(aside, height, -50.0))?;
        run(&mut world, &car, 2.0, 0.0, 400.0, 0.0)?;
        let [now, way, down] = run(&mut world, &car, 8.0, speed, if rough { 1000.0 } else { 400.0 }, 0.0)?;
        let up = (world.rotation(car.chassis)? * Vec3::Y).y;
        println!("{name}: {now:.1} m/s, {way:.0} m, all four wheels down in {:.0} % of steps", 100.0 * down);
        assert!(up > 0.5, "it stands on its wheels");
        assert!(way > if rough { 20.0 } else { 100.0 });
    }
    Ok(())
}
