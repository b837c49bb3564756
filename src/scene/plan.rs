//! What a scene will take in memory, from the scene alone: nothing is built, nothing steps.

use super::{Scene, crowd};
use crate::config::Settings;
use crate::handle::BodyHandle;
use crate::memory::{Amounts, Category};
use crate::world::World;

/// Bytes that a world with a budget will hold at most while a scene runs in it.
///
/// Buffers with an entry for each body, shape or joint are exact: they are what [`World::add_bodies`]
/// reserves. Pairs, contacts and their rows are an estimate: their number at the start of the scene, or, if
/// that is more, the usual number where so many bodies come down on so much ground (docs/memory.md says how
/// good it is).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    bytes: Amounts,
}

impl Plan {
    /// The plan of a scene in a world with these settings; their budget does not matter.
    pub fn of(scene: &Scene, settings: &Settings) -> Plan {
        let handles: Vec<BodyHandle> =
            (0..scene.bodies.len() as u32).map(|slot| BodyHandle { slot, generation: 1 }).collect();
        let joints: Vec<_> = scene.joints.iter().filter_map(|joint| joint.desc(&handles)).collect();
        let bodies = scene.bodies.iter().map(|body| &body.desc);
        let content = (&joints[..], scene.couplings.len());
        Plan { bytes: World::planned(settings, bodies, content, &crowd::expect(scene, settings)) }
    }

    /// Bytes of one category.
    pub fn category(&self, category: Category) -> usize {
        self.bytes.of(category)
    }

    /// All categories with their bytes.
    pub fn iter(&self) -> impl Iterator<Item = (Category, usize)> + '_ {
        Category::ALL.into_iter().map(|category| (category, self.category(category)))
    }

    /// Bytes of all categories.
    pub fn total(&self) -> usize {
        self.bytes.total()
    }
}
