//! Promises of a character: it walks as far as geometry says, over steps and slopes up to its limits, goes
//! along with moving ground, and is never in anything.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

mod anywhere;
mod carried;
mod crowd;
mod forms;
mod resident;
mod slopes;
mod stairs;
mod walls;

use crate::common::random::Random;
use crate::common::{self, Floor};
use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Character, CharacterReport, CharacterSettings, Error, Geometry, HeightField,
    Material, QueryFilter, Settings, ShapeCast, ShapeDesc, ShapeHandle, TriangleMesh, World,
};
use backstop_scene::Terrain;
use std::sync::Arc;

const DT: f32 = 1.0 / 60.0;
const G: f32 = 9.81;
/// Gap that a cast leaves, for each of a few casts [m].
const GAP: f64 = 3e-5;

fn world() -> World {
    World::new(Settings::default()).unwrap()
}

fn fixed(world: &mut World, at: DVec3, turn: Quat, geometry: Geometry) -> BodyHandle {
    let body = BodyDesc::fixed().with_position(at).with_rotation(turn);
    world.add_body(&body.with_shape(ShapeDesc::new(geometry))).unwrap()
}

fn cuboid(world: &mut World, at: [f64; 3], half: [f32; 3]) -> BodyHandle {
    fixed(world, at.into(), Quat::IDENTITY, Geometry::cuboid(half[0], half[1], half[2]))
}

fn floor(world: &mut World) -> BodyHandle {
    world.add_body(&Floor::Plane.desc(Material::default())).unwrap()
}

/// A character with its feet at a point.
fn character_at(feet: DVec3, settings: CharacterSettings) -> Character {
    let height = settings.half_height + settings.radius + settings.skin;
    Character::new(settings, feet + settings.up.as_dvec3() * f64::from(height)).unwrap()
}

/// One that stands already.
fn standing(world: &World, feet: DVec3, settings: CharacterSettings) -> Character {
    let mut character = character_at(feet, settings);
    character.walk(world, &QueryFilter::new(), -settings.up * 0.1, 1e-3).unwrap();
    assert!(character.ground().is_some());
    character
}

fn walk(character: &mut Character, world: &World, velocity: Vec3) -> CharacterReport {
    character.walk(world, &QueryFilter::new(), velocity, DT).unwrap()
}

/// The velocity of a game: the wish across, gravity and the rest of a fall.
fn go(character: &mut Character, world: &World, wish: Vec3, last: &mut Vec3) -> CharacterReport {
    let report = walk(character, world, Vec3::new(wish.x, last.y - G * DT, wish.z));
    *last = report.velocity;
    report
}

/// Whether the capsule without its skin overlaps anything.
fn is_inside(character: &Character, world: &World) -> bool {
    let (capsule, rotation) = character.capsule();
    world.overlap_any(&capsule, character.position(), rotation, &QueryFilter::new()).unwrap()
}

#[track_caller]
fn near(a: f64, b: f64, within: f64) {
    assert!((a - b).abs() <= within, "{a} is not {b}");
}

fn mesh(corners: &[Vec3], triangles: &[[u32; 3]]) -> Geometry {
    Geometry::Mesh(Arc::new(TriangleMesh::new(corners.to_vec(), triangles.to_vec()).unwrap()))
}
