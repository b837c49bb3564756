//! Which settings are measured.

use super::{Cell, ContinuousChoice, FrictionLaw};
use crate::WorldMethod;
use backstop::Error;
use backstop::limits::within;

/// A grid of settings: all combinations of the values of its axes.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Grid {
    /// Steps per second, 1..=10000.
    pub hz: Vec<u32>,
    /// Substeps of a step, 1..=64.
    pub substeps: Vec<u32>,
    /// Iterations of a substep, 1..=256.
    pub iterations: Vec<u32>,
    /// Most substeps times iterations: combinations with more are left out.
    pub most_passes: u32,
    /// Friction.
    pub friction: Vec<FrictionLaw>,
    /// Continuous collision.
    pub continuous: Vec<ContinuousChoice>,
    /// Whether contacts of pairs that hardly moved are kept.
    pub recycling: Vec<bool>,
    /// Whether trees of joints are solved exactly.
    pub joint_trees: Vec<bool>,
    /// Methods of the lab, by their names, that solve steps beside the engine's own solver. They know no
    /// substeps and iterations: each is combined with the rates and friction alone.
    #[serde(default)]
    pub solvers: Vec<String>,
}

/// Fewest frames per second at which trajectories are compared.
const FEWEST_FRAMES: u32 = 10;

impl Grid {
    /// The full grid for a scene with or without joints. Conservative advancement, which is slow, the talk's
    /// method and boxes of friction are left out.
    pub fn full(joints: bool) -> Grid {
        use ContinuousChoice::{Discrete, LinearCast, Segment, Speculative, Volume};
        Grid {
            hz: vec![30, 60, 120, 240],
            substeps: vec![1, 2, 4, 8, 16],
            iterations: vec![1, 2, 4, 8],
            most_passes: 32,
            friction: vec![FrictionLaw::Patch, FrictionLaw::Point],
            continuous: vec![Discrete, Segment, Volume, Speculative, LinearCast],
            recycling: vec![true, false],
            joint_trees: if joints { vec![true, false] } else { vec![true] },
            solvers: ["gs-cone", "admm"].map(String::from).to_vec(),
        }
    }

    /// A coarse one.
    pub fn quick(joints: bool) -> Grid {
        Grid {
            hz: vec![30, 60, 120],
            substeps: vec![1, 2, 4, 8],
            iterations: vec![1, 4],
            most_passes: 8,
            continuous: vec![ContinuousChoice::Discrete, ContinuousChoice::Segment],
            recycling: vec![true],
            solvers: Vec::new(),
            ..Grid::full(joints)
        }
    }

    /// Its cells: the default first, then all others.
    pub fn cells(&self) -> Vec<Cell> {
        let mut cells = vec![Cell::default()];
        for &hz in &self.hz {
            for (substeps, iterations) in self.passes() {
                for &friction in &self.friction {
                    for &continuous in &self.continuous {
                        for &recycling in &self.recycling {
                            for &joint_trees in &self.joint_trees {
                                let cell = Cell {
                                    hz,
                                    substeps,
                                    iterations,
                                    friction,
                                    continuous,
                                    recycling,
                                    joint_trees,
                                    solver: None,
                                };
                                if !cells.contains(&cell) {
                                    cells.push(cell);
                                }
                            }
                        }
                    }
                }
            }
        }
        for solver in &self.solvers {
            for &hz in &self.hz {
                for &friction in &self.friction {
                    let usual = Cell { hz, substeps: 1, iterations: 1, friction, ..Cell::default() };
                    let cell = Cell { solver: Some(solver.clone()), ..usual };
                    if !cells.contains(&cell) {
                        cells.push(cell);
                    }
                }
            }
        }
        cells
    }

    fn passes(&self) -> impl Iterator<Item = (u32, u32)> {
        let pairs = self.substeps.iter().flat_map(|&s| self.iterations.iter().map(move |&i| (s, i)));
        pairs.filter(|(s, i)| s.saturating_mul(*i) <= self.most_passes)
    }

    /// Times per second at which every cell has a pose: the greatest common divisor of the rates of its
    /// cells.
    ///
    /// # Errors
    /// If a number is out of range, an axis has no value, or the rates have so little in common that
    /// trajectories would be compared less than ten times a second.
    pub fn frame_rate(&self) -> Result<u32, Error> {
        let empty =
            [self.friction.len(), self.continuous.len(), self.recycling.len(), self.joint_trees.len()]
                .contains(&0);
        if empty || self.hz.is_empty() || self.passes().next().is_none() {
            return Err(Error::Incomplete { what: "a grid", expected: "a value for each axis" });
        }
        if self.solvers.iter().any(|name| WorldMethod::by_name(name).is_none()) {
            return Err(Error::Incomplete {
                what: "a solver of a grid",
                expected: "the name of a method of the lab",
            });
        }
        for (what, values, most, expected) in [
            ("steps per second", &self.hz, 10_000, "in 1..=10000"),
            ("substeps", &self.substeps, 64, "in 1..=64"),
            ("iterations", &self.iterations, 256, "in 1..=256"),
        ] {
            for &value in values {
                within(what, value as f32, 1.0, most as f32, expected)?;
            }
        }
        let rate = self.hz.iter().copied().fold(Cell::default().hz, divisor);
        within(
            "the greatest common divisor of 60 and all rates [Hz]",
            rate as f32,
            FEWEST_FRAMES as f32,
            f32::MAX,
            "at least 10, so that trajectories have times in common",
        )?;
        Ok(rate)
    }
}

fn divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { divisor(b, a % b) }
}

/// An axis of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Steps per second.
    Rate,
    /// Substeps times iterations.
    Passes,
    /// Friction.
    Friction,
    /// Continuous collision.
    Continuous,
    /// Recycling of contacts.
    Recycling,
    /// How joints are solved.
    Joints,
    /// The solver of steps.
    Solver,
}

impl Axis {
    /// All of them.
    pub const ALL: [Axis; 7] = [
        Axis::Rate,
        Axis::Passes,
        Axis::Friction,
        Axis::Continuous,
        Axis::Recycling,
        Axis::Joints,
        Axis::Solver,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Axis::Rate => "rate",
            Axis::Passes => "substeps x iterations",
            Axis::Friction => "friction",
            Axis::Continuous => "continuous",
            Axis::Recycling => "recycling",
            Axis::Joints => "joints",
            Axis::Solver => "solver",
        }
    }

    /// The value that a cell has on it.
    pub fn value(self, cell: &Cell) -> String {
        match self {
            Axis::Rate => format!("{} Hz", cell.hz),
            Axis::Passes => format!("{}x{}", cell.substeps, cell.iterations),
            Axis::Friction => cell.friction.name().into(),
            Axis::Continuous => cell.continuous.name().into(),
            Axis::Recycling => if cell.recycling { "on" } else { "off" }.into(),
            Axis::Joints => if cell.joint_trees { "exact" } else { "rows" }.into(),
            Axis::Solver => cell.solver.clone().unwrap_or_else(|| "backstop".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_has_each_combination_once_and_the_default_first() {
        let grid = Grid::quick(false);
        let cells = grid.cells();
        // 3 rates, (1, 2, 4, 8)x1 and (1, 2)x4, 2 frictions, 2 modes; the default is one of them.
        assert_eq!(cells.len(), 3 * 6 * 2 * 2);
        assert_eq!(cells[0], Cell::default());
        assert!(cells.iter().enumerate().all(|(i, cell)| !cells[..i].contains(cell)));
        assert_eq!(Grid::quick(true).cells().len(), 2 * cells.len());
        // If the default is not in the grid, there is one more cell.
        assert_eq!(Grid { hz: vec![120], ..grid }.cells().len(), 6 * 2 * 2 + 1);
    }

    #[test]
    fn rates_need_times_in_common() {
        let rate = |hz: &[u32]| Grid { hz: hz.to_vec(), ..Grid::quick(false) }.frame_rate();
        assert_eq!(rate(&[30, 120]), Ok(30));
        assert_eq!(rate(&[50]), Ok(10));
        assert!(rate(&[61]).is_err() && rate(&[]).is_err() && rate(&[0]).is_err());
        assert!(Grid { substeps: vec![65], ..Grid::quick(false) }.frame_rate().is_err());
        assert!(Grid { most_passes: 0, ..Grid::quick(false) }.frame_rate().is_err());
    }
}
