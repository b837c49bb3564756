//! Restitution: impacts are events, each solved at its time within the substep, before the rows.
//!
//! A row removes the velocity that would cross a surface, and with it the speed of the impact: the result
//! tells neither how fast two bodies met nor, in a row of balls, which met first. So before the rows of a
//! substep, manifolds with restitution that close within it, faster than the threshold, are solved one by one
//! in the order of their times ([`meet`]), with the velocities at that time: by Newton's law of impact and
//! Coulomb's of friction. Impacts that follow from one come next, so a row of balls passes motion on from
//! ball to ball. The rows then see separating velocities.
//!
//! [`find`] lists the manifolds of a step. Most steps have no impact, and then there is no list.

mod find;
mod meet;
mod queue;
mod strike;

use crate::lanes::Record;
use crate::math::Quat;
use crate::memory::buffers;
pub(crate) use find::find;
use glam::Vec3;
pub(crate) use meet::Bodies;

/// Instead of an index.
const NONE: u32 = u32::MAX;

/// A point of a manifold with restitution.
#[derive(Clone, Copy, Debug)]
struct Spot {
    /// The normal points from the first to the second.
    bodies: [u32; 2],
    normal: Vec3,
    /// From the bodies' centres [m].
    arms: [Vec3; 2],
    /// At the start of the step [m].
    separation: f32,
    restitution: f32,
    friction: f32,
    /// The contact.
    slot: u32,
    /// Index among all spots, in the order of pairs: a restored snapshot may have given contacts other slots.
    order: u32,
}

/// All points between two bodies, or between one body and all that can't be pushed: they are solved together,
/// so that a body that lands flat stays flat.
#[derive(Clone, Copy, Debug)]
struct Site {
    first: u32,
    count: u32,
    /// The bodies that an impact changes, the second or [`NONE`].
    bodies: [u32; 2],
    /// For each body: its next site, and which side of that it is.
    next: [Link; 2],
    /// When it next closes within the substep [s], and how fast then [m/s].
    time: f32,
    approach: f32,
    /// Position in the queue, or [`NONE`].
    place: u32,
    /// Impacts in this substep.
    hits: u32,
    /// It closes in this step, or a body of it was struck: it is checked in each substep.
    wakeful: bool,
}

/// A site and the side of it on which a body is.
#[derive(Clone, Copy, Debug)]
struct Link {
    site: u32,
    side: u32,
}

impl Link {
    const NONE: Link = Link { site: NONE, side: 0 };
}

/// State of a dynamic body.
#[derive(Clone, Copy, Debug)]
struct Struck {
    first: Link,
    /// It has joints, which would be torn by displacing it alone.
    joined: bool,
    /// It had an impact in this step.
    bounced: bool,
    /// Displacement by its impacts in this substep, if it is in the list of displaced bodies.
    moved: Record,
    listed: bool,
    /// It is held for the rest of the step, and has this velocity afterwards.
    stands: bool,
    velocity_after: Record,
    /// Its acceleration, which is zero meanwhile.
    pull: Record,
    /// Orientation at its last impact in this step, and the time of that [s], if its principal moments
    /// differ.
    turned: Option<(Quat, f32)>,
}

/// The impacts of a step.
#[derive(Debug, Default)]
pub(crate) struct Restitution {
    spots: Vec<Spot>,
    sites: Vec<Site>,
    struck: Vec<Struck>,
    /// Sites by time, a binary heap.
    queue: Vec<u32>,
    wakeful: Vec<u32>,
    /// Bodies that were displaced in this substep.
    moved: Vec<u32>,
    /// Bodies that are held.
    standing: Vec<u32>,
    /// Number of impacts that were solved.
    pub(crate) count: u32,
}

buffers! { Restitution { bytes { spots, sites, struck, queue, wakeful, moved, standing } } }

impl Restitution {
    #[cfg(debug_assertions)]
    pub(crate) fn spoil(&mut self) {
        use crate::memory::spoil;
        let Restitution { spots, sites, struck, queue, wakeful, moved, standing, count: _ } = self;
        spoil(spots);
        spoil(sites);
        spoil(struck);
        [queue, wakeful, moved, standing].into_iter().for_each(spoil);
    }

    /// Orientation of a body at its last impact in the step, and the time of that [s], if its principal
    /// moments differ.
    pub(crate) fn turned(&self, body: usize) -> Option<(Quat, f32)> {
        self.struck.get(body).and_then(|struck| struck.turned)
    }

    /// Forgets the impacts of a body: something else decides where it is at the end of the step, and how it
    /// moves.
    #[cfg(feature = "observe")]
    pub(crate) fn forget(&mut self, body: usize) {
        if let Some(struck) = self.struck.get_mut(body) {
            (struck.turned, struck.bounced) = (None, false);
        }
    }

    /// Whether a body bounced in the step.
    pub(crate) fn bounced(&self, body: usize) -> bool {
        self.struck.get(body).is_some_and(|struck| struck.bounced)
    }

    /// Whether a body is held for the rest of the step.
    pub(crate) fn stands(&self, body: u32) -> bool {
        self.struck.get(body as usize).is_some_and(|struck| struck.stands)
    }

    /// The bodies that are held.
    pub(crate) fn standing(&self) -> &[u32] {
        &self.standing
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.wakeful.is_empty()
    }

    /// Clears the last step.
    pub(crate) fn clear(&mut self) {
        self.spots.clear();
        self.sites.clear();
        self.struck.clear();
        self.queue.clear();
        self.wakeful.clear();
        self.moved.clear();
        self.standing.clear();
        self.count = 0;
    }
}
