//! How deep a body is beyond the surface of its target: by its deepest point, not by its centre.

use super::target::{TARGETS, Targets};
use backstop::ShapeDesc;
use glam::{DQuat, DVec3};

/// Sample points per side for the slope of bumpy ground below a body.
const PLACES: i32 = 3;

impl Targets {
    /// Distance of the deepest point of a body beyond the surface of a target [m]; negative if all of it is
    /// in front. For bumpy ground a lower bound: the body's furthest points against the slopes below it are
    /// examined.
    pub(super) fn depth_of(&self, target: usize, shapes: &[ShapeDesc], at: DVec3, rotation: DQuat) -> f64 {
        let deepest = |into: DVec3| furthest(shapes, at, rotation, into);
        if Self::is_corner(target) {
            let front = f64::from(self.front(target, 0.0, 0.0));
            return DVec3::AXES
                .into_iter()
                .map(|axis| front - deepest(-axis).dot(axis))
                .fold(f64::NEG_INFINITY, f64::max);
        }
        let below = |point: DVec3| {
            let (x, z) = (point.x as f32, point.z as f32);
            let height = f64::from(self.front(target, x, z));
            (height - point.y) * self.slope(target, x, z).y
        };
        let low = below(deepest(DVec3::NEG_Y));
        if TARGETS[target] != "bumpy_mesh" {
            return low;
        }
        let reach = f64::from(super::body::reach(shapes));
        let places = (-PLACES..=PLACES).flat_map(|i| (-PLACES..=PLACES).map(move |k| (i, k)));
        places
            .map(|(i, k)| {
                let step = reach / f64::from(PLACES);
                let (x, z) = (at.x + f64::from(i) * step, at.z + f64::from(k) * step);
                below(deepest(-self.slope(target, x as f32, z as f32)))
            })
            .fold(low, f64::max)
    }

    /// Normal of flat or bumpy ground.
    fn slope(&self, target: usize, x: f32, z: f32) -> DVec3 {
        /// Far less than a cell, far more than a rounding [m].
        const STEP: f32 = 0.01;
        let height = |x: f32, z: f32| f64::from(self.front(target, x, z));
        let along = |a: f64, b: f64| (a - b) / f64::from(2.0 * STEP);
        let dx = along(height(x + STEP, z), height(x - STEP, z));
        let dz = along(height(x, z + STEP), height(x, z - STEP));
        DVec3::new(-dx, 1.0, -dz).normalize()
    }
}

/// The point of a body that is furthest along a unit vector.
fn furthest(shapes: &[ShapeDesc], at: DVec3, rotation: DQuat, way: DVec3) -> DVec3 {
    let points = shapes.iter().filter_map(|shape| {
        let turn = rotation * shape.rotation.as_dquat();
        let point = shape.geometry.furthest(turn.conjugate() * way)?;
        Some(at + rotation * shape.position.as_dvec3() + turn * point)
    });
    points.max_by(|a, b| a.dot(way).total_cmp(&b.dot(way))).unwrap_or(at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use backstop::Geometry;
    use glam::{Quat, Vec3};

    /// By hand: a cube on its corner is deep by half its diagonal less the height of its centre; a ball by
    /// its radius.
    #[test]
    fn the_deepest_point_is_that_of_the_shape() {
        let targets = Targets::new().unwrap();
        let cube = [ShapeDesc::new(Geometry::cuboid(1.0, 1.0, 1.0))];
        let corner = DQuat::from_rotation_arc(DVec3::ONE.normalize(), DVec3::NEG_Y);
        let depth = targets.depth_of(0, &cube, DVec3::new(3.0, 1.5, 2.0), corner);
        assert!((depth - (3f64.sqrt() - 1.5)).abs() < 1e-6, "{depth}");
        let ball = [ShapeDesc::new(Geometry::Sphere { radius: 0.5 })
            .with_position(Vec3::X)
            .with_rotation(Quat::from_rotation_z(0.3))];
        // The front of that box is at 0.01 m; turned by a quarter about z the ball is a metre above the
        // origin.
        let up = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
        let depth = targets.depth_of(2, &ball, DVec3::new(0.0, -0.6, 0.0), up);
        assert!((depth - (0.01 + 0.5 - 0.4)).abs() < 1e-6, "{depth}");
        let depth = targets.depth_of(5, &ball, DVec3::new(2.0, 0.2, 5.0), DQuat::IDENTITY);
        assert!((depth - 0.3).abs() < 1e-6, "{depth}");
    }

    /// On a slope of 45 degrees and less a ball is as deep as its radius less the distance of its centre from
    /// the ground, which is at least the height times the cosine of the steepest slope.
    #[test]
    fn bumpy_ground_is_measured_along_its_slope() {
        let targets = Targets::new().unwrap();
        let ball = [ShapeDesc::new(Geometry::Sphere { radius: 0.2 })];
        for i in 0..200 {
            let (x, z) = (f64::from(i) * 0.37 - 30.0, f64::from(i) * 0.21 - 20.0);
            let high = f64::from(targets.front(1, x as f32, z as f32)) + 0.1;
            let depth = targets.depth_of(1, &ball, DVec3::new(x, high, z), DQuat::IDENTITY);
            assert!(
                (0.09..=0.2 - 0.1 * std::f64::consts::FRAC_1_SQRT_2 + 1e-3).contains(&depth),
                "{i}: {depth}"
            );
        }
    }
}
