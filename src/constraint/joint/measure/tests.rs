use super::*;
use crate::body::{Pose, exp_map};
use crate::joint::JointFrame;
use crate::math::Quat;
use crate::random::Random;
use glam::{DVec3, Vec3};

#[test]
fn an_angle_is_that_of_its_sine_and_cosine() {
    for i in 0..=10_000 {
        let x = i as f32 * 1e-4 * std::f32::consts::PI;
        let found = angle(2.0 * libm::sinf(x).max(0.0), 2.0 * libm::cosf(x));
        assert!((found - x).abs() < 1e-6, "{x}: {found}");
    }
}

type Lanes3 = crate::lanes::Vec3<f32>;

fn lanes(v: Vec3) -> Lanes3 {
    Lanes3::new(v.x, v.y, v.z)
}

/// A row at its bodies, after they moved on for a time: speed along the lever, bend over a time,
/// displacement.
fn measured<M: Measure<f32>>(at: &Placed, axes: Axes, v: &BodyPair<f32>, time: f32, h: f32) -> [f32; 3] {
    let mut measure = M::default();
    let start = measure.place(0, at, axes);
    let d = BodyPair { va: v.va * time, wa: v.wa * time, vb: v.vb * time, wb: v.wb * time };
    let (ra, rb) = (lanes(at.arm[0] + at.apart), lanes(at.arm[1]));
    let now = turned(d.wb, rb);
    let mut lever = Lever { arm: [ra + (d.vb - d.va) + (now - rb), now], ..Lever::zero() };
    let value = measure.follow(&d, &mut lever, start);
    [lever.speed(v), measure.bend(v, &lever, h), value]
}

/// Rates of displacements equal their differences over a motion, and displacements that are followed within a
/// step equal those measured at its end.
fn check<M: Measure<f32>>(axes: Axes, angular: bool, turns: bool) -> usize {
    let mut random = Random(1);
    let mut checked = 0;
    for case in 0..300 {
        let frames =
            [0; 2].map(|_| JointFrame { position: random.cube(), rotation: exp_map(random.cube() * 1.8) });
        // Far out, where a single-precision position would be a millimetre off.
        let poses = [0; 2].map(|_| Pose {
            position: random.cube().as_dvec3() + DVec3::splat(1e4),
            rotation: exp_map(random.cube() * 1.8),
        });
        let (v, w) = ([0; 2].map(|_| random.cube()), [0; 2].map(|_| random.cube()));
        let after = |time: f32| {
            let moved = [0, 1].map(|i| Pose {
                position: poses[i].position + (v[i] * time).as_dvec3(),
                rotation: exp_map(w[i] * time) * poses[i].rotation,
            });
            Placed::new([&moved[0], &moved[1]], &frames)
        };
        let pair = BodyPair { va: lanes(v[0]), wa: lanes(w[0]), vb: lanes(v[1]), wb: lanes(w[1]) };
        let now = after(0.0);
        let value = |time: f32| measured::<M>(&after(time), axes, &pair, 0.0, 0.0)[2];
        let start = value(0.0);
        // Where an angle turns round, and where small angles are of no direction, it has no slope; close to
        // half a turn of tilt the twist runs away.
        let axis = axis_of(axes);
        let tilted = turns && now.axis(0, axis).dot(now.axis(1, axis)) < -0.3;
        if (angular && (start.abs() > 2.7 || start.abs() < 0.1)) || tilted {
            continue;
        }
        let step = 2e-3;
        let [speed, ..] = measured::<M>(&now, axes, &pair, 0.0, 0.0);
        let found = (value(step) - value(-step)) / (2.0 * step);
        assert!((found - speed).abs() < 0.02 * (1.0 + speed.abs()), "{case} {axes:?}: {found} {speed}");
        let time = 0.02;
        let [_, _, moved] = measured::<M>(&now, axes, &pair, time, 0.0);
        let there = value(time);
        assert!((moved - there).abs() < 5e-4, "{case} {axes:?}: {moved} {there}");
        let [speed, bend, _] = measured::<M>(&now, axes, &pair, 0.0, time);
        let mean = (there - start) / time;
        // No error of second order is left.
        let (wrong, least) = ((speed + bend - mean).abs(), 0.02 * (1.0 + mean.abs()));
        assert!(turns || wrong < least, "{case} {axes:?}: {speed} + {bend} for {mean}");
        checked += 1;
    }
    checked
}

#[test]
fn displacements_change_as_their_rows_say() {
    let mut checked = 0;
    for axis in Axis::ALL {
        checked += check::<Slide<f32>>(Axes::One(axis), false, false);
        checked += check::<Distance<f32>>(Axes::Perpendicular(axis), false, false);
        checked += check::<Twist<f32>>(Axes::One(axis), true, true);
        checked += check::<Tilt<f32>>(Axes::Perpendicular(axis), true, false);
    }
    checked += check::<Distance<f32>>(Axes::All, false, false);
    checked += check::<Turn<f32>>(Axes::All, true, false);
    assert!(checked > 3000, "{checked}");
}

/// Coincident frames are pushed apart in some direction, and half a turn of tilt gives finite numbers.
#[test]
fn there_is_always_a_direction() {
    fn lever<M: Measure<f32>>(second: Quat, axes: Axes) -> Lever<f32> {
        let at = |rotation| Pose { position: DVec3::ZERO, rotation };
        let first = exp_map(Vec3::new(0.3, -1.0, 0.8));
        let at = Placed::new([&at(first), &at(first * second)], &[JointFrame::default(); 2]);
        let zero = lanes(Vec3::ZERO);
        let (mut measure, mut lever) = (M::default(), Lever::zero());
        let start = measure.place(0, &at, axes);
        let value = measure.follow(&BodyPair { va: zero, wa: zero, vb: zero, wb: zero }, &mut lever, start);
        assert!(
            value.is_finite() && lever.speed(&BodyPair { va: zero, wa: zero, vb: zero, wb: zero }) == 0.0
        );
        lever
    }
    for axis in Axis::ALL {
        for second in [Quat::IDENTITY, exp_map(Vec3::Y * std::f32::consts::PI)] {
            let levers = [
                lever::<Slide<f32>>(second, Axes::One(axis)),
                lever::<Distance<f32>>(second, Axes::Perpendicular(axis)),
                lever::<Distance<f32>>(second, Axes::All),
                lever::<Twist<f32>>(second, Axes::One(axis)),
                lever::<Tilt<f32>>(second, Axes::Perpendicular(axis)),
                lever::<Turn<f32>>(second, Axes::All),
            ];
            for Lever { force, torque, .. } in levers {
                let length = (force + torque).length();
                assert!((0.99..2e3).contains(&length), "{axis:?}: {length}");
            }
        }
    }
}
