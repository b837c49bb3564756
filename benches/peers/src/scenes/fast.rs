//! Fast bodies; all of these are run with continuous collision.

use super::{Error, Subject, WALL, below};
use crate::engines::Continuous;
use backstop::Geometry;
use backstop::glam::Vec3;
use backstop_scene::builtin::{self, dynamic, fixed, pebble, talk_terrain};
use backstop_scene::{Rng, Scene};
use std::sync::Arc;

/// A thousand balls, capsules, rods and blades at 50 to 500 m/s onto a mesh without thickness.
pub(super) fn bullets() -> Subject {
    let beyond = Arc::new(|p: Vec3| if p.x.abs().max(p.z.abs()) < 199.0 { -p.y } else { f32::NEG_INFINITY });
    let subject = Subject::new(builtin::bullets(false), Error::Lost);
    Subject { steps: 120, continuous: Continuous::On, rests: false, beyond, ..subject }
}

/// Half the inside of the room [m].
const ROOM: f32 = 20.0;

/// Five thousand bodies that fly about at 250 m/s in a closed room and bounce by 0.9.
pub(super) fn room() -> Subject {
    let mut scene = Scene::new("fast_room");
    let outer = ROOM + 2.0 * WALL;
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let (mut half, mut at) = (Vec3::splat(outer), Vec3::ZERO);
            (half[axis], at[axis]) = (WALL, side * (ROOM + WALL));
            scene.add("wall", fixed(Geometry::Box { half_extents: half }, at));
        }
    }
    let mut rng = Rng::new(37);
    let hulls: Vec<Geometry> = (0..4).map(|_| pebble(12, Vec3::splat(0.2), &mut rng)).collect();
    for i in 0..5000usize {
        let shape = match i % 4 {
            0 => Geometry::sphere(0.18),
            1 => Geometry::capsule(0.12, 0.12),
            2 => Geometry::cuboid(0.16, 0.12, 0.18),
            _ => hulls[i / 4 % 4].clone(),
        };
        let (x, y, z) = (i % 18, i / 18 % 18, i / 324);
        let at = Vec3::new(x as f32 - 8.5, y as f32 - 8.5, z as f32 - 8.0) * 2.0;
        let velocity = rng.direction() * 250.0;
        let spin = rng.direction() * rng.range(0.0, 20.0);
        scene.add("body", dynamic(shape, at).with_rotation(rng.rotation()).with_velocity(velocity, spin));
    }
    for shape in scene.bodies.iter_mut().flat_map(|body| &mut body.desc.shapes) {
        shape.material.restitution = 0.9;
    }
    let beyond = Arc::new(|p: Vec3| p.abs().max_element() - ROOM);
    let subject = Subject::new(scene, Error::Lost);
    Subject { steps: 120, continuous: Continuous::On, rests: false, beyond, ..subject }
}

/// Eleven fast, spinning bodies of every shape onto a terrain.
pub(super) fn talk() -> Subject {
    let subject = Subject::new(builtin::talk(), Error::Lost);
    Subject { continuous: Continuous::On, beyond: below(talk_terrain()), ..subject }
}
