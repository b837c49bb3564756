//! One surface of many pieces: what a shape touches of ground that is built of several colliders.
//!
//! Kernels see a pair at a time, so each seam between two pieces of a floor is an edge to them, and the side
//! of the next tile is a wall that a body in the least overlap strikes. Here the manifolds that a shape has
//! with all pieces of what cannot be pushed are judged together, real and potential ones alike, and those
//! that the surface as a whole does not have are dropped:
//!
//! 1. The piece lies wholly behind the plane of a face of another piece that holds the shape, and would push
//!    along another direction: the side of the next tile of a floor. A manifold that leans by little may bear
//!    what spans a gap, so it stays, unless it comes from an edge that a further piece covers.
//! 2. The normal leans from an edge over another piece, which has the same points and is nearer: the edge of
//!    a mesh that goes on in the next one, level or rising.
//!
//! A third rule mends what is left: points of a face that another piece continues act along the normal of the
//! face, not along that of a shape which leans on its border.
//!
//! Gaps and steps up to the distance that counts as touching are none. A shape that has only one piece near
//! it costs nothing but the count of its pieces.

mod piece;

use super::contacts::admit::ContactMemory;
use super::contacts::contact::{ContactMut, ContactRef, FoundAt, NO_CONTACT};
use super::contacts::store::{ContactCount, Contacts, SharedContacts};
use super::convex::collide_convex;
use super::convex::polytope::Pose;
use super::input::Input;
use super::pair_state::PackedState;
use super::relative::relative_pose;
use super::{MAX_POINTS, Relative};
use crate::broad_phase::Pair;
use crate::config::tuning::FLAT_EDGE_COSINE;
use crate::math::Quat;
use crate::memory::{Allowance, Category, buffers};
use crate::shape::{Collider, Geometry, Kind};
use crate::threads::{Shared, Workers, per_block};
use glam::Vec3;
use piece::{Piece, Places};

/// A pair whose contact is to be found again on the plane of a face.
const TO_LEVEL: u32 = 1 << 31;
/// Shapes a block.
const BLOCK: usize = per_block(32, 1);
/// The most manifolds and pieces of a shape that are judged together. A shape that has more meets the others
/// as they are.
const MOST: usize = 32;

/// Buffers of one step.
#[derive(Debug, Default)]
pub(crate) struct Seams {
    /// Of each collider the end of its part of `pairs`.
    ends: Vec<u32>,
    /// Pairs with ground, in the order of what lies on it.
    pairs: Vec<u32>,
    /// Ranges of these that belong to a shape with several pieces.
    groups: Vec<[u32; 2]>,
}

buffers! { Seams { bytes { ends, pairs, groups } } }

impl Seams {
    #[cfg(debug_assertions)]
    pub(crate) fn spoil(&mut self) {
        use crate::memory::spoil;
        let Seams { ends, pairs, groups } = self;
        spoil(ends);
        spoil(pairs);
        spoil(groups);
    }

    /// Drops the manifolds of the step that a surface of several pieces does not have. Without memory for it
    /// all stay. Returns the number of points that got no place.
    pub(crate) fn judge(
        &mut self,
        workers: &Workers<'_>,
        input: &Input<'_>,
        pairs: &mut [Pair],
        states: &[PackedState],
        contacts: &mut Contacts,
        memory: &mut ContactMemory<'_>,
    ) -> u32 {
        let group = |allowance: &mut Allowance| self.group(input, pairs, states, allowance);
        if !memory.allowances.within(Category::Scratch, group) {
            return 0;
        }
        let Seams { pairs: order, groups, .. } = self;
        let (all, view, own) = (contacts.share(), &*pairs, Shared::new(order));
        workers.run(groups.len().div_ceil(BLOCK), &|block| {
            let end = groups.len().min((block + 1) * BLOCK);
            for &[first, last] in &groups[block * BLOCK..end] {
                // SAFETY: groups don't overlap, and this is the only one that runs the block.
                unsafe { judge(input, view, own.part(first as usize..last as usize), &all) };
            }
        });
        let mut shed = 0;
        for &index in order.iter() {
            let pair = &mut pairs[(index & !TO_LEVEL) as usize];
            if index & TO_LEVEL != 0 {
                shed += find_again(input, pair, contacts, memory);
            }
            if pair.contact != NO_CONTACT {
                pair.contact = contacts.remove_empty(pair.contact);
            }
        }
        shed
    }

    /// Finds the shapes that are near several pieces. Returns whether there are any.
    fn group(
        &mut self,
        input: &Input<'_>,
        pairs: &[Pair],
        states: &[PackedState],
        allowance: &mut Allowance,
    ) -> bool {
        let Seams { ends, pairs: order, groups } = self;
        order.clear();
        groups.clear();
        ends.clear();
        let count = states.iter().filter(|state| state.is_of_ground()).count();
        let colliders = input.colliders.len();
        if count < 2
            || allowance.fit(ends, colliders) < colliders
            || allowance.fit(order, count) < count
            || allowance.fit(groups, count / 2) < count / 2
        {
            return false;
        }
        ends.resize(colliders, 0);
        let of_ground = || (0..).zip(states).filter(|(_, state)| state.is_of_ground()).map(|(i, _)| i as u32);
        for index in of_ground() {
            ends[lying(input, &pairs[index as usize]) as usize] += 1;
        }
        let mut start = 0;
        for end in ends.iter_mut() {
            let own = *end;
            *end = if own > 1 { start } else { u32::MAX };
            if own > 1 {
                groups.push([start, start + own]);
                start += own;
            }
        }
        order.resize(start as usize, 0);
        for index in of_ground() {
            let at = &mut ends[lying(input, &pairs[index as usize]) as usize];
            if *at != u32::MAX {
                order[*at as usize] = index;
                *at += 1;
            }
        }
        !groups.is_empty()
    }
}

/// The collider of a pair with ground that is ground.
fn ground(input: &Input<'_>, pair: &Pair) -> u32 {
    if lying(input, pair) == pair.a { pair.b } else { pair.a }
}

/// The collider of a pair with ground that can be pushed.
fn lying(input: &Input<'_>, pair: &Pair) -> u32 {
    let pushed = (input.summaries[pair.a as usize].body as usize) < input.dynamic;
    if pushed { pair.a } else { pair.b }
}

/// A manifold of a shape with a piece.
#[derive(Clone, Copy)]
struct Side {
    slot: u32,
    /// Index of its piece.
    piece: usize,
    /// Unit, out of the piece.
    normal: Vec3,
    places: Places,
    /// The normal of the face of the piece that it comes from, if any.
    face: Option<Vec3>,
    is_edge: bool,
    /// Least separation of its points [m].
    nearest: f32,
    /// Where the shape is when it touches the piece [m].
    shape_at: Vec3,
    /// How exact its places are: carried along a path they are less so [m].
    within: f32,
    /// Whether the shape is a ball: then points that were merged each have a normal of their own.
    is_ball: bool,
    dropped: bool,
}

impl Side {
    fn normal_at(&self, at: Vec3) -> Vec3 {
        if self.is_ball { (self.shape_at - at).normalize_or(self.normal) } else { self.normal }
    }
}

/// Judges the manifolds of the pairs of one shape; those that are dropped are left without points.
///
/// # Safety
/// No other thread may access the contacts of these pairs.
unsafe fn judge(input: &Input<'_>, pairs: &[Pair], own: &mut [u32], contacts: &SharedContacts<'_>) {
    if own.iter().filter(|&&index| pairs[index as usize].contact != NO_CONTACT).count() == 0 {
        return;
    }
    let most = own.len().min(MOST);
    let own = &mut own[..most];
    let mut pieces = [None::<Piece<'_>>; MOST];
    let mut sides = [None::<Side>; MOST];
    let mut count = 0;
    for (i, &index) in own.iter().enumerate() {
        let pair = &pairs[index as usize];
        let piece = piece_of(input, pair);
        pieces[i] = Some(piece);
        let mut slot = pair.contact;
        while slot != NO_CONTACT && count < MOST {
            // SAFETY: by the contract.
            let contact = unsafe { contacts.at(slot) };
            sides[count] =
                side(input, pair, contact.as_ref(), &piece).map(|side| Side { slot, piece: i, ..side });
            count += usize::from(sides[count].is_some());
            slot = contact.next;
        }
    }
    let mut sides: [Side; MOST] = match sides[0] {
        Some(first) => sides.map(|side| side.unwrap_or(first)),
        None => return,
    };
    let sides = &mut sides[..count];
    // What rests on level faces.
    let first = sides[0].normal;
    if sides.iter().all(|side| !side.is_edge && side.normal.dot(first) > FLAT_EDGE_COSINE) {
        return;
    }
    let lies = lying(input, &pairs[own[0] as usize]) as usize;
    let pose = Pose::new(Vec3::ZERO, input.poses[lies].rotation);
    let shape = Piece { collider: &input.colliders[lies], pose };
    // The nearest first; they are judged from the last, so a nearer one stays for those behind it.
    sides.sort_unstable_by(|x, y| x.nearest.total_cmp(&y.nearest).then(x.piece.cmp(&y.piece)));
    for i in (0..count).rev() {
        // SAFETY: by the contract.
        let mut contact = unsafe { contacts.at(sides[i].slot) };
        let over = |at: &Vec3| is_over_another(&pieces, &sides[i], *at);
        let face = sides[i].face.filter(|_| sides[i].is_edge && sides[i].places.each().iter().any(over));
        let index = &mut own[sides[i].piece];
        let pair = &pairs[*index as usize];
        let is_convex = input.summaries[ground(input, pair) as usize].kind.is_convex();
        let hidden = hidden(input, &shape, &pieces, sides, i);
        if hidden {
            sides[i].dropped = true;
            contact.empty();
        } else if face.is_some() && is_convex && contact.fraction == 0.0 {
            *index |= TO_LEVEL;
        } else if is_covered(input, &pieces, sides, i) {
            sides[i].dropped = true;
            contact.empty();
        } else if let Some(face) = face {
            level(input, pair, &mut contact, &sides[i], face);
        }
    }
}

/// The ground of a pair, seen from what lies on it.
fn piece_of<'a>(input: &Input<'a>, pair: &Pair) -> Piece<'a> {
    let lies = lying(input, pair);
    let ground = ground(input, pair);
    let (pose, from) = (&input.poses[ground as usize], &input.poses[lies as usize]);
    let position = (pose.position - from.position).as_vec3();
    Piece { collider: &input.colliders[ground as usize], pose: Pose::new(position, pose.rotation) }
}

/// A manifold as a side of a piece.
fn side(input: &Input<'_>, pair: &Pair, contact: ContactRef<'_>, piece: &Piece<'_>) -> Option<Side> {
    let lies_first = lying(input, pair) == pair.a;
    // From a to b, in the world.
    let normal = contact.frame * contact.normal;
    let [a, b] = [pair.a, pair.b].map(|c| input.motion_of(c).linear);
    let moved = (a - b) * contact.fraction;
    let Relative { position, rotation } = contact.found_at;
    let mut places = Places::default();
    for point in contact.points() {
        // Midway between the surfaces where it was found.
        let apart = 0.5 * (point.found - normal.dot(moved).max(0.0));
        places.at[places.count] = if lies_first {
            let local = rotation.conjugate() * (point.position - position);
            piece.pose.point(local) + moved + normal * apart
        } else {
            piece.pose.point(point.position) - normal * apart
        };
        places.count += 1;
    }
    let out = if lies_first { -normal } else { normal };
    let nearest = contact.points().iter().map(|p| p.separation).fold(f32::INFINITY, f32::min);
    let is_ball = input.summaries[lying(input, pair) as usize].kind == Kind::Sphere;
    let within = input.touch_distance * if contact.fraction > 0.0 { 2.0 } else { 1.0 };
    let face = piece.face(out, &places, within);
    let is_edge = piece.is_edge(out, face);
    let shape_at = if lies_first { moved } else { -moved };
    let side = Side {
        slot: 0,
        piece: 0,
        normal: out,
        places,
        face,
        is_edge,
        nearest,
        shape_at,
        within,
        is_ball,
        dropped: false,
    };
    (places.count > 0).then_some(side)
}

/// The first rule, for a manifold of `shape`.
fn hidden(
    input: &Input<'_>,
    shape: &Piece<'_>,
    pieces: &[Option<Piece<'_>>],
    sides: &[Side],
    i: usize,
) -> bool {
    let own = &sides[i];
    let Some(piece) = &pieces[own.piece] else { return false };
    let touch = input.touch_distance;
    let behind = |other: &Side, face: Vec3| {
        // A place that was carried along a path may not be found again: then all counts that is near the
        // shape.
        let around = Places { at: [own.shape_at; MAX_POINTS], count: 1 };
        let high = piece.reach(face, &own.places, own.within);
        let high = high.or_else(|| piece.reach(face, &around, shape.collider.radius));
        // Lifted out of the face the shape reaches no lower than this, nor while the face holds it.
        let low = shape.reach(-face, &own.places, 0.0).map(|low| -low - other.nearest.min(0.0));
        let plane = other.places.each().iter().map(|at| at.dot(face)).fold(f32::MIN, f32::max);
        high.zip(low).is_some_and(|(high, low)| high <= low.min(plane) + touch)
    };
    sides.iter().filter(|other| !other.dropped && other.piece != own.piece).any(|other| {
        let leans = |face: &Vec3| own.normal.dot(*face) < FLAT_EDGE_COSINE;
        other.face.filter(leans).is_some_and(|face| behind(other, face))
    })
}

/// Whether a place of a manifold lies on another piece that goes on beyond its plane, or on another part of
/// its own mesh that does.
fn is_over_another(pieces: &[Option<Piece<'_>>], own: &Side, at: Vec3) -> bool {
    let others = pieces.iter().flatten().enumerate();
    others
        .filter(|(k, piece)| *k != own.piece || !piece.collider.kind.is_convex())
        .any(|(_, piece)| piece.goes_on(at, own.normal_at(at), own.within))
}

/// The second rule.
fn is_covered(input: &Input<'_>, pieces: &[Option<Piece<'_>>], sides: &[Side], i: usize) -> bool {
    let own = &sides[i];
    let near = own.nearest.max(input.touch_distance);
    let holds = |(k, other): (usize, &Side)| k != i && !other.dropped && other.nearest <= near;
    own.is_edge
        && sides.iter().enumerate().any(holds)
        && own.places.each().iter().all(|&at| is_over_another(pieces, own, at))
}

/// The third rule: the points of a manifold on the face that it is of.
fn level(input: &Input<'_>, pair: &Pair, contact: &mut ContactMut<'_>, own: &Side, face: Vec3) {
    let lies = lying(input, pair);
    let ground = &input.poses[ground(input, pair) as usize];
    let shape = &input.colliders[lies as usize];
    let pose = &input.poses[lies as usize];
    let turn = pose.rotation * shape.rotation.conjugate();
    let (lever, spin) = (turn * shape.position, input.motion_of(lies).angular * contact.fraction);
    let offset = own.places.each().iter().map(|at| at.dot(face)).fold(f32::MIN, f32::max);
    let frame = contact.frame.conjugate();
    contact.normal = frame * if lies == pair.a { -face } else { face };
    for (point, &at) in contact.points_mut().iter_mut().zip(own.places.each()) {
        let apart = point.found - own.shape_at.dot(-own.normal).max(0.0);
        // On the shape, where it touches.
        let on_shape = at + own.normal * apart;
        let height = on_shape.dot(face) - offset;
        let closed = -face.dot(own.shape_at + spin.cross(lever + on_shape - own.shape_at));
        let middle = on_shape - face * (0.5 * height);
        point.position = if lies == pair.a {
            frame * (middle - own.shape_at)
        } else {
            frame * (middle - (ground.position - pose.position).as_vec3())
        };
        point.separation = height + closed.max(0.0);
        point.found = point.separation;
    }
}

/// The third rule for a convex piece: finds the contact with the plane of its face, as far as the piece goes.
/// A contact that has nothing there is left without points. Returns the number of points that got no place.
fn find_again(
    input: &Input<'_>,
    pair: &Pair,
    contacts: &mut Contacts,
    memory: &mut ContactMemory<'_>,
) -> u32 {
    let piece = piece_of(input, pair);
    let Some(Side { face: Some(face), .. }) = side(input, pair, contacts.at(pair.contact), &piece) else {
        return 0;
    };
    let lies = lying(input, pair);
    let (shape, rotation) = (&input.colliders[lies as usize], input.poses[lies as usize].rotation);
    let Some(offset) = piece.reach(face, &Places::default(), 0.0) else { return 0 };
    let back = rotation.conjugate();
    let plane = Collider { kind: Kind::Plane, geometry: Geometry::Plane, ..piece.collider.clone() };
    let up = back * face;
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
    if kept == 0 {
        contacts.at_mut(pair.contact).empty();
        return 0;
    }
    if lies == pair.b {
        let ground = relative_pose(pair, input.poses);
        let turned = ground.rotation.conjugate();
        raw = raw.flipped(-(turned * ground.position), turned);
    }
    if kept > contacts.room(pair.contact) {
        let points = ContactCount { contacts: 0, points: kept };
        memory.allowances.within(Category::Manifolds, |allowance| contacts.reserve(points, allowance));
    }
    let shed = raw.keep(contacts.grow(pair.contact, kept));
    contacts.at_mut(pair.contact).renew(&raw, FoundAt::of(pair, input, 0.0), input.match_limits(pair));
    shed
}

/// The rotation of the y axis to a unit vector, exact for small angles too.
fn turn_to(up: Vec3) -> Quat {
    if up.y < -0.9 {
        return Quat::from_rotation_arc(Vec3::Y, up);
    }
    let axis = Vec3::Y.cross(up);
    Quat::from_xyzw(axis.x, axis.y, axis.z, 1.0 + up.y).normalize()
}
