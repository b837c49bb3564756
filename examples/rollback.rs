//! Rollback as a networked game does it: eight frames are predicted with a guess at what the other player
//! does, then that comes in, and they are done again. The bits at the end are those of a machine that knew
//! all along.
//!
//!     cargo run --release --example rollback

use backstop::glam::Vec3;
use backstop::{BodyHandle, Error, Settings, Snapshot, World};
use backstop_scene::builtin;

const FRAMES: u32 = 8;
const DT: f32 = 1.0 / 60.0;

/// What the other player does in a frame: a push to one side or the other, seldom for long.
fn input(frame: u32) -> Vec3 {
    let side = if (frame / 5).is_multiple_of(2) { 1.0 } else { -1.0 };
    Vec3::new(side, 0.3, 0.5) * 20_000.0
}

fn frame(world: &mut World, player: BodyHandle, push: Vec3) -> Result<(), Error> {
    world.add_force(player, push)?;
    world.step(DT)?;
    Ok(())
}

/// A small pile, the same on each machine.
fn machine() -> Result<(World, BodyHandle), Error> {
    let mut scene = builtin::pile();
    scene.bodies.truncate(405);
    let mut world = World::new(Settings::default())?;
    let player = scene.add_to(&mut world)?.bodies[200];
    Ok((world, player))
}

fn main() -> Result<(), Error> {
    let (mut knowing, player) = machine()?;
    let (mut guessing, _) = machine()?;
    let mut saved = Snapshot::new();
    for round in 0..30 {
        let first = round * FRAMES;
        // What came last may go on for ever: the best guess there is.
        let guess = input(first.saturating_sub(1));
        guessing.snapshot(&mut saved);
        for _ in 0..FRAMES {
            frame(&mut guessing, player, guess)?;
        }
        let guessed = guessing.state_hash();
        guessing.restore(&saved)?;
        for now in first..first + FRAMES {
            frame(&mut guessing, player, input(now))?;
            frame(&mut knowing, player, input(now))?;
        }
        assert_eq!(guessing.state_hash(), knowing.state_hash());
        if round % 10 == 9 {
            let right = if guessed == knowing.state_hash() { "right" } else { "wrong" };
            println!("frame {}: hash {:016x}, the guess was {right}", first + FRAMES, knowing.state_hash());
        }
    }
    println!("{} bytes a snapshot, {} bodies", saved.size(), guessing.body_count());
    Ok(())
}
