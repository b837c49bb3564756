//! A small world with everything in it, for as long as you like: bodies come and go, sleep and wake, explode,
//! are joined, switched off and carried about, and the ground is rebuilt, all by a seeded draw. Two worlds do
//! the same on one thread and on two; they must have the same hash at every look, lose nobody, stay finite,
//! and take no more memory than they did early on.
//!
//!     cargo run --release --example soak -- 1000000
//!
//! Without arguments 2,000 steps.

#[path = "../src/random.rs"]
mod random;

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Error, Frame, Geometry, JointDesc, JointHandle, Settings, ShapeDesc, TriangleMesh,
    World,
};
use random::Random;
use std::sync::Arc;

/// Half of the room [m], and the thickness of its walls.
const ROOM: f32 = 8.0;
const WALL: f32 = 0.2;
/// Bodies: fewer get company, more are thinned out. Enough for two threads to share a step.
const BODIES: std::ops::Range<usize> = 140..200;
const DT: f32 = 1.0 / 60.0;
/// Steps between two looks at everything.
const LOOK: u64 = 500;

struct Soak {
    world: World,
    random: Random,
    bodies: Vec<BodyHandle>,
    joints: Vec<JointHandle>,
    ground: BodyHandle,
    lift: BodyHandle,
    lost: u64,
}

impl Soak {
    fn new(threads: usize) -> Result<Soak, Error> {
        let mut world = World::new(Settings::default().with_threads(threads).with_sleeping(true))?;
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for side in [-1.0, 1.0] {
                let half_extents = (Vec3::ONE - axis) * (ROOM + 2.0 * WALL) + axis * WALL;
                let wall = BodyDesc::fixed().with_position(axis * side * (ROOM + WALL));
                world.add_body(&wall.with_shape(ShapeDesc::new(Geometry::Box { half_extents })))?;
            }
        }
        let mut random = Random(1);
        let ground = world.add_body(&ground(&mut random)?)?;
        let plate = ShapeDesc::new(Geometry::cuboid(1.5, 0.1, 1.5));
        let lift = world.add_body(&BodyDesc::kinematic().with_shape(plate))?;
        let mut soak = Soak { world, random, bodies: Vec::new(), joints: Vec::new(), ground, lift, lost: 0 };
        while soak.bodies.len() < BODIES.start {
            soak.add()?;
        }
        Ok(soak)
    }

    fn add(&mut self) -> Result<(), Error> {
        let random = &mut self.random;
        let size = 0.25 + 0.1 * random.signed();
        let geometry = match random.below(4) {
            0 => Geometry::Sphere { radius: size },
            1 => Geometry::capsule(size, 0.5 * size),
            2 => Geometry::cuboid(size, 0.6 * size, 0.3 * size),
            _ => Geometry::cylinder(0.5 * size, 0.5 * size),
        };
        let at = random.cube() * (0.8 * ROOM);
        let body = BodyDesc::dynamic()
            .with_position(DVec3::new(at.x.into(), f64::from(at.y.abs()), at.z.into()))
            .with_velocity(random.cube() * 30.0, random.cube() * 20.0)
            .with_shape(ShapeDesc::new(geometry));
        self.bodies.push(self.world.add_body(&body)?);
        Ok(())
    }

    /// Any of the bodies.
    fn some(&mut self) -> BodyHandle {
        let index = self.random.below(self.bodies.len());
        self.bodies[index]
    }

    /// One change to the world.
    fn change(&mut self) -> Result<(), Error> {
        let body = self.some();
        match self.random.below(12) {
            0 | 1 if self.bodies.len() < BODIES.end => self.add()?,
            2 | 3 if self.bodies.len() > BODIES.start => {
                self.bodies.retain(|&one| one != body);
                self.world.remove_body(body)?;
                // Joints go with their bodies.
                let world = &self.world;
                self.joints.retain(|&joint| world.contains_joint(joint));
            }
            4 => self.world.wake(body)?,
            5 => self.world.sleep(body)?,
            6 => self.explode(body)?,
            7 => {
                let other = self.some();
                if other != body && self.joints.len() < 40 {
                    let frames = [Frame::at(Vec3::Y * 0.4), Frame::at(Vec3::NEG_Y * 0.4)];
                    self.joints.push(self.world.add_joint(&JointDesc::distance(
                        [body, other],
                        frames,
                        0.0,
                        4.0,
                    ))?);
                }
            }
            8 if !self.joints.is_empty() => {
                let index = self.random.below(self.joints.len());
                self.world.remove_joint(self.joints.swap_remove(index))?;
            }
            9 => {
                let enabled = self.world.is_enabled(body)?;
                self.world.set_enabled(body, !enabled)?;
            }
            10 => {
                let velocity = self.random.cube() * Vec3::new(2.0, 0.5, 2.0);
                let at = self.world.position(self.lift)?.as_vec3();
                // Back to the middle if it strays.
                let velocity = if at.length() > 0.5 * ROOM { -at * 0.3 } else { velocity };
                self.world.set_velocity(self.lift, velocity, Vec3::Y * self.random.signed())?;
            }
            11 if self.random.below(50) == 0 => {
                self.world.remove_body(self.ground)?;
                self.ground = self.world.add_body(&ground(&mut self.random)?)?;
            }
            _ => {}
        }
        Ok(())
    }

    /// Throws all that is near away from a body.
    fn explode(&mut self, centre: BodyHandle) -> Result<(), Error> {
        let at = self.world.position(centre)?;
        for &body in &self.bodies {
            let way = (self.world.position(body)? - at).as_vec3();
            if body != centre && way.length() < 3.0 && self.world.is_enabled(body)? {
                let impulse = (way.normalize_or_zero() + Vec3::Y) * 500.0;
                self.world.apply_impulse_at(body, impulse, self.world.position(body)?)?;
            }
        }
        Ok(())
    }

    /// Puts back who is not in the room, and counts them: whoever was added or switched on in a wall or in
    /// the ground may leave by the nearest side; no one else may.
    fn look(&mut self) -> Result<(), Error> {
        for i in 0..self.bodies.len() {
            let body = self.bodies[i];
            let (at, spin) = (self.world.position(body)?, self.world.angular_velocity(body)?);
            assert!(at.is_finite() && spin.is_finite() && self.world.linear_velocity(body)?.is_finite());
            if at.abs().max_element() > f64::from(ROOM) {
                self.lost += 1;
                self.world.set_pose(body, DVec3::ZERO, Quat::IDENTITY)?;
            }
        }
        Ok(())
    }
}

/// A bumpy floor.
fn ground(random: &mut Random) -> Result<BodyDesc, Error> {
    const CELLS: u32 = 16;
    let mut vertices = Vec::new();
    for i in 0..(CELLS + 1) * (CELLS + 1) {
        let side = |n: u32| (n as f32 / CELLS as f32 - 0.5) * 2.0 * ROOM;
        vertices.push(Vec3::new(
            side(i % (CELLS + 1)),
            0.4 * random.signed() - ROOM + 0.6,
            side(i / (CELLS + 1)),
        ));
    }
    let mut triangles = Vec::new();
    for i in (0..CELLS).flat_map(|row| (0..CELLS).map(move |column| row * (CELLS + 1) + column)) {
        let [b, c, d] = [i + 1, i + CELLS + 1, i + CELLS + 2];
        triangles.extend([[i, c, b], [b, c, d]]);
    }
    let mesh = TriangleMesh::new(vertices, triangles)?;
    Ok(BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Mesh(Arc::new(mesh)))))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let steps: u64 = std::env::args().nth(1).map_or(Ok(2_000), |n| n.parse())?;
    let mut soaks = [Soak::new(1)?, Soak::new(2)?];
    let (mut early, mut late) = (0, 0);
    for step in 0..steps {
        for soak in &mut soaks {
            soak.change()?;
            soak.world.step(DT)?;
            if step % LOOK == 0 {
                soak.look()?;
            }
        }
        let [one, two] = &soaks;
        if step % LOOK == 0 {
            assert_eq!(
                one.world.state_hash(),
                two.world.state_hash(),
                "one and two threads part by step {step}"
            );
            let bytes = one.world.memory().total();
            if step < steps / 5 { early = early.max(bytes) } else { late = late.max(bytes) }
        }
        if step % (steps / 10).max(LOOK) == 0 {
            println!(
                "step {step:8}  {:3} bodies, {:2} joints, {:3} asleep, {:4} KiB, {} out of the room, hash {:016x}",
                one.bodies.len(),
                one.joints.len(),
                one.world.report().asleep,
                one.world.memory().total() / 1024,
                one.lost,
                one.world.state_hash()
            );
        }
    }
    let lost = soaks[0].lost;
    println!(
        "{steps} steps: most memory {early} bytes in the first fifth, {late} after; {lost} out of the room"
    );
    // A short run has no early part to compare with.
    assert!(steps < 50 * LOOK || late <= early + early / 4, "memory grew from {early} to {late} bytes");
    Ok(())
}
