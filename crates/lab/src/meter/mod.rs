//! How accurately a step was solved: the errors of the laws of contact, friction and joints after it, how
//! deep bodies overlap, and whether energy and momentum are balanced.
//!
//! ```
//! use backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World};
//! use backstop_lab::LabWorld;
//! use backstop::glam::DVec3;
//!
//! # fn main() -> Result<(), backstop::Error> {
//! let mut world = World::new(Settings::default())?;
//! world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane)))?;
//! let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
//! world.add_body(&BodyDesc::dynamic().with_position(DVec3::Y * 0.5).with_shape(cube))?;
//! world.measure_accuracy(true);
//! for _ in 0..60 {
//!     world.step(1.0 / 60.0)?;
//! }
//! let measures = &world.accuracy().expect("it is measured").whole;
//! assert!(measures.residual.worst < 1e-3 && measures.penetration < 1e-3);
//! # Ok(())
//! # }
//! ```

mod laws;
mod motion;

use super::problem::Residual;
use super::system::{Owner, System};
use super::world_solver::{Last, SolverReport, WorldSolver};
use backstop::observe::{BodyState, Observer, Solved, joint_rows};
use backstop::{BodyHandle, World};
use std::any::Any;

/// The measures of a step, for all bodies or for an island. Zero is exact for all but counts and energies;
/// `docs/accuracy.md` has the values that scenes reach.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measures {
    /// The natural-map residual of the impulses of the step and the velocities at its end: `worst` is the
    /// velocity of the law that is obeyed worst [m/s], `relative` the norm of all errors over that of the
    /// velocities without impulses. Good: `worst` below the slop per step, 0.05 of gravity times the step;
    /// `relative` below 1e-2. An angular error counts as that of a point at the radius of gyration. Springs
    /// and motors that yield are left out.
    pub residual: Residual,
    /// The owner of the worst law.
    pub worst: Option<Owner>,
    /// Fastest approach at the end of the step of points that touched at its start or bear load [m/s].
    pub approach: f64,
    /// The greatest impulse times separating speed of a point: a pushing point must not separate [J].
    pub parting: f64,
    /// The most by which friction exceeds its cone, as a share of it. The engine's own solver keeps it to
    /// rounding, 1e-6.
    pub cone: f64,
    /// Misalignment of sliding friction, which has to point against the slip: 1 + cosine of the angle between
    /// both, 2 if friction points along the slip. Good: below 1e-2.
    pub slip_angle: f64,
    /// Deepest overlap at the start of the step, as collision detection found it: what the step before left
    /// [m]. Good: about the slop.
    pub penetration: f64,
    /// The sum of the squares of all overlaps [m²].
    pub penetration_squares: f64,
    /// The deepest overlap as a share of the size of the thinner shape, from its middle to its surface. Good:
    /// below 1e-2.
    pub penetration_share: f64,
    /// The greatest error of rigid directions of joints at the end of the step: lengths [m].
    pub joint_length: f64,
    /// The same for angles [rad].
    pub joint_angle: f64,
    /// Kinetic and potential energy before the step [J].
    pub energy_before: f64,
    /// The same after it [J].
    pub energy_after: f64,
    /// Work of motors, springs, kinematic bodies, moving surfaces and the caller's forces [J], by the
    /// mean of the velocities before and after.
    pub work: f64,
    /// Energy that joints which were pulled open can give back [J]: of each rigid direction and each stop,
    /// half of its force times its error, where the force is against the error, as of a spring.
    pub stored: f64,
    /// Change of momentum that neither gravity, nor forces, nor impulses of rows explain [N s].
    pub momentum: f64,
    /// The same for angular momentum about the centre of mass [N m s].
    pub angular_momentum: f64,
    /// The greatest change of a body's velocity that none of those explains [m/s]: rounding.
    pub unexplained: f64,
    /// The greatest change of a body's angular velocity that none of those explains, at its radius of
    /// gyration [m/s]: rounding.
    pub unexplained_turn: f64,
    /// The greatest change of velocity beyond the impulses of rows where the engine conserves no momentum
    /// [m/s]: in trees in which bodies count as heavier or harder to turn than they are or of which a substep
    /// was solved again (see [`StepReport::damped_trees`](backstop::StepReport::damped_trees)), and of bodies
    /// that stand still for the rest of a step after several impacts. They are left out of the four before.
    pub unconserved: f64,
    /// Laws that were measured.
    pub laws: usize,
    /// Points that touch, and those that might have.
    pub points: [usize; 2],
    /// Laws that were left out: springs and motors that yield.
    pub soft: usize,
    /// Laws that were left out because a body bounced and had more than one contact: impacts are solved one
    /// by one, each at its time, and no law of the whole step says what is left after several.
    pub bouncing: usize,
}

impl Measures {
    /// Energy gained without a cause [J]; negative if impacts and friction dissipated it. Good: at most
    /// rounding.
    pub fn gained(&self) -> f64 {
        self.energy_after - self.energy_before - self.work
    }
}

/// The measures of bodies that touch or are joined.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct IslandAccuracy {
    /// Its dynamic bodies.
    pub bodies: Vec<BodyHandle>,
    /// The measures.
    pub measures: Measures,
}

/// How accurately a step was solved.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Accuracy {
    /// Everything together.
    pub whole: Measures,
    /// The measures of each island that has contacts or joints, in the order of their first bodies.
    pub islands: Vec<IslandAccuracy>,
    /// Contacts that bounced: their impulses are shared out evenly among their points.
    pub bounced: usize,
}

/// State of the meter within a step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Meter {
    /// Energy of each dynamic body before the step [J].
    energy: Vec<f64>,
    accuracy: Option<Accuracy>,
    /// Whether it measures; else it only solves.
    measures: bool,
    solver: Option<Box<Solving>>,
}

/// A method that solves the world, and its state from step to step.
#[derive(Clone, Debug)]
struct Solving {
    solver: WorldSolver,
    report: SolverReport,
    last: Last,
}

impl Meter {
    /// Drops the state of the previous method.
    fn set_solver(&mut self, solver: Option<WorldSolver>) {
        let with =
            |solver| Box::new(Solving { solver, report: SolverReport::default(), last: Last::default() });
        self.solver = solver.map(with);
    }

    fn solver(&self) -> Option<(&WorldSolver, &SolverReport)> {
        self.solver.as_deref().map(|solving| (&solving.solver, &solving.report))
    }

    /// Whether it neither measures nor solves.
    fn is_idle(&self) -> bool {
        !self.measures && self.solver.is_none()
    }
}

/// The meter of a world.
fn meter(world: &World) -> Option<&Meter> {
    let observer: &dyn Any = world.observer()?;
    observer.downcast_ref()
}

/// A copy of the meter of a world, with the state of the method that solves it: no part of a snapshot.
pub(crate) fn meter_of(world: &World) -> Option<Meter> {
    meter(world).cloned()
}

/// Gives a world the meter that it had.
pub(crate) fn put_meter(world: &mut World, meter: Option<Meter>) {
    match meter {
        Some(meter) => world.observe(Some(Box::new(meter))),
        None => world.observe(None),
    }
}

/// Changes the meter of a world, which may be made for that; it goes if it is there for nothing.
fn with_meter(world: &mut World, change: impl FnOnce(&mut Meter)) {
    if meter(world).is_none() {
        world.observe(Some(Box::<Meter>::default()));
    }
    let Some(observer) = world.observer_mut() else { return };
    let observer: &mut dyn Any = observer;
    let Some(meter) = observer.downcast_mut::<Meter>() else { return };
    change(meter);
    if meter.is_idle() {
        world.observe(None);
    }
}

/// Measuring and solving by the lab in a world that steps. It replaces any other [`Observer`] of the world.
pub trait LabWorld {
    /// Measures the accuracy of each step from now on, or no longer. It changes no result; a step that is
    /// measured allocates, and takes a multiple of its time.
    fn measure_accuracy(&mut self, on: bool);

    /// The accuracy of the last step, if it was measured.
    fn accuracy(&self) -> Option<&Accuracy>;

    /// The rows of the last step as one system with the impulses that they got, if it was measured.
    fn system(&self) -> Option<&System>;

    /// Lets a method of the lab solve the steps from now on; none: the fast path alone. See [`WorldSolver`]
    /// for which islands it solves and what happens to the others.
    fn solve_with(&mut self, solver: Option<WorldSolver>);

    /// Counts of the method of [`LabWorld::solve_with`] in the last step.
    fn solver_report(&self) -> Option<&SolverReport>;
}

impl LabWorld for World {
    fn measure_accuracy(&mut self, on: bool) {
        if !on && meter(self).is_none() {
            return;
        }
        with_meter(self, |meter| {
            if on != meter.measures {
                (meter.measures, meter.accuracy) = (on, None);
            }
        });
    }

    fn accuracy(&self) -> Option<&Accuracy> {
        meter(self)?.accuracy.as_ref()
    }

    fn system(&self) -> Option<&System> {
        self.accuracy()?;
        self.observed()
    }

    fn solve_with(&mut self, solver: Option<WorldSolver>) {
        if solver.is_some() || meter(self).is_some() {
            with_meter(self, |meter| meter.set_solver(solver));
        }
    }

    fn solver_report(&self) -> Option<&SolverReport> {
        meter(self)?.solver().map(|(_, report)| report)
    }
}

impl Observer for Meter {
    fn before_rows(&mut self, world: &World, system: &System) {
        self.accuracy = None;
        if self.measures {
            self.energy = energies(world);
        }
        if let Some(solving) = &mut self.solver {
            solving.last.take(system);
        }
    }

    fn after_rows(&mut self, solved: &mut Solved<'_>) {
        if let Some(solving) = &mut self.solver {
            solving.report = solving.solver.apply(solved, &mut solving.last);
        }
        self.accuracy = self.measures.then(|| Accuracy { bounced: solved.bounced, ..Accuracy::default() });
    }

    fn after_step(&mut self, world: &World, system: &System) {
        let Some(accuracy) = &mut self.accuracy else { return };
        let joints = joint_rows(world);
        let found = laws::Found::new(system, &joints);
        let all: Vec<usize> = (0..system.laws.len()).collect();
        let bodies: Vec<usize> = (0..system.bodies.len()).collect();
        let after = energies(world);
        let balance = motion::Balance::new(system, [&self.energy, &after]);
        let measure = |laws: &[usize], bodies: &[usize]| {
            let mut measures = found.measure(laws);
            balance.measure(laws, bodies, &mut measures);
            measures
        };
        accuracy.whole = measure(&all, &bodies);
        accuracy.islands = system
            .islands
            .iter()
            .map(|island| IslandAccuracy {
                bodies: island.bodies.iter().map(|&i| system.bodies[i].body).collect(),
                measures: measure(&island.laws, &island.bodies),
            })
            .collect();
    }
}

/// Kinetic and potential energy of each dynamic body that is awake [J].
fn energies(world: &World) -> Vec<f64> {
    BodyState::of_awake(world).iter().map(BodyState::energy).collect()
}
