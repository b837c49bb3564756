//! Bodies that are joined.

use super::super::conditions::Conditions;
use super::super::measures::{Gauge, Measure, mass_of};
use super::setup::{Setup, about_z, floor, weight};
use backstop::Geometry;
use backstop::math::Quat;
use backstop::{JointDesc, Skeleton};
use backstop_scene::Scene;
use backstop_scene::builtin::{dynamic, fixed};
use backstop_scene::{join, throw};
use glam::{DVec3, Vec3};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_6};

/// Anchors of a joint may part by a hundredth of a body's size, and the joint is lost at a tenth.
fn together(unit: f32) -> Gauge {
    Gauge { measure: Measure::Apart { unit: f64::from(unit) }, bounds: [0.01, 0.1] }
}

/// A mechanism without motors may gain a hundredth of its energy, and is lost at a tenth.
fn gains(unit: f64) -> Gauge {
    Gauge { measure: Measure::Gain { unit }, bounds: [0.01, 0.1] }
}

/// Turns the axis x of a frame to z.
pub(super) fn x_to_z() -> Quat {
    Quat::from_xyzw(0.0, -libm::sinf(0.5 * FRAC_PI_2), 0.0, libm::cosf(0.5 * FRAC_PI_2))
}

fn kinetic(scene: &Scene) -> f64 {
    let of = |body: &backstop_scene::SceneBody| {
        let desc = &body.desc;
        let mass = mass_of(desc);
        let spin = desc.rotation.inverse() * desc.angular_velocity;
        0.5 * f64::from(mass.mass * desc.linear_velocity.length_squared() + (mass.inertia * spin).dot(spin))
    };
    scene.bodies.iter().map(of).sum()
}

/// Ten links of half a length unit, level, and a ball at their end, on a hook.
pub(super) fn chain(c: &Conditions) -> Setup {
    const LINKS: usize = 10;
    let mut scene = Scene::new("chain");
    let length = 0.5 * c.size;
    let thick = (0.1 / c.slenderness.sqrt()).min(0.1) * c.size;
    let hook = scene.add("hook", fixed(Geometry::Sphere { radius: 0.05 * c.size }, Vec3::ZERO));
    let level = about_z(-FRAC_PI_2);
    let mut last = hook;
    for i in 0..LINKS {
        let shape = Geometry::capsule(0.5 * length - thick, thick);
        let at = Vec3::new((i as f32 + 0.5) * length, 0.0, 0.0);
        let link = scene.add("link", dynamic(shape, at).with_rotation(level));
        let point = DVec3::new(f64::from(i as f32 * length), 0.0, 0.0);
        join(&mut scene, [last, link], point, Quat::IDENTITY, JointDesc::ball);
        last = link;
    }
    let link_mass = mass_of(&scene.bodies[last].desc).mass;
    let radius = 0.2 * c.size;
    let end = LINKS as f32 * length;
    let mut ball = dynamic(Geometry::Sphere { radius }, Vec3::new(end + radius, 0.0, 0.0));
    let mass = mass_of(&ball).mass;
    weight(&mut ball, c.mass_ratio * link_mass / mass);
    let sideways = Vec3::Z * c.speed.unwrap_or(0.0) * c.size;
    let ball = scene.add("ball", ball.with_velocity(sideways, Vec3::Z * c.spin.unwrap_or(0.0)));
    join(&mut scene, [last, ball], DVec3::new(f64::from(end), 0.0, 0.0), Quat::IDENTITY, JointDesc::ball);
    let total: f32 = scene.bodies.iter().map(|body| mass_of(&body.desc).mass).sum();
    let fall = f64::from(total * 9.81 * c.gravity * end);
    let gauges = vec![together(length), gains(fall + kinetic(&scene))];
    Setup { scene, boundaries: Vec::new(), gauges }
}

/// A figure thrown at the floor, head first.
pub(super) fn ragdoll(c: &Conditions) -> Setup {
    let mut scene = Scene::new("ragdoll");
    // The floor is large enough for limbs that fly off no faster than they spin, for a minute at most.
    let fastest = c.speed.unwrap_or(5.0).max(c.spin.unwrap_or(0.0));
    let boundaries = floor(&mut scene, (66.0 * fastest + 20.0) * c.size, c.size);
    let mut figure = Skeleton::humanoid();
    figure.friction = 0.0;
    for bone in &mut figure.bones {
        bone.joint_at *= c.size;
        bone.from *= c.size;
        bone.to *= c.size;
        bone.radius *= c.size;
    }
    let turn = about_z(2.6);
    let down = Vec3::new(0.6, -0.8, 0.0) * (c.speed.unwrap_or(5.0) * c.size);
    throw(&mut scene, &figure, (DVec3::Y * f64::from(3.0 * c.size), turn), down);
    // The pelvis is the heavy one.
    weight(&mut scene.bodies[1].desc, c.mass_ratio);
    for body in &mut scene.bodies[1..] {
        body.desc.angular_velocity = Vec3::Y * c.spin.unwrap_or(0.0);
        let arm = (body.desc.position - DVec3::Y * f64::from(3.0 * c.size)).as_vec3();
        body.desc.linear_velocity += body.desc.angular_velocity.cross(arm);
    }
    let limb = 0.1 * c.size;
    let depth = Gauge { measure: Measure::Depth { unit: f64::from(limb) }, bounds: [0.05, 0.5] };
    let through = Gauge { measure: Measure::Through, bounds: [0.0, 0.0] };
    Setup { scene, boundaries, gauges: vec![together(2.0 * limb), depth, through] }
}

/// A rod that swings from 60 degrees on a hinge at its end.
pub(super) fn hinge(c: &Conditions) -> Setup {
    let mut scene = Scene::new("hinge");
    let post = scene.add("post", fixed(Geometry::Sphere { radius: 0.05 * c.size }, Vec3::ZERO));
    let thick = (0.1 / c.slenderness.sqrt()).min(0.1);
    let turn = about_z(2.0 * FRAC_PI_6);
    let rod = Geometry::cuboid(thick * c.size, 0.5 * c.size, thick * c.size);
    let arm = turn * Vec3::new(0.0, -0.5 * c.size, 0.0);
    // Without a spin of its own it is a pendulum.
    let spin = Vec3::Z * c.spin.unwrap_or(0.0);
    let mut body = dynamic(rod, arm).with_rotation(turn).with_velocity(spin.cross(arm), spin);
    weight(&mut body, c.mass_ratio);
    let rod = scene.add("rod", body);
    join(&mut scene, [post, rod], DVec3::ZERO, x_to_z(), JointDesc::hinge);
    let mass = mass_of(&scene.bodies[rod].desc).mass;
    // Potential energy from there to the lowest point: half of that from the horizontal.
    let energy = f64::from(mass * 9.81 * c.gravity * 0.25 * c.size) + kinetic(&scene);
    let loss = Gauge { measure: Measure::Loss { unit: energy }, bounds: [0.02, 0.5] };
    Setup { scene, boundaries: Vec::new(), gauges: vec![together(c.size), gains(energy), loss] }
}

/// A disc that spins on a tilted hinge through its centre; a slender one is a rod that spins about its
/// length.
pub(super) fn rotor(c: &Conditions) -> Setup {
    let mut scene = Scene::new("rotor");
    let tilt = Quat::from_xyzw(libm::sinf(0.25), 0.0, 0.0, libm::cosf(0.25));
    let post = scene.add("post", fixed(Geometry::Sphere { radius: 0.05 * c.size }, Vec3::ZERO));
    let half = match c.slenderness {
        1.0 => Vec3::new(0.05, 0.5, 0.5),
        // (1 + s^2) / 2 s^2 is the ratio of the moments of a bar of sides 1, s, s.
        ratio => {
            Vec3::new(0.5, 1.0, 1.0).with_y(0.5 / (2.0 * ratio).sqrt()).with_z(0.5 / (2.0 * ratio).sqrt())
        }
    };
    let shape = Geometry::Box { half_extents: half * c.size };
    let spin = tilt * Vec3::X * c.spin.unwrap_or(50.0);
    let disc =
        scene.add("disc", dynamic(shape, Vec3::ZERO).with_rotation(tilt).with_velocity(Vec3::ZERO, spin));
    weight(&mut scene.bodies[disc].desc, c.mass_ratio);
    join(&mut scene, [post, disc], DVec3::ZERO, tilt, JointDesc::hinge);
    let kept = Gauge { measure: Measure::Spin { body: disc }, bounds: [0.02, 0.3] };
    let energy = kinetic(&scene);
    Setup { scene, boundaries: Vec::new(), gauges: vec![together(0.5 * c.size), kept, gains(energy)] }
}

/// A cart that coasts on four ball wheels.
pub(super) fn cart(c: &Conditions) -> Setup {
    let mut scene = Scene::new("cart");
    let speed = c.speed.unwrap_or(5.0) * c.size;
    let boundaries = floor(&mut scene, 66.0 * speed + 20.0 * c.size, c.size);
    let radius = 0.3 * c.size;
    let along = Vec3::X * speed;
    let chassis = Geometry::cuboid(c.size, 0.15 * c.size, 0.5 * c.size);
    let mut body = dynamic(chassis, Vec3::new(0.0, 0.6 * c.size, 0.0)).with_velocity(along, Vec3::ZERO);
    weight(&mut body, c.mass_ratio);
    let chassis = scene.add("chassis", body);
    for (x, z) in [(-0.8, -0.8), (-0.8, 0.8), (0.8, -0.8), (0.8, 0.8)] {
        let at = Vec3::new(x * c.size, radius, z * c.size);
        let wheel =
            dynamic(Geometry::Sphere { radius }, at).with_velocity(along, Vec3::NEG_Z * (speed / radius));
        let wheel = scene.add("wheel", wheel);
        join(&mut scene, [chassis, wheel], at.as_dvec3(), x_to_z(), JointDesc::hinge);
    }
    let depth = Gauge { measure: Measure::Depth { unit: f64::from(radius) }, bounds: [0.02, 0.5] };
    let kept = Gauge { measure: Measure::Speed { body: chassis }, bounds: [0.02, 0.3] };
    Setup { scene, boundaries, gauges: vec![together(radius), kept, depth] }
}
