//! Memory that the world holds, and that its budget allows.

use crate::body::{BodyDesc, BodyKind, RareCounts};
use crate::broad_phase::Population;
use crate::config::Settings;
use crate::constraint::WIDEST_JOINT_BATCH;
use crate::error::Error;
use crate::finish;
use crate::joint::{JointAdditions, JointDesc};
use crate::memory::{Allowance, Allowances, Amounts, Budget, Buffer, Category, MemoryReport, bytes_of};
use crate::narrow_phase::LEAST_ROWS;
use crate::shape::{Geometry, Kind, ShapeDesc};
use crate::world::World;

/// Numbers of entries, present or future, in the buffers that a step can't do without.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Counts {
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
    /// Slots of characters.
    pub(in crate::world) characters: usize,
    /// Joints that are added.
    pub(in crate::world) joints: JointAdditions,
    /// Number of geometries, and the bytes of new ones and of the collider lists of compounds.
    pub(in crate::world) assets: usize,
    pub(in crate::world) once: Amounts,
}

/// Content that a call adds to a world, for which its budget must have room.
#[derive(Clone, Copy)]
pub(crate) enum Addition<'a> {
    Bodies(&'a [BodyDesc]),
    /// Another shape of a body of a kind, which has so many.
    Shape(BodyKind, &'a ShapeDesc, usize),
    /// Another form of a shape.
    Form(&'a Geometry),
    /// The geometry of a character, and slots of characters in all.
    Character(Option<&'a Geometry>, usize),
    /// A body, by its index, becomes one of another kind.
    Kind(usize, BodyKind),
    /// A body, by its index, is enabled again.
    Enabled(usize),
    /// Joints, or parts of them; `true`: with a margin for later ones.
    Joints(JointAdditions, bool),
    /// Data that few bodies have.
    Rare(RareCounts),
    /// A body's rows are solved after a group.
    SolvedAfter(bool),
    /// A shape has a material with a part that few have.
    RareMaterial(bool),
    /// The first force.
    Force,
}

/// # Memory
impl World {
    /// Bytes by category.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// let memory = world.memory();
    /// for (category, bytes) in memory.iter() {
    ///     println!("{}: {} of {} bytes", category.name(), bytes.live, bytes.reserved);
    /// }
    /// assert!(memory.total() > 0);
    /// # Ok::<(), Error>(())
    /// ```
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

    /// Each buffer as a whole. No field is left out by `..`: a new field must state its memory here.
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
        // A budget counts the motion as needed by continuous bodies, before it is known whether any comes.
        buffers.report(&mut report, self.is_continuous() || !self.settings.budget.is_none());
        report
    }

    pub(crate) fn note_peaks(&mut self) {
        self.peaks = self.memory();
    }

    /// Bytes that may still be reserved.
    pub(crate) fn allowances(&self) -> Allowances {
        self.rooms_without(&self.settings.budget, &Amounts::default())
    }

    /// Bytes that a budget leaves after so many were released.
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
    /// its limit, and their bytes before.
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

    /// Reserves entries for added content in all buffers that have one for each, including those that steps
    /// can't do without, so that a step can only lack memory for pairs and contacts. Without a budget there
    /// is nothing to reserve.
    ///
    /// # Errors
    /// If the budget does not allow it.
    pub(crate) fn reserve(&mut self, addition: Addition<'_>) -> Result<(), Error> {
        if self.settings.budget.is_none() {
            return Ok(());
        }
        let more = self.counts_of(addition);
        let (mut counts, allowances) = (self.counts(more), self.allowances());
        // More while that is a small part of the rest, so that buffers do not move for each of many
        // additions.
        let wider = match addition {
            Addition::Bodies([_]) | Addition::Shape(..) => counts.with_more(4),
            Addition::Joints(joints, true) => Counts { joints: self.joints.ahead(joints), ..counts },
            _ => counts,
        };
        if allowances.part(AHEAD).fits(&self.lacking(wider)) {
            counts = wider;
        } else {
            check(&self.lacking(counts), &allowances)?;
        }
        self.reserve_all(counts);
        Ok(())
    }

    fn reserve_all(&mut self, counts: Counts) {
        self.each_buffer(counts, &mut |_, buffer, len| buffer.reserve_total(len));
        self.joints.reserve_total(counts.joints);
    }

    /// Reserves entries for all present content, whether or not the budget allows it: without them no step is
    /// possible.
    pub(crate) fn reserve_for_step(&mut self) {
        if !self.settings.budget.is_none() {
            let counts = self.counts(Counts::default());
            self.reserve_all(counts);
        }
    }

    /// Entries that are added.
    fn counts_of(&self, addition: Addition<'_>) -> Counts {
        let none = Counts::default();
        let form = |geometry: Option<&Geometry>| {
            let (once, assets) = self.assets.cost(geometry.into_iter());
            Counts { once, assets, ..none }
        };
        match addition {
            Addition::Bodies(descs) => self.counts_of_bodies(descs),
            Addition::Shape(kind, shape, has) => {
                let mut more = form(Some(&shape.geometry));
                more.once.add(Category::Bodies, list_bytes(has, has + 1));
                more.add_shape(kind, shape);
                more
            }
            Addition::Form(geometry) => {
                let (mut more, kind) = (form(Some(geometry)), Kind::of(geometry));
                more.meshed = kind.is_ground();
                more.rare_materials = geometry.rare_flags() != 0;
                more.colliders.endless = usize::from(kind == Kind::Plane);
                more
            }
            Addition::Character(geometry, characters) => Counts { characters, ..form(geometry) },
            Addition::Kind(index, kind) => {
                let is = |kind: BodyKind| self.bodies.kind[index] == kind;
                let kept_masses = usize::from(is(BodyKind::Dynamic));
                let more = Counts {
                    movers: usize::from(is(BodyKind::Static)),
                    dynamic: usize::from(kind == BodyKind::Dynamic),
                    rare: RareCounts { kept_masses, ..RareCounts::default() },
                    ..none
                };
                let stays = is(BodyKind::Static) == (kind == BodyKind::Static);
                if stays { more } else { self.with_colliders_of(index, kind, more) }
            }
            Addition::Enabled(index) => {
                let kind = self.bodies.kind[index];
                let dynamic = usize::from(kind == BodyKind::Dynamic);
                self.with_colliders_of(index, kind, Counts { dynamic, ..none })
            }
            Addition::Joints(joints, _) => Counts { joints, joined: true, ..none },
            Addition::Rare(rare) => Counts { rare, ..none },
            Addition::SolvedAfter(solved_after) => Counts { solved_after, ..none },
            Addition::RareMaterial(rare_materials) => Counts { rare_materials, ..none },
            Addition::Force => Counts { forced: true, ..none },
        }
    }

    /// The same with the colliders of a body that becomes one of a kind. Their slots exist already.
    fn with_colliders_of(&self, index: usize, kind: BodyKind, mut more: Counts) -> Counts {
        for &c in self.bodies.colliders[index].as_slice() {
            more.add_collider(kind, self.colliders.all[c as usize].kind);
        }
        more.colliders.slots = 0;
        more
    }

    /// Entries that bodies add.
    pub(in crate::world) fn counts_of_bodies<'a>(
        &self,
        descs: impl IntoIterator<Item = &'a BodyDesc> + Clone,
    ) -> Counts {
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
            meets: settings.continuous_method.meets_impacts() && !now.meets,
            settles: settings.continuous_method.settles() && !self.settings.continuous_method.settles(),
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
        check(&asked, &self.rooms_without(&settings.budget, &Amounts::default()))?;
        self.each_of_switched(counts, &mut |_, buffer, len| buffer.reserve_total(len));
        Ok(())
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
        let mut more = self.counts_of_bodies(bodies);
        if !joints.is_empty() {
            more.joined = true;
            more.joints = joints.between(self.bodies.slots.count() + bodies.len());
        }
        let counts = self.counts(more);
        check(&self.lacking(counts), &self.allowances())
    }

    /// Bytes that are missing for so many entries.
    pub(in crate::world) fn lacking(&mut self, counts: Counts) -> Amounts {
        let mut bytes = counts.once;
        self.each_buffer(counts, &mut |category, buffer, len| bytes.add(category, buffer.missing(len)));
        bytes.add(Category::Joints, self.joints.missing(counts.joints, WIDEST_JOINT_BATCH));
        bytes
    }

    /// The entries that there will be with more.
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
            meets: more.meets || self.settings.continuous_method.meets_impacts(),
            settles: more.settles
                || (self.settings.continuous_method.settles() && !self.settings.budget.is_none()),
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
        use Category::{Bodies, BroadPhase, Continuous, Joints, Rows, Scratch, Shapes};
        self.bodies.each(n.bodies, n.forced, &mut |buffer, len| f(Bodies, buffer, len));
        self.bodies.rare.each(n.rare, &mut |buffer, len| f(Bodies, buffer, len));
        let rare = if n.rare_materials { n.colliders.slots } else { 0 };
        self.colliders.each(n.colliders.slots, rare, &mut |buffer, len| f(Shapes, buffer, len));
        f(Shapes, &mut self.assets.list, n.assets);
        f(Bodies, self.character_buffer(), n.characters);
        self.broad.each(n.colliders, &mut |buffer, len| f(BroadPhase, buffer, len));
        f(Continuous, self.broad.paths(), n.colliders.moving);
        self.now.each(n.colliders, &mut |buffer, len| f(BroadPhase, buffer, len));
        let buffers = &mut self.buffers;
        f(Continuous, &mut buffers.forces.motion, n.movers);
        f(Rows, buffers.rows.batch_buffer(), if n.movers > 0 { LEAST_ROWS } else { 0 });
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

/// A margin beyond the request may take this part of the rest.
const AHEAD: usize = 8;

/// Checks that so much fits; the error names the category that lacks it.
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
