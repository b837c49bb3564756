//! How much memory a world takes, as the system counts it, beside what the engine reports: bytes a body of a
//! pile of 4,096, and a small scene on a mesh of 100,352 triangles.
//!
//!     cargo run --release --example footprint
//!
//! What counts is memory of the process's own (`Anonymous` in `/proc/self/smaps_rollup`). Pages of the
//! program's file, which the first steps of any world bring in, are told apart: they are there once, and the
//! system may drop them at any time.
//!
//! The scene's description is built before the world and kept until the end. So what grows from there on is
//! the world: its buffers and what the allocator adds. A mesh is part of both (an `Arc`), and was there
//! already.

use backstop::{Category, Settings, World};
use backstop_scene::builtin;
use std::process::Command;

/// Resident memory [bytes]: of the process's own, and all of it.
type Resident = (usize, usize);

/// `None` where the system doesn't tell.
fn resident() -> Option<Resident> {
    let all = std::fs::read_to_string("/proc/self/smaps_rollup").ok()?;
    let of = |name: &str| {
        let line = all.lines().find_map(|line| line.strip_prefix(name))?;
        Some(line.trim().strip_suffix(" kB")?.parse::<usize>().ok()? * 1024)
    };
    Some((of("Anonymous:")?, of("Rss:")?))
}

/// A hundred steps of a scene.
fn measure(name: &str) -> Result<(), Box<dyn std::error::Error>> {
    let start = resident();
    let scene = builtin::build(name).ok_or("no such scene")?;
    let before = resident();
    let mut world = World::new(Settings::default().with_gravity(scene.gravity))?;
    // One by one: what a call for all of them needs for itself would count too.
    for body in &scene.bodies {
        world.add_body(&body.desc)?;
    }
    for _ in 0..100 {
        world.step(1.0 / 60.0)?;
    }
    let after = resident();

    let report = world.memory();
    let (total, bodies) = (report.total(), scene.bodies.len());
    let meshes = report.category(Category::Meshes).reserved;
    let line = |what: &str, bytes: usize| println!("{name:5} {what:48} {bytes:9} bytes");
    let each = |what: &str, bytes: usize| {
        println!("{name:5} {what:48} {bytes:9} bytes, {:5} a body", bytes / bodies);
    };
    let (Some(start), Some(before), Some(after)) = (start, before, after) else {
        println!("{name:5} reported {total} bytes; no /proc/self/smaps_rollup to compare with");
        return Ok(());
    };
    let grown = after.0.saturating_sub(before.0);
    if name == "pile" {
        each("reported", total);
        each("own memory, since before the world", grown);
        each("with pages of the program's file", after.1.saturating_sub(before.1));
        // Nine tenths: what was reserved but never written to is not resident.
        assert!(total * 9 / 10 <= grown && grown <= 2900 * bodies, "{grown} bytes, {total} reported");
    } else {
        line("reported, the mesh included", total);
        line("of it the mesh", meshes);
        line("own memory, since before the mesh", after.0.saturating_sub(start.0));
        let own = after.0.saturating_sub(start.0);
        assert!(total <= 3_000_000 && own <= 3_000_000, "{own} bytes, {total} reported");
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
