//! The data of contacts for a batch, looked up contact by contact and transposed for the lanes.

use super::batch::lock_bits;
use super::input::PrepareInput;
use super::soft::bodies::moves_by_mean;
use crate::config::tuning::THIN_SLOP;
use crate::constraint::articulation::slots::{TreeSlot, TreeSlots};
use crate::constraint::schedule::part::Part;
use crate::constraint::tweak_of;
use crate::lanes::{Lanes, Sym3, Vec3, kernel, ones};
use crate::narrow_phase::{ContactRef, Point, most_points};
use crate::shape::{BELT, Collider, EVENTS, Kind, ROLLS};
use bytemuck::Zeroable;

/// A column of eight lanes for each number. Inert lanes are zero.
#[derive(Zeroable)]
pub(super) struct Columns<const P: usize> {
    /// Bodies, contacts and bits of the lanes: see [`Batch`](super::batch::Batch).
    pub(super) a: [u32; 8],
    pub(super) b: [u32; 8],
    pub(super) contact: [Part; 8],
    pub(super) write: [u8; 2],
    pub(super) swapped: u8,
    pub(super) heard: u8,
    pub(super) rotation: [[f32; 8]; 4],
    pub(super) normal: [[f32; 8]; 3],
    /// From the batch's body a to the origin of the contact's shape a, at the time of the contact.
    pub(super) origin: [[f32; 8]; 3],
    /// From the batch's body b to its body a, at the time of the contact.
    pub(super) to_b: [[f32; 8]; 3],
    pub(super) sign: [f32; 8],
    pub(super) inverse_mass: [[f32; 8]; 2],
    pub(super) locks: [u32; 2],
    pub(super) inverse_inertia: [[[f32; 8]; 6]; 2],
    pub(super) position: [[[f32; 8]; 3]; P],
    pub(super) separation: [[f32; 8]; P],
    pub(super) impulse: [[f32; 8]; P],
    pub(super) lasting: [[f32; 8]; P],
    pub(super) rest: [f32; 8],
    pub(super) reach: [f32; 8],
    pub(super) present: [[f32; 8]; P],
    pub(super) friction: [[f32; 8]; 3],
    pub(super) twist: [f32; 8],
    /// Static and dynamic.
    pub(super) coefficient: [[f32; 8]; 2],
    /// By which the surface of b moves past that of a, in the world [m/s].
    pub(super) past: [[f32; 8]; 3],
    /// Lever arms of the load against rolling and spinning [m], and the impulse against rolling on b, in the
    /// world [N m s].
    pub(super) roll_arms: [[f32; 8]; 2],
    pub(super) rolling: [[f32; 8]; 3],
    /// Some lane resists rolling or spinning.
    pub(super) rolls: bool,
}

/// The same for soft contacts, of which most scenes have none.
#[derive(Default)]
pub(super) struct SpringColumns {
    /// See [`SoftRow`](super::soft::SoftRow).
    pub(super) soft: [f32; 8],
    pub(super) start_share: [f32; 8],
    pub(super) stop: [f32; 8],
    /// Frequency [Hz] and damping ratio of the contact's spring, and the share of each of its points.
    pub(super) hertz: [f32; 8],
    pub(super) zeta: [f32; 8],
    pub(super) point_share: [f32; 8],
    /// Acceleration: linear, of body b as seen from body a [m/s²]; angular, of body a and of body b [rad/s²].
    pub(super) pull: [[[f32; 8]; 3]; 3],
    /// Some lane is soft.
    pub(super) softens: bool,
}

fn put3(columns: &mut [[f32; 8]; 3], lane: usize, v: glam::Vec3) {
    for (column, x) in columns.iter_mut().zip(v.to_array()) {
        column[lane] = x;
    }
}

#[inline(always)]
pub(super) fn vec3<L: Lanes>(columns: &[[f32; 8]; 3]) -> Vec3<L> {
    Vec3::new(L::load(&columns[0]), L::load(&columns[1]), L::load(&columns[2]))
}

#[inline(always)]
pub(super) fn sym3<L: Lanes>(c: &[[f32; 8]; 6]) -> Sym3<L> {
    let (xx, yy, zz) = (L::load(&c[0]), L::load(&c[1]), L::load(&c[2]));
    Sym3 { xx, yy, zz, xy: L::load(&c[3]), xz: L::load(&c[4]), yz: L::load(&c[5]) }
}

/// A contact, or some of its points, to be entered into a lane.
struct Entry<'a> {
    lane: usize,
    part: Part,
    contact: ContactRef<'a>,
    shape_a: &'a Collider,
    shape_b: &'a Collider,
    /// The bodies of the lane. `a` is one that can be pushed; `swap`: it is the contact's `b`.
    a: u32,
    b: u32,
    swap: bool,
}

kernel! {
    /// Looks up one lane after another: each contact is touched once, and the arithmetic is left to the
    /// lanes.
    ///
    /// A function of its own: this is most of the code that makes a batch, and the same for any bodies `b`.
    pub(super) fn gather<'a, L: Lanes, const P: usize>(
        parts: &'a [Part],
        touching: bool,
        tree_slots: Option<&'a TreeSlots>,
        springs: Option<&'a mut SpringColumns>,
        input: &'a PrepareInput<'a>,
    ) -> Columns<P> {
        Columns::of(parts, touching, tree_slots, springs, input)
    }
}

impl<const P: usize> Columns<P> {
    #[inline(always)]
    fn of(
        parts: &[Part],
        touching: bool,
        tree_slots: Option<&TreeSlots>,
        mut springs: Option<&mut SpringColumns>,
        input: &PrepareInput<'_>,
    ) -> Columns<P> {
        let mut out: Self =
            Columns { contact: [Part::NONE; 8], separation: [[f32::INFINITY; 8]; P], ..Zeroable::zeroed() };
        let dynamic = input.bodies.dynamic() as u32;
        let mut first = 0;
        for (place, &part) in parts.iter().enumerate() {
            let contact = input.contacts.at(part.slot() as u32);
            let (shape_a, shape_b) =
                (&input.colliders.all[contact.a as usize], &input.colliders.all[contact.b as usize]);
            let swap = shape_a.body >= dynamic;
            let (a, b) = if swap { (shape_b.body, shape_a.body) } else { (shape_a.body, shape_b.body) };
            let lane =
                tree_slots.and_then(|tree_slots| tree_slots.of(a as usize)).map_or(place, TreeSlot::lane);
            if place == 0 {
                first = lane;
            }
            let entry = Entry { lane, part, contact, shape_a, shape_b, a, b, swap };
            out.put_frame(&entry, input);
            out.put_bodies(&entry, input);
            out.put_points(&entry, input);
            if touching {
                out.put_friction_impulse(&entry, input);
                if input.beside.rolling && (shape_a.flags | shape_b.flags) & ROLLS != 0 {
                    out.put_rolling(&entry, input);
                }
            }
            if input.beside.surfaces {
                out.put_surface(&entry, input);
            }
            if let Some(springs) = &mut springs {
                springs.put(&entry, input);
            }
            out.heard |= u8::from((shape_a.flags | shape_b.flags) & EVENTS != 0) << lane;
            if input.friction {
                let mut friction = if contact.material == 0 {
                    shape_a.material.friction_with(&shape_b.material)
                } else {
                    shape_a.material.friction_with(&shape_b.surface(contact.material))
                };
                if !input.tweaks.is_empty() {
                    friction = tweak_of(input.tweaks, part.slot()).friction_or(friction);
                }
                let (sticking, sliding) = friction;
                (out.coefficient[0][lane], out.coefficient[1][lane]) = (sticking, sliding);
            }
        }
        for lane in (0..8).filter(|&lane| out.contact[lane] == Part::NONE) {
            (out.a[lane], out.b[lane]) = (out.a[first], out.b[first]);
        }
        out
    }

    /// Position and normal of the contact.
    #[inline(always)]
    fn put_frame(&mut self, entry: &Entry<'_>, input: &PrepareInput<'_>) {
        let &Entry { lane, contact, shape_a, shape_b, swap, .. } = entry;
        let pose = &input.colliders.poses[contact.a as usize];
        let at = |body: u32| &input.bodies.pose[body as usize].position;
        let own = (pose.position - *at(shape_a.body)).as_vec3();
        let between = if contact.fraction > 0.0 {
            let moved =
                |body: u32| input.forces.motion.get(body as usize).map_or(glam::Vec3::ZERO, |m| m.linear);
            (*at(shape_a.body) - *at(shape_b.body)).as_vec3()
                + (moved(shape_a.body) - moved(shape_b.body)) * contact.fraction
        } else {
            // As the shapes stood when the contact was found.
            let own_b = (input.colliders.poses[contact.b as usize].position - *at(shape_b.body)).as_vec3();
            own_b - own - contact.frame * contact.found_at.position
        };
        put3(&mut self.origin, lane, if swap { own + between } else { own });
        put3(&mut self.to_b, lane, if swap { -between } else { between });
        self.sign[lane] = if swap { -1.0 } else { 1.0 };
        put3(&mut self.normal, lane, contact.normal);
        for (column, x) in self.rotation.iter_mut().zip(contact.frame.to_array()) {
            column[lane] = x;
        }
    }

    #[inline(always)]
    fn put_bodies(&mut self, entry: &Entry<'_>, input: &PrepareInput<'_>) {
        let &Entry { lane, part, a, b, swap, .. } = entry;
        let (dynamic, movers) = (input.bodies.dynamic() as u32, input.bodies.movers() as u32);
        self.contact[lane] = part;
        self.swapped |= u8::from(swap) << lane;
        self.write[0] |= u8::from(a < dynamic) << lane;
        self.write[1] |= u8::from(b < dynamic) << lane;
        // A static body has no record: its velocity is never used.
        (self.a[lane], self.b[lane]) = (a, if b < movers { b } else { a });
        for (side, body) in [a, b].into_iter().enumerate() {
            if let Some(i) = input.forces.inverse_inertia.get(body as usize) {
                self.inverse_mass[side][lane] = input.bodies.mass[body as usize].inverse;
                if input.bodies.locked > 0 {
                    self.locks[side] |= lock_bits(input.bodies.traits[body as usize].locks, lane);
                }
                for (column, x) in
                    self.inverse_inertia[side].iter_mut().zip([i.xx, i.yy, i.zz, i.xy, i.xz, i.yz])
                {
                    column[lane] = x;
                }
            }
        }
    }

    #[inline(always)]
    fn put_points(&mut self, entry: &Entry<'_>, input: &PrepareInput<'_>) {
        let &Entry { lane, part, contact, shape_a, shape_b, .. } = entry;
        let points = part.points(contact);
        let mut lasting = contact.lasting_force * input.lengths.now();
        let carried = |p: &Point| input.lengths.carry(p.impulse, p.mean_force).max(0.0);
        // If some points were left out, the others bear their loads.
        let (mut load, mut missing) = (1.0, 0.0);
        if part.is_cut() {
            let kept =
                |of: &dyn Fn(&Point) -> f32| ones(points).map(|i| of(&contact.points()[i])).sum::<f32>();
            let all: f32 = contact.points().iter().map(carried).sum();
            let (own, share) = (kept(&carried), kept(&|p| p.share));
            if own > 0.0 {
                load = all / own
            } else {
                missing = all / points.count_ones() as f32
            }
            lasting = if share > 0.0 { lasting / share } else { 0.0 };
        }
        let thinnest = shape_a.thickness().min(shape_b.thickness());
        [self.rest[lane], self.reach[lane]] = contact.spring(input.measures.slop.min(THIN_SLOP * thinnest));
        for (i, point) in ones(points).map(|i| &contact.points()[i]).enumerate().take(P) {
            put3(&mut self.position[i], lane, point.position);
            self.separation[i][lane] = point.separation;
            let borne = carried(point);
            self.impulse[i][lane] = if part.is_cut() { borne * load + missing } else { borne };
            self.lasting[i][lane] = point.share * lasting;
            self.present[i][lane] = 1.0;
        }
    }

    /// Friction was stored for the whole contact; its points share it by their load.
    #[inline(always)]
    fn put_friction_impulse(&mut self, entry: &Entry<'_>, input: &PrepareInput<'_>) {
        let &Entry { lane, part, contact, .. } = entry;
        let total: f32 = contact.points().iter().map(|p| p.impulse).sum();
        let share =
            part.only().map_or(1.0, |p| if total > 0.0 { contact.points()[p].impulse / total } else { 0.0 });
        let carried =
            input.lengths.carry(contact.friction.extend(contact.twist), contact.mean_friction.into());
        put3(&mut self.friction, lane, carried.truncate() * share);
        self.twist[lane] = carried.w;
    }

    /// The velocities of both surfaces, by their materials and by hooks.
    #[inline(never)]
    fn put_surface(&mut self, entry: &Entry<'_>, input: &PrepareInput<'_>) {
        let &Entry { lane, part, contact, shape_a, shape_b, swap, .. } = entry;
        let moves = |c: u32, shape: &Collider, part: u8| {
            if shape.flags & BELT == 0 {
                return glam::Vec3::ZERO;
            }
            input.colliders.poses[c as usize].rotation * input.rare_of(c, part).surface_velocity
        };
        let of_materials = moves(contact.b, shape_b, contact.material) - moves(contact.a, shape_a, 0);
        let past = tweak_of(input.tweaks, part.slot()).surface + of_materials;
        put3(&mut self.past, lane, if swap { -past } else { past });
    }

    /// The larger lever arms of both materials, and the impulse of the last step.
    #[inline(never)]
    fn put_rolling(&mut self, entry: &Entry<'_>, input: &PrepareInput<'_>) {
        let &Entry { lane, part, contact, swap, .. } = entry;
        let (a, b) = (input.rare_of(contact.a, 0), input.rare_of(contact.b, contact.material));
        self.rolls = true;
        self.roll_arms[0][lane] = a.rolling_friction.max(b.rolling_friction);
        self.roll_arms[1][lane] = a.spinning_friction.max(b.spinning_friction);
        let last = input.contacts.rolling(part.slot() as u32);
        let carried = input.lengths.carry(last.extend(0.0), glam::Vec4::ZERO).truncate();
        put3(&mut self.rolling, lane, if swap { -carried } else { carried });
    }
}

impl SpringColumns {
    /// The spring of the softer material, and the accelerations of both bodies.
    #[inline(never)]
    fn put(&mut self, entry: &Entry<'_>, input: &PrepareInput<'_>) {
        let &Entry { lane, contact, shape_a, shape_b, a, b, .. } = entry;
        let Some(depth) = shape_a.soft_depth(shape_b, contact.material) else { return };
        let (of_a, of_b) = (input.rare_of(contact.a, 0), input.rare_of(contact.b, contact.material));
        self.softens = true;
        self.soft[lane] = 1.0;
        self.stop[lane] = depth;
        (self.hertz[lane], self.zeta[lane]) = of_a.spring_with(&of_b);
        let facing = |shape: &Collider| {
            if shape.kind.is_ground() { Kind::Plane } else { shape.kind }
        };
        self.point_share[lane] = 1.0 / most_points(facing(shape_a), facing(shape_b)) as f32;
        let dynamic = input.bodies.dynamic();
        let mean = [a, b].into_iter().all(|body| moves_by_mean(input.marks, body, dynamic));
        self.start_share[lane] = if mean { 0.5 } else { 0.0 };
        let pull = |body: u32| {
            let moves = (body as usize) < dynamic;
            input.forces.acceleration.get(body as usize).copied().filter(|_| moves).unwrap_or_default()
        };
        let (on_a, on_b) = (pull(a), pull(b));
        put3(&mut self.pull[0], lane, on_b.linear - on_a.linear);
        put3(&mut self.pull[1], lane, on_a.angular);
        put3(&mut self.pull[2], lane, on_b.angular);
    }
}
