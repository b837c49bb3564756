//! Methods of solving a [`Problem`], a file each. [`Method::ALL`] names them.
//!
//! `pivoting` and `newton` have the exact methods, `projected` the iterations. Exact methods share the
//! forms into which they bring a problem (`forms`), the rounds that lead from these to the exact cone
//! (`rounds`) and the bookkeeping of a run (`run`). What any method found is checked before it is returned
//! (`verdict`).

mod cone;
mod envelope;
mod forms;
mod linear;
mod newton;
mod pivoting;
mod projected;
mod registry;
mod rounds;
mod run;
mod tableau;
#[cfg(test)]
mod tests;
mod verdict;

pub use newton::{newton_fb, newton_min};
pub use pivoting::{block_pivoting, dantzig, keller, lemke, murty, path};
pub use projected::{admm, apgd, gs_cone, jacobi, nncg, pgs, prox, psor};
pub use registry::Method;

use crate::problem::Problem;

/// How a method ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Every law holds to the tolerance, by the [residual](Problem::residual) of these very impulses.
    Solved,
    /// A pivoting method ran along a ray: for a copositive-plus matrix this means that there is no solution,
    /// for others it means nothing.
    Ray,
    /// There is no solution, by a proof that was checked ([`Problem::is_contradicted_by`]).
    NoSolution,
    /// Iterations or pivots ran out, or it stagnated, before the tolerance was met.
    Limit,
}

/// The model of friction with which a [`Law::Contact`](crate::problem::Law::Contact) is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Friction {
    /// The exact cone if the method supports it, else the method's own model.
    #[default]
    Cone,
    /// An inscribed pyramid of four sides, with its slack (Stewart and Trinkle 1996).
    Pyramid,
    /// A box whose size follows from the normal impulse of the previous round.
    Box,
}

/// The order in which `sequential` visits pairs of bodies, and `impulse-based` points that meet at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// The fastest approach first, in impacts and in each sweep.
    #[default]
    Fastest,
    /// By the order of bodies.
    Given,
    /// At once: all pairs that approach, and all points of two bodies that meet at one time.
    Together,
}

/// Limits on the work of a method, and its start.
#[derive(Clone, Debug, PartialEq)]
pub struct Effort {
    /// Unit-free natural-map residual to be reached. Default 1e-10.
    pub tolerance: f64,
    /// The most sweeps, iterations or pivots. Default 10,000.
    pub iterations: u32,
    /// The model of friction, if the method has a choice.
    pub friction: Friction,
    /// Impulses to start from; none: zero.
    pub start: Option<Vec<f64>>,
    /// Over-relaxation of `psor`, in (0, 2). Default 1.3.
    pub relaxation: f64,
    /// Frequency of the springs of penalty methods [Hz]; zero: 0.048 of the rate of steps. Default 0.
    pub frequency: f64,
    /// Damping ratio of these springs. Default 0.7.
    pub damping: f64,
    /// Impacts of a pair after which `sequential` halves its restitution; it loses all of it after four times
    /// as many. At least 1. Default 32.
    pub calm: u32,
    /// The order of what `sequential` and `impulse-based` take one after the other.
    pub order: Order,
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
            calm: 32,
            order: Order::default(),
        }
    }
}

/// The result of a method.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// How a method ended.
    pub status: Status,
    /// Impulses [N s], one a row: the best that were found.
    pub r: Vec<f64>,
    /// Sweeps or iterations.
    pub iterations: u32,
    /// Pivots, of methods that pivot.
    pub pivots: u32,
    /// Unit-free natural-map residual of `r`, in twice the precision of `f64`.
    pub residual: f64,
}

/// A method as a function.
pub type Solve = fn(&Problem, &Effort) -> Solution;
