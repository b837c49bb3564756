//! Supporting points of a shape along eight directions at a time.

use crate::lanes::{Lanes, Vec3 as LaneVec3};
use crate::shape::{Collider, Geometry};

/// The points of a shape that are furthest along eight unit directions, in its frame.
#[inline(always)]
pub(crate) fn support<L: Lanes>(shape: &Collider, d: LaneVec3<L>) -> LaneVec3<L> {
    let [x, y, z, _] = shape.size;
    let (x, y, z) = (L::splat(x), L::splat(y), L::splat(z));
    let zero = L::zero();
    match &shape.geometry {
        Geometry::Sphere { .. } => d * x,
        Geometry::Capsule { .. } => {
            let top = (x * d.y + z).gt(y - x * d.y);
            let ball = d * Lanes::select(top, z, y);
            LaneVec3::new(ball.x, ball.y + Lanes::select(top, x, -x), ball.z)
        }
        Geometry::Cylinder { .. } => {
            let across = (d.x * d.x + d.z * d.z).sqrt();
            let top = (x * d.y + z * across).gt(y * across - x * d.y);
            let apart = across.gt(zero);
            let r = Lanes::select(top, z, y) / Lanes::select(apart, across, L::one());
            LaneVec3::new(d.x * r, Lanes::select(top, x, -x), d.z * r)
        }
        Geometry::Box { .. } => LaneVec3::new(x * d.x.sign(), y * d.y.sign(), z * d.z.sign()),
        Geometry::Hull(hull) => {
            let mut most = L::splat(f32::MIN);
            let mut point = LaneVec3::zero();
            for v in &hull.vertices {
                let v = LaneVec3::<L>::splat(*v);
                let along = v.dot(d);
                let further = along.gt(most);
                most = Lanes::select(further, along, most);
                point = LaneVec3::select(further, v, point);
            }
            point
        }
        _ => d * L::splat(f32::MAX),
    }
}

/// How far a shape reaches from its origin along eight unit directions [m].
#[inline(always)]
pub(crate) fn reach<L: Lanes>(shape: &Collider, d: LaneVec3<L>) -> L {
    match &shape.geometry {
        Geometry::Hull(hull) => {
            let mut most = L::splat(f32::MIN);
            for v in &hull.vertices {
                most = Lanes::max(LaneVec3::<L>::splat(*v).dot(d), most);
            }
            most
        }
        _ => support(shape, d).dot(d),
    }
}
