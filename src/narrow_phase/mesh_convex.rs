//! A cylinder against triangles, one triangle at a time, once boxes around them are found to be near; and what of a
//! contact with one triangle the surface as a whole has.

use super::clip::{Cloud, Loop};
use super::convex::collide_triangle;
use super::cylinder::over_triangle;
use super::mesh::{Ground, Triangles};
use super::mesh_box::key;
use super::mesh_patch::{GAP, Patches, Touch, Verdict};
use super::polytope::Pose;
use super::round_polytope::Core;
use super::{RawPoint, mesh_capsule, mesh_hull};
use crate::lanes::{Lanes, Mask, f32x8};
use crate::shape::{Collider, Geometry, Kind};
use glam::Vec3;

/// Points with keys that tell the triangle too.
pub(super) fn named<'a>(touch: &Touch, points: &'a [RawPoint]) -> impl Iterator<Item = RawPoint> + use<'a> {
    let index = touch.index;
    let fold = |k: u32| k ^ k >> 8 ^ k >> 15 ^ k >> 23;
    points.iter().map(move |p| RawPoint { key: key(index, fold(p.key)), ..*p })
}

/// Adds a patch for every triangle that is nearer than its margin. `around`: middle and half extents of the box around
/// the shape, and the shape's centre.
pub(super) fn touch(
    a: &Collider,
    around: (Vec3, Vec3, Vec3),
    triangles: &Triangles,
    margins: f32x8,
    ground: &Ground,
    patches: &mut Patches,
) {
    let (middle, half, _) = around;
    if a.kind == Kind::Capsule {
        let Some(core) = Core::of(a) else { return };
        mesh_capsule::touch((&core, half, a.radius), triangles, margins, ground, patches);
        return;
    }
    if let Geometry::Hull(hull) = &a.geometry {
        mesh_hull::touch((hull, a.radius), around, triangles, margins, ground, patches);
        return;
    }
    let (_, axis, _) = triangles.separate(middle, half);
    let mut bits = axis.le(margins).bits() & triangles.valid;
    while bits != 0 {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits - 1;
        // Deepest below the face, of all of the shape.
        let (front, height) = (triangles.front.lane(lane), triangles.height.lane(lane));
        let margin = margins.lane(lane);
        let face = height - extent(a, -front);
        if face > margin {
            continue;
        }
        let touch = triangles.touch(lane, ground);
        let manifold = collide_triangle(a, touch.corners, margin);
        if manifold.count == 0 {
            continue;
        }
        let apart = manifold.points().iter().map(|p| p.separation).fold(f32::MAX, f32::min);
        // Seen from the frame's origin, which of a hull may be on the other side than its centre.
        let verdict = if manifold.normal.dot(front) > 1e-3 && apart < 0.0 {
            Verdict::Face(f32::MIN)
        } else {
            touch.judge(manifold.normal, apart, face, a.radius)
        };
        let found = Found { normal: manifold.normal, apart, face, margin, verdict };
        let own = |points: &mut Vec<RawPoint>| points.extend(named(&touch, manifold.points()));
        let over = |points: &mut Vec<RawPoint>| {
            let mut cloud = Cloud::new();
            over_triangle(a, &outline(&touch), front, margin, &mut cloud);
            points.extend(named(&touch, cloud.points()));
        };
        found.add(&touch, (middle, half), own, over, patches);
    }
}

/// What was found of one triangle that is nearer than the margin.
pub(super) struct Found {
    /// Unit, from the shape to the triangle.
    pub(super) normal: Vec3,
    /// Separation along it, and along the triangle's normal, of all of the shape [m].
    pub(super) apart: f32,
    pub(super) face: f32,
    pub(super) margin: f32,
    pub(super) verdict: Verdict,
}

impl Found {
    /// Adds the patch that the surface has there, if it has one.
    ///
    /// `own` adds the points of the shape and the triangle, `over` those of the shape that are over the triangle along
    /// the triangle's normal. `around`: middle and half extents of the box around the shape.
    pub(super) fn add(
        &self,
        touch: &Touch,
        (middle, half): (Vec3, Vec3),
        own: impl Fn(&mut Vec<RawPoint>),
        over: impl Fn(&mut Vec<RawPoint>),
        patches: &mut Patches,
    ) {
        let Found { normal, apart, face, margin, verdict } = *self;
        let front = touch.front;
        let first = patches.points.len();
        match verdict {
            Verdict::Drop => {}
            Verdict::Keep => {
                own(&mut patches.points);
                patches.add(*touch, normal, None, first);
            }
            Verdict::Face(least) => {
                over(&mut patches.points);
                patches.limit(first, least);
                // In the gap between the faces of a hardly convex edge, over neither of them.
                if patches.points.len() == first && -normal.dot(front) > GAP {
                    own(&mut patches.points);
                    let offset = front.dot(touch.corners[0]);
                    let bound = half + Vec3::splat(1e-3 * half.max_element());
                    let mut kept = first;
                    for i in first..patches.points.len() {
                        let p = patches.points[i];
                        let on_a = p.position - normal * (0.5 * p.separation);
                        let separation = front.dot(on_a) - offset;
                        let position = on_a - front * (0.5 * separation);
                        if (on_a - middle).abs().cmple(bound).all() && separation <= margin {
                            patches.points[kept] = RawPoint { position, separation, ..p };
                            kept += 1;
                        }
                    }
                    patches.points.truncate(kept);
                    patches.add_in_gap(*touch, face, first, -normal);
                } else {
                    patches.add(*touch, -front, Some(face), first);
                }
            }
        }
        if apart < 0.0 && patches.points.len() == first {
            patches.pass_over(*touch, face);
        }
    }
}

/// The corners of a triangle, counter-clockwise seen from its front.
pub(super) fn outline(touch: &Touch) -> Loop {
    let order: [u16; 3] = if touch.behind { [0, 2, 1] } else { [0, 1, 2] };
    Loop::new(&touch.corners, &order, &Pose::IDENTITY)
}

/// How far a cylinder reaches along a direction from its centre [m].
fn extent(a: &Collider, d: Vec3) -> f32 {
    let Geometry::Cylinder { half_height: h, radius_bottom, radius_top } = a.geometry else {
        return f32::MAX;
    };
    let flat = (d.x * d.x + d.z * d.z).sqrt();
    (h * d.y + radius_top * flat).max(-h * d.y + radius_bottom * flat)
}
