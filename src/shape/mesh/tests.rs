use super::testing::*;
use super::*;
use crate::shape::Ground;
use crate::shape::slabs::path_in_box;

#[test]
fn a_mesh_refuses_what_is_no_mesh_and_drops_what_is_no_triangle() {
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::X, Vec3::X * 2.0];
    let new = |triangles: &[[u32; 3]]| TriangleMesh::new(corners.clone(), triangles.to_vec());
    assert!(matches!(new(&[]), Err(Error::Degenerate(_))));
    assert!(matches!(new(&[[0, 1, 5]]), Err(Error::Index { what: "mesh index", index: 5, count: 5 })));
    assert!(matches!(new(&[[0, 1, 4], [0, 1, 1], [1, 2, 3]]), Err(Error::Degenerate(_))));
    let bad = TriangleMesh::new(vec![Vec3::NAN; 3], vec![[0, 1, 2]]);
    assert!(bad.is_err_and(|error| matches!(error.innermost(), Error::NotFinite { .. })));
    // The same again, turned, and with the other vertex of the same place.
    let mesh = new(&[[0, 1, 2], [1, 2, 0], [0, 2, 3], [0, 1, 4]]).unwrap();
    assert_eq!(mesh.triangle_count(), 1);
    assert_eq!(mesh.vertices.len(), 3);
}

#[test]
fn boxes_find_the_triangles_that_a_search_of_all_finds() {
    let mut random = Random(1);
    for mesh in [soup(3000, &mut random), terrain(40), soup(40, &mut random)] {
        for _ in 0..500 {
            let centre = random.cube() * 11.0;
            let half = random.cube().abs() * random.range(0.0, 3.0);
            let (min, max) = (centre - half, centre + half);
            let mut found = Vec::new();
            mesh.visit_box(min, max, &mut |t, _| found.push(t));
            found.sort_unstable();
            let expected: Vec<u32> = (0..mesh.triangle_count() as u32)
                .filter(|&t| {
                    let [a, b, c] = mesh.triangle(t);
                    a.min(b).min(c).cmple(max).all() && a.max(b).max(c).cmpge(min).all()
                })
                .collect();
            assert_eq!(found, expected);
        }
    }
}

/// Whether a path meets a box, and where.
fn slabs(from: Vec3, to: Vec3, min: Vec3, max: Vec3) -> Option<f64> {
    let path = to.as_dvec3() - from.as_dvec3();
    path_in_box(from.as_dvec3(), path, min.as_dvec3(), max.as_dvec3()).map(|(enter, _)| enter)
}

#[test]
fn paths_find_every_triangle_whose_inflated_box_they_meet() {
    let mut random = Random(2);
    for mesh in [soup(3000, &mut random), terrain(40)] {
        for round in 0..500 {
            let from = random.cube() * 12.0;
            let mut to = if round % 4 == 0 { from } else { random.cube() * 12.0 };
            if round % 4 == 1 {
                (to.x, to.z) = (from.x, from.z);
            }
            let inflate = random.cube().abs() * 0.5 * (round % 3) as f32;
            let path = bvh::Path::new(from, to, inflate, mesh.tree.slack());
            let mut found = vec![None; mesh.triangle_count()];
            mesh.visit_segment(from, to, inflate, &mut |t, [a, b, c], most| {
                let entry = path.meets_one(a.min(b).min(c), a.max(b).max(c));
                assert!(std::mem::replace(&mut found[t as usize], entry).is_none() && entry.is_some());
                most
            });
            for (t, found) in found.iter().enumerate() {
                let [a, b, c] = mesh.triangle(t as u32);
                let (min, max) = (a.min(b).min(c) - inflate, a.max(b).max(c) + inflate);
                match (slabs(from, to, min, max), *found) {
                    (Some(enter), Some(entry)) => assert!(f64::from(entry) <= enter + 1e-6),
                    (Some(_), None) => panic!("missed {t}"),
                    (None, Some(_)) => {
                        let more = Vec3::splat(1e-4);
                        assert!(slabs(from, to, min - more, max + more).is_some());
                    }
                    (None, None) => {}
                }
            }
        }
    }
}

/// Segment against triangle in f64, by volumes (Ericson 5.3.4); `None` within `border` of an edge or an end.
fn exact(from: Vec3, to: Vec3, t: [Vec3; 3], border: f64) -> Option<Option<f64>> {
    let (p, d) = (from.as_dvec3(), to.as_dvec3() - from.as_dvec3());
    let [a, b, c] = t.map(|v| v.as_dvec3() - p);
    let volumes = [d.dot(b.cross(c)), d.dot(c.cross(a)), d.dot(a.cross(b))];
    let sum: f64 = volumes.iter().sum();
    let normal = (b - a).cross(c - a);
    if volumes.iter().any(|v| (v / sum).abs() < border) || sum.abs() <= 1e-9 {
        return None;
    }
    let fraction = a.dot(normal) / d.dot(normal);
    if fraction.abs() < border || (fraction - 1.0).abs() < border {
        return None;
    }
    let inside = volumes.iter().all(|v| v / sum > 0.0) && (0.0..=1.0).contains(&fraction);
    Some(inside.then_some(fraction))
}

#[test]
fn a_path_hits_the_nearest_triangle_of_all() {
    let mut random = Random(3);
    for mesh in [soup(500, &mut random), terrain(30)] {
        let mut hits = 0;
        'paths: for _ in 0..2000 {
            let (from, to) = (random.cube() * 9.0, random.cube() * 9.0);
            let mut nearest: Option<f64> = None;
            for t in 0..mesh.triangle_count() as u32 {
                match exact(from, to, mesh.triangle(t), 1e-4) {
                    None => continue 'paths,
                    Some(Some(f)) => nearest = Some(nearest.map_or(f, |n: f64| n.min(f))),
                    Some(None) => {}
                }
            }
            let found = Ground::Mesh(&mesh).segment_hit(from, to);
            assert_eq!(found.is_some(), nearest.is_some());
            if let (Some((f, _)), Some(n)) = (found, nearest) {
                hits += 1;
                assert!((f64::from(f) - n).abs() < 1e-5, "{f} {n}");
            }
        }
        assert!(hits > 20);
    }
}

#[test]
fn no_path_slips_through_shared_edges_and_vertices() {
    let mut random = Random(4);
    // A closed mesh, left from within; a terrain, crossed from above; over 100 m.
    let (vertices, triangles) = cuboid(Vec3::new(3.0, 1.7, 2.3));
    let closed = TriangleMesh::new(vertices, triangles).unwrap();
    let ground = terrain(64);
    for i in 0..100_000 {
        for (mesh, is_closed) in [(&closed, true), (&ground, false)] {
            let t = random.below(mesh.triangle_count()) as u32;
            let corners = mesh.triangle(t);
            let (a, b) = (corners[random.below(3)], corners[random.below(3)]);
            let through = if i % 3 == 0 { a } else { a.lerp(b, random.range(0.0, 1.0)) };
            if !is_closed && through.x.abs().max(through.z.abs()) > 15.9 {
                continue;
            }
            let from = if is_closed {
                random.cube() * 1.5
            } else {
                through
                    + Vec3::new(
                        random.range(-20.0, 20.0),
                        random.range(30.0, 90.0),
                        random.range(-20.0, 20.0),
                    )
            };
            let direction = (through - from).normalize();
            let to = through + direction * random.range(0.01, 100.0);
            assert!(Ground::Mesh(mesh).segment_hit(from, to).is_some(), "{from} {to} through {through}");
            // And in two steps that meet somewhere near the surface.
            let middle = through + random.cube() * 1e-6 * random.below(3) as f32;
            let two =
                Ground::Mesh(mesh).segment_hit(from, middle).or(Ground::Mesh(mesh).segment_hit(middle, to));
            assert!(two.is_some(), "{from} {middle} {to}");
        }
    }
}

#[test]
fn a_triangle_of_a_terrain_takes_less_than_24_bytes() {
    let mesh = terrain(224);
    assert_eq!(mesh.triangle_count(), 100_352);
    let (live, reserved) = mesh.bytes();
    let each = reserved as f64 / mesh.triangle_count() as f64;
    println!("{each:.2} bytes a triangle, of them {} of tree", mesh.tree.bytes().0 / mesh.triangle_count());
    assert!(live <= reserved && each < 24.0, "{each}");
}
