//! The same input gives the same bits on every processor: run it anywhere, it asserts the hashes that are
//! pinned here. `scripts/same-bits` runs it as x86-64, aarch64 and WebAssembly code.

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::scene::{Scene, builtin};
use backstop::{BodyDesc, Error, Geometry, Settings, ShapeDesc, Skeleton, World};

/// Scene, steps, hash of all poses and velocities after them.
const PINNED: [(&str, usize, u64); 5] = [
    ("talk", 120, 0x60E6_279C_2286_353E),
    ("bullets", 60, 0x0461_A14E_0EC9_C504),
    ("large_pyramid", 60, 0x45F8_983F_88D7_91AC),
    ("joint_grid", 60, 0xD624_D63D_D7AA_DFB6),
    ("ragdolls", 300, 0x905A_A67A_284E_887C),
];

fn add(world: &mut World, scene: &Scene) -> Result<(), Error> {
    scene.add_to(world).map(drop)
}

/// Figures fall among boxes, cylinders and balls, and come to rest.
fn ragdolls(world: &mut World) -> Result<(), Error> {
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane)))?;
    for i in 0..100u8 {
        let geometry = match i % 4 {
            0 => Geometry::cuboid(0.2, 0.3, 0.2),
            1 => Geometry::Sphere { radius: 0.25 },
            2 => Geometry::capsule(0.2, 0.15),
            _ => Geometry::cylinder(0.25, 0.2),
        };
        let at =
            DVec3::new(f64::from(i % 5) - 2.0, 0.5 + 0.7 * f64::from(i / 25), f64::from(i / 5 % 5) - 2.0);
        world.add_body(&BodyDesc::dynamic().at(at).with_shape(ShapeDesc::new(geometry)))?;
    }
    let figure = Skeleton::humanoid();
    for i in 0..6u8 {
        let at = DVec3::new(0.6 * f64::from(i) - 1.5, 4.0 + 0.3 * f64::from(i), 0.0);
        figure.add_to(world, at, Quat::IDENTITY, Vec3::new(0.0, -5.0, 1.0))?;
    }
    Ok(())
}

fn hash(name: &str, steps: usize) -> Result<u64, Error> {
    let mut world = World::new(Settings::default())?;
    match name {
        "talk" => add(&mut world, &builtin::talk())?,
        "bullets" => add(&mut world, &builtin::bullets(true))?,
        "large_pyramid" => add(&mut world, &builtin::large_pyramid(12))?,
        "joint_grid" => add(&mut world, &builtin::joint_grid(10))?,
        _ => ragdolls(&mut world)?,
    }
    for _ in 0..steps {
        world.step(1.0 / 60.0)?;
    }
    Ok(world.hash())
}

fn main() -> Result<(), Error> {
    let mut all = true;
    for (name, steps, pinned) in PINNED {
        let hash = hash(name, steps)?;
        println!("{name}, {steps} steps: 0x{hash:016x}");
        all &= hash == pinned;
    }
    assert!(all, "not the bits that are pinned");
    Ok(())
}
