//! The contact with one triangle by itself, and the patch that the surface as a whole has there.

use super::boxes::key;
use super::patch::{Patches, Touch, Verdict};
use super::reach::Bounds;
use crate::config::tuning::EDGE_GAP_COSINE;
use crate::narrow_phase::RawPoint;
use crate::narrow_phase::convex::clip::Loop;
use crate::narrow_phase::convex::polytope::Pose;
use glam::Vec3;

/// The points, with keys that also identify the triangle.
pub(crate) fn named<'a>(touch: &Touch, points: &'a [RawPoint]) -> impl Iterator<Item = RawPoint> + use<'a> {
    let index = touch.index;
    let fold = |k: u32| k ^ k >> 8 ^ k >> 15 ^ k >> 23;
    points.iter().map(move |p| RawPoint { key: key(index, fold(p.key)), ..*p })
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
    /// Whether the shape is one that may roll.
    pub(crate) round: bool,
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
        let TriangleContact { normal, apart, face, margin, verdict, round } = *self;
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
                if patches.points.len() == first && -normal.dot(front) > EDGE_GAP_COSINE && round {
                    // A point of the shape that is not its lowest there moves as the shape rolls.
                    own(&mut patches.points);
                    patches.add_in_gap(*touch, normal, face, first);
                } else if patches.points.len() == first && -normal.dot(front) > EDGE_GAP_COSINE {
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
