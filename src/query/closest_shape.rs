//! The point of a shape that is nearest to a point, in the shape's frame; exact, in `f64`.

use crate::narrow_phase::{Accuracy, Simplex, Support, SupportPose, core_gap, off_triangle};
use crate::shape::{Collider, Geometry, Kind};
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

impl Nearest {
    fn within(at: DVec3) -> Nearest {
        Nearest { point: at, normal: DVec3::ZERO, distance: 0.0, triangle: None, inside: true }
    }

    /// A point of the surface; `facing` is its normal, for a point that lies on it.
    fn outside(at: DVec3, point: DVec3, facing: DVec3) -> Nearest {
        let off = at - point;
        let distance = off.length();
        let normal = if distance > 0.0 { off / distance } else { facing };
        Nearest { point, normal, distance, triangle: None, inside: false }
    }
}

/// Whether a point is inside a solid shape; not on its surface.
pub(super) fn holds(shape: &Collider, at: DVec3) -> bool {
    let [x, y, z, _] = shape.size.map(f64::from);
    match shape.kind {
        Kind::Sphere => at.length_squared() < x * x,
        Kind::Box => at.abs().cmplt(DVec3::new(x, y, z)).all(),
        Kind::Plane => at.y < 0.0,
        Kind::Capsule => Capsule::new(x, y, z).above(at).0 < 0.0,
        Kind::Cylinder => at.y.abs() < x && across(at) < 0.5 * (y + z) - 0.5 * (y - z) * at.y / x,
        Kind::Hull => match &shape.geometry {
            Geometry::Hull(hull) => {
                hull.planes.iter().all(|(n, offset)| n.as_dvec3().dot(at) < f64::from(*offset))
            }
            _ => false,
        },
        Kind::Mesh | Kind::HeightField => false,
    }
}

/// The nearest point of a shape, if it is within `most` [m].
pub(super) fn nearest(shape: &Collider, at: DVec3, most: f64) -> Option<Nearest> {
    if holds(shape, at) {
        return Some(Nearest::within(at));
    }
    let [x, y, z, _] = shape.size.map(f64::from);
    let found = match shape.kind {
        Kind::Sphere => {
            let normal = at.normalize_or(DVec3::Y);
            Nearest::outside(at, normal * x, normal)
        }
        Kind::Capsule => {
            let (above, normal) = Capsule::new(x, y, z).above(at);
            Nearest { point: at - normal * above, normal, distance: above, triangle: None, inside: false }
        }
        Kind::Box => {
            let half = DVec3::new(x, y, z);
            let point = at.clamp(-half, half);
            let on = (at.abs() - half).to_array();
            let axis = if on[0] >= on[1] && on[0] >= on[2] { 0 } else { 1 + usize::from(on[2] > on[1]) };
            let mut facing = DVec3::ZERO;
            facing[axis] = 1f64.copysign(at[axis]);
            Nearest::outside(at, point, facing)
        }
        Kind::Cylinder => frustum(at, x, y, z),
        Kind::Plane => Nearest::outside(at, DVec3::new(at.x, 0.0, at.z), DVec3::Y),
        Kind::Hull => hull(shape, at)?,
        Kind::Mesh | Kind::HeightField => return triangles(&shape.geometry, at, most),
    };
    (found.distance <= most).then_some(found)
}

fn across(at: DVec3) -> f64 {
    (at.x * at.x + at.z * at.z).sqrt()
}

/// Away from the y axis.
fn outwards(at: DVec3) -> DVec3 {
    DVec3::new(at.x, 0.0, at.z).normalize_or(DVec3::X)
}

/// The hull of two balls on the y axis.
struct Capsule {
    half: f64,
    bottom: f64,
    top: f64,
    /// Sine and cosine of the angle by which the side leans: its normals point up by it.
    lean: f64,
    flat: f64,
}

impl Capsule {
    fn new(half: f64, bottom: f64, top: f64) -> Capsule {
        let lean = if half > 0.0 { (bottom - top) / (2.0 * half) } else { 2f64.copysign(bottom - top) };
        Capsule { half, bottom, top, lean, flat: (1.0 - lean * lean).max(0.0).sqrt() }
    }

    /// Signed distance from the surface, and its direction.
    fn above(&self, at: DVec3) -> (f64, DVec3) {
        let out = across(at);
        let along = at.y * self.flat - out * self.lean;
        let end = self.half * self.flat;
        // One ball holds the other; or beyond an end.
        if self.lean.abs() >= 1.0 || along.abs() >= end {
            let low = if self.lean.abs() >= 1.0 { self.lean > 0.0 } else { along < 0.0 };
            let (y, radius) = if low { (-self.half, self.bottom) } else { (self.half, self.top) };
            let off = at - DVec3::Y * y;
            return (off.length() - radius, off.normalize_or(DVec3::Y));
        }
        let mean = 0.5 * (self.bottom + self.top);
        let normal = outwards(at) * self.flat + DVec3::Y * self.lean;
        (out * self.flat + at.y * self.lean - mean, normal)
    }
}

/// From outside, in the half plane through the axis: the nearest of two caps and a side.
fn frustum(at: DVec3, half: f64, bottom: f64, top: f64) -> Nearest {
    let (out, away) = (across(at), outwards(at));
    let side = (top - bottom, 2.0 * half);
    let whole = side.0 * side.0 + side.1 * side.1;
    let t = (((out - bottom) * side.0 + (at.y + half) * side.1) / whole).clamp(0.0, 1.0);
    let facing = (away * side.1 - DVec3::Y * side.0) / whole.sqrt();
    let of = |out: f64, y: f64, facing: DVec3| Nearest::outside(at, away * out + DVec3::Y * y, facing);
    let mut best = of(bottom + side.0 * t, -half + side.1 * t, facing);
    for cap in [of(out.min(top), half, DVec3::Y), of(out.min(bottom), -half, -DVec3::Y)] {
        if cap.distance < best.distance {
            best = cap;
        }
    }
    best
}

fn hull(shape: &Collider, at: DVec3) -> Option<Nearest> {
    let Geometry::Hull(hull) = &shape.geometry else { return None };
    let shape = Support::of(shape)?;
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
        Nearest::outside(at, at, on())
    } else {
        Nearest::outside(at, at + gap.point_b, on())
    })
}

fn triangles(geometry: &Geometry, at: DVec3, most: f64) -> Option<Nearest> {
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
    match geometry {
        Geometry::Mesh(mesh) => mesh.visit_near(at, limit(most * most), &mut look),
        Geometry::HeightField(field) => field.visit_near(at, limit(most * most), &mut look),
        _ => {}
    }
    let (squared, index, off, across) = best?;
    let distance = squared.sqrt();
    let normal = if distance > 0.0 { off / distance } else { across.normalize_or(DVec3::Y) };
    Some(Nearest { point: at - off, normal, distance, triangle: Some(index), inside: false })
}
