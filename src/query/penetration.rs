//! How deep two convex shapes are in each other.
//!
//! The polytope of van den Bergen (*Proximity Queries and Penetration Depth Computation on 3D Game Objects*,
//! 2001): the convex hull of some points of b - a grows where it is nearest to the origin until it can't.
//! Here the distance of a face counts with its sign, so that the first tetrahedron need not hold the origin:
//! a face that has it in front is the lowest, and grows first. On a fixed stack, with `f64`.

use crate::narrow_phase::{CoreGap, Support, SupportPose};
use glam::DVec3;

/// Points until the search is content: polytopes need about ten, round shapes reach a thousandth of the depth
/// with 40.
const MAX_POINTS: usize = 64;
const MAX_FACES: usize = 2 * MAX_POINTS;
const MAX_EDGES: usize = 96;

/// An overlap.
#[derive(Clone, Copy, Debug)]
pub(super) struct Depth {
    /// Distance by which a has to go back along the normal until they only touch [m].
    pub(super) depth: f64,
    /// Unit, from a to b, in a's frame.
    pub(super) normal: DVec3,
    /// On the surface of b, in a's frame, about.
    pub(super) point: DVec3,
}

/// The penetration depth of overlapping shapes; `gap`: GJK's result for them.
pub(super) fn depth(a: &Support, b: &Support, pose: &SupportPose, gap: &CoreGap) -> Depth {
    let radii = a.radius + b.radius;
    if !gap.overlap && gap.upper > 1e-9 * radii {
        let point = gap.point_b - gap.normal * b.radius;
        return Depth { depth: radii - gap.upper, normal: gap.normal, point };
    }
    let found = Polytope::new(a, b, pose).lowest();
    Depth { depth: found.depth + radii, normal: found.normal, point: found.point - found.normal * b.radius }
}

/// A point of b - a, and the point of b in a's frame that it comes from.
#[derive(Clone, Copy, Default)]
struct Corner {
    at: DVec3,
    on_b: DVec3,
}

#[derive(Clone, Copy, Default)]
struct Face {
    corners: [u8; 3],
    /// Unit, outwards, and its distance from the origin.
    normal: DVec3,
    height: f64,
}

struct Polytope<'a> {
    a: &'a Support<'a>,
    b: &'a Support<'a>,
    pose: &'a SupportPose,
    corners: [Corner; MAX_POINTS],
    count: usize,
    faces: [Face; MAX_FACES],
    face_count: usize,
    size: f64,
}

impl<'a> Polytope<'a> {
    fn new(a: &'a Support<'a>, b: &'a Support<'a>, pose: &'a SupportPose) -> Polytope<'a> {
        Polytope {
            a,
            b,
            pose,
            corners: [Corner::default(); MAX_POINTS],
            count: 0,
            faces: [Face::default(); MAX_FACES],
            face_count: 0,
            size: 0.0,
        }
    }

    /// The point of b - a that is furthest along `n`.
    fn furthest(&self, n: DVec3) -> Corner {
        let on_b =
            self.pose.rotation * self.b.support(self.pose.rotation.transpose() * n) + self.pose.position;
        Corner { at: on_b - self.a.support(-n), on_b }
    }

    /// The least distance by which b - a must be moved off the origin.
    fn lowest(mut self) -> Depth {
        if let Some(flat) = self.begin() {
            return flat;
        }
        let mut best = Depth { depth: f64::INFINITY, normal: DVec3::Y, point: DVec3::ZERO };
        for _ in 0..MAX_POINTS {
            let faces = &self.faces[..self.face_count];
            let Some(&face) = faces.iter().min_by(|p, q| p.height.total_cmp(&q.height)) else { break };
            let next = self.furthest(face.normal);
            let reach = face.normal.dot(next.at);
            if reach < best.depth {
                best = Depth { depth: reach.max(0.0), normal: -face.normal, point: self.point_on(&face) };
            }
            if reach - face.height <= 1e-9 * self.size + 1e-4 * reach.max(0.0) || !self.grow(next) {
                break;
            }
        }
        best
    }

    /// Makes the first tetrahedron; if b - a has no volume, the answer.
    fn begin(&mut self) -> Option<Depth> {
        let flat = |corner: &Corner, normal: DVec3| Depth { depth: 0.0, normal, point: corner.on_b };
        // Its longest side along an axis.
        let mut ends = [Corner::default(); 2];
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let pair = [self.furthest(axis), self.furthest(-axis)];
            if (pair[0].at - pair[1].at).length() > (ends[0].at - ends[1].at).length() {
                ends = pair;
            }
        }
        let along = ends[0].at - ends[1].at;
        self.size = along.length();
        if self.size == 0.0 {
            return Some(flat(&self.furthest(DVec3::Y), DVec3::Y));
        }
        let along = along / self.size;
        let (u, v) = along.any_orthonormal_pair();
        let off = |c: &Corner| {
            let d = c.at - ends[0].at;
            (d - along * d.dot(along)).length()
        };
        let sides = [u, -u, v, -v].map(|n| self.furthest(n));
        let third = sides.iter().fold(sides[0], |best, c| if off(c) > off(&best) { *c } else { best });
        if off(&third) <= 1e-9 * self.size {
            return Some(flat(&third, u));
        }
        let normal = (ends[1].at - ends[0].at).cross(third.at - ends[0].at).normalize_or(u);
        let (above, below) = (self.furthest(normal), self.furthest(-normal));
        let height = |c: &Corner| normal.dot(c.at - ends[0].at);
        let fourth = if height(&above) >= -height(&below) { above } else { below };
        if height(&fourth).abs() <= 1e-9 * self.size {
            return Some(flat(&third, normal));
        }
        self.corners[..4].copy_from_slice(&[ends[0], ends[1], third, fourth]);
        self.count = 4;
        let faces = if height(&fourth) < 0.0 {
            [[0, 1, 2], [1, 0, 3], [2, 1, 3], [0, 2, 3]]
        } else {
            [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
        };
        faces.iter().for_each(|&face| {
            self.push(face);
        });
        None
    }

    fn push(&mut self, corners: [u8; 3]) -> bool {
        if self.face_count == MAX_FACES {
            return false;
        }
        let [a, b, c] = corners.map(|i| self.corners[usize::from(i)].at);
        let across = (b - a).cross(c - a);
        let length = across.length();
        // A sliver has no direction to grow in.
        let (normal, height) = if length > 1e-18 * self.size * self.size {
            (across / length, (across / length).dot(a))
        } else {
            (DVec3::ZERO, f64::INFINITY)
        };
        self.faces[self.face_count] = Face { corners, normal, height };
        self.face_count += 1;
        true
    }

    /// Adds a point. False if there is no space left, or no face sees the point.
    fn grow(&mut self, corner: Corner) -> bool {
        if self.count == MAX_POINTS {
            return false;
        }
        let mut edges = [[0u8; 2]; MAX_EDGES];
        let (mut used, mut i) = (0, 0);
        while i < self.face_count {
            let face = self.faces[i];
            let seen = face.normal.dot(corner.at) - face.height > 1e-12 * self.size;
            if !seen {
                i += 1;
                continue;
            }
            self.face_count -= 1;
            self.faces[i] = self.faces[self.face_count];
            let [a, b, c] = face.corners;
            for edge in [[a, b], [b, c], [c, a]] {
                // An edge between two removed faces is inside.
                if let Some(twin) = edges[..used].iter().position(|e| *e == [edge[1], edge[0]]) {
                    used -= 1;
                    edges[twin] = edges[used];
                } else if used == MAX_EDGES {
                    return false;
                } else {
                    edges[used] = edge;
                    used += 1;
                }
            }
        }
        let new = self.count as u8;
        self.corners[self.count] = corner;
        self.count += 1;
        used > 0 && edges[..used].iter().all(|&[a, b]| self.push([a, b, new]))
    }

    /// The point of b for the point of a face that is nearest to the origin, or the one in the face's middle.
    fn point_on(&self, face: &Face) -> DVec3 {
        let [a, b, c] = face.corners.map(|i| self.corners[usize::from(i)]);
        let p = face.normal * face.height;
        let part = |p1: DVec3, p2: DVec3| face.normal.dot((p1 - p).cross(p2 - p)).max(0.0);
        let weights = [part(b.at, c.at), part(c.at, a.at), part(a.at, b.at)];
        let whole: f64 = weights.iter().sum();
        if whole > 0.0 {
            (a.on_b * weights[0] + b.on_b * weights[1] + c.on_b * weights[2]) / whole
        } else {
            (a.on_b + b.on_b + c.on_b) / 3.0
        }
    }
}
