//! Snapshots of a world, from which it continues to the same bits.
//!
//! State that changes in every step is written into one buffer ([`save`], [`contacts`]); state that seldom
//! changes is written once and shared ([`part`]). Reading ([`view`]) comes before checking ([`check`], for
//! bytes from outside), and both before the world is touched ([`restore`]). `docs/decisions/snapshots.md`
//! says of each thing in a world whether it is saved, and why.

mod bytes;
mod characters;
mod check;
mod checksum;
mod contacts;
mod geometry;
mod part;
#[cfg(feature = "replay")]
mod recorded;
mod restore;
mod save;
mod settings;
mod view;

use crate::error::Error;
#[cfg(feature = "replay")]
use crate::world::Change;
use crate::world::{SharedPart, World};
use part::{Part, Which};
#[cfg(feature = "replay")]
pub(crate) use recorded::RecordedPart;
use std::sync::{Arc, PoisonError, Weak};

/// The state of a world at one time, for [`World::restore`].
///
/// A snapshot keeps everything that the future of the world depends on, to the bit: poses, velocities,
/// pending forces, pairs with their contacts and impulses, joints, sleep, characters, and settings except
/// threads and budget. The list of bodies, shapes and joints is shared by all snapshots between which it did
/// not change, and geometry is shared with the world.
///
/// The buffer is used again by the next [`World::snapshot`] into it.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    words: Vec<u32>,
    parts: [Option<Arc<Part>>; 2],
    /// Hulls of characters.
    forms: Vec<geometry::Known>,
    /// For a snapshot from bytes, the fingerprints of its parts, which the restored world has to have.
    foreign: Option<[[u64; 2]; 2]>,
    /// The arrangement of joints that belongs to it, if they were arranged.
    arrangement: Option<u64>,
    /// Bytes that rows of joints held or were promised: as much suffices to arrange them again. Unknown for a
    /// snapshot from bytes.
    joint_rows: Option<usize>,
    /// All of it did not fit in the budget of its world, which was lowered: then it need not fit again.
    over_budget: bool,
}

impl Snapshot {
    /// An empty one, to be filled by [`World::snapshot`].
    pub fn new() -> Snapshot {
        Snapshot::default()
    }

    /// Bytes of the state: the size of a snapshot if no body, shape or joint was added, removed or changed
    /// since the previous one. Shared parts are not counted.
    pub fn size(&self) -> usize {
        self.words.len() * size_of::<u32>()
    }

    /// Hash of the state: of all that outlives a step and may change in one, to the bit. Two worlds with the
    /// same bodies, shapes, joints and forms of characters have the same future if it is the same. It differs
    /// from the step on in which anything differs; [`World::state_hash`] only once a pose or velocity does.
    pub fn hash(&self) -> u64 {
        // Without the head, which identifies the bytes.
        checksum::hash(self.words.get(view::HEAD..).unwrap_or_default())
    }

    /// Bytes of the parts that snapshots share until bodies, shapes or joints are added, removed or changed.
    pub fn shared_size(&self) -> usize {
        self.parts.iter().flatten().map(|part| part.words.len() * size_of::<u32>()).sum()
    }
}

/// # Snapshots
impl World {
    /// Writes the state of the world into a snapshot. Allocates nothing once the snapshot's buffer is large
    /// enough, unless bodies, shapes or joints were added, removed or changed since the last one. A world
    /// that a panic left half stepped has no snapshot: it is empty, and can't be restored.
    ///
    /// ```
    /// use backstop::{BodyDesc, Geometry, Settings, ShapeDesc, Snapshot, World};
    ///
    /// # fn main() -> Result<(), backstop::Error> {
    /// let mut world = World::new(Settings::default())?;
    /// let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.5 });
    /// world.add_body(&BodyDesc::dynamic().with_shape(ball))?;
    /// let mut saved = Snapshot::default();
    /// world.snapshot(&mut saved);
    /// world.step(1.0 / 60.0)?;
    /// let once = world.state_hash();
    /// // Back, and the same step again: the same bits.
    /// world.restore(&saved)?;
    /// world.step(1.0 / 60.0)?;
    /// assert_eq!(world.state_hash(), once);
    /// # Ok(())
    /// # }
    /// ```
    pub fn snapshot(&self, into: &mut Snapshot) {
        into.foreign = None;
        if self.stage.is_some() {
            // A half finished step is not a valid state.
            into.words.clear();
            into.parts = [None, None];
            into.forms.clear();
            return;
        }
        into.parts = self.parts().map(Some);
        into.arrangement = (!self.joints.changed).then_some(self.buffers.joints.arrangement);
        (into.joint_rows, into.over_budget) = (Some(self.bytes_of_joint_rows()), self.is_over_budget());
        save::save(self, &mut into.forms, &mut into.words);
    }

    /// Restores the world to the time of a snapshot: its next steps give the same bits as then, with any
    /// number of threads. Bodies, shapes and joints that were added since are removed, those that were
    /// removed are back, with the same handles. The snapshot may be of another world.
    ///
    /// [`Settings::threads`](crate::Settings::threads), [`Settings::budget`](crate::Settings::budget) and
    /// [`World::report`] stay as they are. A world that a panic left half stepped ([`Error::Poisoned`]) is
    /// valid again.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// let mut snapshot = Snapshot::new();
    /// world.snapshot(&mut snapshot);
    /// let before = world.state_hash();
    /// world.step(1.0 / 60.0)?;
    /// world.restore(&snapshot)?;
    /// assert_eq!(world.state_hash(), before);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the world's budget does not allow the bytes that the snapshot needs; and for snapshots from bytes:
    /// if they are broken, or the world lacks geometry to which they refer.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), Error> {
        #[cfg(feature = "replay")]
        if self.recorder.is_some() {
            return self.restore_recorded(snapshot);
        }
        restore::restore(self, snapshot)
    }

    /// Restores the world and has its recorder note it: nothing can refuse it only once it is done.
    #[cfg(feature = "replay")]
    fn restore_recorded(&mut self, snapshot: &Snapshot) -> Result<(), Error> {
        let noted = snapshot.with_geometry_of(self)?;
        let asked = self.was_asked();
        restore::restore(self, snapshot)?;
        if let Some(recorder) = &mut self.recorder {
            recorder.note(Change::Restore(&*noted), asked);
        }
        Ok(())
    }

    /// The parts that snapshots share, as they are now.
    fn parts(&self) -> [Arc<Part>; 2] {
        let revisions = self.revision_numbers();
        let mut written = self.revisions.written.lock().unwrap_or_else(PoisonError::into_inner);
        [Which::Fixed, Which::Moving].map(|which| {
            let (revision, part) = &mut written[which as usize];
            let known = part.as_ref().and_then(Weak::upgrade).and_then(|part| part.downcast::<Part>().ok());
            let known = known.filter(|_| *revision == revisions[which as usize]);
            known.unwrap_or_else(|| {
                let new = Arc::new(Part::of(self, which));
                (*revision, *part) = (revisions[which as usize], Some(weak(&new)));
                new
            })
        })
    }

    /// The parts, if they are known to be these.
    fn has_parts(&self, parts: &[Arc<Part>; 2]) -> bool {
        let revisions = self.revision_numbers();
        let written = self.revisions.written.lock().unwrap_or_else(PoisonError::into_inner);
        let same = |i: usize| {
            let part = written[i].1.as_ref();
            part.is_some_and(|part| std::ptr::addr_eq(part.as_ptr(), Arc::as_ptr(&parts[i])))
        };
        (0..2).all(|i| written[i].0 == revisions[i] && same(i))
    }

    /// Notes that the world's parts are these now.
    fn keep_parts(&mut self, parts: &[Arc<Part>; 2]) {
        let revisions = self.revision_numbers();
        let written = self.revisions.written.get_mut().unwrap_or_else(PoisonError::into_inner);
        for i in 0..2 {
            written[i] = (revisions[i], Some(weak(&parts[i])));
        }
    }

    fn revision_numbers(&self) -> [u64; 2] {
        [self.revisions.fixed + self.broad.statics_changes(), self.revisions.moving]
    }
}

/// The world keeps parts without knowing their types.
fn weak(part: &Arc<Part>) -> SharedPart {
    let weak: Weak<Part> = Arc::downgrade(part);
    weak
}
