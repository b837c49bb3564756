//! Scenes that come in any size.

use super::{Error, Mixed, Subject, add_mesh, below, beyond_pen, grid, pen};
use backstop::glam::Vec3;
use backstop_scene::{Rng, Scene, Terrain};

/// The growing quantity.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
pub(crate) enum Scaling {
    /// Mixed bodies, eight layers of them.
    Bodies,
    /// Triangles of a terrain on which 200 bodies come to rest.
    Triangles,
}

impl Scaling {
    /// The sizes of a sweep.
    pub(crate) fn sizes(self) -> &'static [usize] {
        match self {
            Scaling::Bodies => &[1_000, 3_000, 10_000, 30_000, 100_000],
            Scaling::Triangles => &[1_000, 10_000, 100_000, 1_000_000, 10_000_000],
        }
    }

    /// The counted objects.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Scaling::Bodies => "bodies",
            Scaling::Triangles => "triangles",
        }
    }
}

/// A scene by its growing quantity and size, as `bodies_1000`.
pub(super) fn named(name: &str) -> Option<Subject> {
    let (what, size) = name.rsplit_once('_')?;
    let size = size.parse().ok()?;
    match what {
        "bodies" => Some(bodies(size)),
        "triangles" => Some(triangles(size)),
        _ => None,
    }
}

fn bodies(count: usize) -> Subject {
    let side = (count as f32 / 8.0).sqrt().ceil() as usize;
    let (half, height) = (0.5 * side as f32 + 0.1, 12.0);
    let mut scene = Scene::new("bodies");
    pen(&mut scene, half, height);
    let mut rng = Rng::new(41);
    let mixed = Mixed::new(0.4, &mut rng);
    grid(&mut scene, (count, side), (0.98, 0.6), &mut rng, |i| mixed.shape(i));
    Subject { steps: 90, beyond: beyond_pen(half, height), ..Subject::new(scene, Error::Depth) }
}

fn triangles(count: usize) -> Subject {
    let cells = (count as f32 / 2.0).sqrt().round() as usize;
    let terrain = Terrain::bumpy(cells, 0.5);
    let mut scene = Scene::new("triangles");
    add_mesh(&mut scene, "terrain", Vec3::ZERO, terrain.mesh());
    let mut rng = Rng::new(42);
    let mixed = Mixed::new(0.4, &mut rng);
    // Within the smallest of the terrains.
    grid(&mut scene, (200, 8), (1.1, 5.0), &mut rng, |i| mixed.shape(i));
    Subject { steps: 180, beyond: below(terrain), ..Subject::new(scene, Error::Lost) }
}
