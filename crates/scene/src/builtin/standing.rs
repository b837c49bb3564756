//! Structures that should stand for ever: they show whether bodies at rest stay at rest.
//!
//! Each is put up without gaps and without overlap on a static box, with friction 0.6. They stand by statics
//! alone, so any motion after the first seconds is the engine's error.

use super::{dynamic, fixed};
use crate::Scene;
use backstop::BodyHandle;
use backstop::Error;
use backstop::Geometry;
use backstop::Settings;
use backstop::World;
use backstop::limits::positive;
use glam::Vec3;

/// A structure and how large it is. Lengths are in units of [`Standing::scene`]'s scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Standing {
    /// This many unit boxes on top of each other.
    Tower(usize),
    /// Rows of unit boxes, each one box shorter than the one below; the length of the lowest.
    Pyramid(usize),
    /// Unit boxes, each over the joint of two; half boxes end every other row.
    Wall {
        /// Boxes in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// This many upright cylinders on top of each other, of radius 0.4 and height 1.
    Barrels(usize),
    /// The same, of radius 0.5 and height 0.1.
    Coins(usize),
    /// A unit box on one that is lighter by this factor.
    Light(f32),
    /// Pairs of planks of 1.2 x 0.08 x 0.24, lying flat, this many levels crosswise.
    Crib(usize),
    /// The same with the planks on edge.
    Edge(usize),
    /// Layers of three blocks of 1.5 x 0.3 x 0.5 side by side, this many layers crosswise.
    Layers(usize),
}

/// Half length, half thickness and half width of a plank.
const PLANK: [f32; 3] = [0.6, 0.04, 0.12];
/// The same of a block.
const BLOCK: [f32; 3] = [0.75, 0.15, 0.25];

impl Standing {
    /// The names for [`Standing::named`], with default sizes.
    pub const NAMES: &[(&str, usize)] = &[
        ("tower", 30),
        ("pyramid", 20),
        ("wall", 10),
        ("high_wall", 40),
        ("barrels", 20),
        ("coins", 20),
        ("light", 1000),
        ("crib", 40),
        ("edge", 20),
        ("layers", 40),
    ];

    /// A structure by its name and size: boxes, rows, levels; for `light` how many times lighter the lower
    /// box is. Both walls are twenty boxes wide. A size may also end the name, as in `tower_30`.
    pub fn named(name: &str, size: Option<usize>) -> Option<Standing> {
        let known = |name: &str| Self::NAMES.iter().find(|one| one.0 == name).map(|one| one.1);
        let (name, size) = match (known(name), name.rsplit_once('_')) {
            (Some(usual), _) => (name, size.unwrap_or(usual)),
            (None, Some((name, end))) => (name, size.or(end.parse().ok())?),
            (None, None) => return None,
        };
        Some(match name {
            "tower" => Standing::Tower(size),
            "pyramid" => Standing::Pyramid(size),
            "wall" | "high_wall" => Standing::Wall { width: 20, height: size },
            "barrels" => Standing::Barrels(size),
            "coins" => Standing::Coins(size),
            "light" => Standing::Light(size as f32),
            "crib" => Standing::Crib(size),
            "edge" => Standing::Edge(size),
            "layers" => Standing::Layers(size),
            _ => return None,
        })
    }

    /// Its name and size.
    pub fn name(&self) -> String {
        match *self {
            Standing::Tower(n) => format!("tower_{n}"),
            Standing::Pyramid(n) => format!("pyramid_{n}"),
            Standing::Wall { height, .. } => format!("wall_{height}"),
            Standing::Barrels(n) => format!("barrels_{n}"),
            Standing::Coins(n) => format!("coins_{n}"),
            Standing::Light(ratio) => format!("light_{ratio}"),
            Standing::Crib(n) => format!("crib_{n}"),
            Standing::Edge(n) => format!("edge_{n}"),
            Standing::Layers(n) => format!("layers_{n}"),
        }
    }

    /// The scene: the ground first, the top last. `scale`: length of the unit [m]; `density` [kg/m³].
    pub fn scene(&self, scale: f32, density: f32) -> Scene {
        let mut scene = Scene::new(self.name());
        scene.steps = 60 * 120;
        let ground = Geometry::cuboid(200.0 * scale, scale, 200.0 * scale);
        scene.add("ground", fixed(ground, Vec3::new(0.0, -scale, 0.0)));
        let mut put = |name: &str, shape: Geometry, at: Vec3, weight: f32| {
            let mut desc = dynamic(shape, at * scale);
            desc.shapes[0].density = density * weight;
            scene.add(name, desc);
        };
        let cuboid = |half: Vec3| Geometry::Box { half_extents: half * scale };
        let unit = Vec3::splat(0.5);
        match *self {
            Standing::Tower(n) => {
                for i in 0..n {
                    put("box", cuboid(unit), Vec3::new(0.0, i as f32 + 0.5, 0.0), 1.0);
                }
            }
            Standing::Pyramid(rows) => {
                for (row, i) in (0..rows).flat_map(|row| (0..rows - row).map(move |i| (row, i))) {
                    let x = i as f32 + 0.5 * (row as f32 + 1.0 - rows as f32);
                    put("box", cuboid(unit), Vec3::new(x, row as f32 + 0.5, 0.0), 1.0);
                }
            }
            Standing::Wall { width, height } => {
                for row in 0..height {
                    let (y, end) = (row as f32 + 0.5, 0.5 * width as f32);
                    let shifted = row % 2 != 0 && width > 0;
                    for i in 0..width - usize::from(shifted) {
                        let x = i as f32 + if shifted { 1.0 } else { 0.5 } - end;
                        put("box", cuboid(unit), Vec3::new(x, y, 0.0), 1.0);
                    }
                    for side in [-1.0, 1.0].into_iter().filter(|_| shifted) {
                        let at = Vec3::new(side * (end - 0.25), y, 0.0);
                        put("half box", cuboid(Vec3::new(0.25, 0.5, 0.5)), at, 1.0);
                    }
                }
            }
            Standing::Barrels(n) => {
                for i in 0..n {
                    let barrel = Geometry::cylinder(0.5 * scale, 0.4 * scale);
                    put("barrel", barrel, Vec3::new(0.0, i as f32 + 0.5, 0.0), 1.0);
                }
            }
            Standing::Coins(n) => {
                for i in 0..n {
                    let coin = Geometry::cylinder(0.05 * scale, 0.5 * scale);
                    put("coin", coin, Vec3::new(0.0, 0.1 * (i as f32 + 0.5), 0.0), 1.0);
                }
            }
            Standing::Light(ratio) => {
                put("light box", cuboid(unit), Vec3::new(0.0, 0.5, 0.0), 1.0 / ratio);
                put("box", cuboid(unit), Vec3::new(0.0, 1.5, 0.0), 1.0);
            }
            Standing::Crib(levels) => crosswise(levels, PLANK, 2, |half, at| {
                put("plank", cuboid(half), at, 1.0);
            }),
            Standing::Edge(levels) => {
                let [length, thickness, width] = PLANK;
                crosswise(levels, [length, width, thickness], 2, |half, at| {
                    put("plank", cuboid(half), at, 1.0);
                });
            }
            Standing::Layers(layers) => crosswise(layers, BLOCK, 3, |half, at| {
                put("block", cuboid(half), at, 1.0);
            }),
        }
        scene
    }

    /// A world with the structure in it, and its bodies: the top last. The scale is the settings' length
    /// unit.
    ///
    /// # Errors
    /// If the settings or the density are out of range.
    pub fn build(&self, settings: Settings, density: f32) -> Result<(World, Vec<BodyHandle>), Error> {
        positive("density", density)?;
        let scale = settings.length_unit;
        let mut world = World::new(settings)?;
        let mut bodies = self.scene(scale, density).add_to(&mut world)?.bodies;
        bodies.remove(0);
        Ok((world, bodies))
    }
}

/// Levels of `count` beams side by side, flush with the ends of those below and above; `half`: length,
/// height, width.
fn crosswise(
    levels: usize,
    [length, height, width]: [f32; 3],
    count: usize,
    mut put: impl FnMut(Vec3, Vec3),
) {
    for (level, i) in (0..levels).flat_map(|level| (0..count).map(move |i| (level, i))) {
        let aside = (length - width) * (2.0 * i as f32 / (count - 1) as f32 - 1.0);
        let y = height * (2.0 * level as f32 + 1.0);
        let (half, at) = match level % 2 {
            0 => (Vec3::new(length, height, width), Vec3::new(0.0, y, aside)),
            _ => (Vec3::new(width, height, length), Vec3::new(aside, y, 0.0)),
        };
        put(half, at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_structure_has_its_bodies_and_the_top_last() {
        // Counted from the descriptions; a wall of ten rows has five of twenty boxes and five of nineteen
        // with two halves.
        let expected = [
            (30, 29.5),
            (210, 19.5),
            (205, 9.5),
            (820, 39.5),
            (20, 19.5),
            (20, 1.95),
            (2, 1.5),
            (80, 3.16),
            (40, 4.68),
            (120, 11.85),
        ];
        for (&(name, _), (count, top)) in Standing::NAMES.iter().zip(expected) {
            for scale in [1.0, 0.01] {
                let settings = Settings::default().with_length_unit(scale);
                let (world, bodies) = Standing::named(name, None).unwrap().build(settings, 1000.0).unwrap();
                let y = |b: &BodyHandle| world.position(*b).unwrap().y;
                assert_eq!(bodies.len(), count, "{name}");
                let height = y(bodies.last().unwrap()) / f64::from(scale);
                assert!((height - top).abs() < 1e-4, "{name}: {height}");
                assert!(bodies.iter().all(|b| y(b) / f64::from(scale) < top + 1e-4), "{name}");
            }
        }
        assert_eq!(Standing::named("tower_7", None), Some(Standing::Tower(7)));
        assert_eq!(Standing::named("high_wall", None).unwrap().name(), "wall_40");
        assert_eq!(Standing::named("wall_5", None), Some(Standing::Wall { width: 20, height: 5 }));
        assert!(["", "tower_", "nothing", "nothing_3"].iter().all(|n| Standing::named(n, None).is_none()));
    }
}
