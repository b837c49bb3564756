//! Characters: capsules and other convex shapes that walk.

mod resident;

pub use resident::*;

use crate::abi::guard::{call, value_or};
use crate::abi::lock::{Changing, Reading, Shared};
use crate::abi::pointers::{Buffer, Out, borrow};
use crate::abi::sized::{place, read, write};
use crate::abi::status::{BsStatus, Outcome};
use crate::abi::twin::record;
use crate::abi::values::{BsBody, BsBool, BsDVec3, BsQuat, BsShape, BsVec3};
use crate::query::{BsQueryFilter, with_filter};
use crate::shape::BsGeometry;
use crate::world::{BsWorld, changing, reading};
use backstop::{Character, CharacterHit, CharacterReport, CharacterSettings, Ground, QueryFilter};

/// A capsule, or another convex shape, that walks, climbs steps, slides along walls and is carried by what it
/// stands on. Calls that take it as `const` may come from any number of threads at once.
pub struct BsCharacter {
    walker: Shared<Walker>,
}

struct Walker {
    character: Character,
    report: CharacterReport,
}

impl Walker {
    /// The report of its last walk.
    fn told(&self) -> BsCharacterReport {
        let position = self.character.position().into();
        BsCharacterReport { position, ..BsCharacterReport::of_engine(&self.report) }
    }
}

record! {
    /// Settings of a character.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsCharacterSettings of settings: CharacterSettings {
        /// Size of this struct; `bs_character_settings_default` fills it in.
        pub size: u32 = size_of::<BsCharacterSettings>() as u32,
        pub radius: f32,
        pub half_height: f32,
        pub skin: f32,
        /// The steepest ground to stand and walk on [rad], 0..=1.57. Default 50 degrees.
        pub max_slope: f32,
        pub step_height: f32,
        pub snap: f32,
        pub iterations: u32,
        /// The upward direction, a unit vector. Default y.
        pub up: BsVec3,
        pub mass: f32,
        pub strength: f32,
    }
    default bs_character_settings_default()
}

/// A character of 1.8 m and 80 kg.
#[unsafe(no_mangle)]
pub extern "C" fn bs_character_settings_default() -> BsCharacterSettings {
    BsCharacterSettings::of_engine(&CharacterSettings::default())
}

record! {
    /// What a character stands on.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsGround of ground: Ground {
        /// Whose shape it is.
        pub body: BsBody,
        /// Which shape.
        pub shape: BsShape,
        /// Where, in the world [m].
        pub point: BsDVec3,
        /// Unit, out of the ground.
        pub normal: BsVec3,
        /// How fast the ground moves at that point [m/s].
        pub velocity: BsVec3,
    }
}

impl BsGround {
    const NONE: BsGround = BsGround {
        body: BsBody::NONE,
        shape: BsShape::NONE,
        point: BsDVec3 { x: 0.0, y: 0.0, z: 0.0 },
        normal: BsVec3 { x: 0.0, y: 0.0, z: 0.0 },
        velocity: BsVec3 { x: 0.0, y: 0.0, z: 0.0 },
    };
}

record! {
    /// What a character ran into.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsCharacterHit of hit: CharacterHit {
        /// Whose shape it is.
        pub body: BsBody,
        /// Which shape.
        pub shape: BsShape,
        /// Where, in the world [m].
        pub point: BsDVec3,
        /// Unit, from the obstacle towards the character.
        pub normal: BsVec3,
        /// Impulse of the push on a dynamic body, zero for others [N s].
        pub impulse: BsVec3,
    }
}

impl Default for BsCharacterHit {
    fn default() -> BsCharacterHit {
        let (point, none) = (BsDVec3::default(), BsVec3::default());
        BsCharacterHit { body: BsBody::NONE, shape: BsShape::NONE, point, normal: none, impulse: none }
    }
}

record! {
    /// What came of a walk.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsCharacterReport of report: CharacterReport {
        /// Size of this struct, set by the caller.
        pub size: u32 = size_of::<BsCharacterReport>() as u32,
        /// How far steps were climbed [m].
        pub stepped: f32,
        /// Where the middle of the capsule is [m].
        pub position: BsDVec3 = BsDVec3::default(),
        /// The whole displacement [m].
        pub moved: BsVec3,
        /// The part of it by moving ground [m].
        pub carried: BsVec3,
        /// The part of it out of bodies that had moved into the character [m].
        pub pushed_out: BsVec3,
        /// The velocity after obstacles [m/s]: relative to the ground if there is one, else in the world.
        pub velocity: BsVec3,
        /// By how much the ground turned about `up` meanwhile [rad].
        pub turned: f32,
        /// Remaining overlap of the capsule [m]; above zero only if it is squeezed.
        pub overlap: f32,
        /// The ground, if `on_ground`.
        pub ground: BsGround = report.ground.as_ref().map_or(BsGround::NONE, BsGround::of_engine),
        /// Whether it stands on something.
        pub on_ground: BsBool = report.ground.is_some().into(),
        /// Zero.
        pub reserved: [u8; 7] = [0; 7],
    }
    default BsCharacterReport::default()
}

impl Default for BsCharacterReport {
    fn default() -> BsCharacterReport {
        BsCharacterReport::of_engine(&CharacterReport::default())
    }
}

/// # Safety
/// The pointer is null or that of a character that nobody destroys meanwhile.
unsafe fn looking<'a>(character: *const BsCharacter) -> Outcome<Reading<'a, Walker>> {
    // SAFETY: as this function.
    unsafe { borrow("the character", character) }?.walker.read()
}

/// # Safety
/// As `looking`.
unsafe fn moving<'a>(character: *const BsCharacter) -> Outcome<Changing<'a, Walker>> {
    // SAFETY: as this function.
    unsafe { borrow("the character", character) }?.walker.change()
}

/// A character whose capsule has its middle at a point [m]. `settings` may be null: the defaults. It belongs
/// to no world: each walk says in which.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_character_create(
    settings: *const BsCharacterSettings,
    position: BsDVec3,
    character: *mut *mut BsCharacter,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (out, settings) = unsafe {
            let out = Out::new("the place for the character", character)?;
            (out, crate::abi::sized::read_or_default(settings)?)
        };
        let character = Character::new(settings.on(CharacterSettings::default())?, position.into())?;
        let walker = Shared::new(Walker { character, report: CharacterReport::default() });
        out.set(Box::into_raw(Box::new(BsCharacter { walker })));
        Ok(())
    })
}

/// Destroys a character. Null is none, and fine.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_character_destroy(character: *mut BsCharacter) {
    value_or((), || {
        if !character.is_null() {
            // SAFETY: it came from `bs_character_create`, and nobody else has it.
            drop(unsafe { Box::from_raw(character) });
        }
    });
}

/// Moves with a velocity [m/s] for `dt` [s], as far as obstacles allow. On ground the velocity is relative to
/// it, in the air it is that in the world; gravity is the caller's to add. `filter` may be null, `report`
/// too.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_character_walk(
    character: *mut BsCharacter,
    world: *const BsWorld,
    filter: *const BsQueryFilter,
    velocity: BsVec3,
    dt: f32,
    report: *mut BsCharacterReport,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut walker, content) = unsafe { (moving(character)?, reading(world)?) };
        if !report.is_null() {
            // A report that can't be written is refused before the walk.
            // SAFETY: the caller keeps to the header.
            unsafe { place(report) }?;
        }
        let walk = |filter: &QueryFilter<'_>| {
            walker.report = walker.character.walk(&content, filter, velocity.into(), dt)?;
            Ok(())
        };
        // SAFETY: the caller keeps to the header.
        unsafe { with_filter(filter, walk) }?;
        if report.is_null() {
            return Ok(());
        }
        let after = walker.told();
        // SAFETY: the caller keeps to the header.
        unsafe { write(report, after) }
    })
}

/// The report of the last walk.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_character_report(
    character: *const BsCharacter,
    report: *mut BsCharacterReport,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let walker = unsafe { looking(character) }?;
        let own = walker.told();
        // SAFETY: the caller keeps to the header.
        unsafe { write(report, own) }
    })
}

/// What the last walk ran into, in order, up to eight. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_character_hits(
    character: *const BsCharacter,
    hits: *mut BsCharacterHit,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (walker, out) = unsafe { (looking(character)?, Buffer::new("hits", hits, capacity, count)?) };
        let hits: Vec<_> = walker.report.hits().map(BsCharacterHit::of_engine).collect();
        out.fill(hits.into_iter())
    })
}

/// Pushes the dynamic bodies that the last walk ran into, and puts the character's weight on the one that it
/// stands on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_character_push(character: *const BsCharacter, world: *mut BsWorld) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (walker, mut content) = unsafe { (looking(character)?, changing(world)?) };
        Ok(walker.report.push(&mut content.world)?)
    })
}

/// Where the middle of the capsule is, and the ground under a character on level ground [m]; each pointer may
/// be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_character_position(
    character: *const BsCharacter,
    middle: *mut BsDVec3,
    feet: *mut BsDVec3,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (walker, middle, feet) = unsafe {
            let middle = Out::optional("the place for the middle", middle)?;
            (looking(character)?, middle, Out::optional("the place for the feet", feet)?)
        };
        if let Some(out) = middle {
            out.set(walker.character.position().into());
        }
        if let Some(out) = feet {
            out.set(walker.character.feet().into());
        }
        Ok(())
    })
}

/// Puts a character somewhere else at once [m], on nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_character_set_position(
    character: *mut BsCharacter,
    position: BsDVec3,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { moving(character) }?.character.set_position(position.into())?))
}

/// The settings of a character.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_character_settings(
    character: *const BsCharacter,
    settings: *mut BsCharacterSettings,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let walker = unsafe { looking(character) }?;
        // SAFETY: the caller keeps to the header.
        unsafe { write(settings, BsCharacterSettings::of_engine(walker.character.settings())) }
    })
}

/// Replaces the settings, to crouch or to grow; its middle stays where it is.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_character_set_settings(
    character: *mut BsCharacter,
    settings: *const BsCharacterSettings,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut walker, settings) = unsafe { (moving(character)?, read(settings)?) };
        Ok(walker.character.set_settings(settings.on(CharacterSettings::default())?)?)
    })
}

/// Its capsule without the skin, and how that is turned: for queries, or for a kinematic body of its own.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_character_capsule(
    character: *const BsCharacter,
    capsule: *mut BsGeometry,
    rotation: *mut BsQuat,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (walker, capsule, rotation) = unsafe {
            let capsule = Out::new("the place for the capsule", capsule)?;
            (looking(character)?, capsule, Out::optional("the place for the rotation", rotation)?)
        };
        let (geometry, turned) = walker.character.capsule();
        capsule.set(BsGeometry::of_engine(&geometry));
        if let Some(out) = rotation {
            out.set(turned.into());
        }
        Ok(())
    })
}

/// Gives a character a shape of its own, any convex one, or with null the capsule of its settings again. Its
/// y axis is along `up`, its origin at the character's position, which stays; `radius` and `half_height` of
/// the settings then mean nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_character_set_shape(
    character: *mut BsCharacter,
    shape: *const BsGeometry,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let mut walker = unsafe { moving(character) }?;
        let own = match shape.is_null() {
            true => None,
            // SAFETY: the caller keeps to the header.
            false => Some(unsafe { borrow("the shape", shape)?.to_engine() }?),
        };
        Ok(walker.character.set_shape(own)?)
    })
}

/// The shape of a character without the skin, its own or its capsule, and how that is turned in the world. A
/// hull in it is the character's: retain it to keep it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_character_shape(
    character: *const BsCharacter,
    shape: *mut BsGeometry,
    rotation: *mut BsQuat,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (walker, shape, rotation) = unsafe {
            let shape = Out::new("the place for the shape", shape)?;
            (looking(character)?, shape, Out::optional("the place for the rotation", rotation)?)
        };
        let (geometry, turned) = walker.character.shape();
        shape.set(BsGeometry::of_engine(&geometry));
        if let Some(out) = rotation {
            out.set(turned.into());
        }
        Ok(())
    })
}

/// Turns a character's own shape from upright at once, in axes whose y is `up`; a capsule is not turned.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_character_set_rotation(
    character: *mut BsCharacter,
    rotation: BsQuat,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { moving(character) }?.character.set_rotation(rotation)?))
}

/// The rotation of a character's own shape from upright.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_character_rotation(
    character: *const BsCharacter,
    rotation: *mut BsQuat,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (walker, out) =
            unsafe { (looking(character)?, Out::new("the place for the rotation", rotation)?) };
        out.set(walker.character.rotation().into());
        Ok(())
    })
}

/// What a character stood on after its last walk, `on_ground` 0 if on nothing: all else is then zero.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_character_ground(
    character: *const BsCharacter,
    ground: *mut BsGround,
    on_ground: *mut BsBool,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (walker, ground, on) = unsafe {
            let ground = Out::new("the place for the ground", ground)?;
            (looking(character)?, ground, Out::new("the place for the answer", on_ground)?)
        };
        let found = walker.character.ground();
        ground.set(found.map_or(BsGround::NONE, BsGround::of_engine));
        on.set(found.is_some().into());
        Ok(())
    })
}
