//! A leaning rod that strikes the floor with its end: the slip of the end drives the rod, and the rod the
//! slip, which may stop or reverse during the impact (E. J. Routh, *Dynamics of a System of Rigid Bodies*,
//! 1905; Y. Wang and M. T. Mason, *Two-dimensional rigid-body collisions with friction*, 1992).
//!
//! An impulse along the floor changes the slip by `B1`, one along the normal the approach by `B2`, and each
//! the other by `B3`, for the rod of 1 kg at 45 degrees: 5/2, 5/2 and 3/2.

use crate::cases::case::{Case, Outcome, Setting};
use crate::cases::rig::{Rig, rod, shape, surface, tilted};
use backstop::Error;
use backstop::Geometry;
use glam::{DVec3, Vec3};

pub(in crate::cases) const CASES: &[Case] = &[
    Case {
        name: "rod-slip",
        about: "a rod at 45 degrees strikes the floor with its end, which slips on, mu = 0.3, e = 0.5: the \
            impulse",
        formula: "J = m u (1 + e) / (B2 + mu B3), by Newton's law and Poisson's",
        unit: "N s",
        bar: 1e-4,
        measure: |setting| rod_impact(setting, Strike { friction: 0.3, e: 0.5, slip: 4.0 }),
    },
    Case {
        name: "rod-slip-plastic",
        about: "the same with e = 0",
        formula: "J = m u / (B2 + mu B3)",
        unit: "N s",
        bar: 1e-3,
        measure: |setting| rod_impact(setting, Strike { friction: 0.3, e: 0.0, slip: 4.0 }),
    },
    Case {
        name: "rod-stick",
        about: "the same with mu = 0.8 and less slip, which stops",
        formula: "J = m (B1 u - B3 v) / (B1 B2 - B3²)",
        unit: "N s",
        bar: 1e-3,
        measure: |setting| rod_impact(setting, Strike { friction: 0.8, e: 0.0, slip: 1.0 }),
    },
    Case {
        name: "rod-reversal",
        about: "the same with mu = 0.3 < B3 / B1 and e = 0.5: the slip stops during compression and reverses",
        formula: "J = m (1 + e) (u - 2 mu B3 v / (B3 + mu B1)) / (B2 - mu B3), by Routh's method",
        unit: "N s",
        bar: 1e-2,
        measure: |setting| rod_impact(setting, Strike { friction: 0.3, e: 0.5, slip: 1.0 }),
    },
];

const LENGTH: f64 = 1.0;
const POINT: f64 = 0.05;
/// How fast the end approaches the floor [m/s].
const SPEED: f64 = 2.0;
/// Responses of the end of the rod to impulses [1/kg].
const B: [f64; 3] = [2.5, 2.5, 1.5];

/// A surface, and the slip with which the end arrives [m/s].
#[derive(Clone, Copy)]
struct Strike {
    friction: f64,
    e: f64,
    slip: f64,
}

impl Strike {
    /// The normal impulse of the rod of 1 kg, by Routh's method and Poisson's restitution [N s].
    fn impulse(self) -> f64 {
        let Strike { friction, e, slip } = self;
        let [b1, b2, b3] = B;
        // Impulses at which the slip stops and at which compression ends, if the slip goes on.
        let (stops, ends) = (slip / (b3 + friction * b1), SPEED / (b2 + friction * b3));
        if (1.0 + e) * ends <= stops {
            (1.0 + e) * ends
        } else if friction >= b3 / b1 {
            (1.0 + e) * (b1 * SPEED - b3 * slip) / (b1 * b2 - b3 * b3)
        } else {
            (1.0 + e) * (SPEED - 2.0 * friction * b3 * stops) / (b2 - friction * b3)
        }
    }
}

fn rod_impact(setting: &Setting, strike: Strike) -> Result<Outcome, Error> {
    let mut rig = Rig::new(setting, Vec3::ZERO)?;
    let material = surface(strike.friction, strike.e);
    rig.floor(material)?;
    // The lower end is behind the centre: the impact drives it back.
    let turn = tilted(DVec3::Z, -45f64.to_radians());
    let mut point = shape(Geometry::Sphere { radius: POINT as f32 }, material);
    // The rod's lower end is the lowest point of the ball, so that the impulse passes through it.
    let up = turn.inverse().as_dquat() * DVec3::Y * POINT;
    point.position = (DVec3::NEG_Y * (0.5 * LENGTH) + up).as_vec3();
    let height = 0.5 * LENGTH * libm::cos(45f64.to_radians());
    // Without restitution it starts in touch: a gap that a step closes first divides the impact in two.
    let height = if strike.e > 0.0 { height + 0.31 } else { height };
    let body = rod(LENGTH).with_shape(point).with_position(DVec3::Y * height).with_rotation(turn);
    let velocity = DVec3::new(strike.slip, -SPEED, 0.0).as_vec3();
    let body = rig.add(&body.with_velocity(velocity, Vec3::ZERO))?;
    rig.until(2.0, |rig| Ok(rig.velocity(body)?.y != -SPEED))?;
    // An impact that takes more than one step, by springs or with the gap closed first.
    rig.run_to(rig.time + 0.05)?;
    Ok(Outcome::of(strike.impulse(), rig.velocity(body)?.y + SPEED))
}

#[test]
fn the_formulas_are_those_of_the_laws() {
    use crate::impacts::{Body, Law, Motion};
    use glam::DVec2;
    let arm = DVec2::new(-0.5, -0.5) * (0.5 * LENGTH * 2f64.sqrt());
    for (friction, e, slip) in [(0.3, 0.5, 4.0), (0.3, 0.0, 4.0), (0.8, 0.0, 1.0), (0.3, 0.5, 1.0)] {
        let body = Body { gyration: (1.0f64 / 12.0).sqrt(), friction, restitution: e };
        let before = Motion { velocity: DVec2::new(slip, -SPEED), spin: 0.0 };
        let found = Law::Poisson.after(before, arm, &body).velocity.y + SPEED;
        assert!((found - Strike { friction, e, slip }.impulse()).abs() < 1e-9, "{friction} {e} {slip}");
    }
}
