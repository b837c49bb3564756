//! Boxes around shapes, and the paths of swept ones.

use super::{DebugDraw, DrawOptions, Element, Ink};
use crate::broad_phase::{Aabb, aabb_of};
use crate::shape::outline::cuboid;
use crate::world::World;
use glam::{DVec3, Vec3};

pub(super) fn draw(world: &World, options: &DrawOptions, out: &mut dyn DebugDraw) {
    let palette = &options.palette;
    let tight = Ink { element: Element::Aabb, colour: palette.aabb };
    let fat = Ink { element: Element::FatAabb, colour: palette.fat_aabb };
    for (pose, colliders) in world.bodies.pose.iter().zip(&world.bodies.colliders) {
        for &c in colliders.as_slice() {
            if options.aabbs {
                let collider = &world.colliders.all[c as usize];
                draw_box(aabb_of(collider, pose.position, pose.rotation), tight, options, out);
            }
            if options.fat_aabbs
                && let Some(bounds) = world.broad.kept_bounds(c)
            {
                draw_box(bounds, fat, options, out);
            }
        }
    }
    if options.motion {
        draw_ways(world, options, out);
    }
}

/// A box, unless it is infinite, as that of a plane.
fn draw_box(bounds: Aabb, ink: Ink, options: &DrawOptions, out: &mut dyn DebugDraw) {
    let Aabb { min, max } = bounds;
    let wanted = options.region.is_none_or(|region| region.meets(min.as_dvec3(), max.as_dvec3()));
    if wanted && min.is_finite() && max.is_finite() {
        cuboid(min, max, &mut |from: Vec3, to: Vec3| out.line(from.as_dvec3(), to.as_dvec3(), ink));
    }
}

fn draw_ways(world: &World, options: &DrawOptions, out: &mut dyn DebugDraw) {
    let ink = Ink { element: Element::Motion, colour: options.palette.motion };
    for (c, motion) in world.broad.swept() {
        // The pose at the start of the step.
        let from: DVec3 = world.colliders.poses[c as usize].position;
        let to = from + motion.as_dvec3();
        if options.region.is_none_or(|region| region.meets(from.min(to), from.max(to))) {
            out.line(from, to, ink);
        }
    }
}
