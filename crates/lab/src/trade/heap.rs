//! Statistics of where bodies are, for runs whose paths can't be compared.

use super::run::Frame;
use super::track::Track;
use glam::DVec3;

/// Differences that count as one: a quarter of a body's width,
const LENGTH: f64 = 0.25;
/// a tenth of the greatest kinetic energy,
const ENERGY: f64 = 0.1;
/// beyond so many standard deviations of the reference's runs.
const DEVIATIONS: f64 = 3.0;
/// The heap's height is that above which one body in ten lies.
const TOP: f64 = 0.9;
/// The time is divided into so many parts, of which the worst counts.
const PARTS: usize = 4;

/// Centroid, spread (root mean square distance from it), height and energy, each by the difference that
/// counts as one.
type Statistics = [f64; 6];

/// The statistics of the runs of a reference, frame by frame.
#[derive(Clone, Debug)]
pub(super) struct Heap {
    /// Bodies that move in any of the runs.
    bodies: Vec<usize>,
    length: f64,
    energy: f64,
    up: DVec3,
    /// Mean, and standard deviation.
    frames: Vec<[Statistics; 2]>,
}

impl Heap {
    pub(super) fn new(members: &[Track], bodies: Vec<usize>) -> Heap {
        let Some(fine) = members.first() else {
            return Heap { bodies, length: 1.0, energy: 1.0, up: DVec3::Y, frames: Vec::new() };
        };
        let width = bodies.iter().map(|&body| fine.widths[body]).sum::<f64>() / bodies.len().max(1) as f64;
        let (length, energy) = (LENGTH * width, ENERGY * fine.scale);
        let mut heap = Heap { bodies, length, energy, up: fine.up.as_dvec3(), frames: Vec::new() };
        for at in 1..fine.frames.len() {
            let all: Vec<Statistics> = members.iter().map(|one| heap.statistics(&one.frames[at])).collect();
            let count = all.len() as f64;
            let mean: Statistics = std::array::from_fn(|i| all.iter().map(|one| one[i]).sum::<f64>() / count);
            let deviation = std::array::from_fn(|i| {
                let squares: f64 = all.iter().map(|one| (one[i] - mean[i]).powi(2)).sum();
                (squares / (count - 1.0).max(1.0)).sqrt()
            });
            heap.frames.push([mean, deviation]);
        }
        heap
    }

    fn statistics(&self, frame: &Frame) -> Statistics {
        let count = self.bodies.len().max(1) as f64;
        let places = || self.bodies.iter().map(|&body| frame.poses[body].0);
        let centroid = places().sum::<DVec3>() / count;
        let spread = (places().map(|at| at.distance_squared(centroid)).sum::<f64>() / count).sqrt();
        let mut heights: Vec<f64> = places().map(|at| at.dot(self.up)).collect();
        heights.sort_by(f64::total_cmp);
        let top = (TOP * count).ceil() as usize;
        let height = heights.get(top.saturating_sub(1)).copied().unwrap_or(0.0);
        let [x, y, z] = (centroid / self.length).to_array();
        [x, y, z, spread / self.length, height / self.length, frame.energy / self.energy]
    }

    /// The difference of each statistic, by what a run may differ: one, and three standard deviations of the
    /// reference's runs.
    pub(super) fn difference(&self, at: usize, frame: &Frame) -> Statistics {
        let (found, [mean, deviation]) = (self.statistics(frame), &self.frames[at]);
        std::array::from_fn(|i| (found[i] - mean[i]).abs() / (1.0 + DEVIATIONS * deviation[i]))
    }

    /// The error of a run: the greatest mean difference of any statistic in any part of the time.
    pub(super) fn error(differences: &[Statistics]) -> f64 {
        let part = differences.len().div_ceil(PARTS).max(1);
        let mean =
            |part: &[Statistics], i: usize| part.iter().map(|one| one[i]).sum::<f64>() / part.len() as f64;
        let worst = |part: &[Statistics]| (0..6).map(|i| mean(part, i)).fold(0.0, f64::max);
        differences.chunks(part).map(worst).fold(0.0, f64::max)
    }
}
