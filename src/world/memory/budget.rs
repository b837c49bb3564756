//! Memory that the world holds, and that its budget allows.

use crate::body::{BodyDesc, BodyKind, RareCounts};
use crate::broad_phase::Population;
use crate::config::Settings;
use crate::constraint::WIDEST_JOINT_BATCH;
use crate::error::Error;
use crate::finish;
use crate::joint::{JointAdditions, JointDesc};
use crate::lanes::Record;
use crate::memory::{Allowance, Allowances, Amounts, Budget, Buffer, Category, MemoryReport, bytes_of};
use crate::shape::{Geometry, Kind, RareMaterial, ShapeDesc};
use crate::world::World;

/// Numbers of entries, present or future, in the buffers that a step can't do without.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::world) struct Counts {
    pub(in crate::world) bodies: usize,
    pub(in crate::world) movers: usize,
    pub(in crate::world) dynamic: usize,
    pub(in crate::world) colliders: Population,
    pub(in crate::world) solved_after: bool,
    /// Whether shapes have a material with a part that few have.
    pub(in crate::world) rare_materials: bool,
    /// Bodies with data that few have.
    pub(in crate::world) rare: RareCounts,
    /// Whether there are joints, and meshes or height fields.
    pub(in crate::world) joined: bool,
    pub(in crate::world) meshed: bool,
    /// Whether forces were applied, bodies may sleep, and impacts are solved at their times.
    pub(in crate::world) forced: bool,
    pub(in crate::world) rests: bool,
    pub(in crate::world) meets: bool,
    /// Whether bodies that leave their paths are settled. Without a budget the buffers for that are allocated
    /// when there are any.
    pub(in crate::world) settles: bool,
    /// Number of geometries, and the bytes of new ones and of the collider lists of compounds.
    pub(in crate::world) assets: usize,
    pub(in crate::world) once: Amounts,
}

impl World {
    /// Bytes by category.
    pub fn memory(&self) -> MemoryReport {
        let mut report = self.buffers_by_category();
        let (manifolds, rows) = self.buffers.prepare.ahead_bytes();
        report.shift(Category::Manifolds, Category::Continuous, manifolds);
        report.shift(Category::Rows, Category::Continuous, rows);
        report.keep_peaks(&self.peaks);
        report
    }

    /// Bytes that the rows of joints do not hold yet, or hold no more, but may take in any step: joints that
    /// are new, asleep or restored. With a budget nothing else gets them.
    pub fn memory_promised(&self) -> usize {
        self.joints.promised(WIDEST_JOINT_BATCH)
    }

    /// Each buffer as a whole. No field is left out by `..`: whoever adds one says here what it holds.
    pub(in crate::world) fn buffers_by_category(&self) -> MemoryReport {
        let World {
            bodies,
            colliders,
            assets,
            broad,
            removed,
            now,
            contacts,
            joints,
            events,
            sleep,
            characters,
            faults,
            helpers,
            buffers,
            // They hold no memory of the world, or its size never changes.
            settings: _,
            origin: _,
            needs: _,
            revisions: _,
            report: _,
            last_demand: _,
            spent: _,
            peaks: _,
            stage: _,
            #[cfg(feature = "observe")]
                meter: _,
            // The tape is the caller's.
            #[cfg(feature = "replay")]
                recorder: _,
        } = self;
        let mut report = MemoryReport::default();
        report.add(Category::Bodies, bodies.bytes());
        report.add(Category::Shapes, colliders.bytes());
        report.add(Category::Shapes, bytes_of(&assets.list));
        assets.bytes().for_each(|(category, bytes)| report.add(category, bytes));
        report.add(Category::BroadPhase, broad.bytes());
        report.add(Category::BroadPhase, bytes_of(removed));
        report.add(Category::BroadPhase, buffers.broad.removed_bytes());
        report.add(Category::BroadPhase, now.bytes());
        report.add(Category::Manifolds, contacts.bytes());
        report.add(Category::Rows, buffers.rows.bytes());
        report.add(Category::Continuous, broad.continuous_bytes());
        report.add(Category::Joints, joints.bytes());
        report.add(Category::Events, events.bytes());
        report.add(Category::Bodies, sleep.bytes());
        report.add(Category::Bodies, characters.bytes());
        report.add(Category::BroadPhase, sleep.kept_bytes());
        report.add(Category::Scratch, faults.bytes());
        report.add(Category::Scratch, helpers.bytes());
        // A budget asks for the motion as what continuous bodies need, before it is known whether any comes.
        buffers.report(&mut report, self.is_continuous() || !self.settings.budget.is_none());
        report
    }

    pub(crate) fn note_peaks(&mut self) {
        self.peaks = self.memory();
    }

    /// Bytes that may still be reserved.
    pub(crate) fn allowances(&self) -> Allowances {
        self.rooms_of(&self.settings.budget)
    }

    /// Bytes that another budget leaves.
    fn rooms_of(&self, budget: &Budget) -> Allowances {
        self.rooms_without(budget, &Amounts::default())
    }

    /// The same after so many bytes were released.
    pub(in crate::world) fn rooms_without(&self, budget: &Budget, gone: &Amounts) -> Allowances {
        if budget.is_none() {
            return Allowances::ENDLESS;
        }
        let whole = self.buffers_by_category();
        let mut held = self.memory();
        // The share of continuous collision in their buffers may be theirs in the next step.
        held.take_over(&whole, &[Category::Manifolds, Category::Rows]);
        let promised = self.memory_promised();
        held.add(Category::Joints, (0, promised));
        Allowances::new(budget, &held.reserved(), whole.total() + promised, gone)
    }

    /// Whether so many bytes may be reserved.
    ///
    /// # Errors
    /// If the budget does not allow them.
    pub(crate) fn grant(&self, category: Category, bytes: usize) -> Result<(), Error> {
        let mut asked = Amounts::default();
        asked.add(category, bytes);
        check(&asked, &self.allowances())
    }

    /// Bytes of one category that may still be reserved.
    pub(crate) fn allowance(&self, category: Category) -> Allowance {
        self.allowances().allowance(category)
    }

    /// Bytes that the contacts of continuous collision and their rows may take in a step: all that is left of
    /// its limit, and what they had before.
    pub(crate) fn room_ahead(&self, allowances: &Allowances) -> usize {
        if self.settings.budget.limit_of(Category::Continuous).is_none() {
            return usize::MAX;
        }
        let held = |report: MemoryReport| report.category(Category::Continuous).reserved;
        allowances.own(Category::Continuous) + held(self.memory()) - held(self.buffers_by_category())
    }

    /// Updates the bytes that events may still reserve.
    pub(crate) fn refresh_event_allowance(&mut self) {
        self.events.allowance = self.allowance(Category::Events);
    }

    /// Reserves entries for bodies in all buffers that have one for each, including those that their steps
    /// can't do without, so that a step can only lack memory for pairs and contacts.
    pub(in crate::world) fn reserve(&mut self, descs: &[BodyDesc]) -> Result<(), Error> {
        if self.settings.budget.is_none() {
            return Ok(());
        }
        let more = self.counts_of(descs);
        self.reserve_for(more, descs.len() == 1)
    }

    /// Entries that bodies add.
    fn counts_of<'a>(&self, descs: impl IntoIterator<Item = &'a BodyDesc> + Clone) -> Counts {
        let shapes = descs.clone().into_iter().flat_map(|desc| &desc.shapes);
        let (once, assets) = self.assets.cost(shapes.map(|shape| &shape.geometry));
        let mut more = Counts { once, assets, ..Counts::default() };
        for desc in descs {
            let (moves, pushed) = (desc.kind != BodyKind::Static, desc.kind == BodyKind::Dynamic);
            more.bodies += 1;
            more.movers += usize::from(moves);
            more.dynamic += usize::from(pushed);
            more.once.add(Category::Bodies, list_bytes(0, desc.shapes.len()));
            more.solved_after |= desc.solved_after.is_some();
            more.rare = more.rare
                + RareCounts {
                    damped: usize::from(desc.linear_damping > 0.0 || desc.angular_damping > 0.0),
                    capped: usize::from(desc.max_linear_speed.or(desc.max_angular_speed).is_some()),
                    kept_masses: usize::from(!pushed && desc.mass.is_some()),
                    targets: 0,
                };
            desc.shapes.iter().for_each(|shape| more.add_shape(desc.kind, shape));
        }
        more
    }

    /// Reserves entries for another shape of a body.
    pub(in crate::world) fn reserve_for_shape(
        &mut self,
        kind: BodyKind,
        shape: &ShapeDesc,
        has: usize,
    ) -> Result<(), Error> {
        if self.settings.budget.is_none() {
            return Ok(());
        }
        let (once, assets) = self.assets.cost(std::iter::once(&shape.geometry));
        let mut more = Counts { once, assets, ..Counts::default() };
        more.once.add(Category::Bodies, list_bytes(has, has + 1));
        more.add_shape(kind, shape);
        self.reserve_for(more, true)
    }

    /// Reserves so many slots of characters, and the geometry of one.
    ///
    /// # Errors
    /// If the budget does not allow them.
    pub(crate) fn reserve_for_character(
        &mut self,
        geometry: Option<&Geometry>,
        slots: usize,
    ) -> Result<(), Error> {
        if self.settings.budget.is_none() {
            return Ok(());
        }
        let (mut once, assets) = self.assets.cost(geometry.into_iter());
        once.add(Category::Bodies, self.character_buffer().missing(slots));
        self.reserve_for(Counts { once, assets, ..Counts::default() }, false)?;
        self.character_buffer().reserve_total(slots);
        Ok(())
    }

    /// Reserves entries for another form of a shape.
    pub(in crate::world) fn reserve_for_geometry(&mut self, geometry: &Geometry) -> Result<(), Error> {
        if self.settings.budget.is_none() {
            return Ok(());
        }
        let (once, assets) = self.assets.cost(std::iter::once(geometry));
        let mut more = Counts { once, assets, ..Counts::default() };
        let kind = Kind::of(geometry);
        more.meshed = kind.is_ground();
        more.rare_materials = geometry.rare_flags() != 0;
        more.colliders.endless = usize::from(kind == Kind::Plane);
        self.reserve_for(more, false)
    }

    /// Reserves sort keys for contacts of bodies that are solved after a group.
    pub(in crate::world) fn reserve_for_solved_after(&mut self, solved_after: bool) -> Result<(), Error> {
        if self.settings.budget.is_none() {
            return Ok(());
        }
        self.reserve_for(Counts { solved_after, ..Counts::default() }, false)
    }

    /// Reserves entries for bodies with data that few have.
    pub(in crate::world) fn reserve_for_rare(&mut self, rare: RareCounts) -> Result<(), Error> {
        if self.settings.budget.is_none() {
            return Ok(());
        }
        self.reserve_for(Counts { rare, ..Counts::default() }, false)
    }

    /// Reserves the column of rare materials, which exists only once a shape has one.
    pub(in crate::world) fn reserve_for_rare_material(&mut self, rare: RareMaterial) -> Result<(), Error> {
        if self.settings.budget.is_none() || rare.flags() == 0 {
            return Ok(());
        }
        self.reserve_for(Counts { rare_materials: true, ..Counts::default() }, false)
    }

    /// Reserves entries for a body that becomes one of another kind.
    pub(in crate::world) fn reserve_for_kind(&mut self, index: usize, kind: BodyKind) -> Result<(), Error> {
        if self.settings.budget.is_none() {
            return Ok(());
        }
        let is = |kind: BodyKind| self.bodies.kind[index] == kind;
        let mut more = Counts {
            movers: usize::from(is(BodyKind::Static)),
            dynamic: usize::from(kind == BodyKind::Dynamic),
            rare: RareCounts { kept_masses: usize::from(is(BodyKind::Dynamic)), ..RareCounts::default() },
            ..Counts::default()
        };
        if is(BodyKind::Static) != (kind == BodyKind::Static) {
            for &c in self.bodies.colliders[index].as_slice() {
                more.add_collider(kind, self.colliders.all[c as usize].kind);
            }
        }
        // Their slots exist already.
        more.colliders.slots = 0;
        self.reserve_for(more, false)
    }

    /// Creates the column of forces, which exists only once a force was applied.
    pub(in crate::world) fn reserve_for_forces(&mut self) -> Result<(), Error> {
        let (column, bodies) = (&self.bodies.force, self.bodies.len());
        if column.is_empty() {
            let mut asked = Amounts::default();
            asked.add(Category::Bodies, column.missing(bodies));
            check(&asked, &self.allowances())?;
            self.bodies.force.reserve_total(bodies);
            self.bodies.force.resize(bodies, Record::default());
        }
        Ok(())
    }

    /// Whether other settings arrange joints in another way.
    pub(in crate::world) fn rearranges(&self, settings: &Settings) -> bool {
        settings.order != self.settings.order || settings.joint_trees != self.settings.joint_trees
    }

    /// Reserves the buffers that other settings switch on.
    ///
    /// # Errors
    /// If their budget does not allow it.
    pub(in crate::world) fn reserve_for_settings(&mut self, settings: &Settings) -> Result<(), Error> {
        let now = self.counts(Counts::default());
        let counts = Counts {
            rests: settings.sleeping && !now.rests,
            meets: settings.method.meets_impacts() && !now.meets,
            settles: settings.method.settles() && !self.settings.method.settles(),
            ..now
        };
        let anew = self.rearranges(settings) && self.joints.count > 0;
        if settings.budget.is_none() || !(counts.rests || counts.meets || counts.settles || anew) {
            return Ok(());
        }
        let mut asked = Amounts::default();
        if anew {
            asked.add(Category::Joints, self.joints.row_count() * WIDEST_JOINT_BATCH);
        }
        self.each_of_switched(counts, &mut |category, buffer, len| asked.add(category, buffer.missing(len)));
        check(&asked, &self.rooms_of(&settings.budget))?;
        self.each_of_switched(counts, &mut |_, buffer, len| buffer.reserve_total(len));
        Ok(())
    }

    /// Reserves entries for a body that is enabled again.
    pub(in crate::world) fn reserve_for_enabled(&mut self, index: usize) -> Result<(), Error> {
        if self.settings.budget.is_none() {
            return Ok(());
        }
        let kind = self.bodies.kind[index];
        let mut more = Counts { dynamic: usize::from(kind == BodyKind::Dynamic), ..Counts::default() };
        for &c in self.bodies.colliders[index].as_slice() {
            more.add_collider(kind, self.colliders.all[c as usize].kind);
        }
        // Their slots exist already.
        more.colliders.slots = 0;
        self.reserve_for(more, false)
    }

    /// Reserves entries for all present content, whether or not the budget allows it: without them no step is
    /// possible.
    pub(crate) fn reserve_for_step(&mut self) {
        if !self.settings.budget.is_none() {
            let counts = self.counts(Counts::default());
            self.each_buffer(counts, &mut |_, buffer, len| buffer.reserve_total(len));
            self.joints.reserve_total(JointAdditions::default());
        }
    }

    /// Reserves entries for more content; `ahead`: with a margin for later additions.
    fn reserve_for(&mut self, more: Counts, ahead: bool) -> Result<(), Error> {
        let allowances = self.allowances();
        let mut counts = self.counts(more);
        // A quarter more while that is a small part of what is left, so that buffers do not move for each of
        // many bodies that are added one by one.
        let wider = counts.with_more(4);
        if ahead && allowances.part(AHEAD).fits(&self.lacking(wider)) {
            counts = wider;
        } else {
            check(&self.lacking(counts), &allowances)?;
        }
        self.each_buffer(counts, &mut |_, buffer, len| buffer.reserve_total(len));
        Ok(())
    }

    /// Bytes that are missing for bodies, some of them joined.
    pub(in crate::world) fn lacking_for<'a>(
        &mut self,
        descs: impl IntoIterator<Item = &'a BodyDesc> + Clone,
        joined: bool,
    ) -> Amounts {
        let more = self.counts_of(descs);
        let counts = self.counts(Counts { joined, ..more });
        self.lacking(counts)
    }

    /// Whether the budget has room for bodies, for joints between them (their handles do not matter), and for
    /// a number of couplings of these, before any are added.
    ///
    /// # Errors
    /// [`Error::Budget`] if it has not.
    pub fn allow(
        &mut self,
        bodies: &[BodyDesc],
        joints: &[JointDesc],
        couplings: usize,
    ) -> Result<(), Error> {
        let coupled = (0..couplings).map(|_| JointAdditions::of_coupling());
        let more = joints.iter().map(JointAdditions::of_joint).chain(coupled);
        let joints = more.fold(JointAdditions::default(), JointAdditions::and);
        if self.settings.budget.is_none() {
            return Ok(());
        }
        let mut asked = self.lacking_for(bodies, !joints.is_empty());
        if !joints.is_empty() {
            let joints = joints.between(self.bodies.slots.count() + bodies.len());
            asked.add(Category::Joints, self.joints.missing(joints, WIDEST_JOINT_BATCH));
        }
        check(&asked, &self.allowances())
    }

    /// Bytes that are missing for so many entries.
    pub(in crate::world) fn lacking(&mut self, counts: Counts) -> Amounts {
        let mut bytes = counts.once;
        self.each_buffer(counts, &mut |category, buffer, len| bytes.add(category, buffer.missing(len)));
        bytes
    }

    /// Reserves entries for joints, with a margin for later ones: in their columns, in the batches of steps,
    /// and in the data that steps keep of each body that may be joined.
    pub(in crate::world) fn reserve_for_joints(
        &mut self,
        more: JointAdditions,
        ahead: bool,
    ) -> Result<(), Error> {
        if self.settings.budget.is_none() {
            return Ok(());
        }
        let counts = self.counts(Counts { joined: true, ..Counts::default() });
        let further = if ahead { self.joints.ahead(more) } else { more };
        let (allowances, of_bodies) = (self.allowances(), self.lacking(counts));
        let mut asked = |more: JointAdditions| {
            let mut asked = of_bodies;
            asked.add(Category::Joints, self.joints.missing(more, WIDEST_JOINT_BATCH));
            asked
        };
        // So that buffers do not move for each joint that is added.
        let (wider, exact) = (asked(further), asked(more));
        let far = allowances.part(AHEAD).fits(&wider);
        if !far {
            check(&exact, &allowances)?;
        }
        self.each_buffer(counts, &mut |_, buffer, len| buffer.reserve_total(len));
        self.joints.reserve_total(if far { further } else { more });
        Ok(())
    }

    pub(in crate::world) fn counts(&self, more: Counts) -> Counts {
        let now = self.broad.population();
        let spare = self.colliders.slots.spare();
        Counts {
            bodies: self.bodies.len() + more.bodies,
            // Sleeping bodies may wake.
            movers: self.bodies.asleep().end + more.movers,
            dynamic: self.bodies.all_dynamic().count() + more.dynamic,
            colliders: Population {
                slots: self.colliders.all.len() + more.colliders.slots.saturating_sub(spare),
                moving: now.moving + more.colliders.moving,
                still: now.still + more.colliders.still,
                endless: now.endless + more.colliders.endless,
            },
            joined: more.joined || self.joints.count > 0,
            rare_materials: more.rare_materials || self.needs.rare_materials > 0,
            meshed: more.meshed || self.needs.meshes + self.needs.height_fields > 0,
            forced: more.forced || !self.bodies.force.is_empty(),
            rests: more.rests || self.settings.sleeping || self.bodies.rests,
            meets: more.meets || self.settings.method.meets_impacts(),
            settles: more.settles || (self.settings.method.settles() && !self.settings.budget.is_none()),
            solved_after: more.solved_after || self.bodies.solved_after_groups().next().is_some(),
            assets: self.assets.list.len() + more.assets,
            rare: self.bodies.rare.counts() + more.rare,
            ..more
        }
    }

    /// Calls `f` with each buffer that has an entry for each body or collider, its category, and the capacity
    /// that it needs.
    pub(in crate::world) fn each_buffer(
        &mut self,
        n: Counts,
        f: &mut dyn FnMut(Category, &mut dyn Buffer, usize),
    ) {
        use Category::{Bodies, BroadPhase, Continuous, Joints, Scratch, Shapes};
        self.bodies.each(n.bodies, n.forced, &mut |buffer, len| f(Bodies, buffer, len));
        self.bodies.rare.each(n.rare, &mut |buffer, len| f(Bodies, buffer, len));
        let rare = if n.rare_materials { n.colliders.slots } else { 0 };
        self.colliders.each(n.colliders.slots, rare, &mut |buffer, len| f(Shapes, buffer, len));
        f(Shapes, &mut self.assets.list, n.assets);
        self.broad.each(n.colliders, &mut |buffer, len| f(BroadPhase, buffer, len));
        f(Continuous, self.broad.paths(), n.colliders.moving);
        self.now.each(n.colliders, &mut |buffer, len| f(BroadPhase, buffer, len));
        let buffers = &mut self.buffers;
        f(Continuous, &mut buffers.forces.motion, n.movers);
        let mut scratch = |buffer: &mut dyn Buffer, len: usize| f(Scratch, buffer, len);
        buffers.forces.each(n.movers, n.dynamic, &mut scratch);
        buffers.broad.each(n.movers, n.colliders.moving, &mut scratch);
        buffers.prepare.each(n.dynamic, n.solved_after, &mut scratch);
        buffers.statics.each(n.dynamic, &mut scratch);
        buffers.solver.each(n.movers, &mut scratch);
        let content = finish::Content { movers: n.movers, dynamic: n.dynamic, joined: n.joined };
        buffers.finish.each(&content, &mut scratch);
        if n.joined {
            buffers.joints.each(n.dynamic, &mut |buffer, len| f(Joints, buffer, len));
        }
        self.each_of_switched(n, f);
    }

    /// The same for the buffers that settings switch on, alone.
    pub(in crate::world) fn each_of_switched(
        &mut self,
        n: Counts,
        f: &mut dyn FnMut(Category, &mut dyn Buffer, usize),
    ) {
        if n.rests {
            f(Category::Bodies, &mut self.bodies.rest, n.bodies);
            self.sleep.each(n.bodies, n.dynamic, &mut |buffer, len| f(Category::Bodies, buffer, len));
        }
        if n.settles && n.dynamic > 0 && n.meshed {
            self.buffers.finish.each_to_settle(&mut |buffer, len| f(Category::Scratch, buffer, len));
        }
        if n.meets {
            let tracks = &mut self.buffers.impacts;
            tracks.each(n.movers, &mut |buffer, len| f(Category::Continuous, buffer, len));
        }
    }
}

/// A margin beyond the request may take this part of what is left.
const AHEAD: usize = 8;

/// Checks that so much fits; the error tells what is short.
pub(in crate::world) fn check(asked: &Amounts, allowances: &Allowances) -> Result<(), Error> {
    if allowances.fits(asked) {
        return Ok(());
    }
    let short = |&category: &Category| asked.of(category) > allowances.own(category);
    Err(match Category::ALL.into_iter().find(short) {
        Some(category) => {
            Error::Budget { category, asked: asked.of(category), left: allowances.own(category) }
        }
        None => Error::Budget { category: asked.largest(), asked: asked.total(), left: allowances.whole() },
    })
}

impl Counts {
    fn add_shape(&mut self, kind: BodyKind, shape: &ShapeDesc) {
        self.add_collider(kind, Kind::of(&shape.geometry));
        self.rare_materials |= shape.material.rare().flags() | shape.geometry.rare_flags() != 0;
    }

    pub(in crate::world) fn add_collider(&mut self, of: BodyKind, kind: Kind) {
        self.colliders.slots += 1;
        self.meshed |= kind.is_ground();
        *match of {
            BodyKind::Static => &mut self.colliders.still,
            _ => &mut self.colliders.moving,
        } += 1;
        self.colliders.endless += usize::from(kind == Kind::Plane);
    }

    /// A share of `1 / part` more of each.
    fn with_more(mut self, part: usize) -> Counts {
        let Population { slots, moving, still, endless } = &mut self.colliders;
        let assets = &mut self.assets;
        let all =
            [&mut self.bodies, &mut self.movers, &mut self.dynamic, slots, moving, still, endless, assets];
        all.into_iter().for_each(|n| *n += *n / part);
        self
    }
}

/// Bytes that a body's list of colliders grows by, from so many to so many.
pub(in crate::world) fn list_bytes(from: usize, to: usize) -> usize {
    let bytes = |n: usize| if n < 2 { 0 } else { n.next_power_of_two() * size_of::<u32>() };
    bytes(to) - bytes(from)
}
