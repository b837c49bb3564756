//! Memory that a world will hold, before it exists, from the sizes of its buffers.

use super::budget::Counts;
use crate::body::BodyDesc;
use crate::broad_phase::BroadPhase;
use crate::config::Settings;
use crate::constraint::JOINT_BYTES;
use crate::joint::{JointAdditions, JointDesc};
use crate::memory::{Amounts, Category};
use crate::narrow_phase::{ContactCount, FRESH_BYTES};
use crate::shape::Collider;
use crate::world::{Needs, World};
use glam::Vec3;

/// Maximum numbers of pairs, contacts and other content that varies from step to step.
#[derive(Clone, Copy, Debug, Default)]
pub struct ContentForecast {
    /// Pairs of colliders that may touch.
    pub pairs: usize,
    /// Pairs with meshes and height fields.
    pub of_meshes: usize,
    /// Contacts that are new in one step.
    pub fresh: usize,
    /// Contacts by their number of points: between dynamic bodies, and with static ones.
    pub contacts: [[usize; 4]; 2],
    /// The share of them that is due to continuous collision.
    pub ahead: f32,
    /// Bodies in trees of joints of a unique shape.
    pub branches: usize,
}

/// Bytes that a world with a budget will hold at most, before it exists.
///
/// Buffers with an entry for each body, shape or joint are exact: [`World::add_bodies`] reserves as much.
/// Pairs, contacts and their rows follow from a [`ContentForecast`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    bytes: Amounts,
}

impl Plan {
    /// Of a world with these settings, whose budget does not matter, with bodies, joints between them (their
    /// handles do not matter) and a number of couplings.
    pub fn new<'a>(
        settings: &Settings,
        bodies: impl IntoIterator<Item = &'a BodyDesc> + Clone,
        joints: &[JointDesc],
        couplings: usize,
        forecast: &ContentForecast,
    ) -> Plan {
        Plan { bytes: planned(settings, bodies, (joints, couplings), forecast) }
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

/// Bytes by category of a world whose budget is never short.
fn planned<'a>(
    settings: &Settings,
    bodies: impl IntoIterator<Item = &'a BodyDesc> + Clone,
    (joints, couplings): (&[JointDesc], usize),
    crowd: &ContentForecast,
) -> Amounts {
    // No body is ever added to it: it only provides sizes.
    let mut empty = World { settings: settings.clone(), ..World::default() };
    let mut needs = Needs::default();
    let shapes = bodies.clone().into_iter().flat_map(|body| &body.shapes);
    shapes.for_each(|shape| needs.count(&Collider::of(shape), 1));
    let (friction, beside) = (needs.friction > 0, needs.beside());
    let more = Counts { joined: !joints.is_empty(), ..empty.counts_of_bodies(bodies) };
    let counts = empty.counts(more);
    let mut bytes = empty.lacking(counts);

    let coupled = (0..couplings).map(|_| JointAdditions::of_coupling());
    let more = joints.iter().map(JointAdditions::of_joint).chain(coupled);
    let more = more.fold(JointAdditions::default(), JointAdditions::and);
    bytes.add(Category::Joints, empty.joints.missing_columns(more));
    let [lock, row, branch] = JOINT_BYTES;
    let (locks, rows) = more.rows();
    let in_lanes = locks.saturating_sub(crowd.branches);
    bytes.add(Category::Joints, in_lanes * lock + rows * row + crowd.branches * branch);

    let contacts: usize = crowd.contacts.iter().flatten().sum();
    bytes.add(Category::BroadPhase, empty.broad.missing(crowd.pairs));
    bytes.add(Category::BroadPhase, BroadPhase::missing_to_find(crowd.pairs));
    let buffers = &mut empty.buffers;
    let narrow = &buffers.narrow;
    bytes.add(Category::Scratch, narrow.missing(crowd.pairs));
    bytes.add(Category::Scratch, narrow.missing_to_find(crowd.of_meshes));
    bytes.add(Category::Scratch, buffers.prepare.missing(contacts));
    bytes.add(Category::Scratch, buffers.statics.missing(contacts));
    let points = crowd.contacts.iter().flat_map(|side| side.iter().zip(1..)).map(|(n, points)| n * points);
    let of_rolling = if beside.rolling { contacts * size_of::<Vec3>() } else { 0 };
    let manifolds = of_rolling + empty.contacts.missing(ContactCount { contacts, points: points.sum() });
    // The last batches for each number of points are not full.
    let batches = crowd.contacts.map(|side| side.map(|n| (n.div_ceil(8) + ENDS).min(n)));
    let stages = buffers.prepare.most_stages(settings.order);
    // New contacts occupy the memory of rows.
    let rows = buffers.rows.missing(batches, stages, friction, beside).max(crowd.fresh * FRESH_BYTES);
    let ahead = |bytes: usize| (bytes as f32 * crowd.ahead) as usize;
    bytes.add(Category::Manifolds, manifolds - ahead(manifolds));
    let brought = bytes.of(Category::Rows);
    bytes.add(Category::Rows, (rows - ahead(rows)).saturating_sub(brought));
    bytes.add(Category::Continuous, ahead(manifolds) + ahead(rows));
    bytes
}

/// Incomplete batches for each number of points: some colours have few contacts.
const ENDS: usize = 2;
