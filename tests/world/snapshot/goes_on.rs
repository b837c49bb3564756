//! Scenes of every kind go on to the same bits, at any number of threads.

use super::*;

/// Takes snapshots on the way of a run, goes on, restores each in an order that jumps to and fro, and
/// compares every step.
fn goes_on(case: &Case, threads: usize) {
    let (mut world, bodies) = world_of(case, 1);
    let end = case.at.last().unwrap() + case.on;
    let mut snapshots = Vec::new();
    let mut hashes = Vec::new();
    for step in 0..end {
        if case.at.contains(&step) {
            let mut snapshot = Snapshot::new();
            world.snapshot(&mut snapshot);
            snapshots.push((step, world.state_hash(), snapshot));
        }
        hashes.extend(advance(&mut world, &bodies, case, step, 1));
    }
    assert!(!case.sleeping || world.sleeping_body_count() > 0, "{}: something is to sleep", case.name);
    let (mut other, _) = world_of(case, threads);
    for (step, hash, snapshot) in snapshots.iter().rev().chain(&snapshots) {
        for (which, world) in [(0, &mut world), (1, &mut other)] {
            let world: &mut World = world;
            let threads = world.settings().threads;
            world.restore(snapshot).unwrap();
            assert_eq!(world.state_hash(), *hash, "{} at {step}", case.name);
            assert_eq!(world.settings().threads, threads);
            let mut again = Snapshot::new();
            world.snapshot(&mut again);
            assert_eq!(again.size(), snapshot.size(), "{} at {step}", case.name);
            let from = *step as usize;
            for (i, hash) in advance(world, &bodies, case, *step, case.on).into_iter().enumerate() {
                assert_eq!(
                    hash,
                    hashes[from + i],
                    "{}, world {which}: restored at {step}, differs after {} steps",
                    case.name,
                    i + 1
                );
            }
        }
    }
}

#[test]
fn what_is_restored_goes_on_to_the_same_bits() {
    for case in cases() {
        let start = std::time::Instant::now();
        goes_on(&case, 1);
        println!("{}: {:.1} s", case.name, start.elapsed().as_secs_f32());
    }
}

#[test]
fn another_number_of_threads_goes_on_to_the_same_bits() {
    for threads in [2, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        for case in cases().iter().filter(|case| ["pile", "bullets", "bounce", "sleep"].contains(&case.name))
        {
            pool.install(|| goes_on(case, threads));
        }
    }
}
