use super::*;
use crate::narrow_phase::cast::{Other, Sweep, tolerance};
use crate::narrow_phase::fixtures::{CONVEX, collider};
use crate::random::Random;
use crate::shape::Geometry;
use crate::shape::support::Support;

/// No triangle is left out that the exact search finds to be touched, and none is touched before the fraction
/// that is given for it.
#[test]
fn nothing_that_is_touched_is_left_out() {
    let mut random = Random(77);
    let (mut touched, mut left_out, mut all) = (0, 0, 0);
    for i in 0..if cfg!(miri) { 5 } else { 1000 } {
        let mut a = random.shape(CONVEX[i % 5], 1.0);
        if i % 2 == 0 {
            a.position = random.cube();
        }
        let b = collider(Geometry::Plane);
        let (mut pa, pb) = (random.body(4.0, [0.0, 0.5, 3.0][i % 3]), random.body(1.0, 0.0));
        pa.displacement = pa.centre.as_vec3() * -2.0 + pb.displacement * 3.0;
        let motion = Motion::new(&a, &pa, &b, &pb);
        let eps = tolerance(&a, &b, 1.0);
        let mut eight = Eight::default();
        // With the tolerance, and nearly without: as casts search once something is touched.
        let mut exact = Vec::new();
        for k in 0..8 {
            let triangle = random.triangle(2.0);
            eight.push(k, triangle);
            exact.push([eps, 1e-3 * eps].map(|eps| {
                let other = Other::Convex(Support::triangle(triangle));
                Sweep::new(a.geometry.support().unwrap(), other, &motion, eps).first_touch(1.0)
            }));
        }
        let mut sweep = MeshSweep::new(&a, &motion.relative(0.0), &motion, eps);
        for until in [1.0, 0.6, 0.2] {
            if until < 1.0 {
                sweep.end_at(until);
            }
            let cast = MeshCast::first(eps, 0.0);
            let Reached { lanes, .. } = sweep.by_planes(&eight, eight.lanes(), &cast);
            let (lanes, earliest) = sweep.sift(&eight, lanes, &cast);
            for (k, touch) in exact.iter().enumerate() {
                all += 1;
                left_out += 1 - (lanes >> k & 1);
                let touch = touch[usize::from(until < 1.0)];
                let Some(touch) = touch.filter(|t| (1e-6..=until).contains(&t.fraction)) else {
                    continue;
                };
                touched += 1;
                assert!(lanes >> k & 1 != 0, "{i} {k} {until} {touch:?} {a:?} {motion:?}");
                assert!(earliest[k] <= touch.fraction + 1e-5, "{i} {k} {until} {touch:?} {}", earliest[k]);
            }
        }
    }
    // Most triangles that are not touched are left out; otherwise the test in lanes would not pay.
    assert!(cfg!(miri) || touched > 500 && left_out > (all - touched) / 2, "{touched} {left_out} {all}");
}
