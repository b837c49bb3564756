//! Structures that stand at the start and ought to go on standing.

use super::{Error, Subject};
use crate::engines::Continuous;
use backstop::Geometry;
use backstop::glam::Vec3;
use backstop_scene::Scene;
use backstop_scene::builtin::{dynamic, fixed, large_pyramid};

fn stands(scene: Scene) -> Subject {
    Subject { steps: 180, stands: true, continuous: Continuous::Off, ..Subject::new(scene, Error::Drift) }
}

/// A wall of unit boxes, each row one box shorter than the one below.
pub(super) fn pyramid(rows: usize) -> Subject {
    stands(large_pyramid(rows))
}

/// 14 by 14 pyramids of ten rows each, apart from each other.
pub(super) fn pyramids() -> Subject {
    let (side, rows) = (14, 10);
    let mut scene = Scene::new("pyramids");
    scene.add("floor", fixed(Geometry::cuboid(120.0, 1.0, 60.0), Vec3::new(0.0, -1.0, 0.0)));
    for i in 0..side * side {
        let middle = 0.5 * (side as f32 - 1.0);
        let at = Vec3::new(((i % side) as f32 - middle) * 12.0, 0.0, ((i / side) as f32 - middle) * 3.0);
        for (row, k) in (0..rows).flat_map(|row| (0..rows - row).map(move |k| (row, k))) {
            let x = k as f32 + 0.5 * (row as f32 + 1.0 - rows as f32);
            let place = at + Vec3::new(x, row as f32 + 0.5, 0.0);
            scene.add("box", dynamic(Geometry::cuboid(0.5, 0.5, 0.5), place));
        }
    }
    stands(scene)
}
