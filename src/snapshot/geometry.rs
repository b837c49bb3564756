//! Geometry by reference: shapes of a few numbers are written, shared geometry is named by its index in a
//! table.

use super::checksum::hash;
use crate::error::Error;
use crate::shape::Geometry;
use crate::words::{broken, words};
use crate::world::World;

/// A hull, a mesh or a height field of a part.
#[derive(Clone, Debug)]
pub(crate) enum Known {
    /// The geometry itself.
    Here(Geometry),
    /// The fingerprint of geometry that the restored world has to have.
    Print(u64),
}

impl Known {
    /// A number that differs if the content does.
    pub(super) fn print(&self) -> u64 {
        match self {
            Known::Here(geometry) => print_of(geometry),
            Known::Print(print) => *print,
        }
    }
}

/// Shared geometry by its place.
#[derive(Debug, Default)]
pub(super) struct Table {
    pub(super) known: Vec<Known>,
    places: std::collections::BTreeMap<usize, u32>,
}

/// A code, and numbers that go with it.
pub(super) fn code_of(geometry: &Geometry, table: &mut Table) -> (u32, [u32; 4]) {
    let Some(address) = geometry.address() else { return code_in(geometry, 0) };
    let next = table.known.len() as u32;
    // Addresses are compared for identity only: indices are in the order of first use.
    let place = *table.places.entry(address).or_insert(next);
    if place == next {
        table.known.push(Known::Here(geometry.clone()));
    }
    code_in(geometry, place)
}

/// The same, for shared geometry that is at a place.
pub(super) fn code_in(geometry: &Geometry, place: u32) -> (u32, [u32; 4]) {
    let numbers = if geometry.address().is_some() { [place, 0, 0, 0] } else { words(geometry.size()) };
    (geometry.code(), numbers)
}

/// The geometry of a code.
pub(super) fn geometry_of(code: u32, numbers: &[u32], known: &[Geometry]) -> Result<Geometry, Error> {
    let shared = || known.get(numbers[0] as usize).filter(|geometry| geometry.code() == code).cloned();
    let small = Geometry::of_numbers(code, crate::words::record::<_, 4>(numbers));
    small.or_else(shared).ok_or_else(|| broken("a shape"))
}

/// A number that differs if the content of shared geometry does.
fn print_of(geometry: &Geometry) -> u64 {
    let mut all = Vec::new();
    geometry.words(&mut all);
    hash(&all).wrapping_add(geometry.code().into())
}

/// The geometry of a table that is here.
pub(super) fn here(table: &[Known]) -> impl Iterator<Item = &Geometry> {
    table.iter().filter_map(|known| match known {
        Known::Here(geometry) => Some(geometry),
        Known::Print(_) => None,
    })
}

/// A table with geometry in the place of fingerprints, which the world has to have.
///
/// # Errors
/// If it lacks some.
pub(super) fn found(table: &[Known], world: &World) -> Result<Vec<Known>, Error> {
    Ok(resolve(table, world)?.into_iter().map(Known::Here).collect())
}

/// The geometry of a table; fingerprints are looked up in the world.
pub(super) fn resolve(table: &[Known], world: &World) -> Result<Vec<Geometry>, Error> {
    let mut own: Option<Vec<(u64, Geometry)>> = None;
    let mut find = |print: u64| {
        let own = own.get_or_insert_with(|| {
            let colliders = world.colliders.all.iter().filter(|collider| collider.body != u32::MAX);
            let of_characters = world.characters.iter().filter_map(|(_, own)| own.geometry.as_ref());
            let mut known = std::collections::BTreeSet::new();
            // In the order of use, not of addresses: of two with equal content the same is found in each run.
            let all = colliders.map(|collider| &collider.geometry).chain(of_characters);
            let shared = all.filter(|geometry| geometry.address().is_some_and(|at| known.insert(at)));
            shared.map(|geometry| (print_of(geometry), geometry.clone())).collect()
        });
        own.iter().find(|(other, _)| *other == print).map(|(_, geometry)| geometry.clone())
    };
    table
        .iter()
        .map(|known| match known {
            Known::Here(geometry) => Ok(geometry.clone()),
            Known::Print(print) => find(*print)
                .ok_or(Error::ForeignSnapshot { what: "a mesh, height field or hull that this one lacks" }),
        })
        .collect()
}
