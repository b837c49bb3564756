//! Free rotation: torque-free bodies, by Euler's equations.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]
use crate::common;
use crate::common::random::Random;

use backstop::glam::{DMat3, DQuat, DVec3, Mat3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Geometry, MassProperties, Settings, ShapeDesc, World};

fn alone(inertia: Vec3, spin: Vec3) -> (World, BodyHandle) {
    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
    let mut desc = BodyDesc::dynamic().with_velocity(Vec3::ZERO, spin);
    desc.mass =
        Some(MassProperties { mass: 1.0, centre_of_mass: Vec3::ZERO, inertia: Mat3::from_diagonal(inertia) });
    let body = world.add_body(&desc).unwrap();
    (world, body)
}

/// Angular velocity in the body's axes [rad/s].
fn local_spin(world: &World, body: BodyHandle) -> DVec3 {
    let turn = world.rotation(body).unwrap().as_dquat().normalize();
    turn.conjugate() * world.angular_velocity(body).unwrap().as_dvec3()
}

/// Angular momentum in the world [kg m²/s] and kinetic energy [J].
fn kept(world: &World, body: BodyHandle, inertia: Vec3) -> (DVec3, f64) {
    let (local, i) = (local_spin(world, body), inertia.as_dvec3());
    let turn = DMat3::from_quat(world.rotation(body).unwrap().as_dquat().normalize());
    (turn * (i * local), 0.5 * local.dot(i * local))
}

/// A box of 0.2 x 0.4 x 0.1 m and 1 kg turns about its middle axis and flips. Period of the middle component:
/// 4 K(k) / om, with om and k from the energy and the momentum (Landau and Lifshitz, *Mechanics*, 37);
/// evaluated: 3.86563793 s for a start of (0.1, 10, 0) rad/s about the axes by their moments, 5.40081053 s
/// for (0.01, 10, 0).
#[test]
fn a_tumbling_box_flips_on_time_and_keeps_energy_and_momentum() {
    // The moments of the axes x, y, z; by size: y, x, z.
    let inertia = Vec3::new(17.0 / 1200.0, 1.0 / 240.0, 1.0 / 60.0);
    for (nudge, want) in [(0.1, 3.86563793), (0.01, 5.40081053)] {
        // The smaller nudge has 3e-7 of the energy: one rounding of the spin to single precision, 6e-8, is a
        // fifth of that, and the period, which grows with the logarithm, then changes by up to 2 %. (At 1/60
        // s the integrator's own 2e-4 hides such a nudge: 7 %.)
        let (steps, most): (&[f32], f64) =
            if nudge == 0.1 { (&[1.0 / 60.0, 1.0 / 240.0], 0.01) } else { (&[1.0 / 240.0], 0.02) };
        for &dt in steps {
            let (mut world, body) = alone(inertia, Vec3::new(10.0, nudge, 0.0));
            let (l0, e0) = kept(&world, body, inertia);
            let (mut turns, mut before, mut time) = (Vec::new(), 10.0, 0.0);
            while turns.len() < 3 {
                world.step(dt).unwrap();
                time += f64::from(dt);
                let now = local_spin(&world, body).x;
                if now * before < 0.0 {
                    turns.push(time - f64::from(dt) * now / (now - before));
                }
                before = now;
                assert!(time < 20.0, "it does not flip");
            }
            let period = turns[2] - turns[0];
            let (l, e) = kept(&world, body, inertia);
            let (dl, de) = ((l - l0).length() / l0.length(), (e - e0).abs() / e0);
            println!("{nudge} dt {dt:.4}: {period:.5} of {want} s; momentum {dl:.1e}, energy {de:.1e}");
            assert!((period - want).abs() < most * want, "{nudge} dt {dt}: {period} for {want}");
            // Three flips: energy 1e-4 each. Direction of the momentum too, not only its size.
            assert!(de < 3e-4, "{nudge} dt {dt}: energy off by {de}");
            assert!(dl < 1e-4, "{nudge} dt {dt}: momentum off by {dl}");
        }
    }
}

/// A free symmetric top: its axis goes round the angular momentum at L / I1, at any spin.
#[test]
fn the_axis_of_a_free_top_precesses_at_momentum_over_inertia() {
    let inertia = Vec3::new(0.02, 0.03, 0.02);
    let dt = 1.0 / 240.0;
    let (mut world, body) = alone(inertia, Vec3::new(6.0, 20.0, 0.0));
    let (l, _) = kept(&world, body, inertia);
    let want = l.length() / 0.02;
    let up = l.normalize();
    let (e1, e2) = up.any_orthonormal_pair();
    let angle = |world: &World| {
        let axis = world.rotation(body).unwrap().as_dquat() * DVec3::Y;
        axis.dot(e2).atan2(axis.dot(e1))
    };
    let (mut gone, mut last, mut time) = (0.0f64, angle(&world), 0.0);
    while gone.abs() < 100.0 * std::f64::consts::TAU {
        world.step(dt).unwrap();
        time += f64::from(dt);
        let now = angle(&world);
        let mut turn: f64 = now - last;
        turn -= (turn / std::f64::consts::TAU).round() * std::f64::consts::TAU;
        gone += turn;
        last = now;
        assert!(time < 60.0, "it does not precess");
    }
    let rate = gone.abs() / time;
    println!("precession {rate:.4} of {want:.4} rad/s");
    assert!((rate - want).abs() < 0.01 * want, "{rate} for {want}");
}

/// The worst case of an explicit gyroscopic term: moments of 1:10 000, 1000 rad/s, a minute.
#[test]
fn a_needle_at_a_thousand_radians_a_second_stays_bounded() {
    let inertia = Vec3::new(1e-4, 1.0, 1.0);
    for direction in [Vec3::new(1.0, 0.0, 0.0), Vec3::new(1.0, 1.0, 0.3), Vec3::new(0.1, 1.0, -1.0)] {
        let spin = direction.normalize() * 1000.0;
        let (mut world, body) = alone(inertia, spin);
        let (l0, e0) = kept(&world, body, inertia);
        for _ in 0..3600 {
            world.step(1.0 / 60.0).unwrap();
            let (l, e) = kept(&world, body, inertia);
            assert!(l.is_finite() && e.is_finite());
            assert!(e < 1.01 * e0, "{direction}: energy grew from {e0} to {e}");
            assert!(l.length() < 1.001 * l0.length(), "{direction}: momentum grew from {l0} to {l}");
        }
        let (l, e) = kept(&world, body, inertia);
        println!(
            "{direction}: momentum {:.1e}, energy {:+.1e}",
            (l - l0).length() / l0.length(),
            e / e0 - 1.0
        );
        assert!((l.length() / l0.length() - 1.0).abs() < 1e-3, "{direction}: {l0} to {l}");
    }
}

/// The same with a real shape, in contact: it must not blow up when it touches something.
#[test]
fn a_spinning_needle_dropped_on_the_floor_gains_nothing() {
    let mut world = World::new(Settings::default()).unwrap();
    world.add_body(&common::Floor::Plane.desc(Default::default())).unwrap();
    let needle = ShapeDesc::new(Geometry::cuboid(1.0, 0.01, 0.01));
    let desc = BodyDesc::dynamic()
        .with_position(DVec3::new(0.0, 3.0, 0.0))
        .with_rotation(Quat::from_rotation_z(0.4));
    let body = world
        .add_body(&desc.with_shape(needle).with_velocity(Vec3::ZERO, Vec3::new(300.0, 3.0, 100.0)))
        .unwrap();
    let start = world.energy();
    for _ in 0..1200 {
        world.step(1.0 / 60.0).unwrap();
        assert!(common::all_finite(&world));
        assert!(world.energy() < 1.02 * start, "energy grew from {start} to {}", world.energy());
    }
    let at = world.position(body).unwrap();
    // Flat on its side or on an edge, on the floor.
    assert!(at.y > 0.0 && at.y < 0.02, "{at}");
}

/// Euler's equations keep both, whatever the shape, the axis, the speed and the step. What is left is
/// rounding of the state: of 14,400 steps of 6e-8 each, at random, and for the momentum of a rod times the
/// ratio of its moments, here 80. Once a box lost a tenth in this minute, and the flat rod had
/// three times its energy after ten seconds.
#[test]
fn whatever_spins_freely_keeps_its_energy_and_momentum_for_a_minute() {
    let shapes = [
        Geometry::Sphere { radius: 0.3 },
        Geometry::cuboid(0.5, 0.3, 0.15),
        Geometry::cuboid(0.5, 0.3, 0.29),
        Geometry::cuboid(0.5, 0.05, 0.04),
        Geometry::cuboid(0.5, 0.4, 0.02),
        Geometry::capsule(0.5, 0.1),
        Geometry::cylinder(0.4, 0.2),
        Geometry::cylinder(0.02, 0.5),
    ];
    for hz in [30.0, 60.0, 120.0, 240.0] {
        for speed in [10.0, 100.0, 1000.0] {
            let substeps = if speed == 100.0 { 8 } else { 1 };
            let settings = Settings::default().with_gravity(Vec3::ZERO).with_substeps(substeps);
            let mut world = World::new(settings).unwrap();
            let mut random = Random(7);
            let mut all = Vec::new();
            for geometry in &shapes {
                for n in 0..9 {
                    // Near each principal axis, and about any.
                    let principal = [Vec3::X, Vec3::Y, Vec3::Z][n % 3];
                    let axis =
                        [principal + 1e-3 * random.cube(), principal + 0.2 * random.cube(), random.cube()];
                    let (axis, rotation) = (axis[n / 3].normalize(), random.rotation());
                    let mut body = BodyDesc::dynamic()
                        .with_position(DVec3::X * 5.0 * all.len() as f64)
                        .with_rotation(rotation);
                    body.can_sleep = false;
                    let shape = ShapeDesc::new(geometry.clone());
                    let body = body.with_shape(shape).with_velocity(Vec3::ZERO, rotation * (axis * speed));
                    let body = world.add_body(&body).unwrap();
                    let inertia = world.mass_properties(body).unwrap().inertia;
                    let inertia = Vec3::new(inertia.x_axis.x, inertia.y_axis.y, inertia.z_axis.z);
                    all.push((
                        body,
                        inertia,
                        format!("{geometry:?} about {axis}"),
                        kept(&world, body, inertia),
                    ));
                }
            }
            let (mut worst_energy, mut worst_momentum) = (0.0_f64, 0.0_f64);
            for _ in 0..60 {
                (0..hz as u32).for_each(|_| {
                    world.step(1.0 / hz).unwrap();
                });
                for (body, inertia, case, (l0, e0)) in &all {
                    let (l, e) = kept(&world, *body, *inertia);
                    let (dl, de) = ((l - *l0).length() / l0.length(), (e / e0 - 1.0).abs());
                    assert!(de < 1e-4, "{case} at {speed} rad/s, {hz} Hz: energy off by {de:.1e}");
                    assert!(dl < 1e-3, "{case} at {speed} rad/s, {hz} Hz: momentum off by {dl:.1e}");
                    (worst_energy, worst_momentum) = (worst_energy.max(de), worst_momentum.max(dl));
                }
            }
            println!("{speed} rad/s {hz} Hz: energy {worst_energy:.1e}, momentum {worst_momentum:.1e}");
        }
    }
}

/// The closed solution: the body turns about the angular momentum at L / I1, and about its own axis at what
/// is left, (1 - I3 / I1) of its spin about that.
#[test]
fn a_free_top_is_where_the_closed_solution_has_it() {
    for inertia in [Vec3::new(0.02, 0.03, 0.02), Vec3::new(0.2, 0.02, 0.2)] {
        for hz in [30.0, 60.0, 240.0_f32] {
            for speed in [10.0_f32, 100.0, 1000.0] {
                let spin = Vec3::new(0.3, 0.9, -0.2) * speed;
                let (mut world, body) = alone(inertia, spin);
                (0..hz as u32).for_each(|_| {
                    world.step(1.0 / hz).unwrap();
                });
                let time = f64::from(1.0 / hz) * f64::from(hz);
                let (i, w) = (inertia.as_dvec3(), spin.as_dvec3());
                let around = DQuat::from_scaled_axis(i * w / i.x * time);
                let own = DQuat::from_rotation_y(w.y * (1.0 - i.y / i.x) * time);
                let at = world.rotation(body).unwrap().as_dquat().normalize();
                let off = at.angle_between(around * own);
                println!("{inertia} {speed} rad/s {hz} Hz: off by {off:.1e}");
                // Rounding of the spin: 6e-8 of it in each step, and of the axis.
                assert!(off < 1e-4 + 1e-5 * f64::from(speed), "{inertia} {speed} rad/s {hz} Hz: {off}");
            }
        }
    }
}
