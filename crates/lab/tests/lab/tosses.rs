//! Measured tosses of a cube (`tosses` of `$BACKSTOP_DATA`) beside the same tosses simulated, and one toss by
//! hand.

use crate::common::data::data;
use backstop::Settings;
use backstop::glam::{DQuat, DVec3};
use backstop_lab::tosses::{Cube, Deviation, Sample, deviation};

const STEP: f64 = 1.0 / 148.0;

/// Free flight by the parabola: x = x0 + v t - g t² / 2, with a spin about one axis.
fn flight(time: f64) -> Sample {
    let gravity = DVec3::NEG_Z * 9.81;
    let (start, velocity, spin) = (DVec3::new(0.1, -0.2, 5.0), DVec3::new(1.0, 0.5, 2.0), 3.0);
    Sample {
        time,
        position: start + velocity * time + gravity * (0.5 * time * time),
        rotation: DQuat::from_xyzw(libm::sin(0.5 * spin * time), 0.0, 0.0, libm::cos(0.5 * spin * time)),
        velocity: velocity + gravity * time,
        body_spin: DVec3::X * spin,
    }
}

#[test]
fn a_cube_in_free_flight_is_where_the_parabola_is() {
    let samples: Vec<Sample> = (0..100).map(|i| flight(f64::from(i) * STEP)).collect();
    let found = deviation(&samples, &Cube::default(), &Settings::default(), None, 1).unwrap();
    assert!(found.last_position < 1e-4, "{found:?}");
    assert!(found.last_rotation < 1e-4, "{found:?}");
}

#[test]
fn what_is_no_toss_is_refused() {
    let settings = Settings::default();
    let one = [flight(0.0)];
    assert!(deviation(&one, &Cube::default(), &settings, None, 1).is_err());
    assert!(deviation(&[], &Cube::default(), &settings, None, 1).is_err());
    let still = [flight(0.0), flight(0.0)];
    assert!(deviation(&still, &Cube::default(), &settings, None, 1).is_err(), "no time passes");
    let lost = [Sample { position: DVec3::NAN, ..flight(0.0) }, flight(STEP)];
    assert!(deviation(&lost, &Cube::default(), &settings, None, 1).is_err());
    let turned = [Sample { rotation: DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), ..flight(0.0) }, flight(STEP)];
    assert!(deviation(&turned, &Cube::default(), &settings, None, 1).is_err());
    let flat = Cube { half_width: 0.0, ..Cube::default() };
    assert!(deviation(&[flight(0.0), flight(STEP)], &flat, &settings, None, 1).is_err());
}

/// MuJoCo with stiff contacts and an elliptic cone is off by 13.2 % of the width on these tosses, and by 18.5
/// degrees; this engine's default by 12.7 % and 20.2 degrees, so the rotation is held to what was measured
/// here (docs/tosses.md).
#[test]
fn measured_tosses_are_followed_as_closely_as_by_others() {
    let Some(folder) = data("tosses") else { return };
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()).collect();
    files.sort();
    let all: Vec<Deviation> = files
        .iter()
        .map(|file| {
            let text = std::fs::read_to_string(file).unwrap();
            let sample = |line: &str| {
                let x: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
                Sample {
                    time: x[0],
                    position: DVec3::new(x[1], x[2], x[3]),
                    rotation: DQuat::from_xyzw(x[5], x[6], x[7], x[4]),
                    velocity: DVec3::new(x[8], x[9], x[10]),
                    body_spin: DVec3::new(x[11], x[12], x[13]),
                }
            };
            let samples: Vec<Sample> = text.lines().skip(1).map(sample).collect();
            deviation(&samples, &Cube::default(), &Settings::default(), None, 1).unwrap()
        })
        .collect();
    let mean = Deviation::mean(&all);
    println!("{} tosses: {mean:?}", all.len());
    assert!(all.len() > 100 && mean.position < 0.132, "{mean:?}");
    assert!(mean.rotation.to_degrees() < 21.0, "{mean:?}");
}
