//! How much memory a world takes, as the system counts it, beside what the engine reports: bytes a body of a pile of 4,096,
//! and a small scene on a mesh of 100,352 triangles.
//!
//!     cargo run --release --example footprint
//!
//! A scene's description is built before the first reading and kept until after the last, so what grows in between is
//! the world: its buffers, what the allocator adds, and the pages of the program that steps touch for the first time.
//! A mesh is shared with the description by an `Arc` and so is there already; the report counts it once, and it is added here.

use backstop::scene::builtin;
use backstop::{Category, Settings, World};
use std::process::Command;

/// Resident memory of this process [bytes], and how much of it is its own rather than of files, where the system tells.
fn resident() -> Option<(usize, usize)> {
    let all = std::fs::read_to_string("/proc/self/smaps_rollup").ok()?;
    let of = |name: &str| {
        let line = all.lines().find_map(|line| line.strip_prefix(name))?;
        Some(line.trim().strip_suffix(" kB")?.parse::<usize>().ok()? * 1024)
    };
    Some((of("Rss:")?, of("Anonymous:")?))
}

/// A hundred steps of a scene.
fn measure(name: &str) -> Result<(), Box<dyn std::error::Error>> {
    let scene = builtin::build(name).ok_or("no such scene")?;
    let before = resident();
    let mut world = World::new(Settings { gravity: scene.gravity, ..Settings::default() })?;
    // One by one: what a call for all of them needs for itself would count too.
    for body in &scene.bodies {
        world.add_body(&body.desc)?;
    }
    for _ in 0..100 {
        world.step(1.0 / 60.0)?;
    }
    let after = resident();

    let report = world.memory();
    let meshes = report.category(Category::Meshes).reserved;
    let (own, bodies) = (report.total() - meshes, scene.bodies.len());
    let line = |what: &str, bytes: usize| {
        println!("{name:5} {what:42} {bytes:9} bytes, {:6} a body", bytes / bodies);
    };
    line("reported, without meshes", own);
    match before.zip(after) {
        Some(((all, anonymous), (all_then, anonymous_then))) => {
            let grown = all_then.saturating_sub(all);
            line("resident growth", grown);
            line("of it not of the program's file", anonymous_then.saturating_sub(anonymous));
            println!("{name:5} {:42} {:9} bytes", "in all, with the mesh", grown + meshes);
            // The pile is large enough for the rest not to matter; all of the other one is below the limit.
            let (least, most) =
                if name == "pile" { (own * 9 / 10, bodies * 2900) } else { (0, 3_000_000 - meshes) };
            assert!((least..=most).contains(&grown), "{grown} is not in {least}..={most}");
        }
        None => println!("{name:5} this system has no /proc/self/smaps_rollup: nothing to compare with"),
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    if let Some(name) = std::env::args().nth(1) {
        return measure(&name);
    }
    // In a process of its own each: memory that one gave back would hide what the next one takes.
    for name in ["pile", "talk"] {
        let ended = Command::new(std::env::current_exe()?).arg(name).status()?;
        assert!(ended.success(), "{name}: {ended}");
    }
    Ok(())
}
