//! Geometry by reference: shapes of a few numbers are written, shared geometry is named by its index in a
//! table.

use super::checksum::hash;
use crate::error::Error;
use crate::shape::{Geometry, Surfaces};
use crate::words::{broken, words};
use crate::world::World;
use std::sync::Arc;

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

fn address(geometry: &Geometry) -> Option<usize> {
    match geometry {
        Geometry::Hull(hull) => Some(Arc::as_ptr(hull) as usize),
        Geometry::Mesh(mesh) => Some(Arc::as_ptr(mesh) as usize),
        Geometry::HeightField(field) => Some(Arc::as_ptr(field) as usize),
        _ => None,
    }
}

/// A code, and numbers that go with it.
pub(super) fn code_of(geometry: &Geometry, table: &mut Table) -> (u32, [u32; 4]) {
    let Some(address) = address(geometry) else { return code_in(geometry, 0) };
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
    let code = match geometry {
        Geometry::Sphere { .. } => 0,
        Geometry::Capsule { .. } => 1,
        Geometry::Box { .. } => 2,
        Geometry::Cylinder { .. } => 3,
        Geometry::Plane => 4,
        Geometry::Hull(_) => 5,
        Geometry::Mesh(_) => 6,
        Geometry::HeightField(_) => 7,
    };
    if address(geometry).is_some() {
        return (code, [place, 0, 0, 0]);
    }
    (code, geometry.size().map(f32::to_bits))
}

/// The geometry of a code.
pub(super) fn geometry_of(code: u32, numbers: &[u32], known: &[Geometry]) -> Result<Geometry, Error> {
    let [a, b, c, _]: [f32; 4] = crate::words::record::<_, 4>(numbers);
    let shared = known.get(numbers[0] as usize);
    let no = || broken("a shape");
    Ok(match code {
        0 => Geometry::Sphere { radius: a },
        1 => Geometry::Capsule { half_height: a, radius_bottom: b, radius_top: c },
        2 => Geometry::Box { half_extents: glam::Vec3::new(a, b, c) },
        3 => Geometry::Cylinder { half_height: a, radius_bottom: b, radius_top: c },
        4 => Geometry::Plane,
        5 => shared.filter(|g| matches!(g, Geometry::Hull(_))).ok_or_else(no)?.clone(),
        6 => shared.filter(|g| matches!(g, Geometry::Mesh(_))).ok_or_else(no)?.clone(),
        7 => shared.filter(|g| matches!(g, Geometry::HeightField(_))).ok_or_else(no)?.clone(),
        _ => return Err(no()),
    })
}

/// A number that differs if the content of shared geometry does.
fn print_of(geometry: &Geometry) -> u64 {
    let mut all = Vec::new();
    let mut triangles = |count: usize, corners: &dyn Fn(u32) -> [glam::Vec3; 3]| {
        (0..count as u32).for_each(|i| all.extend(words::<9>(corners(i))));
    };
    let kind = match geometry {
        Geometry::Hull(hull) => {
            all.extend(hull.vertices().iter().flat_map(|&v| words::<3>(v)));
            5
        }
        Geometry::Mesh(mesh) => {
            triangles(mesh.triangle_count(), &|i| mesh.triangle(i));
            all.extend(Surfaces::words(&mesh.surfaces));
            6
        }
        Geometry::HeightField(field) => {
            triangles(field.triangle_count(), &|i| field.triangle(i));
            all.extend(field.holes());
            all.extend(Surfaces::words(&field.surfaces));
            7
        }
        _ => 0,
    };
    hash(&all).wrapping_add(kind)
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
            let shared = all.filter(|geometry| address(geometry).is_some_and(|at| known.insert(at)));
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
