//! The third rule: what bears on a border of a face that another piece continues bears on the face.

use super::piece::{Piece, Places};
use super::rules::{Side, piece_of};
use super::{ground, lying};
use crate::broad_phase::Pair;
use crate::math::Quat;
use crate::memory::Category;
use crate::narrow_phase::contacts::admit::ContactMemory;
use crate::narrow_phase::contacts::contact::{ContactMut, FoundAt};
use crate::narrow_phase::contacts::store::{ContactCount, Contacts};
use crate::narrow_phase::convex::collide_convex;
use crate::narrow_phase::convex::reduce::reduce;
use crate::narrow_phase::input::Input;
use crate::narrow_phase::relative::relative_pose;
use crate::narrow_phase::{MAX_POINTS, RawManifold, RawPoint, Relative};
use crate::shape::{Collider, Geometry, Kind};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A pair with ground, and whether its contact was levelled: then what its face bears is still to be found,
/// and some of its points, one bit each, are covered by other pieces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub(super) struct Found(u32);

const LEVELLED: u32 = 1 << 31;
const COVERED: u32 = 31 - MAX_POINTS as u32;

impl Found {
    /// The most pairs that can be told apart.
    pub(super) const MOST: usize = 1 << COVERED;

    pub(super) fn new(pair: u32) -> Found {
        Found(pair)
    }

    pub(super) fn pair(self) -> u32 {
        self.0 & (Self::MOST as u32 - 1)
    }

    pub(super) fn levelled(self, covered: u32) -> Found {
        Found(self.pair() | covered << COVERED | LEVELLED)
    }

    /// Which points of a contact that was levelled are covered.
    pub(super) fn to_level(self) -> Option<u32> {
        (self.0 & LEVELLED != 0).then_some(self.0 >> COVERED & ((1 << MAX_POINTS) - 1))
    }
}

/// Lets the points of a manifold act along the normal of the face that it is of.
pub(super) fn level(input: &Input<'_>, pair: &Pair, contact: &mut ContactMut<'_>, own: &Side, face: Vec3) {
    let lies = lying(input, pair);
    let [ground, pose] = [ground(input, pair), lies].map(|c| &input.poses[c as usize]);
    let shape = &input.colliders[lies as usize];
    let lever = pose.rotation * shape.rotation.conjugate() * shape.position;
    let spin = input.motion_of(lies).angular * contact.fraction;
    let offset = own.places.furthest(face);
    let frame = contact.frame.conjugate();
    contact.normal = frame * if lies == pair.a { -face } else { face };
    let origin = if lies == pair.a { own.shape_at } else { (ground.position - pose.position).as_vec3() };
    for (point, &at) in contact.points_mut().iter_mut().zip(own.places.each()) {
        // On the shape, where it touches.
        let on_shape = at + own.normal * own.gap(point.found);
        let height = on_shape.dot(face) - offset;
        let closed = -face.dot(own.shape_at + spin.cross(lever + on_shape - own.shape_at));
        point.position = frame * (on_shape - face * (0.5 * height) - origin);
        point.separation = height + closed.max(0.0);
        point.found = point.separation;
    }
}

/// Gives a contact with a convex piece, which was levelled, what its face bears as far as the piece goes, in
/// place of the points that other pieces cover. One that has nothing there is left without points. Returns the
/// number of points that got no place.
pub(super) fn find_again(
    input: &Input<'_>,
    pair: &Pair,
    covered: u32,
    contacts: &mut Contacts,
    memory: &mut ContactMemory<'_>,
) -> u32 {
    let piece = piece_of(input, pair);
    let contact = contacts.at(pair.contact);
    let lies_first = lying(input, pair) == pair.a;
    let face = contact.frame * contact.normal * if lies_first { -1.0 } else { 1.0 };
    let (mut points, mut count) = ([RawPoint::default(); 2 * MAX_POINTS], 0);
    for (_, point) in contact.points().iter().enumerate().filter(|(k, _)| covered >> k & 1 == 0) {
        points[count] = RawPoint { position: point.position, separation: point.separation, key: point.key };
        count += 1;
    }
    let own = count;
    let same = 1e-3 * piece.collider.radius.min(input.summaries[lying(input, pair) as usize].radius);
    let on_face = on_face(input, pair, &piece, face);
    for point in on_face.points() {
        let is_new = |other: &RawPoint| other.position.distance_squared(point.position) > same * same;
        if points[..own].iter().all(is_new) {
            points[count] = *point;
            count += 1;
        }
    }
    let mut raw = RawManifold { normal: contact.normal, material: contact.material.into(), ..on_face };
    let reduced = reduce(&points[..count], raw.normal);
    (raw.points, raw.count) = (reduced.0, reduced.1 as u16);
    if raw.count == 0 {
        contacts.at_mut(pair.contact).empty();
        return 0;
    }
    let wanted = raw.count as usize;
    if wanted > contacts.room(pair.contact) {
        let points = ContactCount { contacts: 0, points: wanted };
        memory.allowances.within(Category::Manifolds, |allowance| contacts.reserve(points, allowance));
    }
    let shed = raw.keep(contacts.grow(pair.contact, wanted));
    contacts.at_mut(pair.contact).renew(&raw, FoundAt::of(pair, input, 0.0), input.match_limits(pair));
    shed
}

/// The contact of a shape with the plane of a face of a convex piece, as far as the piece goes; in the frame of
/// the pair's shape `a`.
fn on_face(input: &Input<'_>, pair: &Pair, piece: &Piece<'_>, face: Vec3) -> RawManifold {
    let lies = lying(input, pair);
    let (shape, rotation) = (&input.colliders[lies as usize], input.poses[lies as usize].rotation);
    let Some(offset) = piece.reach(face, &Places::default(), 0.0) else { return RawManifold::default() };
    let up = rotation.conjugate() * face;
    let plane = Collider { kind: Kind::Plane, geometry: Geometry::Plane, ..piece.collider.clone() };
    let rel = Relative { position: up * offset, rotation: turn_to(up) };
    let mut raw = collide_convex(shape, &plane, &rel, input.margin);
    let mut kept = 0;
    for i in 0..raw.count as usize {
        let point = raw.points[i];
        let at = rotation * (point.position + raw.normal * (0.5 * point.separation));
        if piece.has(at, input.touch_distance) {
            raw.points[kept] = point;
            kept += 1;
        }
    }
    raw.count = kept as u16;
    if lies == pair.a {
        return raw;
    }
    let shape_in_ground = relative_pose(pair, input.poses);
    let back = shape_in_ground.rotation.conjugate();
    raw.flipped(-(back * shape_in_ground.position), back)
}

/// The rotation of the y axis to a unit vector, exact for small angles too.
fn turn_to(up: Vec3) -> Quat {
    if up.y < -0.9 {
        return Quat::from_rotation_arc(Vec3::Y, up);
    }
    let axis = Vec3::Y.cross(up);
    Quat::from_xyzw(axis.x, axis.y, axis.z, 1.0 + up.y).normalize()
}
