//! Half-spaces.

use super::outline::{Line, Triangle, Window};
use super::solid::{Entry, NearPoint};
use super::{Form, Kind};
use crate::math::Quat;
use glam::{DVec3, Vec3};

/// All of y <= 0.
#[derive(Clone, Copy)]
pub(in crate::shape) struct HalfSpace;

// Guard: an endless plane is drawn to here.
/// Extent of a drawn plane to each side of its origin [m].
const SHOWN: f32 = 20.0;
/// Lines along a plane, each way.
const GRID: u32 = 20;

/// The drawn part: the low and high corner of the window, or of the default extent without one; nothing if
/// the plane is outside.
fn shown(window: Window) -> Option<(Vec3, Vec3)> {
    let (min, max) = window.unwrap_or((Vec3::splat(-SHOWN), Vec3::splat(SHOWN)));
    (min.y <= 0.0 && max.y >= 0.0).then_some((min, max))
}

impl<'a> Form<'a> for HalfSpace {
    const KIND: Kind = Kind::Plane;
    const NAME: &'static str = "plane";
    const CODE: u32 = 4;

    fn aabb(self) -> (Vec3, Vec3) {
        (Vec3::NEG_INFINITY, Vec3::INFINITY.with_y(0.0))
    }

    /// Bounded only if its normal is exactly an axis.
    fn turned_bounds(self, rotation: Quat) -> (Vec3, Vec3) {
        let normal = rotation * Vec3::Y;
        let (mut min, mut max) = (Vec3::NEG_INFINITY, Vec3::INFINITY);
        for k in 0..3 {
            let others = normal.abs().dot(Vec3::ONE) - normal[k].abs();
            if others == 0.0 && normal[k] > 0.0 {
                max[k] = 0.0;
            } else if others == 0.0 && normal[k] < 0.0 {
                min[k] = 0.0;
            }
        }
        (min, max)
    }

    fn radius(self) -> f32 {
        f32::INFINITY
    }

    #[inline]
    fn enter(self, start: DVec3, path: DVec3, _extra: f64) -> Option<Entry> {
        let end = start.y + path.y;
        (start.y >= 0.0 && path.y < 0.0 && end <= 0.0).then(|| ((start.y / -path.y).min(1.0), DVec3::Y))
    }

    fn contains(self, at: DVec3) -> bool {
        at.y < 0.0
    }

    fn nearest(self, at: DVec3) -> Option<NearPoint> {
        Some(NearPoint::outside(at, DVec3::new(at.x, 0.0, at.z), DVec3::Y))
    }

    fn triangles(self, window: Window, triangle: &mut Triangle<'_>) {
        let Some((min, max)) = shown(window) else { return };
        let at = |x: f32, z: f32| Vec3::new(x, 0.0, z);
        let corners = [at(min.x, min.z), at(min.x, max.z), at(max.x, max.z), at(max.x, min.z)];
        triangle([corners[0], corners[1], corners[2]]);
        triangle([corners[0], corners[2], corners[3]]);
    }

    fn lines(self, window: Window, line: &mut Line<'_>) {
        let Some((min, max)) = shown(window) else { return };
        let at = |u: f32, v: f32| Vec3::new(min.x + (max.x - min.x) * u, 0.0, min.z + (max.z - min.z) * v);
        for i in 0..=GRID {
            let u = i as f32 / GRID as f32;
            line(at(u, 0.0), at(u, 1.0));
            line(at(0.0, u), at(1.0, u));
        }
    }
}
