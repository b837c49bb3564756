//! How a body turns.

use glam::{Mat3, Quat, Vec3};

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

/// Free rotation over `h` seconds: turns `rotation` and returns it with the new angular velocity. Implicit midpoint
/// in the angular momentum, which stays what it was to rounding: the energy is bounded by it, so no spin can blow
/// up, unlike with an explicit gyroscopic torque.
pub(crate) fn tumble(rotation: Quat, omega: Vec3, inertia: Vec3, h: f32) -> (Quat, Vec3) {
    let local = rotation.conjugate() * omega;
    let momentum = Mat3::from_quat(rotation) * (inertia * local);
    let at = |q: Quat| {
        let m = Mat3::from_quat(q);
        m * ((m.transpose() * momentum) / inertia)
    };
    let mut middle = omega;
    for _ in 0..3 {
        middle = at(exp_map(middle * (0.5 * h)) * rotation);
    }
    let turned = (exp_map(middle * h) * rotation).normalize();
    (turned, at(turned))
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
            (q, w) = tumble(q, w, inertia, h);
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
