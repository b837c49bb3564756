//! Nothing gets through static geometry with continuous collision, however fast, thin and spinning it is.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]
use backstop::scene::shots::{MODES, Outcome, Shot, Tally, Targets};

/// Shots of this test; `cargo backstop shots` runs as many as one likes.
const SHOTS: u64 = 3000;

#[test]
fn no_shot_gets_through_a_target_with_continuous_collision() {
    let targets = Targets::new().unwrap();
    let mut tally = Tally::default();
    let mut through = Vec::new();
    for number in 0..SHOTS {
        let shot = Shot::new(&targets, 2, number);
        let outcomes = shot.run_all(&targets).unwrap();
        tally.add(&shot, &outcomes);
        if outcomes[1..].iter().any(|o| *o != Outcome::Kept) {
            through.push((number, outcomes));
        }
    }
    let [discrete, segment, volume] = tally.all.through;
    assert!(
        discrete > SHOTS / 2,
        "the shots are no test: {discrete} get through without continuous collision"
    );
    assert_eq!((segment, volume), (0, 0), "{MODES:?}: {through:?}");
}
