//! Every long-lived byte belongs to a category; the report says how many, and how many continuous physics
//! adds.

mod allowance;
mod allowances;
mod amounts;
mod budget;
mod buffers;
mod column;
mod slab;

pub(crate) use allowance::{Allowance, Buffer, Buffers, Made, Marks, even_out};
pub(crate) use allowances::Allowances;
pub(crate) use amounts::Amounts;
pub use budget::Budget;
#[cfg(debug_assertions)]
pub(crate) use buffers::spoil;
pub(crate) use buffers::{List, buffers};
pub(crate) use column::{add_bytes, bytes_of, in_arc, sum_bytes};
pub(crate) use slab::{Cut, Slab};

use std::fmt;

/// The purpose of a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Category {
    /// Poses, velocities, masses, handles.
    Bodies,
    /// Colliders, materials, convex hulls.
    Shapes,
    /// Triangle meshes and height fields, with their trees.
    Meshes,
    /// Trees of the world, bounds, pairs.
    BroadPhase,
    /// Contact manifolds and their impulses.
    Manifolds,
    /// Solver rows in their batches.
    Rows,
    /// Joints.
    Joints,
    /// Event buffers.
    Events,
    /// Buffers of one step.
    Scratch,
    /// Memory that exists only because of continuous collision: motion segments, potential points and their
    /// rows.
    Continuous,
}

impl Category {
    /// Every category, in the order of reports.
    pub const ALL: [Category; 10] = [
        Category::Bodies,
        Category::Shapes,
        Category::Meshes,
        Category::BroadPhase,
        Category::Manifolds,
        Category::Rows,
        Category::Joints,
        Category::Events,
        Category::Scratch,
        Category::Continuous,
    ];

    /// The name in reports and JSON.
    pub fn name(self) -> &'static str {
        match self {
            Category::Bodies => "bodies",
            Category::Shapes => "shapes",
            Category::Meshes => "meshes",
            Category::BroadPhase => "broad_phase",
            Category::Manifolds => "manifolds",
            Category::Rows => "rows",
            Category::Joints => "joints",
            Category::Events => "events",
            Category::Scratch => "scratch",
            Category::Continuous => "continuous",
        }
    }
}

impl fmt::Display for Category {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Bytes of one category.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Bytes {
    /// In use now.
    pub live: usize,
    /// Held, in use or not.
    pub reserved: usize,
    /// The most that was ever reserved.
    pub peak: usize,
}

/// Bytes by category.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MemoryReport {
    bytes: [Bytes; Category::ALL.len()],
}

impl MemoryReport {
    /// The bytes of one category.
    pub fn category(&self, category: Category) -> Bytes {
        self.bytes[category as usize]
    }

    /// All categories with their bytes.
    pub fn iter(&self) -> impl Iterator<Item = (Category, Bytes)> + '_ {
        Category::ALL.iter().map(|&c| (c, self.category(c)))
    }

    /// Reserved bytes of all categories.
    pub fn total(&self) -> usize {
        self.bytes.iter().map(|b| b.reserved).sum()
    }

    pub(crate) fn add(&mut self, category: Category, (live, reserved): (usize, usize)) {
        let bytes = &mut self.bytes[category as usize];
        bytes.live += live;
        bytes.reserved += reserved;
        bytes.peak = bytes.peak.max(bytes.reserved);
    }

    /// Counts bytes under another category than the one that holds them, but none of those that it needs
    /// itself now.
    pub(crate) fn shift(&mut self, from: Category, to: Category, (live, reserved): (usize, usize)) {
        let held = &mut self.bytes[from as usize];
        let live = live.min(held.live);
        let reserved = reserved.min(held.reserved - (held.live - live));
        let live = live.min(reserved);
        held.live -= live;
        held.reserved -= reserved;
        held.peak = held.reserved;
        self.add(to, (live, reserved));
    }

    /// Reserved bytes of each category.
    pub(crate) fn reserved(&self) -> Amounts {
        let mut all = Amounts::default();
        self.iter().for_each(|(category, bytes)| all.add(category, bytes.reserved));
        all
    }

    /// Takes over some categories of another report.
    pub(crate) fn take_over(&mut self, other: &MemoryReport, categories: &[Category]) {
        categories.iter().for_each(|&c| self.bytes[c as usize] = other.bytes[c as usize]);
    }

    /// Takes over the peaks of an earlier report.
    pub(crate) fn keep_peaks(&mut self, earlier: &MemoryReport) {
        for (now, before) in self.bytes.iter_mut().zip(&earlier.bytes) {
            now.peak = now.peak.max(before.peak);
        }
    }
}
