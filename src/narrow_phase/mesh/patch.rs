//! Contact patches of single triangles, and which of them the surface as a whole does not have.
//!
//! A single triangle has sharp edges all around. In a mesh most of them are flat or lie in a valley, and a
//! normal that comes from such an edge is a ghost that bodies trip over. Five rules remove ghosts:
//!
//! 1. A normal at a concave edge, as seen from the shape's side: the face beyond the edge is in front of it
//!    and is really touched. The patch is dropped.
//! 2. A normal at a flat edge: the patch takes the face's normal, and keeps only points over the triangle. If
//!    they are far deeper below the face than the shape is past the edge, the shape does not come from above
//!    the face, and the patch is dropped.
//! 3. A normal at a flat edge, while the shape is over neither face there: it lies in the gap between the
//!    normals of the two faces, which is next to nothing. The patch counts where no face that is level with
//!    this one holds the shape.
//! 4. A triangle wholly behind the plane of another touched face, which the shape would no longer reach once
//!    it were lifted out of that face: the sides of a step under a box that stands on it.
//! 5. A triangle that is overlapped and seen from behind, because it lies on the far slope of a hill that the
//!    shape has sunk into: it would push the shape further in. The triangle nearest to the shape's centre
//!    tells which side of the surface that is on.

use super::RawPoint;
use crate::config::tuning::{EDGE_GAP_COSINE, FLAT_EDGE_COSINE};
use crate::memory::{Allowance, buffers};
use crate::narrow_phase::convex::simplex::from_triangle;
use crate::shape::{Edges, Fold};
use glam::Vec3;

/// A triangle that may be touched, in the shape's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch {
    pub(crate) corners: [Vec3; 3],
    /// Unit normal, to the side on which the shape's centre is.
    pub(crate) front: Vec3,
    /// Whether the triangle winds clockwise, seen from there.
    pub(crate) behind: bool,
    /// The edges, as seen from there.
    pub(crate) edges: Edges,
    pub(crate) index: u32,
}

impl Touch {
    /// In the triangle's plane, away from it, at edge `i`; not of unit length.
    pub(crate) fn outward(&self, i: usize) -> Vec3 {
        let along = self.corners[(i + 1) % 3] - self.corners[i];
        if self.behind { self.front.cross(along) } else { along.cross(self.front) }
    }

    /// The edge that a normal of contact leans over most, of those that meet in the feature that is furthest
    /// against it; `None` where that is the whole face. `tolerance` [m]: corners this close are equally far.
    pub(crate) fn feature(&self, normal: Vec3, tolerance: f32) -> Option<usize> {
        let along = self.corners.map(|c| c.dot(normal));
        let least = along[0].min(along[1]).min(along[2]) + tolerance;
        let first = along.map(|x| x <= least);
        match first {
            [true, true, true] => None,
            [true, true, false] => Some(0),
            [false, true, true] => Some(1),
            [true, false, true] => Some(2),
            // One corner: the edge before and the edge after it.
            _ => {
                let corner = first.iter().position(|&x| x).unwrap_or(0);
                let (before, after) = ((corner + 2) % 3, corner);
                let lean = |i: usize| {
                    let out = self.outward(i);
                    -normal.dot(out) / out.length()
                };
                Some(if lean(after) > lean(before) { after } else { before })
            }
        }
    }

    /// Height of a point over the plane [m].
    fn height(&self, point: Vec3) -> f32 {
        self.front.dot(point - self.corners[0])
    }

    /// Whether a point is not over the triangle but beyond an edge where the surface goes on, level or
    /// towards the point's side: there it may come to lie between the two.
    fn goes_on_below(&self, point: Vec3) -> bool {
        (0..3).any(|i| {
            matches!(self.edges.fold(i), Fold::Flat | Fold::Valley)
                && self.outward(i).dot(point - self.corners[i]) > 0.0
        })
    }

    /// The verdict on a patch with this normal: see the module.
    ///
    /// `apart` and `face_apart`: separation of all of the shape along this normal and the face's [m]. `size`:
    /// of the shape [m].
    pub(crate) fn judge(&self, normal: Vec3, apart: f32, face_apart: f32, size: f32) -> Verdict {
        if -normal.dot(self.front) > FLAT_EDGE_COSINE {
            return Verdict::Face(f32::MIN);
        }
        let Some(edge) = self.feature(normal, 1e-3 * size) else { return Verdict::Face(f32::MIN) };
        match self.edges.fold(edge) {
            Fold::Ridge | Fold::Open => Verdict::Keep,
            Fold::Valley => Verdict::Drop,
            Fold::Flat => {
                // Four times as deep: a corner may poke through a small triangle.
                let least = 4.0 * apart.min(0.0) - 0.02 * size;
                let leans = -normal.dot(self.front) < EDGE_GAP_COSINE;
                if leans && face_apart < least { Verdict::Drop } else { Verdict::Face(least) }
            }
        }
    }
}

/// See [`Touch::judge`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Verdict {
    Keep,
    /// The patch takes the face's normal, unless a point is deeper than this then.
    Face(f32),
    Drop,
}

/// The points of one triangle.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Patch {
    /// Unit, from the shape to the triangle.
    pub(crate) normal: Vec3,
    /// Its points are `first..first + count` of all.
    pub(crate) first: u32,
    pub(crate) count: u32,
    /// Least separation of its points [m].
    pub(crate) least: f32,
    /// Whether it is one by the third rule.
    pub(crate) gap: bool,
    /// For a face: how far the shape reaches beyond its plane, negative [m].
    pub(crate) reach: Option<f32>,
    /// Index of its triangle.
    pub(crate) touch: u32,
}

/// A face that may hide others.
#[derive(Clone, Copy, Default)]
struct Plane {
    front: Vec3,
    offset: f32,
    low: f32,
    patch: usize,
    touch: u32,
}

/// Patches of a pair. Triangles that were touched, patches and points each in one column.
#[derive(Debug, Default)]
pub(crate) struct Patches {
    pub(crate) touches: Vec<Touch>,
    pub(crate) patches: Vec<Patch>,
    pub(crate) points: Vec<RawPoint>,
    /// The triangle whose plane is overlapped least, among those that are overlapped and yielded no patch,
    /// and by how much [m].
    spare: Option<(Touch, f32)>,
}

buffers! { Patches { bytes { touches, patches, points } } }

impl Patches {
    /// Reserves capacity for the contacts of so many further triangles; returns whether there was memory.
    pub(crate) fn has_place(&mut self, triangles: usize, points: usize, allowance: &mut Allowance) -> bool {
        let (patches, points) = (self.patches.len() + triangles, self.points.len() + triangles * points);
        allowance.fit(&mut self.touches, patches) >= patches
            && allowance.fit(&mut self.patches, patches) >= patches
            && allowance.fit(&mut self.points, points) >= points
    }
    pub(crate) fn clear(&mut self) {
        self.touches.clear();
        self.patches.clear();
        self.points.clear();
        self.spare = None;
    }

    /// Notes a triangle that is overlapped although its patch was dropped.
    pub(crate) fn pass_over(&mut self, touch: Touch, face_apart: f32) {
        if self.spare.is_none_or(|(_, other)| face_apart > other) {
            self.spare = Some((touch, face_apart));
        }
    }

    /// The noted triangle if no patch pushes the shape out. A rod that is stuck halfway close to a flat edge
    /// is shallowest past that edge as either triangle sees it: both patches are dropped, and a face has to
    /// push it out instead.
    pub(crate) fn spare(&self) -> Option<Touch> {
        self.spare.filter(|_| self.patches.is_empty()).map(|(touch, _)| touch)
    }

    /// The noted triangle, and how far the shape reaches beyond its plane, negative [m].
    pub(crate) fn passed_over(&self) -> Option<(Touch, f32)> {
        self.spare
    }

    /// Drops the points from `first` on if one of them is deeper than `least`.
    pub(crate) fn limit(&mut self, first: usize, least: f32) {
        if self.points[first..].iter().any(|p| p.separation < least) {
            self.points.truncate(first);
        }
    }

    /// Makes a patch of the points from `first` on, if there are any.
    pub(crate) fn add(&mut self, touch: Touch, normal: Vec3, reach: Option<f32>, first: usize) {
        let points = &self.points[first..];
        if points.is_empty() {
            return;
        }
        let least = points.iter().map(|p| p.separation).fold(f32::MAX, f32::min);
        self.patches.push(Patch {
            normal,
            first: first as u32,
            count: points.len() as u32,
            least,
            gap: false,
            reach,
            touch: self.touches.len() as u32,
        });
        self.touches.push(touch);
    }

    /// [`Patches::add`] for a patch to which the third rule applies.
    pub(crate) fn add_in_gap(&mut self, touch: Touch, normal: Vec3, reach: f32, first: usize) {
        let before = self.patches.len();
        self.add(touch, normal, Some(reach), first);
        self.patches[before..].iter_mut().for_each(|p| p.gap = true);
    }

    /// Whether the third rule drops a patch.
    fn is_no_gap(&self, patch: &Patch, size: f32) -> bool {
        let front = self.touches[patch.touch as usize].front;
        let holds = |other: &Patch| {
            !other.gap
                && other.reach.is_some()
                && other.least <= patch.least + 1e-3 * size
                && self.touches[other.touch as usize].front.dot(front) >= FLAT_EDGE_COSINE
        };
        patch.gap && self.patches.iter().any(holds)
    }

    /// The fifth rule, for a shape with this centre.
    pub(crate) fn drop_backs(&mut self, centre: Vec3) {
        let deep = self.patches.iter().filter(|p| p.least < 0.0);
        let sides = deep.fold(0, |sides, p| sides | 1 << u32::from(self.touches[p.touch as usize].behind));
        if sides != 0b11 {
            return;
        }
        // At a ridge two triangles are equally near, and the centre may be behind one of them, by less than
        // it is in front of the other.
        let mut own: Option<(&Touch, [f32; 2])> = None;
        for touch in &self.touches {
            let (gap, height) = (from_triangle(centre, touch.corners).length() as f32, touch.height(centre));
            let nearer = |[other, above]: [f32; 2]| {
                gap < other * (1.0 - 1e-4) || (gap <= other * (1.0 + 1e-4) && height > above)
            };
            if own.is_none_or(|(_, other)| nearer(other)) {
                own = Some((touch, [gap, height]));
            }
        }
        let Some((&own, _)) = own else { return };
        let Patches { patches, touches, .. } = self;
        patches.retain(|p| {
            let touch = &touches[p.touch as usize];
            p.least >= 0.0
                || touch.behind == own.behind
                || touch.front.dot(own.front) >= 0.0
                || !touch.goes_on_below(centre)
        });
    }

    /// Applies the third and the fourth rule. Also sorts the patches, the deepest first.
    pub(crate) fn drop_hidden(&mut self, size: f32) {
        if self.patches.iter().any(|p| p.gap) {
            let mut keep = 0;
            for i in 0..self.patches.len() {
                let patch = self.patches[i];
                if !self.is_no_gap(&patch, size) {
                    self.patches[keep] = patch;
                    keep += 1;
                }
            }
            self.patches.truncate(keep);
        }
        self.patches.sort_unstable_by(|a, b| a.least.total_cmp(&b.least).then(a.touch.cmp(&b.touch)));
        if self.patches.len() < 2 {
            return;
        }
        // A body that lies in a thousand triangles must not cost a million tests.
        const FACES: usize = 32;
        let mut planes = [Plane::default(); FACES];
        let mut count = 0;
        for (i, p) in self.patches.iter().enumerate() {
            let Some(reach) = p.reach.filter(|_| p.least < 1e-3 * size && count < FACES) else { continue };
            let front = self.touches[p.touch as usize].front;
            let offset = front.dot(self.touches[p.touch as usize].corners[0]);
            // The lowest point that the shape still reaches once it is lifted out of this face.
            let low = (reach - p.least.min(0.0)).min(0.0) + 1e-4 * size;
            planes[count] = Plane { front, offset, low, patch: i, touch: p.touch };
            count += 1;
        }
        let planes = &planes[..count];
        let Patches { patches, touches, .. } = self;
        let hides = |plane: &Plane, normal: Vec3, touch: u32| {
            let corners = &touches[touch as usize].corners;
            -normal.dot(plane.front) < FLAT_EDGE_COSINE
                && corners.iter().all(|c| plane.front.dot(*c) - plane.offset <= plane.low)
        };
        let mut at = 0..;
        patches.retain(|p| {
            let i = at.next().unwrap_or(0);
            !planes.iter().any(|plane| {
                // Two faces on either side of a ridge hide each other: then the deeper one stays.
                let back = |own: &&Plane| own.patch == i && i < plane.patch;
                hides(plane, p.normal, p.touch)
                    && !planes.iter().find(back).is_some_and(|own| hides(own, -plane.front, plane.touch))
            })
        });
    }
}
