//! The point of a shape that is nearest to a point, in the shape's frame; exact, in `f64`.

use crate::narrow_phase::{Accuracy, Simplex, Support, SupportPose, core_gap, off_triangle};
use crate::shape::{Collider, Geometry, Ground, NearPoint};
use glam::{DMat3, DVec3};

/// The nearest point of a shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    pub(super) point: DVec3,
    /// Unit, from there to where it was asked from; zero inside.
    pub(super) normal: DVec3,
    /// Zero inside [m].
    pub(super) distance: f64,
    pub(super) triangle: Option<u32>,
    pub(super) inside: bool,
}

impl From<NearPoint> for Nearest {
    fn from(NearPoint { point, normal, distance }: NearPoint) -> Nearest {
        Nearest { point, normal, distance, triangle: None, inside: false }
    }
}

/// The nearest point of a shape, if it is within `most` [m].
pub(super) fn nearest(shape: &Collider, at: DVec3, most: f64) -> Option<Nearest> {
    let geometry = &shape.geometry;
    if geometry.contains(at) {
        return Some(Nearest { point: at, normal: DVec3::ZERO, distance: 0.0, triangle: None, inside: true });
    }
    if let Some(ground) = geometry.ground() {
        return triangles(ground, at, most);
    }
    let found = geometry.nearest(at).or_else(|| hull(geometry, at))?;
    (found.distance <= most).then_some(found.into())
}

fn hull(geometry: &Geometry, at: DVec3) -> Option<NearPoint> {
    let Geometry::Hull(hull) = geometry else { return None };
    let shape = geometry.support()?;
    // The hull in the frame of the point.
    let pose = SupportPose { rotation: DMat3::IDENTITY, position: -at };
    let gap = core_gap(
        &Support::point(),
        &shape,
        &pose,
        -at,
        &mut Simplex::empty(),
        Accuracy { absolute: 0.0, relative: 1e-9 },
    );
    // A point on the surface has the normal of the face that it is on.
    let on = || {
        let above = |(n, offset): &&(glam::Vec3, f32)| n.as_dvec3().dot(at) - f64::from(*offset);
        let face = hull.planes.iter().max_by(|p, q| above(p).total_cmp(&above(q)));
        face.map_or(DVec3::Y, |(n, _)| n.as_dvec3())
    };
    Some(if gap.overlap || gap.upper == 0.0 {
        NearPoint::outside(at, at, on())
    } else {
        NearPoint::outside(at, at + gap.point_b, on())
    })
}

fn triangles(ground: Ground<'_>, at: DVec3, most: f64) -> Option<Nearest> {
    let mut best: Option<(f64, u32, DVec3, DVec3)> = None;
    // A little more than the limit, which `f32` may round.
    let limit = |squared: f64| (squared * (1.0 + 1e-6)) as f32;
    let mut look = |index: u32, corners: [glam::Vec3; 3], limit_now: f32| {
        let off = off_triangle(at, corners);
        let squared = off.length_squared();
        if squared <= most * most
            && best.is_none_or(|(least, other, ..)| squared < least || (squared == least && index < other))
        {
            let [a, b, c] = corners.map(glam::Vec3::as_dvec3);
            best = Some((squared, index, off, (b - a).cross(c - a)));
        }
        best.map_or(limit_now, |b| limit(b.0))
    };
    ground.visit_near(at, limit(most * most), &mut look);
    let (squared, index, off, across) = best?;
    let distance = squared.sqrt();
    let normal = if distance > 0.0 { off / distance } else { across.normalize_or(DVec3::Y) };
    Some(Nearest { point: at - off, normal, distance, triangle: Some(index), inside: false })
}
