//! The state of a world as numbers: displaced by a vector, and the difference of two.

use crate::handle::BodyHandle;
use crate::lanes::Record;
use crate::math::Quat;
use crate::narrow_phase::{ContactMut, ContactRef, MAX_POINTS, NO_CONTACT};
use crate::world::World;
use glam::{DQuat, DVec3, Vec3};
use std::collections::BTreeMap;

/// A contact at rest: two colliders and which of their contacts.
type Name = (u32, u32, u32);

/// State variables of a contact beside the impulses of its points: friction and twist. Its lasting force is
/// not among them: it does not change as long as the load is close to it.
const OTHERS: usize = 4;

/// Where the variables of a contact are in the state, and the positions of its loaded points in the frame of
/// shape `a`.
#[derive(Debug)]
struct Bearing {
    first: usize,
    places: Vec<Vec3>,
}

impl Bearing {
    fn numbers(&self) -> usize {
        self.places.len() + OTHERS
    }

    /// Matches each point of a contact with the nearest point that is not matched yet. Keys do not do: when
    /// the other box's face becomes the reference, a contact has the same points under other keys.
    fn same(&self, contact: ContactRef<'_>) -> [Option<usize>; MAX_POINTS] {
        let mut same = [None; MAX_POINTS];
        let mut free: Vec<usize> = (0..self.places.len()).collect();
        for (same, point) in same.iter_mut().zip(contact.points()).filter(|(_, p)| p.impulse > 0.0) {
            let near = |i: &usize| self.places[*i].distance_squared(point.position);
            let nearest = (0..free.len()).min_by(|&i, &k| near(&free[i]).total_cmp(&near(&free[k])));
            *same = nearest.map(|i| free.remove(i));
        }
        same
    }
}

/// Calls `visit` for each contact, in the order of pairs.
fn each_contact(world: &mut World, mut visit: impl FnMut(Name, &mut ContactMut<'_>)) {
    let World { broad, contacts, .. } = world;
    for pair in &broad.pairs {
        let (mut slot, mut nth) = (pair.contact, 0);
        while slot != NO_CONTACT {
            let mut contact = contacts.at_mut(slot);
            visit((contact.a, contact.b, nth), &mut contact);
            (slot, nth) = (contact.next, nth + 1);
        }
    }
}

/// Calls `visit` for each number that joints carry over to the next step, in their order.
fn each_of_joints(world: &mut World, mut visit: impl FnMut(&mut f32)) {
    for lock in &mut world.joints.locks {
        lock.impulse.as_mut().iter_mut().for_each(&mut visit);
        visit(&mut lock.lasting_impulse);
        visit(&mut lock.steady);
    }
    for row in &mut world.joints.rows {
        row.impulse.iter_mut().for_each(&mut visit);
        visit(&mut row.lasting_impulse);
    }
}

/// State variables of a body, three each: position, rotation, linear and angular velocity.
pub const BODY_VARIABLES: usize = 12;

// Guard: keeps the unit of impulse far above rounding of poses.
/// The unit of impulse is the weight of this many bodies over a substep: contacts are stiff, and rounding of
/// poses alone shifts their loads by a thousandth of a weight. A displacement of 5e-5 is then 0.5 % of one.
const STIFF: f64 = 100.0;

/// Which variables make up the state, and their units. Bodies come first, then the impulses of contact points
/// that are loaded at rest (the impulse of an unloaded point can only rise, which is not linear), then those
/// of joints.
#[derive(Debug)]
pub struct StateLayout {
    bodies: usize,
    contacts: BTreeMap<Name, Bearing>,
    /// Where the variables of joints begin, and where all end.
    joints: usize,
    end: usize,
    /// [m], [s], [N s].
    length: f64,
    time: f64,
    impulse: f64,
}

impl StateLayout {
    /// The state of a world at rest. `h`: length of a substep [s].
    pub fn of(world: &mut World, h: f32) -> StateLayout {
        let bodies = world.bodies.dynamic();
        let mut contacts = BTreeMap::new();
        let mut end = BODY_VARIABLES * bodies;
        each_contact(world, |name, contact| {
            let bears = contact.as_ref().points().iter().filter(|p| p.impulse > 0.0);
            let places: Vec<Vec3> = bears.map(|p| p.position).collect();
            if !places.is_empty() {
                let bearing = Bearing { first: end, places };
                end += bearing.numbers();
                contacts.insert(name, bearing);
            }
        });
        let joints = end;
        each_of_joints(world, |_| end += 1);
        let masses = world.bodies.mass[..bodies].iter().map(|m| m.inverse).filter(|&m| m > 0.0);
        let (sum, count) = masses.fold((0.0, 0), |(sum, count), m| (sum + 1.0 / f64::from(m), count + 1));
        let length = f64::from(world.settings.length_unit);
        let g = f64::from(world.settings.gravity.length());
        let g = if g > 0.0 { g } else { 9.81 };
        let impulse = STIFF * sum / f64::from(count.max(1)) * g * f64::from(h);
        StateLayout { bodies, contacts, joints, end, length, time: (length / g).sqrt(), impulse }
    }

    /// Number of variables.
    pub fn variables(&self) -> usize {
        self.end
    }

    /// Calls `visit` for each impulse of the state with its index, unit, least value, and the impulse itself.
    /// Returns how many contacts and points are loaded but not part of the state, or part of it but not
    /// loaded.
    fn each_impulse(&self, world: &mut World, mut visit: impl FnMut(usize, f64, f64, &mut f32)) -> usize {
        let (mut met, mut changed) = (0, 0);
        each_contact(world, |name, contact| {
            let bears = contact.as_ref().points().iter().filter(|p| p.impulse > 0.0).count();
            let Some(bearing) = self.contacts.get(&name) else {
                changed += bears;
                return;
            };
            let same = bearing.same(contact.as_ref());
            for (point, same) in contact.points_mut().iter_mut().zip(same) {
                let Some(at) = same else { continue };
                let at = bearing.first + at;
                // Contacts push.
                visit(at, self.impulse, 0.0, &mut point.impulse);
            }
            let known = same.iter().flatten().count();
            (met, changed) = (met + known, changed + bears - known);
            let at = bearing.first + bearing.places.len();
            for (i, value) in contact.friction.as_mut().iter_mut().enumerate() {
                visit(at + i, self.impulse, f64::NEG_INFINITY, value);
            }
            visit(at + 3, self.impulse * self.length, f64::NEG_INFINITY, &mut contact.twist);
        });
        let mut at = self.joints;
        each_of_joints(world, |value| {
            visit(at, self.impulse, f64::NEG_INFINITY, value);
            at += 1;
        });
        let expected: usize = self.contacts.values().map(|c| c.places.len()).sum();
        changed + expected - met
    }

    /// Adds `scale` times `v` to the state.
    pub fn displace(&self, world: &mut World, v: &[f64], scale: f64) {
        let (chunks, _) = v[..BODY_VARIABLES * self.bodies].as_chunks::<BODY_VARIABLES>();
        for (i, d) in chunks.iter().enumerate() {
            let at = |k: usize| DVec3::new(d[k], d[k + 1], d[k + 2]) * scale;
            let pose = &mut world.bodies.pose[i];
            pose.position += at(0) * self.length;
            let turn = DQuat::from_scaled_axis(at(3));
            pose.rotation = (turn * pose.rotation.as_dquat()).normalize().into();
            let Record { linear, angular, .. } = &mut world.bodies.velocity[i];
            let add = |v: &mut Vec3, d: DVec3| *v = (v.as_dvec3() + d).as_vec3();
            add(linear, at(6) * (self.length / self.time));
            add(angular, at(9) / self.time);
        }
        self.each_impulse(world, |at, unit, least, value| {
            *value = (f64::from(*value) + v[at] * scale * unit).max(least) as f32;
        });
    }

    /// The difference of `plus` and `minus`, and how many points are loaded in only one of a world and rest.
    pub fn difference(&self, plus: &mut World, minus: &mut World) -> (Vec<f64>, usize) {
        let mut out = Vec::with_capacity(self.variables());
        for i in 0..self.bodies {
            let [p, m] = [&*plus, &*minus].map(|world| (&world.bodies.pose[i], &world.bodies.velocity[i]));
            let turned = |q: Quat| q.as_dquat().normalize();
            let turn = turned(p.0.rotation) * turned(m.0.rotation).conjugate();
            let turn = if turn.w < 0.0 { -turn } else { turn };
            let speed = self.time / self.length;
            for three in [
                (p.0.position - m.0.position) / self.length,
                turn.to_scaled_axis(),
                (p.1.linear.as_dvec3() - m.1.linear.as_dvec3()) * speed,
                (p.1.angular.as_dvec3() - m.1.angular.as_dvec3()) * self.time,
            ] {
                out.extend(three.to_array());
            }
        }
        out.resize(self.variables(), 0.0);
        let mut changed = 0;
        for (world, sign) in [(plus, 1.0), (minus, -1.0)] {
            changed +=
                self.each_impulse(world, |at, unit, _, value| out[at] += sign * f64::from(*value) / unit);
        }
        (out, changed)
    }

    /// The bodies of the state, in its order.
    pub fn bodies(&self, world: &World) -> Vec<BodyHandle> {
        (0..self.bodies).map(|i| world.handle_of(i)).collect()
    }
}
