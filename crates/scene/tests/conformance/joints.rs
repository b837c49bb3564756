//! Joints keep their limits and reach their targets, by the metrics of `KHR_physics_rigid_bodies`, appendix
//! "Joint Limit Metrics".

use super::*;
use backstop::{Axes, Axis, Limit, Motion};

/// A joint's frames in the world: the joint node's, and the connected node's.
type Frames = [(DVec3, Quat); 2];

fn relative([(ta, qa), (tb, qb)]: Frames) -> (DVec3, DQuat) {
    let back = qa.as_dquat().normalize().inverse();
    let turn = back * qb.as_dquat().normalize();
    (back * (tb - ta), if turn.w < 0.0 { -turn } else { turn })
}

/// The metric of a limit [m] or [rad].
fn metric(limit: &Limit, frames: Frames) -> f64 {
    let (apart, turn) = relative(frames);
    let e = |axis: Axis| [DVec3::X, DVec3::Y, DVec3::Z][axis as usize];
    // Arc cosines lose small angles: arc tangents of the same.
    match (limit.motion, limit.axes) {
        (Motion::Linear, Axes::One(i)) => e(i).dot(apart),
        (Motion::Linear, Axes::Perpendicular(k)) => (apart - e(k) * e(k).dot(apart)).length(),
        (Motion::Linear, Axes::All) => apart.length(),
        (Motion::Angular, Axes::One(i)) => 2.0 * turn.xyz().dot(e(i)).atan2(turn.w),
        (Motion::Angular, Axes::Perpendicular(k)) => {
            let (a, b) = (e(k), turn * e(k));
            a.cross(b).length().atan2(a.dot(b))
        }
        (Motion::Angular, Axes::All) => 2.0 * turn.xyz().length().atan2(turn.w),
    }
}

/// Two single axes that can't turn leave an axis to turn about. Past a half turn about that the metrics of
/// the two jump between zero and a whole turn, so this looks at the cone that they are together.
fn with_hinges(limits: &[Limit]) -> Vec<Limit> {
    let lock = |axis| Limit::lock(Motion::Angular, Axes::One(axis));
    let free = |axis: &Axis| !limits.contains(&lock(*axis));
    let open: Vec<Axis> = Axis::ALL.into_iter().filter(free).collect();
    let [open] = open[..] else { return limits.to_vec() };
    let rest = limits.iter().filter(|l| !Axis::ALL.iter().any(|&a| **l == lock(a)));
    rest.copied().chain([Limit::lock(Motion::Angular, Axes::Perpendicular(open))]).collect()
}

/// How far the limits of a joint were ever left [m], [rad].
#[derive(Clone, Debug, Default)]
struct Worst {
    linear: f64,
    angular: f64,
}

/// Steps a scene; returns how far each joint's limits were left after any step. `look` sees the frames of the
/// first.
fn worst(
    scene: &Scene,
    run: &mut Run,
    seconds: f32,
    dt: f32,
    mut look: impl FnMut(DVec3, DQuat),
) -> Vec<Worst> {
    let limits: Vec<Vec<Limit>> = scene.joints.iter().map(|j| with_hinges(&j.limits)).collect();
    let mut worst = vec![Worst::default(); limits.len()];
    for step in 0..=(seconds / dt).round() as u32 {
        for (i, (worst, limits)) in worst.iter_mut().zip(&limits).enumerate() {
            let frames = run.world.joint_frames(run.joints[i]).unwrap();
            for limit in limits {
                let is = metric(limit, frames);
                assert!(is.is_finite(), "{} after {step} steps of {dt}", scene.joints[i].name);
                let left = (f64::from(limit.min) - is).max(is - f64::from(limit.max)).max(0.0);
                match limit.motion {
                    Motion::Linear => worst.linear = worst.linear.max(left),
                    Motion::Angular => worst.angular = worst.angular.max(left),
                }
            }
            if i == 0 {
                let (apart, turn) = relative(frames);
                look(apart, turn);
            }
        }
        run.world.step(dt).unwrap();
    }
    worst
}

/// Runs a file at every step, and asserts its limits. A joined body accelerates like a falling one, so a
/// limit may be left by as far as that is in one step, g dt² / 2: 5.5, 1.4 and 0.09 mm, and as many
/// milliradians an arm of 1 m away. Then `check` gets the step, the world, and where the connected node was
/// after each step.
fn keeps_its_limits(number: u32, check: impl Fn(f32, &Run, &[(DVec3, DQuat)])) {
    let Some(folder) = data("gltf/tests") else { return };
    let scene = load(folder.join(format!("RigidBodies_Joint_{number:02}.gltf"))).unwrap();
    assert_eq!((scene.notes.len(), scene.joints.len()), (0, 1));
    for dt in STEPS {
        let (mut run, mut path) = (Run::new(&scene), Vec::new());
        let worst = worst(&scene, &mut run, 10.0, dt, |apart, turn| path.push((apart, turn)));
        let most = 0.5 * 9.81 * f64::from(dt) * f64::from(dt) + 1e-6;
        assert!(worst[0].linear < most && worst[0].angular < most, "{number} at {dt}: {worst:?}");
        check(dt, &run, &path);
    }
}

#[test]
fn fixed() {
    keeps_its_limits(0, |dt, run, _| assert!(run.body(1).at_rest(), "{dt}: {:?}", run.body(1)));
}

/// A cube on a hinge along its edge, let go with its centre half a right angle off the lowest point: it
/// swings through a right angle about x or z, and neither wins nor loses height.
#[test]
fn hinges() {
    for (number, axis) in [(2, DVec3::X), (4, DVec3::Z)] {
        keeps_its_limits(number, |dt, _, path| {
            let angle = |turn: &DQuat| 2.0 * turn.xyz().dot(axis).atan2(turn.w);
            let last = &path[path.len() / 2..];
            let ends =
                last.iter().map(|(_, q)| angle(q)).fold((9.0_f64, -9.0_f64), |e, a| (e.0.min(a), e.1.max(a)));
            let swing = (ends.1 - ends.0).to_degrees();
            assert!((swing - 90.0).abs() < 1.0, "{number} at {dt}: {ends:?}");
            assert!(ends.0.abs().min(ends.1.abs()) < 0.02, "{number} at {dt}: {ends:?}");
        });
    }
}

/// Slides down a line at 45 degrees from its upper end, until it meets the cube that the line goes through:
/// this joint lets the two collide.
#[test]
fn a_slider_that_collides() {
    keeps_its_limits(6, |dt, run, path| {
        let (start, end) = (path[0].0.y, path[path.len() - 1].0.y);
        assert!((start - 2.0).abs() < 1e-6 && (end - 1.0).abs() < 2e-3, "{dt}: {start} {end}");
        assert!(run.body(1).at_rest(), "{dt}: {:?}", run.body(1));
    });
}

/// Held 1 m along x, free to turn about it; its centre of mass is level with the axis, 25 cm off, when it is
/// let go, so it swings through a half turn.
#[test]
fn a_hinge_at_a_distance() {
    keeps_its_limits(8, |dt, _, path| {
        // Between the start and a half turn, whichever way a quaternion says that.
        let lowest = path[path.len() / 2..].iter().map(|(_, q)| (*q * DVec3::Z).y).fold(9.0, f64::min);
        let highest = path[path.len() / 2..].iter().map(|(_, q)| (*q * DVec3::Z).y).fold(-9.0, f64::max);
        assert!(lowest < -0.999 && highest.abs() < 0.03, "{dt}: {lowest} {highest}");
    });
}

/// Pulled to 2 m, k = 100 and c = 1 per unit of mass: it comes to rest g / k below, and its oscillation about
/// that decays with e^(-c t / 2).
#[test]
fn a_drive_reaches_its_target() {
    keeps_its_limits(10, |dt, _, path| {
        let (rest, swing) = (2.0 - 9.81 / 100.0, 9.81 / 100.0);
        let end = path[path.len() - 1].0.y;
        assert!((end - rest).abs() < swing * (-5.0_f64).exp() + 2e-4, "{dt}: {end}");
        let lowest = path.iter().map(|(p, _)| p.y).fold(9.0, f64::min);
        assert!(lowest > rest - swing && lowest < rest - 0.5 * swing, "{dt}: {lowest}");
    });
}

/// All limits, and the motions that a motor and a spring should give.
///
/// The bounds are a fifth above measured values: 0.9 m/s dt and 2.6 rad/s dt at most. The latter is a ball
/// with one angle locked and another limited, in the step in which it swings into its limit: two rows that
/// know only of each other's bodies. Before its tree kept its energy it was 1.8, three times in the run
/// instead of once.
fn sample_keeps_its_limits(collide: bool) {
    let Some(folder) = data("gltf/samples") else { return };
    let mut scene = load(folder.join("JointTypes.glb")).unwrap();
    assert_eq!((scene.notes.len(), scene.joints.len()), (0, 11));
    if !collide {
        scene.bodies.iter_mut().flat_map(|b| &mut b.desc.shapes).for_each(|s| s.filter.mask = 0);
    }
    for dt in STEPS {
        let mut run = Run::new(&scene);
        let worst = worst(&scene, &mut run, 20.0, dt, |_, _| {});
        for (joint, worst) in scene.joints.iter().zip(worst) {
            let names = joint.bodies.map(|b| scene.bodies[b].name.as_str());
            let (linear, angular) = (1.1 * f64::from(dt), 3.2 * f64::from(dt));
            assert!(worst.linear < linear && worst.angular < angular, "{names:?} at {dt}: {worst:?}");
        }
        let named = |name: &str| run.body(scene.bodies.iter().position(|b| b.name == name).unwrap());
        // Joint node on the static body, so that the motor's speed is the other body's.
        let motor = named("Cube.017").angular;
        near3(motor, Vec3::NEG_Z * 1.57, 0.05, "the motor's speed");
        // k = 10 N/m for 1 kg can't lift it to the target of 1.2 m above the other: g / k less, still
        // swinging.
        let lift = named("Cube.019").position.y - 0.253_732_68 - (2.965_963_6 + 0.25);
        assert!((lift - (1.2 - 0.981)).abs() < 0.22, "{dt}: {lift}");
    }
}

#[test]
fn the_sample_keeps_its_limits() {
    sample_keeps_its_limits(true);
}

#[test]
fn the_sample_keeps_its_limits_without_collisions() {
    sample_keeps_its_limits(false);
}

/// A joint to a node without a body holds on to the world.
#[test]
fn a_body_hangs_from_the_world() {
    let ball = |joint: Value| {
        physics(
            json!({ "motion": { "mass": 2.0 }, "collider": { "geometry": { "shape": 0 } }, "joint": joint }),
        )
    };
    let nodes = json!([
        { "translation": [0.0, 3.0, 100.0] },
        { "translation": [0.0, 2.0, 100.0], "extensions": ball(json!({ "connectedNode": 0, "joint": 0 })) }
    ]);
    let root =
        json!({ "physicsJoints": [{ "limits": [{ "linearAxes": [0, 1, 2], "min": 0.5, "max": 1.5 }] }] });
    let scene = written("hangs", nodes, json!([{ "type": "sphere" }]), root);
    for dt in STEPS {
        let mut run = Run::new(&scene);
        run.for_seconds(5.0, dt);
        let y = run.body(0).position.y;
        assert!(run.body(0).at_rest() && (y - 1.5).abs() < 2e-3, "{dt}: {y}");
        let (force, _) = run.world.joint_force(run.joints[0]).unwrap();
        near3(force, Vec3::NEG_Y * 19.62, 0.01, "on the connected node's body");
    }
}
