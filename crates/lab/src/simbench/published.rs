//! Numbers that SimBenchmark published: the files `data/TEST/sample.csv` of
//! <https://github.com/leggedrobotics/SimBenchmark> (September 2021), which its pages show as plots. Measured
//! there on an Intel Core i7-7700HQ.

use super::test::Test;

/// The result of an engine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Published {
    /// Its name.
    pub engine: &'static str,
    /// Which of the engine's solvers.
    pub solver: &'static str,
    /// Whether it corrected errors (ERP).
    pub error_reduction: bool,
    /// Length of a step [s].
    pub dt: f64,
    /// Iterations of the solver, where SimBenchmark varies them.
    pub iterations: Option<u32>,
    /// The test's metric.
    pub metric: f64,
    /// Wall-clock time of the whole run [s].
    pub time: f64,
}

pub(super) fn of(test: Test) -> &'static [Published] {
    match test {
        Test::Rolling => ROLLING,
        Test::Bouncing => BOUNCING,
        Test::Spheres => SPHERES,
        Test::Elastic => ELASTIC,
        Test::Momentum => MOMENTUM,
        Test::Energy => ENERGY,
        Test::Tower => TOWER,
    }
}

const fn row(
    engine: &'static str,
    solver: &'static str,
    error_reduction: bool,
    dt: f64,
    iterations: Option<u32>,
    metric: f64,
    time: f64,
) -> Published {
    Published { engine, solver, error_reduction, dt, iterations, metric, time }
}

/// `data/rolling/sample.csv`, force xy; the last two from `data/rolling/default.csv`.
#[rustfmt::skip]
const ROLLING: &[Published] = &[
    row("RaiSim", "bisection", false, 0.001, Some(10), 1.96524e-06, 0.169005),
    row("RaiSim", "bisection", false, 0.001, Some(40), 4.08978e-07, 0.485514),
    row("RaiSim", "bisection", false, 0.001, Some(100), 4.08991e-07, 1.05239),
    row("RaiSim", "bisection", false, 0.001, Some(1000), 4.08935e-07, 1.09317),
    row("Bullet", "sequential impulse", false, 0.001, Some(10), 1.68453e-06, 0.448674),
    row("Bullet", "sequential impulse", false, 0.001, Some(40), 4.42287e-15, 0.910267),
    row("Bullet", "sequential impulse", false, 0.001, Some(100), 2.83765e-17, 1.79777),
    row("Bullet", "sequential impulse", false, 0.001, Some(1000), 3.85251e-27, 1.81757),
    row("ODE", "PGS", false, 0.001, Some(10), 3.14495, 0.534643),
    row("ODE", "PGS", false, 0.001, Some(40), 3.14497, 1.22149),
    row("ODE", "PGS", false, 0.001, Some(100), 3.14497, 2.56709),
    row("ODE", "PGS", false, 0.001, Some(1000), 3.14497, 22.5541),
    row("MuJoCo", "Newton", false, 0.001, None, 0.00692691, 1.67194),
    row("DART", "Dantzig", false, 0.001, None, 3.14497, 2.67552),
];

/// `data/bouncing/sample.csv`, without error reduction.
#[rustfmt::skip]
const BOUNCING: &[Published] = &[
    row("RaiSim", "bisection", false, 0.0001, None, 1.86413e-06, 2.36529),
    row("RaiSim", "bisection", false, 0.001, None, 0.0186204, 0.235136),
    row("RaiSim", "bisection", false, 0.004, None, 4.76468, 0.0610991),
    row("RaiSim", "bisection", false, 0.01, None, 185.953, 0.0252509),
    row("RaiSim", "bisection", false, 0.04, None, 47390.6, 0.00647402),
    row("RaiSim", "bisection", false, 0.1, None, 1834520.0, 0.00265884),
    row("Bullet", "sequential impulse", false, 0.0001, None, 752.345, 8.22547),
    row("Bullet", "sequential impulse", false, 0.001, None, 75245.4, 0.851648),
    row("Bullet", "sequential impulse", false, 0.004, None, 1201780.0, 0.226891),
    row("Bullet", "sequential impulse", false, 0.01, None, 7406640.0, 0.102335),
    row("Bullet", "sequential impulse", false, 0.04, None, 119223000.0, 0.0310302),
    row("Bullet", "sequential impulse", false, 0.1, None, 767704000.0, 0.0160391),
    row("ODE", "PGS", false, 0.0001, None, 1.85054, 19.8034),
    row("ODE", "PGS", false, 0.001, None, 185.027, 1.88695),
    row("ODE", "PGS", false, 0.004, None, 2982.68, 0.473906),
    row("ODE", "PGS", false, 0.01, None, 18808.3, 0.189298),
    row("ODE", "PGS", false, 0.04, None, 313419.0, 0.0494759),
    row("ODE", "PGS", false, 0.1, None, 2033260.0, 0.0211151),
    row("DART", "Dantzig", false, 0.0001, None, 483.166, 31.917),
    row("DART", "Dantzig", false, 0.001, None, 72274.4, 3.2084),
    row("DART", "Dantzig", false, 0.004, None, 1189660.0, 0.795548),
    row("DART", "Dantzig", false, 0.01, None, 7375880.0, 0.338765),
    row("DART", "Dantzig", false, 0.04, None, 119086000.0, 0.085922),
    row("DART", "Dantzig", false, 0.1, None, 767291000.0, 0.0378909),
];

/// `data/666/sample.csv`. DART varies from step to step.
#[rustfmt::skip]
const SPHERES: &[Published] = &[
    row("RaiSim", "bisection", false, 0.0001, None, 1.63724e-06, 12.9292),
    row("RaiSim", "bisection", false, 0.001, None, 0.00013534, 1.51045),
    row("RaiSim", "bisection", false, 0.004, None, 0.00211391, 0.38779),
    row("RaiSim", "bisection", false, 0.01, None, 0.0152745, 0.167983),
    row("RaiSim", "bisection", false, 0.04, None, 0.249862, 0.0550811),
    row("RaiSim", "bisection", false, 0.1, None, 0.961629, 0.0367491),
    row("Bullet", "sequential impulse", false, 0.0001, None, 0.00353091, 79.6021),
    row("Bullet", "sequential impulse", false, 0.001, None, 0.38247, 11.9778),
    row("Bullet", "sequential impulse", false, 0.004, None, 5.78282, 4.14151),
    row("Bullet", "sequential impulse", false, 0.01, None, 37.4217, 2.01153),
    row("Bullet", "sequential impulse", false, 0.04, None, 727.893, 0.677048),
    row("Bullet", "sequential impulse", false, 0.1, None, 278496.0, 0.91797),
    row("ODE", "PGS", false, 0.0001, None, 1.58571e-06, 98.9894),
    row("ODE", "PGS", false, 0.001, None, 0.000157122, 10.0378),
    row("ODE", "PGS", false, 0.004, None, 0.00208149, 2.52893),
    row("ODE", "PGS", false, 0.01, None, 0.0161901, 1.00332),
    row("ODE", "PGS", false, 0.04, None, 0.236774, 0.286833),
    row("ODE", "PGS", false, 0.1, None, 3.05789, 0.121567),
    row("MuJoCo", "Newton", false, 0.0001, None, 0.0112876, 291.667),
    row("MuJoCo", "Newton", false, 0.001, None, 0.0950124, 43.1372),
    row("MuJoCo", "Newton", false, 0.004, None, 0.374245, 15.3103),
    row("MuJoCo", "Newton", false, 0.01, None, 0.933766, 5.1182),
    row("MuJoCo", "Newton", false, 0.04, None, 3.84858, 16.7819),
    row("MuJoCo", "Newton", false, 0.1, None, 10.9935, 37.0414),
    row("DART", "Dantzig", false, 0.0001, None, 1.97837e-07, 197.014),
    row("DART", "Dantzig", false, 0.001, None, 0.000282356, 22.9162),
    row("DART", "Dantzig", false, 0.004, None, 9292.72, 6.56869),
    row("DART", "Dantzig", false, 0.01, None, 214.842, 3.06581),
    row("DART", "Dantzig", false, 0.04, None, 1366.83, 1.24581),
    row("DART", "Dantzig", false, 0.1, None, 6.83924, 2.75566),
];

/// `data/666-elastic/sample.csv`, without error reduction.
#[rustfmt::skip]
const ELASTIC: &[Published] = &[
    row("RaiSim", "bisection", false, 0.0001, None, 0.00110304, 6.11585),
    row("RaiSim", "bisection", false, 0.0004, None, 0.248699, 1.64278),
    row("RaiSim", "bisection", false, 0.001, None, 8.36835, 0.655143),
    row("RaiSim", "bisection", false, 0.004, None, 264.072, 0.180666),
    row("RaiSim", "bisection", false, 0.01, None, 5184170.0, 0.0702891),
    row("RaiSim", "bisection", false, 0.04, None, 2731520000.0, 0.021476),
    row("RaiSim", "bisection", false, 0.1, None, 119339000.0, 0.0127361),
    row("Bullet", "sequential impulse", false, 0.0001, None, 167.526, 21.5038),
    row("Bullet", "sequential impulse", false, 0.0004, None, 3563.92, 5.93753),
    row("Bullet", "sequential impulse", false, 0.001, None, 41498.1, 2.31772),
    row("Bullet", "sequential impulse", false, 0.004, None, 840066.0, 0.65147),
    row("Bullet", "sequential impulse", false, 0.01, None, 9863960.0, 0.31976),
    row("Bullet", "sequential impulse", false, 0.05, None, 105315000.0, 0.149203),
    row("Bullet", "sequential impulse", false, 0.1, None, 1720190000.0, 0.150474),
    row("ODE", "PGS", false, 0.0001, None, 1.09578, 55.5611),
    row("ODE", "PGS", false, 0.0004, None, 17.5054, 13.8713),
    row("ODE", "PGS", false, 0.001, None, 112.318, 5.64728),
    row("ODE", "PGS", false, 0.004, None, 1648.4, 1.43055),
    row("ODE", "PGS", false, 0.01, None, 8559990.0, 0.601697),
    row("ODE", "PGS", false, 0.05, None, 1378830.0, 0.130007),
    row("ODE", "PGS", false, 0.1, None, 18843500.0, 0.065268),
    row("DART", "Dantzig", false, 0.0001, None, 2438.45, 141.159),
    row("DART", "Dantzig", false, 0.0004, None, 52414.7, 20.386),
    row("DART", "Dantzig", false, 0.001, None, 346909.0, 8.05873),
    row("DART", "Dantzig", false, 0.004, None, 6622240.0, 1.9544),
    row("DART", "Dantzig", false, 0.01, None, 12870600000.0, 0.842985),
    row("DART", "Dantzig", false, 0.04, None, 5964670000.0, 0.251876),
    row("DART", "Dantzig", false, 0.1, None, 1207130000000.0, 0.12266),
];

/// `data/anymal-momentum/sample.csv`, from steps of a millisecond on.
#[rustfmt::skip]
const MOMENTUM: &[Published] = &[
    row("RaiSim", "bisection", false, 0.001, None, 4.67537e-05, 0.058022),
    row("RaiSim", "bisection", false, 0.004, None, 0.00091496, 0.016257),
    row("RaiSim", "bisection", false, 0.01, None, 0.00538685, 0.00609994),
    row("Bullet", "sequential impulse", false, 0.001, None, 0.000265836, 0.43904),
    row("Bullet", "sequential impulse", false, 0.004, None, 0.00426832, 0.0868042),
    row("Bullet", "sequential impulse", false, 0.01, None, 0.022708, 0.035419),
    row("ODE", "PGS", false, 0.001, None, 1.33335e-27, 1.77907),
    row("ODE", "PGS", false, 0.004, None, 5.44184e-28, 0.449475),
    row("ODE", "PGS", false, 0.01, None, 4.03941e-28, 0.179843),
    row("MuJoCo", "Newton", false, 0.001, None, 0.0011404, 0.379829),
    row("MuJoCo", "Newton", false, 0.004, None, 0.0133445, 0.094028),
    row("MuJoCo", "Newton", false, 0.01, None, 0.0156349, 0.038142),
    row("MuJoCo", "Newton, RK4", false, 0.001, None, 4.66112e-13, 0.790538),
    row("MuJoCo", "Newton, RK4", false, 0.004, None, 3.51561e-07, 0.199953),
    row("MuJoCo", "Newton, RK4", false, 0.01, None, 2.39848e-05, 0.0783849),
    row("DART", "Dantzig", false, 0.001, None, 168.986, 0.526448),
    row("DART", "Dantzig", false, 0.004, None, 150.287, 0.135765),
    row("DART", "Dantzig", false, 0.01, None, 104.792, 0.0524459),
];

/// `data/anymal-energy/sample.csv`, from steps of a millisecond on.
#[rustfmt::skip]
const ENERGY: &[Published] = &[
    row("RaiSim", "bisection", false, 0.001, None, 0.0118404, 0.0149939),
    row("RaiSim", "bisection", false, 0.004, None, 0.214716, 0.00422597),
    row("RaiSim", "bisection", false, 0.01, None, 1.39767, 0.00145698),
    row("Bullet", "sequential impulse", false, 0.001, None, 3.65233, 0.082814),
    row("Bullet", "sequential impulse", false, 0.004, None, 55.6567, 0.0273678),
    row("Bullet", "sequential impulse", false, 0.01, None, 342.786, 0.010957),
    row("ODE", "PGS", false, 0.001, None, 3.92255, 0.481013),
    row("ODE", "PGS", false, 0.004, None, 61.9581, 0.126718),
    row("ODE", "PGS", false, 0.01, None, 379.89, 0.0516329),
    row("MuJoCo", "Newton", false, 0.001, None, 3.48198, 0.063359),
    row("MuJoCo", "Newton", false, 0.004, None, 55.5411, 0.0151579),
    row("MuJoCo", "Newton", false, 0.01, None, 343.91, 0.006392),
    row("MuJoCo", "Newton, RK4", false, 0.001, None, 1.6273e-17, 0.139079),
    row("MuJoCo", "Newton, RK4", false, 0.004, None, 4.50248e-14, 0.0343139),
    row("MuJoCo", "Newton, RK4", false, 0.01, None, 5.56596e-11, 0.0135331),
    row("DART", "Dantzig", false, 0.001, None, 236.756, 0.0965772),
    row("DART", "Dantzig", false, 0.004, None, 392.803, 0.0225611),
    row("DART", "Dantzig", false, 0.01, None, 918.391, 0.0119619),
];

/// `data/kapla/sample.csv`, steps of 0.01 s; 600 s is the end of the test. MuJoCo is listed with the
/// tolerance with which the tower stood longest.
#[rustfmt::skip]
const TOWER: &[Published] = &[
    row("RaiSim", "bisection", false, 0.01, Some(10), 0.25, 0.0345781),
    row("RaiSim", "bisection", false, 0.01, Some(40), 0.89, 0.285568),
    row("RaiSim", "bisection", false, 0.01, Some(100), 2.63, 1.88927),
    row("RaiSim", "bisection", false, 0.01, Some(400), 52.65, 120.686),
    row("RaiSim", "bisection", false, 0.01, Some(1000), 600.0, 2884.89),
    row("RaiSim", "bisection", true, 0.01, Some(10), 0.26, 0.036145),
    row("RaiSim", "bisection", true, 0.01, Some(40), 0.89, 0.280317),
    row("RaiSim", "bisection", true, 0.01, Some(100), 2.58, 1.92177),
    row("RaiSim", "bisection", true, 0.01, Some(400), 46.37, 108.465),
    row("RaiSim", "bisection", true, 0.01, Some(1000), 548.39, 2843.2),
    row("Bullet", "sequential impulse", false, 0.01, Some(10), 0.24, 0.234968),
    row("Bullet", "sequential impulse", false, 0.01, Some(40), 0.58, 0.976372),
    row("Bullet", "sequential impulse", false, 0.01, Some(100), 0.98, 2.77953),
    row("Bullet", "sequential impulse", false, 0.01, Some(400), 1.44, 13.5886),
    row("Bullet", "sequential impulse", false, 0.01, Some(1000), 1.47, 33.302),
    row("Bullet", "sequential impulse", true, 0.01, Some(10), 0.52, 0.275129),
    row("Bullet", "sequential impulse", true, 0.01, Some(40), 3.34, 3.33458),
    row("Bullet", "sequential impulse", true, 0.01, Some(100), 8.46, 17.5881),
    row("Bullet", "sequential impulse", true, 0.01, Some(400), 202.46, 1038.86),
    row("Bullet", "sequential impulse", true, 0.01, Some(1000), 550.58, 6954.77),
    row("ODE", "PGS", false, 0.01, Some(10), 0.4, 0.122368),
    row("ODE", "PGS", false, 0.01, Some(40), 1.01, 0.852728),
    row("ODE", "PGS", false, 0.01, Some(100), 1.22, 2.32766),
    row("ODE", "PGS", false, 0.01, Some(400), 1.24, 8.63345),
    row("ODE", "PGS", false, 0.01, Some(1000), 1.22, 21.2848),
    row("ODE", "PGS", true, 0.01, Some(10), 11.04, 3.0415),
    row("ODE", "PGS", true, 0.01, Some(40), 52.34, 39.056),
    row("ODE", "PGS", true, 0.01, Some(100), 59.9, 108.136),
    row("ODE", "PGS", true, 0.01, Some(400), 63.07, 428.714),
    row("ODE", "PGS", true, 0.01, Some(1000), 64.53, 1052.36),
    row("MuJoCo", "Newton", true, 0.01, None, 32.97, 60.6884),
    row("DART", "Dantzig", false, 0.01, None, 0.19, 5.92624),
];
