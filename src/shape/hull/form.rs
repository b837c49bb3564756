//! The form of a hull.

use super::ConvexHull;
use crate::lanes::{self, Lanes, Vec3 as LaneVec3, f32x8};
use crate::math::Quat;
use crate::shape::forms::outline::{Line, Solid, Window};
use crate::shape::forms::support::{Core, Support};
use crate::shape::forms::{Entry, Form, Kind, clip};
use crate::shape::mass::Moments;
use crate::words::words;
use glam::{DVec3, Vec3};

impl<'a> Form<'a> for &'a ConvexHull {
    const KIND: Kind = Kind::Hull;
    const NAME: &'static str = "hull";
    const CODE: u32 = 5;

    fn aabb(self) -> (Vec3, Vec3) {
        (self.min, self.max)
    }

    /// From its vertices: its box, turned, would be up to twice as large.
    fn turned_bounds(self, rotation: Quat) -> (Vec3, Vec3) {
        let rows = rotation.matrix().transpose();
        let rows = [rows.x_axis, rows.y_axis, rows.z_axis].map(lanes::Vec3::<f32x8>::splat);
        let mut low = [f32x8::splat(f32::INFINITY); 3];
        let mut high = [f32x8::splat(f32::NEG_INFINITY); 3];
        for chunk in &self.vertex_chunks {
            let [x, y, z] = chunk.map(f32x8::new);
            let vertices = lanes::Vec3 { x, y, z };
            for k in 0..3 {
                let along = rows[k].dot(vertices);
                low[k] = Lanes::min(low[k], along);
                high[k] = Lanes::max(high[k], along);
            }
        }
        let lowest = |v: f32x8| v.to_array().into_iter().fold(f32::INFINITY, f32::min);
        let highest = |v: f32x8| v.to_array().into_iter().fold(f32::NEG_INFINITY, f32::max);
        (Vec3::from_array(low.map(lowest)), Vec3::from_array(high.map(highest)))
    }

    fn radius(self) -> f32 {
        self.radius
    }

    fn inner_radius(self) -> f32 {
        self.inner_radius
    }

    fn holds(self, point: Vec3) -> bool {
        self.planes.iter().all(|(n, offset)| n.dot(point) < *offset)
    }

    fn moments(self) -> Moments {
        self.moments
    }

    #[inline]
    fn support(self) -> Option<Support<'a>> {
        Some(Support { core: Core::Hull(self), radius: 0.0 })
    }

    #[inline(always)]
    fn lane_support<L: Lanes>(self, d: LaneVec3<L>) -> LaneVec3<L> {
        let mut most = L::splat(f32::MIN);
        let mut point = LaneVec3::zero();
        for v in &self.vertices {
            let v = LaneVec3::<L>::splat(*v);
            let along = v.dot(d);
            let further = along.gt(most);
            most = Lanes::select(further, along, most);
            point = LaneVec3::select(further, v, point);
        }
        point
    }

    #[inline(always)]
    fn lane_reach<L: Lanes>(self, d: LaneVec3<L>) -> L {
        let mut most = L::splat(f32::MIN);
        for v in &self.vertices {
            most = Lanes::max(LaneVec3::<L>::splat(*v).dot(d), most);
        }
        most
    }

    #[inline]
    fn enter(self, start: DVec3, path: DVec3, extra: f64) -> Option<Entry> {
        clip(start, path, self.planes.iter().map(|(n, offset)| (n.as_dvec3(), f64::from(*offset) + extra)))
    }

    fn contains(self, at: DVec3) -> bool {
        self.planes.iter().all(|(n, offset)| n.as_dvec3().dot(at) < f64::from(*offset))
    }

    fn solid(self) -> Solid {
        let fan = |face: &[u16]| -> Vec<[u32; 3]> {
            face.windows(2).skip(1).map(|w| [face[0], w[0], w[1]].map(u32::from)).collect()
        };
        (self.vertices.clone(), self.faces().flat_map(fan).collect())
    }

    fn lines(self, _window: Window, line: &mut Line<'_>) {
        for edge in &self.edges {
            let [from, to] = edge.vertices.map(|v| self.vertices[usize::from(v)]);
            line(from, to);
        }
    }

    fn address(self) -> Option<usize> {
        Some(std::ptr::from_ref(self) as usize)
    }

    fn bytes(self) -> (usize, usize) {
        ConvexHull::bytes(self)
    }

    fn words(self, out: &mut Vec<u32>) {
        out.extend(self.vertices.iter().flat_map(|&v| words::<3>(v)));
    }
}
