//! How a body turns.

use crate::math::Quat;
use glam::Vec3;

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

/// The angular velocity of a body that contacts turned from one orientation to another: its angular momentum
/// is kept, unless that would take more energy than there was. A needle that is turned by more than its
/// moments allow would otherwise spin up without bound.
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
}
