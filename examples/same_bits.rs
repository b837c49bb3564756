//! The same input gives the same bits on every processor: run it anywhere, it asserts the hashes that are
//! pinned here. `scripts/same-bits` runs it as x86-64, aarch64 and WebAssembly code.

use backstop::{Error, Settings, World};
use backstop_scene::builtin;

/// Scene, steps, hash of all poses and velocities after them.
const PINNED: [(&str, usize, u64); 5] = [
    ("talk", 120, 0x5BE3_1C72_E67D_1FC3),
    ("bullets", 60, 0x5959_96B2_09AF_D7F9),
    ("large_pyramid", 60, 0x2B04_94F6_9FCF_26D4),
    ("joint_grid", 60, 0xD624_D63D_D7AA_DFB6),
    ("ragdolls", 300, 0xAC12_6067_0962_6D4B),
];

fn hash(name: &str, steps: usize) -> Result<u64, Error> {
    let scene = match name {
        "talk" => builtin::talk(),
        "bullets" => builtin::bullets(true),
        "large_pyramid" => builtin::large_pyramid(12),
        "joint_grid" => builtin::joint_grid(10),
        _ => builtin::ragdolls(6),
    };
    let mut world = World::new(Settings::default())?;
    scene.add_to(&mut world)?;
    for _ in 0..steps {
        world.step(1.0 / 60.0)?;
    }
    Ok(world.state_hash())
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
