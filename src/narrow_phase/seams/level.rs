//! The third rule: a contact on a border of a face that another piece continues is a contact on the face.

use super::lying;
use super::piece::{Piece, Places};
use super::rules::{Side, normal_of, piece_of};
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

/// A pair with ground, and whether its contact was levelled: then the points of its face are still to be
/// found, and some of its points, one bit each, are covered by other pieces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub(super) struct Found(u32);

const LEVELLED: u32 = 1 << 31;
const GONE: u32 = 31 - MAX_POINTS as u32;

impl Found {
    /// The most pairs that can be told apart.
    pub(super) const MOST: usize = 1 << GONE;

    pub(super) fn new(pair: u32) -> Found {
        Found(pair)
    }

    pub(super) fn pair(self) -> u32 {
        self.0 & (Self::MOST as u32 - 1)
    }

    pub(super) fn levelled(self, gone: u32) -> Found {
        Found(self.pair() | gone << GONE | LEVELLED)
    }

    /// Which points of a contact that was levelled go.
    pub(super) fn to_level(self) -> Option<u32> {
        (self.0 & LEVELLED != 0).then_some(self.0 >> GONE & ((1 << MAX_POINTS) - 1))
    }
}

/// Lets the points of a manifold act along the normal of the face that it is of, as if it had been found so.
pub(super) fn level(
    input: &Input<'_>,
    pair: &Pair,
    piece: &Piece<'_>,
    contact: &mut ContactMut<'_>,
    own: &Side,
    face: Vec3,
) {
    let lies = lying(input, pair);
    let shape = &input.colliders[lies as usize];
    let lever = input.poses[lies as usize].rotation * shape.rotation.conjugate() * shape.position;
    let spin = input.motion_of(lies).angular * contact.fraction;
    let offset = own.places.furthest(face);
    let lies_first = lies == pair.a;
    let Relative { position, rotation } = contact.found_at;
    let in_frame = |d: Vec3| if lies_first { rotation * piece.pose.back(d) } else { piece.pose.back(d) };
    contact.normal = in_frame(if lies_first { -face } else { face });
    let (origin, at_origin) = if lies_first { (own.shape_at, position) } else { (Vec3::ZERO, Vec3::ZERO) };
    for (point, &at) in contact.points_mut().iter_mut().zip(own.places.each()) {
        // On the shape, where it touches.
        let on_shape = at + own.normal * own.gap(point.found);
        let height = on_shape.dot(face) - offset;
        let closed = -face.dot(own.shape_at + spin.cross(lever + on_shape - own.shape_at));
        point.position =
            in_frame(on_shape - face * (0.5 * height) - origin - piece.pose.position) + at_origin;
        let found = height + closed.max(0.0);
        point.separation += found - point.found;
        point.found = found;
    }
}

/// Gives a contact with a convex piece, which was levelled, the points of its face as far as the piece goes,
/// beside its own points but those that go. One that has none then is left without. Returns the number of
/// points that got no place.
pub(super) fn find_again(
    input: &Input<'_>,
    pair: &Pair,
    gone: u32,
    contacts: &mut Contacts,
    memory: &mut ContactMemory<'_>,
) -> u32 {
    let piece = piece_of(input, pair);
    let contact = contacts.at(pair.contact);
    let lies_first = lying(input, pair) == pair.a;
    let face = normal_of(contact, &piece, lies_first);
    let (mut points, mut count) = ([RawPoint::default(); 2 * MAX_POINTS], 0);
    for (_, point) in contact.points().iter().enumerate().filter(|(k, _)| gone >> k & 1 == 0) {
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
    let normal = input.poses[pair.a as usize].rotation.conjugate() * if lies_first { -face } else { face };
    let mut raw = RawManifold { normal, material: contact.material.into(), ..on_face };
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

/// The contact of a shape with the plane of a face of a convex piece, as far as the piece goes; in the frame
/// of the pair's shape `a`.
fn on_face(input: &Input<'_>, pair: &Pair, piece: &Piece<'_>, face: Vec3) -> RawManifold {
    let lies = lying(input, pair);
    let (shape, rotation) = (&input.colliders[lies as usize], input.poses[lies as usize].rotation);
    let Some(offset) = piece.reach(face, &Places::default(), 0.0) else { return RawManifold::default() };
    let up = rotation.conjugate() * face;
    let plane = Collider { kind: Kind::Plane, geometry: Geometry::Plane, ..piece.collider.clone() };
    let rel = Relative { position: up * offset, rotation: turn_to(up) };
    let mut raw = collide_convex(shape, &plane, &rel, input.margin);
    let normal = raw.normal;
    raw.retain(|point| {
        let at = rotation * (point.position + normal * (0.5 * point.separation));
        piece.has(at, input.touch_distance)
    });
    if lies == pair.a { raw } else { raw.flipped(&relative_pose(pair, input.poses).inverse()) }
}

/// The rotation of the y axis to a unit vector, exact for small angles too.
fn turn_to(up: Vec3) -> Quat {
    if up.y < -0.9 {
        return Quat::from_rotation_arc(Vec3::Y, up);
    }
    let axis = Vec3::Y.cross(up);
    Quat::from_xyzw(axis.x, axis.y, axis.z, 1.0 + up.y).normalize()
}
