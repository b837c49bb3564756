//! Rules for each call: its numbers are checked, a value that is already set changes nothing, and objects
//! that it breaks or wakes disturb no step.

mod breaking;
mod numbers;
mod same_values;
mod tables;

/// Every public method of `World` that takes a number, or an object with numbers, is called in `numbers.rs`,
/// or stands here with the one whose checks it makes.
#[test]
fn no_method_with_numbers_is_forgotten() {
    const ALIKE: [(&str, &str); 14] = [
        ("new", "set_settings"),
        ("add_bodies", "add_body"),
        ("add_joints", "add_joint"),
        ("step_with", "step"),
        ("cast_rays", "cast_ray"),
        ("cast_ray_any", "cast_ray"),
        ("cast_ray_all", "cast_ray"),
        ("cast_shape_any", "cast_shape"),
        ("cast_shape_all", "cast_shape"),
        ("overlap_any", "overlap"),
        ("closest_point_any", "closest_point"),
        ("closest_point_all", "closest_point"),
        ("draw", "what is drawn is the caller's"),
        ("allow", "asks for what add_bodies, add_joints and add_coupling check"),
    ];
    const NUMBERS: [&str; 18] = [
        "f32",
        "f64",
        "Vec3",
        "Vec2",
        "Quat",
        "Desc",
        "Motor",
        "Limit",
        "Frame",
        "Material",
        "MassProperties",
        "Settings",
        "Geometry",
        "Ray",
        "ShapeCast",
        "Aabb",
        "&Character",
        "DrawOptions",
    ];
    let own = include_str!("numbers.rs");
    let (mut methods, mut forgotten) = (0, Vec::new());
    let mut folders = vec![std::path::PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../src")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            for block in text.split("\nimpl World {").skip(1) {
                let block = &block[..block.find("\n}").unwrap()];
                for method in block.split("\n    pub fn ").skip(1) {
                    let head = method.split(['{', ';']).next().unwrap().split("->").next().unwrap();
                    let name = head.split(['(', '<']).next().unwrap();
                    if !NUMBERS.iter().any(|number| head.contains(number)) {
                        continue;
                    }
                    methods += 1;
                    let called =
                        own.contains(&format!(".{name}(")) || own.contains(&format!("World::{name}"));
                    if !called && !ALIKE.iter().any(|other| other.0 == name) {
                        forgotten.push(name.to_owned());
                    }
                }
            }
        }
    }
    assert!(forgotten.is_empty(), "{forgotten:?}");
    assert!(methods > 50, "the parser sees {methods} methods");
}
