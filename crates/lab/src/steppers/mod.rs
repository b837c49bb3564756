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

pub use guendelman::guendelman;
pub use impulse_based::impulse_based;
pub(super) use memory::Memory;
pub use penalty::{penalty, penalty_implicit};
pub use sequential::sequential;
pub use step::{Resolution, Resolve, Step};

/// A method as the command line names it.
#[derive(Clone, Copy, Debug)]
pub struct Stepper {
    /// Lower case, with hyphens.
    pub name: &'static str,
    /// What it does, and where it comes from.
    pub about: &'static str,
    /// Whether it corrects overlap itself.
    pub pushes: bool,
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
            resolve: sequential,
        },
        Stepper {
            name: "guendelman",
            about: "impacts, then contacts with rising restitution, then shock propagation (Guendelman, \
                Bridson and Fedkiw 2003)",
            pushes: false,
            resolve: guendelman,
        },
        Stepper {
            name: "impulse-based",
            about: "every contact a train of collisions with friction, by the time at which they happen \
                (Mirtich and Canny 1995)",
            pushes: true,
            resolve: impulse_based,
        },
        Stepper {
            name: "penalty",
            about: "springs and dampers where bodies overlap, explicit (Moore and Wilhelms 1988)",
            pushes: true,
            resolve: penalty,
        },
        Stepper {
            name: "penalty-implicit",
            about: "the same springs at the end of the step, which no stiffness makes unstable",
            pushes: true,
            resolve: penalty_implicit,
        },
    ];

    /// The one of that name.
    pub fn by_name(name: &str) -> Option<&'static Stepper> {
        Stepper::ALL.iter().find(|stepper| stepper.name == name)
    }
}
