//! The errors of a run.

/// A measure of a run's error. Zero is exact for each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Measure {
    /// Distance of centres of mass from the reference, relative to the width of each body: the mean over
    /// bodies and over the time in which trajectories can be compared.
    #[default]
    Trajectory,
    /// Angle between rotations and those of the reference [rad], the same mean.
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
}

impl Measure {
    /// All of them.
    pub const ALL: [Measure; 6] = [
        Measure::Trajectory,
        Measure::Rotation,
        Measure::Penetration,
        Measure::Residual,
        Measure::Joint,
        Measure::Energy,
    ];

    /// As the command line names it.
    pub fn name(self) -> &'static str {
        match self {
            Measure::Trajectory => "trajectory",
            Measure::Rotation => "rotation",
            Measure::Penetration => "penetration",
            Measure::Residual => "residual",
            Measure::Joint => "joint",
            Measure::Energy => "energy",
        }
    }

    /// Its unit; for relative measures, the reference quantity.
    pub fn unit(self) -> &'static str {
        match self {
            Measure::Trajectory => "body widths",
            Measure::Rotation => "rad",
            Measure::Penetration | Measure::Joint => "m",
            Measure::Residual => "m/s",
            Measure::Energy => "of the kinetic energy",
        }
    }
}

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
        let values = [0.123_456_789, f64::NAN, 1e-13, 12_345_678.9, f64::INFINITY, 3e-5];
        let errors = Errors::new(values);
        let found = Measure::ALL.map(|measure| errors.of(measure));
        assert_eq!(found, [0.123_456_8, f64::INFINITY, 0.0, 12_345_680.0, f64::INFINITY, 3e-5]);
    }
}
