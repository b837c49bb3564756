//! Sphere against box: one point.

use super::lanes_io::{ManifoldLanes, PairLanes, direction};
use crate::lanes::{Lanes, Vec3, kernel};

kernel! {
    /// Outside: towards the nearest point of the box. Centre within the box: out through the nearest face.
    pub(crate) fn sphere_box<'a, L: Lanes>(p: &'a PairLanes<L>) -> ManifoldLanes<L> {
        let axes = p.rotation.to_matrix();
        let half = Vec3::new(p.size_b[0], p.size_b[1], p.size_b[2]);
        let centre = -axes.mul_transposed(p.position);
        let excess = centre - centre.max(-half).min(half);
        let (face, depth) = nearest_face(centre, half);
        // A component within the box is exactly zero in `excess`, so the direction is sound down to tiny
        // gaps.
        let (outwards, distance) = direction(excess, L::zero(), face);
        let inside = distance.le(L::splat(1e-15));
        let gap = L::select(inside, depth, distance);
        let normal = -axes.mul(outwards);
        let separation = gap - p.size_a[0];
        let position = normal * (p.size_a[0] + separation * L::splat(0.5));
        ManifoldLanes::single(normal, position, separation, p.margin)
    }
}

/// Outward normal of the face of the box that is nearest to a point within it, and the (negative) distance.
#[inline(always)]
fn nearest_face<L: Lanes>(point: Vec3<L>, half: Vec3<L>) -> (Vec3<L>, L) {
    let depth = point.abs() - half;
    let deepest = depth.x.max(depth.y).max(depth.z);
    let on_y = depth.y.ge(depth.x) & depth.y.ge(depth.z);
    let on_x = !on_y & depth.x.ge(depth.z);
    let zero = L::zero();
    let face = Vec3::new(
        L::select(on_x, point.x.sign(), zero),
        L::select(on_y, point.y.sign(), zero),
        L::select(on_x | on_y, zero, point.z.sign()),
    );
    (face, deepest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Quat;
    use crate::narrow_phase::Relative;
    use crate::narrow_phase::pairs::lanes_io::testing::*;
    use glam::{DVec3, Vec3, vec3};

    /// Signed distance of a point from a box (Quilez, *Distance functions*).
    fn signed(point: DVec3, half: DVec3) -> f64 {
        let q = point.abs() - half;
        q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
    }

    #[test]
    fn the_separation_is_the_signed_distance_at_any_width() {
        let found_in = pairs(3, 4000, 1.5);
        let found = same_at_any_width(&found_in, sphere_box, sphere_box, sphere_box);
        for (m, (relative, a, b, margin)) in found.iter().zip(&found_in) {
            let (into_b, half) =
                (relative.rotation.as_dquat().inverse(), DVec3::new(b[0] as f64, b[1] as f64, b[2] as f64));
            let truth = signed(into_b * -relative.position.as_dvec3(), half) - a[0] as f64;
            assert!(m.gap() as f64 <= truth.max(0.0) + 1e-5);
            assert!(m.size() == (truth < *margin as f64) as u32 || (truth - *margin as f64).abs() < 1e-5);
            for point in m.points() {
                assert!((point.separation as f64 - truth).abs() < 1e-5);
                let on_b = signed(into_b * (point.position - relative.position).as_dvec3(), half);
                let middle = 0.5 * point.separation as f64;
                // In overlap at an edge, the middle is nearer to a face than to the point on the edge.
                assert!(on_b > middle - 1e-5 && (truth < 0.0 || on_b < middle + 1e-5));
            }
        }
    }

    #[test]
    fn a_sphere_within_a_box_leaves_through_the_nearest_face() {
        let at = |position| {
            let relative = Relative { position, rotation: Quat::IDENTITY };
            run::<f32>(&[(relative, [0.1; 4], [1.0, 2.0, 3.0, 0.0], 0.0)], sphere_box)[0]
        };
        let m = at(vec3(-0.9, 0.0, 0.0)); // the centre is 0.1 m below the face at +x
        assert_eq!(m.normal, Vec3::NEG_X);
        assert!((m.points[0].separation + 0.2).abs() < 1e-6);
        let m = at(vec3(0.0, 1.75, 0.0)); // 0.25 m within the face at -y
        assert_eq!((m.normal, m.points[0].separation), (Vec3::Y, -0.35));
        assert_eq!(at(Vec3::ZERO).normal.length(), 1.0);
    }
}
