//! Seeded shots at bodies that can move themselves, where no static geometry is: free plates, doors, stacks
//! and crowds.

use super::draw::{generator, log_range, pick, step_lengths, until};
use super::shot::MODES;
use crate::rng::Rng;
use backstop::BodyHandle;
use backstop::Error;
use backstop::World;
use backstop::{BodyDesc, BodyKind};
use backstop::{ContinuousMode, Settings};
use backstop::{Frame, JointDesc};
use backstop::{Geometry, ShapeDesc};
use glam::{DVec3, Quat, Vec3};

/// Names of the targets that can move.
pub const MOVING_TARGETS: [&str; 4] = ["free_plate", "hinged_plate", "stack", "crowd"];

/// Half widths of plates along y and z, and of the boxes of stacks and crowds [m].
const PLATE: [f32; 2] = [0.6, 0.8];
const BRICK: Vec3 = Vec3::new(0.05, 0.1, 0.2);
const CUBE: f32 = 0.1;
/// Share of a box's half widths within which a centre has got through its surface for good.
const INNER: f64 = 0.5;
/// Makes the shots differ from those at static targets with the same seed.
const OWN: u64 = 0x5EED;
/// Time that is simulated after the impact [s].
const AFTER: f32 = 0.2;
/// Steps at most.
const MAX_STEPS: usize = 30;

/// A bullet on its way to bodies that can move.
#[derive(Clone, Debug)]
pub struct MovingShot {
    /// Index in [`MOVING_TARGETS`].
    pub target: usize,
    /// Length of each step [s].
    pub steps: Vec<f32>,
    /// The bullet.
    pub bullet: BodyDesc,
    /// The target: boxes, each one shape.
    pub boxes: Vec<(BodyDesc, Vec3)>,
}

impl MovingShot {
    /// The shot of that number: a bullet of 5 mm to 5 cm at 50 to 1,000 m/s, on its way along -x within 45
    /// degrees.
    pub fn new(seed: u64, number: u64) -> MovingShot {
        let mut rng = generator(seed ^ OWN, number);
        let target = (number % MOVING_TARGETS.len() as u64) as usize;
        let small = |rng: &mut Rng| log_range(rng, 0.005, 0.05);
        let geometry = match pick(&mut rng, 4) {
            0 => Geometry::Sphere { radius: small(&mut rng) },
            1 => Geometry::capsule(small(&mut rng), small(&mut rng)),
            2 => Geometry::cylinder(small(&mut rng), small(&mut rng)),
            _ => Geometry::cuboid(small(&mut rng), small(&mut rng), small(&mut rng)),
        };
        let boxes = boxes(target, &mut rng);
        let speed = log_range(&mut rng, 50.0, 1000.0);
        let spin = rng.direction() * rng.range(0.0, 200.0);
        let (steps, _) = step_lengths(&mut rng, MAX_STEPS);
        let reach = geometry.radius();
        let front = boxes.iter().map(|(desc, half)| desc.position.x as f32 + half.x).fold(0.0, f32::max);
        let aside = Vec3::new(0.0, rng.range(-0.7, 0.7), rng.range(-0.7, 0.7));
        let direction = (Vec3::NEG_X + aside).normalize();
        let aim = Vec3::new(front, rng.range(-0.2, 0.2), rng.range(-0.3, 0.3));
        let away = 2.0 * reach + 0.01 + speed * steps[0] * rng.range(0.0, 1.5);
        let shape = ShapeDesc::new(geometry).with_density(log_range(&mut rng, 100.0, 8000.0));
        let bullet = BodyDesc::dynamic()
            .with_position((aim - direction * away).as_dvec3())
            .with_rotation(rng.rotation())
            .with_velocity(direction * speed, spin)
            .with_shape(shape);
        MovingShot { target, steps: until(steps, away / speed + AFTER), bullet, boxes }
    }

    /// Runs it, with the guard or without. Says whether the bullet's centre got into the middle of any box,
    /// which is halfway through it: within half of its half widths, on the straight way from step to step as
    /// the box sees it.
    ///
    /// # Errors
    /// None that a shot of [`MovingShot::new`] should give.
    pub fn passes(&self, mode: ContinuousMode, guard: bool) -> Result<bool, Error> {
        let settings = Settings::default().with_continuous(mode).with_guard(guard).with_gravity(Vec3::ZERO);
        let mut world = World::new(settings)?;
        let mut boxes: Vec<(BodyHandle, DVec3)> = Vec::new();
        for (desc, half) in &self.boxes {
            boxes.push((world.add_body(desc)?, half.as_dvec3()));
        }
        if MOVING_TARGETS[self.target] == "hinged_plate"
            && let (Some(&(plate, half)), Some((desc, _))) = (boxes.first(), self.boxes.first())
        {
            let post = world.add_body(&BodyDesc::new(BodyKind::Static))?;
            // The axis of a hinge is x of its frames: here the edge along z.
            let (edge, along_z) =
                (Vec3::Y * half.y as f32, Quat::from_rotation_y(-std::f32::consts::FRAC_PI_2));
            let frame = |position| Frame { position, rotation: along_z };
            let frames = [frame(desc.position.as_vec3() + edge), frame(edge)];
            world.add_joint(&JointDesc::hinge([post, plate], frames))?;
        }
        let bullet = world.add_body(&self.bullet)?;
        let seen_from = |world: &World, body| -> Result<DVec3, Error> {
            let way = world.centre_of_mass(bullet)? - world.position(body)?;
            Ok(world.rotation(body)?.as_dquat().conjugate() * way)
        };
        let places = |world: &World| -> Result<Vec<DVec3>, Error> {
            boxes.iter().map(|&(body, _)| seen_from(world, body)).collect()
        };
        let mut before = places(&world)?;
        for &dt in &self.steps {
            world.step(dt)?;
            let now = places(&world)?;
            let through = |((&(_, half), &a), &b): ((&(BodyHandle, DVec3), &DVec3), &DVec3)| {
                crosses(a, b, half * INNER)
            };
            if boxes.iter().zip(&before).zip(&now).any(through) {
                return Ok(true);
            }
            before = now;
        }
        Ok(false)
    }
}

impl MovingShot {
    /// Runs it under each of [`MODES`], with the guard and without: whether it passes.
    ///
    /// # Errors
    /// As [`MovingShot::passes`].
    pub fn run_all(&self) -> Result<[[bool; 3]; 2], Error> {
        let [discrete, segment, volume] = MODES.map(|mode| self.passes(mode, true));
        let discrete = discrete?;
        // Without continuous collision there is no guard.
        let unguarded = [discrete, self.passes(MODES[1], false)?, self.passes(MODES[2], false)?];
        Ok([[discrete, segment?, volume?], unguarded])
    }
}

/// Whether a segment meets a box around the origin.
fn crosses(a: DVec3, b: DVec3, half: DVec3) -> bool {
    let way = b - a;
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for axis in 0..3 {
        if way[axis] == 0.0 {
            if a[axis].abs() > half[axis] {
                return false;
            }
            continue;
        }
        let (t, u) = ((-half[axis] - a[axis]) / way[axis], (half[axis] - a[axis]) / way[axis]);
        (enter, leave) = (enter.max(t.min(u)), leave.min(t.max(u)));
    }
    enter <= leave
}

fn boxes(target: usize, rng: &mut Rng) -> Vec<(BodyDesc, Vec3)> {
    let one = |half: Vec3, at: Vec3| {
        let shape = ShapeDesc::new(Geometry::Box { half_extents: half });
        (BodyDesc::dynamic().with_position(at.as_dvec3()).with_shape(shape), half)
    };
    match MOVING_TARGETS[target] {
        // 1 to 5 cm thick.
        "free_plate" | "hinged_plate" => {
            vec![one(Vec3::new(log_range(rng, 0.005, 0.025), PLATE[0], PLATE[1]), Vec3::ZERO)]
        }
        // A wall of bricks, one on the other.
        "stack" => {
            let row = |k: i32| {
                (-1..=1).map(move |i| Vec3::new(0.0, 2.0 * k as f32 * BRICK.y, 2.0 * i as f32 * BRICK.z))
            };
            (-2..=2).flat_map(row).map(|at| one(BRICK, at)).collect()
        }
        _ => {
            let mut all = Vec::new();
            for (x, y, z) in (0..27).map(|n| (n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1)) {
                let at = Vec3::new(x as f32, y as f32, z as f32) * (2.2 * CUBE);
                all.push(one(Vec3::splat(CUBE), at));
            }
            all
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_meets_a_box_or_passes_by() {
        let half = DVec3::new(0.1, 1.0, 2.0);
        assert!(crosses(DVec3::X, DVec3::NEG_X, half));
        assert!(!crosses(DVec3::X, DVec3::X * 0.2, half));
        assert!(!crosses(DVec3::new(1.0, 1.5, 0.0), DVec3::new(-1.0, 1.5, 0.0), half));
        assert!(crosses(DVec3::ZERO, DVec3::ZERO, half));
    }

    /// Without continuous collision most fly through: the shots are a test.
    #[test]
    fn most_pass_without_continuous_collision() {
        let mut count = 0;
        for number in 0..200 {
            count += u32::from(MovingShot::new(5, number).passes(ContinuousMode::Discrete, true).unwrap());
        }
        assert!(count > 100, "{count} of 200");
    }
}
