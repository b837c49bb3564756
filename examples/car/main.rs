//! Cars of `backstop::vehicle`: three kinds of wheels on one plain, over a bump, around a bend, to a halt.
//!
//!     cargo run --release --example car

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::vehicle::{AntiRollBar, Controls, Vehicle, VehicleDesc, WheelKind};
use backstop::{BodyDesc, Error, Geometry, MassProperties, Settings, ShapeDesc, World};

const DT: f32 = 1.0 / 60.0;
const MASS: f32 = 1200.0;

fn car(world: &mut World, kind: WheelKind) -> Result<Vehicle, Error> {
    let hull = Geometry::cuboid(0.8, 0.3, 2.0);
    let mass = MassProperties::of(&hull, 1.0).scaled_to(MASS);
    // The box is above the centre of mass, which is the origin.
    let hull = ShapeDesc::new(hull).with_position(Vec3::Y * 0.35);
    let chassis = BodyDesc::dynamic().with_position(DVec3::Y * 0.75).with_shape(hull).with_mass(mass);
    let chassis = world.add_body(&chassis)?;
    let bars = [[0, 1], [2, 3]].map(|wheels| AntiRollBar { wheels, stiffness: 10_000.0 });
    let desc = VehicleDesc::car(Vec3::Y * -0.2, [0.8, 1.3], MASS);
    Vehicle::new(world, chassis, &desc.with_wheel_kind(kind).with_anti_roll(bars.to_vec()))
}

fn drive(world: &mut World, car: &mut Vehicle, seconds: f32, controls: Controls) -> Result<(), Error> {
    for _ in 0..(seconds / DT) as u32 {
        car.update(world, DT, &controls)?;
        world.step(DT)?;
    }
    let down = car.wheels().iter().filter(|wheel| wheel.contact.is_some()).count();
    let (at, speed) = (world.position(car.chassis())?, car.speed(world)?);
    let (gear, rpm) = (car.gear(), car.rpm());
    println!(
        "  {speed:5.1} m/s, gear {gear}, {rpm:4.0} rpm, {down} wheels down, at {:.0}, {:.0}",
        at.x, at.z
    );
    Ok(())
}

fn main() -> Result<(), Error> {
    let controls = Controls::default();
    for kind in [WheelKind::Ray, WheelKind::Sphere, WheelKind::Body] {
        println!("{kind:?}");
        let mut world = World::new(Settings::default())?;
        world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane)))?;
        let bump = ShapeDesc::new(Geometry::cylinder(5.0, 1.0))
            .with_rotation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2));
        world.add_body(&BodyDesc::fixed().with_position([0.0, -0.95, 20.0]).with_shape(bump))?;
        let mut car = car(&mut world, kind)?;
        drive(&mut world, &mut car, 1.0, controls)?;
        drive(&mut world, &mut car, 8.0, Controls { throttle: 0.5, ..controls })?;
        drive(&mut world, &mut car, 3.0, Controls { throttle: 0.2, steer: 0.1, ..controls })?;
        drive(&mut world, &mut car, 5.0, Controls { brake: 1.0, ..controls })?;
        let up = world.rotation(car.chassis())? * Vec3::Y;
        assert!(up.y > 0.99 && car.speed(&world)?.abs() < 0.1, "it stands on its wheels");
        assert!(world.position(car.chassis())?.z > 50.0);
    }
    Ok(())
}
