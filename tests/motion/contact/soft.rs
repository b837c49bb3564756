//! Soft contacts: a spring of the material's frequency f acts where shapes overlap, up to a rigid stop.
//!
//! With omega = 2 pi f, a body rests at a depth of g / omega² whatever its mass, and one that falls on the
//! spring with speed v comes to v / omega (with gravity, by energy: omega² x² / 2 = v² / 2 + g x).

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use crate::common::{self, Floor, G, dynamic, shape};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, FrictionModel, Geometry, Material, Settings, Snapshot, World};

const TAU: f64 = std::f64::consts::TAU;

fn soft(hertz: f32, damping: f32) -> Material {
    Material::default().with_contact_hertz(hertz).with_contact_damping(damping)
}

fn world(settings: Settings, floor: Floor, material: Material) -> World {
    let mut world = World::new(settings).unwrap();
    world.add_body(&floor.desc(material)).unwrap();
    world
}

fn height(world: &World, body: BodyHandle) -> f64 {
    world.position(body).unwrap().y
}

/// Energy of a body that does not rotate [J/kg].
fn energy(world: &World, body: BodyHandle) -> f64 {
    let v = f64::from(world.linear_velocity(body).unwrap().length());
    0.5 * v * v + G * height(world, body)
}

fn run(world: &mut World, dt: f32, seconds: f32) {
    common::steps(world, (seconds / dt).round() as u32, dt);
}

/// g / omega², at any rate, with any number of substeps, for any mass and shape.
#[test]
fn a_body_sinks_by_its_weight_on_the_spring() {
    let shapes = [
        (Geometry::sphere(0.5), 0.5),
        (Geometry::cuboid(0.5, 0.5, 0.5), 0.5),
        (Geometry::cuboid(1.2, 0.4, 0.7), 0.4),
        (Geometry::cylinder(0.5, 0.4), 0.5),
    ];
    for (geometry, half) in shapes {
        for floor in [Floor::Box, Floor::Plane, Floor::Mesh] {
            for (hertz, damping) in [(4.0, 1.0), (7.0, 0.3), (10.0, 1.0)] {
                for (rate, substeps, density) in
                    [(30.0, 4, 1.0), (60.0, 4, 1000.0), (60.0, 2, 20.0), (120.0, 1, 5e4), (60.0, 8, 1.0)]
                {
                    let settings = Settings::default().with_substeps(substeps);
                    let mut world = world(settings, floor, soft(hertz, damping));
                    let at = Vec3::new(0.3, half as f32, 0.2);
                    let mut desc = dynamic(geometry.clone(), Material::default(), at);
                    desc.shapes[0].density = density;
                    let body = world.add_body(&desc).unwrap();
                    run(&mut world, 1.0 / rate, 8.0);
                    let depth = half - height(&world, body);
                    let expected = G / (TAU * f64::from(hertz)).powi(2);
                    let name = geometry.kind_name();
                    assert!(
                        (depth - expected).abs() < 0.01 * expected,
                        "{name} {floor:?} {hertz} Hz {rate}/s x{substeps} {density}: {depth} for {expected}"
                    );
                }
            }
        }
    }
}

/// By energy: the depth of the first bounce; and nothing is ever gained. With damping 0 a bounce gives back
/// nearly all.
#[test]
fn a_ball_that_falls_on_a_spring_comes_back_with_its_energy() {
    for floor in [Floor::Box, Floor::Plane, Floor::Mesh] {
        for (hertz, drop) in [(10.0, 0.5), (6.0, 0.3), (10.0, 1.1), (20.0, 1.5)] {
            for (rate, substeps) in [(60.0, 4), (30.0, 8), (120.0, 4), (60.0, 16)] {
                let settings = Settings::default().with_substeps(substeps);
                let mut world = world(settings, floor, soft(hertz, 0.0));
                let at = Vec3::new(0.1, 0.5 + drop, 0.2);
                let body = world.add_body(&dynamic(Geometry::sphere(0.5), Material::default(), at)).unwrap();
                let start = energy(&world, body);
                let (mut deepest, mut highest, mut most) = (0.0_f64, 0.0_f64, 0.0_f64);
                let dt = 1.0 / rate;
                let minute = (60.0 * rate) as u32;
                for step in 0..minute {
                    world.step(dt).unwrap();
                    let depth = 0.5 - height(&world, body);
                    deepest = deepest.max(depth);
                    if depth <= 0.0 {
                        most = most.max(energy(&world, body));
                    }
                    if step >= minute - (2.0 * rate) as u32 {
                        highest = highest.max(height(&world, body) - 0.5);
                    }
                }
                let omega = TAU * f64::from(hertz);
                let sag = G / (omega * omega);
                let expected = sag + (sag * sag + 2.0 * sag * f64::from(drop)).sqrt();
                let name = format!("{floor:?} {hertz} Hz from {drop} m, {rate}/s x{substeps}");
                println!("{name}: depth {deepest:.5} of {expected:.5} m, {most:.6} of {start:.6} J/kg");
                assert!((deepest / expected - 1.0).abs() < 0.05, "{name}: {deepest} for {expected}");
                assert!(most < start * (1.0 + 2e-5), "{name}: energy {start} to {most}");
                assert!(highest > 0.9 * f64::from(drop), "{name}: back at {highest}");
            }
        }
    }
}

/// With damping 1 it does not swing: it comes up no higher than it rests, and sleeps there. Restitution does
/// not count.
#[test]
fn a_ball_on_a_damped_spring_comes_to_rest_and_sleeps() {
    for floor in [Floor::Box, Floor::Plane, Floor::Mesh] {
        for restitution in [0.0, 1.0] {
            let settings = Settings::default().with_sleeping(true);
            let material = soft(8.0, 1.0).with_restitution(restitution);
            let mut world = world(settings, floor, material);
            let at = Vec3::new(0.1, 1.2, 0.2);
            let ball = Material::default().with_restitution(restitution);
            let body = world.add_body(&dynamic(Geometry::sphere(0.5), ball, at)).unwrap();
            let (mut turned, mut slept) = (false, false);
            for step in 0..600 {
                world.step(1.0 / 60.0).unwrap();
                let speed = world.linear_velocity(body).unwrap().y;
                turned |= speed > 0.0;
                assert!(!turned || height(&world, body) < 0.5, "{floor:?} step {step}: it flies up");
                slept |= world.is_sleeping(body).unwrap();
            }
            let sag = G / (TAU * 8.0).powi(2);
            let depth = 0.5 - height(&world, body);
            assert!((depth - sag).abs() < 0.01 * sag && slept, "{floor:?}: {depth} for {sag}, {slept}");
        }
    }
}

/// Bodies that tumble on a spring gain nothing either: looked at while they fly. Boxes and capsules even
/// without damping; the points at the rim of a cylinder are others from step to step, and with them the
/// energy of its spring, so it has some damping.
#[test]
fn what_tumbles_on_a_spring_gains_nothing() {
    let shapes = [
        (Geometry::cuboid(0.5, 0.3, 0.4), 0.0),
        (Geometry::capsule(0.3, 0.2), 0.0),
        (Geometry::cylinder(0.3, 0.3), 0.1),
    ];
    let reach = 0.75;
    for (i, (geometry, damping)) in shapes.iter().enumerate() {
        for friction in [0.0, 0.6] {
            for seed in 0..5u8 {
                let material = soft(10.0, *damping).with_friction(friction);
                let mut world = world(Settings::default(), Floor::Plane, material);
                let x = f32::from(seed);
                let desc = dynamic(geometry.clone(), material, Vec3::new(0.0, 1.5, 0.0));
                let desc =
                    desc.with_velocity(Vec3::new(1.0, -x, 0.3), Vec3::new(x - 1.0, 0.7, 2.0 - 0.5 * x));
                let body = world.add_body(&desc).unwrap();
                let start = world.energy();
                for step in 0..1200 {
                    world.step(1.0 / 60.0).unwrap();
                    let gained = world.energy() / start;
                    let name = format!("shape {i}, friction {friction}, seed {seed}, step {step}");
                    assert!(height(&world, body) < reach || gained < 1.0 + 1e-4, "{name}: {gained}");
                }
            }
        }
    }
}

/// Strong damping stops a ball and throws nothing back.
#[test]
fn an_overdamped_spring_throws_nothing_back() {
    for damping in [1.0, 3.0, 10.0, 100.0] {
        for (rate, substeps) in [(60.0, 4), (30.0, 2), (120.0, 8)] {
            let settings = Settings::default().with_substeps(substeps);
            let mut world = world(settings, Floor::Box, soft(8.0, damping));
            let cube = Geometry::cuboid(0.4, 0.4, 0.4);
            let cube = dynamic(cube, Material::default(), Vec3::new(0.0, 2.0, 0.0));
            let body = world.add_body(&cube).unwrap();
            let mut touched = false;
            for step in 0..(20.0 * rate) as u32 {
                world.step(1.0 / rate).unwrap();
                touched |= height(&world, body) < 0.4;
                let name = format!("damping {damping}, {rate}/s x{substeps}, step {step}");
                assert!(!touched || height(&world, body) < 0.405, "{name}: {}", height(&world, body));
            }
            let (sag, depth) = (G / (TAU * 8.0).powi(2), 0.4 - height(&world, body));
            assert!((depth / sag - 1.0).abs() < 0.01, "{damping} {rate}/s x{substeps}: {depth} for {sag}");
        }
    }
}

/// A swinging body is not put to sleep: a ball on a spring of 1 Hz without damping moves for a minute, at one
/// amplitude.
#[test]
fn a_body_that_swings_stays_awake() {
    let settings = Settings::default().with_sleeping(true).with_gravity(Vec3::Y * -2.0);
    let mut world = world(settings, Floor::Plane, soft(1.5, 0.0));
    let body = dynamic(Geometry::sphere(0.5), Material::default(), Vec3::new(0.0, 0.5, 0.0));
    let body = world.add_body(&body).unwrap();
    let sag = 2.0 / (TAU * 1.5).powi(2);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for step in 0..3600 {
        world.step(1.0 / 60.0).unwrap();
        assert!(!world.is_sleeping(body).unwrap(), "step {step}");
        if step > 3400 {
            (low, high) = (low.min(height(&world, body)), high.max(height(&world, body)));
        }
    }
    assert!(((high - low) - 2.0 * sag).abs() < 0.05 * sag, "{low} to {high}, {sag}");
}

/// Five boxes for two minutes, rigid ones on a soft floor and soft ones on one another. By statics the first
/// sinks by five weights on its spring; between two boxes the spring is that of half their mass.
#[test]
fn a_stack_stands_on_springs() {
    let settings = [Settings::default(), Settings::default().with_friction_model(FrictionModel::Point)];
    for (settings, (damping, own)) in
        settings.iter().flat_map(|s| [(1.0, false), (0.2, false), (1.0, true), (0.2, true)].map(|x| (s, x)))
    {
        let material = soft(10.0, damping);
        let mut world = world(settings.clone(), Floor::Box, material);
        let own_material = if own { material } else { Material::default() };
        let boxes: Vec<_> = (0..5u8)
            .map(|i| {
                let at = Vec3::new(0.0, 0.5 + f32::from(i), 0.0);
                world.add_body(&dynamic(Geometry::cuboid(0.5, 0.5, 0.5), own_material, at)).unwrap()
            })
            .collect();
        let sag = G / (TAU * 10.0).powi(2);
        let check = |world: &World, seconds: u32| {
            let mut expected = 0.0;
            for (i, &body) in boxes.iter().enumerate() {
                expected += if i == 0 {
                    5.0 * sag
                } else if own {
                    2.0 * (5 - i) as f64 * sag
                } else {
                    0.0
                };
                let sunk = 0.5 + i as f64 - height(world, body);
                let away = common::sideways(world.position(body).unwrap());
                let name = format!("damping {damping}, own {own}, {seconds} s, box {i}");
                assert!((sunk - expected).abs() < 0.02 * expected + 0.003, "{name}: {sunk} for {expected}");
                assert!(away < 0.01, "{name}: {away} m aside");
            }
        };
        run(&mut world, 1.0 / 60.0, 20.0);
        check(&world, 20);
        run(&mut world, 1.0 / 60.0, 100.0);
        check(&world, 120);
    }
}

/// v² / (2 mu g), by Coulomb: the load of a body that has sunk is its weight.
#[test]
fn a_box_slides_as_far_on_a_soft_floor() {
    for floor in Floor::ALL {
        for model in [FrictionModel::Patch, FrictionModel::Point] {
            let material = soft(8.0, 1.0).with_friction(0.3);
            let settings = Settings::default().with_friction_model(model);
            let mut world = world(settings, floor, material);
            let sag = (G / (TAU * 8.0).powi(2)) as f32;
            let own = Material::default().with_friction(0.3);
            let at = Vec3::new(-4.0, 0.25 - sag, 0.3);
            let desc =
                dynamic(Geometry::cuboid(0.5, 0.25, 0.5), own, at).with_velocity(Vec3::X * 4.0, Vec3::ZERO);
            let body = world.add_body(&desc).unwrap();
            run(&mut world, 1.0 / 60.0, 4.0);
            let way = world.position(body).unwrap().x + 4.0;
            let expected = 16.0 / (2.0 * 0.3 * G);
            assert!((way / expected - 1.0).abs() < 0.03, "{floor:?} {model:?}: {way} for {expected}");
            assert!((height(&world, body) - f64::from(0.25 - sag)).abs() < 0.05 * f64::from(sag));
        }
    }
}

/// A spring of 2 Hz would let them through: at the stop the wall is rigid, and nothing comes back faster than
/// it came.
#[test]
fn nothing_gets_through_a_soft_wall() {
    let shapes = [Geometry::sphere(0.1), Geometry::cuboid(0.1, 0.06, 0.1), Geometry::capsule(0.1, 0.05)];
    for (hertz, damping) in [(2.0, 0.0), (2.0, 1.0), (20.0, 0.0)] {
        for speed in [5.0, 30.0, 200.0, 500.0] {
            for (i, geometry) in shapes.iter().enumerate() {
                let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
                let wall = shape(Geometry::cuboid(0.05, 4.0, 4.0), soft(hertz, damping));
                world.add_body(&BodyDesc::fixed().with_shape(wall)).unwrap();
                let mut shots = Vec::new();
                for seed in 0..12u8 {
                    let at = Vec3::new(-2.0 - 0.17 * f32::from(seed), 0.4 * f32::from(seed) - 2.0, 0.1);
                    let spin = Vec3::new(0.0, 0.3 * f32::from(seed), 1.0);
                    let desc = dynamic(geometry.clone(), Material::default(), at);
                    shots.push(world.add_body(&desc.with_velocity(Vec3::X * speed, spin)).unwrap());
                }
                for step in 0..120 {
                    world.step(1.0 / 60.0).unwrap();
                    for &body in &shots {
                        let (x, v) = (world.position(body).unwrap().x, world.linear_velocity(body).unwrap());
                        let name = format!("{hertz} Hz {damping}, shape {i} at {speed} m/s, step {step}");
                        assert!(x < -0.05, "{name}: at {x}");
                        assert!(v.length() < speed * 1.001 + 0.01, "{name}: {v}");
                    }
                }
            }
        }
    }
}

/// A spring of half a hertz sags by a metre: a ball of half a metre rests at the stop, at half its radius; so
/// do ten boxes on a plate, at a quarter of its thickness.
#[test]
fn what_is_too_heavy_rests_on_the_stop() {
    let mut heavy = world(Settings::default(), Floor::Plane, soft(0.5, 1.0));
    let ball = dynamic(Geometry::sphere(0.5), Material::default(), Vec3::new(0.0, 0.6, 0.0));
    let ball = heavy.add_body(&ball).unwrap();
    run(&mut heavy, 1.0 / 60.0, 10.0);
    assert!((height(&heavy, ball) - 0.25).abs() < 0.002, "{}", height(&heavy, ball));
    let mut plate = World::new(Settings::default()).unwrap();
    let wall = shape(Geometry::cuboid(4.0, 0.1, 4.0), soft(0.5, 1.0));
    plate.add_body(&BodyDesc::fixed().with_shape(wall)).unwrap();
    let boxes: Vec<_> = (0..10u8)
        .map(|i| {
            let at = Vec3::new(f32::from(i % 4) - 2.0, 1.0, f32::from(i / 4));
            plate.add_body(&dynamic(Geometry::cuboid(0.3, 0.3, 0.3), Material::default(), at)).unwrap()
        })
        .collect();
    run(&mut plate, 1.0 / 60.0, 10.0);
    for body in boxes {
        assert!((height(&plate, body) - 0.35).abs() < 0.002, "{}", height(&plate, body));
    }
}

/// A soft ball and a rigid one on the same floor; a material changes while the body rests, and of two soft
/// ones the softer decides.
#[test]
fn each_contact_is_as_soft_as_its_softer_side() {
    let mut world = world(Settings::default(), Floor::Plane, Material::default());
    let balls: Vec<_> = [0.0, 8.0, 12.0]
        .into_iter()
        .enumerate()
        .map(|(i, hertz)| {
            let at = Vec3::new(2.0 * i as f32, 0.5, 0.0);
            world.add_body(&dynamic(Geometry::sphere(0.5), soft(hertz, 1.0), at)).unwrap()
        })
        .collect();
    let floor = world.bodies().find(|b| !balls.contains(b)).unwrap();
    let sag = |hertz: f64| G / (TAU * hertz).powi(2);
    let depths = |world: &World| [0, 1, 2].map(|i| 0.5 - height(world, balls[i]));
    run(&mut world, 1.0 / 60.0, 5.0);
    let [rigid, eight, twelve] = depths(&world);
    assert!(rigid.abs() < 0.002 && (eight / sag(8.0) - 1.0).abs() < 0.01, "{rigid} {eight}");
    assert!((twelve / sag(12.0) - 1.0).abs() < 0.01, "{twelve}");
    let shape = world.shapes(floor).unwrap().next().unwrap();
    let pad = soft(10.0, 1.0);
    world.set_material(shape, pad).unwrap();
    assert_eq!(world.material(shape).unwrap(), pad);
    run(&mut world, 1.0 / 60.0, 5.0);
    let [rigid, eight, twelve] = depths(&world);
    assert!((rigid / sag(10.0) - 1.0).abs() < 0.01 && (twelve / sag(10.0) - 1.0).abs() < 0.01);
    assert!((eight / sag(8.0) - 1.0).abs() < 0.01, "{eight}");
    // Damping is kept where nothing yields.
    world.set_material(shape, soft(0.0, 0.3)).unwrap();
    assert_eq!(world.material(shape).unwrap(), soft(0.0, 0.3));
    let own = world.shapes(balls[1]).unwrap().next().unwrap();
    world.set_material(own, Material::default()).unwrap();
    run(&mut world, 1.0 / 60.0, 5.0);
    assert!(depths(&world)[1].abs() < 1e-4, "{:?}", depths(&world));
}

/// Two boxes on a hinge, and a box half on a soft plate and half on a rigid one: springs act beside trees of
/// joints and beside rigid rows, and all come to rest.
#[test]
fn springs_act_beside_joints_and_rigid_contacts() {
    let mut world = world(Settings::default(), Floor::Box, soft(10.0, 1.0));
    let cube = Geometry::cuboid(0.5, 0.5, 0.5);
    let pair = [0.0, 1.01].map(|x| {
        world.add_body(&dynamic(cube.clone(), Material::default(), Vec3::new(x, 0.5, 0.0))).unwrap()
    });
    let frames = world.frames_at(pair, DVec3::new(0.505, 0.5, 0.0), Quat::IDENTITY).unwrap();
    world.add_joint(&backstop::JointDesc::hinge(pair, frames)).unwrap();
    let ledge = shape(Geometry::cuboid(2.0, 0.5, 2.0), Material::default());
    world.add_body(&BodyDesc::fixed().with_position(Vec3::new(8.0, -0.49, 0.0)).with_shape(ledge)).unwrap();
    let beam = dynamic(Geometry::cuboid(2.0, 0.2, 0.4), Material::default(), Vec3::new(6.0, 0.3, 0.0));
    let beam = world.add_body(&beam).unwrap();
    run(&mut world, 1.0 / 60.0, 20.0);
    let sag = G / (TAU * 10.0).powi(2);
    for body in pair {
        let depth = 0.5 - height(&world, body);
        assert!((depth / sag - 1.0).abs() < 0.02, "{depth} for {sag}");
    }
    for body in [pair[0], pair[1], beam] {
        let (v, w) = (world.linear_velocity(body).unwrap(), world.angular_velocity(body).unwrap());
        assert!(v.length() < 1e-3 && w.length() < 1e-3, "{v} {w}");
    }
    assert!((height(&world, beam) - 0.2).abs() < 0.03, "{}", height(&world, beam));
}

/// Bodies of several shapes, soft and rigid, on a soft floor.
fn heap(settings: Settings) -> (World, Vec<BodyHandle>) {
    let mut world = World::new(settings).unwrap();
    world.add_body(&Floor::Mesh.desc(soft(12.0, 0.5))).unwrap();
    let bodies = (0..150u8)
        .map(|i| {
            let geometry = match i % 3 {
                0 => Geometry::capsule(0.2, 0.15),
                1 => Geometry::cuboid(0.2, 0.15, 0.25),
                _ => Geometry::sphere(0.2),
            };
            let material = if i % 4 == 3 { soft(6.0 + f32::from(i % 5), 0.2) } else { Material::default() };
            let (level, x) = (f32::from(i / 25), f32::from(i % 5) - 2.0);
            let at = Vec3::new(x + 0.05 * level, 0.4 + 0.6 * level, f32::from(i / 5 % 5));
            world.add_body(&dynamic(geometry, material, at).with_velocity(Vec3::X * 0.5, Vec3::Y)).unwrap()
        })
        .collect();
    (world, bodies)
}

fn poses(world: &World, bodies: &[BodyHandle]) -> Vec<(DVec3, Quat)> {
    bodies.iter().map(|&b| (world.position(b).unwrap(), world.rotation(b).unwrap())).collect()
}

/// To the bit: on one thread and two, after a snapshot and after one in bytes.
#[test]
fn soft_contacts_are_the_same_on_any_threads_and_from_a_snapshot() {
    let dt = 1.0 / 60.0;
    let (mut world, bodies) = heap(Settings::default().with_threads(1));
    let (mut twin, twins) = heap(Settings::default().with_threads(2));
    common::steps(&mut world, 90, dt);
    common::steps(&mut twin, 90, dt);
    assert_eq!(poses(&world, &bodies), poses(&twin, &twins));
    let mut snapshot = Snapshot::new();
    world.snapshot(&mut snapshot);
    let bytes = snapshot.to_whole_bytes();
    common::steps(&mut world, 120, dt);
    let want = poses(&world, &bodies);
    world.restore(&snapshot).unwrap();
    common::steps(&mut world, 120, dt);
    assert_eq!(poses(&world, &bodies), want);
    let kept = twin.shapes(twins[3]).unwrap().next().unwrap();
    twin.set_material(kept, Material::default()).unwrap();
    twin.restore(&Snapshot::from_bytes(&bytes).unwrap()).unwrap();
    assert_eq!(twin.material(kept).unwrap(), soft(9.0, 0.2));
    common::steps(&mut twin, 120, dt);
    assert_eq!(poses(&twin, &twins), want);
    // And bodies that have not rolled off the floor lie on it.
    common::steps(&mut twin, 600, dt);
    let on_floor = |at: DVec3| at.x.abs() < 9.9 && at.z.abs() < 9.9;
    let mut lying = 0;
    for &body in &twins {
        let (at, v) = (twin.position(body).unwrap(), twin.linear_velocity(body).unwrap());
        lying += u32::from(on_floor(at));
        assert!(!on_floor(at) || at.y > 0.05 && v.y.abs() < 0.2, "{at} {v}");
    }
    assert!(lying > 100, "{lying}");
}

/// A scene pays for it only while a shape asks: neither bytes nor a part of the model.
#[test]
fn what_is_rigid_costs_nothing() {
    let (mut world, bodies) = heap(Settings::default());
    world.step(1.0 / 60.0).unwrap();
    let part = |world: &World| world.feature_report().part(backstop::Feature::SoftContacts);
    assert!(part(&world).count == 38 && part(&world).bytes > 0, "{:?}", part(&world));
    let floor = world.bodies().find(|b| !bodies.contains(b)).unwrap();
    for body in bodies.into_iter().chain([floor]) {
        let shape = world.shapes(body).unwrap().next().unwrap();
        world.set_material(shape, Material::default()).unwrap();
    }
    common::steps(&mut world, 2, 1.0 / 60.0);
    assert_eq!((part(&world).count, part(&world).bytes), (0, 0));
}
