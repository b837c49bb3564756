//! Two polytopes: by a face of one, by two edges, or by the nearest features where they are apart.

use super::clip::{Cloud, EDGES, Loop, Segment, clip_edges, clip_face, key};
use super::manifold_of;
use super::polytope::{Polytope, Pose};
use super::sat::{
    EdgeAxis, EdgeSet, FaceAxis, Nearest, Slab, edge_axis, edges_in_reach, face_axis, nearest_edges,
};
use crate::config::tuning::{FACE_PREFERENCE, FLAT_FACE_COSINE};
use crate::narrow_phase::contacts::manifold::{RawManifold, RawPoint};
use glam::Vec3;
use std::ops::ControlFlow::{self, Break, Continue};

/// Two polytopes, `b` at `pose` in the frame of `a`. `size`: a length of the smaller one [m].
pub(super) fn polytopes(a: &Polytope, b: &Polytope, pose: &Pose, margin: f32, size: f32) -> RawManifold {
    let none = RawManifold::default();
    let pair = match FacePair::of(a, b, pose, margin, size) {
        Ok(pair) => pair,
        Err(gap) => return RawManifold::apart(gap),
    };
    let mut cloud = Cloud::new();
    let mut done = None;
    if pair.face.separation > 0.0 {
        let manifold = pair.by_face(&mut cloud);
        if cloud.least() <= pair.face.separation + pair.tolerance {
            return manifold;
        }
        done = Some(manifold);
    }
    // A wide face that leans by a hair shows less than the small one that is over it.
    if pair.other.separation > 0.0 {
        let other = pair.by_other();
        let manifold = other.by_face(&mut Cloud::new());
        if manifold.least() <= other.face.separation + pair.tolerance {
            return manifold;
        }
    }

    let mut near = pair.edges_in_reach(margin.max(-pair.face.separation));
    let mut touching = None;
    if pair.face.separation <= 0.0 {
        touching = match pair.overlap(&mut near, &mut cloud) {
            Break(manifold) => return manifold,
            Continue(touching) => touching,
        };
    }

    // Apart, and no vertex of one over the face of the other: edges or vertices of both are nearest.
    let Some(nearest) = nearest_edges(a, b, pose, &near) else { return done.unwrap_or(none) };
    if touching.is_some_and(|e| nearest.distance > FURTHEST * e.separation + pair.tolerance) {
        // Apart by rounding alone.
        return pair.by_face(&mut cloud);
    }
    if nearest.distance > margin {
        // Edges out of reach were not looked at.
        return RawManifold::apart(pair.face.separation.max(pair.other.separation).max(margin));
    }
    if nearest.distance <= pair.face.separation + pair.tolerance {
        let manifold = done.unwrap_or_else(|| pair.by_face(&mut cloud));
        return with_nearest_point(manifold, &nearest, pair.tolerance, &mut cloud);
    }
    pair.by_nearest_edges(&nearest, touching)
}

/// Two polytopes that overlap, or are nearer than the margin, by their faces, and the face that shows the
/// largest separation.
struct FacePair<'a> {
    a: &'a Polytope<'a>,
    b: &'a Polytope<'a>,
    /// Pose of b in the frame of a.
    pose: &'a Pose,
    /// Pose of a in the frame of b.
    back: Pose,
    margin: f32,
    size: f32,
    /// By how much one separation has to be larger than another to count as that [m].
    tolerance: f32,
    face: FaceAxis,
    /// Whose face it is.
    on_b: bool,
    /// The best face of the other one.
    other: FaceAxis,
}

// Rounding: of separations.
/// How many times their largest separation along an axis two polytopes may be apart, where neither is much of
/// a needle.
const FURTHEST: f32 = 10.0;

/// The separation above which another axis counts as clearly better than one with this separation [m].
#[inline(always)]
fn clearly(separation: f32, tolerance: f32) -> f32 {
    if separation < 0.0 { FACE_PREFERENCE.0 * separation + tolerance } else { separation + tolerance }
}

impl<'a> FacePair<'a> {
    /// If they are further apart than the margin: by how much at least.
    #[inline(always)]
    fn of(
        a: &'a Polytope<'a>,
        b: &'a Polytope<'a>,
        pose: &'a Pose,
        margin: f32,
        size: f32,
    ) -> Result<FacePair<'a>, f32> {
        let back = pose.inverse();
        let tolerance = FACE_PREFERENCE.1 * size;
        let face_a = face_axis(a, b, pose, margin);
        if face_a.separation > margin {
            return Err(face_a.separation);
        }
        let face_b = face_axis(b, a, &back, margin);
        if face_b.separation > margin {
            return Err(face_b.separation);
        }
        let on_b = face_b.separation > clearly(face_a.separation, tolerance);
        let (face, other) = if on_b { (face_b, face_a) } else { (face_a, face_b) };
        Ok(FacePair { a, b, pose, back, margin, size, tolerance, face, on_b, other })
    }

    /// The same by the best face of the other one.
    fn by_other(&self) -> FacePair<'a> {
        FacePair { face: self.other, on_b: !self.on_b, other: self.face, ..*self }
    }

    /// The manifold of the face, whose points are added to a cloud.
    fn by_face(&self, cloud: &mut Cloud) -> RawManifold {
        let normal = self.face_contact(cloud);
        manifold_of(cloud, normal)
    }

    #[inline(always)]
    fn slab(&self) -> Slab {
        let FaceAxis { face, separation } = self.face;
        if self.on_b {
            let n = -self.pose.direction(self.b.planes[face].0);
            let low = n.dot(self.pose.position) - self.b.planes[face].1;
            Slab { normal: n, high: low - separation, low }
        } else {
            let (n, offset) = self.a.planes[face];
            Slab { normal: n, high: offset, low: offset + separation }
        }
    }

    /// Edges of both that may be nearer to each other than `reach` [m].
    #[inline(always)]
    fn edges_in_reach(&self, reach: f32) -> (EdgeSet, EdgeSet) {
        edges_in_reach(self.a, self.b, self.pose, &self.back, reach, &self.slab())
    }

    /// The manifold of the face instead of that of two edges, if the face is nearly across their axis and its
    /// points are as deep: it has several, to rest on, and a shape that leans a little does not alternate
    /// between two manifolds.
    #[inline(never)]
    fn by_flat_face(&self, edges: &EdgeAxis) -> Option<RawManifold> {
        let mut cloud = Cloud::new();
        let manifold = self.by_face(&mut cloud);
        let off = (cloud.least() - edges.separation).abs();
        let allowed = self.tolerance - edges.separation * (1.0 - FACE_PREFERENCE.0);
        let flat = manifold.normal.dot(edges.normal) > FLAT_FACE_COSINE;
        (manifold.count > 1 && flat && off <= allowed).then_some(manifold)
    }

    /// The manifold of two that overlap by all of their faces: of the face, or of two edges on whose axis
    /// they overlap by clearly less. If the edges show that they are apart: their axis.
    #[inline(always)]
    fn overlap(
        &self,
        near: &mut (EdgeSet, EdgeSet),
        cloud: &mut Cloud,
    ) -> ControlFlow<RawManifold, Option<EdgeAxis>> {
        let &FacePair { a, b, pose, margin, .. } = self;
        let edges = edge_axis(a, b, pose, near);
        match edges {
            Some(e) if e.separation > margin => Break(RawManifold::apart(e.separation)),
            Some(e) if e.separation > 0.0 => Continue(edges),
            Some(e) if e.separation > clearly(self.face.separation, self.tolerance) => {
                let flat = self.by_flat_face(&e);
                Break(flat.unwrap_or_else(|| self.by_edges(e.edges, e.normal, cloud)))
            }
            _ => {
                let manifold = self.by_face(cloud);
                if manifold.count > 1 {
                    return Break(manifold);
                }
                // One vertex, maybe beside the face: are they apart, by edges that are further away than any
                // face sees?
                *near = self.edges_in_reach(f32::MAX);
                let touching = edge_axis(a, b, pose, near);
                match touching {
                    Some(e) if e.separation > margin => Break(RawManifold::apart(e.separation)),
                    Some(e) if e.separation > 0.0 => {
                        *cloud = Cloud::new();
                        Continue(touching)
                    }
                    _ => Break(manifold),
                }
            }
        }
    }

    /// The manifold of the nearest edges of two that are apart. `touching`: the axis of edges that separates
    /// them.
    fn by_nearest_edges(&self, nearest: &Nearest, touching: Option<EdgeAxis>) -> RawManifold {
        let [p, q] = nearest.points;
        // If two edges just touch, only their cross product has a direction.
        let normal = match touching {
            Some(e) if nearest.distance < 1e-5 * self.size => e.normal,
            _ if nearest.distance > 0.0 => (q - p) / nearest.distance,
            _ => self.slab().normal,
        };
        self.by_edges(nearest.edges, normal, &mut Cloud::new())
    }

    /// The manifold of an edge of each.
    fn by_edges(&self, edges: [usize; 2], normal: Vec3, cloud: &mut Cloud) -> RawManifold {
        let on_a = Segment::of_edge(self.a, edges[0], &Pose::IDENTITY);
        let of_b = Segment::of_edge(self.b, edges[1], self.pose);
        clip_edges(&on_a, &of_b, normal, self.margin, cloud);
        manifold_of(cloud, normal)
    }

    /// The face as the reference: adds its points, in the frame of `a`; the normal from a to b.
    ///
    /// Adds the nearest vertex if the incident face that was chosen doesn't have it: of an overlap always,
    /// else where it is over the reference face, and so is the nearest point of all.
    fn face_contact(&self, cloud: &mut Cloud) -> Vec3 {
        let &FacePair { a, b, pose: b_in_a, margin, tolerance, face, on_b, .. } = self;
        // Everything in the frame of `a`.
        let (reference, incident, to_a, incident_to_a) =
            if on_b { (b, a, b_in_a, &Pose::IDENTITY) } else { (a, b, &Pose::IDENTITY, b_in_a) };
        let plane = |p: &Polytope, face: usize, pose: &Pose| {
            let (n, offset) = p.planes[face];
            let n = pose.direction(n);
            (n, offset + n.dot(pose.position))
        };
        let (normal, offset) = plane(reference, face.face, to_a);
        let down = if on_b { -normal } else { b_in_a.back(-normal) };
        let other = incident.face_towards(down);
        let corners = incident.face(other);
        let bit = if on_b { 1 << 14 } else { 0 };
        let before = cloud.points().len();
        let border = Loop::new(reference.vertices, reference.face(face.face), to_a);
        clip_face(
            &border,
            (normal, offset),
            &Loop::new(incident.vertices, corners, incident_to_a),
            plane(incident, other, incident_to_a),
            margin,
            tolerance,
            cloud,
        );
        if cloud.least() > face.separation + tolerance {
            let (vertex, _) = incident.support(down);
            let at = incident_to_a.point(incident.vertices[vertex]);
            let position = at - normal * (0.5 * face.separation);
            let known = corners.iter().any(|&c| usize::from(c) == vertex);
            if if face.separation < 0.0 {
                !known || cloud.points().is_empty()
            } else {
                border.is_over(normal, at)
            } {
                cloud.push(RawPoint { position, separation: face.separation, key: key(0, vertex, 1) });
            }
        }
        cloud.mark(before, bit);
        if on_b { -normal } else { normal }
    }
}

/// The manifold of a face, with the nearest point if that is missing: it can be a hair beside the face.
fn with_nearest_point(
    manifold: RawManifold,
    nearest: &Nearest,
    tolerance: f32,
    cloud: &mut Cloud,
) -> RawManifold {
    let [p, q] = nearest.points;
    let separation = manifold.normal.dot(q - p);
    if cloud.least() <= separation + tolerance {
        return manifold;
    }
    let [one, two] = nearest.edges;
    cloud.push(RawPoint { position: (p + q) * 0.5, separation, key: key(EDGES, one, two) });
    manifold_of(cloud, manifold.normal)
}
