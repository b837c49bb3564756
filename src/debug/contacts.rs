//! Points of contact: real, potential, ghost; with normals, gaps and impulses.

use super::{Colour, DebugDraw, DrawOptions, Element, Ink};
use crate::body::{Pose, exp_map};
use crate::config::tuning::{CONTACT_MARGIN, GHOST_GAP, TOUCH_DISTANCE};
use crate::math::Quat;
use crate::narrow_phase::{ContactRef, NO_CONTACT, Point, Relative, Support, distance};
use crate::shape::{Collider, Geometry, Kind};
use crate::world::World;
use glam::{DVec3, Vec3};

pub(super) fn draw(world: &World, options: &DrawOptions, out: &mut dyn DebugDraw) {
    for pair in &world.broad.pairs {
        let mut slot = pair.contact;
        while slot != NO_CONTACT {
            let contact = world.contacts.at(slot);
            draw_contact(world, contact, options, out);
            slot = contact.next;
        }
    }
}

fn draw_contact(world: &World, contact: ContactRef<'_>, options: &DrawOptions, out: &mut dyn DebugDraw) {
    let now = relative(world, contact);
    let unit = world.settings.length_unit;
    let palette = &options.palette;
    let ghost = contact.pushed && are_apart(world, contact, &now, GHOST_GAP * CONTACT_MARGIN * unit);
    let real = |point: &Point| point.separation <= TOUCH_DISTANCE * unit;
    for (point, gap) in contact.points().iter().zip(contact.separations(&now)) {
        let Place { on_a, normal, gap } = if contact.fraction > 0.0 {
            ahead(world, contact, point)
        } else {
            at_start(world, contact, point, gap, &now)
        };
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

/// Pose of the second shape in the frame of the first, now.
fn relative(world: &World, contact: ContactRef<'_>) -> Relative {
    let [a, b] = [contact.a, contact.b].map(|c| world.collider_pose(c));
    let back = a.rotation.conjugate();
    Relative { position: back * (b.position - a.position).as_vec3(), rotation: back * b.rotation }
}

/// A point of contact where the bodies are now.
struct Place {
    /// On the surface of the first shape [m].
    on_a: DVec3,
    /// Unit, from the first shape to the second.
    normal: Vec3,
    /// From there to the surface of the second, negative in overlap [m].
    gap: f32,
}

/// A point that was found at the poses of the start of a step.
fn at_start(world: &World, contact: ContactRef<'_>, point: &Point, gap: f32, now: &Relative) -> Place {
    let a = world.collider_pose(contact.a);
    if is_round(world, contact) {
        // The point does not rotate with a rolling shape.
        let start = world.colliders.poses[contact.a as usize].rotation;
        let normal = start * contact.normal;
        let on_a = start * point.position - normal * (0.5 * point.found);
        return Place { on_a: a.position + on_a.as_dvec3(), normal, gap };
    }
    // The point moves with both bodies. Midway between its two positions is midway between the surfaces.
    let turn = now.rotation * contact.found_at.rotation.conjugate();
    let on_b = now.position + turn * (point.position - contact.found_at.position);
    let on_a = (point.position + on_b) * 0.5 - contact.normal * (0.5 * gap);
    Place { on_a: a.position + (a.rotation * on_a).as_dvec3(), normal: a.rotation * contact.normal, gap }
}

/// Whether the first shape touches with a round side.
fn is_round(world: &World, contact: ContactRef<'_>) -> bool {
    match world.colliders.all[contact.a as usize].kind {
        Kind::Sphere | Kind::Capsule => true,
        Kind::Cylinder => contact.count < 3,
        _ => false,
    }
}

/// A point that was found at a first touch within the step. Its separation was extrapolated back from there
/// along the predicted motion, to first order; here it is carried forward along the actual motion.
fn ahead(world: &World, contact: ContactRef<'_>, point: &Point) -> Place {
    let [a, b] = [contact.a, contact.b].map(|c| Way::of(world, c));
    let normal = a.shape * contact.normal;
    let arm_a = a.lever + a.shape * point.position;
    let between = (a.start.position - b.start.position).as_vec3();
    let arm_b = arm_a + between + (a.predicted.0 - b.predicted.0) * contact.fraction;
    let closing = |(way_a, turn_a): (Vec3, Vec3), (way_b, turn_b): (Vec3, Vec3)| {
        normal.dot(way_a - way_b + turn_a.cross(arm_a) - turn_b.cross(arm_b))
    };
    // Other points than those that touched first were still apart there.
    let apart = point.found - (contact.fraction * closing(a.predicted, b.predicted)).max(0.0);
    let gap = point.found - closing(a.gone, b.gone);
    let on_a = arm_a - normal * (0.5 * apart);
    let rest = if is_round(world, contact) { 0.0 } else { 1.0 - contact.fraction };
    Place { on_a: a.end + (exp_map(a.gone.1 * rest) * on_a).as_dvec3(), normal, gap }
}

/// The motion of a collider's body in the last step: displacements [m] and rotation vectors [rad].
struct Way {
    start: Pose,
    /// Rotation of the shape at the start.
    shape: Quat,
    /// From the body's centre of mass to the shape's origin at the start [m].
    lever: Vec3,
    end: DVec3,
    predicted: (Vec3, Vec3),
    gone: (Vec3, Vec3),
}

impl Way {
    fn of(world: &World, c: u32) -> Way {
        let collider = &world.colliders.all[c as usize];
        let (placed, end) = (&world.colliders.poses[c as usize], &world.bodies.pose[collider.body as usize]);
        let rotation = placed.rotation * collider.rotation.conjugate();
        let lever = rotation * collider.position;
        let start = Pose { position: placed.position - lever.as_dvec3(), rotation };
        let motion = world.buffers.forces.motion.get(collider.body as usize);
        Way {
            shape: placed.rotation,
            lever,
            end: end.position,
            predicted: motion.map_or((Vec3::ZERO, Vec3::ZERO), |m| (m.linear, m.angular)),
            gone: ((end.position - start.position).as_vec3(), turn_between(rotation, end.rotation)),
            start,
        }
    }
}

/// The rotation vector that leads from one rotation to another, of at most half a turn [rad].
fn turn_between(from: Quat, to: Quat) -> Vec3 {
    let q = to * from.conjugate();
    let q = if q.w < 0.0 { -q } else { q };
    let sine = q.xyz().length();
    // For a small angle, twice the sine of its half.
    q.xyz() * if sine < 1e-4 { 2.0 } else { 2.0 * libm::atan2f(sine, q.w) / sine }
}

/// Whether two shapes are further apart than a limit [m].
fn are_apart(world: &World, contact: ContactRef<'_>, now: &Relative, limit: f32) -> bool {
    let [a, b] = [contact.a, contact.b].map(|c| &world.colliders.all[c as usize]);
    // A plane, mesh or height field is the second of a pair.
    let Some(convex) = Support::of(a) else { return false };
    let hint = now.position;
    if let Some(other) = Support::of(b) {
        return distance(&convex, &other, now, hint).distance > limit;
    }
    let back = now.rotation.conjugate();
    let from_b = Relative { position: back * -now.position, rotation: back };
    match &b.geometry {
        Geometry::Mesh(mesh) => {
            let (min, max) = reach(a, &from_b, limit);
            let mut near = false;
            mesh.visit_box(min, max, &mut |_, t| near |= touches(&convex, t, now, limit));
            !near
        }
        Geometry::HeightField(field) => {
            let (min, max) = reach(a, &from_b, limit);
            let mut near = false;
            field.visit_box(min, max, &mut |_, t| near |= touches(&convex, t, now, limit));
            !near
        }
        _ => {
            // The half-space below: the height of the lowest point above it.
            let up = now.rotation * Vec3::Y;
            let lowest = convex.support(-up.as_dvec3()).as_vec3();
            up.dot(lowest - now.position) - convex.radius as f32 > limit
        }
    }
}

fn touches(convex: &Support<'_>, corners: [Vec3; 3], now: &Relative, limit: f32) -> bool {
    let triangle = Support::triangle(corners);
    distance(convex, &triangle, now, Vec3::ZERO).distance <= limit
}

/// A box, in the other's frame, around all that is within a limit of a shape.
fn reach(a: &Collider, in_other: &Relative, limit: f32) -> (Vec3, Vec3) {
    let reach = Vec3::splat(a.radius + limit);
    (in_other.position - reach, in_other.position + reach)
}
