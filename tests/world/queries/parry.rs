//! Another library says the same.

use super::*;

/// The same shape for both libraries.
fn in_parry(geometry: &Geometry) -> parry3d::shape::SharedShape {
    use parry3d::shape::SharedShape;
    let vectors = |v: &[Vec3]| v.iter().map(|v| v.to_array().into()).collect::<Vec<_>>();
    match geometry {
        Geometry::Sphere { radius } => SharedShape::ball(*radius),
        Geometry::Capsule { half_height, radius_top, .. } => {
            SharedShape::capsule_y(*half_height, *radius_top)
        }
        Geometry::Box { half_extents: h } => SharedShape::cuboid(h.x, h.y, h.z),
        Geometry::Cylinder { half_height, radius_top, .. } => {
            SharedShape::cylinder(*half_height, *radius_top)
        }
        Geometry::Hull(hull) => SharedShape::convex_hull(&vectors(hull.vertices())).unwrap(),
        Geometry::Mesh(mesh) => {
            let corners: Vec<Vec3> =
                (0..mesh.triangle_count() as u32).flat_map(|i| mesh.corners(i).unwrap()).collect();
            let triangles =
                (0..mesh.triangle_count() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            SharedShape::trimesh(vectors(&corners), triangles).unwrap()
        }
        _ => unreachable!("not asked for"),
    }
}

/// Another library, shape by shape: single precision, and its own idea of how near a touch is.
#[test]
fn another_library_says_the_same() {
    use parry3d::math::{Pose, Rotation, Vector};
    use parry3d::query::{Ray as ParryRay, ShapeCastOptions, cast_shapes, intersection_test};
    let mut random = Random(21);
    let vertices: Vec<Vec3> = (0..400)
        .map(|i| Vec3::new((i % 20) as f32 - 10.0, random.range(-1.0, 1.0), (i / 20) as f32 - 10.0) * 0.4)
        .collect();
    let triangles = (0..361u32).flat_map(|i| {
        let c = i / 19 * 20 + i % 19;
        [[c, c + 20, c + 1], [c + 1, c + 20, c + 21]]
    });
    let mesh = Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles.collect()).unwrap()));
    let (mut rays, mut casts, mut overlaps, mut odd) = (0, 0, 0, 0);
    for i in 0..6000 {
        let geometry = if i % 6 == 5 { mesh.clone() } else { convex(&mut random, i % 6) };
        let other = in_parry(&geometry);
        let turned = random.rotation();
        let mut world = world();
        add(&mut world, BodyDesc::fixed().with_rotation(turned), geometry.clone());
        let pose = Pose::from_parts(Vector::ZERO, Rotation::from_array(turned.to_array()));
        let from = random.cube() * 5.0;
        let path = (random.cube() * 1.5 - from) * random.range(0.5, 2.0);
        let vector = |v: Vec3| Vector::from(v.to_array());

        let ours = world.cast_ray(&Ray::new(from.as_dvec3(), path), &ALL()).unwrap();
        let ray = ParryRay::new(vector(from), vector(path));
        let theirs = other.cast_ray_and_get_normal(&pose, &ray, 1.0, true);
        match (ours, theirs) {
            (Some(ours), Some(theirs)) => {
                rays += 1;
                let apart = (ours.fraction - theirs.time_of_impact).abs() * path.length();
                // Grazing rays differ by more than rounding.
                let facing = ours.normal.dot(path.normalize()).abs();
                let same = apart < 1e-4 / facing.max(0.01);
                assert!(same || ours.inside, "{i}: {ours:?} {theirs:?}");
            }
            (None, None) => {}
            _ => odd += 1,
        }

        let asked = in_parry(&geometry);
        let found = world.closest_point(from.as_dvec3(), 100.0, &ALL()).unwrap().unwrap();
        let theirs = asked.distance_to_point(&pose, vector(from), true);
        assert!((found.distance - theirs).abs() < 1e-3, "{i}: {found:?} {theirs}");

        let shape = convex(&mut random, i / 6);
        let (moving, turn) = (in_parry(&shape), random.rotation());
        let start = Pose::from_parts(vector(from), Rotation::from_array(turn.to_array()));
        let ours = world.overlap_any(&shape, from.as_dvec3(), turn, &ALL()).unwrap();
        let theirs = intersection_test(&start, &*moving, &pose, &*other).unwrap().intersecting;
        overlaps += usize::from(ours && theirs);
        odd += usize::from(ours != theirs);
        let cast = ShapeCast::new(&shape, from.as_dvec3(), path).with_rotation(turn);
        let ours = world.cast_shape(&cast, &ALL()).unwrap();
        let options = ShapeCastOptions::with_max_time_of_impact(1.0);
        let theirs =
            cast_shapes(&start, vector(path), &*moving, &pose, Vector::ZERO, &*other, options).unwrap();
        match (ours, theirs) {
            (Some(ours), Some(theirs)) => {
                casts += 1;
                let apart = (ours.fraction - theirs.time_of_impact).abs() * path.length();
                odd += usize::from(apart > 2e-3);
            }
            (None, None) => {}
            _ => odd += 1,
        }
    }
    println!("{rays} rays, {casts} casts, {overlaps} overlaps alike; {odd} not");
    // Which of the two is right where they differ, the oracles of `src/query/tests.rs` say.
    assert!(rays > 1500 && casts > 2000 && overlaps > 200 && odd < 60, "{rays} {casts} {overlaps} {odd}");
}
