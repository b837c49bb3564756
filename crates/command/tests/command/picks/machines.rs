//! More scenes, as games bring them: machines that are driven, ropes and springs, walls and piles.
use super::scenes::{dynamic, fixed, ground, heavy, hinge, pin};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::math;
use backstop::{
    Axes, Axis, BodyDesc, CouplingDesc, Geometry, JointDesc, Limit, Material, Motion, Motor, ShapeDesc,
    Skeleton, Spring,
};
use backstop_scene::{Rng, Scene, SceneCoupling, axis_angle, join, throw};
use std::f32::consts::PI;

pub(super) const FAMILIES: [fn(&mut Rng) -> Scene; 20] = [
    ragdolls,
    buggy,
    wrecking_ball,
    cards,
    conveyor,
    pusher,
    rope,
    slide,
    gears,
    barrels,
    springboard,
    lift,
    stack,
    cabin,
    winch,
    plates,
    bounces,
    door,
    skittles,
    hoist,
];

fn level() -> math::Quat {
    Quat::IDENTITY.into()
}

/// Figures that fall on each other.
fn ragdolls(random: &mut Rng) -> Scene {
    let mut scene = ground("ragdolls");
    for i in 0..3 {
        let turn = axis_angle(random.direction(), random.range(0.5, 1.5));
        let at = DVec3::new(f64::from(random.range(-0.2, 0.2)), 1.2 + 1.2 * f64::from(i), 0.0);
        throw(&mut scene, &Skeleton::humanoid(), (at, turn), Vec3::ZERO);
    }
    scene
}

/// A car on springs with an engine, over bumps.
fn buggy(random: &mut Rng) -> Scene {
    let mut scene = ground("buggy");
    let body = scene.add("chassis", heavy(Geometry::cuboid(1.0, 0.2, 0.5), DVec3::Y * 0.7, 600.0));
    let speed = random.range(12.0, 16.0);
    for (x, z) in [(-0.8, -0.7), (-0.8, 0.7), (0.8, -0.7), (0.8, 0.7)] {
        let at = DVec3::new(x, 0.35, z);
        let turn = axis_angle(Vec3::X, 0.5 * PI);
        let wheel = scene.add("wheel", heavy(Geometry::cylinder(0.12, 0.35), at, 300.0).with_rotation(turn));
        let axes = axis_angle(Vec3::Y, 0.5 * PI);
        let spring = Spring::Frequency { hertz: 3.0, ratio: 0.5 };
        let engine = Motor::velocity(Motion::Angular, Axis::X, speed, 120.0);
        // The frame's x points against z, so that the wheels roll along x.
        join(&mut scene, [body, wheel], at, axes, |bodies, frames| {
            JointDesc::wheel(bodies, frames, 0.15, spring).with_motor(engine)
        });
    }
    for i in 0..6 {
        let at = DVec3::new(2.5 + 1.3 * f64::from(i), 0.0, if i % 2 == 0 { -0.7 } else { 0.7 });
        let turn = axis_angle(Vec3::X, 0.5 * PI);
        scene.add("bump", fixed(Geometry::capsule(0.6, 0.12), at).with_rotation(turn));
    }
    scene
}

/// A ball on a chain, let go, and a wall of bricks.
fn wrecking_ball(random: &mut Rng) -> Scene {
    let mut scene = ground("wrecking_ball");
    let mast = scene.add("mast", BodyDesc::fixed().with_position(DVec3::new(-1.5, 5.0, 0.0)));
    let (mut last, angle) = (mast, random.range(0.9, 1.2));
    let turn = axis_angle(Vec3::Z, -angle);
    let down = (turn * Vec3::NEG_Y).as_dvec3();
    let hook = DVec3::new(-1.5, 5.0, 0.0);
    for i in 0..8 {
        let at = hook + down * (0.25 + 0.5 * f64::from(i));
        let link = heavy(Geometry::capsule(0.19, 0.05), at, 3000.0).with_rotation(turn);
        let link = scene.add("link", link);
        pin(&mut scene, [last, link], hook + down * (0.5 * f64::from(i)));
        last = link;
    }
    let ball = scene.add("ball", heavy(Geometry::sphere(0.5), hook + down * 4.4, 4000.0));
    pin(&mut scene, [last, ball], hook + down * 4.0);
    for row in 0..8 {
        for i in 0..5 {
            let z = 0.5 * (f64::from(i) - 2.0) + if row % 2 == 0 { 0.0 } else { 0.25 };
            let at = DVec3::new(-1.0, 0.15 + 0.3 * f64::from(row), z);
            scene.add("brick", heavy(Geometry::cuboid(0.15, 0.15, 0.25), at, 1500.0));
        }
    }
    scene
}

/// A house of cards of two storeys.
fn cards(random: &mut Rng) -> Scene {
    let mut scene = ground("cards");
    let (half, thin) = (0.44, 0.006);
    let lean = random.range(0.30, 0.36);
    let (across, up) = (half * f64::from(lean).sin(), half * f64::from(lean).cos());
    let card = |scene: &mut Scene, at: DVec3, half: f64, angle: f32| {
        let shape = ShapeDesc::new(Geometry::cuboid(thin, half as f32, 0.3)).with_density(200.0);
        let shape = shape.with_material(Material::default().with_friction(1.0));
        let body = BodyDesc::dynamic().with_position(at).with_rotation(axis_angle(Vec3::Z, angle));
        scene.add("card", body.with_shape(shape));
    };
    let reach = across + f64::from(thin) * f64::from(lean).cos();
    let tall = up + f64::from(thin) * f64::from(lean).sin();
    let storey = 2.0 * (tall + f64::from(thin));
    for (level, tents) in [(0, 3), (1, 2), (2, 1)] {
        let y = storey * f64::from(level) + tall;
        for i in 0..tents {
            let x = (f64::from(i) - 0.5 * f64::from(tents - 1)) * 4.0 * reach;
            card(&mut scene, DVec3::new(x - reach, y, 0.0), half, -lean);
            card(&mut scene, DVec3::new(x + reach, y, 0.0), half, lean);
        }
        for i in 0..tents - 1 {
            let x = (f64::from(i) - 0.5 * f64::from(tents - 2)) * 4.0 * reach;
            // From one top to the next.
            card(&mut scene, DVec3::new(x, y + tall + f64::from(thin), 0.0), 2.0 * reach - 0.001, 0.5 * PI);
        }
    }
    scene
}

/// A belt that carries boxes off its end.
fn conveyor(random: &mut Rng) -> Scene {
    let mut scene = ground("conveyor");
    let belt = Material::default().with_surface_velocity(Vec3::X * random.range(1.5, 2.5));
    let belt = ShapeDesc::new(Geometry::cuboid(2.0, 0.25, 0.5)).with_material(belt);
    scene.add("belt", BodyDesc::fixed().with_position(DVec3::Y * 0.75).with_shape(belt));
    for i in 0..7 {
        let size = random.range(0.12, 0.22);
        let at =
            DVec3::new(-1.7 + 0.5 * f64::from(i), 1.0 + f64::from(size), f64::from(random.range(-0.2, 0.2)));
        scene.add("parcel", dynamic(Geometry::cuboid(size, size, size), at));
    }
    scene
}

/// A blade that pushes a pile of boxes.
fn pusher(random: &mut Rng) -> Scene {
    let mut scene = ground("pusher");
    let blade = BodyDesc::kinematic().with_position(DVec3::new(-1.2, 0.5, 0.0));
    let blade = blade.with_velocity(Vec3::X * random.range(0.8, 1.4), Vec3::ZERO);
    scene.add("blade", blade.with_shape(ShapeDesc::new(Geometry::cuboid(0.1, 0.45, 1.5))));
    for i in 0..18 {
        let at = DVec3::new(
            0.45 * f64::from(i % 3),
            0.2 + 0.4 * f64::from(i / 9),
            0.45 * f64::from(i / 3 % 3) - 0.45,
        );
        let size = random.range(0.16, 0.2);
        scene.add("box", dynamic(Geometry::cuboid(size, 0.2, size), at));
    }
    scene
}

/// Thirty links from a hook, and a load that swings on them.
fn rope(random: &mut Rng) -> Scene {
    let mut scene = Scene::new("rope");
    let mut last = scene.add("hook", BodyDesc::fixed());
    for i in 0..30 {
        let at = DVec3::NEG_Y * (0.05 + 0.1 * f64::from(i));
        let link = scene.add("link", dynamic(Geometry::capsule(0.04, 0.015), at));
        pin(&mut scene, [last, link], DVec3::NEG_Y * (0.1 * f64::from(i)));
        last = link;
    }
    let load = heavy(Geometry::cuboid(0.2, 0.2, 0.2), DVec3::NEG_Y * 3.2, 2000.0);
    let load = scene.add("load", load.with_velocity(Vec3::X * random.range(3.0, 4.0), Vec3::ZERO));
    pin(&mut scene, [last, load], DVec3::NEG_Y * 3.0);
    scene
}

/// A chute for balls, rollers and boxes.
fn slide(random: &mut Rng) -> Scene {
    let mut scene = ground("slide");
    let tilt = random.range(-0.5, -0.4);
    let turn: Quat = axis_angle(Vec3::Z, tilt).into();
    let mut chute = BodyDesc::fixed().with_position(DVec3::new(0.0, 1.6, 0.0)).with_rotation(turn);
    chute = chute.with_shape(ShapeDesc::new(Geometry::cuboid(2.5, 0.05, 0.8)));
    for z in [-0.85, 0.85] {
        chute =
            chute.with_shape(ShapeDesc::new(Geometry::cuboid(2.5, 0.25, 0.05)).with_position(Vec3::Z * z));
    }
    scene.add("chute", chute);
    for i in 0..9 {
        let size = random.range(0.1, 0.16);
        let geometry = match i % 3 {
            0 => Geometry::sphere(size),
            1 => Geometry::cylinder(size, size),
            _ => Geometry::cuboid(size, 0.6 * size, size),
        };
        let place = Vec3::new(-2.2 + 0.5 * (i / 3) as f32, 0.25, -0.5 + 0.5 * (i % 3) as f32);
        let lying = if i % 3 == 1 { Quat::from(axis_angle(Vec3::X, 0.5 * PI)) } else { Quat::IDENTITY };
        let body = dynamic(geometry, DVec3::Y * 1.6 + (turn * place).as_dvec3());
        scene.add("piece", body.with_rotation(turn * lying));
    }
    scene
}

/// Two wheels in gear, one with a motor, the other with an arm that throws balls.
fn gears(random: &mut Rng) -> Scene {
    let mut scene = ground("gears");
    let frame = scene.add("frame", BodyDesc::fixed().with_position(DVec3::Y * 1.2));
    let wheels: Vec<usize> = [(-0.5, 0.3), (0.5, 0.6)]
        .into_iter()
        .map(|(x, radius)| {
            let disc =
                ShapeDesc::new(Geometry::cylinder(0.05, radius)).with_rotation(axis_angle(Vec3::X, 0.5 * PI));
            let arm = ShapeDesc::new(Geometry::cuboid(0.08, 0.9, 0.3)).with_position(Vec3::Z * 0.4);
            let body = BodyDesc::dynamic().with_position(DVec3::new(x, 1.2, 0.0)).with_shape(disc);
            scene.add("wheel", if radius > 0.5 { body.with_shape(arm) } else { body })
        })
        .collect();
    for &wheel in &wheels {
        let at = scene.bodies[wheel].desc.position;
        hinge(&mut scene, [frame, wheel], at, Vec3::Z);
    }
    let motor = Motor::velocity(Motion::Angular, Axis::X, random.range(6.0, 9.0), 200.0);
    scene.joints[0].motors.push(motor);
    scene.couplings.push(SceneCoupling::new([0, 1], |hinges| CouplingDesc::gear(hinges, [10.0, 20.0])));
    for i in 0..5 {
        let at = DVec3::new(0.9 + 0.25 * f64::from(i), 0.35, 0.4);
        scene.add("ball", dynamic(Geometry::sphere(0.12), at));
    }
    scene
}

/// Barrels that roll down a ramp into others that stand.
fn barrels(random: &mut Rng) -> Scene {
    let mut scene = ground("barrels");
    let turn = axis_angle(Vec3::Z, random.range(-0.35, -0.25));
    let ramp = fixed(Geometry::cuboid(2.0, 0.1, 1.0), DVec3::new(-2.0, 0.6, 0.0));
    scene.add("ramp", ramp.with_rotation(turn));
    let lying = axis_angle(Vec3::X, 0.5 * PI);
    for i in 0..3 {
        let place = Vec3::new(-1.6 + 0.7 * i as f32, 0.42, 0.0);
        let at = DVec3::new(-2.0, 0.6, 0.0) + (Quat::from(turn) * place).as_dvec3();
        let barrel = heavy(Geometry::cylinder(0.45, 0.3), at, 600.0);
        scene.add("barrel", barrel.with_rotation(lying));
    }
    for i in 0..4 {
        let at = DVec3::new(1.5 + 0.62 * f64::from(i % 2), 0.45, 0.62 * f64::from(i / 2) - 0.31);
        scene.add("barrel", heavy(Geometry::cylinder(0.45, 0.3), at, 300.0));
    }
    scene.add("barrel", heavy(Geometry::cylinder(0.45, 0.3), DVec3::new(1.8, 1.35, 0.0), 300.0));
    scene
}

/// A table on a spring, crates on it, and one that falls on them.
fn springboard(random: &mut Rng) -> Scene {
    let mut scene = ground("springboard");
    let foot = scene.add("foot", BodyDesc::fixed());
    let table = scene.add("table", heavy(Geometry::cuboid(0.8, 0.08, 0.8), DVec3::Y * 1.0, 500.0));
    let spring = Spring::Frequency { hertz: random.range(2.0, 3.0), ratio: 0.1 };
    join(&mut scene, [foot, table], DVec3::Y * 1.0, axis_angle(Vec3::Z, 0.5 * PI), |bodies, frames| {
        let motor = Motor::position(Motion::Linear, Axis::X, 0.0, spring);
        JointDesc::slider(bodies, frames).with_motor(motor)
    });
    for x in [-0.4, 0.4] {
        scene.add("crate", dynamic(Geometry::cuboid(0.2, 0.2, 0.2), DVec3::new(x, 1.28, 0.0)));
    }
    scene.add("crate", dynamic(Geometry::cuboid(0.25, 0.25, 0.25), DVec3::new(0.0, 2.4, 0.1)));
    scene
}

/// A platform that moves up and aside, and a pile on it.
fn lift(random: &mut Rng) -> Scene {
    let mut scene = ground("lift");
    let platform = BodyDesc::kinematic().with_position(DVec3::Y * 0.1);
    let velocity = Vec3::new(random.range(0.5, 1.0), 0.8, 0.0);
    let platform = platform.with_velocity(velocity, Vec3::Y * 0.4);
    scene.add("platform", platform.with_shape(ShapeDesc::new(Geometry::cuboid(1.2, 0.1, 1.2))));
    for i in 0..6 {
        let at = DVec3::new(0.62 * f64::from(i % 2) - 0.31, 0.5 + 0.6 * f64::from(i / 2), 0.0);
        scene.add("crate", dynamic(Geometry::cuboid(0.3, 0.3, 0.3), at));
    }
    scene
}

/// Twenty boxes on each other.
fn stack(random: &mut Rng) -> Scene {
    let mut scene = ground("stack");
    for i in 0..20 {
        let aside = f64::from(random.range(-0.02, 0.02));
        let at = DVec3::new(aside, 0.25 + 0.5 * f64::from(i), -aside);
        scene.add("box", dynamic(Geometry::cuboid(0.25, 0.25, 0.25), at));
    }
    scene
}

/// A tower of planks, crosswise, and a ball that hits it.
fn cabin(random: &mut Rng) -> Scene {
    let mut scene = ground("cabin");
    for row in 0..12 {
        for side in [-0.5, 0.5] {
            let y = 0.05 + 0.1 * f64::from(row);
            let (half, at) = if row % 2 == 0 {
                (Vec3::new(0.6, 0.05, 0.08), DVec3::new(0.0, y, side))
            } else {
                (Vec3::new(0.08, 0.05, 0.6), DVec3::new(side, y, 0.0))
            };
            scene.add("plank", heavy(Geometry::cuboid(half.x, half.y, half.z), at, 600.0));
        }
    }
    let at = DVec3::new(-3.0, 0.8, f64::from(random.range(-0.2, 0.2)));
    let ball = heavy(Geometry::sphere(0.2), at, 2000.0);
    scene.add("ball", ball.with_velocity(Vec3::new(random.range(7.0, 9.0), 1.0, 0.0), Vec3::ZERO));
    scene
}

/// A motor that turns a paddle wheel in a pile of balls.
fn winch(random: &mut Rng) -> Scene {
    let mut scene = ground("winch");
    let frame = scene.add("frame", BodyDesc::fixed().with_position(DVec3::Y * 0.9));
    let mut wheel = BodyDesc::dynamic().with_position(DVec3::Y * 0.9);
    for i in 0..3 {
        let turn = axis_angle(Vec3::Z, PI / 3.0 * i as f32);
        wheel = wheel.with_shape(ShapeDesc::new(Geometry::cuboid(0.8, 0.05, 0.5)).with_rotation(turn));
    }
    let wheel = scene.add("wheel", wheel);
    hinge(&mut scene, [frame, wheel], DVec3::Y * 0.9, Vec3::Z);
    let motor = Motor::velocity(Motion::Angular, Axis::X, random.range(2.0, 4.0), 1e4);
    scene.joints[0].motors.push(motor);
    for (x, half) in [(-1.4, 0.1), (1.4, 0.1)] {
        scene.add("wall", fixed(Geometry::cuboid(half, 0.5, 0.7), DVec3::new(x, 0.5, 0.0)));
    }
    for z in [-0.75, 0.75] {
        scene.add("wall", fixed(Geometry::cuboid(1.5, 0.5, 0.1), DVec3::new(0.0, 0.5, z)));
    }
    for i in 0..16 {
        let at = DVec3::new(
            0.3 * f64::from(i % 8) - 1.05,
            2.0 + 0.3 * f64::from(i / 8),
            f64::from(random.range(-0.3, 0.3)),
        );
        scene.add("ball", dynamic(Geometry::sphere(0.12), at));
    }
    scene
}

/// A bullet and thin plates that stand in its way.
fn plates(random: &mut Rng) -> Scene {
    let mut scene = ground("plates");
    for i in 0..5 {
        let at = DVec3::new(2.0 + 0.8 * f64::from(i), 0.6, 0.0);
        scene.add("plate", heavy(Geometry::cuboid(0.015, 0.6, 0.6), at, 2000.0));
    }
    let at = DVec3::new(0.0, 0.8, f64::from(random.range(-0.2, 0.2)));
    let bullet = heavy(Geometry::sphere(0.06), at, 7800.0);
    scene.add("bullet", bullet.with_velocity(Vec3::X * random.range(60.0, 120.0), Vec3::ZERO));
    scene
}

/// Balls and boxes that bounce.
fn bounces(random: &mut Rng) -> Scene {
    let mut scene = ground("bounces");
    let rubber = Material::default().with_restitution(0.7);
    for i in 0..6 {
        let size = random.range(0.15, 0.25);
        let geometry = if i % 2 == 0 { Geometry::sphere(size) } else { Geometry::cuboid(size, size, size) };
        let at = DVec3::new(0.8 * f64::from(i), f64::from(random.range(1.0, 2.0)), 0.0);
        let body = BodyDesc::dynamic().with_position(at).with_rotation(random.rotation());
        scene.add("ball", body.with_shape(ShapeDesc::new(geometry).with_material(rubber)));
    }
    scene
}

/// A door with stops, and a ball that throws it open.
fn door(random: &mut Rng) -> Scene {
    let mut scene = ground("door");
    let frame = scene.add("post", fixed(Geometry::cuboid(0.1, 1.1, 0.1), DVec3::new(0.0, 1.1, -0.12)));
    let leaf = scene.add("leaf", heavy(Geometry::cuboid(0.03, 1.0, 0.5), DVec3::new(0.0, 1.05, 0.52), 400.0));
    let axes = Quat::from_rotation_arc(Vec3::X, Vec3::Y).into();
    join(&mut scene, [frame, leaf], DVec3::new(0.0, 1.05, 0.0), axes, |bodies, frames| {
        let stops = Limit::new(Motion::Angular, Axes::One(Axis::X), -1.2, 1.2);
        JointDesc::hinge(bodies, frames).with_limit(stops)
    });
    let at = DVec3::new(-2.0, 1.2, 0.8);
    let ball = heavy(Geometry::sphere(0.2), at, 500.0);
    scene.add("ball", ball.with_velocity(Vec3::X * random.range(6.0, 10.0), Vec3::ZERO));
    scene
}

/// Ten pins and a ball.
fn skittles(random: &mut Rng) -> Scene {
    let mut scene = ground("skittles");
    for row in 0..4 {
        for i in 0..=row {
            let at =
                DVec3::new(2.0 + 0.3 * f64::from(row), 0.2, 0.35 * (f64::from(i) - 0.5 * f64::from(row)));
            scene.add("pin", heavy(Geometry::cylinder(0.2, 0.06), at, 700.0));
        }
    }
    let ball =
        heavy(Geometry::sphere(0.11), DVec3::new(0.0, 0.11, f64::from(random.range(-0.1, 0.1))), 1300.0);
    scene.add("ball", ball.with_velocity(Vec3::X * random.range(5.0, 7.0), Vec3::NEG_Z * 50.0));
    scene
}

/// A load on a rope of one joint over a beam on hinges, and a crate that it drags.
fn hoist(random: &mut Rng) -> Scene {
    let mut scene = ground("hoist");
    let post = scene.add("post", fixed(Geometry::cuboid(0.1, 1.5, 0.1), DVec3::new(0.0, 1.5, 0.0)));
    let beam = scene.add("beam", heavy(Geometry::cuboid(1.2, 0.08, 0.1), DVec3::new(0.0, 3.2, 0.0), 500.0));
    hinge(&mut scene, [post, beam], DVec3::new(0.0, 3.2, 0.0), Vec3::Z);
    for (x, size) in [(-1.1, 0.3), (1.1, random.range(0.2, 0.27))] {
        let load = scene.add("load", dynamic(Geometry::cuboid(size, size, size), DVec3::new(x, 2.0, 0.0)));
        join(&mut scene, [beam, load], DVec3::new(x, 3.2, 0.0), level(), |bodies, mut frames| {
            frames[1].position = Vec3::Y * size;
            JointDesc::distance(bodies, frames, 0.0, 1.0)
        });
    }
    scene
}
