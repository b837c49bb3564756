//! The meter adds up: every change of a body's velocity has its cause, in scenes at random.
//! `COUNT=100 cargo test --package backstop-lab --test lab adds_up` runs more of them.

use crate::common;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Frame, Geometry, JointDesc, Material, Settings, ShapeDesc, Skeleton, World,
};
use backstop_lab::LabWorld;
use backstop_scene::Rng;

/// Figures that fall down stairs.
fn stairs(world: &mut World, rng: &mut Rng) {
    let (height, depth) = (rng.range(0.1, 0.4), rng.range(0.2, 0.6));
    for i in 1..12 {
        let top = height * i as f32;
        let shape = ShapeDesc::new(Geometry::cuboid(3.0, 0.5 * top, 0.5 * depth));
        let at = Vec3::new(0.0, 0.5 * top, -depth * i as f32);
        world.add_body(&BodyDesc::fixed().with_position(at).with_shape(shape)).unwrap();
    }
    for i in 0..2 {
        let at = DVec3::new(1.5 * f64::from(i), f64::from(12.5 * height), f64::from(-11.0 * depth));
        let push = rng.direction() * rng.range(0.0, 4.0) + Vec3::Z * 2.0;
        let figure = Skeleton::humanoid().with_friction(rng.range(0.0, 5.0));
        figure.add_to(world, at, Quat::from_rotation_y(rng.range(0.0, 6.0)), push).unwrap();
    }
}

/// Chains of bodies of unequal masses, some of which hang; their ends swing into a heap.
fn chains(world: &mut World, rng: &mut Rng) {
    for i in 0..3 {
        let post =
            world.add_body(&BodyDesc::fixed().with_position(Vec3::new(2.0 * i as f32, 6.0, 0.0))).unwrap();
        let mut last = post;
        let mut at = Vec3::new(2.0 * i as f32, 6.0, 0.0);
        let way = rng.direction();
        for k in 0..6 {
            let half = Vec3::new(rng.range(0.05, 0.2), rng.range(0.05, 0.2), rng.range(0.05, 0.2));
            let reach = if k == 0 { 0.0 } else { 0.3 };
            at += way * (reach + 0.3);
            let density = 30.0 * libm::powf(200.0, rng.range(0.0, 1.0));
            let shape = ShapeDesc::new(Geometry::cuboid(half.x, half.y, half.z)).with_density(density);
            let spin = rng.direction() * rng.range(0.0, 10.0);
            let body =
                BodyDesc::dynamic().with_position(at).with_shape(shape).with_velocity(Vec3::ZERO, spin);
            let body = world.add_body(&body).unwrap();
            if k > 0 || i > 0 {
                join(world, [last, body], [way * reach, way * -0.3], rng);
            }
            last = body;
        }
    }
    heap(world, rng);
}

fn join(world: &mut World, bodies: [BodyHandle; 2], at: [Vec3; 2], rng: &mut Rng) {
    let frames = at.map(|position| Frame { position, rotation: Quat::IDENTITY });
    let desc = match rng.bits() % 4 {
        0 | 1 => JointDesc::ball(bodies, frames),
        2 => JointDesc::hinge(bodies, frames),
        _ => JointDesc::fixed(bodies, frames),
    };
    world.add_joint(&desc).unwrap();
}

/// Bodies of many shapes that fall on each other, fast ones among them, with restitution.
fn heap(world: &mut World, rng: &mut Rng) {
    for _ in 0..25 {
        let [a, b, c] = [0; 3].map(|_| rng.range(0.1, 0.4));
        let geometry = match rng.bits() % 4 {
            0 => Geometry::cuboid(a, b, c),
            1 => Geometry::Sphere { radius: a },
            2 => Geometry::Capsule { half_height: a, radius_bottom: b, radius_top: b },
            _ => Geometry::Cylinder { half_height: a, radius_bottom: b, radius_top: b },
        };
        let material = Material::default()
            .with_friction(rng.range(0.0, 1.5))
            .with_restitution((rng.range(-1.0, 0.9)).max(0.0));
        let at = Vec3::new(rng.range(-2.0, 6.0), rng.range(0.5, 5.0), rng.range(-1.5, 1.5));
        let fast = if rng.bits().is_multiple_of(5) { 60.0 } else { 3.0 };
        let shape = common::shape(geometry, material);
        let body = BodyDesc::dynamic().with_position(at).with_shape(shape);
        let body = body.with_velocity(rng.direction() * rng.range(0.0, fast), rng.direction() * fast * 0.3);
        world.add_body(&body).unwrap();
    }
}

/// Newton's second law: what changes the momentum of a body is gravity and the impulses of rows. What is left
/// is rounding: bodies and impulses are single precision, 6e-8, over the passes of four substeps. One in a
/// hundred runs of more seeds has a step, about the first impact, with up to 3 m/s that have no cause here.
#[test]
fn every_change_of_momentum_has_its_cause() {
    let count = std::env::var("COUNT").ok().and_then(|count| count.parse().ok()).unwrap_or(2_u64);
    for seed in 0..count {
        for (k, build) in [stairs, chains, heap].iter().enumerate() {
            for hz in [30.0_f32, 60.0, 120.0] {
                let mut rng = Rng::new(seed);
                let mut world = World::new(Settings::default()).unwrap();
                world.measure_accuracy(true);
                world.add_body(&common::Floor::Box.desc(Material::default())).unwrap();
                build(&mut world, &mut rng);
                let mut worst = (0.0_f64, 0.0_f64, 0);
                for n in 0..(4.0 * hz) as u32 {
                    world.step(1.0 / hz).unwrap();
                    let system = world.system().unwrap();
                    let speeds = |v: &[DVec3; 2]| v[0].length();
                    let fastest = system.bodies.iter().map(|b| speeds(&b.start).max(speeds(&b.end)));
                    let given = system.rows.iter().flat_map(|row| {
                        row.bodies.iter().enumerate().filter_map(|(side, body)| {
                            let mass = system.bodies[(*body)?].inverse_mass;
                            Some((mass * row.linear[side] * row.impulse).length())
                        })
                    });
                    let scale = fastest.chain(given).fold(0.1, f64::max);
                    let measures = &world.accuracy().unwrap().whole;
                    let share = measures.unexplained / scale;
                    if share > worst.0 {
                        worst = (share, measures.unexplained, n);
                    }
                }
                assert!(worst.0 < 5e-6, "seed {seed}, kind {k}, {hz} Hz: {worst:?}");
            }
        }
    }
}
