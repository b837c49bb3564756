use backstop::glam::{DVec3, Quat, Vec3};
use backstop::*;
use std::f32::consts::*;
use std::sync::Arc;
fn ground(world: &mut World) {
    let s = 50.0;
    let v = vec![Vec3::new(-s, 0., -s), Vec3::new(-s, 0., s), Vec3::new(s, 0., s), Vec3::new(s, 0., -s)];
    let g = Geometry::Mesh(Arc::new(TriangleMesh::new(v, vec![[0, 1, 2], [0, 2, 3]]).unwrap()));
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(g))).unwrap();
}
fn gap(world: &World, j: JointHandle) -> f64 {
    let [(a, _), (b, _)] = world.joint_frames(j).unwrap();
    (b - a).length()
}
fn chain(sub: u32, it: u32, tilt: f32, n: usize) {
    let mut w = World::new(Settings { substeps: sub, iterations: it, ..Settings::default() }).unwrap();
    ground(&mut w);
    let turn = Quat::from_rotation_z(tilt);
    let dir = turn * Vec3::Y;
    let mut js = vec![];
    let mut last = None;
    for i in 0..n {
        let at = DVec3::Y * 1.0 + (dir * (0.25 + 0.5 * i as f32)).as_dvec3();
        let d =
            BodyDesc { linear_velocity: Vec3::NEG_Y * 30.0, rotation: turn, ..BodyDesc::dynamic().at(at) }
                .with_shape(ShapeDesc::new(Geometry::capsule(0.15, 0.1)));
        let b = w.add_body(&d).unwrap();
        if let Some(l) = last {
            let p = DVec3::Y * 1.0 + (dir * (0.5 * i as f32)).as_dvec3();
            let f = w.frames_at([l, b], p, turn).unwrap();
            js.push(w.add_joint(&JointDesc::ball([l, b], f)).unwrap());
        }
        last = Some(b);
    }
    println!("{sub}x{it} tilt {tilt} n {n}");
    for step in 0..12 {
        w.step(1.0 / 60.0).unwrap();
        let g: Vec<String> = js.iter().map(|&j| format!("{:.1}", gap(&w, j) * 1e3)).collect();
        println!("{step}: {} mm", g.join(" "));
    }
}
#[test]
fn two() {
    driven2(Order::default(), (1, 8), 5e4);
}
#[test]
fn one() {
    chain(4, 1, 0.0, 2);
    chain(4, 1, 0.3, 2);
    chain(4, 1, 0.3, 5);
    chain(1, 8, 0.3, 5);
    chain(4, 1, 1.57, 5);
}
/// A door of 2 cm, 1 m wide, that turns about the y axis, driven at 5 rad/s by a motor against a mesh without thickness
/// that stands in its way at 45 degrees. How far its outer edge gets beyond the mesh, and the widest gap in the hinge [m].
fn driven2(order: Order, (substeps, iterations): (u32, u32), torque: f32) -> (f32, f64) {
    let settings = Settings { order, substeps, iterations, ..Settings::default() };
    let mut world = World::new(settings).unwrap();
    let frame = world.add_body(&BodyDesc::fixed()).unwrap();
    let along = Quat::from_rotation_y(FRAC_PI_4) * Vec3::X;
    let corner = |r: f32, y: f32| along * r + Vec3::Y * y;
    let corners = vec![corner(0.4, -3.0), corner(4.0, -3.0), corner(4.0, 3.0), corner(0.4, 3.0)];
    let wall = TriangleMesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let wall = ShapeDesc::new(Geometry::Mesh(Arc::new(wall)));
    world.add_body(&BodyDesc::fixed().with_shape(wall)).unwrap();
    let door = ShapeDesc::new(Geometry::cuboid(0.5, 1.0, 0.01));
    let door = BodyDesc::dynamic().at(DVec3::X * 0.5).with_shape(door);
    let door = world.add_body(&door).unwrap();
    // The frames' x is the world's y.
    let turn = Quat::from_rotation_z(FRAC_PI_2);
    let frames = [Vec3::ZERO, Vec3::X * -0.5].map(|position| Frame { position, rotation: turn });
    let hinge = JointDesc::hinge([frame, door], frames);
    let motor = Drive::motor(Motion::Angular, Axis::X, 5.0, torque);
    let joint = world.add_joint(&hinge.with_drive(motor)).unwrap();
    // Towards the side from which the door comes.
    let normal = along.cross(Vec3::Y);
    let (mut beyond, mut widest) = (0.0_f32, 0.0_f64);
    for k in 0..60 {
        let r = world.step(1.0 / 60.0).unwrap();
        let (re, po) = (r.real, r.potential);
        let (at, turn) = (world.position(door).unwrap().as_vec3(), world.rotation(door).unwrap());
        for y in [-1.0, 1.0] {
            beyond = beyond.max(-normal.dot(at + turn * Vec3::new(0.5, y, 0.0)));
        }
        let f = world.joint_force(joint).unwrap();
        println!(
            "{k}: real {re} pot {po} pos {at:.3} w {:.2} v {:.2} force {:.0?}",
            world.angular_velocity(door).unwrap(),
            world.linear_velocity(door).unwrap(),
            f
        );
        let [(a, _), (b, _)] = world.joint_frames(joint).unwrap();
        widest = widest.max((b - a).length());
    }
    (beyond, widest)
}
