//! The contact with one triangle by itself, and the patch that the surface as a whole has there.

use super::patch::{Patches, Touch, Verdict};
use super::reach::Bounds;
use crate::config::tuning::EDGE_GAP_COSINE;
use crate::narrow_phase::RawPoint;
use crate::narrow_phase::convex::clip::Loop;
use crate::narrow_phase::convex::polytope::Pose;
use glam::Vec3;

/// Keys below this name a corner of a box, whichever triangle it is over.
pub(crate) const CORNERS: u32 = 8;

/// A key out of a triangle and one of 256 features; never one of the first eight.
pub(crate) fn key(triangle: u32, feature: u32) -> u32 {
    (triangle << 8 | feature & 0xff).wrapping_mul(0x9E37_79B1) | CORNERS
}

/// The points, with keys that also identify the triangle.
pub(crate) fn named<'a>(touch: &Touch, points: &'a [RawPoint]) -> impl Iterator<Item = RawPoint> + use<'a> {
    let index = touch.index;
    let fold = |k: u32| k ^ k >> 8 ^ k >> 15 ^ k >> 23;
    points.iter().map(move |p| RawPoint { key: key(index, fold(p.key)), ..*p })
}

/// The verdict on a contact whose normal lies in the gap between the normals of two faces of a hardly convex
/// edge, while no point of the shape is over the triangle.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Gap {
    /// No patch.
    None,
    /// Its own points, along its own normal: a point of a shape that may roll which is not its lowest there
    /// moves as the shape rolls.
    Round,
    /// Its points, as far as they are on the shape, along the normal of the face.
    Flat,
}

/// The contact of a shape with one triangle that is nearer than the margin.
pub(crate) struct TriangleContact {
    /// Unit, from the shape to the triangle.
    pub(crate) normal: Vec3,
    /// Separation of the whole shape along it, and along the triangle's normal [m].
    pub(crate) apart: f32,
    pub(crate) face: f32,
    pub(crate) margin: f32,
    pub(crate) verdict: Verdict,
    pub(crate) gap: Gap,
}

impl TriangleContact {
    /// Adds the patch that the surface has there, if it has one.
    ///
    /// `own` adds the points of the shape and the triangle, `over` those of the shape that are over the
    /// triangle along the triangle's normal. `bounds`: the box around the shape.
    pub(crate) fn add(
        &self,
        touch: &Touch,
        Bounds { middle, half }: Bounds,
        own: impl Fn(&mut Vec<RawPoint>),
        over: impl Fn(&mut Vec<RawPoint>),
        patches: &mut Patches,
    ) {
        let TriangleContact { normal, apart, face, margin, verdict, gap } = *self;
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
                let in_gap = patches.points.len() == first && -normal.dot(front) > EDGE_GAP_COSINE;
                if in_gap && gap == Gap::Round {
                    own(&mut patches.points);
                    patches.add_in_gap(*touch, normal, face, first);
                } else if in_gap && gap == Gap::Flat {
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
                    patches.add_in_gap(*touch, -front, face, first);
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
pub(crate) fn outline(touch: &Touch) -> Loop {
    let order: [u16; 3] = if touch.behind { [0, 2, 1] } else { [0, 1, 2] };
    Loop::new(&touch.corners, &order, &Pose::IDENTITY)
}
