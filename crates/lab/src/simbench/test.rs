//! The tests: their names, units, steps and lengths.

use super::run::Setting;

/// Which test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Test {
    /// A box with 25 balls on it is pushed over the ground; the metric is the squared error of velocities
    /// [m²/s²].
    Rolling,
    /// 49 balls bounce with restitution 1; the metric is the squared error of their energy [J²].
    Bouncing,
    /// 216 balls in a cube collapse; the metric is the sum of squared penetrations [m²].
    Spheres,
    /// The same 216 balls fall by 1 m with restitution 1; the metric is the squared error of their energy
    /// [J²].
    Elastic,
    /// A ball flies into a robot without gravity; the metric is the squared error of their momentum [kg²
    /// m²/s²].
    Momentum,
    /// A robot is thrown up; the metric is the squared error of its energy [J²].
    Energy,
    /// A tower of 102 bricks; the metric is how long it stands [s].
    Tower,
}

impl Test {
    /// All of them.
    pub const ALL: [Test; 7] = [
        Test::Rolling,
        Test::Bouncing,
        Test::Spheres,
        Test::Elastic,
        Test::Momentum,
        Test::Energy,
        Test::Tower,
    ];

    /// SimBenchmark's name.
    pub fn name(self) -> &'static str {
        match self {
            Test::Rolling => "rolling",
            Test::Bouncing => "bouncing",
            Test::Spheres => "666",
            Test::Elastic => "666-elastic",
            Test::Momentum => "momentum",
            Test::Energy => "energy",
            Test::Tower => "kapla",
        }
    }

    /// The test with that name.
    pub fn named(name: &str) -> Option<Test> {
        Test::ALL.into_iter().find(|one| one.name() == name)
    }

    /// Unit of the metric.
    pub fn unit(self) -> &'static str {
        match self {
            Test::Rolling => "m2/s2",
            Test::Bouncing | Test::Elastic | Test::Energy => "J2",
            Test::Momentum => "kg2m2/s2",
            Test::Spheres => "m2",
            Test::Tower => "s",
        }
    }

    /// SimBenchmark's step, where it does not vary it [s].
    pub fn dt(self) -> f32 {
        if self == Test::Rolling { 0.001 } else { 0.01 }
    }

    /// Simulated time [s].
    pub fn seconds(self) -> f32 {
        match self {
            Test::Rolling => 4.0,
            Test::Bouncing => 20.0,
            Test::Spheres | Test::Elastic | Test::Momentum => 10.0,
            Test::Energy => 3.0,
            Test::Tower => 600.0,
        }
    }

    /// The settings of its curve: different step lengths, or different effort if SimBenchmark varies that.
    pub fn curve(self) -> Vec<Setting> {
        let with = |dt, substeps, iterations| Setting { dt, substeps, iterations, ..Setting::default() };
        let steps = |dts: &[f32]| dts.iter().map(|&dt| with(dt, 4, 1)).collect();
        let efforts = |efforts: &[(u32, u32)]| efforts.iter().map(|&(s, i)| with(self.dt(), s, i)).collect();
        match self {
            Test::Rolling => {
                let mut all: Vec<Setting> = efforts(&[(1, 1), (1, 10), (1, 40), (1, 100), (4, 1)]);
                all.extend::<Vec<_>>(steps(&[0.004, 0.01, 1.0 / 60.0, 0.04]));
                all
            }
            Test::Bouncing => steps(&[0.0001, 0.001, 0.004, 0.01, 1.0 / 60.0, 0.04, 0.1]),
            Test::Momentum | Test::Energy => steps(&[0.001, 0.004, 0.01, 1.0 / 60.0]),
            Test::Elastic => steps(&[0.0004, 0.001, 0.004, 0.01, 1.0 / 60.0, 0.05]),
            Test::Spheres => steps(&[0.001, 0.004, 0.01, 1.0 / 60.0, 0.04]),
            Test::Tower => efforts(&[(1, 1), (1, 10), (1, 40), (1, 100), (4, 1), (8, 1)]),
        }
    }
}
