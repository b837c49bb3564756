//! The narrow phase's central decision: the search for a pair, and its pose.
//!
//! Each pair gets the *manifold of the start* first: the result of its kernel at the poses that the step
//! begins with, real points and potential ones as far away as the predicted motion can reach. It is good as
//! long as the pair touches, or moves little. For everything else the rows below replace it; the first that
//! fits counts, and "fast" means that the two may approach each other by more than [`Input::fast`]. The mode
//! `Discrete` and the method [`Start::Speculative`] never leave the manifold of the start because of a gap.
//!
//! Two convex shapes, or one and a plane:
//!
//! | state of the pair | searched | at which pose |
//! | --- | --- | --- |
//! | apart and fast, and the motion can't close the gap | nothing: no contact | - |
//! | apart; fast, or a plane would push an untouched shape | the manifold of the first touch | first touch |
//! | ... but it finds none, in mode `Volume` | the manifold of the closest pass | closest pass |
//! | ... but it finds none, and a body may leave its predicted path | the manifold of the start | start |
//! | ... but it finds none | nothing: no contact | - |
//! | overlaps so deeply that it leads out through a still shape | that on the side of the centre | start |
//! | none of these | the manifold of the start | start |
//!
//! The result is examined once more, if it has a point:
//!
//! | state of the pair | searched | at which pose |
//! | --- | --- | --- |
//! | both bodies move far past each other | deeper overlap than foreseen | half the rest, the step's end |
//! | one or two points, on a comparatively large round shape | the manifold of mid-step | half the step |
//!
//! A convex shape against a mesh or a height field:
//!
//! | state of the pair | searched | at which pose |
//! | --- | --- | --- |
//! | in flight: fast and without a contact | only the first touch, unless triangles are near | first touch |
//! | slow, in mode `Segment`, and moves beyond the margin | triangles near here or on its path | start |
//! | ... but strikes some of that | all within reach | start |
//! | slow | all within reach | start |
//! | fast | triangles that it rests on, | start |
//! | | the first touch with anything else, | first touch |
//! | | the second, sliding along the first | first touch |
//!
//! Where a mesh is near but not touched, planes of the start that would push count only if a cast touches
//! anything. Slow is also a shape that moves by less than half the ball that fits into it, and one that
//! rolls: then planes at the start suffice.
//!
//! Which pairs are not looked at at all (they sleep, keep their contact, are too far apart or only feed a
//! sensor) is decided before, by [`collide`](super::collide).

use super::cast::ahead::{
    MeshPair, add_manifolds_at_touch, first_touch_in_flight, first_touch_with_mesh, keep_reached,
    manifold_at_closest_pass, manifold_at_first_touch, manifold_at_half_step, manifold_later_on_path,
    motion_of, right_way_out, strikes, touches_mesh, would_push,
};
use super::cast::gates::{enter_mesh, gate, straight};
use super::cast::mesh::CastResult;
use super::cast::motion::Motion;
use super::cast::{Touch, tolerance};
use super::contacts::contact::{FoundAt, NO_CONTACT};
use super::contacts::found::{BlockOutput, Handed};
use super::contacts::of_meshes::MeshBlock;
use super::contacts::store::SharedContacts;
use super::input::{Approach, Input};
use super::mesh::collide_mesh;
use super::mesh::reach::{Reach, extent_of};
use super::{RawManifold, Relative};
use crate::broad_phase::Pair;
use crate::config::ContinuousMode;
use crate::config::Start;
use crate::config::tuning::{GHOST_GAP, NO_GAP};
use crate::shape::Collider;
use std::cell::OnceCell;

/// A pair of the step, where its shapes are and how they move.
#[derive(Clone, Copy)]
pub(super) struct PairView<'a> {
    pub(super) input: &'a Input<'a>,
    pub(super) pair: &'a Pair,
    /// Index of the pair in the step's list.
    pub(super) index: u32,
    /// Pose of `b` in the frame of `a` at the start of the step.
    pub(super) rel: &'a Relative,
    pub(super) approach: &'a Approach,
}

/// The predicates of both tables.
impl PairView<'_> {
    fn shapes(&self) -> (&Collider, &Collider) {
        self.input.shapes(self.pair)
    }

    fn has_contact(&self) -> bool {
        self.pair.contact != NO_CONTACT
    }

    /// Whether the predicted motion decides about touches: separate shapes are not left to the planes of the
    /// start.
    fn follows_motion(&self) -> bool {
        self.approach.is_continuous() && self.input.start != Start::Speculative
    }

    fn is_gated(&self) -> bool {
        self.input.start.is_gated()
    }

    /// Whether a pair is of something static and a body that joints may pull off its predicted path. That
    /// this path misses near shapes proves nothing then.
    fn may_leave_predicted_path(&self) -> bool {
        let (input, pair) = (self.input, self.pair);
        let pushed = if input.is_pushed(pair.a) { pair.a } else { pair.b };
        input.is_static(pair) && (input.has_joints)(input.summaries[pushed as usize].body)
    }
}

/// The predicates of convex pairs. `raw`: the manifold of the start, `nearest` the least of its separations
/// [m].
impl PairView<'_> {
    fn is_fast(&self, nearest: f32) -> bool {
        nearest > self.input.touch_distance && self.approach.max_closing() > self.input.fast
    }

    /// Whether the motion is too short to close the gap across a plane that lies between the two.
    fn stays_apart(&self, raw: &RawManifold, nearest: f32) -> bool {
        let normal = self.input.poses[self.pair.a as usize].rotation * raw.normal;
        let closing = -normal.dot(self.approach.displacement);
        self.approach.mode != ContinuousMode::Volume && closing + self.approach.swing < nearest
    }

    /// Whether a plane would push a shape that the predicted motion never brings to it.
    fn would_push(&self, raw: &RawManifold) -> bool {
        would_push(self.input, &motion_of(self.input, self.pair), raw)
    }

    /// Whether two bodies that both move go further past each other within the step than the planes of its
    /// start are good for.
    fn slides_far(&self) -> bool {
        let Self { input, pair, approach, .. } = *self;
        let moves = |c: u32| (input.summaries[c as usize].body as usize) < input.motion.len();
        let inner = |c: u32| input.colliders[c as usize].inner_radius;
        approach.is_continuous()
            && input.start == Start::Cast
            && approach.max_closing() > input.fast
            && moves(pair.a)
            && moves(pair.b)
            && approach.max_closing() > 0.5 * inner(pair.a).max(inner(pair.b))
    }

    /// Whether the contact point moves much faster than the bodies: on a round shape that is large against
    /// the other, which rocks on it. The rows of a step act at one place. At the place of its start they
    /// would add energy to the rocking in every step; at that of its middle they take a little away.
    fn contact_point_moves(&self) -> bool {
        let large =
            |round: &Collider, other: &Collider| round.kind.is_round() && round.radius > 2.0 * other.radius;
        let (a, b) = self.shapes();
        large(a, b) || large(b, a)
    }
}

/// How far from each other the kernel of a convex pair still finds points [m].
#[inline(always)]
pub(super) fn margin_of(input: &Input<'_>, approach: &Approach) -> f32 {
    input.margin + approach.reach(input.margin)
}

/// The manifold that a convex pair gets.
struct Chosen {
    raw: RawManifold,
    /// Fraction of the step at which it was found.
    fraction: f32,
    /// Nothing is touched on the whole predicted path.
    missed: bool,
}

/// Chooses the manifold of two convex shapes, or of one and a plane, by the first two tables. `raw`: that of
/// the start.
pub(super) fn finish_convex(
    view: &PairView<'_>,
    raw: RawManifold,
    contacts: &SharedContacts<'_>,
    out: &mut BlockOutput<'_>,
) {
    let &PairView { input, pair, rel, .. } = view;
    let (nearest, casts) = (raw.points().iter().fold(f32::INFINITY, |s, p| s.min(p.separation)), out.casts());
    let mut chosen = Chosen { raw, fraction: 0.0, missed: false };
    if raw.count == 0 && !view.has_contact() {
        return out.note_apart(input, view.index, raw.gap());
    }
    if view.follows_motion() && nearest > 0.0 && raw.count > 0 {
        choose_apart(view, nearest, &mut chosen, out);
    } else if nearest < 0.0
        && let Some(way_out) = right_way_out(input, pair, rel, &raw)
    {
        chosen.raw = way_out;
    }
    if chosen.raw.count > 0
        && view.slides_far()
        && let Some(later) = manifold_later_on_path(input, pair, &chosen.raw, chosen.fraction)
    {
        (chosen.raw, chosen.fraction) = later;
    }
    if chosen.fraction == 0.0 && (1..3).contains(&chosen.raw.count) && view.contact_point_moves() {
        let middle = manifold_at_half_step(input, pair, input.margin);
        // Unless it would push where nothing is touched.
        if middle.count > 0 && (nearest <= 0.0 || !view.would_push(&middle)) {
            (chosen.raw, chosen.fraction) = (middle, 0.5);
        }
    }
    if !store(view, &chosen, nearest, contacts, out) {
        out.set_casts(casts);
    }
}

/// Chooses for a pair that is apart by `nearest` at the start: the rest of the first table.
#[inline(always)]
fn choose_apart(view: &PairView<'_>, nearest: f32, chosen: &mut Chosen, out: &mut BlockOutput<'_>) {
    let fast = view.is_fast(nearest);
    let may_leave = nearest <= view.input.margin && view.may_leave_predicted_path();
    if fast && !may_leave && view.stays_apart(&chosen.raw, nearest) {
        (chosen.raw.count, chosen.missed) = (0, true);
    } else if fast || view.would_push(&chosen.raw) {
        let found = look_on_path(view, &chosen.raw, out);
        if found.is_some() || !may_leave {
            (chosen.raw, chosen.fraction) = found.unwrap_or_default();
        }
        chosen.missed = chosen.raw.count == 0;
    }
}

/// The manifold of the first touch or, in mode `Volume`, of the closest pass, and the fraction of the step.
fn look_on_path(
    view: &PairView<'_>,
    raw: &RawManifold,
    out: &mut BlockOutput<'_>,
) -> Option<(RawManifold, f32)> {
    let &PairView { input, pair, approach, .. } = view;
    let hit = if view.is_gated() {
        gate(input, pair, raw)
    } else {
        out.count_casts(1);
        manifold_at_first_touch(input, pair)
    };
    let is_volume = approach.mode == ContinuousMode::Volume;
    hit.or_else(|| if is_volume { manifold_at_closest_pass(input, pair) } else { None })
}

/// Hands the manifold of a convex pair to its contact. Returns false if the pair has to be looked at again
/// because the contact has no place for its points.
#[inline(always)]
fn store(
    view: &PairView<'_>,
    chosen: &Chosen,
    nearest: f32,
    contacts: &SharedContacts<'_>,
    out: &mut BlockOutput<'_>,
) -> bool {
    let &PairView { input, pair, index, rel, .. } = view;
    if !view.has_contact() {
        if chosen.raw.count > 0 {
            let handed = out.hand_over(index, chosen.raw, chosen.fraction, true);
            if handed == Handed::Nowhere {
                out.count_shed(chosen.raw.size());
            }
            return handed != Handed::Again;
        }
        if chosen.missed {
            out.clear(index);
        }
        return true;
    }
    // SAFETY: the contact is this pair's, and this block has the pair.
    let mut contact = unsafe { contacts.at(pair.contact) };
    let mut raw = chosen.raw;
    let grows = raw.count as usize > contact.room();
    let handed = grows.then(|| out.hand_over(index, raw, chosen.fraction, false));
    match handed {
        Some(Handed::Again) => return false,
        Some(Handed::Nowhere) => out.count_shed(raw.keep(contact.room())),
        Some(Handed::Over) | None => {}
    }
    if contact.pushed && nearest > GHOST_GAP * input.margin {
        out.count_ghost();
    }
    if chosen.raw.count == 0 {
        out.empty(index);
    } else if handed != Some(Handed::Over) {
        let frame = input.poses[pair.a as usize].rotation;
        let at = FoundAt { pose: *rel, frame, fraction: chosen.fraction };
        contact.renew(&raw, at, input.match_limits(pair));
    }
    true
}

/// A look at a convex shape and a mesh or height field.
struct MeshLook<'a> {
    view: &'a PairView<'a>,
    shape: &'a Collider,
    mesh: &'a Collider,
    /// Made on first use: a shape that rests on the mesh may not need it.
    motion: OnceCell<Motion>,
    fast: bool,
    /// How far from the shape triangles matter at the start [m].
    margin: f32,
}

/// Counts of a search in a mesh.
struct Tally {
    casts: u32,
    /// The least separation at the start [m].
    nearest: f32,
}

/// Finds the manifolds of a convex shape and a mesh or height field, by the third table.
pub(super) fn finish_mesh(view: &PairView<'_>, contacts: &SharedContacts<'_>, out: &mut BlockOutput<'_>) {
    let &PairView { pair, index, .. } = view;
    let look = MeshLook::new(view);
    let Some(block) = out.mesh.as_deref_mut() else {
        // No buffers were granted, and the contacts of the last step are out of date.
        out.count_shed(1);
        if view.has_contact() {
            out.empty(index);
        }
        return;
    };
    let mut tally = Tally { casts: 0, nearest: f32::INFINITY };
    let start = block.count();
    block.mesh.nearby.forget();
    let flight = if look.is_in_flight() {
        first_touch_in_flight(view.input, &look.moving(), &mut block.mesh)
    } else {
        CastResult::Near
    };
    let ahead = match flight {
        CastResult::First(touch) => Some(touch),
        CastResult::Free => None,
        CastResult::Near => look.look_at_start(block, &mut tally),
    };
    tally.casts += u32::from(look.fast);
    if let Some(touch) = ahead {
        tally.casts += 1;
        look.hit(touch, block);
    }
    let found = block.end(index, start);
    out.count_casts(if view.is_gated() { 0 } else { tally.casts });
    if let CastResult::Free = flight {
        out.clear(index);
    }
    if view.has_contact() {
        // SAFETY: the contact is this pair's, and this block has the pair.
        let contact = unsafe { contacts.at(pair.contact) };
        if contact.pushed && tally.nearest > GHOST_GAP * view.input.margin {
            out.count_ghost();
        }
    }
    if !found && view.has_contact() {
        out.empty(index);
    }
}

/// The predicates of the third table.
impl<'a> MeshLook<'a> {
    fn new(view: &'a PairView<'a>) -> MeshLook<'a> {
        let &PairView { input, approach, .. } = view;
        let ((shape, mesh), most) = (view.shapes(), approach.max_closing());
        // Within half the ball that fits into it a body can't get past a triangle, and planes at the start
        // will do.
        let fast =
            view.follows_motion() && !rolls(view, shape) && most > input.fast.max(0.5 * shape.inner_radius);
        // Where the body is, and the reach of its rotation: touches further away are found by the cast.
        let reach = if fast { approach.swing.min(shape.radius) } else { approach.reach(input.margin) };
        MeshLook { view, shape, mesh, motion: OnceCell::new(), fast, margin: input.margin + reach }
    }

    /// Without a contact it is likely that nothing is near.
    fn is_in_flight(&self) -> bool {
        self.fast && !self.view.is_gated() && !self.view.has_contact()
    }

    /// A slow shape reaches its end pose: only triangles near the start or the end matter, unless it strikes
    /// those.
    fn looks_along_motion(&self) -> bool {
        let &PairView { input, approach, .. } = self.view;
        !self.fast && approach.mode == ContinuousMode::Segment && approach.length > input.margin
    }

    /// Whether a manifold of the start is a guess: its planes would push, and neither is it near nor may the
    /// body leave its predicted path.
    fn is_guess(&self, raw: &RawManifold) -> bool {
        let input = self.view.input;
        let near = |m: &RawManifold| m.points().iter().any(|p| p.separation <= input.margin);
        would_push(input, self.motion(), raw) && !(near(raw) && self.view.may_leave_predicted_path())
    }

    fn shapes(&self) -> (&'a Collider, &'a Collider) {
        (self.shape, self.mesh)
    }

    fn motion(&self) -> &Motion {
        self.motion.get_or_init(|| motion_of(self.view.input, self.view.pair))
    }

    fn moving(&self) -> MeshPair<'_> {
        let MeshLook { view, shape, mesh, .. } = *self;
        MeshPair { shape, mesh, rel: view.rel, motion: self.motion() }
    }
}

/// A shape that rolls on a mesh moves and turns alike, and its planes are near: its path and its turn may
/// each be as long as the radius of the ball that fits into it.
fn rolls(view: &PairView<'_>, shape: &Collider) -> bool {
    let approach = view.approach;
    view.has_contact()
        && approach.mode == ContinuousMode::Segment
        && approach.length.max(approach.swing) < shape.inner_radius
}

/// The searches, case by case.
impl MeshLook<'_> {
    /// Adds the manifolds of the start; if the pair is fast only those that it rests on. Returns the first
    /// other touch of a fast one.
    #[inline(always)]
    fn look_at_start(&self, block: &mut MeshBlock, tally: &mut Tally) -> Option<Touch> {
        let &PairView { input, .. } = self.view;
        if self.fast {
            // The path will be asked for too.
            let motion = self.motion();
            let path = motion.a.rotation.conjugate() * motion.displacement;
            block.mesh.nearby.expect(extent_of(self.shape, self.view.rel, self.margin, path));
        }
        self.collide(block);
        tally.nearest =
            block.raw.iter().flat_map(|m| m.points()).fold(f32::INFINITY, |s, p| s.min(p.separation));
        // A shape that rests on the mesh sinks by the displacement of gravity in the step, and must not
        // strike the ground that it is on.
        let resting = if tally.nearest <= input.touch_distance { input.margin } else { input.touch_distance };
        if self.fast {
            // Manifolds without a near point are guesses; real hits come from the cast.
            block.raw.retain(|m| m.points().iter().any(|p| p.separation <= resting));
        }
        self.drop_guesses(block, tally);
        (0..block.raw.len()).for_each(|i| block.add(block.raw[i], 0.0));
        if !self.fast {
            None
        } else if self.view.is_gated() {
            enter_mesh(input, &self.moving(), resting)
        } else {
            first_touch_with_mesh(input, &self.moving(), resting, &mut block.mesh)
        }
    }

    /// Finds the manifolds of the start.
    #[inline(always)]
    fn collide(&self, block: &mut MeshBlock) {
        let &PairView { input, pair, approach, rel, .. } = self.view;
        let (a, b) = self.shapes();
        block.raw.clear();
        // If it is fast, manifolds without a near point would be dropped.
        let all = Reach::new(self.margin).within(if self.fast { input.margin } else { self.margin });
        let along = self.looks_along_motion();
        let path = input.poses[pair.a as usize].rotation.conjugate() * -approach.displacement;
        let reach = if along { Reach { path, ..Reach::new(input.margin + approach.swing) } } else { all };
        collide_mesh(a, b, rel, reach, &mut block.mesh, &mut block.raw);
        if along && strikes(self.motion(), input.margin, &block.raw) {
            // After an impact it may go anywhere.
            block.raw.clear();
            collide_mesh(a, b, rel, all, &mut block.mesh, &mut block.raw);
        } else if along && block.raw.iter().any(|m| m.points().iter().all(|p| p.separation > input.margin)) {
            keep_reached(self.motion(), input.margin, &mut block.raw);
        }
    }

    /// Drops guesses if the mesh is close, but apart by more than shows, and nothing is touched at all within
    /// the step.
    #[inline(always)]
    fn drop_guesses(&self, block: &mut MeshBlock, tally: &mut Tally) {
        let &PairView { input, approach, .. } = self.view;
        let apart =
            tally.nearest > tolerance(self.shape, self.mesh, input.unit).max(NO_GAP * input.touch_distance);
        if !(self.view.follows_motion() && apart && block.raw.iter().any(|m| self.is_guess(m))) {
            return;
        }
        tally.casts += 1;
        let touches = if self.view.is_gated() {
            approach.swing > input.margin || enter_mesh(input, &self.moving(), 0.0).is_some()
        } else {
            touches_mesh(input.unit, &self.moving(), &mut block.mesh)
        };
        if !touches {
            block.raw.retain(|m| !self.is_guess(m));
        }
    }

    /// Adds the manifolds of the first touch, and of the second.
    fn hit(&self, touch: Touch, block: &mut MeshBlock) {
        let &PairView { input, pair, .. } = self.view;
        if self.view.is_gated() {
            add_manifolds_at_touch(input, pair, self.shapes(), &straight(self.motion()), touch, block);
        } else {
            add_manifolds_at_touch(input, pair, self.shapes(), self.motion(), touch, block);
        }
    }
}
