//! Collision filters of our own: which bodies fall through which, by the specification's rule.

use super::*;

/// Drops one cube for each filter onto one slab, and says which are held.
fn held(test: &str, slab: Value, cubes: &[Value]) -> Vec<bool> {
    let mut filters: Vec<Value> = vec![slab];
    filters.extend_from_slice(cubes);
    // A filter that is null is none at all.
    let collider = |i: usize, shape: u32| match filters[i].is_null() {
        true => json!({ "geometry": { "shape": shape } }),
        false => json!({ "geometry": { "shape": shape }, "collisionFilter": i }),
    };
    let mut nodes = vec![json!({ "extensions": physics(json!({ "collider": collider(0, 0) })) })];
    for i in 0..cubes.len() {
        nodes.push(json!({
            "translation": [3.0 * i as f32, 1.5, 0.0],
            "extensions": physics(json!({ "motion": {}, "collider": collider(i + 1, 1) }))
        }));
    }
    let shapes = json!([
        { "type": "box", "box": { "size": [100.0, 1.0, 10.0] } },
        { "type": "box", "box": { "size": [1.0, 1.0, 1.0] } }
    ]);
    let listed: Vec<Value> =
        filters.iter().map(|f| if f.is_null() { json!({}) } else { f.clone() }).collect();
    let scene = written(test, json!(nodes), shapes, json!({ "collisionFilters": listed }));
    let mut run = Run::new(&scene);
    run.for_seconds(3.0, 1.0 / 60.0);
    (1..=cubes.len()).map(|i| run.body(i).position.y > 0.99).collect()
}

#[test]
fn lists_of_what_to_collide_with() {
    let cubes = [
        Value::Null,
        json!({}),
        json!({ "collisionSystems": ["a"] }),
        json!({ "collisionSystems": ["b"] }),
        json!({ "collisionSystems": ["a"], "collideWithSystems": ["ground"] }),
        json!({ "collisionSystems": ["a"], "collideWithSystems": ["b", "ground"] }),
        json!({ "collisionSystems": ["a"], "collideWithSystems": ["b"] }),
        json!({ "collisionSystems": ["a", "b"], "collideWithSystems": ["ground"] }),
    ];
    let ground = json!({ "collisionSystems": ["ground"], "collideWithSystems": ["a"] });
    assert_eq!(held("with", ground, &cubes), [true, true, true, false, true, true, false, true]);
}

#[test]
fn lists_of_what_not_to_collide_with() {
    let cubes = [
        Value::Null,
        json!({ "collisionSystems": ["a"] }),
        json!({ "collisionSystems": ["b"] }),
        json!({ "collisionSystems": ["a", "b"] }),
        json!({ "collisionSystems": ["b"], "notCollideWithSystems": ["ground"] }),
        json!({ "collisionSystems": ["b"], "notCollideWithSystems": ["a", "other"] }),
        json!({ "notCollideWithSystems": ["ground"] }),
    ];
    let ground = json!({ "collisionSystems": ["ground"], "notCollideWithSystems": ["a"] });
    assert_eq!(held("without", ground, &cubes), [true, false, true, true, false, true, false]);
}

/// Both have to agree: one that refuses is enough.
#[test]
fn one_side_is_enough_to_refuse() {
    let cubes = [
        json!({ "collisionSystems": ["a"], "notCollideWithSystems": ["ground"] }),
        json!({ "collisionSystems": ["a"], "collideWithSystems": ["a"] }),
        json!({ "collisionSystems": ["a"] }),
    ];
    let ground = json!({ "collisionSystems": ["ground"] });
    assert_eq!(held("one_side", ground, &cubes), [false, false, true]);
}

/// A collider that one list lets in may be kept out by the other.
#[test]
fn a_filter_may_have_both_lists() {
    let both = |with: &[&str], without: &[&str]| json!({ "collisionSystems": ["a"], "collideWithSystems": with, "notCollideWithSystems": without });
    let cubes = [both(&["ground", "b"], &["b"]), both(&["ground", "b"], &["ground"]), both(&["b"], &["c"])];
    let ground = json!({ "collisionSystems": ["ground"] });
    assert_eq!(held("both", ground, &cubes), [true, false, false]);
}
