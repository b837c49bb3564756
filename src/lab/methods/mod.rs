//! Methods of solving a [`Problem`], a file each: direct ones that pivot, Newton's, and iterations that project. [`Method::ALL`]
//! names them.

mod admm;
mod apgd;
mod block_pivoting;
mod certificate;
mod cone;
mod cone_newton;
mod dantzig;
mod dictionary;
mod envelope;
#[cfg(test)]
mod exact_tests;
mod forms;
mod gs_cone;
mod jacobi;
mod keller;
mod lemke;
mod linear;
mod murty;
mod newton_fb;
mod newton_min;
mod nncg;
mod path;
mod pgs;
mod principal;
mod prox;
mod psor;
mod registry;
mod rounds;
mod run;
mod sweep;
mod tableau;
#[cfg(test)]
mod tests;

pub use admm::admm;
pub use apgd::apgd;
pub use block_pivoting::block_pivoting;
pub use dantzig::dantzig;
pub use gs_cone::gs_cone;
pub use jacobi::jacobi;
pub use keller::keller;
pub use lemke::lemke;
pub use murty::murty;
pub use newton_fb::newton_fb;
pub use newton_min::newton_min;
pub use nncg::nncg;
pub use path::path;
pub use pgs::pgs;
pub use prox::prox;
pub use psor::psor;
pub use registry::Method;

use crate::lab::problem::Problem;

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Every law holds to the tolerance.
    Solved,
    /// A pivoting method ran along a ray: for a copositive-plus matrix there is no solution, for others it says nothing.
    Ray,
    /// There is none: it was proved.
    NoSolution,
    /// Iterations or pivots ran out, or it stagnated, before the tolerance was met.
    Limit,
}

/// With what friction a [`Law::Contact`](crate::lab::problem::Law::Contact) is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Friction {
    /// The exact cone, where a method can; else what it says.
    #[default]
    Cone,
    /// An inscribed pyramid of four sides, with its slack (Stewart and Trinkle 1996).
    Pyramid,
    /// A box whose size is that of the normal impulse of the round before.
    Box,
}

/// What a method may spend and what it starts from.
#[derive(Clone, Debug, PartialEq)]
pub struct Effort {
    /// Unit-free natural-map residual to be reached. Default 1e-10.
    pub tolerance: f64,
    /// The most sweeps, iterations or pivots. Default 10,000.
    pub iterations: u32,
    /// Of the method, where it has a choice.
    pub friction: Friction,
    /// Impulses to start from; none: zero.
    pub start: Option<Vec<f64>>,
    /// Over-relaxation of `psor`, in (0, 2). Default 1.3.
    pub relaxation: f64,
    /// Frequency of the springs of penalty methods [Hz]; zero: 0.048 of the rate of steps. Default 0.
    pub frequency: f64,
    /// Damping ratio of these springs. Default 0.7.
    pub damping: f64,
}

impl Default for Effort {
    fn default() -> Effort {
        Effort {
            tolerance: 1e-10,
            iterations: 10_000,
            friction: Friction::Cone,
            start: None,
            relaxation: 1.3,
            frequency: 0.0,
            damping: 0.7,
        }
    }
}

/// What a method found.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// How it ended.
    pub status: Status,
    /// Impulses [N s], as many as rows: the best that was seen.
    pub r: Vec<f64>,
    /// Sweeps or iterations.
    pub iterations: u32,
    /// Pivots, of methods that pivot.
    pub pivots: u32,
    /// Unit-free natural-map residual of `r`.
    pub residual: f64,
}

/// A method as a function.
pub type Solve = fn(&Problem, &Effort) -> Solution;
