//! The equivalence principle: points inside the hull of others change no motion.

use super::comparison::{best, worst_of_tipping};
use super::*;
use std::f64::consts::TAU;

/// A face that lies on y = -0.5, as points that push up.
fn face(places: impl IntoIterator<Item = (f64, f64)>) -> Vec<Point> {
    let point = |(x, z): (f64, f64)| Point { position: DVec3::new(x, -0.5, z), normal: DVec3::Y, depth: 0.0 };
    places.into_iter().map(point).collect()
}

fn ring(count: u32, radius: f64) -> Vec<(f64, f64)> {
    let angle = |i: u32| TAU * (f64::from(i) + 0.3) / f64::from(count);
    (0..count).map(|i| (radius * libm::cos(angle(i)), radius * libm::sin(angle(i)))).collect()
}

/// Shapes by name, and how many corners their hulls have.
fn shapes() -> Vec<(&'static str, Vec<Point>, usize)> {
    let grid =
        |n: i32| (-n..=n).flat_map(move |x| (-n..=n).map(move |z| (f64::from(x) * 0.2, f64::from(z) * 0.2)));
    let square = [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)];
    let l = [(-0.5, -0.5), (0.5, -0.5), (0.5, -0.1), (-0.1, -0.1), (-0.1, 0.5), (-0.5, 0.5)];
    let with_middle = square.into_iter().chain([(0.1, 0.2), (0.0, 0.0), (-0.3, 0.4)]);
    vec![
        ("square", face(square), 4),
        ("square with points inside", face(with_middle), 4),
        ("grid of 49", face(grid(3)), 4),
        ("l", face(l), 5),
        ("triangle", face(ring(3, 0.5)), 3),
        ("pentagon", face(ring(5, 0.5)), 5),
        ("octagon", face(ring(8, 0.5)), 8),
        ("ring of 32", face(ring(32, 0.5)), 32),
        ("two rings", face(ring(6, 0.5).into_iter().chain(ring(6, 0.3))), 6),
    ]
}

/// A body that falls, spins and slides: all of it at once.
fn impacts() -> Vec<Impact> {
    let inertia = DMat3::from_diagonal(DVec3::new(0.3, 0.4, 0.25));
    let mut all = Vec::new();
    for friction in [0.0, 0.5] {
        for velocity in [
            [DVec3::NEG_Y, DVec3::ZERO],
            [DVec3::new(0.3, -1.0, 0.2), DVec3::new(1.0, 0.5, -0.7)],
            [DVec3::new(0.0, -0.2, 0.0), DVec3::new(-2.0, 0.0, 1.0)],
            [DVec3::new(3.0, -0.5, 0.0), DVec3::new(0.0, 4.0, 0.0)],
        ] {
            all.push(Impact { mass: 2.0, inertia, velocity, friction });
        }
    }
    all
}

fn moved(impact: &Impact, points: &[Point]) -> [DVec3; 2] {
    impact.resolve(points).unwrap().0
}

fn apart(a: [DVec3; 2], b: [DVec3; 2]) -> f64 {
    (a[0] - b[0]).length().max((a[1] - b[1]).length())
}

fn of(points: &[Point], kept: &[usize]) -> Vec<Point> {
    kept.iter().map(|&i| points[i]).collect()
}

/// Without friction, any wrench of points of a face can come from the corners of its hull: motion is the same
/// to the solver's tolerance.
#[test]
fn the_whole_hull_moves_a_body_as_all_points_do() {
    for (name, points, corners) in shapes() {
        let kept = reduce(&points, Keep::Hull);
        assert_eq!(kept.len(), corners, "{name}");
        for impact in impacts().into_iter().filter(|impact| impact.friction == 0.0) {
            let off = apart(moved(&impact, &points), moved(&impact, &of(&points, &kept)));
            assert!(off < 1e-9, "{name}, {impact:?}: {off}");
        }
    }
}

/// A body that falls flat without rotation stops on four points of any shape.
#[test]
fn four_points_bear_what_falls_flat() {
    for (name, points, corners) in shapes() {
        let kept = reduce(&points, Keep::Most(4));
        assert_eq!(kept.len(), corners.min(4), "{name}");
        let off = apart(moved(&impacts()[0], &of(&points, &kept)), [DVec3::ZERO; 2]);
        assert!(off < 1e-9, "{name}: {off}");
    }
}

/// Shapes with four corners move the same without friction. Of more corners some are left out, and a body
/// that tips by one of these tips earlier; no four corners do better by more than a twentieth. With friction
/// even equal wrenches differ, as loads that are not unique do.
#[test]
fn four_points_move_a_body_nearly_as_the_best_four_do() {
    for (name, points, corners) in shapes() {
        let kept = of(&points, &reduce(&points, Keep::Most(4)));
        let off = [0.0, 0.5].map(|friction| worst_of_tipping(&points, &kept, friction));
        let least = if corners <= 8 {
            best(&points, false, |four| worst_of_tipping(&points, &of(&points, four), 0.0))
        } else {
            f64::NAN
        };
        println!(
            "{name:28} {:2} -> {} points: off by {:.3} without friction, {:.3} with; best four corners {least:.3}",
            points.len(),
            kept.len(),
            off[0],
            off[1]
        );
        let most = if corners <= 4 { 1e-9 } else { least + 0.05 };
        assert!(off[0] < most || least.is_nan(), "{name}: {off:?}, {least}");
    }
}

/// Two faces of a wedge are two clusters, whose points are reduced apart.
#[test]
fn normals_that_differ_are_clusters_of_their_own() {
    let mut points = face(ring(12, 0.5));
    let side = DVec3::new(1.0, 1.0, 0.0).normalize();
    points.extend(ring(12, 0.4).into_iter().map(|(x, z)| {
        let (t, s) = side.any_orthonormal_pair();
        Point { position: t * x + s * z - DVec3::X, normal: side, depth: 0.0 }
    }));
    let kept = reduce(&points, Keep::Most(4));
    assert_eq!(kept.iter().filter(|&&i| i < 12).count(), 4, "{kept:?}");
    assert_eq!(kept.iter().filter(|&&i| i >= 12).count(), 4, "{kept:?}");
}

/// The deepest point is kept, even in the middle; few, equal or no points are handled.
#[test]
fn the_deepest_point_is_kept() {
    let mut points = face(ring(9, 0.5));
    points.push(Point { position: DVec3::new(0.05, -0.5, 0.02), normal: DVec3::Y, depth: 0.01 });
    for most in 1..5 {
        let kept = reduce(&points, Keep::Most(most));
        assert!(kept.contains(&9) && kept.len() == most, "{most}: {kept:?}");
    }
    assert_eq!(reduce(&points[..1], Keep::Most(4)), [0]);
    assert_eq!(reduce(&[points[0], points[0], points[0]], Keep::Most(4)).len(), 1);
    assert!(reduce(&[], Keep::Most(4)).is_empty());
    let odd = Point { depth: f64::NAN, ..points[0] };
    assert!(reduce(&[odd], Keep::Most(4)).is_empty());
}
