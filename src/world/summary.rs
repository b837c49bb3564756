//! Reports: of a step, and of the state of the world.

use super::{StageTimes, StepCounts, StepReport, World};

/// # Reports of a step
impl World {
    /// Times and counts of the last step.
    pub fn report(&self) -> &StepReport {
        &self.report
    }

    /// The report of a step that took these times.
    pub(crate) fn report_of(&self, times: StageTimes, did: &StepCounts) -> StepReport {
        let StepCounts { broad, narrow, prepared, held, met, .. } = did;
        StepReport {
            times,
            pairs: self.broad.pairs.len() as u32,
            moved: broad.moved,
            swept: broad.fast,
            ghosts: narrow.ghosts + did.ghosts,
            recycled: narrow.recycled,
            casts: narrow.casts,
            impacts: prepared.impacts,
            manifolds: prepared.manifolds,
            real: prepared.real,
            potential: prepared.potential,
            pushed: did.pushed,
            cut: held.cut,
            lifted: held.lifted,
            settled: held.settled,
            weighted_trees: self.buffers.joints.weighted_trees(),
            damped_trees: self.buffers.joints.damped_trees(),
            faulted: self.faults.stopped.len() as u32,
            struck: met.struck,
            stood: met.stood,
            shed: did.shed() + met.shed,
            asleep: self.bodies.sleepers() as u32,
            slept: self.sleep.slept,
            woke: self.sleep.woke,
            events_lost: self.events.lost,
            uncoloured: self.buffers.rows.uncoloured() as u32,
            batches: self.buffers.rows.schedule.len() as u32,
        }
    }

    /// Hash of all poses and velocities, bit by bit, in the order of the bodies' handles, and of the world's
    /// characters.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// // Two worlds that were made and stepped alike have the same bits.
    /// let mut other = World::new(Settings::default())?;
    /// other.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// other.add_body(&desc)?;
    /// for _ in 0..60 {
    ///     world.step(1.0 / 60.0)?;
    ///     other.step(1.0 / 60.0)?;
    /// }
    /// assert_eq!(world.state_hash(), other.state_hash());
    /// # Ok::<(), Error>(())
    /// ```
    pub fn state_hash(&self) -> u64 {
        let mut order: Vec<(u32, usize)> =
            self.bodies.slot.iter().enumerate().map(|(i, &s)| (s, i)).collect();
        order.sort_unstable();
        let mut hash = 0xCBF2_9CE4_8422_2325u64;
        let mut add = |bits: u64| hash = (hash ^ bits).wrapping_mul(0x100_0000_01B3).rotate_left(5);
        for (_, index) in order {
            let (pose, v) = (&self.bodies.pose[index], &self.bodies.velocity[index]);
            pose.position.to_array().iter().for_each(|x| add(x.to_bits()));
            pose.rotation.to_array().iter().for_each(|x| add(x.to_bits().into()));
            v.linear.to_array().iter().chain(&v.angular.to_array()).for_each(|x| add(x.to_bits().into()));
        }
        for (handle, resident) in self.characters.iter() {
            add(handle.to_bits());
            resident.words.iter().for_each(|&word| add(word.into()));
        }
        hash
    }

    /// Kinetic energy of all dynamic bodies plus their potential energy in the world's gravity, relative to
    /// the world's zero [J].
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// let before = world.energy();
    /// for _ in 0..30 {
    ///     world.step(1.0 / 60.0)?;
    /// }
    /// // It falls freely: potential energy became kinetic.
    /// assert!((world.energy() - before).abs() < 0.01 * before.abs());
    /// # Ok::<(), Error>(())
    /// ```
    pub fn energy(&self) -> f64 {
        self.bodies
            .all_dynamic()
            .map(|i| {
                let (mass, pose, v) = (&self.bodies.mass[i], &self.bodies.pose[i], &self.bodies.velocity[i]);
                let m = f64::from(self.bodies.details[i].mass);
                let local = pose.rotation.conjugate() * v.angular;
                let spin = 0.5 * f64::from(local.dot(mass.inertia * local));
                let linear = 0.5 * m * v.linear.as_dvec3().length_squared();
                let pull = f64::from(self.bodies.traits[i].gravity_scale) * self.settings.gravity.as_dvec3();
                linear + spin - m * pull.dot(pose.position)
            })
            .sum()
    }
}
