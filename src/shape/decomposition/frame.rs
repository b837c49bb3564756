//! The grid on which a solid is cut: its axes, and its steps.

use glam::{DMat3, DVec3, Vec3};

/// A grid of integers.
#[derive(Debug)]
pub(super) struct Frame {
    /// From the grid's axes to the mesh's.
    axes: DMat3,
    /// The grid's zero, along the grid's axes [m].
    origin: DVec3,
    /// A power of two [m]: numbers of few digits stay exact.
    step: f64,
}

/// Steps along the longest side are between half of this and this.
const STEPS: u64 = 1 << 22;

impl Frame {
    /// The frame along whose axes most faces of a mesh lie: identity, if no others are better.
    pub(super) fn of(triangles: &[[DVec3; 3]], principal: DMat3) -> Frame {
        let areas: Vec<DVec3> = triangles.iter().map(|[a, b, c]| (b - a).cross(c - a)).collect();
        // Faces across an axis add one component, others two or three.
        let score = |axes: &DMat3| -> f64 {
            let turned = axes.transpose();
            areas.iter().map(|&area| (turned * area).abs().element_sum()).sum()
        };
        let mut best = (score(&DMat3::IDENTITY) * BETTER, DMat3::IDENTITY);
        for axes in [Some(principal), by_faces(&areas)].into_iter().flatten() {
            let score = score(&axes);
            if score < best.0 {
                best = (score, axes);
            }
        }
        Frame::along(best.1, triangles)
    }

    fn along(axes: DMat3, triangles: &[[DVec3; 3]]) -> Frame {
        let turned = axes.transpose();
        let places = triangles.iter().flatten().map(|&p| turned * p);
        let (low, high) =
            places.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let size = (high - low).max_element().max(f64::MIN_POSITIVE);
        // The power of two at or below the size.
        let power = f64::from_bits(size.to_bits() >> 52 << 52);
        let step = 2.0 * power / STEPS as f64;
        Frame { axes, origin: (low / step).floor() * step, step }
    }

    pub(super) fn to_grid(&self, place: DVec3) -> [i64; 3] {
        ((self.axes.transpose() * place - self.origin) / self.step).round().to_array().map(|x| x as i64)
    }

    pub(super) fn out_of(&self, points: &[DVec3]) -> Vec<Vec3> {
        points.iter().map(|&p| (self.axes * (self.origin + p * self.step)).as_vec3()).collect()
    }
}

// Rounding: of the sum over all faces; axes that are as good as the mesh's own are not taken.
const BETTER: f64 = 0.999;

/// The normal of the largest face, and of the largest one that is about across it.
fn by_faces(areas: &[DVec3]) -> Option<DMat3> {
    let largest = |fit: &dyn Fn(DVec3) -> bool| {
        let fitting = areas.iter().copied().filter(|&area| fit(area));
        fitting.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))
    };
    let x = largest(&|_| true)?.try_normalize()?;
    let y = largest(&|area| area.dot(x).abs() <= 0.1 * area.length())?;
    let y = (y - x * y.dot(x)).try_normalize()?;
    Some(DMat3::from_cols(x, y, x.cross(y)))
}
