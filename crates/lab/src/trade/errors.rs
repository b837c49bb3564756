//! The errors of a run.

/// A measure of a run's error. Zero is exact for each.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "lowercase")]
pub enum Measure {
    /// Distance of centres of mass from the reference, relative to the width of each body: the mean over
    /// bodies that move in it and over the time in which the path of each can be compared.
    #[default]
    Trajectory,
    /// The same of the worst body, moving or at rest: the mean over its time.
    Worst,
    /// Angle between rotations and those of the reference [rad]: the mean as of trajectories.
    Rotation,
    /// The deepest overlap of the whole run [m].
    Penetration,
    /// The error of the worst law [m/s]: the mean over all steps.
    Residual,
    /// The greatest error of rigid directions of joints in the whole run [m].
    Joint,
    /// Difference of the energy of all bodies from the reference's: the mean over the whole run, relative to
    /// the greatest kinetic energy of the reference.
    Energy,
    /// The deepest overlap as a share of the thinner shape, from its middle to its surface, of an instant: of
    /// impacts. What is left of overlaps that the scene starts with does not count.
    Overlap,
    /// The same of overlaps that last a tenth of a second.
    Lasting,
    /// The greatest error of a joint, relative to the width of the narrowest body that has joints.
    Opening,
    /// The greatest rise, from any earlier time, of the energy that bodies have and joints have stored, less
    /// the work of motors, springs and what the caller moves: gained from nothing. Relative to the greatest
    /// kinetic energy of the reference.
    Gain,
    /// Bodies that left the region in which those of the reference are.
    Lost,
    /// Mean speed in the last half second of the fastest body that rests in the reference, relative to
    /// the square root of gravity times its width.
    Unrest,
    /// The greatest distance of any body from the reference, relative to its width, while its path can be
    /// compared.
    Deviation,
    /// How far the statistics of all bodies that move are from those of the reference: their centroid,
    /// spread, height and energy, in the worst quarter of the time. One is a quarter of a body's width, or
    /// a tenth of the greatest kinetic energy, beyond three standard deviations of the reference's runs.
    Heap,
}

impl Measure {
    /// All of them.
    pub const ALL: [Measure; 15] = [
        Measure::Trajectory,
        Measure::Worst,
        Measure::Rotation,
        Measure::Penetration,
        Measure::Residual,
        Measure::Joint,
        Measure::Energy,
        Measure::Overlap,
        Measure::Lasting,
        Measure::Opening,
        Measure::Gain,
        Measure::Lost,
        Measure::Unrest,
        Measure::Deviation,
        Measure::Heap,
    ];

    /// Those which a setting has to keep a limit of, whatever it is picked by.
    pub const CONDITIONS: [Measure; 8] = [
        Measure::Overlap,
        Measure::Lasting,
        Measure::Opening,
        Measure::Gain,
        Measure::Lost,
        Measure::Unrest,
        Measure::Deviation,
        Measure::Heap,
    ];

    /// As the command line names it.
    pub const fn name(self) -> &'static str {
        match self {
            Measure::Trajectory => "trajectory",
            Measure::Worst => "worst",
            Measure::Rotation => "rotation",
            Measure::Penetration => "penetration",
            Measure::Residual => "residual",
            Measure::Joint => "joint",
            Measure::Energy => "energy",
            Measure::Overlap => "overlap",
            Measure::Lasting => "lasting",
            Measure::Opening => "opening",
            Measure::Gain => "gain",
            Measure::Lost => "lost",
            Measure::Unrest => "unrest",
            Measure::Deviation => "deviation",
            Measure::Heap => "heap",
        }
    }

    /// Its unit; for relative measures, the reference quantity.
    pub fn unit(self) -> &'static str {
        match self {
            Measure::Trajectory | Measure::Worst | Measure::Opening | Measure::Deviation => "body widths",
            Measure::Rotation => "rad",
            Measure::Penetration | Measure::Joint => "m",
            Measure::Residual => "m/s",
            Measure::Energy | Measure::Gain => "of the kinetic energy",
            Measure::Overlap | Measure::Lasting => "of the thinner half",
            Measure::Lost => "bodies",
            Measure::Unrest => "of the speed of a fall",
            Measure::Heap => "of what may differ",
        }
    }

    /// Whether it is of paths alone, and says nothing about the time after they part.
    pub fn of_paths(self) -> bool {
        matches!(self, Measure::Trajectory | Measure::Worst | Measure::Rotation | Measure::Deviation)
    }
}

/// The greatest values that a setting which is picked may have of [`Measure::CONDITIONS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits([f64; Measure::CONDITIONS.len()]);

impl Default for Limits {
    /// Overlaps of half of the thinner half for an instant and of a tenth of it for longer, joints open by a
    /// twentieth of a body's width, a gain of a tenth of the energy, no lost body, speeds of a twentieth, no
    /// body a width away from the reference, and the heap where it may be.
    fn default() -> Limits {
        Limits([0.5, 0.1, 0.05, 0.1, 0.0, 0.05, 1.0, 1.0])
    }
}

impl Limits {
    /// With another limit; other measures than conditions have none.
    #[must_use]
    pub fn with(mut self, measure: Measure, limit: f64) -> Limits {
        if let Some(at) = Measure::CONDITIONS.iter().position(|&condition| condition == measure) {
            self.0[at] = limit;
        }
        self
    }

    /// The limit of each condition. Where the reference itself has more, it is half more than that.
    pub fn all(&self, uncertainty: impl Fn(Measure) -> f64) -> [(Measure, f64); Measure::CONDITIONS.len()] {
        std::array::from_fn(|i| {
            let measure = Measure::CONDITIONS[i];
            let own = match measure {
                Measure::Overlap | Measure::Lasting | Measure::Opening => ABOVE * uncertainty(measure),
                _ => 0.0,
            };
            (measure, self.0[i].max(own))
        })
    }
}

/// How much more than the reference a setting may have.
const ABOVE: f64 = 1.5;

/// All errors of a run, each to seven digits; infinite if the run produced numbers that are not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors([f64; Measure::ALL.len()]);

impl Errors {
    /// The errors of a failed run.
    pub const LOST: Errors = Errors([f64::INFINITY; Measure::ALL.len()]);

    /// Errors in the order of [`Measure::ALL`]; NaN becomes infinite.
    pub fn new(values: [f64; Measure::ALL.len()]) -> Errors {
        Errors(values.map(rounded))
    }

    /// One of them.
    pub fn of(&self, measure: Measure) -> f64 {
        self.0[measure as usize]
    }
}

/// Rounds to seven digits: few enough to be exact in text, whatever reads it.
fn rounded(value: f64) -> f64 {
    if value.is_nan() {
        return f64::INFINITY;
    }
    if value.abs() < 1e-12 {
        return 0.0;
    }
    format!("{value:.6e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_have_seven_digits_and_are_never_nan() {
        let mut values = [0.0; Measure::ALL.len()];
        values[..6].copy_from_slice(&[0.123_456_789, f64::NAN, 1e-13, 12_345_678.9, f64::INFINITY, 3e-5]);
        let errors = Errors::new(values);
        let found = Measure::ALL.map(|measure| errors.of(measure));
        assert_eq!(found[..6], [0.123_456_8, f64::INFINITY, 0.0, 12_345_680.0, f64::INFINITY, 3e-5]);
    }
}
