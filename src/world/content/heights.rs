//! Heights and holes of a field that change while the world runs.

use crate::broad_phase::Aabb;
use crate::error::Error;
use crate::handle::ShapeHandle;
use crate::narrow_phase::NO_CONTACT;
use crate::shape::{Geometry, HeightField, HolePatch, Patch};
use crate::world::{Addition, Change, World};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// # Height fields that change
impl World {
    /// Changes heights of a height field [m]: `size[0]` times `size[1]` samples from column `first[0]` and
    /// row `first[1]` on, row by row ([`HeightField::set_heights`]). Holes and materials stay. Equal heights
    /// change nothing and wake no body.
    ///
    /// Nearby bodies wake. Bodies on a surface that was lowered fall. A body that stood above the surface and
    /// would be below it is lifted, by any height and at once, until its centres are as far above as they
    /// were or by their inner radius; bodies that stand on it are lifted too. It gains no velocity. A static
    /// ceiling does not stop it. A body that was below the surface before stays there.
    ///
    /// Other shapes, worlds and snapshots that share the field keep theirs: the first edit then copies the
    /// field, others are made in place. If the least or the largest height of the whole field changes, its
    /// box does, and contacts of the shape begin anew as after [`World::set_geometry`].
    ///
    /// # Errors
    /// If the handle is stale, the shape is no height field, the region or a height is refused by the field,
    /// or the budget does not allow the copy.
    pub fn set_heights(
        &mut self,
        shape: ShapeHandle,
        first: [usize; 2],
        size: [usize; 2],
        heights: &[f32],
    ) -> Result<(), Error> {
        let collider = self.collider(shape)?;
        let patch = Patch { first, size, heights };
        let Some(field) = self.own_field(collider, |field| {
            field.check(&patch)?;
            Ok(field.has_heights(&patch))
        })?
        else {
            return Ok(());
        };
        self.note(Change::SetHeights(shape, &patch));
        let bounds = self.bounds_of_patch(collider, &field, &patch);
        self.disturb_box(&bounds);
        self.find_anew(collider, &bounds);
        // How far a ball of this radius has to go.
        let rise = |at: Vec3, radius: f32| {
            let [old, new] = field.heights_at(at.x, at.z, &patch)?;
            let above = at.y - old;
            (new > old && above > 0.0).then(|| above.min(radius) - (at.y - new))
        };
        self.lift(collider, &bounds, rise);
        self.revise(self.colliders.all[collider as usize].body as usize);
        self.exchange_field(collider, field, |field| field.edit(&patch));
        Ok(())
    }

    /// Makes holes of some cells of a height field and fills others: of `size[0]` times `size[1]` cells from
    /// column `first[0]` and row `first[1]` on, row by row, those are holes for which `holes` says so
    /// ([`HeightField::set_holes`]). Where all are so already nothing happens.
    ///
    /// Nearby bodies wake. Bodies on a cell that becomes a hole fall. A filled cell carries again. A shape in
    /// it whose centre is above the surface by less than its inner radius is lifted to that height, as by
    /// [`World::set_heights`], with the bodies that stand on its body; a shape that overlaps the surface from
    /// below is left to contacts. A shared field is copied as there.
    ///
    /// # Errors
    /// If the handle is stale, the shape is no height field, the region is refused by the field, or the
    /// budget does not allow the copy.
    pub fn set_holes(
        &mut self,
        shape: ShapeHandle,
        first: [usize; 2],
        size: [usize; 2],
        holes: &[bool],
    ) -> Result<(), Error> {
        let collider = self.collider(shape)?;
        let patch = HolePatch { first, size, holes };
        let Some(field) = self.own_field(collider, |field| {
            field.check_holes(&patch)?;
            Ok(field.has_holes_as(&patch))
        })?
        else {
            return Ok(());
        };
        self.note(Change::SetHoles(shape, &patch));
        let bounds = self.bounds_of_patch(collider, &field, &patch.samples());
        self.disturb_box(&bounds);
        self.find_anew(collider, &bounds);
        let rise = |at: Vec3, radius: f32| {
            let above = at.y - field.filled_at(at.x, at.z, &patch)?;
            (above > 0.0).then_some(radius - above)
        };
        self.lift(collider, &bounds, rise);
        self.revise(self.colliders.all[collider as usize].body as usize);
        self.exchange_field(collider, field, |field| field.edit_holes(&patch));
        Ok(())
    }

    /// The field of a shape, once it was checked; none if `check` says that it is so already. A copy of its
    /// own, which the budget counts, if other shapes have it too.
    fn own_field(
        &mut self,
        collider: u32,
        check: impl FnOnce(&HeightField) -> Result<bool, Error>,
    ) -> Result<Option<Arc<HeightField>>, Error> {
        let Geometry::HeightField(field) = &self.colliders.all[collider as usize].geometry else {
            return Err(Error::Degenerate("only a height field has heights and holes".into()));
        };
        if check(field)? {
            return Ok(None);
        }
        let mut field = field.clone();
        if self.assets.uses(&self.colliders.all[collider as usize].geometry) > 1 {
            field = Arc::new((*field).clone());
            self.reserve(Addition::Form(&Geometry::HeightField(field.clone())))?;
        }
        Ok(Some(field))
    }

    /// World bounds of the changed part of the surface, before and after.
    fn bounds_of_patch(&self, collider: u32, field: &HeightField, patch: &Patch<'_>) -> Aabb {
        let (low, high) = field.box_of(patch);
        let (pose, half) = (self.collider_pose(collider), 0.5 * (high - low));
        let middle = pose.position + (pose.rotation * (0.5 * (low + high))).as_dvec3();
        let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (pose.rotation * (axis * half)).abs());
        // Bodies that hover within the margin of contacts are included.
        let half = x + y + z + self.settings.length_unit;
        let middle = middle.as_vec3();
        Aabb { min: middle - half, max: middle + half }
    }

    /// Marks the contacts of a field with bodies in a box to be found again, and keeps these bodies awake.
    fn find_anew(&mut self, field: u32, bounds: &Aabb) {
        for place in 0..self.broad.pairs.len() {
            let pair = self.broad.pairs[place];
            if pair.a != field && pair.b != field {
                continue;
            }
            let other = if pair.a == field { pair.b } else { pair.a };
            if !self.bounds(other).overlaps(bounds) {
                continue;
            }
            let body = self.colliders.all[other as usize].body as usize;
            if let Some(rest) = self.bodies.rest.get_mut(body) {
                *rest = 0.0;
            }
            if pair.contact != NO_CONTACT {
                // Sentinel: a contact of a later fraction of the step is never kept.
                self.contacts.at_mut(pair.contact).fraction = f32::MIN_POSITIVE;
            }
        }
    }

    /// Lifts bodies that stood above the surface and would be below it, and bodies that stand on them.
    /// `rise`: how far a ball has to go up [m], from its centre in the field's frame and its radius.
    fn lift(&mut self, collider: u32, bounds: &Aabb, rise: impl Fn(Vec3, f32) -> Option<f32>) {
        let pose = self.collider_pose(collider);
        let (up, to_field) = (pose.rotation * Vec3::Y, pose.rotation.conjugate());
        let lift_of = |centre: DVec3, radius: f32| {
            let at = to_field * (centre - pose.position).as_vec3();
            rise(at, radius).map_or(0.0, |lift| lift.max(0.0))
        };
        let mut lifts: Vec<f32> = Vec::new();
        let dynamic = self.bodies.dynamic();
        for body in 0..dynamic {
            let mut most = 0.0f32;
            for &c in self.bodies.colliders[body].as_slice() {
                if !self.bounds(c).overlaps(bounds) {
                    continue;
                }
                let inner = self.colliders.all[c as usize].inner_radius;
                most = most.max(lift_of(self.collider_pose(c).position, inner));
                most = most.max(lift_of(self.bodies.pose[body].position, 0.0));
            }
            if most > 0.0 {
                lifts.resize(dynamic, 0.0);
                lifts[body] = most;
            }
        }
        if lifts.is_empty() {
            return;
        }
        while self.lift_what_stands_on(&mut lifts, up) {}
        for (body, lift) in lifts.into_iter().enumerate().filter(|(_, lift)| *lift > 0.0) {
            self.bodies.pose[body].position += (up * lift).as_dvec3();
            self.place_colliders(body);
            self.note_move(body);
            if let Some(rest) = self.bodies.rest.get_mut(body) {
                *rest = 0.0;
            }
        }
    }

    /// Passes lifts on to bodies whose lowest point is above the middle of a lifted neighbour; returns
    /// whether there were any. The largest lift wins, so the order doesn't matter.
    fn lift_what_stands_on(&self, lifts: &mut [f32], up: Vec3) -> bool {
        let mut any = false;
        for pair in &self.broad.pairs {
            for (low, high) in [(pair.a, pair.b), (pair.b, pair.a)] {
                let [under, over] = [low, high].map(|c| self.colliders.all[c as usize].body as usize);
                if under.max(over) >= lifts.len() || lifts[under] <= lifts[over] {
                    continue;
                }
                let (one, other) = (self.bounds(low), self.bounds(high));
                let half = 0.5 * (other.max - other.min);
                let bottom = up.dot(other.min + half) - up.abs().dot(half);
                if bottom >= up.dot(0.5 * (one.min + one.max)) && self.touches_from_above(&one, &other, up) {
                    lifts[over] = lifts[under];
                    any = true;
                }
            }
        }
        any
    }

    /// Whether a box stands over another, within the margin of contacts.
    fn touches_from_above(&self, one: &Aabb, other: &Aabb, up: Vec3) -> bool {
        let reach = up.abs() * self.settings.measures().touch;
        Aabb { min: one.min - reach, max: one.max + reach }.overlaps(other)
    }

    /// Edits a field that was checked, in place if it is not shared, and sets it as a shape's.
    fn exchange_field(
        &mut self,
        collider: u32,
        mut field: Arc<HeightField>,
        edit: impl FnOnce(&mut HeightField),
    ) {
        let before = field.aabb();
        {
            let World { colliders, needs, assets, .. } = self;
            let own = &mut colliders.all[collider as usize];
            needs.count(own, -1);
            assets.remove(&own.geometry);
            // The shape lets go of it, so that it counts as shared only if somebody else has it.
            own.geometry = Geometry::Plane;
            edit(Arc::make_mut(&mut field));
        }
        let moved = field.aabb() != before;
        if moved {
            self.leave_broad(collider);
        }
        let World { colliders, needs, assets, bodies, .. } = self;
        let rare = colliders.rare(collider);
        let own = &mut colliders.all[collider as usize];
        own.set_geometry(Geometry::HeightField(field), rare);
        needs.count(own, 1);
        assets.add(&own.geometry);
        colliders.summaries[collider as usize] = own.summaries(bodies.mode(own.body as usize));
        if moved {
            self.enter_broad(collider);
        } else {
            self.note_change(collider);
            self.buffers.finish.statics_changed();
        }
    }
}
