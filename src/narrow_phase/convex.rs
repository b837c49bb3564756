//! Any two convex shapes, one pair at a time: the general path, and the reference for the lane kernels.
//!
//! Apart along a face normal by more than the margin: no contact. Otherwise the best axis of [`sat`](super::sat) makes
//! the manifold. Where two shapes are apart and nearest at an edge or vertex of both, the normal is the direction
//! between the nearest points: a reference plane there would stop what passes beside the face.

use super::clip::{Cloud, EDGES, Loop, Segment, clip_edges, clip_face, key};
use super::manifold::{RawManifold, RawPoint};
use super::polytope::{Polytope, Pose, Solid, Triangle};
use super::reduce::reduce;
use super::round_polytope::{Core, round_polytope, round_round};
use super::sat::{FaceAxis, edge_axis, edges_in_reach, face_axis, nearest_edges};
use super::{Relative, cylinder};
use crate::shape::{Collider, Kind};
use glam::Vec3;

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

/// What the tests of this folder share: seeded numbers, shapes, and a slow reference in f64.
#[cfg(test)]
pub(crate) mod testing {
    use super::*;
    use crate::shape::{ConvexHull, Filter, Geometry, Material};
    use glam::{DQuat, DVec3, Quat};
    use std::sync::Arc;

    /// Numbers in 0..1 (SplitMix64).
    pub(crate) struct Random(pub(crate) u64);
    impl Random {
        pub(crate) fn bits(&mut self) -> u64 {
            self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut z = self.0;
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            z ^ (z >> 31)
        }
        pub(crate) fn unit(&mut self) -> f32 {
            (self.bits() >> 40) as f32 / (1 << 24) as f32
        }
        pub(crate) fn below(&mut self, n: usize) -> usize {
            (self.bits() % n as u64) as usize
        }
        pub(crate) fn cube(&mut self) -> Vec3 {
            Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
        }
        pub(crate) fn sphere(&mut self) -> Vec3 {
            loop {
                let v = self.cube();
                if (0.01..1.0).contains(&v.length_squared()) {
                    return v.normalize();
                }
            }
        }
        pub(crate) fn rotation(&mut self) -> Quat {
            let (v, w) = (self.sphere(), self.unit() * 2.0 - 1.0);
            Quat::from_xyzw(v.x, v.y, v.z, w).normalize()
        }
    }

    pub(crate) fn collider(geometry: Geometry) -> Collider {
        let (mut size, radius) = ([0.0; 4], reach(&geometry));
        match &geometry {
            Geometry::Sphere { radius } => size[0] = *radius,
            Geometry::Capsule { half_height, radius_bottom, radius_top }
            | Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
                size = [*half_height, *radius_bottom, *radius_top, 0.0];
            }
            Geometry::Box { half_extents: h } => size = [h.x, h.y, h.z, 0.0],
            _ => {}
        }
        Collider {
            kind: Kind::of(&geometry),
            body: 0,
            place: 0,
            size,
            position: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            radius,
            inner_radius: 0.0,
            geometry,
            material: Material::default(),
            filter: Filter::default(),
            density: 1.0,
            flags: 0,
            user_data: 0,
        }
    }

    fn reach(geometry: &Geometry) -> f32 {
        match geometry {
            Geometry::Sphere { radius } => *radius,
            Geometry::Capsule { half_height, radius_bottom, radius_top } => {
                half_height + radius_bottom.max(*radius_top)
            }
            Geometry::Box { half_extents } => half_extents.length(),
            Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
                half_height.hypot(radius_bottom.max(*radius_top))
            }
            Geometry::Hull(h) => h.vertices.iter().map(|v| v.length()).fold(0.0, f32::max),
            _ => f32::INFINITY,
        }
    }

    pub(crate) fn hull(random: &mut Random, points: usize) -> Geometry {
        let squash = random.cube().abs() * 0.6 + 0.4;
        let points: Vec<Vec3> = (0..points).map(|_| random.sphere() * squash).collect();
        Geometry::Hull(Arc::new(ConvexHull::new(&points).unwrap()))
    }

    /// A shape of a kind, about a metre in size.
    pub(crate) fn shape(random: &mut Random, kind: Kind) -> Collider {
        let mut size = || 0.3 + 0.7 * random.unit();
        let (x, y, z) = (size(), size(), size());
        let tapers = random.below(2) == 0;
        collider(match kind {
            Kind::Sphere => Geometry::Sphere { radius: x },
            Kind::Capsule if tapers => {
                Geometry::Capsule { half_height: y, radius_bottom: x * 0.5, radius_top: z * 0.5 }
            }
            Kind::Capsule => Geometry::capsule(y, x * 0.5),
            Kind::Box => Geometry::cuboid(x, y, z),
            Kind::Cylinder if tapers => {
                Geometry::Cylinder { half_height: y, radius_bottom: x, radius_top: z - 0.3 }
            }
            Kind::Cylinder => Geometry::cylinder(y, x),
            _ => {
                let n = 6 + random.below(20);
                hull(random, n)
            }
        })
    }

    /// Largest extent along a direction.
    pub(crate) fn extent(shape: &Collider, d: DVec3) -> f64 {
        match &shape.geometry {
            Geometry::Sphere { radius } => f64::from(*radius) * d.length(),
            Geometry::Capsule { half_height, radius_bottom, radius_top } => {
                let (h, l) = (f64::from(*half_height) * d.y, d.length());
                (f64::from(*radius_bottom) * l - h).max(f64::from(*radius_top) * l + h)
            }
            Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
                let (h, l) = (f64::from(*half_height) * d.y, d.x.hypot(d.z));
                (f64::from(*radius_bottom) * l - h).max(f64::from(*radius_top) * l + h)
            }
            Geometry::Box { half_extents } => half_extents.as_dvec3().dot(d.abs()),
            Geometry::Hull(h) => h.vertices.iter().map(|v| v.as_dvec3().dot(d)).fold(f64::MIN, f64::max),
            _ => f64::INFINITY,
        }
    }

    /// Two shapes with the pose of b in a's frame.
    pub(crate) struct Pair<'a> {
        pub(crate) a: &'a Collider,
        pub(crate) b: &'a Collider,
        pub(crate) rel: Relative,
    }

    impl Pair<'_> {
        /// Distance of the two along a unit vector from a to b.
        pub(crate) fn along(&self, n: DVec3) -> f64 {
            let rotation: DQuat = self.rel.rotation.as_dquat().normalize();
            n.dot(self.rel.position.as_dvec3())
                - extent(self.a, n)
                - extent(self.b, rotation.conjugate() * -n)
        }

        /// A lower bound of [`Self::signed_distance`] out of 400 directions.
        pub(crate) fn about(&self) -> f64 {
            spiral(400).map(|n| self.along(n)).fold(f64::MIN, f64::max)
        }

        /// The largest distance along any direction: the distance of the shapes or, negative, the depth of their
        /// overlap. A thousand directions and all normals, and from the best of them uphill.
        pub(crate) fn signed_distance(&self) -> f64 {
            let rotation: DQuat = self.rel.rotation.as_dquat().normalize();
            let mut starts: Vec<(f64, DVec3)> =
                spiral(1000).chain(self.normals(rotation)).map(|n| (self.along(n), n)).collect();
            starts.sort_by(|a, b| b.0.total_cmp(&a.0));
            let mut best = f64::MIN;
            for &(mut value, mut n) in starts.iter().take(8) {
                let mut step = 0.04;
                while step > 1e-7 {
                    let (u, v) = (n.any_orthonormal_vector(), n.cross(n.any_orthonormal_vector()));
                    let mut better = false;
                    for k in 0..12 {
                        let angle = f64::from(k) * std::f64::consts::TAU / 12.0;
                        let next = (n + (u * libm::cos(angle) + v * libm::sin(angle)) * step).normalize();
                        let at = self.along(next);
                        if at > value {
                            (value, n, better) = (at, next, true);
                            break;
                        }
                    }
                    if !better {
                        step *= 0.5;
                    }
                }
                best = best.max(value);
            }
            best
        }

        /// All face normals, in a's frame.
        fn normals(&self, rotation: DQuat) -> Vec<DVec3> {
            let of = |shape: &Collider| match Solid::of(shape) {
                Some(solid) => solid.view().planes.iter().map(|p| p.0.as_dvec3()).collect(),
                None if shape.kind == Kind::Cylinder => vec![DVec3::Y, DVec3::NEG_Y],
                None => vec![],
            };
            let mut normals: Vec<DVec3> = of(self.a);
            normals.extend(of(self.b).into_iter().map(|n| rotation * -n));
            normals
        }
    }

    /// Evenly spread unit vectors.
    fn spiral(count: i32) -> impl Iterator<Item = DVec3> {
        (0..count).map(move |i| {
            let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let angle = f64::from(i) * 2.399_963_229_728_653;
            let r = (1.0 - y * y).sqrt();
            DVec3::new(r * libm::cos(angle), y, r * libm::sin(angle))
        })
    }

    /// At most how far a point is outside of a shape, by its planes; negative inside.
    pub(crate) fn outside(shape: &Collider, p: DVec3) -> f64 {
        let excess = |n: DVec3| n.dot(p) - extent(shape, n);
        if let Geometry::Cylinder { half_height, radius_bottom, radius_top } = shape.geometry {
            let slope = f64::from(radius_bottom - radius_top);
            let along = f64::from(2.0 * half_height);
            let across = DVec3::new(p.x, 0.0, p.z).normalize_or(DVec3::X);
            let side = (across * along + DVec3::Y * slope).normalize();
            return [DVec3::Y, DVec3::NEG_Y, side].map(excess).into_iter().fold(f64::MIN, f64::max);
        }
        match Solid::of(shape) {
            Some(solid) => {
                solid.view().planes.iter().map(|plane| excess(plane.0.as_dvec3())).fold(f64::MIN, f64::max)
            }
            None => spiral(1000).map(excess).fold(f64::MIN, f64::max),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::testing::*;
    use super::*;
    use crate::shape::{ConvexHull, Geometry};
    use glam::Quat;
    use std::sync::Arc;

    const KINDS: [Kind; 5] = [Kind::Sphere, Kind::Capsule, Kind::Box, Kind::Cylinder, Kind::Hull];
    const MARGIN: f32 = 0.05;

    /// How far normal and points may be from the reference [m]: faces are preferred by 5 % of the overlap and half a
    /// millimetre.
    fn tolerance(pair: &Pair, distance: f64) -> f64 {
        let size = f64::from(pair.a.radius.min(pair.b.radius));
        1e-5 + 1e-3 * size + 0.06 * (-distance).max(0.0)
    }

    fn check(pair: &Pair) -> RawManifold {
        let manifold = collide_convex(pair.a, pair.b, &pair.rel, MARGIN);
        let distance = pair.signed_distance();
        let tolerance = tolerance(pair, distance);
        let margin = f64::from(MARGIN);
        let kinds = (pair.a.kind, pair.a.size, pair.b.kind, pair.b.size);
        let what = format!("{kinds:?} {:?}\n{manifold:?}\ndistance {distance}", pair.rel);
        if manifold.count == 0 {
            assert!(distance > margin - tolerance, "missed: {what}");
            return manifold;
        }
        assert!(distance < margin + tolerance, "too far: {what}");
        let n = manifold.normal.as_dvec3();
        assert!((n.length() - 1.0).abs() < 1e-5, "normal: {what}");
        let along = pair.along(n);
        assert!(along > distance - tolerance, "not the way out, {along}: {what}");
        let least = manifold.points().iter().map(|p| p.separation).fold(f32::MAX, f32::min);
        assert!(
            (f64::from(least) - along).abs() < tolerance,
            "depth {least} but {along} along the normal: {what}"
        );
        let rotation = pair.rel.rotation.as_dquat().normalize();
        for point in manifold.points() {
            assert!(point.separation <= MARGIN);
            let half = n * (0.5 * f64::from(point.separation));
            let (on_a, on_b) = (point.position.as_dvec3() - half, point.position.as_dvec3() + half);
            let in_b = rotation.conjugate() * (on_b - pair.rel.position.as_dvec3());
            assert!(outside(pair.a, on_a) < 2.0 * tolerance, "off a by {}: {what}", outside(pair.a, on_a));
            assert!(outside(pair.b, in_b) < 2.0 * tolerance, "off b by {}: {what}", outside(pair.b, in_b));
        }
        for (i, p) in manifold.points().iter().enumerate() {
            assert!(manifold.points()[..i].iter().all(|q| q.key != p.key), "equal keys: {what}");
        }
        manifold
    }

    /// Random poses at which the signed distance is near `at` [m].
    fn sweep(a: Kind, b: Kind, seed: u64, rounds: usize) {
        let mut random = Random(seed);
        for round in 0..rounds {
            let (one, two) = (shape(&mut random, a), shape(&mut random, b));
            let (direction, rotation) = (random.sphere(), random.rotation());
            let rotation = if round % 5 == 4 { Quat::IDENTITY } else { rotation };
            let at = [-0.1, -0.02, -0.001, 0.002, 0.03][random.below(5)];
            // Bring them together until they are about that far apart.
            let mut far = one.radius + two.radius + 0.5;
            let at_distance =
                |t: f32| Pair { a: &one, b: &two, rel: Relative { position: direction * t, rotation } };
            for _ in 0..12 {
                far -= (at_distance(far).about() as f32 - at).max(-0.3) * 0.9;
            }
            check(&at_distance(far));
        }
    }

    #[test]
    fn round_pairs_agree_with_the_slow_reference() {
        for (i, a) in KINDS[..2].iter().enumerate() {
            for (j, b) in KINDS.iter().enumerate().skip(i) {
                sweep(*a, *b, (10 * i + j) as u64, 20);
            }
        }
    }

    #[test]
    fn boxes_and_hulls_agree_with_the_slow_reference() {
        sweep(Kind::Box, Kind::Box, 1, 60);
        sweep(Kind::Box, Kind::Hull, 2, 60);
        sweep(Kind::Hull, Kind::Hull, 3, 60);
    }

    #[test]
    fn cylinders_agree_with_the_slow_reference() {
        sweep(Kind::Box, Kind::Cylinder, 1, 40);
        sweep(Kind::Cylinder, Kind::Hull, 2, 40);
        sweep(Kind::Cylinder, Kind::Cylinder, 3, 40);
    }

    /// More of the above; says how many poses fail and shows each.
    #[test]
    #[ignore = "long"]
    fn many_more_poses_agree_with_the_slow_reference() {
        let mut failed = vec![];
        for (i, a) in KINDS.into_iter().enumerate() {
            for b in KINDS.into_iter().skip(i) {
                for seed in 0..150 {
                    if std::panic::catch_unwind(|| sweep(a, b, 1000 + seed, 2)).is_err() {
                        failed.push((a, b, seed));
                    }
                }
            }
        }
        assert!(failed.is_empty(), "{} of 4500: {failed:?}", failed.len());
    }

    fn at(y: f32) -> Relative {
        Relative { position: Vec3::Y * y, rotation: Quat::IDENTITY }
    }

    /// Splinters: the face that looks at the wall most need not have the vertex that is nearest to it. The distance is
    /// the height of the lowest vertex, at any margin.
    #[test]
    fn the_nearest_vertex_of_a_splinter_is_found_at_any_distance() {
        let mut random = Random(14);
        let wall = collider(Geometry::cuboid(50.0, 50.0, 0.01));
        for round in 0..2000 {
            let size = Vec3::new(0.1, 0.02 + 0.08 * random.unit(), 0.01);
            let points: Vec<Vec3> = (0..8 + random.below(20)).map(|_| random.sphere() * size).collect();
            let splinter = collider(Geometry::Hull(Arc::new(ConvexHull::new(&points).unwrap())));
            let rotation =
                if round % 2 == 0 { random.rotation() } else { Quat::from_rotation_x(0.2 * random.unit()) };
            let height = 0.5 * random.unit();
            let lowest = extent(&splinter, (rotation.conjugate() * Vec3::NEG_Z).as_dvec3());
            let position = Vec3::new(-45.0, 20.0, 0.01 + lowest as f32 + height);
            let manifold = collide_convex(&wall, &splinter, &Relative { position, rotation }, 4.0);
            let least = manifold.points().iter().map(|p| p.separation).fold(f32::MAX, f32::min);
            assert!((least - height).abs() < 1e-4, "{round}: {least} at {height}\n{manifold:?}");
            assert!((manifold.normal - Vec3::Z).length() < 1e-5, "{round}: {manifold:?}");
        }
    }

    /// The equal box on top covers the one below: contact in all four corners, however they are turned.
    #[test]
    fn equal_boxes_on_top_of_each_other_meet_in_four_corners() {
        let one = collider(Geometry::cuboid(0.5, 0.4, 0.3));
        for y in [0.79, 0.8, 0.81] {
            let manifold = check(&Pair { a: &one, b: &one, rel: at(y) });
            assert_eq!(manifold.count, 4);
            assert_eq!(manifold.normal, Vec3::Y);
            for p in manifold.points() {
                assert!((p.position.abs() - Vec3::new(0.5, 0.5 * y, 0.3)).abs().max_element() < 1e-3);
                assert!((p.separation - (y - 0.8)).abs() < 1e-6);
            }
            // A hair aside, the same features meet.
            let mut rel = at(y);
            rel.position += Vec3::new(2e-5, 0.0, -1e-5);
            let moved = collide_convex(&one, &one, &rel, MARGIN);
            assert_eq!(moved.points.map(|p| p.key), manifold.points.map(|p| p.key));
        }
    }

    #[test]
    fn identical_hulls_at_one_place_and_other_degenerate_poses_give_numbers() {
        let mut random = Random(11);
        for a in KINDS {
            for b in KINDS {
                let (one, two) = (shape(&mut random, a.min(b)), shape(&mut random, a.max(b)));
                let same = if a == b { &one } else { &two };
                for position in [Vec3::ZERO, Vec3::Y * 1e-20, Vec3::X * 1e10] {
                    for rotation in [Quat::IDENTITY, Quat::from_xyzw(1.0, 0.0, 0.0, 0.0)] {
                        let manifold = collide_convex(&one, same, &Relative { position, rotation }, MARGIN);
                        assert!(manifold.normal.is_finite());
                        assert_eq!(manifold.count == 0, position.x > 1.0, "{a:?} {b:?}");
                        for p in manifold.points() {
                            assert!(p.position.is_finite() && p.separation.is_finite());
                        }
                    }
                }
            }
        }
        // Needles, plates and cones.
        let thin = [
            Geometry::cuboid(1.0, 1e-4, 1.0),
            Geometry::cuboid(1e-4, 1.0, 1e-4),
            Geometry::cylinder(1e-3, 1.0),
            Geometry::cylinder(1.0, 1e-3),
            Geometry::Cylinder { half_height: 0.5, radius_bottom: 0.5, radius_top: 0.0 },
            Geometry::Cylinder { half_height: 0.5, radius_bottom: 0.0, radius_top: 0.5 },
            Geometry::capsule(0.0, 0.1),
        ]
        .map(collider);
        for a in &thin {
            for b in &thin {
                for _ in 0..20 {
                    let rel = Relative { position: random.cube() * 0.5, rotation: random.rotation() };
                    let manifold = collide_convex(a, b, &rel, MARGIN);
                    assert!(manifold.normal.is_finite());
                    assert!(
                        manifold.points().iter().all(|p| p.position.is_finite() && p.separation <= MARGIN)
                    );
                }
            }
        }
    }

    /// By the geometry of the shapes: what touches the plane is known.
    #[test]
    fn shapes_rest_on_a_half_space_by_their_lowest_points() {
        let plane = collider(Geometry::Plane);
        let rests = |geometry: Geometry, rotation: Quat, height: f32| {
            let rel = Relative {
                position: rotation.conjugate() * Vec3::Y * -height,
                rotation: rotation.conjugate(),
            };
            let manifold = collide_convex(&collider(geometry), &plane, &rel, MARGIN);
            let down = rotation * manifold.normal;
            assert!((down - Vec3::NEG_Y).length() < 1e-6);
            for p in manifold.points() {
                let world = rotation * p.position + Vec3::Y * height;
                assert!((world.y - 0.5 * p.separation).abs() < 1e-5);
            }
            manifold
        };
        let quarter = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2);
        assert_eq!(rests(Geometry::Sphere { radius: 1.0 }, quarter, 0.99).count, 1);
        assert_eq!(rests(Geometry::capsule(1.0, 0.5), quarter, 0.51).count, 2);
        assert_eq!(rests(Geometry::capsule(1.0, 0.5), Quat::IDENTITY, 1.51).count, 1);
        assert_eq!(rests(Geometry::cuboid(1.0, 0.5, 1.0), Quat::IDENTITY, 0.49).count, 4);
        assert_eq!(rests(Geometry::cylinder(1.0, 0.5), Quat::IDENTITY, 0.99).count, 4);
        // A cylinder that rolls touches with both ends of one line at every angle, just at its radius.
        for i in 0..100 {
            let turned = quarter * Quat::from_rotation_y(0.1 * i as f32);
            let manifold = rests(Geometry::cylinder(1.0, 0.5), turned, 0.49);
            assert_eq!(manifold.count, 2);
            assert!(manifold.points().iter().all(|p| (p.separation + 0.01).abs() < 1e-6));
        }
    }

    /// The same cylinder on a box: as on the plane.
    #[test]
    fn a_cylinder_rolls_and_stands_on_a_box_as_on_a_plane() {
        let (ground, drum) =
            (collider(Geometry::cuboid(5.0, 1.0, 5.0)), collider(Geometry::cylinder(1.0, 0.5)));
        for i in 0..100 {
            let rotation =
                Quat::from_rotation_z(std::f32::consts::FRAC_PI_2) * Quat::from_rotation_y(0.1 * i as f32);
            for height in [1.49, 1.51] {
                let rel = Relative { position: Vec3::new(0.3, height, 0.1), rotation };
                let manifold = collide_convex(&ground, &drum, &rel, MARGIN);
                assert_eq!(manifold.count, 2, "{i}: {manifold:?}");
                assert!((manifold.normal - Vec3::Y).length() < 1e-5);
                assert!(manifold.points().iter().all(|p| (p.separation - (height - 1.5)).abs() < 1e-5));
            }
            let standing = Quat::from_rotation_y(0.1 * i as f32);
            let rel = Relative { position: Vec3::new(0.3, 1.99, 0.1), rotation: standing };
            let manifold = collide_convex(&ground, &drum, &rel, MARGIN);
            assert_eq!(manifold.count, 4);
            let spread = manifold.points().iter().map(|p| (p.position - rel.position).x.abs()).sum::<f32>();
            assert!(spread > 0.99, "{spread}");
        }
        // Two logs, one on the other: the normal joins their axes.
        let turn = Quat::from_rotation_y(0.3);
        let manifold = collide_convex(
            &drum,
            &drum,
            &Relative { position: Vec3::new(0.6, 0.0, 0.79), rotation: turn },
            0.01,
        );
        assert_eq!(manifold.count, 2);
        assert!((manifold.normal - Vec3::new(0.6, 0.0, 0.79).normalize()).length() < 1e-3, "{manifold:?}");
    }

    /// A corner that passes beside a face is not in its way: the normal is the way between the corners.
    #[test]
    fn apart_at_corners_the_normal_joins_the_nearest_points() {
        let one = collider(Geometry::cuboid(0.5, 0.5, 0.5));
        let rel = Relative { position: Vec3::new(1.02, 1.02, 0.2), rotation: Quat::IDENTITY };
        let manifold = check(&Pair { a: &one, b: &one, rel });
        assert!((manifold.normal - Vec3::new(1.0, 1.0, 0.0).normalize()).length() < 1e-4);
        assert_eq!(manifold.count, 2);
    }

    #[test]
    fn a_triangle_pushes_back_to_the_side_that_the_centre_is_on() {
        let mut random = Random(5);
        let corners = [Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 0.0, -3.0), Vec3::new(0.0, 0.0, 3.0)];
        for kind in KINDS {
            for _ in 0..200 {
                let one = shape(&mut random, kind);
                let rotation = random.rotation();
                // The centre is above the triangle, by up to the size of the shape.
                let height = 0.02 + random.unit();
                let local = |p: Vec3| rotation.conjugate() * (p - Vec3::Y * height);
                let lowest =
                    f64::from(height) - extent(&one, (rotation.conjugate() * Vec3::NEG_Y).as_dvec3());
                let manifold = collide_triangle(&one, corners.map(local), MARGIN);
                assert_eq!(manifold.count == 0, lowest > f64::from(MARGIN), "{kind:?} lowest {lowest}");
                if manifold.count == 0 {
                    continue;
                }
                let down = rotation * manifold.normal;
                assert!(down.y < 1e-3, "{kind:?} pushes through: {down}");
                if lowest > -0.02 {
                    assert!(down.y < -0.999, "{kind:?} {down}, lowest {lowest}");
                    let least = manifold.points().iter().map(|p| p.separation).fold(f32::MAX, f32::min);
                    assert!((f64::from(least) - lowest).abs() < 2e-3, "{kind:?} {least} {lowest}");
                }
            }
        }
        assert_eq!(collide_triangle(&shape(&mut random, Kind::Box), [Vec3::ZERO; 3], MARGIN).count, 0);
    }

    #[test]
    fn a_pair_in_the_wrong_order_is_the_same_contact_seen_from_the_other() {
        let mut random = Random(3);
        let (one, two) = (shape(&mut random, Kind::Sphere), shape(&mut random, Kind::Hull));
        let rotation = random.rotation();
        let rel = Relative { position: Vec3::X * (one.radius + 0.3), rotation };
        let back =
            Relative { position: -(rotation.conjugate() * rel.position), rotation: rotation.conjugate() };
        let (forth, other) = (collide_convex(&one, &two, &rel, 2.0), collide_convex(&two, &one, &back, 2.0));
        assert!(forth.count > 0 && (other.normal + rotation.conjugate() * forth.normal).length() < 1e-5);
    }
}
