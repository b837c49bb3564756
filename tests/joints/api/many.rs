//! Many joints: at any number of threads, on one body, in a row.

use super::*;

/// A crowd on chains, doors, sliders, wheels and ropes, that falls onto a floor.
fn fair() -> World {
    let mut world = world(G);
    world.add_body(&common::Floor::Plane.desc(Material::default())).unwrap();
    let platform = common::shape(Geometry::cuboid(3.0, 0.1, 3.0), Material::default());
    let platform = world
        .add_body(
            &BodyDesc::kinematic()
                .with_position(DVec3::Y * 0.5)
                .with_velocity(Vec3::ZERO, Vec3::Y * 0.5)
                .with_shape(platform),
        )
        .unwrap();
    let mut random = Random(11);
    for chain in 0..42 {
        let mut last = platform;
        for link in 0..10 {
            let at = DVec3::new(
                f64::from(chain % 7) * 1.5 - 4.5,
                f64::from(link) * 0.45 + 1.0,
                f64::from(chain / 7) * 1.5 - 4.5,
            );
            let geometry = match (chain + link) % 3 {
                0 => Geometry::cuboid(0.15, 0.15, 0.15),
                1 => Geometry::Sphere { radius: 0.2 },
                _ => Geometry::capsule(0.1, 0.1),
            };
            let spin = Vec3::new(0.0, f64::from(chain).sin() as f32, 1.0);
            let body =
                common::dynamic(geometry, Material::default(), at.as_vec3()).with_velocity(Vec3::ZERO, spin);
            let body = world.add_body(&body).unwrap();
            if link > 0 || chain % 6 == 0 {
                let point = at - DVec3::Y * 0.225;
                let frames = world.frames_at([last, body], point, Quat::IDENTITY).unwrap();
                let mut desc = any([last, body], &mut random);
                (desc.frames, desc.collide) = (frames, link % 4 == 0);
                if link == 5 {
                    desc = desc.with_break_force(2000.0, f32::INFINITY);
                }
                world.add_joint(&desc).unwrap();
            }
            last = body;
        }
    }
    world
}

fn fair_after(steps: u32, threads: usize) -> (u64, usize) {
    let mut world = fair();
    world.set_settings(world.settings().clone().with_threads(threads)).unwrap();
    let all = world.joint_count();
    common::steps(&mut world, steps, DT);
    assert!(world.body_count() > 400 && world.report().real > 0 && common::all_finite(&world));
    assert!(world.joint_count() < all && world.joint_count() > all / 2, "some broke, not most");
    (world.state_hash(), world.joint_count())
}

#[test]
fn a_second_run_gives_the_same_bits() {
    assert_eq!(fair_after(60, 1), fair_after(60, 1));
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let alone = fair_after(60, 1);
    for threads in [2, 3, 8] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| fair_after(60, threads)), alone, "{threads} threads");
    }
}

#[test]
fn a_kinematic_platform_drags_a_body() {
    for speed in [0.5_f64, 20.0] {
        let mut world = world(0.0);
        let platform =
            world.add_body(&BodyDesc::kinematic().with_velocity(Vec3::X * speed as f32, Vec3::ZERO)).unwrap();
        let body = world.add_body(&cube(DVec3::Z)).unwrap();
        let frames = world.frames_at([platform, body], DVec3::Z * 0.75, Quat::IDENTITY).unwrap();
        let joint = world.add_joint(&JointDesc::fixed([platform, body], frames)).unwrap();
        common::steps(&mut world, 120, DT);
        // Nothing pushes the platform, and the body stays beside it.
        let (at, with) = (world.position(platform).unwrap(), world.position(body).unwrap());
        assert!((at - DVec3::X * speed * 2.0).length() < 1e-3 * speed, "{at}");
        assert!((with - at - DVec3::Z).length() < 1e-3, "{speed}: {}", with - at);
        let v = world.linear_velocity(body).unwrap();
        assert!((v - Vec3::X * speed as f32).length() < 1e-3 * speed as f32, "{speed}: {v}");
        assert!(world.contains_joint(joint));
    }
    // On a turntable the body goes round: v = w r.
    let mut world = world(0.0);
    let table = world.add_body(&BodyDesc::kinematic().with_velocity(Vec3::ZERO, Vec3::Y * 2.0)).unwrap();
    let body = world.add_body(&ball(DVec3::X)).unwrap();
    let frames = world.frames_at([table, body], DVec3::ZERO, Quat::IDENTITY).unwrap();
    world.add_joint(&JointDesc::fixed([table, body], frames)).unwrap();
    let mut widest = 0.0_f64;
    for step in 0..180 {
        world.step(DT).unwrap();
        if step > 60 {
            widest = widest.max((world.position(body).unwrap().length() - 1.0).abs());
        }
    }
    assert!(widest < 1e-3, "{widest}");
    let v = world.linear_velocity(body).unwrap().length();
    assert!((v - 2.0).abs() < 0.01, "{v}");
}

/// Hangs masses from a hub by so many rods, lets it rest, and gives the rods' worst error [m] and the load of
/// the hub's own joint over all the weight.
fn hub(rods: u32, mass_of_all: f32) -> (f64, f64) {
    let mut world = world(G);
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let lump = |mass: f32, inertia: f32, at: DVec3| {
        let inertia = Mat3::from_diagonal(Vec3::splat(inertia));
        let mass = Some(MassProperties { mass, centre_of_mass: Vec3::ZERO, inertia });
        BodyDesc::dynamic().with_position(at).with_mass(mass)
    };
    let hub = world.add_body(&lump(2000.0, 200.0, DVec3::ZERO)).unwrap();
    let top = world.add_joint(&JointDesc::fixed([ground, hub], [Frame::default(); 2])).unwrap();
    let mut joints = Vec::new();
    for i in 0..rods {
        let angle = f64::from(i) * std::f64::consts::TAU / f64::from(rods);
        let at = DVec3::new(3.0 * angle.cos(), 0.0, 3.0 * angle.sin());
        let mass = mass_of_all / rods as f32;
        let body = world.add_body(&lump(mass, 0.01 * mass, at - DVec3::Y)).unwrap();
        let frames = [Frame::at(at.as_vec3()), Frame::default()];
        joints.push(world.add_joint(&JointDesc::distance([hub, body], frames, 1.0, 1.0)).unwrap());
    }
    common::steps(&mut world, 240, DT);
    assert!(common::all_finite(&world));
    let worst = joints.iter().map(|&joint| {
        let [(a, _), (b, _)] = world.joint_frames(joint).unwrap();
        ((b - a).length() - 1.0).abs()
    });
    let weight = (2000.0 + f64::from(mass_of_all)) * G;
    (worst.fold(0.0, f64::max), f64::from(world.joint_force(top).unwrap().0.y) / weight)
}

/// A body with more than 31 is solved rod by rod, and bears the same.
#[test]
fn a_body_may_have_many_joints() {
    for rods in [6, 31, 32, 60, 300] {
        let (worst, load) = hub(rods, 60.0);
        println!("{rods}: {worst:.2e} {load:.5}");
        assert!(worst < 1e-4, "{rods}: {worst}");
        assert!((load - 1.0).abs() < 1e-3, "{rods}: {load}");
    }
}

/// The rods' masses have five times the hub's moment of inertia about it.
#[test]
fn a_light_body_may_have_many_joints() {
    for rods in [30, 60] {
        let (worst, load) = hub(rods, 240.0);
        println!("{rods}: {worst:.2e} {load:.5}");
        assert!(worst < 1e-2, "{rods}: {worst}");
        assert!((load - 1.0).abs() < 0.05, "{rods}: {load}");
    }
}

/// A ball on a stick: the load has 250 times the ball's own moment of inertia.
#[test]
fn a_long_lever_does_not_sag() {
    for arm in [0.2, 0.5, 1.0] {
        let mut world = world(G);
        let ground = world.add_body(&BodyDesc::fixed()).unwrap();
        let body = world.add_body(&ball(DVec3::X * arm)).unwrap();
        let frames = world.frames_at([ground, body], DVec3::ZERO, Quat::IDENTITY).unwrap();
        world.add_joint(&JointDesc::fixed([ground, body], frames)).unwrap();
        common::steps(&mut world, 240, DT);
        let y = world.position(body).unwrap().y;
        println!("{arm}: {y:.4}");
        assert!(y.abs() < 0.01 * arm, "{arm}: {y}");
    }
}
