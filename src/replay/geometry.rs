//! Geometry in a recording: small forms by their numbers, shared ones once by content.

use super::call::Call;
use super::hash::Hash;
use super::tape::Sink;
use crate::error::Error;
use crate::load_limits::{LimitExceeded, Tally};
use crate::shape::{ConvexHull, Geometry, HeightField, Kind, TriangleMesh};
pub(super) use crate::shape::{StoredHull, StoredMesh};
use crate::snapshot::RecordedPart;
use crate::world::SharedPart;
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::any::Any;
use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Weak};

/// [`Geometry`] with shared geometry by number.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) enum Form {
    Sphere(f32),
    Capsule([f32; 3]),
    Box(Vec3),
    Cylinder([f32; 3]),
    Plane,
    Shared(u32),
    /// Any other of a few numbers: its code in snapshots, and these.
    Numbers(u32, [f32; 4]),
}

/// Keeps the address of shared geometry from being given to another, not its content.
type Held = Weak<dyn Any + Send + Sync>;

/// The geometry that was written.
///
/// Geometry that shares memory in the run shares it in the replay, and no other does, because a budget counts
/// memory. So each object in memory has a number of its own, but of objects with equal content only the first
/// is written.
#[derive(Default)]
pub(super) struct Written {
    /// With the shared value, which is held for it and never read.
    by_address: BTreeMap<usize, (u32, Held)>,
    /// By hash and length of the bytes.
    by_content: BTreeMap<(u64, usize), u32>,
    /// The last parts of snapshots.
    parts: VecDeque<SharedPart>,
    /// How many there were.
    part_count: u32,
}

/// The parts of snapshots that a recording can refer to: the last of them. More than a game goes back by.
pub(super) const PARTS: usize = 64;

impl Written {
    /// The number of a part, or that which it gets now.
    pub(super) fn part(&mut self, part: &SharedPart) -> Result<u32, u32> {
        let first = self.part_count - self.parts.len() as u32;
        if let Some(place) = self.parts.iter().position(|known| Weak::ptr_eq(known, part)) {
            return Ok(first + place as u32);
        }
        if self.parts.len() == PARTS {
            self.parts.pop_front();
        }
        self.parts.push_back(part.clone());
        self.part_count += 1;
        Err(self.part_count - 1)
    }
}

impl Sink {
    pub(super) fn form(&mut self, geometry: &Geometry) -> Form {
        match geometry {
            Geometry::Hull(hull) => return self.shared(hull, |hull| Call::Hull(hull.stored())),
            Geometry::Mesh(mesh) => return self.shared(mesh, |mesh| Call::Mesh(mesh.stored())),
            Geometry::HeightField(field) => return self.shared(field, |field| Call::Field(field.stored())),
            _ => {}
        }
        let [a, b, c, _] = geometry.size();
        match Kind::of(geometry) {
            Kind::Sphere => Form::Sphere(a),
            Kind::Capsule => Form::Capsule([a, b, c]),
            Kind::Box => Form::Box(Vec3::new(a, b, c)),
            Kind::Cylinder => Form::Cylinder([a, b, c]),
            Kind::Plane => Form::Plane,
            _ => Form::Numbers(geometry.code(), geometry.size()),
        }
    }

    fn shared<T: Any + Send + Sync>(&mut self, shared: &Arc<T>, content: impl Fn(&T) -> Call) -> Form {
        let address = Arc::as_ptr(shared) as usize;
        if let Some((number, _)) = self.written.by_address.get(&address) {
            return Form::Shared(*number);
        }
        let number = self.written.by_address.len() as u32;
        let held: Arc<dyn Any + Send + Sync> = shared.clone();
        self.written.by_address.insert(address, (number, Arc::downgrade(&held)));
        let content = content(shared);
        let from = self.block.len();
        self.write(&content);
        let bytes = self.block.get(from..).unwrap_or_default();
        let mut hash = Hash::new();
        hash.bytes(bytes);
        let key = (hash.long(), bytes.len());
        match self.written.by_content.get(&key).copied() {
            Some(first) => {
                self.block.truncate(from);
                self.write(&Call::Again(first));
            }
            None => {
                self.written.by_content.insert(key, number);
            }
        }
        Form::Shared(number)
    }
}

/// The geometry that was read, by number.
#[derive(Default)]
pub(super) struct Read(Vec<Geometry>);

/// The last parts of snapshots that were read, by number.
#[derive(Default)]
pub(super) struct Parts {
    last: VecDeque<RecordedPart>,
    count: u32,
}

impl Parts {
    pub(super) fn define(&mut self, part: RecordedPart) {
        if self.last.len() == PARTS {
            self.last.pop_front();
        }
        self.last.push_back(part);
        self.count += 1;
    }

    pub(super) fn get(&self, number: u32) -> Option<RecordedPart> {
        let place = number.checked_sub(self.count - self.last.len() as u32)?;
        self.last.get(place as usize).cloned()
    }
}

impl Read {
    /// Counts the definitions of a call, before it is made.
    pub(super) fn charge(&self, call: &Call, tally: &mut Tally) -> Result<(), LimitExceeded> {
        let (vertices, triangles) = match call {
            Call::Hull(hull) => hull.counts(),
            Call::Mesh(mesh) => mesh.counts(),
            Call::Field(field) => field.counts(),
            // The call is a few bytes of the file, but the copy counts by its size.
            Call::Again(number) => {
                let known = self.0.get(*number as usize);
                return tally.memory.take(known.map_or(0, |known| known.bytes().1));
            }
            _ => (0, 0),
        };
        tally.vertices.take(vertices)?;
        tally.triangles.take(triangles)
    }

    /// Keeps the geometry that a call defines; none if it defines none.
    pub(super) fn define(&mut self, call: Call) -> Option<Result<(), Error>> {
        let made = match call {
            Call::Hull(hull) => ConvexHull::from_stored(hull).map(Geometry::hull),
            Call::Mesh(mesh) => TriangleMesh::from_stored(mesh).map(Geometry::mesh),
            Call::Field(field) => HeightField::from_stored(field).map(Geometry::height_field),
            Call::Again(number) => self.shared(number).map(|geometry| match geometry {
                Geometry::Hull(hull) => Geometry::hull((**hull).clone()),
                Geometry::Mesh(mesh) => Geometry::mesh((**mesh).clone()),
                Geometry::HeightField(field) => Geometry::height_field((**field).clone()),
                other => other.clone(),
            }),
            _ => return None,
        };
        Some(made.map(|geometry| self.0.push(geometry)))
    }

    #[cfg(test)]
    pub(super) fn count(&self) -> usize {
        self.0.len()
    }

    /// Bytes of the geometry that was defined last.
    pub(super) fn last_bytes(&self) -> usize {
        self.0.last().map_or(0, |last| last.bytes().1)
    }

    pub(super) fn geometry(&self, form: Form) -> Result<Geometry, Error> {
        Ok(match form {
            Form::Sphere(radius) => Geometry::Sphere { radius },
            Form::Capsule([half_height, radius_bottom, radius_top]) => {
                Geometry::Capsule { half_height, radius_bottom, radius_top }
            }
            Form::Box(half_extents) => Geometry::Box { half_extents },
            Form::Cylinder([half_height, radius_bottom, radius_top]) => {
                Geometry::Cylinder { half_height, radius_bottom, radius_top }
            }
            Form::Plane => Geometry::Plane,
            Form::Shared(number) => self.shared(number)?.clone(),
            Form::Numbers(code, numbers) => Geometry::of_numbers(code, numbers)
                .ok_or_else(|| Error::Degenerate("a recorded form is none".into()))?,
        })
    }

    fn shared(&self, number: u32) -> Result<&Geometry, Error> {
        self.0.get(number as usize).ok_or_else(|| Error::Degenerate("a recorded geometry is missing".into()))
    }
}
