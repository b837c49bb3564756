//! The state of a world that seldom changes: its bodies, shapes and joints. It is written once and then
//! shared by all snapshots until it changes; geometry is shared with the world itself.
//!
//! There are two parts, so that the level is not written anew when a bullet is added or removed: *fixed* has
//! static bodies, with their tree; *moving* has everything else, with joints and the lists of free handles.

use super::checksum::hash;
use super::geometry::{Known, Table, code_of, geometry_of, resolve};
use super::settings::mode_of;
use crate::body::{BodyDetails, BodyKind, Damping, KeptMass, Mass, NewBody, Pose, SpeedCap, Traits};
use crate::broad_phase::{BroadPhase, aabb_of, tree_words};
use crate::error::{Error, within};
use crate::joint::{JointRecords, group_code, group_of};
use crate::lanes::Record;
use crate::limits;
use crate::math::Quat;
use crate::shape::{
    BELT, BaseMaterial, Collider, Combine, EVENTS, Filter, HOOKS, IDLE_DAMPING, Kind, Material, RARE, ROLLS,
    RareMaterial, SENSOR, SOFT, STATICS,
};
use crate::words::{Reader, broken, words};
use crate::world::World;
use glam::{DVec3, Vec3};
use std::sync::OnceLock;

/// Which of the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Which {
    Fixed,
    Moving,
}

/// One of the two, as it is written.
#[derive(Debug)]
pub(crate) struct Part {
    pub(super) words: Vec<u32>,
    pub(super) geometry: Vec<Known>,
    prints: OnceLock<[u64; 2]>,
}

impl Part {
    pub(super) fn new(words: Vec<u32>, geometry: Vec<Known>) -> Part {
        Part { words, geometry, prints: OnceLock::new() }
    }

    /// Fingerprints of the part: one of its content, and one of the tree of static shapes, which also depends
    /// on the order in which they were added between steps.
    pub(super) fn prints(&self) -> [u64; 2] {
        *self.prints.get_or_init(|| {
            let content = (self.words.first().copied().unwrap_or(0) as usize).min(self.words.len());
            let (content, tree) = self.words.split_at(content);
            let geometry = self.geometry.iter().fold(0, |all: u64, one| all.rotate_left(9) ^ one.print());
            [hash(content) ^ geometry, hash(tree)]
        })
    }

    /// The part of static bodies once all of them are in the tree.
    pub(super) fn settled(&self, world: &World) -> Part {
        let content = (self.words.first().copied().unwrap_or(0) as usize).min(self.words.len());
        let mut words = self.words[..content].to_vec();
        world.broad.save_settled_statics(&mut words);
        Part::new(words, self.geometry.clone())
    }

    /// Writes one of the two parts of a world.
    pub(super) fn of(world: &World, which: Which) -> Part {
        let (mut out, mut table) = (vec![0, 0], Table::default());
        let bodies = &world.bodies;
        let first_static = bodies.asleep().end;
        let own = if which == Which::Fixed { first_static..bodies.len() } else { 0..first_static };
        // In the order of slots, which nothing changes.
        for slot in 0..bodies.slots.count() as u32 {
            let index = bodies.slots.dense(slot) as usize;
            if own.contains(&index) {
                save_body(world, index, &mut table, &mut out);
                out[1] += 1;
            }
        }
        if which == Which::Fixed {
            out[0] = out.len() as u32;
            world.broad.save_statics(&mut out);
            return Part::new(out, table.known);
        }
        for slots in [&bodies.slots, &world.colliders.slots] {
            out.push(slots.count() as u32);
            slots.save_free(&mut out);
        }
        world.joints.save_all(&mut out);
        out[0] = out.len() as u32;
        Part::new(out, table.known)
    }
}

fn save_pose(pose: &Pose, out: &mut Vec<u32>) {
    out.extend(words::<6>(pose.position.to_array()));
    out.extend(words::<4>(pose.rotation.to_array()));
}

/// Three numbers, a quaternion.
fn save_frame(position: Vec3, rotation: Quat, out: &mut Vec<u32>) {
    out.extend(words::<3>(position));
    out.extend(words::<4>(rotation.to_array()));
}

fn save_body(world: &World, i: usize, table: &mut Table, out: &mut Vec<u32>) {
    let bodies = &world.bodies;
    let (slot, kind, details, traits, mass) =
        (bodies.slot[i], bodies.kind[i], &bodies.details[i], &bodies.traits[i], &bodies.mass[i]);
    let own = bodies.colliders[i].as_slice();
    let damping = bodies.rare.damping.get(slot);
    let (cap, kept_mass) = (bodies.rare.caps.get(slot), bodies.rare.kept_mass.get(slot));
    out.extend([slot, bodies.slots.generation(slot), own.len() as u32]);
    let bits = [
        kind as u32,
        traits.continuous as u32,
        [traits.sleepless, traits.disabled, damping.is_some(), kept_mass.is_some()]
            .iter()
            .rev()
            .fold(0, |all, &bit| all << 1 | u32::from(bit)),
        u32::from(details.mass_from_shapes) | u32::from(cap.is_some()) << 1,
        group_code(traits.solved_after),
        u32::from(traits.locks) & 15,
        u32::from(traits.locks) >> 4,
    ];
    out.push(bits.iter().rev().fold(0, |all, bits| all << 4 | bits));
    out.extend([traits.gravity_scale.to_bits(), mass.inverse.to_bits(), details.mass.to_bits()]);
    out.extend(words::<6>([mass.inertia, mass.inverse_inertia]));
    save_frame(details.centre, details.axes, out);
    out.extend(words::<2>(details.user_data));
    if let Some(Damping { linear, angular }) = damping {
        out.extend([linear, angular].map(f32::to_bits));
    }
    if let Some(SpeedCap { linear, angular }) = cap {
        out.extend([linear, angular].map(f32::to_bits));
    }
    if let Some(KeptMass { mass, moments }) = kept_mass {
        out.push(mass.to_bits());
        out.extend(words::<3>(moments));
    }
    if kind == BodyKind::Static {
        save_pose(&bodies.pose[i], out);
    }
    for &c in own {
        save_collider(world, c, kind == BodyKind::Static, table, out);
    }
}

fn save_collider(world: &World, c: u32, fixed: bool, table: &mut Table, out: &mut Vec<u32>) {
    let collider = &world.colliders.all[c as usize];
    out.extend([c, world.colliders.slots.generation(c)]);
    let (code, numbers) = code_of(&collider.geometry, table);
    let BaseMaterial {
        static_friction,
        dynamic_friction,
        restitution,
        friction_combine,
        restitution_combine,
    } = collider.material;
    let combine = (friction_combine as u32) << 8 | (restitution_combine as u32) << 12;
    out.push(code | combine | u32::from(collider.flags) << 16);
    out.extend(numbers);
    save_frame(collider.position, collider.rotation, out);
    out.extend([static_friction, dynamic_friction, restitution, collider.density].map(f32::to_bits));
    out.extend(words::<4>([collider.filter.category, collider.filter.mask]));
    out.push(collider.filter.group as u32);
    out.extend(words::<2>(collider.user_data));
    let RareMaterial {
        rolling_friction,
        spinning_friction,
        surface_velocity,
        contact_hertz,
        contact_damping,
    } = world.colliders.rare(c);
    if collider.flags & ROLLS != 0 {
        out.extend([rolling_friction, spinning_friction].map(f32::to_bits));
    }
    if collider.flags & BELT != 0 {
        out.extend(words::<3>(surface_velocity));
    }
    if collider.flags & (SOFT | IDLE_DAMPING) != 0 {
        out.extend([contact_hertz, contact_damping].map(f32::to_bits));
    }
    if fixed {
        save_pose(&world.colliders.poses[c as usize], out);
        world.broad.save_static(c, out);
    }
}

/// A body out of a part.
#[derive(Debug)]
pub(super) struct BodyRecord {
    pub(super) slot: u32,
    pub(super) generation: u32,
    pub(super) body: NewBody,
    pub(super) colliders: Vec<ColliderRecord>,
}

/// A shape out of a part; its body's index is still to be filled in.
#[derive(Debug)]
pub(super) struct ColliderRecord {
    pub(super) index: u32,
    pub(super) generation: u32,
    pub(super) collider: Collider,
    pub(super) rare: RareMaterial,
    /// Pose and box of a static collider.
    pub(super) pose: Pose,
    pub(super) bounds: [u32; 6],
}

impl ColliderRecord {
    /// Whether pose and box of a static shape follow from its body, whose centre of mass is at `centre` in
    /// its axes. They may differ by rounding, after other shapes came and went and moved the centre of mass:
    /// by the more the longer the levers are. Disabled shapes have no box.
    fn is_placed(&self, body: &Pose, centre: Vec3, disabled: bool) -> bool {
        let c = &self.collider;
        let slack = 1e-3 + 1e-5 * (centre.length() + c.position.length());
        let position = body.position + (body.rotation * c.position).as_dvec3();
        let turned = (body.rotation * c.rotation).dot(self.pose.rotation).abs();
        let own = aabb_of(c, body.position, body.rotation);
        let own = words::<6>([own.min, own.max]).map(f32::from_bits);
        let near = |x: f32, y: f32| x == y || (x - y).abs() <= slack + 1e-5 * x.abs();
        self.pose.position.distance(position) <= f64::from(slack) + 1e-5 * position.length()
            && turned > 0.99
            && (disabled || own.iter().zip(self.bounds).all(|(&x, y)| near(x, f32::from_bits(y))))
    }
}

/// Free slots with their generations, and how many slots there are.
#[derive(Debug, Default)]
pub(super) struct FreeSlots {
    pub(super) count: usize,
    pub(super) free: Vec<(u32, u32)>,
}

/// All of both parts.
#[derive(Debug)]
pub(super) struct Records {
    /// Movable and static bodies, each in the order of their slots.
    pub(super) moving: Vec<BodyRecord>,
    pub(super) fixed: Vec<BodyRecord>,
    pub(super) bodies: FreeSlots,
    pub(super) colliders: FreeSlots,
    pub(super) joints: JointRecords,
    /// Static shapes that are not in the tree yet, and the tree.
    pub(super) new: Vec<u32>,
    pub(super) tree: Vec<u32>,
}

impl Records {
    /// Reads both parts, and checks that they fit together.
    pub(super) fn read([fixed, moving]: [&Part; 2], world: &World) -> Result<Records, Error> {
        let geometry = [fixed, moving].map(|part| resolve(&part.geometry, world));
        let [of_fixed, of_moving] = geometry;
        let (of_fixed, of_moving) = (of_fixed?, of_moving?);
        let mut from = Reader(&fixed.words);
        let [_, count]: [u32; 2] = from.record::<_, 2>()?;
        let fixed = read_bodies(&mut from, count, &of_fixed)?;
        let new = from.one()?;
        let new = from.table(new, 1)?.to_vec();
        let nodes = from.one()?;
        let tree = from.take(tree_words(nodes))?.to_vec();
        let mut end = from.0.is_empty();

        let mut from = Reader(&moving.words);
        let [_, count]: [u32; 2] = from.record::<_, 2>()?;
        let moving = read_bodies(&mut from, count, &of_moving)?;
        let (bodies, colliders) = (read_free(&mut from)?, read_free(&mut from)?);
        let all = || fixed.iter().chain(&moving);
        let is = |kind: BodyKind, list: &[BodyRecord]| list.iter().any(|record| record.body.kind == kind);
        let split = !fixed.iter().any(|record| record.body.kind != BodyKind::Static)
            && !is(BodyKind::Static, &moving);
        once(all().map(|record| record.slot), &bodies)?;
        once(all().flat_map(|record| record.colliders.iter().map(|c| c.index)), &colliders)?;
        let mut taken = vec![false; bodies.count];
        all().for_each(|record| taken[record.slot as usize] = true);
        // A joint needs a dynamic body when it is added; that may have become one of another kind since.
        let may_be_joined = |slot: u32| taken.get(slot as usize).copied().filter(|&taken| taken);
        let joints = JointRecords::read(&mut from, may_be_joined)?;
        end &= from.0.is_empty();
        if !split || !end {
            return Err(broken("a list of bodies"));
        }
        let mut bounded = vec![false; colliders.count];
        for c in fixed.iter().flat_map(|record| &record.colliders) {
            bounded[c.index as usize] = c.collider.kind != Kind::Plane && BroadPhase::is_bounded(&c.bounds);
        }
        BroadPhase::check_statics(&new, &tree, &bounded)?;
        Ok(Records { moving, fixed, bodies, colliders, joints, new, tree })
    }
}

/// Whether each slot is taken or free, once.
fn once(taken: impl Iterator<Item = u32>, slots: &FreeSlots) -> Result<(), Error> {
    let mut seen: Vec<u32> = taken.chain(slots.free.iter().map(|(slot, _)| *slot)).collect();
    seen.sort_unstable();
    if seen.iter().copied().eq(0..slots.count as u32) { Ok(()) } else { Err(broken("a list of handles")) }
}

fn read_free(from: &mut Reader<'_>) -> Result<FreeSlots, Error> {
    Ok(FreeSlots { count: from.one()? as usize, free: from.free_slots()? })
}

/// Reads a pose and checks that it is valid.
pub(super) fn read_pose(from: &mut Reader<'_>) -> Result<Pose, Error> {
    let position = DVec3::from_array(from.record::<[f64; 3], 6>()?);
    let rotation = from.rotation("a pose")?;
    limits::centre(position)?;
    Ok(Pose { position, rotation })
}

fn read_frame(from: &mut Reader<'_>) -> Result<(Vec3, Quat), Error> {
    let position = from.finite::<Vec3, 3>()?;
    limits::lever("frame", position)?;
    Ok((position, from.rotation("a frame")?))
}

fn read_bodies(
    from: &mut Reader<'_>,
    count: u32,
    geometry: &[crate::shape::Geometry],
) -> Result<Vec<BodyRecord>, Error> {
    (0..count).map(|_| read_body(from, geometry)).collect()
}

fn read_body(from: &mut Reader<'_>, geometry: &[crate::shape::Geometry]) -> Result<BodyRecord, Error> {
    let [slot, generation, own, bits]: [u32; 4] = from.record::<_, 4>()?;
    let part = |i: u32| bits >> (4 * i) & 15;
    let kinds = [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic];
    let kind =
        kinds.into_iter().find(|&kind| kind as u32 == part(0)).ok_or_else(|| broken("a kind of body"))?;
    let [gravity_scale, inverse, mass]: [f32; 3] = from.finite::<_, 3>()?;
    let [inertia, inverse_inertia]: [Vec3; 2] = from.finite::<_, 6>()?;
    let (centre, axes) = read_frame(from)?;
    let user_data = from.long()?;
    limits::acceleration("gravity scale", Vec3::splat(gravity_scale))?;
    // As `columns_of` makes them.
    let over = |x: f32| if x > 0.0 { 1.0 / x } else { 0.0 };
    let fits = if kind == BodyKind::Dynamic {
        let most = 2.0 * limits::MAX_MASS;
        let moments = inertia.to_array().iter().all(|x| *x == 0.0 || (1.0 / most..=most).contains(x));
        limits::inertia("mass", mass)?;
        moments && inverse == over(mass) && inverse_inertia == inertia.map(over)
    } else {
        [inverse, mass] == [0.0; 2] && [inertia, inverse_inertia] == [Vec3::ZERO; 2]
    };
    if !fits {
        return Err(broken("a mass"));
    }
    let traits = Traits {
        gravity_scale,
        continuous: mode_of(part(1))?,
        locks: (part(5) | (part(6) & 3) << 4) as u8,
        solved_after: group_of(part(4))?,
        sleepless: part(2) & 1 != 0,
        disabled: part(2) >> 1 & 1 != 0,
    };
    let mass_from_shapes = part(3) & 1 != 0;
    let damping = if part(2) >> 2 & 1 != 0 { read_damping(from)? } else { Damping::default() };
    let cap = if part(3) >> 1 != 0 { read_cap(from)? } else { SpeedCap::NONE };
    let kept_mass = if part(2) >> 3 != 0 { Some(read_kept_mass(from)?) } else { None };
    if kept_mass.is_some() != (kind != BodyKind::Dynamic && !mass_from_shapes) {
        return Err(broken("a mass"));
    }
    let pose = if kind == BodyKind::Static {
        read_pose(from)?
    } else {
        Pose { position: DVec3::ZERO, rotation: Quat::IDENTITY }
    };
    let colliders = (0..own).map(|_| read_collider(from, kind, geometry)).collect::<Result<Vec<_>, _>>()?;
    if kind == BodyKind::Static && !colliders.iter().all(|c| c.is_placed(&pose, centre, traits.disabled)) {
        return Err(broken("the place of a static shape"));
    }
    let details = BodyDetails { centre, axes, mass, mass_from_shapes, user_data };
    let mass = Mass { inverse, inertia, inverse_inertia };
    let velocity = Record::default();
    let body = NewBody { kind, pose, velocity, mass, traits, details, damping, cap, kept_mass };
    Ok(BodyRecord { slot, generation, body, colliders })
}

fn read_damping(from: &mut Reader<'_>) -> Result<Damping, Error> {
    let [linear, angular]: [f32; 2] = from.finite::<_, 2>()?;
    limits::damping("linear damping", linear)?;
    limits::damping("angular damping", angular)?;
    Ok(Damping { linear, angular })
}

fn read_cap(from: &mut Reader<'_>) -> Result<SpeedCap, Error> {
    let [linear, angular]: [f32; 2] = from.record::<_, 2>()?;
    let cap = SpeedCap { linear, angular };
    let bound = |cap: f32| cap == f32::INFINITY || (0.0..=limits::MAX_SPEED).contains(&cap);
    if bound(linear) && bound(angular) && cap != SpeedCap::NONE { Ok(cap) } else { Err(broken("a speed")) }
}

fn read_kept_mass(from: &mut Reader<'_>) -> Result<KeptMass, Error> {
    let [mass]: [f32; 1] = from.finite::<_, 1>()?;
    let moments = from.finite::<Vec3, 3>()?;
    let fits = mass > 0.0 && moments.min_element() >= 0.0;
    if fits { Ok(KeptMass { mass, moments }) } else { Err(broken("a mass")) }
}

/// Flags of a shape that may have them.
fn flags_of(bits: u32, geometry: &crate::shape::Geometry) -> Result<u8, Error> {
    let flags = bits as u8;
    let known = bits <= u32::from(SENSOR | EVENTS | HOOKS | STATICS | RARE);
    let senses = flags & SENSOR == 0 || Kind::of(geometry) == Kind::Plane || Kind::of(geometry).is_convex();
    if known && senses { Ok(flags) } else { Err(broken("what a shape is for")) }
}

fn read_collider(
    from: &mut Reader<'_>,
    kind: BodyKind,
    known: &[crate::shape::Geometry],
) -> Result<ColliderRecord, Error> {
    let [index, generation, code]: [u32; 3] = from.record::<_, 3>()?;
    let geometry = geometry_of(code & 0xff, from.take(4)?, known)?;
    geometry.validate()?;
    if kind == BodyKind::Dynamic {
        geometry.require_convex()?;
    }
    let flags = flags_of(code >> 16, &geometry)?;
    let (position, rotation) = read_frame(from)?;
    let [static_friction, dynamic_friction, restitution, density]: [f32; 4] = from.finite::<_, 4>()?;
    let combine = |code: u32| {
        let all = [Combine::Average, Combine::Minimum, Combine::Maximum, Combine::Multiply];
        all.into_iter().find(|&how| how as u32 == code).ok_or_else(|| broken("a material"))
    };
    let base = BaseMaterial {
        static_friction,
        dynamic_friction,
        restitution,
        friction_combine: combine(code >> 8 & 15)?,
        restitution_combine: combine(code >> 12 & 15)?,
    };
    within("density", density, 0.0, limits::MAX_DENSITY, "in 0..=1e15")?;
    let [category, mask]: [u64; 2] = from.record::<_, 4>()?;
    let filter = Filter { category, mask, group: from.one()? as i32 };
    let user_data = from.long()?;
    let mut rare = RareMaterial::default();
    {
        // No field is left out by `..`: a new field must be read here.
        let RareMaterial {
            rolling_friction,
            spinning_friction,
            surface_velocity,
            contact_hertz,
            contact_damping,
        } = &mut rare;
        if flags & ROLLS != 0 {
            [*rolling_friction, *spinning_friction] = from.finite::<[f32; 2], 2>()?;
        }
        if flags & BELT != 0 {
            *surface_velocity = from.finite::<Vec3, 3>()?;
        }
        if flags & (SOFT | IDLE_DAMPING) != 0 {
            [*contact_hertz, *contact_damping] = from.finite::<[f32; 2], 2>()?;
        }
    }
    Material::of(base, rare).validate()?;
    if rare.flags() | geometry.rare_flags() != flags & RARE {
        return Err(broken("a material"));
    }
    let collider = Collider {
        position,
        rotation,
        material: base,
        filter,
        density,
        flags,
        user_data,
        ..Collider::new(geometry)
    };
    let fixed = kind == BodyKind::Static;
    let nowhere = Pose { position: DVec3::ZERO, rotation: Quat::IDENTITY };
    let pose = if fixed { read_pose(from)? } else { nowhere };
    let bounds: [u32; 6] = if fixed { from.record::<_, 6>()? } else { [0; 6] };
    Ok(ColliderRecord { index, generation, collider, rare, pose, bounds })
}
