//! Physics materials of our own: every rule for combining against every other, by its effect on motion.

use super::files::rebounds;
use super::*;

const RULES: [&str; 4] = ["average", "minimum", "maximum", "multiply"];

/// The specification's: the first rule of the list that either wants.
fn combined(a: usize, b: usize, x: f32, y: f32) -> f32 {
    match RULES[a.min(b)] {
        "average" => 0.5 * (x + y),
        "minimum" => x.min(y),
        "maximum" => x.max(y),
        _ => x * y,
    }
}

/// For each pair of rules a slab with a body on it, far from all others. Returns the pairs too.
fn grid(
    test: &str,
    material: impl Fn(&str, bool) -> Value,
    shape: Value,
    height: f32,
    speed: f32,
) -> (Scene, Vec<(usize, usize)>) {
    let (mut nodes, mut pairs) = (Vec::new(), Vec::new());
    for (i, j) in (0..16).map(|k| (k / 4, k % 4)) {
        let z = 10.0 * (4 * i + j) as f32;
        nodes.push(json!({
            "translation": [0.0, -0.5, z],
            "extensions": physics(json!({ "collider": { "geometry": { "shape": 0 }, "physicsMaterial": i } }))
        }));
        nodes.push(json!({
            "translation": [0.0, height, z],
            "extensions": physics(json!({
                "motion": { "mass": 2.0, "linearVelocity": [speed, 0.0, 0.0] },
                "collider": { "geometry": { "shape": 1 }, "physicsMaterial": 4 + j }
            }))
        }));
        pairs.push((i, j));
    }
    let materials: Vec<Value> = (0..8).map(|k| material(RULES[k % 4], k < 4)).collect();
    let slab = json!({ "type": "box", "box": { "size": [100.0, 1.0, 8.0] } });
    let root = json!({ "physicsMaterials": materials });
    (written(test, json!(nodes), json!([slab, shape]), root), pairs)
}

/// A flat box at 4 m/s stops after v² / 2 µ g (Coulomb).
#[test]
fn sliding_distance_follows_the_rules() {
    let material = |rule: &str, ground: bool| {
        let friction = if ground { 0.3 } else { 0.6 };
        json!({ "staticFriction": friction, "dynamicFriction": friction, "frictionCombine": rule })
    };
    let plate = json!({ "type": "box", "box": { "size": [1.0, 0.1, 1.0] } });
    let (scene, pairs) = grid("friction", material, plate, 0.05, 4.0);
    for dt in STEPS {
        let mut run = Run::new(&scene);
        run.for_seconds(4.0, dt);
        for (k, &(i, j)) in pairs.iter().enumerate() {
            let expected = 16.0 / (2.0 * 9.81 * combined(i, j, 0.3, 0.6)) as f64;
            let is = run.body(2 * k + 1);
            let what = format!("{} on {} at {dt}: {is:?}, {expected}", RULES[j], RULES[i]);
            // Where in a step the friction of it acts: at most v dt.
            let tolerance = 0.02 * expected + 0.5 * 4.0 * dt as f64;
            assert!((is.position.x - expected).abs() < tolerance && is.at_rest(), "{what}");
        }
    }
}

/// A ball that falls 2 m rises to e² of it.
#[test]
fn rebounds_follow_the_rules() {
    let material = |rule: &str, ground: bool| json!({ "restitution": if ground { 0.5 } else { 0.9 }, "restitutionCombine": rule });
    let ball = json!({ "type": "sphere", "sphere": { "radius": 0.5 } });
    let (scene, pairs) = grid("restitution", material, ball, 2.5, 0.0);
    for dt in STEPS {
        let mut run = Run::new(&scene);
        let bodies: Vec<usize> = (0..16).map(|k| 2 * k + 1).collect();
        let rises = rebounds(&mut run, &bodies, dt);
        for (&(i, j), rise) in pairs.iter().zip(rises) {
            let expected = 2.0 * combined(i, j, 0.5, 0.9).powi(2) as f64;
            let what = format!("{} on {} at {dt}: {rise}, {expected}", RULES[j], RULES[i]);
            assert!((rise - 0.5 - expected).abs() < 0.02 * expected, "{what}");
        }
    }
}

/// On a slope of 0.5 (26.6°) static friction of 0.6 holds a body at rest, and with dynamic friction of 0.2
/// a sliding body accelerates by g (sin - 0.2 cos).
#[test]
fn static_friction_holds_what_dynamic_friction_lets_slide() {
    let angle = 0.5f32.atan();
    let (s, c) = (0.5 * angle).sin_cos();
    let turned = json!([0.0, 0.0, s, c]);
    let (up, along) = (Vec3::new(-angle.sin(), angle.cos(), 0.0), Vec3::new(-angle.cos(), -angle.sin(), 0.0));
    let start = up * (0.5 + 0.05);
    let plate = |z: f32, speed: f32| {
        // Velocities are along the node's axes: its x points up the slope.
        json!({
            "translation": [start.x, start.y, z], "rotation": turned,
            "extensions": physics(json!({
                "motion": { "linearVelocity": [-speed, 0.0, 0.0] },
                "collider": { "geometry": { "shape": 1 }, "physicsMaterial": 0 }
            }))
        })
    };
    let slab = json!({
        "rotation": turned,
        "extensions": physics(json!({ "collider": { "geometry": { "shape": 0 }, "physicsMaterial": 0 } }))
    });
    let shapes = json!([
        { "type": "box", "box": { "size": [100.0, 1.0, 20.0] } },
        { "type": "box", "box": { "size": [1.0, 0.1, 1.0] } }
    ]);
    let root = json!({ "physicsMaterials": [{ "staticFriction": 0.6, "dynamicFriction": 0.2 }] });
    let scene = written("slope", json!([slab, plate(-3.0, 0.0), plate(3.0, 1.0)]), shapes, root);
    for dt in STEPS {
        let mut run = Run::new(&scene);
        run.for_seconds(2.0, dt);
        let (rests, slides) = (run.body(1), run.body(2));
        assert!(rests.at_rest() && rests.position.as_vec3().dot(along).abs() < 2e-3, "{dt}: {rests:?}");
        let expected = 1.0 + 2.0 * 9.81 * (angle.sin() - 0.2 * angle.cos());
        assert!((slides.linear.dot(along) - expected).abs() < 0.02 * expected, "{dt}: {slides:?}");
    }
}
