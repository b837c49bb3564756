//! Sphere against sphere: one point, on the line of centres.

use super::lanes_io::{ManifoldLanes, PairLanes, direction};
use crate::lanes::{Lanes, Vec3, kernel};

kernel! {
    /// Spheres with the same centre are parted along y.
    pub(crate) fn sphere_sphere<'a, L: Lanes>(p: &'a PairLanes<L>) -> ManifoldLanes<L> {
        let up = Vec3::splat(glam::Vec3::Y);
        let (normal, distance) = direction(p.position, L::zero(), up);
        let separation = distance - (p.size_a[0] + p.size_b[0]);
        let position = normal * (p.size_a[0] + separation * L::splat(0.5));
        ManifoldLanes::single(normal, position, separation, p.margin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Quat;
    use crate::narrow_phase::Relative;
    use crate::narrow_phase::pairs::lanes_io::testing::*;
    use glam::{Vec3, vec3};

    #[test]
    fn the_point_lies_midway_on_the_line_of_centres_at_any_width() {
        let mut pairs = pairs(1, 4000, 2.0);
        pairs[0].0.position = Vec3::ZERO;
        pairs[1].0.position = vec3(1e-25, 0.0, 0.0);
        let found = same_at_any_width(&pairs, sphere_sphere, sphere_sphere, sphere_sphere);
        for (m, (relative, a, b, margin)) in found.iter().zip(&pairs).skip(2) {
            let centre = relative.position.as_dvec3();
            let truth = centre.length() - a[0] as f64 - b[0] as f64;
            assert!(m.gap() as f64 <= truth.max(0.0) + 1e-5);
            assert_eq!(m.size(), (truth < *margin as f64) as u32);
            for point in m.points() {
                assert!((point.separation as f64 - truth).abs() < 1e-6);
                // Along the normal, for beyond a centre the distance grows again.
                let on_a = point.position.dot(m.normal) - a[0];
                let on_b = (relative.position - point.position).dot(m.normal) - b[0];
                assert!((on_a - on_b).abs() < 1e-5 && (on_a * 2.0 - point.separation).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn spheres_with_one_centre_part_along_y_by_the_sum_of_radii() {
        let relative = Relative { position: Vec3::ZERO, rotation: Quat::IDENTITY };
        let m = run::<f32>(&[(relative, [0.5; 4], [0.25; 4], 0.0)], sphere_sphere)[0];
        assert_eq!((m.normal, m.count, m.points[0].separation), (Vec3::Y, 1, -0.75));
    }
}
