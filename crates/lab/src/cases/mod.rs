//! Cases of mechanics whose answer is known in closed form, each run in a world and compared with its
//! formula.
//!
//! A [`Case`] builds its bodies through the public interface, steps the world by a [`Setting`], and measures
//! one number, which it returns beside the exact one. `cargo backstop cases` prints all errors;
//! `docs/cases.md` has the table and the cases that miss their bar.
//!
//! ```
//! use backstop_lab::cases::{Case, Setting};
//!
//! # fn main() -> Result<(), backstop::Error> {
//! let slide = Case::by_name("slide-45").expect("a case of this name");
//! let outcome = slide.run(&Setting::REFERENCE)?;
//! assert!(outcome.error() < slide.bar);
//! # Ok(())
//! # }
//! ```

mod balls;
mod bounces;
mod case;
mod discs;
mod falling;
mod impacts;
mod linkages;
mod pendulums;
mod rig;
mod rods;
mod rolling;
mod sliding;
mod statics;
mod structures;
mod tops;
mod watch;

pub use case::{Case, Outcome, Setting};

impl Case {
    /// All of them, subject by subject.
    pub fn all() -> impl Iterator<Item = &'static Case> {
        [
            sliding::CASES,
            statics::CASES,
            rolling::CASES,
            discs::CASES,
            bounces::CASES,
            rods::CASES,
            impacts::eccentric::CASES,
            impacts::rocking::CASES,
            impacts::superball::CASES,
            balls::CASES,
            pendulums::CASES,
            linkages::modes::CASES,
            linkages::capstan::CASES,
            linkages::squeezer::CASES,
            linkages::four_bars::CASES,
            linkages::bricard::CASES,
            falling::CASES,
            tops::CASES,
            structures::CASES,
        ]
        .into_iter()
        .flatten()
    }

    /// The case of this name.
    pub fn by_name(name: &str) -> Option<&'static Case> {
        Case::all().find(|case| case.name == name)
    }
}
