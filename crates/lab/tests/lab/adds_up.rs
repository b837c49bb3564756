//! The meter's books: every change of momentum has its cause.

use crate::common;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, Geometry, Material, Settings, ShapeDesc, Skeleton, World};
use backstop_lab::LabWorld;
use backstop_scene::Rng;

fn step(world: &mut World, i: u32, height: f32, depth: f32) {
    let top = height * i as f32;
    let at = Vec3::new(0.0, 0.5 * top, -depth * i as f32);
    let shape = ShapeDesc::new(Geometry::cuboid(3.0, 0.5 * top, 0.5 * depth));
    world.add_body(&BodyDesc::fixed().with_position(at).with_shape(shape)).unwrap();
}

#[test]
fn probe() {
    let count: u64 = std::env::var("COUNT").ok().and_then(|v| v.parse().ok()).unwrap_or(4);
    for seed in 0..count {
        for hz in [30.0_f32, 60.0, 120.0] {
            let mut rng = Rng::new(seed);
            let mut world = World::new(Settings::default()).unwrap();
            world.measure_accuracy(true);
            world.add_body(&common::Floor::Box.desc(Material::default())).unwrap();
            for i in 1..12 {
                step(&mut world, i, 0.25, 0.35);
            }
            let figure = Skeleton::humanoid().with_friction(3.0);
            let at = DVec3::new(0.0, 3.2, -3.4);
            let _ = rng.bits();
            figure.add_to(&mut world, at, Quat::from_rotation_y(seed as f32), Vec3::new(0.0, 0.0, 3.5)).unwrap();
            let mut worst = [(0.0, 0); 3];
            let mut sum = [0.0; 2];
            for n in 0..(6.0 * hz) as u32 {
                world.step(1.0 / hz).unwrap();
                let system = world.system().unwrap();
                let load: f64 = system.laws[..system.contacts].iter().filter(|l| l.gap.is_some()).map(|l| system.rows[l.first].impulse).sum();
                let m = &world.accuracy().unwrap().whole;
                for (w, v) in worst.iter_mut().zip([m.momentum, m.angular_momentum, m.unexplained]) {
                    if v > w.0 { *w = (v, n); }
                }
                sum[0] += m.momentum;
                sum[1] += load;
            }
            println!("seed {seed} {hz} Hz: worst {worst:?} sums {sum:?}");
        }
    }
}
