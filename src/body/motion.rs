//! How a body turns.

use glam::{DQuat, DVec3, Quat, Vec3};

/// The rotation by the angle |v| [rad] about v. Polynomials below 1 rad, so that the bits don't depend on the
/// platform's sine.
pub(crate) fn exp_map(v: Vec3) -> Quat {
    let t = v.length_squared();
    let (s, c) = if t < 1.0 {
        (
            0.5 + t * (-1.0 / 48.0 + t * (1.0 / 3840.0 + t * (-1.0 / 645_120.0))),
            1.0 + t * (-1.0 / 8.0 + t * (1.0 / 384.0 + t * (-1.0 / 46_080.0 + t * (1.0 / 10_321_920.0)))),
        )
    } else {
        let angle = t.sqrt();
        (libm::sinf(0.5 * angle) / angle, libm::cosf(0.5 * angle))
    };
    Quat::from_xyzw(v.x * s, v.y * s, v.z * s, c).normalize()
}

/// A body that turns freely: with more digits on the way than it begins and ends with, because a rounding that favours one
/// direction, step after step, would add up.
#[derive(Clone, Copy)]
struct Free {
    turn: DQuat,
    /// As seen from the body.
    momentum: DVec3,
}

impl Free {
    /// Free rotation over `h` seconds.
    ///
    /// A symmetric top, which has a closed solution, and what is left of the difference of its two like moments, in turn
    /// (Touma and Wisdom, *Lie-Poisson integrators for rigid body dynamics in the solar system*, 1994). Every part is a
    /// rotation, so the angular momentum stays what it was to rounding at any length of step; a needle, whose moments are
    /// as 1 to 10 000, keeps its energy too, where an iteration for the implicit midpoint would not converge.
    fn tumble(&mut self, inverse: Vec3, h: f64) {
        let Free { turn, momentum } = self;
        // The axis of the top: the other two moments are the likest.
        let apart =
            [(inverse.y - inverse.z).abs(), (inverse.z - inverse.x).abs(), (inverse.x - inverse.y).abs()];
        let k = if apart[0] <= apart[1] && apart[0] <= apart[2] {
            0
        } else if apart[1] <= apart[2] {
            1
        } else {
            2
        };
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let across = 0.5 * (inverse[i] + inverse[j]);
        let rest = 0.25 * f64::from(inverse[i] - inverse[j]);
        let around = f64::from(inverse[k] - across) * h;
        if rest != 0.0 {
            spin_axis(turn, momentum, i, rest * h);
            spin_axis(turn, momentum, j, -rest * h);
        }
        let way = *momentum * (f64::from(across) * h);
        let (s, c) = half_turn(way.length_squared());
        *turn *= DQuat::from_xyzw(way.x * s, way.y * s, way.z * s, c);
        spin_axis(turn, momentum, k, around);
        if rest != 0.0 {
            spin_axis(turn, momentum, j, -rest * h);
            spin_axis(turn, momentum, i, rest * h);
        }
    }
}

/// Turns a body about one of its own axes, by `rate` times its momentum about that axis [rad]; the momentum as seen from
/// the body turns back.
#[inline(always)]
fn spin_axis(turn: &mut DQuat, momentum: &mut DVec3, axis: usize, rate: f64) {
    let angle = rate * momentum[axis];
    let (s, c) = half_turn(angle * angle);
    let s = s * angle;
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let q = turn.to_array();
    let mut out = [0.0; 4];
    out[axis] = q[axis] * c + q[3] * s;
    out[i] = q[i] * c + q[j] * s;
    out[j] = q[j] * c - q[i] * s;
    out[3] = q[3] * c - q[axis] * s;
    *turn = DQuat::from_array(out);
    let (sin, cos) = (2.0 * s * c, c * c - s * s);
    let (x, y) = (momentum[i], momentum[j]);
    (momentum[i], momentum[j]) = (x * cos + y * sin, y * cos - x * sin);
}

/// Sine of half an angle divided by the angle, and cosine of half of it, by the angle's square. The series ends where
/// the next term is below 1e-13.
#[inline(always)]
fn half_turn(t: f64) -> (f64, f64) {
    if t < 0.25 {
        let s = 1.0 / 645_120.0 - t * (1.0 / 185_794_560.0 - t * (1.0 / 81_749_606_400.0));
        let s = 0.5 - t * (1.0 / 48.0 - t * (1.0 / 3840.0 - t * s));
        let c = 1.0 / 46_080.0 - t * (1.0 / 10_321_920.0 - t * (1.0 / 3_715_891_200.0));
        (s, 1.0 - t * (1.0 / 8.0 - t * (1.0 / 384.0 - t * c)))
    } else {
        let angle = t.sqrt();
        let (s, c) = libm::sincos(0.5 * angle);
        (s / angle, c)
    }
}

/// A free body whose axis may wander by more than this at once is turned in several parts [rad], of which there are no more
/// than [`PARTS`]. At this [`Free::tumble`] alone keeps the energy of a box at 100 rad/s within 0.1 %; half of it
/// would make that 0.04 %, and cost twice the time of what spins.
const TURN: f32 = 0.1;
const PARTS: f32 = 16.0;

/// Free rotation over some seconds, however fast, in as many parts as it takes: turns `rotation` and returns it with the new
/// angular velocity. The momentum stays what it was. Where the parts are too few to tell where the axis has got to, so does the
/// energy.
pub(crate) fn turn_freely(rotation: Quat, spin: Vec3, inertia: Vec3, time: f32) -> (Quat, Vec3) {
    let wanted = (wobble(spin, inertia) * time / TURN).ceil();
    let parts = wanted.clamp(1.0, PARTS);
    let (turn, inverse) = (rotation.as_dquat().normalize(), inertia.recip());
    let before = inertia.as_dvec3() * (turn.conjugate() * spin.as_dvec3());
    let mut free = Free { turn, momentum: before };
    for _ in 0..parts as u32 {
        free.tumble(inverse, f64::from(time / parts));
    }
    if wanted > PARTS {
        with_energy(&mut free, inertia.as_dvec3(), before);
    }
    // Rounding turned the momentum by next to nothing, and must not change its length either.
    let turned = free.turn.normalize().as_quat();
    let local = free.momentum.normalize_or_zero() * before.length() / inertia.as_dvec3();
    (turned, (turned.as_dquat().normalize() * local).as_vec3())
}

/// Moves the momentum of a free body, as the body sees it, on its sphere to where the body has the energy that it had with the
/// momentum `before`; in the world the momentum stays what it is. Not for what is well resolved: its energy swings a little
/// about what it should be, and to hold it would make the body turn at a wrong rate.
///
/// The squares of its three parts are shares of a whole, and the energy is the mean of 1/I over them. The shares are tilted
/// by exp(x/I), which keeps them between zero and one and moves the mean one way; x is found by Newton's method.
#[cold]
fn with_energy(free: &mut Free, inertia: DVec3, before: DVec3) {
    const TRIES: usize = 24;
    let inverse = inertia.recip() * inertia.min_element();
    let (Some(first), Some(now)) = (before.try_normalize(), free.momentum.try_normalize()) else { return };
    let energy = (first * first).dot(inverse);
    // None is quite zero, or it could not grow.
    let mut shares = now * now + DVec3::splat(1e-12);
    for _ in 0..TRIES {
        shares /= shares.element_sum();
        let mean = shares.dot(inverse);
        let away = inverse - DVec3::splat(mean);
        let variance = shares.dot(away * away);
        if (energy - mean).abs() < 1e-12 * energy || variance <= 0.0 {
            break;
        }
        let most = 4.0 / away.abs().max_element();
        let tilt = ((energy - mean) / variance).clamp(-most, most);
        shares *= DVec3::from_array((away * tilt).to_array().map(libm::exp));
    }
    let moved = DVec3::from_array(shares.to_array().map(f64::sqrt)) * now.signum();
    if let Some(moved) = moved.try_normalize() {
        free.turn = (free.turn * DQuat::from_rotation_arc(moved, now)).normalize();
        free.momentum = moved;
    }
}

/// How fast the two like moments of a body turn it out of the motion of a symmetric top, at most [rad/s]: what
/// [`Free::tumble`] solves in turn, and so what its step must resolve. Zero for a symmetric top, however fast it spins.
pub(crate) fn wobble(omega: Vec3, inertia: Vec3) -> f32 {
    let inverse = inertia.recip();
    let apart = [(inverse.y - inverse.z).abs(), (inverse.z - inverse.x).abs(), (inverse.x - inverse.y).abs()];
    let rest = 0.5 * apart.into_iter().fold(f32::INFINITY, f32::min);
    rest * inertia.max_element() * omega.length()
}

/// The angular velocity of a body that contacts turned from one orientation to another: its angular momentum is kept,
/// unless that would take more energy than there was. A needle that is turned by more than its moments allow would
/// otherwise spin up without bound.
pub(crate) fn carry_spin(from: Quat, to: Quat, omega: Vec3, inertia: Vec3) -> Vec3 {
    let momentum = from * (inertia * (from.conjugate() * omega));
    let carried = to * ((to.conjugate() * momentum) / inertia);
    let (before, after) = (omega.dot(momentum), carried.dot(momentum));
    if after > before && before > 0.0 { carried * (before / after).sqrt() } else { carried }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_map_agrees_with_glam() {
        for i in 0..100 {
            let v = Vec3::new(0.3, -0.5, 0.7) * (0.05 * i as f32);
            let want = Quat::from_scaled_axis(v);
            assert!(exp_map(v).dot(want).abs() > 1.0 - 1e-6, "{v}");
        }
    }

    /// A needle of 1 m by 4 mm: moments as 1 to 10 000.
    #[test]
    fn a_needle_keeps_its_energy_and_momentum() {
        let inertia = Vec3::new(1.0, 1e-4, 1.001);
        // A tenth of a radian and less: what `finish` asks for.
        for h in [1.0 / 1600.0, 1.0 / 4000.0] {
            let (mut q, mut w) = (Quat::IDENTITY, Vec3::new(120.0, 90.0, -60.0));
            let momentum = inertia * w;
            let energy = w.dot(momentum);
            for _ in 0..500 {
                (q, w) = turn_freely(q, w, inertia, h);
                let now = q * (inertia * (q.conjugate() * w));
                assert!((now - momentum).length() < 1e-3 * momentum.length());
                assert!((w.dot(now) / energy - 1.0).abs() < 0.02, "{h} {}", w.dot(now) / energy);
            }
        }
    }

    /// Whatever the length of the step: a body that spins freely has the energy and the momentum that it had.
    #[test]
    fn free_turns_keep_energy_and_momentum_at_any_speed() {
        for inertia in [Vec3::new(1.0, 1.7, 2.3), Vec3::new(1.0, 1e-2, 1.004), Vec3::new(2.0, 2.1, 2.2)] {
            // Between the two a body that is far from symmetric loses or gains some: 1 % in 60 steps of 1/60 s at 200 rad/s.
            for (speed, dt) in [(3.0, 1.0 / 60.0), (2e4, 1.0 / 20.0)] {
                let (mut q, mut w) = (Quat::IDENTITY, Vec3::new(0.3, 0.9, -0.4).normalize() * speed);
                let momentum = inertia * w;
                let energy = w.dot(momentum);
                // While the parts resolve the motion, what the splitting makes the energy swing by; with too few parts, roundings
                // of 1000 steps.
                let most = if speed > 1000.0 { 2e-5 } else { 1e-3 };
                for step in 0..1000 {
                    (q, w) = turn_freely(q, w, inertia, dt);
                    let now = q * (inertia * (q.conjugate() * w));
                    let off = (w.dot(now) / energy - 1.0).abs();
                    assert!(off < most, "{inertia} {speed} {step}: energy is off by {off}");
                    assert!((now - momentum).length() < 1e-4 * momentum.length(), "{inertia} {speed} {step}");
                }
            }
        }
    }

    #[test]
    fn no_turn_by_contacts_adds_energy() {
        let inertia = Vec3::new(1.0, 1e-4, 1.001);
        let (mut q, mut w) = (Quat::IDENTITY, Vec3::new(10.0, 90.0, -60.0));
        let energy = w.dot(inertia * w);
        for i in 0..500 {
            let next = exp_map(Vec3::new(0.9, -0.2, 0.1 * i as f32)) * q;
            w = carry_spin(q, next, w, inertia);
            q = next;
            let local = q.conjugate() * w;
            assert!(local.dot(inertia * local) < 1.001 * energy);
        }
    }

    /// A box of 0.2 x 0.4 x 0.1 m and 1 kg, spun about its middle axis: METHODS of the field give the period of the
    /// flips in closed form (elliptic integral), 3.86563793 s for a start of (0.1, 10, 0) rad/s about the axes sorted
    /// by moment.
    #[test]
    fn a_tennis_racket_flips_with_the_period_of_the_elliptic_integral() {
        let inertia = Vec3::new(1.0 / 240.0, 1.0 / 60.0, 17.0 / 1200.0);
        let (mut q, mut w) = (Quat::IDENTITY, Vec3::new(0.1, 0.0, 10.0));
        let h = 1.0 / 240.0;
        let momentum = (inertia * w).length();
        let energy = 0.5 * w.dot(inertia * w);
        let mut crossings = Vec::new();
        let mut before = w.z;
        for step in 1..240 * 9 {
            (q, w) = turn_freely(q, w, inertia, h);
            let local = q.conjugate() * w;
            if before.signum() != local.z.signum() {
                crossings.push((step as f32 - local.z / (local.z - before)) * h);
            }
            before = local.z;
            assert!(((inertia * local).length() / momentum - 1.0).abs() < 1e-4);
            assert!((0.5 * local.dot(inertia * local) / energy - 1.0).abs() < 2e-3);
        }
        let period = crossings[2] - crossings[0];
        assert!((period / 3.865_638 - 1.0).abs() < 0.01, "{crossings:?}");
    }
}
