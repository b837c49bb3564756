//! Forces -> velocities: acceleration of the step, world inertia, and the motion it predicts.

use crate::body::{Bodies, Mass, Traits};
use crate::lanes::{Record, Sym3};
use crate::memory::{Buffer, bytes_of};
use crate::threads::{Crew, Shared, per_block};
use crate::world::World;
use glam::{Mat3, Vec3};

/// What is computed of each body before anything collides.
#[derive(Debug, Default)]
pub(crate) struct Forces {
    /// Linear [m/s²] and angular [rad/s²] acceleration.
    pub(crate) acceleration: Vec<Record>,
    /// Inverse inertia in world axes [1/(kg m²)], of dynamic bodies.
    pub(crate) inverse_inertia: Vec<Sym3<f32>>,
    /// Velocities at the start of the step.
    pub(crate) start: Vec<Record>,
    /// Predicted displacement [m] and rotation vector [rad] of the step.
    pub(crate) motion: Vec<Record>,
}

impl Forces {
    /// Calls `f` with each buffer but that of `motion` and the place that it needs for so many bodies that can move, and that
    /// can be pushed.
    pub(crate) fn each(
        &mut self,
        (movers, dynamic): (usize, usize),
        f: &mut dyn FnMut(&mut dyn Buffer, usize),
    ) {
        f(&mut self.acceleration, movers);
        f(&mut self.inverse_inertia, dynamic);
        f(&mut self.start, movers);
    }

    /// Live and reserved bytes, without the predicted motion.
    pub(crate) fn bytes(&self) -> (usize, usize) {
        [bytes_of(&self.acceleration), bytes_of(&self.inverse_inertia), bytes_of(&self.start)]
            .into_iter()
            .fold((0, 0), |s, b| (s.0 + b.0, s.1 + b.1))
    }
}

/// Bodies a block.
const BLOCK: usize = per_block(256, 1);

/// Computes [`Forces`] for a step of `dt` seconds.
pub(crate) fn predict(crew: &Crew<'_>, world: &mut World, dt: f32) {
    let (movers, dynamic) = (world.bodies.movers(), world.bodies.dynamic());
    if world.bodies.locked > 0 {
        // What the caller set about a locked axis must not look like an impact to the rows.
        let bodies = &mut world.bodies;
        bodies.velocity[..dynamic].iter_mut().zip(&bodies.traits).for_each(|(v, traits)| traits.lock(v));
    }
    let Forces { acceleration, inverse_inertia, start, motion } = &mut world.buffers.forces;
    start.clear();
    start.extend_from_slice(&world.bodies.velocity[..movers]);
    acceleration.resize(movers, Record::default());
    motion.resize(movers, Record::default());
    inverse_inertia.resize(dynamic, Sym3::default());
    let bodies = &world.bodies;
    let gravity = world.settings.gravity;
    {
        let acceleration = Shared::new(acceleration);
        let inverse_inertia = Shared::new(inverse_inertia);
        let motion = Shared::new(motion);
        crew.run(movers.div_ceil(BLOCK), &|block| {
            for i in block * BLOCK..((block + 1) * BLOCK).min(movers) {
                let v = bodies.velocity[i];
                let mut pull = Record::default();
                if i < dynamic {
                    let inverse = world_inertia(bodies, i);
                    pull = accelerate(bodies, i, gravity, &inverse);
                    // SAFETY: each body is in one block.
                    unsafe { *inverse_inertia.get(i) = inverse };
                }
                let predicted = Record {
                    linear: v.linear * dt + pull.linear * (0.5 * dt * dt),
                    angular: v.angular * dt,
                    // The angle, for all who ask how far a point gets.
                    pad1: v.angular.length() * dt,
                    ..Record::default()
                };
                // SAFETY: each body is in one block.
                unsafe { (*acceleration.get(i), *motion.get(i)) = (pull, predicted) };
            }
        });
    }
}

fn accelerate(bodies: &Bodies, i: usize, gravity: Vec3, inverse: &Sym3<f32>) -> Record {
    let (mass, traits) = (&bodies.mass[i], &bodies.traits[i]);
    let mut pull = Record { linear: gravity * traits.gravity_scale, ..Record::default() };
    if let Some(force) = bodies.force.get(i) {
        pull.linear += force.linear * mass.inverse;
        let t = force.angular;
        pull.angular = inverse.mul(crate::lanes::Vec3::new(t.x, t.y, t.z)).lane(0);
    }
    if mass.inverse == 0.0 {
        pull.linear = Vec3::ZERO;
    }
    traits.lock(&mut pull);
    pull
}

/// Whether the gyroscopic term matters, which `finish` adds when it turns a body: unequal moments, and enough spin.
pub(crate) fn spins_freely(mass: &Mass, traits: &Traits, spin: Vec3, dt: f32) -> bool {
    let (low, high) = (mass.inertia.min_element(), mass.inertia.max_element());
    let turn = spin.length_squared() * dt * dt;
    high - low > 1e-3 * high && turn > 1e-6 && low > 0.0 && traits.locks == 0
}

/// Inverse inertia in world axes. About a locked axis nothing turns, and the others turn as if it were not there.
pub(crate) fn world_inertia(bodies: &Bodies, i: usize) -> Sym3<f32> {
    let mass = &bodies.mass[i];
    let r = Mat3::from_quat(bodies.pose[i].rotation);
    let locks = bodies.traits[i].locks >> 3;
    let diagonal = |d: Vec3| {
        let column = |row: usize| {
            r.x_axis[row] * d.x * r.x_axis + r.y_axis[row] * d.y * r.y_axis + r.z_axis[row] * d.z * r.z_axis
        };
        [column(0), column(1), column(2)]
    };
    if locks == 0 {
        let [x, y, z] = diagonal(mass.inverse_inertia);
        return Sym3 { xx: x.x, yy: y.y, zz: z.z, xy: x.y, xz: x.z, yz: y.z };
    }
    let [x, y, z] = diagonal(mass.inertia);
    let mut m = Mat3::from_cols(x, y, z);
    for axis in (0..3).filter(|axis| locks >> axis & 1 != 0) {
        for other in 0..3 {
            m.col_mut(axis)[other] = 0.0;
            m.col_mut(other)[axis] = 0.0;
        }
        m.col_mut(axis)[axis] = 1.0;
    }
    let mut inverse = if m.determinant() > 0.0 { m.inverse() } else { Mat3::ZERO };
    for axis in (0..3).filter(|axis| locks >> axis & 1 != 0) {
        inverse.col_mut(axis)[axis] = 0.0;
    }
    let (x, y, z) = (inverse.x_axis, inverse.y_axis, inverse.z_axis);
    Sym3 { xx: x.x, yy: y.y, zz: z.z, xy: x.y, xz: x.z, yz: y.z }
}
