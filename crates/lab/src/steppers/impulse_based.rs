//! Every contact is a train of collisions (Mirtich and Canny, *Impulse-based simulation of rigid bodies*,
//! 1995).
//!
//! Between collisions bodies fly freely. The point that closes first collides, alone: its impulse grows until
//! it separates at the speed of restitution, and friction acts against the present slip or stops it (Routh
//! 1860; Keller 1986). A resting contact is a train of micro-collisions, which separate fast enough for no
//! more than [`HOPS`] hops a step. Colliding, resting, sliding and rolling are then treated alike, but a
//! stack causes a great many events: once there have been as many as iterations are allowed, the rest of the
//! step is left to sequential impulses.
//!
//! Where points of two bodies meet at one time, as those of a box that falls flat do, one collides after the
//! other, and the box turns. [`Order::Together`] lets them collide at once, by Newton's law.
//!
//! Bodies end where they flew, so overlap does not grow, but existing overlap stays.
//!
//! It supports no joints: an island with joints is left to the fast path.

use super::blocks::Block;
use super::moving::Moving;
use super::sequential::{give, resolution, settle};
use super::step::{Resolution, Step};
use crate::methods::{Effort, Order, Status, gs_cone};
use crate::problem::{Law, Matrix, Problem};
use crate::system::with_points;
use crate::system::{System, SystemIsland};

/// Hops of a point at rest in a step.
const HOPS: f64 = 4.0;
/// Share of a step within which points meet at one time.
const AT_ONCE: f64 = 0.01;
/// Parts of a collision over which its slip is followed.
const PARTS: u32 = 64;

/// Treats every contact as a train of collisions with friction, in the order of time. Islands with joints or
/// with rolling or spinning friction are refused ([`Status::NoSolution`]).
pub fn impulse_based(step: &Step<'_>, effort: &Effort) -> Resolution {
    let (points, of) = with_points(step.system, step.island);
    let mut moving = Moving::new(&points, |body| body.start);
    let mut impulses = vec![0.0; points.rows.len()];
    let island = SystemIsland { laws: (0..points.laws.len()).collect(), bodies: step.island.bodies.clone() };
    let flight = Flight::new(&points, effort.order == Order::Together);
    let (events, left) = flight.fly(&mut moving, &mut impulses, effort.iterations);
    if left > 0.0 {
        let way = moving.way.clone();
        moving.fly(left);
        let blocks = Block::all(&points, &island);
        let own = Step { system: &points, island: &island, ..*step };
        let held = impulses.clone();
        let effort = Effort { iterations: 100, ..effort.clone() };
        settle(&own, &mut moving, &blocks, &effort, &mut impulses, &held);
        for ((to, from), velocity) in moving.way.iter_mut().zip(way).zip(&moving.velocity) {
            *to = [0, 1].map(|k| from[k] + velocity[k] * left);
        }
    }
    let mut all = vec![0.0; step.system.rows.len()];
    for (law, &(normal, friction)) in points.laws.iter().zip(&of) {
        all[normal] += impulses[law.first];
        for k in 0..2 {
            if let (Some(friction), Law::Contact { .. }) = (friction, law.law) {
                all[friction + k] += impulses[law.first + 1 + k];
            }
        }
    }
    let mut found = resolution(step, &moving, &all, events);
    let mean = |&i: &usize| moving.way[i].map(|way| way / step.system.dt);
    found.moving = Some(step.island.bodies.iter().map(mean).collect());
    let system = step.system;
    let unknown = |&i: &usize| {
        let law = &system.laws[i];
        (i >= system.contacts && law.gap.is_none()) || law.resists
    };
    if step.island.laws.iter().any(unknown) {
        found.solution.status = Status::NoSolution;
    }
    found
}

/// Points in flight.
struct Flight<'a> {
    points: &'a System,
    /// Acceleration of each normal by gravity and forces [m/s²].
    fall: Vec<f64>,
    /// Whether points of two bodies that meet at one time collide at once.
    together: bool,
}

impl Flight<'_> {
    fn new(points: &System, together: bool) -> Flight<'_> {
        let fall = points.laws.iter().map(|law| {
            let row = &points.rows[law.first];
            (points.speed(row, |body| body.free) - points.speed(row, |body| body.start)) / points.dt
        });
        Flight { points, fall: fall.collect(), together }
    }

    /// Lets points collide in the order of time. Returns the number of collisions, and the rest of the step
    /// when there were too many [s].
    fn fly(&self, moving: &mut Moving<'_>, impulses: &mut [f64], most: u32) -> (u32, f64) {
        let laws = &self.points.laws;
        let mut gaps: Vec<f64> = laws.iter().map(|law| law.gap.unwrap_or(f64::INFINITY).max(0.0)).collect();
        let mut left = self.points.dt;
        for event in 0..most {
            let next = (0..laws.len())
                .map(|i| (arrival(gaps[i], moving.speed(laws[i].first), self.fall[i]), i))
                .fold((f64::INFINITY, 0), |best, one| if one.0 < best.0 { one } else { best });
            let time = next.0.min(left);
            for (i, gap) in gaps.iter_mut().enumerate() {
                let way = moving.speed(laws[i].first) * time + 0.5 * self.fall[i] * time * time;
                *gap = (*gap + way).max(0.0);
            }
            moving.fly(time);
            left -= time;
            if next.0 > time || left <= 0.0 {
                return (event, 0.0);
            }
            gaps[next.1] = 0.0;
            if self.together {
                self.collide_together(next.1, &mut gaps, moving, impulses);
            } else {
                self.collide(next.1, moving, impulses);
            }
        }
        (most, left)
    }

    /// The speeds at which a point separates that arrives with this one: of a hop, and by restitution. Bodies
    /// on each other fall alike between collisions, so the hop is that of the fastest fall of all points: by
    /// their own they would not part, and collide without end.
    fn parting(&self, i: usize, speed: f64) -> [f64; 2] {
        let fall = self.fall.iter().fold(0.0, |most: f64, fall| most.max(fall.abs()));
        let hop = fall * self.points.dt / (2.0 * HOPS);
        let bounces = -speed > self.points.threshold;
        [hop, if bounces { self.points.laws[i].restitution * -speed } else { 0.0 }]
    }

    /// A point collides, with all points of its bodies that meet at this time.
    fn collide_together(&self, i: usize, gaps: &mut [f64], moving: &mut Moving<'_>, impulses: &mut [f64]) {
        let laws = &self.points.laws;
        let soon = AT_ONCE * self.points.dt;
        let meets = |&k: &usize| {
            let arrives = arrival(gaps[k], moving.speed(laws[k].first), self.fall[k]) <= soon;
            laws[k].owner == laws[i].owner && laws[k].gap.is_some() && (gaps[k] <= 0.0 || arrives)
        };
        let at_once: Vec<usize> = (0..laws.len()).filter(meets).collect();
        let offset = |&k: &usize| {
            let speed = moving.speed(laws[k].first);
            // One at rest hops, or it would arrive again at once.
            if speed <= 0.0 { -self.parting(k, speed).into_iter().fold(0.0, f64::max) } else { 0.0 }
        };
        let offsets: Vec<f64> = at_once.iter().map(offset).collect();
        give(moving, &at_once, |_| 0.0, &offsets, impulses);
        at_once.into_iter().for_each(|k| gaps[k] = 0.0);
    }

    /// One point collides.
    fn collide(&self, i: usize, moving: &mut Moving<'_>, impulses: &mut [f64]) {
        let law = &self.points.laws[i];
        let rows: Vec<usize> = (law.first..law.first + law.law.rows()).collect();
        let speed = moving.speed(law.first);
        let [hop, bounce] = self.parting(i, speed);
        let mobility = |a: usize, b: usize| moving.coupling(&self.points.rows[a], &self.points.rows[b]);
        let mut k = [[0.0; 3]; 3];
        for (a, &row) in rows.iter().enumerate() {
            for (b, &other) in rows.iter().enumerate() {
                k[a][b] = mobility(row, other);
            }
        }
        let mut u = [0.0; 3];
        rows.iter().zip(&mut u).for_each(|(&row, u)| *u = moving.speed(row));
        let p = match law.law {
            Law::Contact { mu } if bounce > hop => keller(k, u, mu, bounce / -speed),
            law => stop(law, &k, u, bounce.max(hop)),
        };
        for (&row, p) in rows.iter().zip(p) {
            moving.push(row, p);
            impulses[row] += p;
        }
    }
}

/// The time at which a gap closes [s], by its size [m], speed and acceleration.
fn arrival(gap: f64, speed: f64, fall: f64) -> f64 {
    if gap <= 0.0 && speed < 0.0 {
        return 0.0;
    }
    // The first positive root of gap + speed t + fall t² / 2.
    let root = speed * speed - 2.0 * fall * gap;
    if root < 0.0 {
        return f64::INFINITY;
    }
    let time = if fall < 0.0 {
        (speed + root.sqrt()) / -fall
    } else if speed < 0.0 {
        2.0 * gap / (-speed + root.sqrt())
    } else {
        f64::INFINITY
    };
    // A resting point neither falls nor flies.
    time.max(0.0)
}

/// Impulse of a collision with restitution by Poisson's law, along which the slip is followed. `k`: how
/// velocities change per impulse, normal first.
fn keller(k: [[f64; 3]; 3], mut u: [f64; 3], mu: f64, restitution: f64) -> [f64; 3] {
    let mut p = [0.0; 3];
    let mut part = -u[0] / k[0][0] / f64::from(PARTS);
    let mut compressed = None;
    // Friction may prolong compression, but not without end unless it wedges.
    for _ in 0..40 * PARTS {
        let dp = along(&k, &u, mu, part);
        let gain: f64 = (0..3).map(|j| k[0][j] * dp[j]).sum();
        let mut share = 1.0;
        match compressed {
            // This part ends with the compression.
            None if u[0] + gain >= 0.0 => share = if gain > 0.0 { (-u[0] / gain).max(0.0) } else { 1.0 },
            Some(most) if p[0] + dp[0] >= most => share = ((most - p[0]) / dp[0]).max(0.0),
            _ => {}
        }
        for i in 0..3 {
            p[i] += share * dp[i];
            u[i] += share * (0..3).map(|j| k[i][j] * dp[j]).sum::<f64>();
        }
        match compressed {
            None if u[0] >= -1e-15 => {
                compressed = Some((1.0 + restitution) * p[0]);
                part = restitution * p[0] / f64::from(PARTS);
                if part <= 0.0 {
                    break;
                }
            }
            Some(most) if p[0] >= most * (1.0 - 1e-12) => break,
            _ => {}
        }
    }
    p
}

/// An impulse with the normal part `part`, and friction against the slip or enough to stop it.
fn along(k: &[[f64; 3]; 3], u: &[f64; 3], mu: f64, part: f64) -> [f64; 3] {
    // Friction that stops the slip at the end of this part.
    let slip = [1, 2].map(|i| u[i] + k[i][0] * part);
    let det = k[1][1] * k[2][2] - k[1][2] * k[2][1];
    let hold =
        [(-slip[0] * k[2][2] + slip[1] * k[1][2]) / det, (-slip[1] * k[1][1] + slip[0] * k[2][1]) / det];
    let (size, most) = (hold[0].hypot(hold[1]), mu * part);
    if size <= most {
        return [part, hold[0], hold[1]];
    }
    let speed = u[1].hypot(u[2]);
    // If there is no slip yet, friction opposes the direction in which it would begin.
    let against = if speed > 1e-12 { [-u[1] / speed, -u[2] / speed] } else { hold.map(|x| x / size) };
    [part, most * against[0], most * against[1]]
}

/// Impulse after which the point separates at a given speed, with friction as for a stop.
fn stop(law: Law, k: &[[f64; 3]; 3], u: [f64; 3], part: f64) -> [f64; 3] {
    let rows = law.rows();
    let entries = (0..rows).flat_map(|i| (0..rows).map(move |j| (i, j)));
    let w = Matrix::from_entries(rows, entries.map(|(i, j)| (i, j, k[i][j])));
    let mut q = u[..rows].to_vec();
    q[0] -= part;
    let mut p = [0.0; 3];
    if let Ok(problem) = Problem::new(vec![law], w, q) {
        let found = gs_cone(&problem, &Effort { tolerance: 1e-12, iterations: 100, ..Effort::default() });
        p[..rows].copy_from_slice(&found.r);
    }
    p
}
