//! Distributes a load over the points that support a rigid body.

use glam::{DMat3, DVec3, Vec3};

// Rounding: keeps a matrix with missing directions invertible.
/// Stiffness against displacements that no point resists, as a share of that of one point: a body on an edge
/// has no equilibrium, and its estimate is bounded.
const LOOSE: f64 = 1e-9;

/// A supporting point below a body.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PointLoad {
    pub(super) contact: u32,
    pub(super) point: u32,
    /// The supporting body.
    pub(super) lower: u32,
    /// Force on the supported body, of which one along the normal is a unit: see [`with_friction`].
    pub(super) push: Vec3,
    /// From the centre of mass of the supported body [m].
    pub(super) arm: Vec3,
    /// From that of the supporting body, if it is dynamic [m].
    pub(super) arm_below: Vec3,
    /// [N]
    pub(super) force: f32,
    /// Effect of a unit of force: upwards, and about two level axes divided by the longest arm.
    pub(super) row: Vec3,
    pub(super) pulls: bool,
}

/// The force with which a surface bears a body at rest, of which one along its unit `normal` is a unit:
/// straight up, as far as static friction allows. On a slope a weight presses with its cosine, not with the
/// inverse of it.
pub(super) fn with_friction(normal: Vec3, up: Vec3, friction: f32) -> Vec3 {
    let steep = normal.dot(up);
    let along = up - normal * steep;
    let sine = along.length();
    // The force that is straight up is `up / steep`, with `sine / steep` along the surface.
    if sine <= friction * steep { up / steep } else { normal + along * (friction / sine) }
}

/// Sets the forces of points that balance a force and a moment about the centre of mass of the body above
/// them: those of equal springs under a rigid body, none of which pulls.
///
/// These are also the smallest such forces (in the sum of squares), and those that the springs of the
/// contacts have at rest, so that a resting body starts where it stays. Only forces upwards and moments about
/// level axes are balanced: horizontal forces of surfaces too steep for their friction are left out.
pub(super) fn distribute(
    points: &mut [PointLoad],
    force: Vec3,
    moment: Vec3,
    up: Vec3,
    level_axes: [Vec3; 2],
) {
    let reach = points.iter().fold(f32::MIN_POSITIVE, |reach, p| reach.max(p.arm.length()));
    let level = |v: Vec3| Vec3::new(0.0, v.dot(level_axes[0]), v.dot(level_axes[1])) / reach;
    for point in points.iter_mut() {
        point.row = level(point.arm.cross(point.push)) + Vec3::X * point.push.dot(up);
    }
    let load = level(moment) + Vec3::X * force.dot(up);
    for _ in 0..points.len() {
        let mut stiffness = DMat3::from_diagonal(DVec3::splat(LOOSE));
        for row in points.iter().filter(|p| !p.pulls).map(|p| p.row.as_dvec3()) {
            stiffness += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
        }
        let displacement = stiffness.inverse() * load.as_dvec3();
        let mut least: Option<(usize, f32)> = None;
        for (i, point) in points.iter_mut().enumerate().filter(|(_, p)| !p.pulls) {
            point.force = point.row.as_dvec3().dot(displacement) as f32;
            if point.force < least.map_or(0.0, |(_, force)| force) {
                least = Some((i, point.force));
            }
        }
        let Some((i, _)) = least else { break };
        (points[i].pulls, points[i].force) = (true, 0.0);
    }
    // A body that would topple has no equilibrium: its supports bear no more than its weight.
    let borne: f32 = points.iter().map(|p| p.force * p.row.x).sum();
    let share = if borne > load.x { load.x.max(0.0) / borne } else { 1.0 };
    for point in points {
        point.force = if point.force.is_finite() { (point.force * share).max(0.0) } else { 0.0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn forces(at: &[[f32; 2]], force: f32, moment: Vec3) -> Vec<f32> {
        let point = |&[x, z]: &[f32; 2]| PointLoad {
            push: Vec3::Y,
            arm: Vec3::new(x, -0.5, z),
            ..PointLoad::default()
        };
        let mut points: Vec<PointLoad> = at.iter().map(point).collect();
        distribute(&mut points, Vec3::Y * force, moment, Vec3::Y, [Vec3::X, Vec3::Z]);
        points.iter().map(|p| p.force).collect()
    }

    /// A square slab of 12 N without thickness on a slope of 30 degrees. Expected: held by friction it
    /// presses with 12 cos 30 N; without friction the normal force alone balances it upwards, 12 / cos 30 N.
    #[test]
    fn a_slope_bears_a_weight_straight_up_as_far_as_friction_allows() {
        let (cosine, sine) = (0.75_f32.sqrt(), 0.5);
        let normal = Vec3::new(sine, cosine, 0.0);
        let along = Vec3::new(cosine, -sine, 0.0);
        for (friction, expected) in [(0.6, 12.0 * cosine), (0.0, 12.0 / cosine)] {
            let push = with_friction(normal, Vec3::Y, friction);
            let arms = [along, -along, Vec3::Z, -Vec3::Z];
            let mut points = arms.map(|arm| PointLoad { push, arm, ..PointLoad::default() });
            distribute(&mut points, Vec3::Y * 12.0, Vec3::ZERO, Vec3::Y, [Vec3::X, Vec3::Z]);
            let sum: f32 = points.iter().map(|p| p.force).sum();
            assert!((sum - expected).abs() < 2e-3, "{friction}: {sum} for {expected}");
            assert!((push.dot(normal) - 1.0).abs() < 1e-6, "{push}");
        }
    }

    /// Expected values by the law of the lever, for a weight of 12 N.
    #[test]
    fn a_load_is_shared_by_the_law_of_the_lever() {
        let near = |forces: Vec<f32>, expected: &[f32]| {
            assert!(
                forces.iter().zip(expected).all(|(f, e)| (f - e).abs() < 2e-3),
                "{forces:?} {expected:?}"
            );
        };
        // A square under the middle: a quarter each.
        let square = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
        near(forces(&square, 12.0, Vec3::ZERO), &[3.0; 4]);
        // Supports 1 m and 3 m beside the centre, two points each.
        let uneven = [[1.0, 1.0], [1.0, -1.0], [-3.0, 1.0], [-3.0, -1.0]];
        near(forces(&uneven, 12.0, Vec3::ZERO), &[4.5, 4.5, 1.5, 1.5]);
        // A moment of 6 N m about z is 1.5 N more on one side and 1.5 N less on the other at 2 m apart, two
        // points a side.
        near(forces(&square, 12.0, Vec3::Z * 6.0), &[4.5, 4.5, 1.5, 1.5]);
        // Twice the moment that lifts a side: no point pulls, and no more than the weight is supported.
        let tilted = forces(&square, 12.0, Vec3::Z * 24.0);
        assert!(tilted.iter().all(|&f| f >= 0.0) && tilted.iter().sum::<f32>() <= 12.001, "{tilted:?}");
        // On an edge there is no equilibrium, only bounds.
        let edge = forces(&[[1.0, 1.0], [1.0, -1.0]], 12.0, Vec3::ZERO);
        assert!(edge.iter().all(|&f| (0.0..=12.0).contains(&f)), "{edge:?}");
        assert!(forces(&[], 12.0, Vec3::ZERO).is_empty());
    }
}
