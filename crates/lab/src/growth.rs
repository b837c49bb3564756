//! The growth of a displacement along the world's actual trajectory.

use super::Probe;
use super::arnoldi::{noise, norm};
use super::map::copy_of;
use backstop::Error;
use backstop::Snapshot;
use backstop::World;
use backstop::limits::within;
use backstop::observe::StateLayout;

/// Time after which the two worlds are brought close together again [s].
const EVERY: f32 = 0.5;

/// The rate at which two worlds that differ by a little diverge [1/s], over the second half of `seconds`: the
/// largest Lyapunov exponent (Benettin et al., *Lyapunov Characteristic Exponents*, 1980). The difference is
/// brought back to the probe's displacement every half second. It checks [`stability`](super::stability),
/// which linearises about one state.
///
/// # Errors
/// As [`stability`](super::stability).
pub fn growth(world: &World, probe: &Probe, seconds: f32) -> Result<f64, Error> {
    probe.validate()?;
    within("seconds", seconds, EVERY, 1e6, "at least half a second")?;
    let mut now = Snapshot::new();
    let mut one = copy_of(world, &mut now)?;
    let mut other = World::new(one.settings().clone())?;
    other.restore(&now)?;
    let layout = StateLayout::of(&mut one, probe.dt / world.settings().substeps as f32);
    let mut random = noise(probe.seed);
    let mut apart: Vec<f64> = (0..layout.variables()).map(|_| random()).collect();
    let steps = (EVERY / probe.dt).round().max(1.0) as u32;
    let rounds = (seconds / EVERY).ceil() as u32;
    let (mut sum, mut time) = (0.0, 0.0);
    for round in 0..rounds {
        let greatest = apart.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        if greatest == 0.0 {
            return Ok(f64::NEG_INFINITY);
        }
        one.snapshot(&mut now);
        other.restore(&now)?;
        let scale = probe.displacement / greatest;
        layout.displace(&mut other, &apart, scale);
        let before = norm(&apart) * scale;
        for _ in 0..steps {
            one.step(probe.dt)?;
            other.step(probe.dt)?;
        }
        apart = layout.difference(&mut other, &mut one).0;
        if round >= rounds / 2 {
            sum += (norm(&apart) / before).ln();
            time += f64::from(steps) * f64::from(probe.dt);
        }
    }
    Ok(sum / time)
}
