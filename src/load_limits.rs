//! Limits on the resources for reading a file. Files come from strangers: a few hundred bytes may ask for
//! gigabytes.

use std::fmt;

/// The most that a file may ask for while it is read. Anything beyond is refused before memory is reserved
/// for it, by an error that names the limit.
///
/// Content that is built several times, because it is used at several places or scales, counts each time;
/// shared content counts once. No honest scene for a game meets a default.
///
/// ```
/// use backstop::LoadLimits;
/// let mut limits = LoadLimits::default();
/// limits.triangles = 100_000;
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct LoadLimits {
    /// Bytes of a scene's file, its buffers and images together; of a recording, which is not read at once,
    /// those of one block. Default 1 GiB.
    pub bytes: u64,
    /// Nodes of a scene that are walked through, those below a collider's geometry once more. Default 10
    /// million.
    pub nodes: u64,
    /// How deep nodes of a scene lie within each other. Default 1000.
    pub depth: u64,
    /// Vertices. Default 10 million.
    pub vertices: u64,
    /// Triangles, two for a cell of a height field. Default 10 million.
    pub triangles: u64,
    /// Bodies; of a recording at a time. Default 1 million.
    pub bodies: u64,
    /// Joints with their limits and motors; of a recording at a time, joints alone, and couplings. Default 1
    /// million.
    pub joints: u64,
    /// Bytes of the geometry that a recording has, and of the world that it plays in: that world's budget, if
    /// it has no lower one. Default 1 GiB.
    pub memory: u64,
}

impl Default for LoadLimits {
    fn default() -> LoadLimits {
        let (million, gib) = (1_000_000, 1 << 30);
        LoadLimits {
            bytes: gib,
            nodes: 10 * million,
            depth: 1000,
            vertices: 10 * million,
            triangles: 10 * million,
            bodies: million,
            joints: million,
            memory: gib,
        }
    }
}

impl LoadLimits {
    /// No limits: for files that are trusted.
    pub const NONE: LoadLimits = LoadLimits {
        bytes: u64::MAX,
        nodes: u64::MAX,
        depth: u64::MAX,
        vertices: u64::MAX,
        triangles: u64::MAX,
        bodies: u64::MAX,
        joints: u64::MAX,
        memory: u64::MAX,
    };
}

/// A file asks for more than one of [`LoadLimits`] allows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct LimitExceeded {
    /// The name of the limit: of a field of [`LoadLimits`].
    pub limit: &'static str,
    /// Its value.
    pub most: u64,
}

impl fmt::Display for LimitExceeded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "it asks for more than the load limit `{}` allows, which is {}", self.limit, self.most)
    }
}

impl std::error::Error for LimitExceeded {}

/// A limit, and the part of it that is used.
#[derive(Debug)]
pub struct Count {
    limit: &'static str,
    most: u64,
    taken: u64,
}

impl Count {
    fn new(limit: &'static str, most: u64) -> Count {
        Count { limit, most, taken: 0 }
    }

    /// The limit.
    pub fn most(&self) -> u64 {
        self.most
    }

    /// The amount left.
    pub fn left(&self) -> u64 {
        self.most - self.taken
    }

    /// The error that says it is exceeded.
    pub fn exceeded(&self) -> LimitExceeded {
        LimitExceeded { limit: self.limit, most: self.most }
    }

    /// Whether so much is within the limit by itself.
    ///
    /// # Errors
    /// If it is not.
    pub fn allow(&self, amount: usize) -> Result<(), LimitExceeded> {
        if amount as u64 <= self.most { Ok(()) } else { Err(self.exceeded()) }
    }

    /// Takes so much of it.
    ///
    /// # Errors
    /// If less is left; then nothing is taken.
    pub fn take(&mut self, amount: usize) -> Result<(), LimitExceeded> {
        if amount as u64 > self.left() {
            return Err(self.exceeded());
        }
        self.taken += amount as u64;
        Ok(())
    }
}

/// Counts how much a file has used of its [`LoadLimits`] so far, for readers of other formats.
#[derive(Debug)]
pub struct Tally {
    /// Of [`LoadLimits::bytes`].
    pub bytes: Count,
    /// Of [`LoadLimits::nodes`].
    pub nodes: Count,
    /// Of [`LoadLimits::depth`].
    pub depth: Count,
    /// Of [`LoadLimits::vertices`].
    pub vertices: Count,
    /// Of [`LoadLimits::triangles`].
    pub triangles: Count,
    /// Of [`LoadLimits::bodies`].
    pub bodies: Count,
    /// Of [`LoadLimits::joints`].
    pub joints: Count,
    /// Of [`LoadLimits::memory`].
    pub memory: Count,
}

impl Tally {
    /// Nothing is taken yet.
    pub fn new(limits: &LoadLimits) -> Tally {
        Tally {
            bytes: Count::new("bytes", limits.bytes),
            nodes: Count::new("nodes", limits.nodes),
            depth: Count::new("depth", limits.depth),
            vertices: Count::new("vertices", limits.vertices),
            triangles: Count::new("triangles", limits.triangles),
            bodies: Count::new("bodies", limits.bodies),
            joints: Count::new("joints", limits.joints),
            memory: Count::new("memory", limits.memory),
        }
    }
}
