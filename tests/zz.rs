use backstop::glam::*;
use backstop::*;
use std::f32::consts::PI;
#[test]
fn zz() {
    for (sub, it, contacts) in [(4u32, 1u32, false), (8, 1, false), (16, 1, false), (4, 1, true)] {
        let mut world = World::new(Settings { substeps: sub, iterations: it, ..Settings::default() }).unwrap();
        let top = world.add_body(&BodyDesc::fixed()).unwrap();
        let along = Vec3::X;
        let turn = Quat::from_rotation_arc(Vec3::Y, along);
        let (half, radius) = (0.15_f32, 0.05_f32);
        let pitch = 2.0 * (half + radius);
        let mut bodies = vec![top];
        let mut joints = Vec::new();
        let filter = if contacts { Filter::default() } else { Filter { group: -1, ..Filter::default() } };
        for i in 0..20 {
            let mut s = ShapeDesc::new(Geometry::capsule(half, radius)); s.filter = filter;
            bodies.push(world.add_body(&BodyDesc::dynamic().at(along * pitch * (i as f32 + 0.5)).rotated(turn).with_shape(s)).unwrap());
        }
        let light = world.mass(bodies[1]).unwrap();
        let mut ball = ShapeDesc::new(Geometry::Sphere { radius: 0.5 });
        ball.filter = filter;
        ball.density = 1000.0 * light / (4.0 / 3.0 * PI * 0.125);
        bodies.push(world.add_body(&BodyDesc::dynamic().at(along * (pitch * 20.0 + 0.5)).with_shape(ball)).unwrap());
        for (i, pair) in bodies.windows(2).enumerate() {
            let f = world.frames_at([pair[0], pair[1]], (along * pitch * i as f32).as_dvec3(), Quat::IDENTITY).unwrap();
            joints.push(world.add_joint(&JointDesc::ball([pair[0], pair[1]], f)).unwrap());
        }
        let mut widest = 0.0_f64;
        let e0 = world.energy();
        for step in 0..300 {
            world.step(1.0 / 60.0).unwrap();
            let gap = |j: &JointHandle| { let [(a, _), (b, _)] = world.joint_frames(*j).unwrap(); (b - a).length() };
            widest = joints.iter().map(gap).fold(widest, f64::max);
            if step % 20 == 19 {
                let (k, g) = joints.iter().map(gap).enumerate().fold((0, 0.0), |m, x| if x.1 > m.1 { x } else { m });
                let w = bodies[1..].iter().map(|b| world.angular_velocity(*b).unwrap().length()).fold(0.0, f32::max);
                println!("{sub} {it} {contacts} {step}: gap {g:.5} at {k} widest {widest:.5} spin {w:.1} e {:.1} contacts {}", world.energy() - e0, world.report().manifolds);
            }
        }
    }
}
