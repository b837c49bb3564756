//! Methods that follow a step in time, a file each: they need gaps, bodies and the velocities at the start of
//! the step, not only the problem of its end. [`Stepper::ALL`] names them.

mod blocks;
mod guendelman;
mod impulse_based;
pub mod limit;
mod memory;
mod moving;
mod penalty;
mod sequential;
mod step;
#[cfg(test)]
mod tests;
mod today;

pub use guendelman::guendelman;
pub use impulse_based::impulse_based;
pub(super) use memory::Memory;
pub use penalty::{penalty, penalty_implicit};
pub use sequential::sequential;
pub use step::{Resolution, Resolve, Step};
pub use today::{avbd, mass_splitting, mujoco, sap, temporal_gauss_seidel, xpbd};

/// A method as the command line names it.
#[derive(Clone, Copy, Debug)]
pub struct Stepper {
    /// Lower case, with hyphens.
    pub name: &'static str,
    /// What it does, and where it comes from.
    pub about: &'static str,
    /// Whether it corrects overlap itself.
    pub pushes: bool,
    /// Whether bodies bear on each other by overlap.
    pub yields: bool,
    /// Whether it is to start from the impulses of the step before
    /// ([`Guess::LastStep`](crate::Guess::LastStep)).
    pub warm: bool,
    /// The method.
    pub resolve: Resolve,
}

impl Stepper {
    /// All there are.
    pub const ALL: &'static [Stepper] = &[
        Stepper {
            name: "sequential",
            about: "impacts one pair after the other, the fastest first, counted; then sequential impulses \
                (Moore and Wilhelms 1988)",
            pushes: false,
            yields: false,
            warm: false,
            resolve: sequential,
        },
        Stepper {
            name: "guendelman",
            about: "impacts, then contacts with rising restitution, then shock propagation (Guendelman, \
                Bridson and Fedkiw 2003)",
            pushes: false,
            yields: false,
            warm: false,
            resolve: guendelman,
        },
        Stepper {
            name: "impulse-based",
            about: "every contact a train of collisions with friction, by the time at which they happen \
                (Mirtich and Canny 1995)",
            pushes: true,
            yields: false,
            warm: false,
            resolve: impulse_based,
        },
        Stepper {
            name: "penalty",
            about: "springs and dampers where bodies overlap, explicit (Moore and Wilhelms 1988)",
            pushes: true,
            yields: true,
            warm: false,
            resolve: penalty,
        },
        Stepper {
            name: "penalty-implicit",
            about: "the same springs at the end of the step, which no stiffness makes unstable",
            pushes: true,
            yields: true,
            warm: false,
            resolve: penalty_implicit,
        },
        Stepper {
            name: "mass-splitting",
            about: "blocks of contacts at once, each with its share of the mass of its bodies (Tonge, \
                Benevolenski and Voroshilov 2012)",
            pushes: false,
            yields: false,
            warm: false,
            resolve: mass_splitting,
        },
        Stepper {
            name: "sap",
            about: "the convex problem of compliant contacts and joints, by Newton's method, as in Drake \
                (Castro, Permenter and Han 2022)",
            pushes: true,
            yields: false,
            warm: false,
            resolve: sap,
        },
        Stepper {
            name: "mujoco",
            about: "the convex problem of constraints that strive for the acceleration of a damped spring \
                (Todorov 2014)",
            pushes: true,
            yields: true,
            warm: false,
            resolve: mujoco,
        },
        Stepper {
            name: "tgs",
            about: "temporal Gauss-Seidel, 16 substeps of one sweep as in PhysX (Macklin et al. 2019)",
            pushes: true,
            yields: false,
            warm: false,
            resolve: temporal_gauss_seidel,
        },
        Stepper {
            name: "xpbd",
            about: "extended position based dynamics, 20 substeps (M\u{fc}ller et al. 2020)",
            pushes: true,
            yields: false,
            warm: false,
            resolve: xpbd,
        },
        Stepper {
            name: "avbd",
            about: "augmented vertex block descent, 20 iterations (Giles, Diaz and Yuksel 2025)",
            pushes: true,
            yields: false,
            warm: true,
            resolve: avbd,
        },
    ];

    /// The one of that name.
    pub fn by_name(name: &str) -> Option<&'static Stepper> {
        Stepper::ALL.iter().find(|stepper| stepper.name == name)
    }
}
