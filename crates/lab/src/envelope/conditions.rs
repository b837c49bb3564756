//! The conditions of a trial, and the axes along which they go to extremes.

use backstop_scene::Rng;
use std::fmt;

/// The lengths of the steps of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rhythm {
    /// Equal steps, this many per second.
    Even(f32),
    /// Any length between these [s], by a seeded draw.
    Random(f32, f32),
    /// 60 steps a second, and once a second one of 0.25 s.
    Hitches,
}

impl Rhythm {
    /// Length of step `step` [s].
    pub fn dt(self, step: u64) -> f32 {
        match self {
            Rhythm::Even(hertz) => 1.0 / hertz,
            // The length of any step is known without those before it.
            Rhythm::Random(least, most) => Rng::after(step).range(least, most),
            Rhythm::Hitches => [1.0 / 60.0, 0.25][usize::from(step % 46 == 45)],
        }
    }
}

/// A flaw of the ground, or of a body that lands on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Flaw {
    /// Nothing: a grid of triangles.
    #[default]
    None,
    /// Triangles without area among the others, along every edge.
    NoArea,
    /// Triangles a thousand times as long as wide.
    Slivers,
    /// Every triangle twice.
    Doubled,
    /// Bodies are hulls a thousand times as long as wide.
    Needles,
    /// Bodies are hulls a thousand times as wide as high.
    Flakes,
}

/// The conditions of one cell of the envelope.
#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    /// Distance from the world's origin along x, and 0.7 times as much along z [m].
    pub distance: f64,
    /// Length unit of scene and world [m].
    pub size: f32,
    /// Mass ratio of the heaviest and the lightest body that touch or are joined.
    pub mass_ratio: f32,
    /// Ratio of the largest and the smallest moment of inertia of a body.
    pub slenderness: f32,
    /// Lengths of the steps.
    pub rhythm: Rhythm,
    /// Speed instead of the trial's own [length units / s].
    pub speed: Option<f32>,
    /// Spin instead of the trial's own [rad/s].
    pub spin: Option<f32>,
    /// Gravity in multiples of the earth's.
    pub gravity: f32,
    /// Bodies that one body carries.
    pub carried: usize,
    /// Degeneracy of the ground or the bodies.
    pub flaw: Flaw,
    /// Coefficient of friction of all surfaces instead of their own.
    pub friction: Option<f32>,
    /// Overlap of neighbours at the start, as a part of their size.
    pub overlap: f32,
    /// Bodies of a heap.
    pub bodies: usize,
}

impl Default for Conditions {
    fn default() -> Self {
        Conditions {
            distance: 0.0,
            size: 1.0,
            mass_ratio: 1.0,
            slenderness: 1.0,
            rhythm: Rhythm::Even(60.0),
            speed: None,
            spin: None,
            gravity: 1.0,
            carried: 4,
            flaw: Flaw::None,
            friction: None,
            overlap: 0.3,
            bodies: 60,
        }
    }
}

/// The condition that goes to extremes while all others are ordinary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// Nothing: the ordinary case.
    Ordinary,
    /// Distance from the origin.
    Distance,
    /// Size of everything, under the earth's gravity.
    Size,
    /// Ratio of masses.
    MassRatio,
    /// Ratio of a body's moments of inertia.
    Slenderness,
    /// Length of the steps.
    Rhythm,
    /// Speed.
    Speed,
    /// Spin.
    Spin,
    /// Gravity.
    Gravity,
    /// Contacts of one body.
    Contacts,
    /// Degenerate triangles and hulls.
    Flaw,
    /// Friction of all surfaces.
    Friction,
    /// Overlap at the start.
    Overlap,
    /// Bodies of a heap.
    Bodies,
}

impl Axis {
    /// All, in the order of the map.
    pub const ALL: [Axis; 14] = [
        Axis::Ordinary,
        Axis::Distance,
        Axis::Size,
        Axis::MassRatio,
        Axis::Slenderness,
        Axis::Rhythm,
        Axis::Speed,
        Axis::Spin,
        Axis::Gravity,
        Axis::Contacts,
        Axis::Flaw,
        Axis::Friction,
        Axis::Overlap,
        Axis::Bodies,
    ];

    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Axis::Ordinary => "ordinary",
            Axis::Distance => "distance",
            Axis::Size => "size",
            Axis::MassRatio => "mass-ratio",
            Axis::Slenderness => "slenderness",
            Axis::Rhythm => "rhythm",
            Axis::Speed => "speed",
            Axis::Spin => "spin",
            Axis::Gravity => "gravity",
            Axis::Contacts => "contacts",
            Axis::Flaw => "flaw",
            Axis::Friction => "friction",
            Axis::Overlap => "overlap",
            Axis::Bodies => "bodies",
        }
    }

    /// Its points with their labels, from the mildest to the most extreme.
    pub fn points(self) -> Vec<(String, Conditions)> {
        let of = |values: &[f32], unit: &str, set: fn(&mut Conditions, f32)| {
            let point = |&value: &f32| {
                let mut conditions = Conditions::default();
                set(&mut conditions, value);
                (format!("{}{unit}", Plain(value)), conditions)
            };
            values.iter().map(point).collect()
        };
        match self {
            Axis::Ordinary => vec![("-".into(), Conditions::default())],
            Axis::Distance => of(&[1e3, 1e4, 1e5, 1e6, 1e7], " m", |c, value| c.distance = f64::from(value)),
            Axis::Size => of(&[1e-3, 1e-2, 0.1, 10.0, 100.0, 1e3], " m", |c, value| c.size = value),
            Axis::MassRatio => of(&[10.0, 100.0, 1e3, 1e4, 1e6], "", |c, value| c.mass_ratio = value),
            Axis::Slenderness => of(&[10.0, 100.0, 1e3, 1e4], "", |c, value| c.slenderness = value),
            Axis::Rhythm => {
                let even = [10.0, 20.0, 30.0, 120.0, 240.0, 1e3];
                let mut points = of(&even, " Hz", |c, value| c.rhythm = Rhythm::Even(value));
                let varying =
                    [("random", Rhythm::Random(1.0 / 144.0, 1.0 / 30.0)), ("hitches", Rhythm::Hitches)];
                points.extend(
                    varying.map(|(label, rhythm)| {
                        (label.into(), Conditions { rhythm, ..Conditions::default() })
                    }),
                );
                points
            }
            Axis::Speed => of(&[10.0, 100.0, 1e3, 1e4], " m/s", |c, value| c.speed = Some(value)),
            Axis::Spin => of(&[10.0, 100.0, 1e3], " rad/s", |c, value| c.spin = Some(value)),
            Axis::Gravity => of(&[0.1, 10.0, 100.0], " g", |c, value| c.gravity = value),
            Axis::Contacts => of(&[10.0, 100.0, 1e3, 4e3], "", |c, value| c.carried = value as usize),
            Axis::Flaw => [
                ("no area", Flaw::NoArea),
                ("slivers", Flaw::Slivers),
                ("doubled", Flaw::Doubled),
                ("needles", Flaw::Needles),
                ("flakes", Flaw::Flakes),
            ]
            .map(|(label, flaw)| (label.into(), Conditions { flaw, ..Conditions::default() }))
            .to_vec(),
            Axis::Friction => of(&[0.0, 2.0, 10.0], "", |c, value| c.friction = Some(value)),
            Axis::Overlap => of(&[0.1, 0.5, 0.9, 1.0], "", |c, value| c.overlap = value),
            Axis::Bodies => of(&[200.0, 1e3], "", |c, value| c.bodies = value as usize),
        }
    }
}

/// A number as people write it: powers of ten from a thousand on.
struct Plain(f32);

impl fmt::Display for Plain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            value if value != 0.0 && !(1e-2..1e3).contains(&value) => write!(f, "{value:e}"),
            value => write!(f, "{value}"),
        }
    }
}
