//! The bodies of the fuzz targets (fuzz/README.md), on bytes from seeds: a fixed number of runs, the same
//! every time. What fails is shrunk to few bytes, which belong into `findings`.

#[path = "../../fuzz/bodies/mod.rs"]
#[allow(unreachable_pub, reason = "of the package of fuzz targets")]
mod bodies;

use proptest::prelude::any;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// Sequences of calls: some ten seconds.
const CALL_SEEDS: u64 = 200;

/// Runs a body on `cases` inputs of at most so many bytes.
fn seeded(seed: u8, cases: u32, length: usize, run: fn(&[u8])) {
    let cases = if crate::common::wide() { cases } else { cases / 2 };
    let config = Config { cases, failure_persistence: None, max_shrink_iters: 4096, ..Config::default() };
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[seed; 32]);
    let bytes = proptest::collection::vec(any::<u8>(), 0..length);
    let outcome = TestRunner::new_with_rng(config, rng).run(&bytes, |bytes| {
        run(&bytes);
        Ok(())
    });
    if let Err(error) = outcome {
        panic!("{error}");
    }
}

/// Worlds of everything: what must hold is in `fuzz/bodies/calls/judge.rs`. `scripts/reliability calls` runs
/// more of them.
#[test]
fn calls_in_any_order_leave_a_world_that_restores_to_itself() {
    for seed in 0..if crate::common::wide() { 10 * CALL_SEEDS } else { CALL_SEEDS } {
        println!("seed {seed}");
        bodies::calls::run(&bodies::calls::bytes_of(seed));
    }
}

#[test]
fn scenes_load_or_are_refused() {
    seeded(2, 60000, 700, bodies::scenes::run);
}

#[test]
fn points_make_a_hull_or_are_refused() {
    seeded(3, 60000, 900, bodies::hulls::run);
}

#[test]
fn triangles_make_a_mesh_or_are_refused() {
    seeded(4, 30000, 500, bodies::meshes::run);
}

#[test]
fn changed_snapshots_are_restored_or_refused() {
    seeded(5, 30000, 40, bodies::snapshots::run);
}

#[test]
fn changed_recordings_are_played_or_refused() {
    seeded(6, 40000, 60, bodies::recordings::run);
}

#[test]
fn settings_are_stepped_with_or_refused() {
    seeded(7, 20000, 120, bodies::settings::run);
}

/// Inputs of `fuzz/corpus`, which coverage-guided runs found to reach code that others do not.
#[test]
fn inputs_that_were_kept_leave_all_in_order() {
    type Body = fn(&[u8]);
    let targets: [(&str, Body); 7] = [
        ("calls", bodies::calls::run),
        ("scenes", bodies::scenes::run),
        ("hulls", bodies::hulls::run),
        ("meshes", bodies::meshes::run),
        ("snapshots", bodies::snapshots::run),
        ("recordings", bodies::recordings::run),
        ("settings", bodies::settings::run),
    ];
    let corpus = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus");
    for (target, run) in targets {
        let files: Vec<_> = std::fs::read_dir(corpus.join(target)).unwrap().collect();
        assert!(files.len() >= 40, "{target} has {} inputs", files.len());
        for file in files {
            let path = file.unwrap().path();
            println!("{}", path.display());
            run(&std::fs::read(path).unwrap());
        }
    }
}
