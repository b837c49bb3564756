//! Any two convex shapes, one pair at a time: the general path, and the reference for the lane kernels.
//!
//! Apart along a face normal by more than the margin: no contact. Otherwise the best axis of [`sat`](crate::narrow_phase::convex::sat) makes
//! the manifold. Where two shapes are apart and nearest at an edge or vertex of both, the normal is the direction
//! between the nearest points: a reference plane there would stop what passes beside the face.

pub(crate) mod clip;
pub(crate) mod cylinder;
pub(crate) mod gjk;
pub(crate) mod polytope;
pub(crate) mod reduce;
pub(crate) mod round_polytope;
pub(crate) mod sat;
pub(crate) mod simplex;
pub(crate) mod support;

use super::Relative;
use crate::narrow_phase::contacts::manifold::{RawManifold, RawPoint};
use crate::shape::{Collider, Kind};
use clip::{Cloud, EDGES, Loop, Segment, clip_edges, clip_face, key};
use glam::Vec3;
use polytope::{Polytope, Pose, Solid, Triangle};
use reduce::reduce;
use round_polytope::{Core, round_polytope, round_round};
use sat::{FaceAxis, edge_axis, edges_in_reach, face_axis, nearest_edges};

/// Faces are preferred to edges, and a's to b's, by this share of the overlap and of the size: a manifold of four
/// points that lasts is worth more than half a millimetre on a metre.
pub(super) const PREFERENCE: (f32, f32) = (0.95, 5e-4);

/// All points nearer than the margin of two convex shapes, or of a convex shape and a half-space; in a's frame.
pub(crate) fn collide_convex(a: &Collider, b: &Collider, rel: &Relative, margin: f32) -> RawManifold {
    if a.kind > b.kind {
        let rotation = rel.rotation.conjugate();
        let back = Relative { position: -(rotation * rel.position), rotation };
        return collide_convex(b, a, &back, margin).flipped(back.position, back.rotation);
    }
    let pose = Pose::new(rel.position, rel.rotation);
    if !a.kind.is_convex() {
        return RawManifold::default();
    }
    if b.kind == Kind::Plane {
        return half_space(a, &pose, margin);
    }
    if !b.kind.is_convex() {
        return RawManifold::default();
    }
    match (Core::of(a), Core::of(b)) {
        (Some(a), Some(b)) => round_round(&a, &b.moved(&pose), margin),
        (Some(core), None) => {
            let back = pose.inverse();
            let size = a.radius.min(b.radius);
            let in_b = if b.kind == Kind::Cylinder {
                cylinder::round_cylinder(&core.moved(&back), b, margin)
            } else {
                let Some(solid) = Solid::of(b) else { return RawManifold::default() };
                round_polytope(&core.moved(&back), &solid.view(), margin, size)
            };
            in_frame(in_b, &pose)
        }
        _ if a.kind == Kind::Cylinder || b.kind == Kind::Cylinder => {
            cylinder::cylinder(a, &cylinder::Other::Shape(b), &pose, margin)
        }
        _ => {
            let (Some(of_a), Some(of_b)) = (Solid::of(a), Solid::of(b)) else {
                return RawManifold::default();
            };
            polytopes(&of_a.view(), &of_b.view(), &pose, margin, a.radius.min(b.radius), Vec3::ZERO)
        }
    }
}

/// All points nearer than the margin of a convex shape and a triangle in the shape's frame. The side of the triangle
/// on which the frame's origin is counts as its outside: the normal, from the shape to the triangle, never pushes the
/// shape through.
pub(crate) fn collide_triangle(a: &Collider, triangle: [Vec3; 3], margin: f32) -> RawManifold {
    let Some(triangle) = Triangle::facing(triangle, Vec3::ZERO) else { return RawManifold::default() };
    if let Some(core) = Core::of(a) {
        return round_polytope(&core, &Solid::Triangle(triangle).view(), margin, a.radius);
    }
    if a.kind == Kind::Cylinder {
        return cylinder::cylinder(a, &cylinder::Other::Triangle(&triangle), &Pose::IDENTITY, margin);
    }
    let Some(solid) = Solid::of(a) else { return RawManifold::default() };
    let front = triangle.normal();
    polytopes(&solid.view(), &Solid::Triangle(triangle).view(), &Pose::IDENTITY, margin, a.radius, front)
}

/// A manifold in b's frame whose normal points from a to b, in a's frame.
fn in_frame(mut manifold: RawManifold, b_in_a: &Pose) -> RawManifold {
    manifold.normal = b_in_a.direction(manifold.normal);
    for point in &mut manifold.points[..manifold.count as usize] {
        point.position = b_in_a.point(point.position);
    }
    manifold
}

/// The points of a cloud, at most four of them.
pub(super) fn manifold_of(cloud: &Cloud, normal: Vec3) -> RawManifold {
    let (points, count) = reduce(cloud.points(), normal);
    RawManifold { normal, count, points }
}

/// A face of one of two polytopes as the reference: its points, in the frame of `a`.
///
/// `on_b`: whose face. Adds the nearest vertex if the incident face that was chosen doesn't have it: of an overlap
/// always, else where it is over the reference face, and so is the nearest point of all.
fn face_contact(
    a: &Polytope,
    b: &Polytope,
    b_in_a: &Pose,
    (face, on_b): (FaceAxis, bool),
    margin: f32,
    tolerance: f32,
    cloud: &mut Cloud,
) -> Vec3 {
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

/// Two polytopes, `b` at `pose` in the frame of `a`.
///
/// `size`: a length of the smaller one [m]. `against`: normals along it don't count as ways out of an overlap; zero
/// if all do.
fn polytopes(a: &Polytope, b: &Polytope, pose: &Pose, margin: f32, size: f32, against: Vec3) -> RawManifold {
    let none = RawManifold::default();
    let back = pose.inverse();
    let tolerance = PREFERENCE.1 * size;
    let face_a = face_axis(a, b, pose, margin, against);
    if face_a.separation > margin {
        return none;
    }
    let face_b = face_axis(b, a, &back, margin, Vec3::ZERO);
    if face_b.separation > margin {
        return none;
    }
    let clearly = |s: f32| if s < 0.0 { PREFERENCE.0 * s + tolerance } else { s + tolerance };
    let on_b = face_b.separation > clearly(face_a.separation);
    let face = if on_b { face_b } else { face_a };
    let mut cloud = Cloud::new();
    let by_face = |cloud: &mut Cloud| {
        let normal = face_contact(a, b, pose, (face, on_b), margin, tolerance, cloud);
        manifold_of(cloud, normal)
    };

    let mut done = None;
    if face.separation > 0.0 {
        let manifold = by_face(&mut cloud);
        if cloud.least() <= face.separation + tolerance {
            return manifold;
        }
        done = Some(manifold);
    }

    // Along the normal all of `a` is below `high`, all of `b` above `low`.
    let (normal, high, low) = if on_b {
        let n = -pose.direction(b.planes[face.face].0);
        let low = n.dot(pose.position) - b.planes[face.face].1;
        (n, low - face.separation, low)
    } else {
        let (n, offset) = a.planes[face.face];
        (n, offset, offset + face.separation)
    };
    let reach = margin.max(-face.separation);
    let mut near = edges_in_reach(a, b, pose, &back, reach, normal, (high, low));
    let mut touching = None;
    if face.separation <= 0.0 {
        let edges = edge_axis(a, b, pose, &near, against);
        touching = edges;
        if edges.is_some_and(|e| e.separation > margin) {
            return none;
        }
        match edges {
            Some(e) if e.separation > 0.0 => {}
            Some(e) if e.separation > clearly(face.separation) => {
                let on_a = Segment::of_edge(a, e.edges[0], &Pose::IDENTITY);
                let of_b = Segment::of_edge(b, e.edges[1], pose);
                clip_edges(&on_a, &of_b, e.normal, margin, &mut cloud);
                return manifold_of(&cloud, e.normal);
            }
            _ => {
                let manifold = by_face(&mut cloud);
                if manifold.count > 1 {
                    return manifold;
                }
                // One vertex, maybe beside the face: are they apart, by edges that are further away than any face sees?
                near = edges_in_reach(a, b, pose, &back, f32::MAX, normal, (high, low));
                touching = edge_axis(a, b, pose, &near, against);
                match touching {
                    Some(e) if e.separation > margin => return none,
                    Some(e) if e.separation > 0.0 => cloud = Cloud::new(),
                    _ => return manifold,
                }
            }
        }
    }

    // Apart, and no vertex of one over the face of the other: edges or vertices of both are nearest.
    let Some(nearest) = nearest_edges(a, b, pose, &near) else { return done.unwrap_or(none) };
    if nearest.distance > margin {
        return none;
    }
    if nearest.distance <= face.separation + tolerance {
        let manifold = done.unwrap_or_else(|| by_face(&mut cloud));
        // The nearest point can be a hair beside the face, and be missing.
        let [p, q] = nearest.points;
        let separation = manifold.normal.dot(q - p);
        if cloud.least() <= separation + tolerance {
            return manifold;
        }
        let [one, two] = nearest.edges;
        cloud.push(RawPoint { position: (p + q) * 0.5, separation, key: key(EDGES, one, two) });
        return manifold_of(&cloud, manifold.normal);
    }
    let [p, q] = nearest.points;
    // Of two edges that just touch only their cross product has a direction.
    let normal = match touching {
        Some(e) if nearest.distance < 1e-5 * size => e.normal,
        _ if nearest.distance > 0.0 => (q - p) / nearest.distance,
        _ => normal,
    };
    let mut cloud = Cloud::new();
    let on_a = Segment::of_edge(a, nearest.edges[0], &Pose::IDENTITY);
    let of_b = Segment::of_edge(b, nearest.edges[1], pose);
    clip_edges(&on_a, &of_b, normal, margin, &mut cloud);
    manifold_of(&cloud, normal)
}

/// A convex shape and the half-space y <= 0 of the frame at `pose`.
fn half_space(a: &Collider, pose: &Pose, margin: f32) -> RawManifold {
    let normal = -pose.axes.y_axis;
    let height = |p: Vec3| normal.dot(pose.position - p);
    let mut cloud = Cloud::new();
    let mut emit = |at: Vec3, separation: f32, key: u32| {
        if separation <= margin {
            cloud.push(RawPoint { position: at + normal * (0.5 * separation), separation, key });
        }
    };
    if let Some(core) = Core::of(a) {
        let ends = if core.is_ball() { 1 } else { 2 };
        for k in 0..ends {
            let (c, r) = (core.at(k as f32), core.radius_at(k as f32));
            emit(c + normal * r, height(c) - r, k);
        }
        return manifold_of(&cloud, normal);
    }
    if let Some(f) = cylinder::Frustum::of(a) {
        let plane = (normal, normal.dot(pose.position));
        cylinder::on_half_space(&f, plane, (margin, a.radius), &mut cloud);
        return manifold_of(&cloud, normal);
    }
    let Some(solid) = Solid::of(a) else { return RawManifold::default() };
    for (i, v) in solid.view().vertices.iter().enumerate() {
        emit(*v, height(*v), i as u32);
    }
    manifold_of(&cloud, normal)
}

#[cfg(test)]
pub(crate) mod testing;

#[cfg(test)]
mod tests;
