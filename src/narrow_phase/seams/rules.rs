//! The rules by which a manifold is none of the surface as a whole.

use super::level::{Found, level};
use super::piece::{Piece, Places};
use super::{ground, lying};
use crate::broad_phase::Pair;
use crate::config::tuning::FLAT_EDGE_COSINE;
use crate::narrow_phase::contacts::contact::{ContactRef, NO_CONTACT};
use crate::narrow_phase::contacts::store::SharedContacts;
use crate::narrow_phase::convex::polytope::Pose;
use crate::narrow_phase::input::Input;
use crate::narrow_phase::{MAX_POINTS, Relative};
use crate::shape::Kind;
use glam::Vec3;

/// The most manifolds and pieces of a shape that are judged together. Any beyond are judged by the first rule
/// alone.
const MOST: usize = 32;

/// A manifold of a shape with a piece.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Side {
    pub(super) slot: u32,
    /// Index of its piece.
    pub(super) piece: usize,
    /// Unit, out of the piece.
    pub(super) normal: Vec3,
    pub(super) places: Places,
    /// The normal of the face of the piece that it comes from, if any.
    pub(super) face: Option<Vec3>,
    pub(super) is_edge: bool,
    /// Least separation of its points [m].
    nearest: f32,
    /// Where the shape is when it touches the piece [m].
    pub(super) shape_at: Vec3,
    /// How exact its places are: carried along a path they are less so [m].
    within: f32,
    dropped: bool,
}

impl Side {
    /// `None` if the contact has no points.
    pub(super) fn of(
        input: &Input<'_>,
        pair: &Pair,
        contact: ContactRef<'_>,
        piece: &Piece<'_>,
    ) -> Option<Side> {
        if contact.points().is_empty() {
            return None;
        }
        let lies_first = lying(input, pair) == pair.a;
        let [a, b] = [pair.a, pair.b].map(|c| input.motion_of(c).linear);
        let moved = (a - b) * contact.fraction;
        let mut side = Side {
            normal: normal_of(contact, piece, lies_first),
            nearest: contact.points().iter().map(|p| p.separation).fold(f32::INFINITY, f32::min),
            shape_at: if lies_first { moved } else { -moved },
            within: input.touch_distance * if contact.fraction > 0.0 { 2.0 } else { 1.0 },
            ..Side::default()
        };
        let Relative { position, rotation } = contact.found_at;
        for point in contact.points() {
            // From midway between the surfaces where it was found.
            let to_piece = side.normal * (-0.5 * side.gap(point.found));
            let middle = if lies_first {
                piece.pose.point(rotation.conjugate() * (point.position - position)) + moved
            } else {
                piece.pose.point(point.position)
            };
            side.places.push(middle + to_piece);
        }
        side.face = piece.face(side.normal, &side.places, side.within);
        side.is_edge = piece.is_edge(side.normal, side.face);
        Some(side)
    }

    /// The rest of a separation at the start of the step when the shape touches the piece [m].
    pub(super) fn gap(&self, found: f32) -> f32 {
        found - (-self.normal.dot(self.shape_at)).max(0.0)
    }
}

/// A shape that lies on ground, and the pieces of the ground.
struct Place<'a> {
    shape: Piece<'a>,
    pieces: [Option<Piece<'a>>; MOST],
    touch: f32,
}

/// Judges the manifolds of the pairs of one shape; those that are dropped are left without points.
///
/// # Safety
/// No other thread may access the contacts of these pairs.
pub(super) unsafe fn judge(
    input: &Input<'_>,
    pairs: &[Pair],
    own: &mut [Found],
    contacts: &SharedContacts<'_>,
) {
    let pair = |found: &Found| &pairs[found.pair() as usize];
    if own.iter().all(|found| pair(found).contact == NO_CONTACT) {
        return;
    }
    let lies = lying(input, pair(&own[0])) as usize;
    let pose = Pose::new(Vec3::ZERO, input.poses[lies].rotation);
    let shape = Piece { collider: &input.colliders[lies], pose };
    let mut place = Place { shape, pieces: [None; MOST], touch: input.touch_distance };
    let (mut sides, mut count, mut beyond) = ([Side::default(); MOST], 0, own.len());
    for (i, found) in own.iter().enumerate().take(MOST) {
        let (pair, piece) = (pair(found), piece_of(input, pair(found)));
        place.pieces[i] = Some(piece);
        let mut slot = pair.contact;
        while slot != NO_CONTACT {
            // SAFETY: by the contract.
            let contact = unsafe { contacts.at(slot) };
            let side = Side::of(input, pair, contact.as_ref(), &piece);
            match (side, sides.get_mut(count)) {
                (Some(side), Some(at)) => (*at, count) = (Side { slot, piece: i, ..side }, count + 1),
                (Some(_), None) => beyond = beyond.min(i),
                (None, _) => {}
            }
            slot = contact.next;
        }
    }
    let sides = &mut sides[..count];
    for (i, found) in own.iter().enumerate().skip(beyond.min(MOST)) {
        let (pair, piece) = (pair(found), piece_of(input, pair(found)));
        let mut slot = pair.contact;
        while slot != NO_CONTACT {
            // SAFETY: by the contract.
            let mut contact = unsafe { contacts.at(slot) };
            let side = Side::of(input, pair, contact.as_ref(), &piece);
            if side.is_some_and(|side| place.is_hidden(&Side { piece: i, ..side }, &piece, sides)) {
                contact.empty();
            }
            slot = contact.next;
        }
    }
    // Shapes that rest on level faces.
    let Some(first) = sides.first().map(|side| side.normal) else { return };
    if sides.iter().all(|side| !side.is_edge && side.normal.dot(first) > FLAT_EDGE_COSINE) {
        return;
    }
    // The nearest first; they are judged from the last, so a nearer one stays for those behind it.
    sides.sort_unstable_by(|x, y| x.nearest.total_cmp(&y.nearest).then(x.piece.cmp(&y.piece)));
    for i in (0..count).rev() {
        // SAFETY: by the contract.
        let mut contact = unsafe { contacts.at(sides[i].slot) };
        let (side, found) = (sides[i], &mut own[sides[i].piece]);
        let Some(piece) = place.pieces[side.piece] else { continue };
        if place.is_hidden(&side, &piece, sides) {
            sides[i].dropped = true;
            contact.empty();
        } else if side.is_edge {
            let covered = place.covered(&side);
            let all = covered.count_ones() as usize == side.places.each().len();
            let face = side.face.filter(|_| covered != 0);
            let is_convex = piece.collider.kind.is_convex();
            if let Some(face) = face.filter(|_| is_convex && contact.fraction == 0.0) {
                level(input, pair(found), &piece, &mut contact, &side, face);
                *found = found.levelled(covered);
            } else if all && holds_besides(&side, i, sides, place.touch) {
                sides[i].dropped = true;
                contact.empty();
            } else if let Some(face) = face {
                level(input, pair(found), &piece, &mut contact, &side, face);
            }
        }
    }
}

/// The normal that a contact had when it was found, out of the ground, in the world. The bodies of one that
/// is kept have turned since.
pub(super) fn normal_of(contact: ContactRef<'_>, ground: &Piece<'_>, lies_first: bool) -> Vec3 {
    let back = contact.found_at.rotation.conjugate();
    ground.pose.direction(if lies_first { back * -contact.normal } else { contact.normal })
}

/// The ground of a pair, seen from the shape that lies on it.
pub(super) fn piece_of<'a>(input: &Input<'a>, pair: &Pair) -> Piece<'a> {
    let (lies, ground) = (lying(input, pair), ground(input, pair));
    let (pose, from) = (&input.poses[ground as usize], &input.poses[lies as usize]);
    let position = (pose.position - from.position).as_vec3();
    Piece { collider: &input.colliders[ground as usize], pose: Pose::new(position, pose.rotation) }
}

impl Place<'_> {
    /// The first rule.
    fn is_hidden(&self, own: &Side, piece: &Piece<'_>, sides: &[Side]) -> bool {
        let behind = |other: &Side, face: Vec3| {
            // A place that was carried along a path may not be found again: then all counts that is near the
            // shape.
            let high = piece.reach(face, &own.places, own.within);
            let high =
                high.or_else(|| piece.reach(face, &Places::one(own.shape_at), self.shape.collider.radius));
            // Lifted out of the face the shape reaches no lower than this, nor while the face holds it.
            let low = self.shape.reach(-face, &own.places, 0.0).map(|low| -low - other.nearest.min(0.0));
            let plane = other.places.furthest(face);
            high.zip(low).is_some_and(|(high, low)| high <= low.min(plane) + self.touch)
        };
        sides.iter().filter(|other| !other.dropped && other.piece != own.piece).any(|other| {
            let leans = |face: &Vec3| own.normal.dot(*face) < FLAT_EDGE_COSINE;
            other.face.filter(leans).is_some_and(|face| behind(other, face))
        })
    }

    /// The second rule: which places of a manifold lie on another piece that goes on beyond its plane, or on
    /// another part of its own mesh that does; one bit each.
    fn covered(&self, own: &Side) -> u32 {
        let others = self.pieces.iter().flatten().enumerate();
        let others = others.filter(|(k, piece)| *k != own.piece || !piece.collider.kind.is_convex());
        let covers = |at: Vec3| {
            // Points of a ball that were merged each have a normal of their own.
            let is_ball = self.shape.collider.kind == Kind::Sphere;
            let normal = if is_ball { (own.shape_at - at).normalize_or(own.normal) } else { own.normal };
            others.clone().any(|(_, piece)| piece.goes_on(at, normal, own.within))
        };
        own.places.each().iter().zip(0..MAX_POINTS).map(|(&at, k)| u32::from(covers(at)) << k).sum()
    }
}

/// Whether another manifold holds the shape as near as that at `i`, or at all: of two edges of a crack one
/// has to stay.
fn holds_besides(own: &Side, i: usize, sides: &[Side], touch: f32) -> bool {
    let near = own.nearest.max(touch);
    sides.iter().enumerate().any(|(k, other)| k != i && !other.dropped && other.nearest <= near)
}
