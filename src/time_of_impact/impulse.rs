//! An impact of two bodies, solved on its own at the moment it happens.

use crate::constraint::ImpactBody;
use glam::Vec3;

/// Maximum number of points of an impact: four manifolds.
pub(super) const MAX_POINTS: usize = 16;
/// Gauss-Seidel sweeps over them.
const SWEEPS: usize = 16;

/// A point at which they touch.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Point {
    /// Unit, from a to b.
    pub(super) normal: Vec3,
    /// From the bodies' centres [m].
    pub(super) arms: [Vec3; 2],
}

/// The material of the pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Law {
    pub(super) friction: f32,
    pub(super) restitution: f32,
    /// Approach speeds below this don't bounce [m/s].
    pub(super) threshold: f32,
}

/// Newton's restitution and Coulomb's friction at all points together, by sequential impulses. Returns how
/// fast the two separate at the point where they approached fastest [m/s], or `None` if they did not
/// approach.
pub(super) fn resolve(
    a: &mut ImpactBody,
    b: &mut ImpactBody,
    points: &[Point],
    law: Law,
) -> Option<(f32, Vec3)> {
    let mut rows = [(0.0_f32, 0.0_f32, Vec3::ZERO); MAX_POINTS];
    let speed = |a: &ImpactBody, b: &ImpactBody, p: &Point| p.normal.dot(b.at(p.arms[1]) - a.at(p.arms[0]));
    let mut fastest = (0.0_f32, 0);
    for (i, (row, p)) in rows.iter_mut().zip(points).enumerate() {
        let approach = -speed(a, b, p);
        row.0 = if approach > law.threshold { law.restitution * approach } else { 0.0 };
        if approach > fastest.0 {
            fastest = (approach, i);
        }
    }
    if fastest.0 <= 0.0 {
        return None;
    }
    for _ in 0..SWEEPS {
        for ((target, load, rubbed), p) in rows.iter_mut().zip(points) {
            let ease = a.ease(p.arms[0], p.normal) + b.ease(p.arms[1], p.normal);
            if ease <= 0.0 {
                continue;
            }
            let new = (*load + (*target - speed(a, b, p)) / ease).max(0.0);
            let change = p.normal * (new - *load);
            *load = new;
            a.push(p.arms[0], -change);
            b.push(p.arms[1], change);

            let slip = (b.at(p.arms[1]) - a.at(p.arms[0])).reject_from_normalized(p.normal);
            let Some(way) = slip.try_normalize() else { continue };
            let ease = a.ease(p.arms[0], way) + b.ease(p.arms[1], way);
            let wanted = *rubbed - way * (slip.length() / ease);
            let most = law.friction * *load;
            let now = wanted.clamp_length_max(most);
            let change = now - *rubbed;
            *rubbed = now;
            a.push(p.arms[0], -change);
            b.push(p.arms[1], change);
        }
    }
    let hardest = &points[fastest.1];
    Some((speed(a, b, hardest), hardest.normal))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Record, Sym3};

    fn ball(velocity: Vec3) -> ImpactBody {
        // 1 kg, radius 1: 2/5 m r².
        let i = 2.5;
        let inverse_inertia = Sym3 { xx: i, yy: i, zz: i, xy: 0.0, xz: 0.0, yz: 0.0 };
        let velocity = Record { linear: velocity, ..Record::default() };
        ImpactBody { velocity, inverse_mass: Vec3::ONE, inverse_inertia }
    }

    fn wall() -> ImpactBody {
        ImpactBody { velocity: Record::default(), inverse_mass: Vec3::ZERO, inverse_inertia: Sym3::default() }
    }

    #[test]
    fn a_rough_ball_that_hits_at_an_angle_leaves_rolling() {
        // With mu large enough the slip ends: v_t' = 5/7 v_t for a solid ball without spin.
        let (mut a, mut b) = (ball(Vec3::new(7.0, -3.0, 0.0)), wall());
        let points = [Point { normal: Vec3::NEG_Y, arms: [Vec3::NEG_Y, Vec3::ZERO] }];
        let law = Law { friction: 10.0, restitution: 0.5, threshold: 0.1 };
        let (parting, _) = resolve(&mut a, &mut b, &points, law).unwrap();
        assert!((parting - 1.5).abs() < 1e-5);
        assert!((a.velocity.linear - Vec3::new(5.0, 1.5, 0.0)).length() < 1e-5, "{a:?}");
        assert!((a.velocity.angular - Vec3::new(0.0, 0.0, -5.0)).length() < 1e-5);
    }

    #[test]
    fn slip_takes_no_more_than_coulombs_share() {
        let (mut a, mut b) = (ball(Vec3::new(7.0, -3.0, 0.0)), wall());
        let points = [Point { normal: Vec3::NEG_Y, arms: [Vec3::NEG_Y, Vec3::ZERO] }];
        let law = Law { friction: 0.2, restitution: 0.0, threshold: 0.1 };
        resolve(&mut a, &mut b, &points, law).unwrap();
        assert!((a.velocity.linear - Vec3::new(7.0 - 0.6, 0.0, 0.0)).length() < 1e-5, "{a:?}");
        assert!(resolve(&mut a, &mut b, &points, law).is_none());
    }
}
