//! Meshes that are no solids, and garbage: an error or hulls, and no panic.

use super::common::random::Random;
use super::solids::Mesh;
use backstop::glam::Vec3;
use backstop::{Decomposition, Error};

fn message(vertices: &[Vec3], triangles: &[[u32; 3]]) -> String {
    Decomposition::default().run(vertices, triangles).unwrap_err().to_string()
}

#[test]
fn what_is_no_solid_is_refused() {
    let good = Mesh::torus(1.0, 0.3, 12, 8);
    let flat = Mesh { vertices: good.vertices.iter().map(|v| v.with_y(0.0)).collect(), ..good.clone() };
    let nothing = "the shape is degenerate: the mesh encloses no volume";
    assert_eq!(message(&[], &[]), nothing);
    assert_eq!(message(&good.vertices, &[]), nothing);
    assert_eq!(message(&flat.vertices, &flat.triangles), nothing);
    assert_eq!(message(&[Vec3::X; 3], &[[0, 1, 2]]), nothing);
    assert_eq!(
        message(&good.vertices, &good.triangles[1..]),
        "the shape is degenerate: the mesh is not closed: 3 of its edges have more triangles on one side \
         than on the other"
    );
    let mut turned = good.triangles.clone();
    turned[0].swap(0, 1);
    assert!(message(&good.vertices, &turned).contains("not closed"));
    for (bad, expected) in [
        (f32::NAN, "vertex 5: mesh vertex must be finite, but is NaN"),
        (2e6, "vertex 5: mesh vertex must be within 1e6 m along each axis, but is 2000000"),
    ] {
        let mut vertices = good.vertices.clone();
        vertices[5].y = bad;
        assert_eq!(message(&vertices, &good.triangles), expected);
    }
    let beyond = [good.triangles.as_slice(), &[[0, 1, 96]]].concat();
    assert_eq!(message(&good.vertices, &beyond), "triangle 192: mesh index must be below 96, but is 96");
    let many = vec![[0, 1, 2]; Decomposition::MAX_TRIANGLES + 1];
    assert_eq!(
        message(&good.vertices, &many),
        "too many triangles of a mesh to be decomposed: at most 32768"
    );
    for settings in [
        Decomposition::default().with_max_hulls(0),
        Decomposition::default().with_max_hulls(257),
        Decomposition::default().with_resolution(0),
        Decomposition::default().with_resolution(u32::MAX),
        Decomposition::default().with_concavity(f32::NAN),
        Decomposition::default().with_concavity(-0.1),
    ] {
        let error = settings.run(&good.vertices, &good.triangles).unwrap_err();
        assert!(matches!(error, Error::OutOfRange { .. } | Error::NotFinite { .. }), "{error}");
    }
}

/// Random triangles, each with its back, so that they are closed; needles, sheets and doubles among them; at
/// any scale. Expected: hulls of finite points, as many as may be, or an error.
#[test]
fn garbage_does_not_panic() {
    let mut random = Random(63);
    let mut refused = 0;
    for round in 0..600 {
        let count = 3 + random.below(12);
        let squeeze = Vec3::new(1.0, random.of(&[1.0, 0.1, 1e-4, 0.0]), random.of(&[1.0, 1e-6]));
        let scale = random.log_range(1e-7, 1e5);
        let by = random.cube() * random.of(&[0.0, 1.0, 1e3]) * scale;
        let snap = random.chance(0.5);
        let vertices: Vec<Vec3> = (0..count)
            .map(|_| if snap { (random.cube() * 2.0).round() } else { random.cube() } * squeeze * scale + by)
            .collect();
        let corner = |random: &mut Random| random.below(count) as u32;
        let mut triangles = Vec::new();
        for _ in 0..1 + random.below(10) {
            // A tetrahedron, or a triangle and its back.
            let [a, b, c, d] = std::array::from_fn(|_| corner(&mut random));
            match random.chance(0.8) {
                true => triangles.extend([[a, b, c], [b, a, d], [c, b, d], [a, c, d]]),
                false => triangles.extend([[a, b, c], [a, c, b]]),
            }
        }
        if random.chance(0.1) {
            triangles.pop();
        }
        let settings = Decomposition::default()
            .with_max_hulls(1 + random.below(20) as u32)
            .with_concavity(random.of(&[0.0, 0.01, 1.0]))
            .with_resolution(1 + random.below(20) as u32);
        match settings.run(&vertices, &triangles) {
            Ok(pieces) => {
                assert!(pieces.hulls().len() <= settings.max_hulls as usize, "round {round}");
                assert!(pieces.excess().is_finite() && pieces.volume() > 0.0, "round {round}");
            }
            Err(error) => {
                assert!(!error.to_string().is_empty());
                refused += 1;
            }
        }
    }
    assert!((50..550).contains(&refused), "{refused} were refused");
}
