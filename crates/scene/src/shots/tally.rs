//! Counts over many shots.

use super::body::SHAPES;
use super::shot::{Flight, Flights, GAIN, MODES, Outcome, Shot};
use super::target::TARGETS;

/// Shots, and how many got through (or were lost) under each of [`MODES`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Through {
    /// How many were run.
    pub shots: u64,
    /// With the guard.
    pub guarded: [u64; 3],
    /// Without the guard.
    pub unguarded: [u64; 3],
}

impl Through {
    /// Counts one more shot, by whether it got through.
    pub fn add(&mut self, guarded: [bool; 3], unguarded: [bool; 3]) {
        self.shots += 1;
        for mode in 0..MODES.len() {
            self.guarded[mode] += u64::from(guarded[mode]);
            self.unguarded[mode] += u64::from(unguarded[mode]);
        }
    }

    /// Adds what was counted elsewhere.
    pub fn merge(&mut self, other: &Through) {
        self.shots += other.shots;
        sum(&mut self.guarded, &other.guarded);
        sum(&mut self.unguarded, &other.unguarded);
    }
}

fn sum(own: &mut [u64; 3], of: &[u64; 3]) {
    own.iter_mut().zip(of).for_each(|(a, b)| *a += b);
}

/// Shots at static targets, and their outcomes under each of [`MODES`].
#[derive(Clone, Debug, Default)]
pub struct Count {
    /// How many got through.
    pub through: Through,
    /// How deep those that stayed on their side were.
    pub depths: [Depths; 3],
    /// How many the guard cut, and how many it lifted, at least once each.
    pub cut: [u64; 3],
    /// See `cut`.
    pub lifted: [u64; 3],
    /// How many were settled at least once.
    pub settled: [u64; 3],
    /// How many gained energy: more than [`GAIN`] of their own.
    pub gained: [u64; 3],
}

/// Depths of shots that met their target and stayed on its right side.
#[derive(Clone, Debug, Default)]
pub struct Depths {
    /// The deepest point of each shot after any step [m], and the same as a share of the body's smallest half
    /// width.
    deepest: Vec<(f32, f32)>,
    /// How many were too deep after the step of the impact ([`Flight::is_over`]).
    pub over: u64,
    /// How many stayed deep ([`Flight::is_stuck`]).
    pub stuck: u64,
}

/// Median, 99th of a hundred, and worst.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quantiles {
    /// Half are no deeper.
    pub median: f32,
    /// 99 % are no deeper.
    pub p99: f32,
    /// None is deeper.
    pub worst: f32,
}

impl Quantiles {
    fn of(mut all: Vec<f32>) -> Quantiles {
        all.sort_by(f32::total_cmp);
        let at = |share: f64| {
            let rank = (share * all.len() as f64).ceil() as usize;
            all.get(rank.saturating_sub(1)).copied().unwrap_or(0.0)
        };
        Quantiles { median: at(0.5), p99: at(0.99), worst: at(1.0) }
    }
}

impl Depths {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.deepest.len()
    }

    /// Deepest points after any step [m].
    pub fn metres(&self) -> Quantiles {
        Quantiles::of(self.deepest.iter().map(|one| one.0).collect())
    }

    /// The same as shares of the body's smallest half width.
    pub fn shares(&self) -> Quantiles {
        Quantiles::of(self.deepest.iter().map(|one| one.1).collect())
    }

    fn add(&mut self, flight: &Flight) {
        if flight.met && flight.outcome == Outcome::Kept {
            self.deepest.push((flight.depth, flight.depth / flight.half_width.max(f32::MIN_POSITIVE)));
            self.over += u64::from(flight.is_over());
            self.stuck += u64::from(flight.is_stuck());
        }
    }

    fn merge(&mut self, other: &Depths) {
        self.deepest.extend_from_slice(&other.deepest);
        (self.over, self.stuck) = (self.over + other.over, self.stuck + other.stuck);
    }
}

impl Count {
    /// Counts one more shot.
    pub fn add(&mut self, flights: &Flights) {
        let passed = |outcome: Outcome| outcome != Outcome::Kept;
        self.through.add(flights.guarded.map(|flight| passed(flight.outcome)), flights.unguarded.map(passed));
        for (mode, flight) in flights.guarded.iter().enumerate() {
            self.cut[mode] += u64::from(flight.cut);
            self.lifted[mode] += u64::from(flight.lifted);
            self.settled[mode] += u64::from(flight.settled);
            self.gained[mode] += u64::from(flight.gained > GAIN);
            self.depths[mode].add(flight);
        }
    }

    /// Adds what was counted elsewhere.
    pub fn merge(&mut self, other: &Count) {
        self.through.merge(&other.through);
        sum(&mut self.cut, &other.cut);
        sum(&mut self.lifted, &other.lifted);
        sum(&mut self.settled, &other.settled);
        sum(&mut self.gained, &other.gained);
        self.depths.iter_mut().zip(&other.depths).for_each(|(a, b)| a.merge(b));
    }
}

/// Counts in all, by shape and by target.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// In all.
    pub all: Count,
    /// In the order of [`SHAPES`].
    pub by_shape: [Count; SHAPES.len()],
    /// In the order of [`TARGETS`].
    pub by_target: [Count; TARGETS.len()],
}

impl Tally {
    /// Counts one more shot.
    pub fn add(&mut self, shot: &Shot, flights: &Flights) {
        self.all.add(flights);
        self.by_shape[shot.shape].add(flights);
        self.by_target[shot.target].add(flights);
    }

    /// Adds what was counted elsewhere.
    #[must_use]
    pub fn merge(mut self, other: &Tally) -> Tally {
        self.all.merge(&other.all);
        self.by_shape.iter_mut().zip(&other.by_shape).for_each(|(a, b)| a.merge(b));
        self.by_target.iter_mut().zip(&other.by_target).for_each(|(a, b)| a.merge(b));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_ranks() {
        let all = |n: u32| (1..=n).rev().map(|x| x as f32).collect();
        assert_eq!(Quantiles::of(all(100)), Quantiles { median: 50.0, p99: 99.0, worst: 100.0 });
        assert_eq!(Quantiles::of(all(1)), Quantiles { median: 1.0, p99: 1.0, worst: 1.0 });
        assert_eq!(Quantiles::of(Vec::new()), Quantiles::default());
    }
}
