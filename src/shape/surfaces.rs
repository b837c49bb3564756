//! Materials of the triangles of a mesh, or of the cells of a height field: a byte each, and a table.

use super::Material;
use crate::error::{self, Error, each, within};
use crate::memory::{bytes_of, sum_bytes};

/// Most materials of a table: a byte counts them, and zero is the shape's own.
pub(super) const MAX_MATERIALS: usize = u8::MAX as usize;

/// The materials of parts of a shape. There is none of it where all parts have the shape's own.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub(crate) struct Surfaces {
    /// For each triangle or cell: zero for the shape's own material, `i` for the table's `i - 1`.
    pub(super) parts: Vec<u8>,
    pub(super) table: Vec<Material>,
}

impl Surfaces {
    /// For so many triangles or cells.
    pub(super) fn new(count: usize, parts: Vec<u8>, table: Vec<Material>) -> Result<Box<Surfaces>, Error> {
        error::count("numbers of materials", "one for each triangle or cell", count, parts.len())?;
        if table.len() > MAX_MATERIALS {
            return Err(Error::TooMany { what: "materials of a shape", most: MAX_MATERIALS as u64 });
        }
        each("material", &table, Material::validate)?;
        let most = parts.iter().copied().max().unwrap_or(0);
        within(
            "number of a material",
            f32::from(most),
            0.0,
            table.len() as f32,
            "at most the table's length",
        )?;
        Ok(Box::new(Surfaces { parts, table }))
    }

    /// Bytes live and reserved.
    pub(super) fn bytes(this: &Option<Box<Surfaces>>) -> (usize, usize) {
        let Some(this) = this else { return (0, 0) };
        let own = size_of::<Surfaces>();
        sum_bytes([bytes_of(&this.parts), bytes_of(&this.table), (own, own)])
    }

    #[inline]
    pub(super) fn part(this: &Option<Box<Surfaces>>, i: usize) -> u8 {
        this.as_ref().map_or(0, |this| this.parts.get(i).copied().unwrap_or(0))
    }

    pub(super) fn table(this: &Option<Box<Surfaces>>) -> &[Material] {
        this.as_ref().map_or(&[], |this| &this.table)
    }

    /// All as words, for a fingerprint; nothing if there are none.
    pub(crate) fn words(this: &Option<Box<Surfaces>>) -> impl Iterator<Item = u32> + '_ {
        this.iter().flat_map(|this| {
            let numbers = |m: &Material| {
                // No field is left out by `..`: a new field must say here where it is stored.
                let &Material {
                    static_friction,
                    dynamic_friction,
                    restitution,
                    friction_combine,
                    restitution_combine,
                    rolling_friction,
                    spinning_friction,
                    surface_velocity,
                    contact_hertz,
                    contact_damping,
                } = m;
                let how = [friction_combine as u32, restitution_combine as u32];
                let of_contacts = [static_friction, dynamic_friction, restitution];
                let rare = [rolling_friction, spinning_friction, contact_hertz, contact_damping];
                let numbers = of_contacts.into_iter().chain(rare).chain(surface_velocity.to_array());
                how.into_iter().chain(numbers.map(f32::to_bits)).collect::<Vec<u32>>()
            };
            this.parts.iter().map(|&part| part.into()).chain(this.table.iter().flat_map(numbers))
        })
    }
}
