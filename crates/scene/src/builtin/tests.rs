//! Tests of the builtin scenes.

use super::*;

#[test]
fn every_builtin_scene_has_its_bodies() {
    // Counted from the descriptions: a pyramid of 60 has 60 * 61 / 2 boxes. Seven spheres of the grid's upper
    // row are static. Six figures have eleven limbs each; groups of 2, 3, 4, 5, 6, 2, ... meet head on.
    // Eighteen figures fall among a hundred other bodies.
    let expected = [11, 1000, 1000, 1830, 5050, 4096, 10, 10, 10, 30, 9993, 21, 60, 16, 32, 45, 66, 298];
    assert_eq!(NAMES.len(), expected.len());
    for (name, count) in NAMES.iter().zip(expected) {
        let scene = build(name).unwrap();
        assert_eq!((scene.name.as_str(), scene.dynamic_bodies()), (*name, count));
        for body in &scene.bodies {
            body.desc.validate().unwrap();
        }
    }
    assert!(build("no such scene").is_none());
}

#[test]
fn scenes_are_the_same_each_time() {
    let text = |s: Scene| {
        format!("{:?}", s.bodies.iter().map(|b| (b.desc.position, b.desc.rotation)).collect::<Vec<_>>())
    };
    assert_eq!(text(talk()), text(talk()));
    assert_ne!(text(talk()), text(bullets(true)));
}
