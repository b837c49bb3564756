//! A finely resolved run of a scene, and the errors of other runs relative to it.

use super::heap::Heap;
use super::run::{Frame, Run};
use super::track::{Track, beyond_start, lasting, rise, window};
use super::{Errors, Measure};
use crate::{LabWorld, WorldSolver};
use backstop::Error;
use backstop::Settings;
use backstop_scene::Scene;
use glam::DVec3;
use std::ops::Range;

/// Distance of a body between runs of the reference, in its width, up to which its path is compared: beyond
/// it the chaos of the scene would be measured.
const PARTED: f64 = 0.05;

/// Errors below this are meaningless, whatever the unit: velocities have the seven digits of `f32`.
const ROUNDING: f64 = f32::EPSILON as f64;

/// Bodies of the reference whose mean speed in the last frames is no greater, by [`super::run::pace`], rest.
const RESTS: f64 = 0.01;

/// Beyond the region of the reference no body is lost within this share of its diagonal and so many widths of
/// the widest body; below it, within one width.
const MARGIN: (f64, f64) = (0.25, 2.0);

/// Runs of a scene that are as fine as can be, how certain they are, and what of them other runs can be
/// compared with.
#[derive(Clone, Debug)]
pub struct Reference {
    fine: Track,
    /// The frames in which each body's path is compared: from its first motion until it parts.
    compared: Vec<Range<usize>>,
    /// Whether each body moves.
    moves: Vec<bool>,
    /// Whether it rests in the end, in all runs.
    rests: Vec<bool>,
    share: f64,
    heap: Heap,
    region: Region,
    uncertainty: Errors,
}

/// A box about all places of bodies of all runs, and what is above.
#[derive(Clone, Copy, Debug)]
struct Region {
    low: DVec3,
    high: DVec3,
    up: DVec3,
    floor: f64,
}

impl Region {
    fn of(members: &[Track]) -> Region {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (mut floor, mut widest, mut up) = (f64::INFINITY, 0.0_f64, DVec3::Y);
        for member in members {
            up = member.up.as_dvec3();
            widest = member.widths.iter().copied().fold(widest, f64::max);
            for (at, _) in member.frames.iter().flat_map(|frame| &frame.poses) {
                (low, high, floor) = (low.min(*at), high.max(*at), floor.min(at.dot(up)));
            }
        }
        let margin = DVec3::splat(MARGIN.0 * (high - low).length() + MARGIN.1 * widest);
        Region { low: low - margin, high: high + margin, up, floor: floor - widest }
    }

    fn has(&self, at: DVec3) -> bool {
        at.cmpge(self.low).all() && at.cmple(self.high).all() && at.dot(self.up) >= self.floor
    }
}

impl Reference {
    /// A reference from the runs of [`Track::member`], in their order, of the same scene and span.
    ///
    /// # Errors
    /// If there are less than two.
    pub fn new(members: Vec<Track>) -> Result<Reference, Error> {
        let [fine, half, ..] = &members[..] else {
            return Err(Error::Incomplete { what: "a reference", expected: "two runs at least" });
        };
        let (bodies, end) = (fine.widths.len(), fine.frames.len());
        let first: Vec<usize> = fine.first_moves();
        let moves: Vec<bool> = first.iter().map(|&first| first < end).collect();
        // If nothing moves, all bodies are compared.
        let all_rest = !moves.contains(&true);
        let compared: Vec<Range<usize>> = (0..bodies)
            .map(|body| {
                let start = if moves[body] { first[body].max(1) } else { 1 };
                start..parting(&members, body).max(start + 1).min(end)
            })
            .collect();
        let told = |body: &usize| all_rest || moves[*body];
        let count =
            |of: &dyn Fn(usize) -> usize| (0..bodies).filter(told).map(of).sum::<usize>().max(1) as f64;
        let share = count(&|body| compared[body].len()) / count(&|body| end - compared[body].start);
        let firsts: Vec<Vec<usize>> = members.iter().map(Track::first_moves).collect();
        let crowd = |body: &usize| firsts.iter().any(|first| all_rest || first[*body] < end);
        let heap = Heap::new(&members, (0..bodies).filter(crowd).collect());
        let rests =
            (0..bodies).map(|body| members.iter().all(|member| member.end_speed(body) <= RESTS)).collect();
        let region = Region::of(&members);
        let flaws = half.flaws;
        let half = half.clone();
        let fine = members.into_iter().next().unwrap_or_else(|| half.clone());
        let uncertainty = Errors::new([ROUNDING; Measure::ALL.len()]);
        let mut reference = Reference { fine, compared, moves, rests, share, heap, region, uncertainty };
        reference.uncertainty = reference.certain_to(&half, flaws);
        Ok(reference)
    }

    /// The errors of the run of half the resolution.
    fn certain_to(&self, half: &Track, flaws: [f64; 3]) -> Errors {
        let mut paths = Paths::new(self);
        let mut energy = 0.0;
        for (at, frame) in half.frames.iter().enumerate().skip(1) {
            paths.take(at, frame);
            energy += (frame.energy - self.fine.frames[at].energy).abs() / self.fine.scale;
        }
        let [trajectory, worst, rotation] = paths.errors();
        let deviation = paths.deviation;
        let mut values = [ROUNDING; Measure::ALL.len()];
        for (measure, value) in [
            (Measure::Trajectory, trajectory),
            (Measure::Worst, worst),
            (Measure::Rotation, rotation),
            (Measure::Energy, energy / (half.frames.len() - 1).max(1) as f64),
            (Measure::Overlap, flaws[0]),
            (Measure::Lasting, flaws[1]),
            (Measure::Opening, flaws[2]),
            (Measure::Deviation, deviation),
        ] {
            // Not `max`, which would hide NaN.
            if value > ROUNDING || value.is_nan() {
                values[measure as usize] = value;
            }
        }
        Errors::new(values)
    }

    /// The share of the run in which paths are compared: of all frames of all bodies, from the first motion
    /// of each to the end, those before its paths in the runs of the reference differ by a twentieth of its
    /// width.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// The errors of the run of half the resolution, or rounding if that is more: errors below these are
    /// meaningless.
    pub fn uncertainty(&self) -> &Errors {
        &self.uncertainty
    }

    /// Hash of the finest run, see [`Track::hash`].
    pub fn hash(&self) -> u64 {
        self.fine.hash()
    }

    /// Runs the scene with other settings and `hz` steps per second, and returns the errors of the run.
    ///
    /// # Errors
    /// If the world refuses the settings or the scene, or the rate is no multiple of the frame rate.
    pub fn measure(
        &self,
        scene: &Scene,
        settings: &Settings,
        solver: Option<WorldSolver>,
        hz: u32,
    ) -> Result<Errors, Error> {
        let (span, fine) = (self.fine.span, &self.fine);
        let mut run = Run::start(scene, (settings, solver), hz, span)?;
        let joined = run.narrowest_joined(&fine.widths)?;
        run.world.measure_accuracy(true);
        let mut worst = Worst::default();
        let (mut paths, mut energies) = (Paths::new(self), vec![fine.frames[0].energy]);
        let (mut heap, mut lost) = (Vec::new(), vec![false; fine.widths.len()]);
        let mut end_speeds = vec![0.0; fine.widths.len()];
        let tail = span.tail();
        for at in 1..=span.frames as usize {
            for _ in 0..run.steps_per_frame {
                run.world.step(run.dt)?;
                if let Some(accuracy) = run.world.accuracy() {
                    worst.take(&accuracy.whole);
                }
            }
            let frame = run.frame(&fine.widths)?;
            if !frame.is_finite() {
                return Ok(Errors::LOST);
            }
            paths.take(at, &frame);
            heap.push(self.heap.difference(at - 1, &frame));
            for (body, (at, _)) in frame.poses.iter().enumerate() {
                lost[body] |= !self.region.has(*at);
            }
            if tail.contains(&(at - 1)) {
                let share = 1.0 / tail.len() as f64;
                end_speeds.iter_mut().zip(&frame.speeds).for_each(|(sum, speed)| *sum += share * speed);
            }
            energies.push(frame.energy);
        }
        let energy = |(own, frame): (&f64, &Frame)| (own - frame.energy).abs() / fine.scale;
        let energy = energies.iter().zip(&fine.frames).skip(1).map(energy).sum::<f64>();
        let unrest = (0..end_speeds.len()).filter(|&body| self.rests[body]);
        let unrest = unrest.map(|body| end_speeds[body] / fine.paces[body]).fold(0.0, f64::max);
        let [trajectory, worst_body, rotation] = paths.errors();
        let overlaps = beyond_start(&worst.overlaps);
        Ok(Errors::new([
            trajectory,
            worst_body,
            rotation,
            worst.penetration,
            worst.residual / (f64::from(span.frames.max(1)) * f64::from(run.steps_per_frame)),
            worst.joint,
            energy / f64::from(span.frames.max(1)),
            lasting(&overlaps, 1),
            lasting(&overlaps, window(hz)),
            worst.joint / joined,
            rise(worst.balance.iter().copied()) / fine.scale,
            lost.iter().filter(|&&lost| lost).count() as f64,
            unrest,
            paths.deviation,
            Heap::error(&heap),
        ]))
    }
}

/// The first frame in which a body's path in some run of the reference differs from that of the run which it
/// is to be equal to: half the resolution from the finest, and perturbed ones from that.
fn parting(members: &[Track], body: usize) -> usize {
    let [fine, half, others @ ..] = members else { return 0 };
    let width = fine.widths[body];
    let near = |at: usize| {
        let of =
            |one: &Track, other: &Track| one.frames[at].apart(&other.frames[at], body, width)[0] <= PARTED;
        of(half, fine) && others.iter().all(|other| of(other, half))
    };
    (0..fine.frames.len()).find(|&at| !near(at)).unwrap_or(fine.frames.len())
}

/// The worst values of all steps.
#[derive(Default)]
struct Worst {
    penetration: f64,
    /// Of each step.
    overlaps: Vec<f64>,
    joint: f64,
    /// A sum.
    residual: f64,
    /// Energy that was gained without a cause, and that is stored in joints, after each step [J].
    balance: Vec<f64>,
    gained: f64,
}

impl Worst {
    fn take(&mut self, measures: &crate::Measures) {
        self.penetration = self.penetration.max(measures.penetration);
        self.overlaps.push(measures.penetration_share);
        self.joint = self.joint.max(measures.joint_length);
        self.residual += measures.residual.worst;
        self.gained += measures.gained();
        self.balance.push(self.gained + measures.stored);
    }
}

/// Differences of paths from the finest run.
struct Paths<'a> {
    reference: &'a Reference,
    /// Of each body: distances and angles.
    sums: Vec<[f64; 2]>,
    /// The greatest distance of any body in any frame.
    deviation: f64,
}

impl Paths<'_> {
    fn new(reference: &Reference) -> Paths<'_> {
        Paths { reference, sums: vec![[0.0; 2]; reference.compared.len()], deviation: 0.0 }
    }

    fn take(&mut self, at: usize, frame: &Frame) {
        let Reference { fine, compared, .. } = self.reference;
        for (body, sum) in self.sums.iter_mut().enumerate() {
            if compared[body].contains(&at) {
                let [distance, angle] = frame.apart(&fine.frames[at], body, fine.widths[body]);
                sum[0] += distance;
                sum[1] += angle;
                self.deviation = self.deviation.max(distance);
            }
        }
    }

    /// The mean distance of bodies that move, that of the worst body, moving or not, and the mean angle.
    fn errors(&self) -> [f64; 3] {
        let Reference { compared, moves, .. } = self.reference;
        let all_rest = !moves.contains(&true);
        let (mut mean, mut worst, mut frames) = ([0.0; 2], 0.0_f64, 0);
        for (body, sum) in self.sums.iter().enumerate() {
            let own = compared[body].len();
            if moves[body] || all_rest {
                mean = [mean[0] + sum[0], mean[1] + sum[1]];
                frames += own;
            }
            worst = worst.max(sum[0] / own.max(1) as f64);
        }
        let frames = frames.max(1) as f64;
        [mean[0] / frames, worst, mean[1] / frames]
    }
}
