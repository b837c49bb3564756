//! Points to a convex hull, by what its documentation promises.

use super::input::Input;
use backstop::ConvexHull;
use backstop::glam::Vec3;

pub fn run(bytes: &[u8]) {
    let input = &mut Input::new(bytes);
    let mut points = input.points(200);
    // Points that are nearly others, or in a grid, are the hard ones.
    let rounded = input.byte();
    for i in 0..points.len() {
        match rounded % 4 {
            0 => points[i] = points[i].round(),
            1 if i > 0 && i % 3 == 0 => points[i] = points[i - 1] + Vec3::splat(1e-7),
            2 => points[i] *= input.size(),
            _ => {}
        }
    }
    let Ok(hull) = ConvexHull::new(&points) else { return };
    let (vertices, faces) = (hull.vertices(), hull.faces());
    assert!((4..=ConvexHull::MAX_VERTICES).contains(&vertices.len()));
    assert!(vertices.iter().all(|v| points.contains(v)), "a vertex is none of the points");
    assert!(hull.left_out().is_finite());
    let corners: usize = hull.faces().map(<[u16]>::len).sum();
    // Each edge is in two faces: by Euler, V - E + F = 2.
    assert_eq!(vertices.len() + faces.len(), corners / 2 + 2);
}
