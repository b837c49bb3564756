//! Bodies far from all viewers are switched off, island by island.

use crate::body::BodyKind;
use crate::error::Error;
use crate::handle::BodyHandle;
use crate::limits;
use crate::world::World;
use glam::DVec3;
use std::collections::BTreeMap;

/// Switches off dynamic bodies that are far from all viewers, and on again when a viewer comes near.
///
/// Bodies that touch or are joined go together, so that a pile is never left without its foot: all of an
/// island have to be far, and one that is near is enough to bring back all. A body that is off keeps its pose
/// and its velocity ([`World::set_enabled`]), is not hit by queries and costs nothing in a step. Bodies that
/// the caller disabled are left alone.
///
/// ```
/// use backstop::glam::DVec3;
/// use backstop::{BodyDesc, Geometry, LevelOfDetail, Settings, ShapeDesc, World};
///
/// # fn main() -> Result<(), backstop::Error> {
/// let mut world = World::new(Settings::default())?;
/// let ball = ShapeDesc::new(Geometry::sphere(0.5));
/// let ball = world.add_body(&BodyDesc::dynamic().with_shape(ball))?;
/// let mut detail = LevelOfDetail::new(80.0, 100.0)?;
/// // Now and then, not in each step.
/// detail.update(&mut world, &[DVec3::X * 200.0])?;
/// assert!(!world.is_enabled(ball)?);
/// detail.update(&mut world, &[DVec3::X * 90.0])?;
/// assert!(!world.is_enabled(ball)?);
/// detail.update(&mut world, &[DVec3::X * 70.0])?;
/// assert!(world.is_enabled(ball)?);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LevelOfDetail {
    near: f64,
    far: f64,
    /// Islands that are off.
    off: Vec<Vec<BodyHandle>>,
}

impl LevelOfDetail {
    /// Islands are switched off beyond `far` [m] of all viewers, and on within `near` [m] of one. What lies
    /// between keeps them from going on and off at each step of a viewer.
    ///
    /// # Errors
    /// If a distance is not finite, below zero, or `near` is not below `far`.
    pub fn new(near: f32, far: f32) -> Result<LevelOfDetail, Error> {
        limits::amount("near distance", near)?;
        limits::amount("far distance", far)?;
        if near >= far {
            let value = near.into();
            return Err(Error::OutOfRange { what: "near distance", expected: "below the far one", value });
        }
        Ok(LevelOfDetail { near: near.into(), far: far.into(), off: Vec::new() })
    }

    /// Switches islands on and off by the places of viewers [m]: call it when the world is not in a step, as
    /// often as viewers move by a part of the distance between `near` and `far`. Without viewers all is far.
    /// Returns how many bodies it keeps off.
    ///
    /// # Errors
    /// If a place is not finite, or the budget does not allow bodies to come back.
    pub fn update(&mut self, world: &mut World, viewers: &[DVec3]) -> Result<usize, Error> {
        viewers.iter().try_for_each(|&viewer| limits::position(viewer))?;
        for group in &mut self.off {
            group.retain(|&body| world.is_enabled(body) == Ok(false));
        }
        let mut kept = Vec::with_capacity(self.off.len());
        for group in std::mem::take(&mut self.off) {
            if any_within(world, &group, viewers, self.near)? {
                for &body in &group {
                    world.set_enabled(body, true)?;
                }
            } else if !group.is_empty() {
                kept.push(group);
            }
        }
        self.off = kept;
        for group in islands(world)? {
            if !any_within(world, &group, viewers, self.far)? {
                for &body in &group {
                    world.set_enabled(body, false)?;
                }
                self.off.push(group);
            }
        }
        Ok(self.off.iter().map(Vec::len).sum())
    }

    /// Switches all bodies on again that it has switched off.
    ///
    /// # Errors
    /// If the budget does not allow it.
    pub fn clear(&mut self, world: &mut World) -> Result<(), Error> {
        for body in self.off.drain(..).flatten() {
            if world.contains(body) {
                world.set_enabled(body, true)?;
            }
        }
        Ok(())
    }
}

/// Whether any of some bodies is within a distance of any viewer.
fn any_within(world: &World, group: &[BodyHandle], viewers: &[DVec3], distance: f64) -> Result<bool, Error> {
    for &body in group {
        let at = world.centre_of_mass(body)?;
        if viewers.iter().any(|viewer| viewer.distance_squared(at) <= distance * distance) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Dynamic bodies that are enabled, those together that touch or are joined: by handle, each and all.
fn islands(world: &World) -> Result<Vec<Vec<BodyHandle>>, Error> {
    let is_dynamic =
        |&body: &BodyHandle| world.kind(body) == Ok(BodyKind::Dynamic) && world.is_enabled(body) == Ok(true);
    let mut bodies: Vec<BodyHandle> = world.bodies().filter(is_dynamic).collect();
    bodies.sort_unstable();
    let mut above: Vec<usize> = (0..bodies.len()).collect();
    let mut tie = |pair: [BodyHandle; 2]| {
        let places = pair.map(|body| bodies.binary_search(&body));
        if let [Ok(a), Ok(b)] = places {
            let (a, b) = (top(&mut above, a), top(&mut above, b));
            above[a.max(b)] = a.min(b);
        }
    };
    world.contacts().for_each(|contact| tie(contact.bodies));
    for &body in &bodies {
        for joint in world.joints_of(body)? {
            tie(world.joint_bodies(joint)?);
        }
    }
    let mut groups: BTreeMap<usize, Vec<BodyHandle>> = BTreeMap::new();
    for (i, &body) in bodies.iter().enumerate() {
        groups.entry(top(&mut above, i)).or_default().push(body);
    }
    Ok(groups.into_values().collect())
}

/// The first of those that are tied to one, and a shorter way to it.
fn top(above: &mut [usize], mut i: usize) -> usize {
    while above[i] != i {
        above[i] = above[above[i]];
        i = above[i];
    }
    i
}
