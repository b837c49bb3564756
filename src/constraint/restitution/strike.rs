//! One impact: Newton's law along the normals and Coulomb's law of friction across them, as one problem.
//!
//! Away from the centre of a body, friction changes the speed along the normal and the normal impulse the
//! slip. Friction that comes after the normal impulses leaves another speed than Newton's law says. So each
//! point is a block of three rows, solved exactly, and Gauss-Seidel goes over the points. Friction opposes
//! the slip at the end of the impact (J. J. Moreau, *Unilateral contact and dry friction in finite freedom
//! dynamics*, 1988): within the circle of `mu` times the normal impulse it is the one that leaves least
//! energy.
//!
//! Newton's coefficient compares speeds, not energies: with friction it may give back more than there was (T.
//! R. Kane and D. A. Levinson, *Dynamics: Theory and Applications*, 1985). The plastic impact never does, and
//! the set of impulses that lose energy is convex: an impact that would gain some is drawn towards the
//! plastic one until it gains none.

use super::meet::{Bodies, add};
use super::{NONE, Spot, Struck};
use crate::body::{FreeTurn, Traits, is_uneven};
use crate::constraint::ImpactBody;
use crate::constraint::contact::batch::GONE;
use crate::forces::turned_inertia;
use crate::lanes::Record;
use crate::math::Quat;
use glam::{Vec2, Vec3};

/// Maximum number of points that are solved together: four manifolds.
const MAX_POINTS: usize = 16;
/// Maximum number of sweeps over them, and the share of the approach speed at which they end.
const SWEEPS: u32 = 64;
// Guard: where the sweeps over impacts end.
const EXACT: f32 = 1e-5;
/// Maximum number of steps to the normal impulse of a point with friction.
const ROOT_STEPS: u32 = 32;
/// Maximum number of Newton steps to the friction of a point that slips.
const SLIP_STEPS: u32 = 16;

/// A point in an impact.
#[derive(Clone, Copy, Debug, Default)]
struct Row {
    spot: usize,
    /// At the start [m/s].
    approach: f32,
    /// By how much unit impulses along the normal and along each axis of friction change the speed in the
    /// same direction [1/kg].
    ease: f32,
    ease_across: Vec2,
    /// By how much an impulse along the normal changes the speed along each axis, and the other way round
    /// [1/kg].
    ease_between: Vec2,
    /// Directions across the normal that do not act on each other.
    axes: [Vec3; 2],
    /// Along the normal, and along the axes [N s].
    impulse: f32,
    friction: Vec2,
}

/// An impact of two bodies, at all points where they touch.
pub(super) struct Impact<'a> {
    spots: &'a [Spot],
    rows: [Row; MAX_POINTS],
    count: usize,
}

impl<'a> Impact<'a> {
    pub(super) fn new(spots: &'a [Spot]) -> Impact<'a> {
        Impact { spots, rows: [Row::default(); MAX_POINTS], count: 0 }
    }

    /// Adds a point that approaches at a speed [m/s], if there is room and an impulse can stop it.
    pub(super) fn add(&mut self, spot: usize, approach: f32, moving: &[Moving; 2]) {
        let of = &self.spots[spot];
        let ease = of.normal.dot(answer(moving, of, of.normal));
        if self.count == MAX_POINTS || ease <= least_ease(moving) {
            return;
        }
        let mut row = Row { spot, approach, ease, ..Row::default() };
        if of.friction > 0.0 {
            (row.axes, row.ease_across) = axes(moving, of);
            let answer = answer(moving, of, of.normal);
            row.ease_between = row.axes.map(|axis| axis.dot(answer)).into();
        }
        self.rows[self.count] = row;
        self.count += 1;
    }

    /// The greatest approach speed of its points [m/s].
    pub(super) fn fastest(&self) -> f32 {
        self.rows().iter().fold(0.0, |most, row| most.max(row.approach))
    }

    /// The slot of the contact and the normal impulse of each point [N s].
    pub(super) fn impulses(&self) -> impl Iterator<Item = (u32, f32)> {
        self.rows().iter().map(|row| (self.spots[row.spot].slot, row.impulse))
    }

    /// Gives the bodies their velocities after the impact.
    pub(super) fn solve(&mut self, moving: &mut [Moving; 2], bodies: &Bodies<'_>) {
        let before = *moving;
        if !self.sweep(moving, bodies, 1.0) {
            // Only the fastest, and the others come next.
            let row = |i: usize| &self.rows[i];
            let target = |i: usize| self.spots[row(i).spot].restitution * row(i).approach;
            let fastest = (1..self.count).fold(0, |k, i| if target(i) > target(k) { i } else { k });
            (self.rows[0], self.count) = (*row(fastest), 1);
            *moving = before;
            self.sweep(moving, bodies, 1.0);
        }
        let gain = self.work(self.rows(), [&before, moving], bodies);
        if gain > EXACT * self.fastest().powi(2) / self.rows[0].ease {
            self.draw_back(moving, &before, bodies, gain);
        }
    }

    fn rows(&self) -> &[Row] {
        &self.rows[..self.count]
    }

    /// Solves all points together for a share of their restitution. Returns whether the solution is exact: an
    /// approximate one removes or adds energy.
    fn sweep(&mut self, moving: &mut [Moving; 2], bodies: &Bodies<'_>, share: f32) -> bool {
        let exact = self.fastest() * EXACT;
        for row in &mut self.rows[..self.count] {
            (row.impulse, row.friction) = (0.0, Vec2::ZERO);
        }
        for _ in 0..SWEEPS {
            let mut worst = 0.0_f32;
            for row in &mut self.rows[..self.count] {
                let spot = &self.spots[row.spot];
                let slip = spot.slip(|body| velocity(moving, bodies, body));
                let lack = share * spot.restitution * row.approach - spot.normal.dot(slip);
                let change = row.solve(lack, slip, spot.friction);
                worst = worst.max(change[0].abs() * row.ease);
                worst = worst.max((Vec2::new(change[1], change[2]) * row.ease_across).abs().max_element());
                let [along, x, y] = change;
                push(moving, spot, spot.normal * along + row.axes[0] * x + row.axes[1] * y);
            }
            if worst <= exact {
                return true;
            }
        }
        false
    }

    /// The work of impulses over two moments: with those before and after the impact, the energy that it
    /// adds [J].
    fn work(&self, rows: &[Row], [from, to]: [&[Moving; 2]; 2], bodies: &Bodies<'_>) -> f32 {
        let mut sum = 0.0;
        for row in rows {
            let spot = &self.spots[row.spot];
            let impulse = row.impulse_at(spot);
            for moment in [from, to] {
                sum += 0.5 * impulse.dot(spot.slip(|body| velocity(moment, bodies, body)));
            }
        }
        sum
    }

    /// Goes from the plastic impact towards the one that gains energy, as far as none is gained.
    #[cold]
    fn draw_back(&mut self, moving: &mut [Moving; 2], before: &[Moving; 2], bodies: &Bodies<'_>, gain: f32) {
        let full = self.rows;
        *moving = *before;
        self.sweep(moving, bodies, 0.0);
        let mut way = full;
        for (way, row) in way.iter_mut().zip(&self.rows) {
            way.impulse -= row.impulse;
            way.friction -= row.friction;
        }
        // The energy along the way is a parabola.
        let least = self.work(self.rows(), [before, moving], bodies);
        let slope = self.work(&way[..self.count], [moving, moving], bodies);
        let bend = gain - least - slope;
        let root = (slope * slope - 4.0 * bend * least).max(0.0).sqrt();
        let share = if least < 0.0 { -2.0 * least / (slope + root) } else { 0.0 };
        let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
        for (row, way) in self.rows[..self.count].iter_mut().zip(&way) {
            let spot = &self.spots[row.spot];
            push(moving, spot, way.impulse_at(spot) * share);
            row.impulse += way.impulse * share;
            row.friction += way.friction * share;
        }
    }
}

impl Row {
    /// Solves the rows of the point together, all else as it is. Returns the change of its impulses, along
    /// the normal and the axes [N s].
    ///
    /// `lack`: how much faster the surfaces are to part, and `slip`: how fast they move on each other [m/s].
    fn solve(&mut self, lack: f32, slip: Vec3, coefficient: f32) -> [f32; 3] {
        let old = (self.impulse, self.friction);
        let slip = Vec2::from(self.axes.map(|axis| axis.dot(slip)));
        // Without impulses of this point.
        let lack = lack + self.ease * old.0 + self.ease_between.dot(old.1);
        let slip = slip - self.ease_between * old.0 - self.ease_across * old.1;
        let friction =
            |along: f32| friction(slip + self.ease_between * along, self.ease_across, coefficient * along);
        let mut along = (lack / self.ease).max(0.0);
        let mut across = friction(along);
        // Where friction acts along the normal too, false position encloses the root: without an impulse the
        // speed is too low, and with a large one, at which the point sticks, too high.
        let (mut low, mut high, mut was_low) = ((0.0, -lack), None::<(f32, f32)>, None);
        for _ in 0..ROOT_STEPS {
            let over = self.ease * along + self.ease_between.dot(across) - lack;
            if along == 0.0 || over.abs() <= EXACT * lack {
                break;
            }
            let is_low = over < 0.0;
            // An end that stays twice counts half (the Illinois method).
            let weight = if was_low == Some(is_low) { 0.5 } else { 1.0 };
            match (is_low, &mut high) {
                (false, _) => (high, low.1) = (Some((along, over)), low.1 * weight),
                (true, Some(high)) => (low, high.1) = ((along, over), high.1 * weight),
                (true, None) => low = (along, over),
            }
            was_low = Some(is_low);
            along = match high {
                Some(high) => low.0 - low.1 * (high.0 - low.0) / (high.1 - low.1),
                None => 2.0 * along,
            };
            across = friction(along);
        }
        (self.impulse, self.friction) = (along, across);
        [along - old.0, across.x - old.1.x, across.y - old.1.y]
    }

    fn impulse_at(&self, spot: &Spot) -> Vec3 {
        spot.normal * self.impulse + self.axes[0] * self.friction.x + self.axes[1] * self.friction.y
    }
}

/// The friction that minimizes energy within a circle: it stops the slip, or opposes the remaining slip.
///
/// `free`: slip without it [m/s]; `ease`: by how much unit impulses change that, by axis [1/kg].
fn friction(free: Vec2, ease: Vec2, most: f32) -> Vec2 {
    let at = |slack: f32| -free / (ease + slack);
    let stops = at(0.0);
    if most <= 0.0 || stops.length() <= most {
        return if most > 0.0 { stops } else { Vec2::ZERO };
    }
    // The remaining slip is `slack` times the friction, against it. Newton's method on the inverse of the
    // length, which is almost a line (J. J. Moré and D. C. Sorensen, *Computing a trust region step*, 1983).
    let mut slack = 0.0_f32;
    for _ in 0..SLIP_STEPS {
        let now = at(slack);
        let length = now.length();
        let step = (length / most - 1.0) * length * length / (now * now / (ease + slack)).element_sum();
        slack += step;
        if step.abs() <= slack * f32::EPSILON {
            break;
        }
    }
    at(slack).clamp_length_max(most)
}

/// The directions across the normal of a point whose impulses do not act on each other, and by how much
/// each acts on itself [1/kg].
fn axes(moving: &[Moving; 2], spot: &Spot) -> ([Vec3; 2], Vec2) {
    let (x, y) = spot.normal.any_orthonormal_pair();
    let (by_x, by_y) = (answer(moving, spot, x), answer(moving, spot, y));
    let (mean, half) = (0.5 * (by_x.dot(x) + by_y.dot(y)), 0.5 * (by_x.dot(x) - by_y.dot(y)));
    let across = by_x.dot(y);
    let size = (half * half + across * across).sqrt();
    // The direction of the greater, by half of the angle of (half, across).
    let first = if half >= 0.0 { x * (size + half) + y * across } else { x * across + y * (size - half) };
    let first = first.try_normalize().unwrap_or(x);
    let least = least_ease(moving);
    ([first, spot.normal.cross(first)], Vec2::new(mean + size, mean - size).max(Vec2::splat(least)))
}

/// A body in an impact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moving {
    pub(super) body: u32,
    /// At the time of the impact; at rest if there is no body.
    own: ImpactBody,
    before: Record,
    /// Inverse mass, regardless of locked axes [1/kg].
    whole: f32,
    /// If its principal moments differ.
    pub(super) rotation: Option<Quat>,
}

impl Moving {
    pub(super) fn new(bodies: &Bodies<'_>, body: u32, struck: Option<&Struck>, time: f32) -> Moving {
        let i = body as usize;
        let Some(&inverse_inertia) = bodies.inverse_inertia.get(i) else {
            let (own, before) = Default::default();
            return Moving { body: NONE, own, before, whole: 0.0, rotation: None };
        };
        let mut before = bodies.velocity_at(i, time);
        add(&mut before, &struck.map_or(Record::default(), |struck| struck.velocity_after), 1.0);
        let (mut velocity, mut inverse_inertia, mut rotation) = (before, inverse_inertia, None);
        let mass = &bodies.mass[i];
        if is_uneven(mass, &bodies.traits[i]) {
            // Inertia and spin are those at the time of the impact.
            let (from, since) = struck.and_then(|s| s.turned).unwrap_or((bodies.pose[i].rotation, 0.0));
            let since = if struck.is_some_and(|s| s.stands) { bodies.done + time } else { since };
            let time = bodies.done + time - since;
            let turn = FreeTurn { rotation: from, spin: velocity.angular, inertia: mass.inertia, time };
            let (to, spin) = turn.one();
            (velocity.angular, inverse_inertia, rotation) = (spin, turned_inertia(to, mass), Some(to));
        }
        let inverse_mass = bodies.traits[i].free(Vec3::splat(mass.inverse));
        let own = ImpactBody { velocity, inverse_mass, inverse_inertia };
        Moving { body, own, before, whole: mass.inverse, rotation }
    }

    /// Change of its velocity.
    pub(super) fn change(&self, traits: &Traits) -> Record {
        let mut change = self.own.velocity;
        add(&mut change, &self.before, -1.0);
        traits.lock(&mut change);
        change
    }
}

/// The velocity of any body in an impact.
pub(super) fn velocity(moving: &[Moving; 2], bodies: &Bodies<'_>, body: usize) -> Record {
    match moving.iter().find(|moving| moving.body as usize == body) {
        Some(moving) => moving.own.velocity,
        // It is neither pushed nor accelerated.
        None => bodies.velocity.get(body).copied().unwrap_or_default(),
    }
}

/// By how much a unit impulse changes the velocity of a point [1/kg].
fn answer(moving: &[Moving; 2], spot: &Spot, impulse: Vec3) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for moving in moving {
        for (body, arm) in spot.bodies.into_iter().zip(spot.arms) {
            if body == moving.body {
                let turned = moving.own.turned(arm.cross(impulse));
                sum += impulse * moving.own.inverse_mass + turned.cross(arm);
            }
        }
    }
    sum
}

/// A smaller response is rounding: axes are locked, and nothing moves along the direction [1/kg].
fn least_ease(moving: &[Moving; 2]) -> f32 {
    moving.iter().map(|moving| moving.whole).sum::<f32>() * GONE
}

/// Applies an impulse to the second body of a point, and its opposite to the first.
fn push(moving: &mut [Moving; 2], spot: &Spot, impulse: Vec3) {
    for moving in moving {
        for (side, impulse) in [-impulse, impulse].into_iter().enumerate() {
            if spot.bodies[side] == moving.body {
                moving.own.push(spot.arms[side], impulse);
            }
        }
    }
}
