//! Contacts: manifolds that last while their pair does, with the impulses of the last step.
//!
//! A contact is a header and one to four points. The store keeps them in columns of their own
//! ([`Contacts`](super::store::Contacts)); code that works on a contact sees both through [`ContactRef`] or
//! [`ContactMut`], wherever they are.

use super::manifold::{MAX_POINTS, RawManifold};
use crate::config::tuning::{KEPT_CONTACT_TURN, LOAD_BAND, LOAD_TIME, SPRING_GAP};
use crate::limits::MAX_LOAD;
use crate::math::Quat;
use crate::narrow_phase::Relative;
use glam::Vec3;
use std::ops::{Deref, DerefMut};

// Sentinel: no load was estimated.
/// [`Header::static_load`] of a contact whose load was not estimated yet.
pub(crate) const UNKNOWN_LOAD: f32 = -1.0;

// Sentinel: the load is no longer the estimated one.
/// [`Header::static_load`] of a contact whose load has to be estimated again: its spring keeps its rest
/// position.
pub(crate) const CHANGED_LOAD: f32 = -2.0;

/// No contact.
pub(crate) const NO_CONTACT: u32 = u32::MAX;

/// A point of a contact.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Point {
    /// Midway between the surfaces when the contact was found, in the frame of shape `a` [m].
    pub(crate) position: Vec3,
    /// Separation at the start of the step, negative in overlap [m].
    pub(crate) separation: f32,
    /// Separation when the contact was found [m].
    pub(crate) found: f32,
    /// Normal impulse of the last substep [N s].
    pub(crate) impulse: f32,
    /// Mean force of the last steps [N], kept once steps vary in length; zero before, see [`StepLengths`].
    pub(crate) mean_force: f32,
    /// Its share of [`Header::lasting_force`]: by statics, or the same at each point.
    pub(crate) share: f32,
    pub(crate) key: u32,
}

impl Point {
    /// Takes over the impulse and the load of an old point.
    fn inherit(&mut self, old: &Point) {
        (self.impulse, self.mean_force, self.share) = (old.impulse, old.mean_force, old.share);
    }
}

/// A manifold of a pair of colliders, without its points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Header {
    pub(crate) a: u32,
    pub(crate) b: u32,
    /// Next contact of the same pair (meshes have several), or [`NO_CONTACT`].
    pub(crate) next: u32,
    pub(crate) count: u8,
    /// The solver had to push a potential point of it in this step.
    pub(crate) pushed: bool,
    /// Number of the material of `b`, if it is a mesh or a height field; zero: the shape's own.
    pub(crate) material: u8,
    /// Fraction of the step at which the contact was found: the pose of first touch. Its separations are
    /// carried back to the start. Zero: found at the start. Others are never recycled.
    pub(crate) fraction: f32,
    /// Unit, from `a` to `b`, in the frame of shape `a`.
    pub(crate) normal: Vec3,
    /// Friction impulse of the last substep, in the frame of shape `a` [N s].
    pub(crate) friction: Vec3,
    /// Impulse against twist about the normal [N m s].
    pub(crate) twist: f32,
    /// Mean of friction [N] and twist [N m], as [`Point::mean_force`].
    pub(crate) mean_friction: [f32; 4],
    /// Normal force that all points together bear, each its share, at any separations (see `Softness`) [N].
    pub(crate) lasting_force: f32,
    /// Separation at which that force alone bears the load, if it is known: zero in the long run, from any
    /// value at the time when the load became known [m].
    pub(crate) rest: f32,
    /// Normal force by statics (see `statics`), [`UNKNOWN_LOAD`] or [`CHANGED_LOAD`] [N].
    pub(crate) static_load: f32,
    /// Pose of `b` in `a` when the contact was found.
    pub(crate) found_at: Relative,
    /// Rotation of shape `a` when the contact was found: rows act along this normal and at these arms while
    /// the contact is kept (docs/decisions/frozen-contacts.md).
    pub(crate) frame: Quat,
}

/// A contact that is not in the store: a new one, or a copy.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    pub(crate) header: Header,
    /// The first [`Header::count`] are its points.
    pub(crate) points: [Point; MAX_POINTS],
}

/// A contact, to be read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactRef<'a> {
    header: &'a Header,
    points: &'a [Point],
}

/// A contact, to be written.
#[derive(Debug)]
pub(crate) struct ContactMut<'a> {
    header: &'a mut Header,
    /// There may be place for more than it has.
    points: &'a mut [Point],
}

impl Deref for Contact {
    type Target = Header;
    #[inline(always)]
    fn deref(&self) -> &Header {
        &self.header
    }
}

impl DerefMut for Contact {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut Header {
        &mut self.header
    }
}

impl Deref for ContactRef<'_> {
    type Target = Header;
    #[inline(always)]
    fn deref(&self) -> &Header {
        self.header
    }
}

impl Deref for ContactMut<'_> {
    type Target = Header;
    #[inline(always)]
    fn deref(&self) -> &Header {
        self.header
    }
}

impl DerefMut for ContactMut<'_> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut Header {
        self.header
    }
}

impl Contact {
    pub(crate) fn new(a: u32, b: u32) -> Self {
        let header = Header {
            a,
            b,
            next: NO_CONTACT,
            count: 0,
            pushed: false,
            material: 0,
            fraction: 0.0,
            normal: Vec3::Y,
            friction: Vec3::ZERO,
            twist: 0.0,
            mean_friction: [0.0; 4],
            lasting_force: 0.0,
            rest: 0.0,
            static_load: UNKNOWN_LOAD,
            found_at: Relative::IDENTITY,
            frame: Quat::IDENTITY,
        };
        Contact { header, points: [Point::default(); MAX_POINTS] }
    }

    /// A new contact with the points of a manifold and no impulses.
    pub(crate) fn found(a: u32, b: u32, raw: &RawManifold, at: FoundAt) -> Self {
        let mut contact = Contact::new(a, b);
        contact.as_mut().take(raw, at);
        contact
    }

    #[inline(always)]
    pub(crate) fn as_ref(&self) -> ContactRef<'_> {
        ContactRef::new(&self.header, &self.points)
    }

    pub(crate) fn as_mut(&mut self) -> ContactMut<'_> {
        ContactMut::new(&mut self.header, &mut self.points)
    }
}

/// Limits that tell matching points and contacts from new ones.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MatchLimits {
    /// Distance within which two points match [m].
    pub(crate) near: f32,
    /// A pair that moved further past each other since its contact was last found slides or rolls [m].
    pub(crate) slides: f32,
}

/// How a manifold was found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FoundAt {
    /// Pose of `b` in `a`.
    pub(crate) pose: Relative,
    /// Rotation of shape `a`.
    pub(crate) frame: Quat,
    /// Fraction of the step.
    pub(crate) fraction: f32,
}

impl Header {
    /// The share of each point if all bear the same.
    pub(crate) fn even_share(&self) -> f32 {
        1.0 / f32::from(self.count.max(1))
    }

    /// Separation at which springs bear nothing but the lasting force, and how far beyond it they act at most
    /// [m].
    ///
    /// If the load is known, springs act at any depth, and over a gap too: a lean smaller than the gap would
    /// not be taken back. Otherwise only overlap beyond the slop is pushed apart, and rows are rigid above
    /// it: bodies that slide, roll or land meet no spring, which could press them through something thin.
    pub(crate) fn spring(&self, slop: f32) -> [f32; 2] {
        if self.is_unknown() { [-slop, 0.0] } else { [self.rest, SPRING_GAP * slop] }
    }

    /// Whether statics has not estimated its load yet, or not since it changed.
    pub(crate) fn is_unknown(&self) -> bool {
        self.static_load < 0.0
    }
}

impl<'a> ContactRef<'a> {
    /// `points`: at least as many as the header counts.
    #[inline(always)]
    pub(crate) fn new(header: &'a Header, points: &'a [Point]) -> ContactRef<'a> {
        ContactRef { header, points: &points[..header.count as usize] }
    }

    #[inline(always)]
    pub(crate) fn points(self) -> &'a [Point] {
        self.points
    }

    /// A copy that is not in the store.
    pub(crate) fn to_owned(self) -> Contact {
        let mut points = [Point::default(); MAX_POINTS];
        points.iter_mut().zip(self.points).for_each(|(to, from)| *to = *from);
        Contact { header: *self.header, points }
    }

    /// Whether it touches, or pushed within the step. `real`: largest separation that counts as touching [m].
    pub(crate) fn touches(self, real: f32) -> bool {
        self.points.iter().any(|p| p.separation <= real || p.impulse > 0.0)
    }

    /// Whether it touches and statics has not estimated its load yet. `real`: largest separation that counts
    /// as touching [m].
    pub(crate) fn touches_anew(self, real: f32) -> bool {
        self.is_unknown() && self.points.iter().any(|p| p.separation <= real)
    }

    /// Whether all values carried to the next step are finite and in range.
    pub(crate) fn has_sound_loads(self) -> bool {
        // The sum of NaN is NaN. No branch for each value: this runs for every contact in every step.
        let [x, y, z, w] = self.mean_friction.map(f32::abs);
        let friction = self.friction.abs().element_sum() + self.twist.abs() + (x + y) + (z + w);
        let mut sum = friction + self.lasting_force.abs() + self.rest.abs() + self.static_load.abs();
        for point in self.points {
            sum += point.impulse.abs() + point.mean_force.abs();
        }
        sum <= MAX_LOAD
    }

    /// The points that the contact can't do without, one bit each: those that bear or touch, or the nearest.
    pub(crate) fn needed(self) -> u32 {
        let bits = |needs: &dyn Fn(&Point) -> bool| {
            self.points.iter().enumerate().map(|(i, p)| u32::from(needs(p)) << i).sum::<u32>()
        };
        let needed = bits(&|p| p.impulse > 0.0 || p.separation <= 0.0);
        if needed != 0 {
            return needed;
        }
        let nearest = self.points.iter().map(|p| p.separation).fold(f32::INFINITY, f32::min);
        bits(&|p| p.separation == nearest).max(1)
    }

    /// Sum of the normal impulses [N s].
    #[inline(always)]
    pub(crate) fn bears(self) -> f32 {
        self.points.iter().map(|p| p.impulse).sum()
    }

    /// The least separation once the bodies have moved [m].
    #[inline(always)]
    pub(crate) fn nearest(self, now: &Relative) -> f32 {
        self.separations(now)[..self.points.len()].iter().fold(f32::INFINITY, |s, &x| s.min(x))
    }

    /// The separation of each of its points once the bodies have moved [m].
    #[inline(always)]
    pub(crate) fn separations(self, now: &Relative) -> [f32; MAX_POINTS] {
        let turn = now.rotation * self.found_at.rotation.conjugate();
        let mut separations = [0.0; MAX_POINTS];
        for (separation, point) in separations.iter_mut().zip(self.points) {
            let on_b = now.position + turn * (point.position - self.found_at.position);
            *separation = point.found + self.normal.dot(on_b - point.position);
        }
        separations
    }
}

impl<'a> ContactMut<'a> {
    /// `points`: its place, of at least as many as the header counts.
    #[inline(always)]
    pub(crate) fn new(header: &'a mut Header, points: &'a mut [Point]) -> ContactMut<'a> {
        ContactMut { header, points }
    }

    #[inline(always)]
    pub(crate) fn as_ref(&self) -> ContactRef<'_> {
        ContactRef::new(self.header, self.points)
    }

    #[inline(always)]
    pub(crate) fn points_mut(&mut self) -> &mut [Point] {
        &mut self.points[..self.header.count as usize]
    }

    /// For how many points there is place.
    #[inline(always)]
    pub(crate) fn room(&self) -> usize {
        self.points.len()
    }

    /// Takes a new manifold, for which there is place, and keeps the impulses of matching points: by key,
    /// else by position.
    pub(crate) fn renew(&mut self, raw: &RawManifold, at: FoundAt, same: MatchLimits) {
        let old = self.as_ref().to_owned();
        self.take(raw, at);
        if old.count == 0 || old.normal.dot(raw.normal) < 0.7 {
            (self.friction, self.twist) = (Vec3::ZERO, 0.0);
            (self.lasting_force, self.static_load) = (0.0, UNKNOWN_LOAD);
            return;
        }
        self.inherit(old.as_ref(), same);
    }

    /// Leaves it without points, to be [removed](super::store::Contacts::remove_empty).
    pub(crate) fn empty(&mut self) {
        self.count = 0;
    }

    /// Sets the points without impulses.
    fn take(&mut self, raw: &RawManifold, FoundAt { pose, frame, fraction }: FoundAt) {
        (self.count, self.material) = (raw.count as u8, raw.material as u8);
        self.normal = raw.normal;
        (self.found_at, self.frame, self.fraction) = (pose, frame, fraction);
        self.pushed = false;
        let share = self.even_share();
        for (point, new) in self.points_mut().iter_mut().zip(raw.points()) {
            *point = Point {
                position: new.position,
                separation: new.separation,
                found: new.separation,
                impulse: 0.0,
                mean_force: 0.0,
                share,
                key: new.key,
            };
        }
    }

    /// Gives each point the impulse of the matching point of `old`: by key, else by position.
    ///
    /// The load of points that are gone is shared evenly among new ones: a shape that slides over triangles
    /// rests on other points from step to step, and would sink each time into the body that bore it.
    pub(crate) fn inherit(&mut self, old: ContactRef<'_>, MatchLimits { near, slides }: MatchLimits) {
        let moved = self.found_at.position - old.found_at.position;
        let past = moved - self.normal * self.normal.dot(moved);
        if past.length_squared() > slides * slides {
            // Sliding or rolling bodies have no lasting loads.
            (self.lasting_force, self.static_load) = (0.0, UNKNOWN_LOAD);
        } else {
            (self.lasting_force, self.rest, self.static_load) =
                (old.lasting_force, old.rest, old.static_load);
        }
        let (mut used, mut fresh) = (0u32, 0u32);
        for (k, point) in self.points_mut().iter_mut().enumerate() {
            let same = old.points.iter().position(|o| o.key == point.key);
            let same = same.filter(|i| used >> i & 1 == 0);
            if let Some(i) = same {
                used |= 1 << i;
                point.inherit(&old.points[i]);
            } else {
                fresh |= 1 << k;
            }
        }
        for (k, point) in self.points_mut().iter_mut().enumerate() {
            if fresh >> k & 1 == 0 {
                continue;
            }
            let close = (0..old.points.len())
                .filter(|i| used >> i & 1 == 0)
                .map(|i| (i, old.points[i].position.distance_squared(point.position)))
                .filter(|&(_, d)| d < near * near)
                .min_by(|x, y| x.1.total_cmp(&y.1));
            if let Some((i, _)) = close {
                used |= 1 << i;
                point.inherit(&old.points[i]);
                fresh &= !(1 << k);
            }
        }
        let mut rest = Point::default();
        for (_, point) in old.points.iter().enumerate().filter(|(i, _)| used >> i & 1 == 0) {
            rest.impulse += point.impulse;
            rest.mean_force += point.mean_force;
            rest.share += point.share;
        }
        let share = 1.0 / fresh.count_ones().max(1) as f32;
        for (_, point) in self.points_mut().iter_mut().enumerate().filter(|(k, _)| fresh >> k & 1 != 0) {
            point.impulse = rest.impulse * share;
            point.mean_force = rest.mean_force * share;
            point.share = rest.share * share;
        }
        self.share_all();
    }

    /// Lets the lasting force approach the load that statics expects, after a step of `dt` seconds whose last
    /// substep took `h`. Returns whether the contact bears a load that statics should examine.
    ///
    /// It never follows the load that is measured. If it followed a sway, the restoring force would lag
    /// behind it by `0.9 / (omega * LOAD_TIME)` and pump it, wherever several manifolds bear a body; and a
    /// wedged body would be squeezed ever more, since there the force itself is most of the measured load,
    /// until something slips, and so on for ever (docs/decisions/heaps.md).
    pub(crate) fn bear(&mut self, dt: f32, h: f32) -> bool {
        let load = self.as_ref().bears() / h;
        let most = load * (1.0 + LOAD_BAND);
        if self.lasting_force > most {
            // At once, or it would push.
            self.lasting_force = load;
        }
        let share = (dt / LOAD_TIME).min(1.0);
        self.lasting_force += (self.static_load.max(0.0).min(most) - self.lasting_force) * share;
        self.rest -= self.rest * share;
        load > 0.0 && self.is_unknown()
    }

    /// Begins the next step as if nothing had been borne.
    pub(crate) fn forget_loads(&mut self) {
        self.forget_weight();
        self.mean_friction = [0.0; 4];
        (self.friction, self.twist) = (Vec3::ZERO, 0.0);
        (self.rest, self.static_load) = (0.0, UNKNOWN_LOAD);
    }

    /// Begins the next step without load along the normal, which statics then estimates.
    pub(crate) fn forget_weight(&mut self) {
        let share = self.even_share();
        let forget = |point: &mut Point| (point.impulse, point.mean_force, point.share) = (0.0, 0.0, share);
        self.points_mut().iter_mut().for_each(forget);
        (self.lasting_force, self.static_load) = (0.0, CHANGED_LOAD);
    }

    /// Takes an estimate of the load of a contact that bears so much [N]. Within the `slop` [m] its bodies
    /// rest where they are now: lifting them would throw them. If its load was known before, they rest where
    /// they did: otherwise a tower that leans or sways while something is taken from it would lose the force
    /// that brings it back.
    ///
    /// A deeper contact is borne by its overlap, and a lasting force takes that over in time, if it is as
    /// much as statics says. If not it is wedged, lands, or was put there: with a lasting force beside its
    /// overlap it would be squeezed.
    pub(crate) fn expect(&mut self, load: f32, borne: f32, slop: f32) {
        let sum: f32 = self.as_ref().points.iter().map(|p| p.separation).sum();
        let depth = -sum / f32::from(self.count);
        if self.static_load == UNKNOWN_LOAD {
            self.rest = -depth.clamp(0.0, slop);
        }
        (self.lasting_force, self.static_load) = if depth <= slop {
            (load.max(borne), load)
        } else if (load - borne).abs() <= LOAD_BAND * borne {
            (0.0, load)
        } else {
            (0.0, 0.0)
        };
    }

    /// Lets the points share all of the lasting force: evenly, if statics did not say how.
    fn share_all(&mut self) {
        let even = self.even_share();
        let sum: f32 = self.as_ref().points.iter().map(|p| p.share).sum();
        let known = sum > 0.0 && !self.is_unknown();
        for point in self.points_mut() {
            point.share = if known { point.share / sum } else { even };
        }
    }

    /// Moves the points with the bodies, for a pair that hardly moved since its contact was found.
    #[inline(always)]
    pub(crate) fn follow(&mut self, now: &Relative, frame: Quat) {
        let separations = self.as_ref().separations(now);
        let turned = frame * self.frame.conjugate();
        if turned.xyz().length_squared() > 0.25 * KEPT_CONTACT_TURN * KEPT_CONTACT_TURN {
            self.frame = frame;
        }
        for (point, separation) in self.points_mut().iter_mut().zip(separations) {
            point.separation = separation;
        }
        self.pushed = false;
    }
}
