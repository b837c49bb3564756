//! Points of contact: real, potential, ghost; with normals, gaps and impulses.

use super::{Colour, DebugDraw, DrawOptions, Element, Ink};
use crate::config::tuning::GHOST_GAP;
use crate::narrow_phase::{ContactRef, Point, Relative, Support, distance};
use crate::world::{Place, World, place_of, relative_now};
use glam::{DVec3, Vec3};

pub(super) fn draw(world: &World, options: &DrawOptions, out: &mut dyn DebugDraw) {
    for pair in &world.broad.pairs {
        for (_, contact) in world.contacts.chain(pair.contact) {
            draw_contact(world, contact, options, out);
        }
    }
}

fn draw_contact(world: &World, contact: ContactRef<'_>, options: &DrawOptions, out: &mut dyn DebugDraw) {
    let now = relative_now(world, contact);
    let measures = world.settings.measures();
    let palette = &options.palette;
    let ghost = contact.pushed && are_apart(world, contact, &now, GHOST_GAP * measures.margin);
    let real = |point: &Point| point.separation <= measures.touch;
    for (point, gap) in contact.points().iter().zip(contact.separations(&now)) {
        let Place { on_a, normal, gap } = place_of(world, contact, point, gap, &now);
        let along = |length: f32| (normal * length).as_dvec3();
        let (middle, on_b) = (on_a + along(0.5 * gap), on_a + along(gap));
        if options.region.is_some_and(|region| !region.holds(middle)) {
            continue;
        }
        let mut line = |from: DVec3, to: DVec3, element: Element, colour: Colour| {
            out.line(from, to, Ink { element, colour });
        };
        if options.normals {
            line(on_b, on_b + along(options.length), Element::Normal, palette.normal);
            line(on_a, on_b, Element::Gap, palette.gap);
        }
        if options.impulses && point.impulse != 0.0 {
            let end = on_b + along(point.impulse * options.impulse_scale);
            line(on_b, end, Element::Impulse, palette.impulse);
        }
        if options.contacts {
            let (element, colour) = match (real(point), ghost) {
                (true, _) => (Element::RealPoint, palette.real_point),
                (false, true) => (Element::GhostPoint, palette.ghost_point),
                (false, false) => (Element::PotentialPoint, palette.potential_point),
            };
            out.point(middle, Ink { element, colour });
        }
    }
}

/// Whether two shapes are further apart than a limit [m].
fn are_apart(world: &World, contact: ContactRef<'_>, now: &Relative, limit: f32) -> bool {
    let [a, b] = [contact.a, contact.b].map(|c| &world.colliders.all[c as usize]);
    // A plane, mesh or height field is the second of a pair.
    let Some(convex) = a.geometry.support() else { return false };
    let hint = now.position;
    if let Some(other) = b.geometry.support() {
        return distance(&convex, &other, now, hint).distance > limit;
    }
    let back = now.rotation.conjugate();
    if let Some(ground) = b.geometry.ground() {
        // Around all that is within the limit of the shape.
        let (at, reach) = (back * -now.position, Vec3::splat(a.radius + limit));
        return !ground.any_in_box(at - reach, at + reach, &mut |_, corners| {
            distance(&convex, &Support::triangle(corners), now, Vec3::ZERO).distance <= limit
        });
    }
    // The half-space below: the height of the lowest point above it.
    let up = now.rotation * Vec3::Y;
    let lowest = convex.support(-up.as_dvec3()).as_vec3();
    up.dot(lowest - now.position) - convex.radius as f32 > limit
}
