//! Body columns. Dense: dynamic bodies first, then kinematic, then dynamic ones that are asleep, then static
//! ones, so that every loop over moving bodies is a loop over a prefix, and sleeping bodies cost no more than
//! static ones. Disabled movable bodies share the range of sleeping ones.

use super::rare::{Damping, KeptMass, RareColumns, SpeedCap};
use super::{BodyKind, ColliderList, Colliders, Pose};
use crate::config::ContinuousMode;
use crate::config::{Order, RowGroup};
use crate::handle::{BodyHandle, Slots};
use crate::lanes::Record;
use crate::math::Quat;
use crate::memory::{Allowance, Buffer, add_bytes, bytes_of};
use glam::{DVec3, Vec3};

/// Inverse mass, and principal moments of inertia with their inverses; zero where a body can't be moved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Mass {
    pub(crate) inverse: f32,
    pub(crate) inertia: Vec3,
    pub(crate) inverse_inertia: Vec3,
}

/// Details of a body that a step reads seldom.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyDetails {
    /// From the body's origin to its centre of mass, in the body's axes [m].
    pub(crate) centre: Vec3,
    /// Principal axes in the body's axes.
    pub(crate) axes: Quat,
    /// Given or computed, before locks [kg].
    pub(crate) mass: f32,
    /// Whether mass comes from the shapes.
    pub(crate) mass_from_shapes: bool,
    pub(crate) user_data: u64,
}

impl BodyDetails {
    /// The pose of the centre of mass while the body's origin has this one.
    pub(crate) fn pose_at(&self, position: DVec3, rotation: Quat) -> Pose {
        Pose {
            position: position + (rotation * self.centre).as_dvec3(),
            rotation: (rotation * self.axes).normalize(),
        }
    }

    /// Position and rotation of the body's origin while the centre of mass has this pose.
    #[inline]
    pub(crate) fn origin_at(&self, pose: &Pose) -> (DVec3, Quat) {
        let rotation = pose.rotation * self.axes.conjugate();
        (pose.position - (rotation * self.centre).as_dvec3(), rotation)
    }
}

/// Flags of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Traits {
    pub(crate) gravity_scale: f32,
    pub(crate) continuous: ContinuousMode,
    /// Bits 0-2: translation along x, y, z is locked; 3-5: rotation about x, y, z.
    pub(crate) locks: u8,
    /// Which rows its own come after.
    pub(crate) solved_after: Option<RowGroup>,
    /// It never sleeps.
    pub(crate) sleepless: bool,
    /// It takes part in nothing.
    pub(crate) disabled: bool,
}

impl Traits {
    /// Takes away the velocity along and about locked axes.
    #[inline]
    pub(crate) fn lock(&self, v: &mut Record) {
        for axis in 0..3 {
            if self.locks >> axis & 1 != 0 {
                v.linear[axis] = 0.0;
            }
            if self.locks >> (axis + 3) & 1 != 0 {
                v.angular[axis] = 0.0;
            }
        }
    }

    /// The components of a vector along the free axes.
    #[inline]
    pub(crate) fn free(&self, mut v: Vec3) -> Vec3 {
        for axis in (0..3).filter(|axis| self.locks >> axis & 1 != 0) {
            v[axis] = 0.0;
        }
        v
    }

    pub(crate) fn lock_bits(translation: [bool; 3], rotation: [bool; 3]) -> u8 {
        (0..3).map(|i| (translation[i] as u8) << i | (rotation[i] as u8) << (i + 3)).sum()
    }
}

/// Whether a body's axes may wander while it turns freely: its moments differ, and none is locked.
pub(crate) fn is_uneven(mass: &Mass, traits: &Traits) -> bool {
    let (low, high) = (mass.inertia.min_element(), mass.inertia.max_element());
    high - low > 1e-3 * high && low > 0.0 && traits.locks == 0
}

/// Steps without a force, or without a query, after which their buffers are freed.
pub(crate) const IDLE: u32 = 256;

/// Parts of the columns, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    Awake,
    Kinematic,
    Asleep,
    Static,
}

impl Part {
    /// Where an enabled body of a kind is while it is awake.
    fn of(kind: BodyKind) -> Part {
        match kind {
            BodyKind::Static => Part::Static,
            BodyKind::Kinematic => Part::Kinematic,
            BodyKind::Dynamic => Part::Awake,
        }
    }

    const ALL: [Part; 4] = [Part::Awake, Part::Kinematic, Part::Asleep, Part::Static];
}

/// Evaluates an expression for each of the columns that all bodies have: the one list of them.
macro_rules! for_each_column {
    ($bodies:ident as [$($by:tt)+], $column:ident => $do:expr) => {{
        for_each_column!(@ [$bodies] [$($by)+] $column $do;
            slot, kind, pose, velocity, mass, traits, details, colliders);
    }};
    (@ $bodies:tt $by:tt $column:ident $do:expr; $($name:ident),+) => {
        $(for_each_column!(@one $bodies $by $name $column $do);)+
    };
    (@one [$bodies:ident] [$($by:tt)+] $name:ident $column:ident $do:expr) => {{
        let $column = $($by)+ $bodies.$name;
        $do;
    }};
}

/// All bodies. A column's index is the body's dense index.
#[derive(Debug, Default)]
pub(crate) struct Bodies {
    pub(crate) slots: Slots,
    pub(crate) slot: Vec<u32>,
    pub(crate) kind: Vec<BodyKind>,
    pub(crate) pose: Vec<Pose>,
    pub(crate) velocity: Vec<Record>,
    pub(crate) mass: Vec<Mass>,
    pub(crate) traits: Vec<Traits>,
    pub(crate) details: Vec<BodyDetails>,
    /// Collider indices of each body.
    pub(crate) colliders: Vec<ColliderList>,
    /// Force [N] and torque [N m] about the centre of mass, for the next step; empty unless the caller ever
    /// applied one.
    pub(crate) force: Vec<Record>,
    /// How many bodies have a locked axis.
    pub(crate) locked: u32,
    /// How many that may move are kept from passing through others.
    pub(crate) continuous: u32,
    /// How many turn about axes that wander: their moments of inertia differ.
    pub(crate) uneven: u32,
    /// How many have more than one shape.
    pub(crate) compounds: u32,
    /// Forces that were applied since the column of them was made, and steps since the last.
    pub(crate) pushes: u32,
    pub(crate) unpushed: u32,
    /// How many bodies have rows that are solved right after each group.
    solved_after: [u32; Order::LEN],
    /// How many there are of each part of the columns, but the last.
    parts: [u32; 3],
    /// How many of the bodies behind the movable ones are disabled, and not asleep.
    disabled: u32,
    /// Since when each body is at rest [s]; empty unless bodies may sleep.
    pub(crate) rest: Vec<f32>,
    /// Whether bodies may sleep.
    pub(crate) rests: bool,
    /// Bytes of the lists in `colliders`, live and reserved.
    lists: (usize, usize),
    /// Rare fields of bodies.
    pub(crate) rare: RareColumns,
    /// How often a body changed its part of the columns: see [`Forces::is_of`](crate::forces::Forces::is_of).
    pub(crate) rearranged: u64,
}

/// A new row of all columns.
#[derive(Debug)]
pub(crate) struct NewBody {
    pub(crate) kind: BodyKind,
    pub(crate) pose: Pose,
    pub(crate) velocity: Record,
    pub(crate) mass: Mass,
    pub(crate) traits: Traits,
    pub(crate) details: BodyDetails,
    pub(crate) damping: Damping,
    pub(crate) cap: SpeedCap,
    pub(crate) kept_mass: Option<KeptMass>,
}

impl Bodies {
    /// The handle of a body.
    pub(crate) fn handle(&self, index: usize) -> BodyHandle {
        let slot = self.slot[index];
        BodyHandle { slot, generation: self.slots.generation(slot) }
    }

    pub(crate) fn len(&self) -> usize {
        self.slot.len()
    }
    /// How many bodies are dynamic and awake: those with an index below.
    pub(crate) fn dynamic(&self) -> usize {
        self.end(Part::Awake) as usize
    }
    /// How many bodies can move: those with an index below.
    pub(crate) fn movers(&self) -> usize {
        self.end(Part::Kinematic) as usize
    }
    /// How many bodies are asleep.
    pub(crate) fn sleepers(&self) -> usize {
        self.asleep().len() - self.disabled as usize
    }
    /// Dynamic bodies that are asleep, and all that could move but are disabled.
    pub(crate) fn asleep(&self) -> std::ops::Range<usize> {
        self.movers()..self.end(Part::Asleep) as usize
    }
    /// All dynamic bodies that are enabled.
    pub(crate) fn all_dynamic(&self) -> impl Iterator<Item = usize> + '_ {
        let there = |&i: &usize| self.kind[i] == BodyKind::Dynamic && !self.traits[i].disabled;
        (0..self.dynamic()).chain(self.asleep().filter(there))
    }

    fn end(&self, part: Part) -> u32 {
        self.parts.iter().take(part as usize + 1).sum()
    }

    fn part_of(&self, index: u32) -> Part {
        match self.kind[index as usize] {
            BodyKind::Static => Part::Static,
            _ if self.traits[index as usize].disabled => Part::Asleep,
            BodyKind::Kinematic => Part::Kinematic,
            BodyKind::Dynamic if index < self.end(Part::Awake) => Part::Awake,
            BodyKind::Dynamic => Part::Asleep,
        }
    }

    /// How a body takes part in continuous collision: a static one not of itself.
    pub(crate) fn mode(&self, index: usize) -> ContinuousMode {
        match self.kind[index] {
            BodyKind::Static => ContinuousMode::Discrete,
            _ => self.traits[index].continuous,
        }
    }

    /// Puts a collider on a body.
    pub(crate) fn attach(&mut self, index: usize, collider: u32) {
        self.change(index, |own| own.push(collider));
    }

    /// Takes a collider off a body, by its place; says which has that place now.
    pub(crate) fn detach(&mut self, index: usize, place: usize) -> Option<u32> {
        self.change(index, |own| own.remove(place));
        self.colliders[index].as_slice().get(place).copied()
    }

    /// Takes all colliders off a body.
    pub(crate) fn take_colliders(&mut self, index: usize) -> ColliderList {
        self.change(index, std::mem::take)
    }

    fn change<R>(&mut self, index: usize, f: impl FnOnce(&mut ColliderList) -> R) -> R {
        let own = &mut self.colliders[index];
        let before = own.bytes();
        self.compounds -= u32::from(own.is_many());
        let result = f(own);
        self.compounds += u32::from(own.is_many());
        let (live, reserved) = own.bytes();
        self.lists = (self.lists.0 + live - before.0, self.lists.1 + reserved - before.1);
        result
    }

    /// Calls `f` with each buffer and the place that it needs for so many bodies. `forced`: with forces.
    pub(crate) fn each(&mut self, n: usize, forced: bool, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        self.slots.each(n, f);
        for_each_column!(self as [&mut], column => f(column, n));
        if forced {
            f(&mut self.force, n);
        }
    }

    /// Makes place for so many more.
    pub(crate) fn reserve(&mut self, more: usize) {
        let (mut allowance, len) = (Allowance::ENDLESS, self.len() + more);
        self.slots.reserve(more);
        for_each_column!(self as [&mut], column => allowance.fit(column, len));
        if !self.force.is_empty() {
            allowance.fit(&mut self.force, len);
        }
    }

    /// Adds a row and returns its slot and generation. Here and below `colliders` learn which bodies changed
    /// their index.
    pub(crate) fn insert(&mut self, body: NewBody, colliders: &mut Colliders) -> (u32, u32) {
        let last = self.len() as u32;
        self.reserve(1);
        let handle = self.slots.insert(last);
        self.push_row(handle.0, &body);
        if !self.force.is_empty() {
            self.force.push(Record::default());
        }
        if self.rests {
            self.rest.push(0.0);
        }
        self.travel(last, (Part::Static, Part::of(body.kind)), colliders);
        handle
    }

    /// Appends a row to the columns that all bodies have, and counts it.
    fn push_row(&mut self, slot: u32, body: &NewBody) {
        self.slot.push(slot);
        self.kind.push(body.kind);
        self.pose.push(body.pose);
        self.velocity.push(body.velocity);
        self.mass.push(body.mass);
        self.traits.push(body.traits);
        self.details.push(body.details);
        self.colliders.push(ColliderList::None);
        self.rare.set_damping(slot, body.damping);
        self.rare.set_cap(slot, body.cap);
        self.rare.kept_mass.set(slot, body.kept_mass);
        self.count_traits(self.len() - 1, 1);
    }

    /// Removes the body at `index`.
    pub(crate) fn remove(&mut self, index: u32, colliders: &mut Colliders) {
        self.count_traits(index as usize, -1);
        self.disabled -= u32::from(self.is_set_aside(index));
        let hole = self.travel(index, (self.part_of(index), Part::Static), colliders);
        self.swap(hole, self.len() as u32 - 1, colliders);
        if let Some(&slot) = self.slot.last() {
            self.slots.remove(slot);
            self.rare.forget(slot);
        }
        for_each_column!(self as [&mut], column => column.pop());
        self.force.pop();
        self.rest.pop();
    }

    /// Takes an awake body out of all that steps look at, at rest and with its colliders where it is: these
    /// are not updated until it wakes. Returns its new index.
    pub(crate) fn sleep(&mut self, index: u32, colliders: &mut Colliders) -> usize {
        let index = self.travel(index, (Part::Awake, Part::Asleep), colliders) as usize;
        self.velocity[index] = Record::default();
        self.colliders[index].as_slice().iter().for_each(|&c| colliders.place(c, &self.pose[index]));
        index
    }

    /// Takes a sleeping body back; returns its new index.
    pub(crate) fn wake(&mut self, index: u32, colliders: &mut Colliders) -> u32 {
        self.travel(index, (Part::Asleep, Part::Awake), colliders)
    }

    /// Takes a body out of the world, or puts it back, awake; returns its new index.
    pub(crate) fn set_enabled(&mut self, index: u32, enabled: bool, colliders: &mut Colliders) -> u32 {
        let part = Part::of(self.kind[index as usize]);
        if part == Part::Static {
            self.traits[index as usize].disabled = !enabled;
            return index;
        }
        if enabled {
            self.disabled -= 1;
            self.traits[index as usize].disabled = false;
            return self.travel(index, (Part::Asleep, part), colliders);
        }
        self.disabled += 1;
        let part = self.part_of(index);
        self.traits[index as usize].disabled = true;
        self.travel(index, (part, Part::Asleep), colliders)
    }

    /// Changes the kind of a body, which is awake then; returns its new index. Its mass and its velocity
    /// stay.
    pub(crate) fn set_kind(&mut self, index: u32, kind: BodyKind, colliders: &mut Colliders) -> u32 {
        let from = self.part_of(index);
        self.disabled -= u32::from(self.is_set_aside(index));
        self.recount(index as usize, |bodies| bodies.kind[index as usize] = kind);
        self.disabled += u32::from(self.is_set_aside(index));
        let to = if self.is_set_aside(index) { Part::Asleep } else { Part::of(kind) };
        self.travel(index, (from, to), colliders)
    }

    /// Whether a body could move, but is disabled.
    fn is_set_aside(&self, index: u32) -> bool {
        self.traits[index as usize].disabled && self.kind[index as usize] != BodyKind::Static
    }

    /// Moves a body from one part of the columns to another: of each part that it passes one body moves from
    /// one end of it to the other. Returns the new index.
    fn travel(&mut self, mut index: u32, (from, to): (Part, Part), colliders: &mut Colliders) -> u32 {
        self.rearranged += 1;
        self.count(from, -1);
        let (first, last) = (from.min(to) as usize, from.max(to) as usize);
        for step in 0..last - first {
            // Without the body, a part ends where it is to go.
            let part = Part::ALL[if from < to { first + step } else { last - 1 - step }];
            let border = self.end(part);
            self.swap(index, border, colliders);
            index = border;
        }
        self.count(to, 1);
        index
    }

    fn count(&mut self, part: Part, change: i32) {
        if let Some(count) = self.parts.get_mut(part as usize) {
            *count = count.wrapping_add_signed(change);
        }
    }

    /// Has a body's rows solved right after a group, or in their own place.
    pub(crate) fn set_solved_after(&mut self, index: usize, above: Option<RowGroup>) {
        self.recount(index, |bodies| bodies.traits[index].solved_after = above);
    }

    /// Whether any body names a group to be solved after.
    pub(crate) fn any_solved_after(&self) -> bool {
        self.solved_after.iter().any(|&count| count > 0)
    }

    /// How many bodies do.
    pub(crate) fn solved_after_count(&self) -> u32 {
        self.solved_after.iter().sum()
    }

    /// Counts the parts of a step that an added (1) or removed (-1) body requires.
    fn count_traits(&mut self, index: usize, change: i32) {
        let (kind, mass, traits) = (self.kind[index], &self.mass[index], &self.traits[index]);
        let add = |count: &mut u32, set: bool| {
            if set {
                *count = count.wrapping_add_signed(change);
            }
        };
        add(&mut self.locked, traits.locks != 0);
        add(&mut self.continuous, kind != BodyKind::Static && traits.continuous != ContinuousMode::Discrete);
        add(&mut self.uneven, is_uneven(mass, traits));
        if let Some(above) = traits.solved_after {
            add(&mut self.solved_after[above as usize], true);
        }
    }

    /// Changes something about a body that is counted.
    fn recount(&mut self, index: usize, change: impl FnOnce(&mut Bodies)) {
        self.count_traits(index, -1);
        change(self);
        self.count_traits(index, 1);
    }

    /// Replaces the mass properties of a body.
    pub(crate) fn set_mass(&mut self, index: usize, mass: Mass) {
        self.recount(index, |bodies| bodies.mass[index] = mass);
    }

    /// Sets the axes that a body can't move along or turn about, as bits.
    pub(crate) fn set_locked_axes(&mut self, index: usize, locks: u8) {
        self.recount(index, |bodies| bodies.traits[index].locks = locks);
    }

    /// Sets how a body is kept from passing through others.
    pub(crate) fn set_continuous(&mut self, index: usize, mode: ContinuousMode) {
        self.recount(index, |bodies| bodies.traits[index].continuous = mode);
    }

    /// The groups that bodies name to be solved after.
    pub(crate) fn solved_after_groups(&self) -> impl Iterator<Item = RowGroup> + Clone + '_ {
        Order::default().0.into_iter().filter(|&above| self.solved_after[above as usize] > 0)
    }

    fn swap(&mut self, i: u32, k: u32, colliders: &mut Colliders) {
        if i == k {
            return;
        }
        let (a, b) = (i as usize, k as usize);
        for_each_column!(self as [&mut], column => column.swap(a, b));
        if !self.force.is_empty() {
            self.force.swap(a, b);
        }
        if !self.rest.is_empty() {
            self.rest.swap(a, b);
        }
        for index in [i, k] {
            self.slots.moved(self.slot[index as usize], index);
            colliders.follow_all(&self.colliders[index as usize], index);
        }
    }

    /// How many bodies are awake and dynamic, kinematic, and asleep.
    pub(crate) fn parts(&self) -> [u32; 3] {
        self.parts
    }

    /// Says how many of the first bodies are awake, kinematic and asleep.
    pub(crate) fn set_parts(&mut self, parts: [u32; 3]) {
        self.parts = parts;
    }

    /// Brings the first bodies in the order of these slots.
    pub(crate) fn line_up(&mut self, slots: &[u32], colliders: &mut Colliders) {
        for (i, &slot) in slots.iter().enumerate() {
            if self.slot[i] != slot {
                self.swap(i as u32, self.slots.dense(slot), colliders);
            }
        }
    }

    /// Takes all bodies out; the slots are to be rebuilt.
    pub(crate) fn clear(&mut self) {
        for_each_column!(self as [&mut], column => column.clear());
        self.force.clear();
        self.rest.clear();
        self.rare.clear();
        (self.locked, self.solved_after, self.parts, self.lists) = (0, [0; Order::LEN], [0; 3], (0, 0));
        (self.continuous, self.uneven, self.compounds, self.disabled) = (0, 0, 0, 0);
    }

    /// Appends a body whose slot is known, without a place in the parts of the columns.
    pub(crate) fn append(&mut self, slot: u32, body: NewBody, colliders: &[u32]) {
        self.disabled += u32::from(body.traits.disabled && body.kind != BodyKind::Static);
        self.push_row(slot, &body);
        let index = self.len() - 1;
        colliders.iter().for_each(|&collider| self.attach(index, collider));
    }

    /// Reserved bytes of the lists of bodies with more than one shape.
    pub(crate) fn list_bytes(&self) -> usize {
        self.lists.1
    }

    /// Live and reserved bytes.
    pub(crate) fn bytes(&self) -> (usize, usize) {
        let mut sum = add_bytes(add_bytes(self.slots.bytes(), self.lists), self.rare.bytes());
        for_each_column!(self as [&], column => sum = add_bytes(sum, bytes_of(column)));
        add_bytes(sum, add_bytes(bytes_of(&self.force), bytes_of(&self.rest)))
    }
}
