use super::*;
use crate::random::Random;

impl Random {
    fn ulp(&mut self, x: f32) -> f32 {
        match self.below(3) {
            0 => x.next_up(),
            1 => x.next_down(),
            _ => x,
        }
    }
    fn jitter(&mut self, v: Vec3) -> Vec3 {
        Vec3::new(self.ulp(v.x), self.ulp(v.y), self.ulp(v.z))
    }
}

/// The tolerance that the builder works with: three units in the last place of each coordinate.
fn noise(points: &[Vec3]) -> f64 {
    let reach = points.iter().fold(Vec3::ZERO, |m, p| m.max(p.abs()));
    3.0 * f64::from(f32::EPSILON) * reach.as_dvec3().element_sum()
}

/// Everything that the type promises, slowly.
fn check(points: &[Vec3], hull: &ConvexHull) {
    let noise = noise(points);
    let (v, e, f) = (hull.vertices.len(), hull.edges.len(), hull.planes.len());
    assert_eq!(v as i64 - e as i64 + f as i64, 2, "Euler: {v} {e} {f}");
    assert!(v <= ConvexHull::MAX_VERTICES);
    assert_eq!(hull.faces().len(), f);
    assert_eq!(usize::from(hull.face_start[f]), hull.face_vertices.len());
    // Vertices are points of the caller.
    assert!(hull.vertices.iter().all(|v| points.contains(v)));
    // Every point is inside every plane.
    for (n, offset) in &hull.planes {
        assert!((n.as_dvec3().length() - 1.0).abs() < 1e-6);
        for p in points {
            let out = n.as_dvec3().dot(p.as_dvec3()) - f64::from(*offset);
            assert!(out <= f64::from(hull.left_out) + 4.0 * noise, "out by {} noises", out / noise);
        }
    }
    let mut faces_at = vec![0; v];
    for (face, (n, offset)) in hull.faces().zip(&hull.planes) {
        assert!(face.len() >= 3);
        let n = n.as_dvec3();
        let at = |i: usize| hull.vertices[usize::from(face[i % face.len()])].as_dvec3();
        for i in 0..face.len() {
            faces_at[usize::from(face[i])] += 1;
            let off = n.dot(at(i)) - f64::from(*offset);
            assert!(off.abs() <= 4.0 * noise, "off the plane by {} noises", off / noise);
            let turn = n.dot((at(i + 1) - at(i)).cross(at(i + 2) - at(i + 1)));
            assert!(turn >= -2.0 * noise * (at(i + 2) - at(i)).length(), "a dent");
        }
    }
    assert!(faces_at.iter().all(|&n| n >= 3), "a vertex on an edge");
    // Each edge is in its two faces, one way and the other.
    let has = |face: u16, a: u16, b: u16| {
        let face = hull.faces().nth(usize::from(face)).unwrap();
        (0..face.len()).any(|i| face[i] == a && face[(i + 1) % face.len()] == b)
    };
    for edge in &hull.edges {
        let ([a, b], [left, right]) = (edge.vertices, edge.faces);
        assert!(a < b && left != right && has(left, a, b) && has(right, b, a));
    }
    assert_eq!(2 * e, hull.face_vertices.len());
    // Data that is stored twice agrees.
    for (i, v) in hull.vertices.iter().enumerate() {
        let [x, y, z] = hull.vertex_chunks[i / 8];
        assert_eq!(*v, Vec3::new(x[i % 8], y[i % 8], z[i % 8]));
    }
    assert_eq!(hull.vertex_chunks.len(), v.div_ceil(8));
    assert_eq!(hull.normal_chunks.len(), f.div_ceil(8));
    assert!(hull.inner_radius <= hull.radius && hull.moments.mass > 0.0);
}

fn built(points: &[Vec3]) -> ConvexHull {
    let hull = ConvexHull::new(points).unwrap_or_else(|e| panic!("{e}: {points:?}"));
    check(points, &hull);
    hull
}

fn counts(hull: &ConvexHull) -> (usize, usize, usize) {
    (hull.vertices.len(), hull.edges.len(), hull.planes.len())
}

#[test]
fn a_grid_of_points_in_a_cube_is_a_cube() {
    let grid = |n: i32| {
        (0..n * n * n).map(move |i| Vec3::new((i % n) as f32, (i / n % n) as f32, (i / n / n) as f32))
    };
    for n in 2..12 {
        for scale in [1e-3, 0.1, 1.0, 1e3] {
            let points: Vec<Vec3> = grid(n).map(|p| p * scale).collect();
            assert_eq!(counts(&built(&points)), (8, 12, 6));
            let mut random = Random(n as u64);
            for _ in 0..4 {
                let (r, t) = (random.turn(), random.cube() * scale * n as f32);
                let turned: Vec<Vec3> = points.iter().map(|&p| r * p + t).collect();
                assert_eq!(counts(&built(&turned)), (8, 12, 6), "n {n} scale {scale}");
            }
        }
    }
}

#[test]
fn random_hulls_are_closed_convex_polyhedra() {
    let mut random = Random(1);
    for round in 0..4000 {
        let scale = [1e-3, 0.03, 1.0, 20.0, 1e3][random.below(5)];
        // Thin ones out of very few points may be flat by chance.
        let n = if matches!(round % 8, 2 | 3) { 12 } else { 4 } + random.below(60);
        let mut points: Vec<Vec3> = match round % 8 {
            0 => (0..n).map(|_| random.direction()).collect(),
            1 => (0..n).map(|_| random.cube()).collect(),
            2 => (0..n).map(|_| random.cube() * Vec3::new(1.0, 1e-4, 1.0)).collect(),
            3 => (0..n).map(|_| random.cube() * Vec3::new(1e-4, 1.0, 1e-4)).collect(),
            // A grid's corners, and many points on its faces.
            4 => (0..n + 20).map(|_| (random.cube() * 2.0).round()).collect(),
            // A prism: two polygons.
            5 => (0..2 * n)
                .map(|i| {
                    let angle = (i / 2) as f32 / n as f32 * std::f32::consts::TAU;
                    let y = if i % 2 == 0 { 0.5 } else { -0.5 };
                    Vec3::new(libm::cosf(angle), y, libm::sinf(angle))
                })
                .collect(),
            // Clusters around few points.
            6 => (0..n).map(|_| Random(random.below(12) as u64).cube() + random.cube() * 1e-5).collect(),
            _ => (0..n).map(|_| random.direction() * Vec3::new(1.0, 0.2, 3.0)).collect(),
        };
        let (rotation, offset) = (random.turn(), random.cube());
        if random.below(2) == 0 {
            points.iter_mut().for_each(|p| *p = rotation * *p + offset);
        }
        points.iter_mut().for_each(|p| *p *= scale);
        let copies: Vec<Vec3> = points.iter().copied().step_by(3).collect();
        points.extend(&copies);
        if random.below(2) == 0 {
            points.iter_mut().for_each(|p| *p = random.jitter(*p));
        }
        match ConvexHull::new(&points) {
            Ok(hull) => check(&points, &hull),
            // Few points on a grid, or in a few clusters, may be flat.
            Err(Error::Degenerate(_)) if matches!(round % 8, 4 | 6) => {}
            Err(e) => panic!("round {round}: {e}"),
        }
    }
}

#[test]
fn a_prism_with_many_sides_has_two_polygons_and_the_sides() {
    for sides in [3, 8, 31, 64, 128] {
        let mut random = Random(sides as u64);
        for _ in 0..10 {
            let rotation = random.turn();
            let points: Vec<Vec3> = (0..2 * sides)
                .map(|i| {
                    let angle = (i / 2) as f32 / sides as f32 * std::f32::consts::TAU;
                    let y = if i % 2 == 0 { 0.5 } else { -0.5 };
                    rotation * Vec3::new(libm::cosf(angle), y, libm::sinf(angle))
                })
                .collect();
            assert_eq!(counts(&built(&points)), (2 * sides, 3 * sides, sides + 2));
        }
    }
}

#[test]
fn flat_faces_with_noise_in_the_last_place_stay_one_face() {
    let mut random = Random(5);
    for _ in 0..200 {
        let (rotation, size) = (random.turn(), random.cube().abs() * 5.0 + 0.1);
        // The corners, and points on all faces and edges.
        let mut points: Vec<Vec3> = (0..8)
            .map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0)
            .collect();
        for i in 0..300 {
            let mut p = random.cube();
            p[i % 3] = p[i % 3].signum();
            if i % 4 == 0 {
                p[(i + 1) % 3] = p[(i + 1) % 3].signum();
            }
            points.push(p);
        }
        let points: Vec<Vec3> = points.iter().map(|&p| random.jitter(rotation * (p * size))).collect();
        assert_eq!(counts(&built(&points)), (8, 12, 6));
    }
}

#[test]
fn up_to_the_limit_every_vertex_is_kept_and_beyond_it_the_rest_is_near() {
    let mut random = Random(9);
    let most = ConvexHull::MAX_VERTICES;
    let few: Vec<Vec3> = (0..most).map(|_| random.direction()).collect();
    let hull = built(&few);
    assert!(hull.vertices.len() > most - 5 && hull.left_out < 1e-6, "{}", hull.vertices.len());

    let many: Vec<Vec3> = (0..100_000).map(|_| random.direction()).collect();
    let hull = ConvexHull::new(&many).unwrap();
    check(&many, &hull);
    assert_eq!(hull.vertices.len(), most);
    // A cap around each of n vertices has the area 4 pi / n: its height is 2 / n, here 0.8 %; uneven caps
    // twice.
    assert!(hull.left_out < 0.02, "{}", hull.left_out);
}

#[test]
fn a_hundred_thousand_points_make_a_valid_hull() {
    let mut random = Random(21);
    let rotation = random.turn();
    for kind in 0..4 {
        let points: Vec<Vec3> = (0..100_000)
            .map(|i| {
                let mut p = random.cube();
                match kind {
                    0 => {}
                    // On the faces of a box, with noise.
                    1 => {
                        p[i % 3] = p[i % 3].signum();
                        p = rotation * p;
                    }
                    // On a cylinder.
                    2 => {
                        p = rotation * (random.direction() * Vec3::new(1.0, 0.0, 1.0)).normalize().with_y(p.y)
                    }
                    // On a plate.
                    _ => p = random.direction() * Vec3::new(1.0, 1e-3, 1.0),
                }
                p
            })
            .collect();
        check(&points, &ConvexHull::new(&points).unwrap());
    }
}

#[test]
fn flat_sets_and_bad_numbers_are_refused_by_name() {
    let refused = |points: &[Vec3]| ConvexHull::new(points).unwrap_err().to_string();
    let mut random = Random(3);
    assert!(refused(&[]).contains("four points"));
    for _ in 0..100 {
        let (p, r) = (random.cube() * 100.0, random.turn());
        assert!(refused(&[p; 10]).contains("all equal"));
        let line: Vec<Vec3> = (0..10).map(|i| p + r * Vec3::X * i as f32).collect();
        assert!(refused(&line).contains("on a line"));
        let plane: Vec<Vec3> =
            (0..30).map(|i| p + r * Vec3::new((i % 6) as f32, (i / 6) as f32, 0.0)).collect();
        assert!(refused(&plane).contains("in a plane"), "{}", refused(&plane));
    }
    let mut points: Vec<Vec3> = (0..10).map(|_| random.cube()).collect();
    points[7].y = f32::NAN;
    assert!(refused(&points).contains("finite"));
    points[7].y = f32::INFINITY;
    assert!(refused(&points).contains("finite"));
}
