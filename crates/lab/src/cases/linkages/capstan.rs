//! A rope round a post (L. Euler, *Remarques sur l'effet du frottement dans l'équilibre*, 1762), as beads on
//! massless links.
//!
//! At a bead the rope turns by an angle d. The links pull with S and T along directions d/2 to both sides of
//! the tangent, so the bead presses with (S + T) sin(d/2) on the post and slips if (T - S) cos(d/2) is mu
//! times that: T / S = (1 + mu t) / (1 - mu t), t = tan(d/2). For many beads that is Euler's exp(mu phi).

use crate::cases::case::{Case, Outcome, Setting};
use crate::cases::rig::{Rig, dynamic, shape, surface};
use crate::cases::watch::threshold;
use backstop::BodyDesc;
use backstop::Error;
use backstop::{Frame, Geometry, JointDesc};
use glam::{DVec3, Vec3};

pub(in crate::cases) const CASES: &[Case] = &[Case {
    name: "capstan",
    about: "a rope of 12 beads lies half round a post, mu = 0.3, and is pulled at both ends: the ratio of the \
        forces from which on it slips",
    formula: "((1 + mu t) / (1 - mu t))^12, t = tan(d / 2), d = 15 degrees: 2.583; a fine rope has e^(mu pi)",
    unit: "",
    bar: 0.02,
    measure: capstan,
}];

const BEADS: u32 = 12;
const MU: f64 = 0.3;
const RADIUS: f64 = 0.05;
/// Distance of the beads from the axis of the post [m].
const AWAY: f64 = 0.55;
/// The lesser pull [N].
const PULL: f64 = 10.0;

fn capstan(setting: &Setting) -> Result<Outcome, Error> {
    let pitch = 15f64.to_radians();
    let share = MU * libm::tan(0.5 * pitch);
    let want = libm::pow((1.0 + share) / (1.0 - share), f64::from(BEADS));
    let around = |angle: f64| {
        let (sin, cos) = libm::sincos(angle);
        DVec3::new(cos, 0.0, sin)
    };
    let found = threshold([0.6 * want, 1.4 * want], 9, |ratio| {
        let mut rig = Rig::new(setting, Vec3::ZERO)?;
        let material = surface(MU, 0.0);
        let post = Geometry::cylinder(0.5, (AWAY - RADIUS) as f32);
        rig.add(&BodyDesc::fixed().with_shape(shape(post, material)))?;
        let mut beads = Vec::new();
        for i in 0..BEADS {
            let ball = Geometry::Sphere { radius: RADIUS as f32 };
            let bead = dynamic(ball, material, Vec3::ZERO).with_position(around(f64::from(i) * pitch) * AWAY);
            // A bead is a piece of the rope and does not roll.
            let bead = bead.with_lock_translation([false, true, false]).with_lock_rotation([true; 3]);
            beads.push(rig.add(&bead)?);
        }
        let link = (2.0 * AWAY * libm::sin(0.5 * pitch)) as f32;
        for pair in beads.windows(2) {
            let bodies = [pair[0], pair[1]];
            rig.world.add_joint(&JointDesc::distance(bodies, [Frame::default(); 2], link, link))?;
        }
        let ends = [(beads[0], -0.5, -PULL), (beads[beads.len() - 1], f64::from(BEADS) - 0.5, PULL * ratio)];
        let start = rig.place(beads[0])?;
        while rig.time < 2.0 {
            for (bead, place, pull) in ends {
                let radial = around(place * pitch);
                let tangent = DVec3::new(-radial.z, 0.0, radial.x);
                rig.world.add_force(bead, (tangent * pull).as_vec3())?;
            }
            rig.step()?;
            if (rig.place(beads[0])? - start).length() > 0.02 {
                return Ok(true);
            }
        }
        Ok(false)
    })?;
    Ok(Outcome::of(want, found))
}
