//! A chain that hangs on two bodies gains no energy.

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, Geometry, JointDesc, Settings, ShapeDesc, World};
use std::f32::consts::FRAC_PI_2;

/// A bridge of hinged planks, level and straight at the start, between two ends that are nearer by a slack:
/// rms speed of the planks in a second of each ten, and how far the worst joint is open [lengths of a plank].
fn bridge(planks: u32, slack: f64, hertz: u32, substeps: u32, seconds: u32) -> (Vec<f64>, f64) {
    let mut world = World::new(Settings::default().with_substeps(substeps).with_sleeping(false)).unwrap();
    let (length, axes) = (0.5, Quat::from_rotation_y(-FRAC_PI_2));
    // Along an arc that is as much longer than its chord: 1 + a²/6, and half the angle a at each end.
    let angle = (6.0 * slack).sqrt();
    let direction = |i: f64| angle * (2.0 * i / f64::from(planks) - 1.0);
    let mut at = DVec3::ZERO;
    let mut last = world.add_body(&BodyDesc::fixed()).unwrap();
    let (mut bodies, mut joints) = (Vec::new(), Vec::new());
    let mut join = |world: &mut World, pair, at| {
        let frames = world.frames_at(pair, at, axes).unwrap();
        joints.push(world.add_joint(&JointDesc::hinge(pair, frames)).unwrap());
    };
    for i in 0..planks {
        let turn = direction(f64::from(i) + 0.5);
        let way = DVec3::new(turn.cos(), turn.sin(), 0.0) * length;
        let mut shape = ShapeDesc::new(Geometry::cuboid(0.5 * length as f32 - 0.02, 0.03, 0.5));
        shape.filter.mask = 0;
        let desc = BodyDesc::dynamic()
            .with_position(at + 0.5 * way)
            .with_rotation(Quat::from_rotation_z(turn as f32))
            .with_shape(shape);
        let plank = world.add_body(&desc).unwrap();
        join(&mut world, [last, plank], at);
        bodies.push(plank);
        (at, last) = (at + way, plank);
    }
    let end = world.add_body(&BodyDesc::fixed().with_position(at)).unwrap();
    join(&mut world, [last, end], at);
    let (mut speeds, mut open) = (Vec::new(), 0.0_f64);
    for second in 0..seconds {
        let mut sum = 0.0;
        for _ in 0..hertz {
            world.step(1.0 / hertz as f32).unwrap();
            for &body in &bodies {
                let (v, w): (Vec3, Vec3) =
                    (world.linear_velocity(body).unwrap(), world.angular_velocity(body).unwrap());
                sum += f64::from(v.length_squared() + 0.25 * w.length_squared());
            }
        }
        for &joint in &joints {
            let [(a, _), (b, _)] = world.joint_frames(joint).unwrap();
            open = open.max((a - b).length() / length);
        }
        if second % 10 == 9 {
            speeds.push((sum / f64::from(hertz * planks)).sqrt());
        }
    }
    (speeds, open)
}

/// Hinges without friction take no energy: a bridge that starts next to where it hangs goes on to sway, but
/// no more than it did at first.
fn check(cases: &[(u32, f64, u32, u32)]) {
    let mut wrong = Vec::new();
    for &(planks, slack, hertz, substeps) in cases {
        let (speeds, open) = bridge(planks, slack, hertz, substeps, 60);
        println!("{planks} planks, {slack}, {hertz} Hz x {substeps}: {speeds:.5?} m/s, open {open:.1e}");
        let last = *speeds.last().unwrap();
        if !(last < 1.05 * speeds[0] && last < 0.2 && open < 0.05) {
            wrong.push((planks, slack, hertz, substeps, last, open));
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn a_bridge_of_planks_calms_down() {
    check(&[(50, 0.04, 60, 4), (50, 0.04, 30, 4), (50, 0.04, 120, 4), (50, 0.01, 60, 4), (50, 0.04, 60, 8)]);
}

#[test]
fn any_bridge_calms_down() {
    check(&[(10, 0.04, 60, 4), (50, 0.04, 60, 1)]);
}
