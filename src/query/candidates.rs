//! The shapes that a query has to test, with their present poses.

use super::filter::{QueryFilter, QueryTarget, Sees};
use crate::body::{BodyKind, Pose};
use crate::broad_phase::{Aabb, QueryTree, WorldView};
use crate::error::Error;
use crate::handle::{BodyHandle, ShapeHandle};
use crate::lanes::f32x4;
use crate::math::Quat;
use crate::memory::Category;
use crate::shape::{Collider, Near, Slabs};
use crate::world::World;
use glam::{DVec3, Vec3};

/// A shape where it is now.
pub(super) struct Candidate<'a> {
    pub(super) index: u32,
    pub(super) shape: &'a Collider,
    pub(super) place: Pose,
}

impl Candidate<'_> {
    /// A point of the world in the shape's frame.
    pub(super) fn local(&self, point: DVec3) -> DVec3 {
        turn_back(self.place.rotation, point - self.place.position)
    }
    /// A point of the shape's frame in the world.
    pub(super) fn global(&self, point: DVec3) -> DVec3 {
        self.place.position + turn(self.place.rotation, point)
    }
    /// A unit vector of the shape's frame in the axes of the world.
    pub(super) fn global_normal(&self, normal: DVec3) -> Vec3 {
        turn(self.place.rotation, normal).as_vec3()
    }
}

/// Rotates a vector by a quaternion that may be slightly off unit length, which would be noticeable in `f64`.
pub(super) fn turn(rotation: Quat, v: DVec3) -> DVec3 {
    let q = rotation.as_dquat();
    let (u, twice) = (q.xyz(), 2.0 / q.length_squared());
    let across = u.cross(v);
    v + (across * q.w + u.cross(across)) * twice
}

/// Turns a vector the other way.
pub(super) fn turn_back(rotation: Quat, v: DVec3) -> DVec3 {
    turn(rotation.conjugate(), v)
}

impl WorldView for World {
    fn each_mover(&self, f: &mut dyn FnMut(u32)) {
        // Sleeping ones too: they may have moved in the step in which they fell asleep.
        let there = |&body: &usize| !self.bodies.traits[body].disabled;
        for body in (0..self.bodies.movers()).chain(self.bodies.asleep().filter(there)) {
            self.bodies.colliders[body].as_slice().iter().for_each(|&c| f(c));
        }
    }
    fn moves(&self, collider: u32) -> Option<bool> {
        let body = self.colliders.all.get(collider as usize).map_or(u32::MAX, |collider| collider.body);
        let there = body != u32::MAX && !self.bodies.traits[body as usize].disabled;
        there.then(|| self.bodies.kind[body as usize] != BodyKind::Static)
    }
    fn bounds(&self, collider: u32) -> Aabb {
        World::bounds(self, collider)
    }
}

impl World {
    /// The tree of movable bodies, as it is now.
    ///
    /// # Errors
    /// If the budget does not allow it.
    #[inline]
    pub(crate) fn current(&self) -> Result<&QueryTree, Error> {
        let grant = |bytes: usize| self.grant(Category::BroadPhase, bytes);
        let bounded: Option<&dyn Fn(usize) -> Result<(), Error>> =
            if self.settings.budget.is_none() { None } else { Some(&grant) };
        self.now.get(&self.broad, self, bounded)
    }

    /// Calls `ask` with every shape that the filter sees and whose box a box of half extents `half`, which
    /// moves along `path`, meets before the fraction `most`; about the nearest first. `ask` returns the new
    /// `most`.
    ///
    /// # Errors
    /// If the budget does not allow the tree of movable bodies.
    #[inline]
    pub(super) fn along<'a>(
        &'a self,
        from: DVec3,
        path: Vec3,
        half: Vec3,
        filter: &QueryFilter<'_>,
        most: f32,
        mut ask: impl FnMut(&Candidate<'a>, f32) -> f32,
    ) -> Result<(), Error> {
        if let Some(target) = filter.only {
            return self.on_target(target, filter, most, &mut ask);
        }
        let sees = Sees::new(self, filter);
        let slabs = Slabs::<f32x4>::new(from, path, half);
        self.broad.ordered_path(self.current()?, filter.sorts(), &slabs, most, |index, most| {
            let shape = &self.colliders.all[index as usize];
            if !sees.sees(index, shape) {
                return most;
            }
            ask(&self.candidate(index), most)
        });
        Ok(())
    }

    /// Calls `ask` with every shape that the filter sees and whose box may be within the squared distance
    /// `most` of a point [m²]; about the nearest first. `ask` returns the new `most`.
    ///
    /// # Errors
    /// As for [`World::along`].
    pub(super) fn around<'a>(
        &'a self,
        point: DVec3,
        filter: &QueryFilter<'_>,
        most: f32,
        mut ask: impl FnMut(&Candidate<'a>, f32) -> f32,
    ) -> Result<(), Error> {
        if let Some(target) = filter.only {
            return self.on_target(target, filter, most, &mut ask);
        }
        let sees = Sees::new(self, filter);
        let near = Near::<f32x4>::new(point);
        self.broad.ordered_near(self.current()?, filter.sorts(), &near, most, |index, most| {
            let shape = &self.colliders.all[index as usize];
            if !sees.sees(index, shape) {
                return most;
            }
            ask(&self.candidate(index), most)
        });
        Ok(())
    }

    /// Calls `ask` with the shapes of a target that the filter sees, until `most` is below zero.
    ///
    /// # Errors
    /// If the target's handle is stale.
    #[inline(never)]
    fn on_target<'a>(
        &'a self,
        target: QueryTarget,
        filter: &QueryFilter<'_>,
        mut most: f32,
        ask: &mut dyn FnMut(&Candidate<'a>, f32) -> f32,
    ) -> Result<(), Error> {
        let one;
        let (body, shapes) = match target {
            QueryTarget::Body(body) => {
                let index = self.index(body)?;
                (index, self.bodies.colliders[index].as_slice())
            }
            QueryTarget::Shape(shape) => {
                one = [self.collider(shape)?];
                (self.colliders.all[one[0] as usize].body as usize, one.as_slice())
            }
        };
        if self.bodies.traits[body].disabled {
            return Ok(());
        }
        let sees = Sees::new(self, filter);
        for &index in shapes {
            if sees.sees(index, &self.colliders.all[index as usize]) {
                most = ask(&self.candidate(index), most);
            }
            if most < 0.0 {
                break;
            }
        }
        Ok(())
    }

    /// Makes sure that a query with this filter can't be refused any more.
    ///
    /// # Errors
    /// If the budget does not allow the tree of movable bodies, or the target of the filter is stale.
    pub(super) fn ready(&self, filter: &QueryFilter<'_>) -> Result<(), Error> {
        match filter.only {
            None => self.current().map(drop),
            Some(QueryTarget::Body(body)) => self.index(body).map(drop),
            Some(QueryTarget::Shape(shape)) => self.collider(shape).map(drop),
        }
    }

    #[inline]
    pub(super) fn candidate(&self, index: u32) -> Candidate<'_> {
        let shape = &self.colliders.all[index as usize];
        let place = self.bodies.pose[shape.body as usize].of_part(shape.position, shape.rotation);
        Candidate { index, shape, place }
    }

    /// Handles of a shape and its body.
    pub(super) fn handles(&self, index: u32) -> (BodyHandle, ShapeHandle) {
        let body = self.colliders.all[index as usize].body as usize;
        (self.handle_of(body), self.shape_handle(index))
    }
}
