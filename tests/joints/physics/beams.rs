//! Thin beams that carry heavy loads on hinges and welds: cranes, trebuchets, doors. About its length a beam
//! has next to no inertia, and the load's, which the hinge turns with it, is up to a million times as large.
//!
//! The mobility of such a beam was once lost in rounding: a trebuchet of an arm of 19 kg and a counterweight
//! of 2 t gained energy out of its plane in two of three substeps, was damped for it, and stopped in mid-air.

use super::{ground, world_with};
use crate::common::random::Random;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Geometry, JointDesc, ShapeDesc, World};

/// A beam on a hinge to the ground, a load on a hinge or a weld at its end, both in the plane across `axis`.
struct Beam {
    world: World,
    bodies: [BodyHandle; 2],
    axis: DVec3,
    length: f64,
    /// Kinetic energy that the load can reach by falling [J].
    scale: f64,
}

impl Beam {
    fn new(seed: u64, substeps: u32, welded: bool) -> Beam {
        let random = &mut Random(seed);
        let mut world = world_with(Vec3::NEG_Y * 9.81, (substeps, 1));
        let ground = ground(&mut world);
        let length = random.range(0.5, 5.0);
        let thin = length / random.range(10.0, 60.0);
        let heavy = random.range(5.0, 150.0);
        // Some way off the level, and turned anyhow about the vertical.
        let frame = Quat::from_rotation_y(random.range(0.0, 6.0));
        let tilt = frame * Quat::from_rotation_z(random.range(-1.0, 1.0));
        let geometry = Geometry::cuboid(0.5 * length, 0.5 * thin, 0.5 * thin);
        let beam = BodyDesc::dynamic().with_rotation(tilt).with_shape(ShapeDesc::new(geometry));
        let beam = world.add_body(&beam).unwrap();
        let mass = heavy * world.mass(beam).unwrap();
        let hangs = random.range(0.05, 0.3) * length;
        let half =
            Vec3::new(random.range(0.02, 0.1), random.range(0.02, 0.1), random.range(0.02, 0.1)) * length;
        let end = tilt * Vec3::X * (0.5 * length);
        let density = mass / (8.0 * half.x * half.y * half.z);
        let shape = ShapeDesc::new(Geometry::cuboid(half.x, half.y, half.z)).with_density(density);
        let load = BodyDesc::dynamic().with_position(end - Vec3::Y * hangs).with_rotation(frame);
        let load = world.add_body(&load.with_shape(shape)).unwrap();
        let (axis, axle) = (frame * Vec3::Z, -end * random.range(0.0, 1.0));
        let mut join = |pair, at: Vec3, make: fn([BodyHandle; 2], _) -> JointDesc| {
            let frames = world.frames_about(pair, at.as_dvec3(), axis).unwrap();
            world.add_joint(&make(pair, frames)).unwrap();
        };
        join([ground, beam], axle, JointDesc::hinge);
        join([beam, load], end, if welded { JointDesc::fixed } else { JointDesc::hinge });
        Beam {
            scale: f64::from(mass * 9.81 * 2.0 * (end - axle).length()),
            world,
            bodies: [beam, load],
            axis: axis.as_dvec3(),
            length: length.into(),
        }
    }

    /// Steps at a rate, and returns least and greatest energy within some seconds, as shares of the scale
    /// above that at the start, and how many steps damped it.
    fn watch(&mut self, hz: u32, seconds: u32) -> (f64, f64, u32) {
        let start = self.world.energy();
        let (mut low, mut high, mut damped) = (0.0_f64, 0.0_f64, 0);
        for _ in 0..hz * seconds {
            self.world.step(1.0 / hz as f32).unwrap();
            let energy = (self.world.energy() - start) / self.scale;
            (low, high) = (low.min(energy), high.max(energy));
            damped += self.world.report().damped_trees;
        }
        (low, high, damped)
    }

    /// How far bodies have left the plane in which they swing, as a share of the beam's length.
    fn off_plane(&self) -> f64 {
        let off = |&body: &BodyHandle| self.axis.dot(self.world.position(body).unwrap()).abs();
        self.bodies.iter().map(off).fold(0.0, f64::max) / self.length
    }
}

/// Pendulums conserve energy: none gains more than `most`, as a share of its scale. Where a hinged load of up
/// to 150 times the beam's mass makes it whip, it may lose up to nine tenths.
fn check(seeds: std::ops::Range<u64>, most: f64) {
    let mut wrong = Vec::new();
    for seed in seeds {
        for welded in [false, true] {
            for (hz, substeps) in [(30, 4), (60, 4), (120, 2)] {
                let mut beam = Beam::new(seed, substeps, welded);
                let (low, high, damped) = beam.watch(hz, 20);
                let off = beam.off_plane();
                if !(high < most && off < OFF_PLANE && low > -0.9) {
                    wrong.push(format!(
                        "{seed} at {hz} Hz, welded: {welded}: {low:.4} to {high:.4}, {damped} damped, {off:.1e}"
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// How far a beam may leave the plane that hinges hold it in, as a share of its length.
const OFF_PLANE: f64 = 1e-3;

#[test]
fn thin_beams_swing_heavy_loads_in_their_plane() {
    check(0..24, 0.02);
}

/// 2,400 runs: about 20 gain 2 to 6 %, slowly and alike at 60 and 120 Hz, and one gains 28 % at 30 Hz. Before
/// bodies counted as thicker 177 gained more than their scale.
#[test]
#[ignore = "half a minute"]
fn thin_beams_of_many_seeds() {
    check(0..400, 0.3);
}
