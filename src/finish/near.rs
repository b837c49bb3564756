//! The point of a triangle that is nearest to another point.

use glam::{DVec3, Vec3};

/// Vector from the nearest point of a triangle to a point [m]. By the regions in which a corner, an edge or the inside
/// is nearest (Ericson, *Real-Time Collision Detection*, 2005, 5.1.5), in `f64`, so that slivers need no care.
pub(super) fn from_triangle(point: Vec3, [a, b, c]: [Vec3; 3]) -> DVec3 {
    let [p, a, b, c] = [point, a, b, c].map(Vec3::as_dvec3);
    let (ab, ac) = (b - a, c - a);
    let to = |corner: DVec3| ((p - corner).dot(ab), (p - corner).dot(ac));
    let ((a1, a2), (b1, b2), (c1, c2)) = (to(a), to(b), to(c));
    if a1 <= 0.0 && a2 <= 0.0 {
        return p - a;
    }
    if b1 >= 0.0 && b2 <= b1 {
        return p - b;
    }
    if c2 >= 0.0 && c1 <= c2 {
        return p - c;
    }
    // An edge without length is none: its ends are corners, and the other edges hold them.
    let edge = |start: DVec3, way: DVec3, before: f64, after: f64| {
        (before >= 0.0 && after >= 0.0 && before + after > 0.0)
            .then(|| p - (start + way * (before / (before + after))))
    };
    let (of_a, of_b, of_c) = (b1 * c2 - c1 * b2, c1 * a2 - a1 * c2, a1 * b2 - b1 * a2);
    if of_c <= 0.0
        && let Some(away) = edge(a, ab, a1, -b1)
    {
        return away;
    }
    if of_b <= 0.0
        && let Some(away) = edge(a, ac, a2, -c2)
    {
        return away;
    }
    if of_a <= 0.0
        && let Some(away) = edge(b, c - b, b2 - b1, c1 - c2)
    {
        return away;
    }
    p - (a + (ab * of_b + ac * of_c) / (of_a + of_b + of_c))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::vec3;

    /// Against a fine grid of points of the triangle, degenerate ones too.
    #[test]
    fn no_point_of_the_triangle_is_nearer() {
        let mut seed = 5u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        for i in 0..600 {
            let mut v = || vec3(next(), next(), next());
            let (point, a, b) = (v() * 2.0, v(), v());
            let c = match i % 6 {
                0 => a,
                1 => b,
                2 => a.midpoint(b),
                _ => v(),
            };
            let b = if i % 18 == 3 { a } else { b };
            let found = from_triangle(point, [a, b, c]);
            let n = 60;
            let mut least = f32::INFINITY;
            for j in 0..=n {
                for k in 0..=n - j {
                    let (s, t) = (j as f32 / n as f32, k as f32 / n as f32);
                    least = least.min((point - (a + (b - a) * s + (c - a) * t)).length());
                }
            }
            let far = found.length() as f32;
            assert!(far <= least + 1e-5 && far > least - 0.1, "{far} {least} {a} {b} {c} {point}");
        }
    }
}
