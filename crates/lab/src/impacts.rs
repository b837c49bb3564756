//! Measured impacts of a body on a plate against the same impacts simulated, or computed by a law of impact.
//!
//! An impact is planar: x is along the plate, y points away from it, and spins are about z. A body that
//! touches the plate at one point is described by its mass, which cancels, its radius of gyration and the arm
//! of that point, whatever its shape.

use crate::LabWorld;
use crate::WorldSolver;
use backstop::BodyDesc;
use backstop::Error;
use backstop::Settings;
use backstop::World;
use backstop::limits::{finite, positive, within};
use backstop::{Geometry, MassProperties, Material, ShapeDesc};
use glam::{DVec2, DVec3, Mat3, Vec3};

/// Velocity in the plane of an impact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Velocity of the centre of mass [m/s].
    pub velocity: DVec2,
    /// [rad/s]
    pub spin: f64,
}

impl Motion {
    /// Velocity of a point of the body, at `arm` from its centre [m/s].
    pub fn at(&self, arm: DVec2) -> DVec2 {
        self.velocity + self.spin * arm.perp()
    }

    /// The motion after an impulse at `arm`, divided by the mass [m/s].
    fn after(&self, impulse: DVec2, arm: DVec2, gyration: f64) -> Motion {
        let spin = self.spin + arm.perp_dot(impulse) / (gyration * gyration);
        Motion { velocity: self.velocity + impulse, spin }
    }
}

/// An impact as it was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// The point that touches the plate, from the centre of mass [m].
    pub arm: DVec2,
    /// The motion with which the body arrives.
    pub before: Motion,
    /// The motion with which it leaves.
    pub after: Motion,
}

/// The body and the plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Radius of gyration about the centre of mass [m]. Default 0.0215: an ellipse of 70 x 50 mm.
    pub gyration: f64,
    /// Coefficient of friction. Default 0.18.
    pub friction: f64,
    /// Coefficient of restitution. Default 0.54.
    pub restitution: f64,
}

impl Default for Body {
    fn default() -> Body {
        Body { gyration: 0.0215, friction: 0.18, restitution: 0.54 }
    }
}

/// A law of impact, in closed form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// The speed of separation is a share of that of approach (Newton), and friction opposes the slip at the
    /// end of the impact (J. J. Moreau, 1988), as in the engine. It may add energy.
    Newton,
    /// Slip and friction are followed through the impact (E. J. Routh, 1905), and the impulse of restitution
    /// is a share of that of compression (Poisson).
    Poisson,
    /// The same, but the work of restitution is the square of the coefficient times that of compression (W.
    /// J. Stronge, 1990).
    Stronge,
}

impl Law {
    /// All of them.
    pub const ALL: [Law; 3] = [Law::Newton, Law::Poisson, Law::Stronge];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Law::Newton => "newton",
            Law::Poisson => "poisson",
            Law::Stronge => "stronge",
        }
    }

    /// The law of that name.
    pub fn by_name(name: &str) -> Option<Law> {
        Law::ALL.into_iter().find(|law| law.name() == name)
    }

    /// The motion after an impact; that before it if the point does not approach the plate.
    pub fn after(self, before: Motion, arm: DVec2, body: &Body) -> Motion {
        let point = Point::new(arm, body.gyration);
        let slip = before.at(arm);
        if slip.y >= 0.0 {
            return before;
        }
        let impulse = match self {
            Law::Newton => point.at_once(slip, body),
            Law::Poisson | Law::Stronge => point.followed(slip, body, self),
        };
        before.after(impulse, arm, body.gyration)
    }
}

/// By how much impulses at the point change its velocity: along the plate, along the normal, and one by the
/// other. Per unit of mass.
#[derive(Clone, Copy, Debug)]
struct Point {
    along: f64,
    normal: f64,
    across: f64,
}

impl Point {
    fn new(arm: DVec2, gyration: f64) -> Point {
        let share = arm / gyration;
        Point { along: 1.0 + share.y * share.y, normal: 1.0 + share.x * share.x, across: -share.x * share.y }
    }

    /// The change of the point's velocity by an impulse.
    fn answer(&self, impulse: DVec2) -> DVec2 {
        DVec2::new(
            self.along * impulse.x + self.across * impulse.y,
            self.across * impulse.x + self.normal * impulse.y,
        )
    }

    /// Newton's speed of separation, and Coulomb's law at the end.
    fn at_once(&self, slip: DVec2, body: &Body) -> DVec2 {
        let lack = -(1.0 + body.restitution) * slip.y;
        let determinant = self.along * self.normal - self.across * self.across;
        let sticks = DVec2::new(
            (-self.normal * slip.x - self.across * lack) / determinant,
            (self.along * lack + self.across * slip.x) / determinant,
        );
        if sticks.x.abs() <= body.friction * sticks.y {
            return sticks;
        }
        // It slips at the end, against the friction.
        let slips = [1.0, -1.0].map(|way| {
            let normal = lack / (self.normal - way * body.friction * self.across);
            (way, DVec2::new(-way * body.friction * normal, normal))
        });
        let holds =
            |&(way, impulse): &(f64, DVec2)| impulse.y >= 0.0 && way * (slip + self.answer(impulse)).x >= 0.0;
        slips.into_iter().find(holds).map_or(sticks, |(_, impulse)| impulse)
    }

    /// Friction opposes the slip of each moment. The velocity of the point is linear in the normal impulse
    /// between the moments at which slip stops, and compression ends.
    fn followed(&self, mut slip: DVec2, body: &Body, law: Law) -> DVec2 {
        let mut total = DVec2::ZERO;
        // Normal impulse and work of compression, once it has ended, and work of restitution.
        let (mut compression, mut work, mut returned) = (None::<f64>, 0.0, 0.0);
        // Slip stops at most once, and then sticks or reverses; compression ends once; then the impact ends.
        for _ in 0..4 {
            let holds = -self.across / self.along;
            let share = if slip.x != 0.0 {
                -body.friction * slip.x.signum()
            } else {
                holds.clamp(-body.friction, body.friction)
            };
            let unit = DVec2::new(share, 1.0);
            let rate = self.answer(unit);
            let rate = if slip.x == 0.0 && share == holds { DVec2::new(0.0, rate.y) } else { rate };
            let stops = if rate.x * slip.x < 0.0 { -slip.x / rate.x } else { f64::INFINITY };
            let ends = match compression {
                None if rate.y > 0.0 => -slip.y / rate.y,
                None => f64::INFINITY,
                Some(impulse) if law == Law::Poisson => (1.0 + body.restitution) * impulse - total.y,
                Some(_) => {
                    let rest = body.restitution * body.restitution * work - returned;
                    ((slip.y * slip.y + 2.0 * rate.y * rest).max(0.0).sqrt() - slip.y) / rate.y
                }
            };
            let length = stops.min(ends);
            if !length.is_finite() {
                break;
            }
            let done = slip.y * length + 0.5 * rate.y * length * length;
            *(if compression.is_none() { &mut work } else { &mut returned }) += done.abs();
            (total, slip) = (total + unit * length, slip + rate * length);
            if stops <= ends {
                slip.x = 0.0;
            } else if compression.is_none() {
                (compression, slip.y) = (Some(total.y), 0.0);
            } else {
                break;
            }
        }
        total
    }
}

/// Distance of a computed motion from the measured one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// Root of the kinetic energy of the difference over that of the motion before the impact.
    pub motion: f64,
    /// Difference of the velocity of the centre [m/s].
    pub velocity: f64,
    /// Difference of the spin [rad/s].
    pub spin: f64,
}

impl Impact {
    /// How far a motion after the impact is from the measured one.
    pub fn deviation(&self, found: Motion, gyration: f64) -> Deviation {
        let size = |motion: Motion| motion.velocity.length().hypot(gyration * motion.spin);
        let off =
            Motion { velocity: found.velocity - self.after.velocity, spin: found.spin - self.after.spin };
        let motion = size(off) / size(self.before);
        Deviation { motion, velocity: off.velocity.length(), spin: off.spin.abs() }
    }

    /// Whether it can be computed.
    ///
    /// # Errors
    /// If a number is not finite or out of range, or the point does not approach the plate.
    pub fn validate(&self, body: &Body) -> Result<(), Error> {
        positive("radius of gyration", body.gyration as f32)?;
        within("friction", body.friction as f32, 0.0, f32::MAX, "at least zero")?;
        within("restitution", body.restitution as f32, 0.0, 1.0, "in 0..=1")?;
        let Impact { arm, before, after } = self;
        for (what, x) in [
            ("arm", arm.x),
            ("arm", arm.y),
            ("velocity", before.velocity.x),
            ("velocity", before.velocity.y),
            ("spin", before.spin),
            ("velocity after the impact", after.velocity.x),
            ("velocity after the impact", after.velocity.y),
            ("spin after the impact", after.spin),
        ] {
            finite(what, x as f32)?;
        }
        let value = before.at(*arm).y;
        if value < 0.0 {
            return Ok(());
        }
        Err(Error::OutOfRange { what: "the normal velocity of the point", expected: "below zero", value })
    }
}

/// The most steps of an impact: springs need several.
const MOST_STEPS: u32 = 1000;
/// Radius of the ball that touches the plate, as a share of the radius of gyration: the impulse passes
/// through its lowest point.
const POINT: f64 = 0.01;

/// Simulates an impact without gravity, in steps of `dt` [s], until the point leaves the plate; returns the
/// motion then. `solver`: what solves the steps, if not the engine's own solver.
///
/// # Errors
/// If a number is not finite or out of range, or the point does not approach the plate.
pub fn simulate(
    impact: &Impact,
    body: &Body,
    settings: &Settings,
    solver: Option<&WorldSolver>,
    dt: f32,
) -> Result<Motion, Error> {
    impact.validate(body)?;
    let gyration = body.gyration as f32;
    let settings = settings.clone().with_gravity(Vec3::ZERO).with_length_unit(gyration);
    let mut world = World::new(settings.with_restitution_threshold(0.0))?;
    world.solve_with(solver.cloned());
    let material =
        Material::default().with_friction(body.friction as f32).with_restitution(body.restitution as f32);
    let shape = |geometry| ShapeDesc::new(geometry).with_material(material);
    world.add_body(&BodyDesc::fixed().with_shape(shape(Geometry::Plane)))?;
    let radius = POINT * body.gyration;
    let mut point = shape(Geometry::Sphere { radius: radius as f32 });
    point.position = DVec3::new(impact.arm.x, impact.arm.y + radius, 0.0).as_vec3();
    let inertia = Mat3::from_diagonal(Vec3::splat(gyration * gyration));
    let desc = BodyDesc::dynamic()
        .with_mass(Some(MassProperties { mass: 1.0, centre_of_mass: Vec3::ZERO, inertia }))
        .with_position(DVec3::NEG_Y * impact.arm.y)
        .with_velocity(impact.before.velocity.extend(0.0).as_vec3(), Vec3::Z * impact.before.spin as f32)
        .with_shape(point);
    let thrown = world.add_body(&desc)?;
    let least = 1e-6 * impact.before.at(impact.arm).y;
    let mut found = impact.before;
    for _ in 0..MOST_STEPS {
        world.step(dt)?;
        let turn = world.rotation(thrown)?.as_dquat();
        found = Motion {
            velocity: world.linear_velocity(thrown)?.as_dvec3().truncate(),
            spin: f64::from(world.angular_velocity(thrown)?.z),
        };
        // From the centre to the lowest point of the ball.
        let centre = turn * impact.arm.extend(0.0) + turn * (DVec3::Y * radius);
        if found.at(centre.truncate() - DVec2::Y * radius).y >= least {
            break;
        }
    }
    Ok(found)
}
