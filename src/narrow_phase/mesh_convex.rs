//! Any convex shape against triangles, one triangle at a time, once boxes around them are found to be near.

use super::RawPoint;
use super::clip::{Cloud, Loop, clip_face};
use super::convex::collide_triangle;
use super::cylinder::over_triangle;
use super::mesh::{Ground, Triangles};
use super::mesh_box::key;
use super::mesh_patch::{GAP, Patches, Touch, Verdict};
use super::polytope::{Pose, Solid};
use super::round_polytope::Core;
use crate::lanes::{Lanes, Mask, f32x8};
use crate::shape::{Collider, Geometry, Kind};
use glam::Vec3;

/// Points with keys that tell the triangle too.
fn named(touch: &Touch, points: &[RawPoint]) -> impl Iterator<Item = RawPoint> {
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
    let (middle, half, centre) = around;
    let (_, axis, _) = triangles.separate(middle, half);
    let mut bits = axis.le(margins).bits() & triangles.valid;
    while bits != 0 {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits - 1;
        // Deepest below the face, of all of the shape.
        let (front, height) = (triangles.front.lane(lane), triangles.height.lane(lane));
        let margin = margins.lane(lane);
        let face = height - extent(a, centre, -front);
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
        let first = patches.points.len();
        match verdict {
            Verdict::Drop => {}
            Verdict::Keep => {
                patches.points.extend(named(&touch, manifold.points()));
                patches.add(touch, manifold.normal, None, first);
            }
            Verdict::Face(least) => {
                // Not if it is the face's own normal already. A cylinder's may be nearly that.
                if -manifold.normal.dot(front) > 0.999_999 && a.kind != Kind::Cylinder {
                    patches.points.extend(named(&touch, manifold.points()));
                } else {
                    over_face(a, &touch, margin, &mut patches.points);
                    patches.limit(first, least);
                }
                // In the gap between the faces of a hardly convex edge, over neither of them.
                let in_gap = patches.points.len() == first && -manifold.normal.dot(front) > GAP;
                if in_gap {
                    let offset = front.dot(touch.corners[0]);
                    let bound = half + Vec3::splat(1e-3 * a.radius);
                    patches.points.extend(named(&touch, manifold.points()).filter_map(|p| {
                        let on_a = p.position - manifold.normal * (0.5 * p.separation);
                        let separation = front.dot(on_a) - offset;
                        let position = on_a - front * (0.5 * separation);
                        let inside = (on_a - middle).abs().cmple(bound).all();
                        (inside && separation <= margin).then_some(RawPoint { position, separation, ..p })
                    }));
                }
                if in_gap {
                    patches.add_in_gap(touch, face, first, -manifold.normal);
                } else {
                    patches.add(touch, -front, Some(face), first);
                }
            }
        }
        if apart < 0.0 && patches.points.len() == first {
            patches.pass_over(touch, face);
        }
    }
}

/// How far a shape reaches along a direction from its centre [m].
fn extent(a: &Collider, centre: Vec3, direction: Vec3) -> f32 {
    let d = direction;
    let flat = (d.x * d.x + d.z * d.z).sqrt();
    match &a.geometry {
        Geometry::Sphere { radius } => *radius,
        Geometry::Capsule { half_height: h, radius_bottom, radius_top } => {
            (h * d.y + radius_top).max(-h * d.y + radius_bottom)
        }
        Geometry::Cylinder { half_height: h, radius_bottom, radius_top } => {
            (h * d.y + radius_top * flat).max(-h * d.y + radius_bottom * flat)
        }
        Geometry::Box { half_extents } => half_extents.dot(d.abs()),
        Geometry::Hull(hull) => {
            let most = hull.vertices.iter().map(|v| v.dot(d)).fold(f32::MIN, f32::max);
            most - centre.dot(d)
        }
        _ => 0.0,
    }
}

/// Adds the points of a shape that are over a triangle and nearer than the margin, along the triangle's normal.
fn over_face(a: &Collider, touch: &Touch, margin: f32, points: &mut Vec<RawPoint>) {
    let front = touch.front;
    let offset = front.dot(touch.corners[0]);
    if let Some(core) = Core::of(a) {
        core_over_face(&core, touch, margin, points);
        return;
    }
    let order: [u16; 3] = if touch.behind { [0, 2, 1] } else { [0, 1, 2] };
    let triangle = Loop::new(&touch.corners, &order, &Pose::IDENTITY);
    let mut cloud = Cloud::new();
    if a.kind == Kind::Cylinder {
        over_triangle(a, &triangle, front, margin, &mut cloud);
        points.extend(named(touch, cloud.points()));
        return;
    }
    let Some(solid) = Solid::of(a) else { return };
    let p = solid.view();
    let face = p.face_towards(-front);
    clip_face(
        &triangle,
        (front, offset),
        &Loop::new(p.vertices, p.face(face), &Pose::IDENTITY),
        p.planes[face],
        margin,
        1e-4 * a.radius,
        &mut cloud,
    );
    points.extend(named(touch, cloud.points()));
}

/// The two ends of what of a core lies over a triangle.
fn core_over_face(core: &Core, touch: &Touch, margin: f32, points: &mut Vec<RawPoint>) {
    let front = touch.front;
    let (mut low, mut high) = (0.0f32, 1.0f32);
    for i in 0..3 {
        let (from, to) = (touch.corners[i], touch.corners[(i + 1) % 3]);
        let out = if touch.behind { front.cross(to - from) } else { (to - from).cross(front) };
        let (start, along) = (out.dot(core.start - from), out.dot(core.along));
        // Outside where start + s along > 0.
        if along > 0.0 {
            high = high.min(-start / along);
        } else if along < 0.0 {
            low = low.max(-start / along);
        } else if start > 0.0 {
            return;
        }
    }
    if low > high {
        return;
    }
    let ends = if core.is_ball() || high - low < 1e-4 { 1 } else { 2 };
    for (k, s) in [low, high].into_iter().enumerate().take(ends) {
        let centre = core.at(s);
        let separation = front.dot(centre - touch.corners[0]) - core.radius_at(s);
        if separation <= margin {
            let position = centre - front * (core.radius_at(s) + 0.5 * separation);
            points.push(RawPoint { position, separation, key: key(touch.index, 0x40 + k as u32) });
        }
    }
}
