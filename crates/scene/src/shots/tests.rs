//! Tests of shots.

use super::shot::MAX_STEPS;
use super::target::Side;
use super::*;

#[test]
fn shots_start_on_the_right_side_and_clear_of_their_target() {
    let targets = Targets::new().unwrap();
    for number in 0..3000 {
        let shot = Shot::new(&targets, 7, number);
        shot.body.validate().unwrap();
        let clear = targets.clearance(shot.target, shot.body.position);
        let reach = f64::from(body::reach(&shot.body.shapes));
        assert!(clear >= 0.99 * reach, "{number}: {clear} m is less than its reach of {reach} m");
        assert!(!shot.steps.is_empty() && shot.steps.len() <= MAX_STEPS);
        let speed = shot.body.linear_velocity.length();
        assert!((9.99..2001.0).contains(&speed));
    }
}

#[test]
fn a_shot_follows_from_seed_and_number() {
    let targets = Targets::new().unwrap();
    let text = |seed, number| format!("{:?}", Shot::new(&targets, seed, number));
    assert_eq!(text(1, 41), text(1, 41));
    assert_ne!(text(1, 41), text(2, 41));
}

#[test]
fn bodies_fly_from_the_right_side_to_the_wrong_one_if_nothing_is_there() {
    // The same flight without a target: most cross where they were aimed at. What remains is slow or grazing
    // and ends before, or leaves over the edge.
    let targets = Targets::new().unwrap();
    let mut crossed = 0;
    for number in 0..1000 {
        let shot = Shot::new(&targets, 3, number);
        let mut p = shot.body.position;
        let v = shot.body.linear_velocity.as_dvec3();
        for &dt in &shot.steps {
            let next = p + v * f64::from(dt);
            match targets.side(shot.target, p, next) {
                Side::Wrong => {
                    crossed += 1;
                    break;
                }
                Side::Right => p = next,
                _ => break,
            }
        }
    }
    assert!(crossed > 900, "{crossed} of 1000");
}
