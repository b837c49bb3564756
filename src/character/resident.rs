//! Characters that live in a world under a handle: they walk as others do, and snapshots, hashes and
//! recordings of the world have them.

use super::carry::Carrier;
use super::report::Ground;
use super::{Character, CharacterReport, CharacterSettings};
use crate::error::Error;
use crate::handle::{BodyHandle, CharacterHandle, ShapeHandle};
use crate::math::Quat;
use crate::query::QueryFilter;
use crate::shape::Geometry;
use crate::words::{Reader, broken, words};
use crate::world::{Addition, CHARACTER_WORDS, Change, Resident, World};
use glam::{DVec3, Vec3};

/// Writes words one after another.
struct Writer {
    all: [u32; CHARACTER_WORDS],
    next: usize,
}

impl Writer {
    fn put<const N: usize>(&mut self, some: [u32; N]) {
        if let Some(place) = self.all.get_mut(self.next..self.next + N) {
            place.copy_from_slice(&some);
        }
        self.next += N;
    }
}

impl Character {
    /// All but its geometry.
    fn words(&self) -> [u32; CHARACTER_WORDS] {
        let mut out = Writer { all: [0; CHARACTER_WORDS], next: 0 };
        // By name and without a rest: a field that is new must not be forgotten.
        let CharacterSettings {
            radius,
            half_height,
            skin,
            max_slope,
            step_height,
            snap,
            iterations,
            up,
            mass,
            strength,
        } = self.settings;
        out.put([radius, half_height, skin, max_slope, step_height, snap, mass, strength].map(f32::to_bits));
        out.put([iterations]);
        out.put(words::<3>(up));
        out.put(words::<4>(self.turned.to_array()));
        out.put(words::<6>(self.position.to_array()));
        out.put([u32::from(self.ground.is_some()) | u32::from(self.carrier.is_some()) << 1]);
        if let Some(Ground { body, shape, point, normal, velocity }) = self.ground {
            out.put([body.slot, body.generation, shape.slot, shape.generation]);
            out.put(words::<6>(point.to_array()));
            out.put(words::<6>([normal, velocity]));
        } else {
            out.put([0; 16]);
        }
        if let Some(Carrier { body, position, rotation }) = self.carrier {
            out.put([body.slot, body.generation]);
            out.put(words::<6>(position.to_array()));
            out.put(words::<4>(rotation.to_array()));
        }
        debug_assert!(out.next + if self.carrier.is_some() { 0 } else { 12 } == CHARACTER_WORDS);
        out.all
    }

    /// The character of a geometry and words, which may come from outside.
    ///
    /// # Errors
    /// If one of its numbers can't be.
    fn from_resident(resident: &Resident) -> Result<Character, Error> {
        let mut from = Reader(&resident.words);
        let [radius, half_height, skin, max_slope, step_height, snap, mass, strength]: [f32; 8] =
            from.finite::<_, 8>()?;
        let iterations = from.one()?;
        let up: Vec3 = from.finite::<_, 3>()?;
        let settings = CharacterSettings {
            radius,
            half_height,
            skin,
            max_slope,
            step_height,
            snap,
            iterations,
            up,
            mass,
            strength,
        };
        let turned = Quat::from_array(from.finite::<_, 4>()?);
        // Already normalised: doing it again could change bits.
        crate::limits::unit_quat("character rotation", turned)?;
        let position = DVec3::from_array(from.record::<_, 6>()?);
        let has = from.one()?;
        let [b, bg, s, sg]: [u32; 4] = from.record::<_, 4>()?;
        let point = DVec3::from_array(from.record::<_, 6>()?);
        let [normal, velocity]: [Vec3; 2] = from.finite::<_, 6>()?;
        let ground = Ground {
            body: BodyHandle { slot: b, generation: bg },
            shape: ShapeHandle { slot: s, generation: sg },
            point,
            normal,
            velocity,
        };
        let [slot, generation]: [u32; 2] = from.record::<_, 2>()?;
        let carrier = Carrier {
            body: BodyHandle { slot, generation },
            position: DVec3::from_array(from.record::<_, 6>()?),
            rotation: Quat::from_array(from.finite::<_, 4>()?),
        };
        if has > 3 {
            return Err(broken("a character"));
        }
        let mut character = Character::new(settings, position)?;
        if has & 1 != 0 {
            crate::limits::position(point)?;
            crate::limits::unit_quat("ground normal", Quat::from_xyzw(normal.x, normal.y, normal.z, 0.0))?;
            character.ground = Some(ground);
        }
        if has & 2 != 0 {
            crate::limits::position(carrier.position)?;
            crate::limits::unit_quat("ground rotation", carrier.rotation)?;
            character.carrier = Some(carrier);
        }
        character.turned = turned;
        character.set_shape(resident.geometry.clone())?;
        Ok(character)
    }

    pub(crate) fn resident(&self) -> Resident {
        Resident { geometry: self.own().cloned(), words: self.words() }
    }
}

/// # Characters
impl World {
    /// Puts a character into the world, where [`World::walk_character`] moves it. Snapshots have its state,
    /// recordings every change of it, and [`World::state_hash`] counts it; bodies don't notice it.
    ///
    /// # Errors
    /// If the budget does not allow it.
    pub fn add_character(&mut self, character: &Character) -> Result<CharacterHandle, Error> {
        let resident = character.resident();
        self.reserve(Addition::Character(resident.geometry.as_ref(), self.slots_with_another()))?;
        self.note(Change::AddCharacter(&resident));
        Ok(self.insert_resident(resident))
    }

    /// Removes a character from the world.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn remove_character(&mut self, character: CharacterHandle) -> Result<(), Error> {
        self.characters.get(character)?;
        self.note(Change::RemoveCharacter(character));
        self.remove_resident(character);
        Ok(())
    }

    /// A character as it is now, a copy.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn character(&self, character: CharacterHandle) -> Result<Character, Error> {
        Character::from_resident(self.characters.get(character)?)
    }

    /// Replaces a character: to place it somewhere else, to give it other settings or another shape.
    ///
    /// # Errors
    /// If the handle is stale, or the budget does not allow its shape.
    pub fn set_character(&mut self, character: CharacterHandle, to: &Character) -> Result<(), Error> {
        self.characters.get(character)?;
        let resident = to.resident();
        self.reserve(Addition::Character(resident.geometry.as_ref(), 0))?;
        self.note(Change::SetCharacter(character, &resident));
        self.replace_resident(character, resident);
        Ok(())
    }

    /// [`Character::walk`] of a character of the world. For many at the same time from several threads, walk
    /// copies of them ([`World::character`]) and set these afterwards.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// let hero = Character::new(CharacterSettings::default(), DVec3::new(5.0, 1.0, 0.0))?;
    /// let hero = world.add_character(&hero)?;
    /// let dt = 1.0 / 60.0;
    /// for _ in 0..60 {
    ///     world.walk_character(hero, &QueryFilter::default(), Vec3::new(2.0, -1.0, 0.0), dt)?;
    ///     world.step(dt)?;
    /// }
    /// assert!((world.character(hero)?.position().x - 7.0).abs() < 0.1);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale, and as there; then nothing has changed.
    pub fn walk_character(
        &mut self,
        character: CharacterHandle,
        filter: &QueryFilter<'_>,
        velocity: Vec3,
        dt: f32,
    ) -> Result<CharacterReport, Error> {
        let mut walker = self.character(character)?;
        let report = walker.walk(self, filter, velocity, dt)?;
        let words = walker.words();
        self.note(Change::WalkCharacter(character, &words));
        self.write_resident(character, &words);
        Ok(report)
    }

    /// The characters of the world, by handle.
    pub fn characters(&self) -> impl Iterator<Item = CharacterHandle> + '_ {
        self.characters.iter().map(|(handle, _)| handle)
    }
}

/// A character of a geometry and words from outside, if it is one that a world may have.
///
/// # Errors
/// If one of its numbers can't be, or its shape is not convex.
pub(crate) fn checked_character(geometry: Option<Geometry>, words: &[u32]) -> Result<Character, Error> {
    let words = words.try_into().map_err(|_| broken("a character"))?;
    Character::from_resident(&Resident { geometry, words })
}
