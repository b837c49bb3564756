//! Final poses of bodies that rows pushed off their predicted path.
//!
//! Rows keep contacts in a linear model: a point moves along its velocity, and arms stay as they were at the
//! touch. A body that strikes with a tip at 500 m/s turns by many radians in the rest of the step. Its centre
//! then takes an unchecked path, and ends with a rotation that no row accounted for. So for bodies that end
//! far from their predicted pose (*off their path*), the end of the step is settled against the actual static
//! geometry:
//!
//! - The path of the centre is followed; where it enters a surface, the rest of it continues along that
//!   surface, and so do the velocities ([`Guard::go_on`]). A shot into a corner meets its three walls in one
//!   step.
//! - At the end, with the rotation that the rows gave it, the body is moved out of all overlap: the manifolds
//!   with which the next step would begin tell how far ([`Settling::settle`]). No velocity is changed, so no
//!   energy is added.
//!
//! Bodies that went as predicted need none of it: their paths were checked before the rows were made.

use super::Moved;
use super::ends::ends_of;
use super::guard::{Guard, Held};
use super::moving::{is_in_range, stop_body};
use crate::body::{Bodies, Pose, Traits};
use crate::broad_phase::{SearchSet, aabb_of};
use crate::config::tuning::STRAY_DISTANCE;
use crate::config::{Measures, Settings};
use crate::lanes::Record;
use crate::limits::MAX_LEFT_SPEED;
use crate::memory::{Allowance, Buffer, add_bytes, bytes_of};
use crate::narrow_phase::{
    MeshScratch, RawManifold, Reach, Relative, collide_convex, collide_mesh, out_by_the_centre,
};
use crate::shape::Collider;
use glam::{DVec3, Vec3};

/// Maximum number of surfaces along which a body is led within a step.
const SURFACES: usize = 4;
/// How often a body is moved out of overlap: out of one surface, and of those that this moves it into.
const LIFTS: usize = 12;

/// Buffers of mesh queries. They do not grow once they have their capacity.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    mesh: MeshScratch,
    raw: Vec<RawManifold>,
}

/// Maximum number of triangles that a query may touch, and of the manifolds that they may yield.
const TRIANGLES: usize = 32;
const MANIFOLDS: usize = 8;

impl Scratch {
    /// Calls `f` with each buffer and the capacity that it needs.
    pub(super) fn each(&mut self, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        self.mesh.each_ready(TRIANGLES, f);
        f(&mut self.raw, MANIFOLDS);
    }

    pub(super) fn bytes(&self) -> (usize, usize) {
        add_bytes(self.mesh.bytes(), bytes_of(&self.raw))
    }
}

/// Buffers of queries: a stack for tree traversals, and those for meshes, which may be allocated now unless
/// memory has a budget.
pub(super) struct Tools<'a> {
    pub(super) stack: &'a mut Vec<u32>,
    pub(super) scratch: &'a mut Scratch,
    pub(super) may_grow: bool,
}

/// How a body off its path was settled.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Settled {
    /// Led along surfaces that its centre would have entered, or moved out of overlap.
    pub(super) moved: bool,
    /// Stopped where it met too many surfaces.
    pub(super) cut: bool,
}

/// Settles the dynamic bodies that are off their path. `delta`: displacements, with the mark of these bodies;
/// counts the bodies that the guard held, and lists those that were stopped.
pub(super) fn settle_off_path(
    guard: &Guard<'_>,
    tools: &mut Tools<'_>,
    bodies: &mut Bodies,
    delta: &[Record],
    acceleration: &[Record],
    settings: &Settings,
    moved: &mut Moved,
) {
    let Measures { unit, slop, .. } = settings.measures();
    for i in (0..bodies.dynamic()).filter(|&i| delta[i].is_off_path()) {
        let own = bodies.colliders[i].as_slice();
        let body = Settling {
            own,
            traits: &bodies.traits[i],
            pull: acceleration.get(i).map_or(Vec3::ZERO, |pull| pull.linear),
            slop,
            least: (STRAY_DISTANCE * unit).min(0.5 * guard.inner(own)).max(2.0 * slop),
        };
        let (pose, velocity) = (&mut bodies.pose[i], &mut bodies.velocity[i]);
        let start = *pose;
        let settled = body.settle(guard, tools, pose, delta[i].linear, velocity);
        moved.held.cut += u32::from(settled.cut);
        moved.held.settled += u32::from(settled.moved);
        if !is_in_range(pose) || !velocity.is_within(MAX_LEFT_SPEED) {
            stop_body(pose, velocity, start, true);
            moved.stopped.push(i as u32);
        }
    }
}

/// A body off its path.
pub(super) struct Settling<'a> {
    pub(super) own: &'a [u32],
    pub(super) traits: &'a Traits,
    /// Acceleration of the step [m/s²].
    pub(super) pull: Vec3,
    /// Overlap that it may keep [m].
    pub(super) slop: f32,
    /// Overlap by no more than this is left as it is [m].
    pub(super) least: f32,
}

/// Result of following the path of a centre.
struct Went {
    to: DVec3,
    /// It was led along a surface.
    along_surface: bool,
    /// The rest of the path, if it led into too many surfaces.
    left: Option<Vec3>,
}

impl Guard<'_> {
    /// How far an end of a body, at `arm` from its centre, is behind the surface between the two, and the
    /// normal of that; `None` if the segment from the centre to the end comes out again.
    fn beyond(&self, stack: &mut Vec<u32>, own: &[u32], centre: DVec3, arm: Vec3) -> Option<(f32, Vec3)> {
        let (fraction, normal) = self.first_static(stack, own, centre, arm)?;
        let behind = (1.0 - fraction) * -arm.dot(normal);
        // Begin just behind the surface.
        let from = fraction + 1e-3 * (1.0 - fraction);
        let rest = arm * (1.0 - from);
        let goes_on = self.first_static(stack, own, centre + (arm * from).as_dvec3(), rest).is_none();
        (behind > 0.0 && goes_on).then_some((behind, normal))
    }

    /// Follows the path of a centre along the static surfaces that it enters, and removes the velocities into
    /// them.
    fn go_on(
        &self,
        stack: &mut Vec<u32>,
        body: &Settling<'_>,
        from: DVec3,
        way: Vec3,
        velocity: &mut Record,
    ) -> Went {
        let (mut at, mut left) = (from, way);
        let mut met = [Vec3::ZERO; SURFACES];
        for count in 0..SURFACES {
            let mut moved = left;
            let Some((Held::Cut, normal)) = self.hold(stack, body.own, at, &mut moved, velocity) else {
                return Went {
                    to: at + body.traits.free(moved).as_dvec3(),
                    along_surface: count > 0,
                    left: None,
                };
            };
            moved = body.traits.free(moved);
            at += moved.as_dvec3();
            met[count] = normal;
            left = body.traits.free(along(&met[..=count], left - moved));
            velocity.linear = body.traits.free(along(&met[..=count], velocity.linear));
            if left == Vec3::ZERO {
                return Went { to: at, along_surface: true, left: None };
            }
        }
        Went { to: at, along_surface: true, left: Some(left) }
    }
}

/// The part of a vector that leads into none of the surfaces with these normals, of which the last was
/// entered last.
fn along(normals: &[Vec3], vector: Vec3) -> Vec3 {
    let Some((&last, before)) = normals.split_last() else { return vector };
    let slid = vector - last * vector.dot(last).min(0.0);
    for (i, &other) in before.iter().enumerate() {
        if slid.dot(other) < 0.0 {
            // Only the direction of the crease is left, and if that leads into a third surface, nothing.
            let Some(crease) = last.cross(other).try_normalize() else { return Vec3::ZERO };
            let slid = crease * vector.dot(crease);
            let into_third =
                before.iter().enumerate().any(|(k, n)| k != i && slid.dot(*n) < -1e-6 * slid.length());
            return if into_third { Vec3::ZERO } else { slid };
        }
    }
    slid
}

/// Removes from a body's speed into the surface, by which it was lifted, the energy of the lift against its
/// acceleration: twice that energy by its mass [m²/s²].
fn pay(velocity: &mut Vec3, out: Vec3, price: f32) {
    let into = -velocity.dot(out);
    if into > 0.0 && price > 0.0 {
        *velocity += out * (into - (into * into - price).max(0.0).sqrt());
    }
}

impl Settling<'_> {
    /// Settles a body that has its final rotation but still its position of the start of the step.
    pub(super) fn settle(
        &self,
        guard: &Guard<'_>,
        tools: &mut Tools<'_>,
        pose: &mut Pose,
        way: Vec3,
        velocity: &mut Record,
    ) -> Settled {
        let went = guard.go_on(tools.stack, self, pose.position, way, velocity);
        pose.position = went.to;
        let mut settled = Settled { moved: went.along_surface, cut: false };
        if let Some(left) = went.left {
            if guard.cuts {
                settled.cut = true;
            } else {
                pose.position += left.as_dvec3();
            }
        }
        for _ in 0..LIFTS {
            let Some((depth, out)) = self.deepest(guard, tools, pose) else { break };
            if depth <= self.least {
                break;
            }
            let mut lift = self.traits.free(out * (depth - self.slop));
            if lift == Vec3::ZERO {
                break;
            }
            guard.hold(tools.stack, self.own, pose.position, &mut lift, velocity);
            let lift = self.traits.free(lift);
            velocity.linear = self.traits.free(velocity.linear);
            pose.position += lift.as_dvec3();
            pay(&mut velocity.linear, self.traits.free(out), -2.0 * self.pull.dot(lift));
            settled.moved = true;
        }
        settled
    }

    /// Greatest depth of the body in static geometry [m], and the direction out of it.
    fn deepest(
        &self,
        guard: &Guard<'_>,
        Tools { stack, scratch, may_grow }: &mut Tools<'_>,
        pose: &Pose,
    ) -> Option<(f32, Vec3)> {
        let mut deepest: Option<(f32, Vec3)> = None;
        let mut note = |depth: f32, out: Vec3| {
            if depth > deepest.map_or(0.0, |(most, _)| most) {
                deepest = Some((depth, out));
            }
        };
        for &c in self.own {
            let shape = &guard.colliders[c as usize];
            if shape.is_sensor() {
                continue;
            }
            let here = pose.of_part(shape.position, shape.rotation);
            let bounds = aabb_of(shape, pose.position, pose.rotation);
            // A shape around its body's centre contains the segments to its ends.
            let mut may_cross = shape.position != Vec3::ZERO;
            guard.broad.in_box(stack, SearchSet::Statics, &bounds, |other| {
                if !guard.may_meet(self.own, other) {
                    return;
                }
                let (still, at) = (&guard.colliders[other as usize], &guard.poses[other as usize]);
                let overlap = self.overlap(shape, &here, still, at, scratch, *may_grow);
                if let Some((depth, into)) = overlap {
                    may_cross = true;
                    note(depth, here.rotation * -into);
                }
            });
            for end in ends_of(shape).filter(|_| may_cross) {
                if let Some((depth, out)) = guard.beyond(stack, self.own, pose.position, pose.rotation * end)
                {
                    note(depth + shape.inner_radius, out);
                }
            }
        }
        deepest
    }

    /// Depth of a shape in a static one [m], and the normal into that, in its own frame; `None` if it is
    /// certainly in nothing, or no deeper in a mesh than it may stay.
    fn overlap(
        &self,
        shape: &Collider,
        here: &Pose,
        still: &Collider,
        at: &Pose,
        scratch: &mut Scratch,
        may_grow: bool,
    ) -> Option<(f32, Vec3)> {
        let back = here.rotation.conjugate();
        let rel = Relative {
            position: back * (at.position - here.position).as_vec3(),
            rotation: back * at.rotation,
        };
        let depth = |raw: &RawManifold| {
            // As deep as a soft contact may be, it is left.
            let allowed = shape.soft_depth(still, raw.material as u8).unwrap_or(0.0);
            raw.points().iter().fold(0.0_f32, |s, p| s.max(-p.separation - allowed))
        };
        if !still.kind.is_ground() {
            let raw = collide_convex(shape, still, &rel, 0.0);
            let raw = out_by_the_centre(shape, still, &rel, &raw, 0.0).unwrap_or(raw);
            return (raw.count > 0).then_some((depth(&raw), raw.normal));
        }
        if may_grow {
            scratch.each(&mut |buffer, len| buffer.reserve_total(len));
        }
        let Scratch { mesh, raw } = scratch;
        raw.clear();
        mesh.allowance = Allowance::new(0);
        mesh.nearby.forget();
        if !collide_mesh(shape, still, &rel, Reach::new(0.0).within(-self.least), mesh, raw) {
            return None;
        }
        let most = raw.iter().map(|raw| (depth(raw), raw.normal));
        let most = most.fold((0.0, Vec3::ZERO), |most, one| if one.0 > most.0 { one } else { most });
        Some(if most.0 > self.least { most } else { mesh.pierced(shape).unwrap_or(most) })
    }
}
