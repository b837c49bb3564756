//! The scenes that are shipped as files, made by code so that they can be made again.

use super::{add_terrain, dynamic, fixed, pebble, throw_at};
use crate::rng::{Rng, axis_angle};
use crate::{Scene, SceneError, Terrain, write_scene};
use backstop::BodyDesc;
use backstop::{Combine, Filter, Geometry, Material, ShapeDesc};
use glam::Vec3;
use std::path::{Path, PathBuf};

/// File names of the shipped scenes.
pub const SHIPPED: &[&str] = &["talk.glb", "tower.gltf", "playground.gltf"];

/// A shipped scene by its file name.
pub fn shipped(file: &str) -> Option<Scene> {
    Some(match file {
        "talk.glb" => talk(),
        "tower.gltf" => tower(),
        "playground.gltf" => playground(),
        _ => return None,
    })
}

/// Writes all shipped scenes into a folder; returns their paths.
///
/// # Errors
/// If one can't be written.
pub fn write_shipped(folder: impl AsRef<Path>) -> Result<Vec<PathBuf>, SceneError> {
    let folder = folder.as_ref();
    std::fs::create_dir_all(folder).map_err(|source| SceneError::Write { file: folder.into(), source })?;
    let mut written = Vec::new();
    for (file, scene) in SHIPPED.iter().filter_map(|f| Some((f, shipped(f)?))) {
        let path = folder.join(file);
        write_scene(&scene, &path)?;
        written.push(path);
    }
    Ok(written)
}

/// Eleven fast, spinning bodies of every shape onto a terrain of 8192 triangles.
fn talk() -> Scene {
    let mut scene = Scene::new("talk");
    let terrain = Terrain::bumpy(64, 0.75);
    add_terrain(&mut scene, &terrain);
    let mut rng = Rng::new(11);
    let shapes = [
        Geometry::Sphere { radius: 0.3 },
        Geometry::capsule(0.3, 0.2),
        Geometry::cuboid(0.3, 0.2, 0.4),
        Geometry::Capsule { half_height: 0.35, radius_bottom: 0.3, radius_top: 0.15 },
        Geometry::cylinder(0.3, 0.25),
        Geometry::Cylinder { half_height: 0.3, radius_bottom: 0.35, radius_top: 0.15 },
        Geometry::Cylinder { half_height: 0.3, radius_bottom: 0.35, radius_top: 0.0 },
        pebble(14, Vec3::new(0.35, 0.3, 0.4), &mut rng),
        pebble(22, Vec3::new(0.4, 0.3, 0.3), &mut rng),
        Geometry::Sphere { radius: 0.15 },
        // A plate, 2 cm thick: the shape that falls through most easily.
        Geometry::cuboid(0.4, 0.01, 0.3),
    ];
    for (i, shape) in shapes.into_iter().enumerate() {
        throw_at(&mut scene, &terrain, i, shape, &mut rng);
    }
    scene
}

/// A tower of boxes, brick on brick, and three balls on their way to it.
fn tower() -> Scene {
    let mut scene = Scene::new("tower");
    scene.add("floor", fixed(Geometry::cuboid(25.0, 0.5, 25.0), Vec3::new(0.0, -0.5, 0.0)));
    for layer in 0..12 {
        for brick in 0..3 {
            let aside = (brick - 1) as f32;
            let y = 0.25 + 0.5 * layer as f32;
            // Three bricks side by side, every other layer turned by a quarter.
            let (half, position) = match layer % 2 {
                0 => (Vec3::new(0.5, 0.25, 1.5), Vec3::new(aside, y, 0.0)),
                _ => (Vec3::new(1.5, 0.25, 0.5), Vec3::new(0.0, y, aside)),
            };
            let name = format!("brick {}", 3 * layer + brick + 1);
            scene.add(name, dynamic(Geometry::Box { half_extents: half }, position));
        }
    }
    for (i, (x, y)) in [(-20.0, 2.0), (-26.0, 4.0), (-32.0, 5.5)].into_iter().enumerate() {
        let ball = dynamic(Geometry::Sphere { radius: 0.4 }, Vec3::new(x, y, 0.2 * i as f32));
        scene.add(format!("ball {}", i + 1), ball.with_velocity(Vec3::new(30.0, 2.0, 0.0), Vec3::ZERO));
    }
    scene
}

/// Boxes on ramps of different friction, balls of different restitution, compounds, a paddle that turns, and
/// two kinds of balls of which one falls through a filtered plate.
fn playground() -> Scene {
    let mut scene = Scene::new("playground");
    // Both shapes of a pair use the same combine mode, so that the result does not depend on a precedence of
    // modes.
    let least = Material::default().with_friction_combine(Combine::Minimum);
    let most = Material::default().with_restitution_combine(Combine::Maximum);
    let mut floor = fixed(Geometry::Plane, Vec3::ZERO);
    floor.shapes[0].material = most;
    scene.add("floor", floor);
    let tilt = axis_angle(Vec3::X, 0.45);
    for i in 0..5 {
        let x = -12.0 + 3.0 * i as f32;
        let friction = 0.2 * i as f32;
        let mut ramp = fixed(Geometry::cuboid(1.2, 0.1, 4.0), Vec3::new(x, 2.0, 0.0)).with_rotation(tilt);
        ramp.shapes[0].material = least.with_friction(friction);
        scene.add(format!("ramp {friction:.1}"), ramp);
        let above = Vec3::new(x, 2.0, 0.0) + tilt * Vec3::new(0.0, 0.41, -3.0);
        let mut slider = dynamic(Geometry::cuboid(0.4, 0.3, 0.4), above).with_rotation(tilt);
        slider.shapes[0].material = least;
        scene.add("slider", slider);
    }
    for i in 0..5 {
        let mut ball = dynamic(Geometry::Sphere { radius: 0.3 }, Vec3::new(4.0 + i as f32, 4.0, -2.0));
        let restitution = 0.25 * i as f32;
        ball.shapes[0].material = most.with_restitution(restitution);
        scene.add(format!("ball {restitution:.2}"), ball);
    }
    for i in 0..3 {
        let part = |geometry, y| ShapeDesc::new(geometry).with_position(Vec3::new(0.0, y, 0.0));
        let dumbbell = BodyDesc::dynamic()
            .with_position(Vec3::new(4.0 + 2.0 * i as f32, 5.0, 3.0))
            .with_rotation(axis_angle(Vec3::Z, 0.4 + i as f32))
            .with_shape(part(Geometry::cylinder(0.5, 0.1), 0.0))
            .with_shape(part(Geometry::Sphere { radius: 0.3 }, -0.6))
            .with_shape(part(Geometry::cuboid(0.25, 0.25, 0.25), 0.6));
        scene.add(format!("dumbbell {}", i + 1), dumbbell);
    }
    let mut paddle = BodyDesc::kinematic()
        .with_position(Vec3::new(6.0, 0.6, 8.0))
        .with_shape(ShapeDesc::new(Geometry::cuboid(3.0, 0.2, 0.2)));
    paddle.angular_velocity = Vec3::new(0.0, 1.5, 0.0);
    scene.add("paddle", paddle);
    // There are three systems: the plate and the first kind collide with each other, the second kind with
    // neither.
    let [plate_filter, held, falls] = [(1, 1 | 2), (2, !4), (4, !(1 | 2))]
        .map(|(category, mask)| Filter::default().with_category(category).with_mask(mask));
    let mut plate = fixed(Geometry::cuboid(2.0, 0.1, 2.0), Vec3::new(-6.0, 2.0, 9.0));
    plate.shapes[0].filter = plate_filter;
    scene.add("plate", plate);
    for i in 0..8 {
        let (x, z) = (-7.2 + 0.8 * (i % 4) as f32, 8.6 + 0.8 * (i / 4) as f32);
        let mut ball = dynamic(Geometry::Sphere { radius: 0.3 }, Vec3::new(x, 4.0, z));
        let (name, filter) = if i % 2 == 0 { ("held", held) } else { ("falls", falls) };
        ball.shapes[0].filter = filter;
        scene.add(name, ball);
    }
    // The rest of the scene has no filter; in a file with filters that means all systems.
    for body in &mut scene.bodies {
        for shape in body.desc.shapes.iter_mut().filter(|s| s.filter == Filter::default()) {
            shape.filter = Filter::default().with_category(u64::MAX);
        }
    }
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shipped_scenes_are_valid_and_named_after_their_files() {
        for file in SHIPPED {
            let scene = shipped(file).unwrap();
            assert!(file.starts_with(&scene.name));
            for body in &scene.bodies {
                body.desc.validate().unwrap();
            }
        }
    }

    /// Writes `scenes/` anew:
    /// `cargo test --package backstop-scene --features gltf -- --ignored write_the_committed_scenes`.
    #[test]
    #[ignore = "changes the repository"]
    fn write_the_committed_scenes() {
        write_shipped(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")).unwrap();
    }
}
