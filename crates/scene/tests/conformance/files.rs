//! CollisionFilter, Materials and MotionProperties: the files at hand, with what follows from their contents.

use super::*;
use backstop::glam::Vec3Swizzles;

/// A file of the family, if there is data.
fn file(name: &str) -> Option<PathBuf> {
    data("gltf/tests").map(|d| d.join(format!("RigidBodies_{name}.gltf")))
}

/// Ground at height 0. The ball at -5 may collide with it, the one at +5 only with dynamic ones.
#[test]
fn a_filter_lets_one_ball_through() {
    let Some(path) = file("CollisionFilter_00") else { return };
    for dt in STEPS {
        let mut run = Run::file(&path);
        run.for_seconds(5.0, dt);
        let (held, lost) = (run.body(0), run.body(1));
        assert!((held.position.y - 1.0).abs() < 2e-3 && held.at_rest(), "{dt}: {held:?}");
        // Free fall for 5 s: 122.6 m, less or more by the fall of a step.
        let fall = 0.5 * 9.81 * 25.0;
        assert!((lost.position.y - 5.0 + fall).abs() < 9.81 * 5.0 * dt as f64, "{dt}: {lost:?}");
    }
}

/// Dumbbells of two cubes, 3 m high: only one cube of each may touch the ground, the lower one of the first,
/// the upper one of the second (which is turned upside down, so the ground reaches into it).
#[test]
fn a_compound_is_filtered_by_part() {
    let Some(path) = file("CollisionFilter_02") else { return };
    for dt in STEPS {
        let mut run = Run::file(&path);
        run.for_seconds(10.0, dt);
        let (stands, hangs) = (run.body(0), run.body(1));
        assert!((stands.position.y - 1.5).abs() < 2e-3 && stands.at_rest(), "{dt}: {stands:?}");
        assert!((hangs.position.y + 0.5).abs() < 2e-3 && hangs.at_rest(), "{dt}: {hangs:?}");
    }
}

/// Balls of restitution 0 and 1, on ground of 0.5; the ground's rule, average, goes before theirs, maximum:
/// 0.25 and 0.75. They fall 4 m and rise to e² of it.
#[test]
fn restitution_combines_by_the_stronger_rule() {
    let Some(path) = file("Materials_00") else { return };
    for dt in STEPS {
        let mut run = Run::file(&path);
        let rises = rebounds(&mut run, &[0, 1], dt);
        for (rise, e) in rises.iter().zip([0.25, 0.75]) {
            let expected = 4.0 * e * e;
            assert!((rise - 1.0 - expected).abs() < 0.02 * expected, "{dt}: {rise} for e = {e}");
        }
    }
}

/// Highest point of each body between its first and its second bounce. A step may end on the surface, at
/// rest, and the next one bounce.
pub(super) fn rebounds(run: &mut Run, bodies: &[usize], dt: f32) -> Vec<f64> {
    let mut top = vec![0.0f64; bodies.len()];
    let mut bounces = vec![0; bodies.len()];
    let mut falls = vec![false; bodies.len()];
    for _ in 0..(4.0 / dt) as u32 {
        run.world.step(dt).unwrap();
        for (k, &i) in bodies.iter().enumerate() {
            let is = run.body(i);
            if falls[k] && is.linear.y > 0.1 {
                (falls[k], bounces[k]) = (false, bounces[k] + 1);
            }
            falls[k] |= is.linear.y < -0.1;
            if bounces[k] == 1 {
                top[k] = top[k].max(is.position.y);
            }
        }
    }
    top
}

/// Plates on a slope of 45°, in average with the ground's default of 0.6: friction 0.3 slides with g (sin -
/// 0.3 cos), friction 5.3 holds.
#[test]
fn a_plate_slides_and_a_plate_sticks() {
    let Some(path) = file("Materials_02") else { return };
    for dt in STEPS {
        let mut run = Run::file(&path);
        let start = [run.body(0).position, run.body(1).position];
        run.for_seconds(1.0, dt);
        let (slides, sticks) = (run.body(0), run.body(1));
        let expected = 9.81 * std::f32::consts::FRAC_1_SQRT_2 * (1.0 - 0.3);
        let along = Vec3::new(0.0, -1.0, -1.0).normalize()
            * if slides.linear.z > 0.0 { Vec3::new(1.0, 1.0, -1.0) } else { Vec3::ONE };
        assert!((slides.linear.dot(along) - expected).abs() < 0.02 * expected, "{dt}: {slides:?}");
        assert!((slides.linear - along * slides.linear.dot(along)).length() < 0.02, "{dt}: {slides:?}");
        let moved = (slides.position - start[0]).length() as f32;
        assert!((moved - 0.5 * expected).abs() < 0.02 * expected + expected * dt, "{dt}: {moved}");
        run.for_seconds(9.0, dt);
        let sticks_later = run.body(1);
        assert!((sticks.position - start[1]).length() < 2e-3, "{dt}: {sticks:?}");
        assert!((sticks_later.position - start[1]).length() < 4e-3, "{dt}: {sticks_later:?}");
        assert!(sticks_later.at_rest(), "{dt}: {sticks_later:?}");
    }
}

#[test]
fn without_gravity_it_stays() {
    let Some(path) = file("MotionProperties_00") else { return };
    let mut run = Run::file(&path);
    run.for_seconds(10.0, 1.0 / 60.0);
    let is = run.body(0);
    assert_eq!((is.position, is.linear, is.angular), (DVec3::ZERO, Vec3::ZERO, Vec3::ZERO));
}

/// 1 rad/s about x, given in the node's axes; in the second file the node is turned by its parent.
#[test]
fn it_spins_about_its_nodes_axis() {
    for name in ["MotionProperties_02", "MotionProperties_04"] {
        let Some(path) = file(name) else { return };
        for dt in STEPS {
            let mut run = Run::file(&path);
            let start = run.body(0);
            near3(start.angular, Vec3::X, 1e-6, name);
            run.for_seconds(10.0, dt);
            let is = run.body(0);
            near3(is.angular, Vec3::X, 1e-5, name);
            near3(is.position.as_vec3(), Vec3::ZERO, 1e-5, name);
            let turned = Quat::from_rotation_x(10.0) * start.rotation;
            assert!(is.rotation.dot(turned).abs() > 1.0 - 1e-5, "{name}: {is:?}");
        }
    }
}

/// Cubes at 5 m/s hit cubes of 1 kg at rest, without restitution: 1 kg ends at 2.5 m/s with the other, 100 kg
/// hardly slow down. The momentum stays.
#[test]
fn masses_share_their_momentum() {
    let Some(path) = file("MotionProperties_06") else { return };
    for dt in STEPS {
        let mut run = Run::file(&path);
        run.for_seconds(2.0, dt);
        for (hitter, hit, mass) in [(0, 2, 1.0), (1, 3, 100.0)] {
            let (hitter, hit) = (run.body(hitter), run.body(hit));
            let together = 5.0 * mass / (mass + 1.0);
            // Four points share the impact evenly, so nothing is left of it but rounding.
            near3(hitter.linear, Vec3::X * together, 1e-5, "the one that hits");
            near3(hit.linear, Vec3::X * together, 1e-5, "the one that is hit");
            assert!(hitter.linear.yz().length() < 1e-5 && hit.angular.length() < 1e-5, "{dt}: {hit:?}");
            let momentum = mass * hitter.linear.x + hit.linear.x;
            assert!((momentum - 5.0 * mass).abs() < 1e-5 * mass, "{dt}: {momentum}");
        }
    }
}
