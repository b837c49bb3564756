//! ColliderTypeMatrix: each type of collider dropped on each type.

use super::*;

/// Height of the static body's top under the dropped one [m], as the files place them.
fn top(geometry: &Geometry) -> f64 {
    match geometry {
        Geometry::Box { .. } => -0.5,
        Geometry::Hull(_) | Geometry::Mesh(_) => 0.0,
        _ => 1.0,
    }
}

/// Height of the dropped body's origin above that top, standing as it was dropped [m].
fn standing(geometry: &Geometry) -> f64 {
    match geometry {
        Geometry::Sphere { radius } => *radius as f64,
        Geometry::Capsule { half_height, radius_bottom, .. } => (half_height + radius_bottom) as f64,
        Geometry::Box { half_extents } => half_extents.y as f64,
        Geometry::Cylinder { half_height, .. } => *half_height as f64,
        Geometry::Hull(hull) => -hull.vertices().iter().fold(f64::MAX, |y, v| y.min(v.y as f64)),
        _ => unreachable!("not dynamic"),
    }
}

/// The bodies fall straight down onto the middle and stay as they fell: level on what is flat, in balance on what is
/// round. The tetrahedron on the box is the one whose origin then lies below the XZ plane: the box's top does.
#[test]
fn every_type_rests_on_every_type() {
    let Some(data) = data("gltf/tests") else { return };
    let mut failed = Vec::new();
    for path in family(&data, "ColliderTypeMatrix") {
        let scene = load(&path, &LoadOptions::default()).unwrap();
        let of = |kind| scene.bodies.iter().position(|b| b.desc.kind == kind).unwrap();
        let (ground, faller) = (of(BodyKind::Static), of(BodyKind::Dynamic));
        let geometry = |i: usize| &scene.bodies[i].desc.shapes[0].geometry;
        let expected = top(geometry(ground)) + standing(geometry(faller));
        for dt in STEPS {
            let mut run = Run::new(&scene);
            run.for_seconds(10.0, dt);
            let is = run.body(faller);
            let on = (is.position - DVec3::new(0.0, expected, 0.0)).abs();
            if !is.at_rest() || on.y > 2e-3 || on.x.max(on.z) > 0.1 {
                let name = scene.name.clone();
                let pair = format!("{} on {}", kind(geometry(faller)), kind(geometry(ground)));
                failed.push(format!("{name} ({pair}) dt {dt}: {is:?}, height {expected}"));
            }
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}
