//! How deep bodies overlap, by parry3d's queries between exact shapes.

use backstop::glam::{Quat, Vec3};
use backstop::{BodyKind, Geometry};
use backstop_lab::envelope::State;
use backstop_scene::Scene;
use parry3d::math::{Pose, Rotation, Vector};
use parry3d::query;
use parry3d::shape::SharedShape;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// A shape where it is.
struct Item {
    body: usize,
    is_dynamic: bool,
    shape: SharedShape,
    pose: Pose,
    min: Vec3,
    max: Vec3,
}

/// The deepest overlap and the mean of all [m]; none if nothing can be asked.
///
/// Meshes are left out: on which side of a triangle a body belongs isn't seen from one pose. So are pairs
/// that a joint keeps from colliding.
pub(super) fn of(scene: &Scene, states: &[State]) -> Option<(f64, f64)> {
    let mut items = items(scene, states);
    items.sort_by(|a, b| a.min.x.total_cmp(&b.min.x));
    let jointed: HashSet<[usize; 2]> = scene.joints.iter().map(|joint| sorted(joint.bodies)).collect();
    let (mut deepest, mut sum, mut count) = (0.0f64, 0.0f64, 0u32);
    for (i, a) in items.iter().enumerate() {
        for b in items[i + 1..].iter().take_while(|b| b.min.x <= a.max.x) {
            let apart = a.min.cmpgt(b.max).any() || b.min.cmpgt(a.max).any();
            let none = a.body == b.body || !(a.is_dynamic || b.is_dynamic);
            if apart || none || jointed.contains(&sorted([a.body, b.body])) {
                continue;
            }
            let contact = query::contact(&a.pose, a.shape.as_ref(), &b.pose, b.shape.as_ref(), 0.0);
            if let Some(depth) = contact.ok().flatten().map(|c| f64::from(-c.dist)).filter(|d| *d > 0.0) {
                (deepest, sum, count) = (deepest.max(depth), sum + depth, count + 1);
            }
        }
    }
    (!items.is_empty()).then(|| (deepest, sum / f64::from(count.max(1))))
}

fn sorted([a, b]: [usize; 2]) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

fn vector(v: Vec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

fn pose(position: Vec3, q: Quat) -> Pose {
    Pose::from_parts(vector(position), Rotation::from_xyzw(q.x, q.y, q.z, q.w))
}

fn items(scene: &Scene, states: &[State]) -> Vec<Item> {
    let mut hulls = HashMap::new();
    let mut items = Vec::new();
    for (body, (of, state)) in scene.bodies.iter().zip(states).enumerate() {
        if !state.position.is_finite() || !state.rotation.is_finite() {
            continue;
        }
        for desc in &of.desc.shapes {
            let Some(shape) = shape(&desc.geometry, &mut hulls) else { continue };
            let local = pose(desc.position, desc.rotation);
            let pose = pose(state.position.as_vec3(), state.rotation) * local;
            let bounds = shape.compute_aabb(&pose);
            let [min, max] = [bounds.mins, bounds.maxs].map(|p| Vec3::new(p.x, p.y, p.z));
            let is_dynamic = of.desc.kind == BodyKind::Dynamic;
            items.push(Item { body, is_dynamic, shape, pose, min, max });
        }
    }
    items
}

/// The shape in parry's terms; equal hulls are made once.
fn shape(geometry: &Geometry, hulls: &mut HashMap<usize, Option<SharedShape>>) -> Option<SharedShape> {
    match geometry {
        Geometry::Sphere { radius } => Some(SharedShape::ball(*radius)),
        Geometry::Capsule { half_height, radius_bottom, .. } => {
            Some(SharedShape::capsule_y(*half_height, *radius_bottom))
        }
        Geometry::Box { half_extents: half } => Some(SharedShape::cuboid(half.x, half.y, half.z)),
        Geometry::Hull(hull) => hulls
            .entry(Arc::as_ptr(hull) as usize)
            .or_insert_with(|| {
                let points: Vec<_> = hull.vertices().iter().map(|&v| vector(v)).collect();
                SharedShape::convex_hull(&points)
            })
            .clone(),
        _ => None,
    }
}
