//! Blocks of work, claimed one by one; all that knows rayon.

/// Who works on a step: the caller alone, or with helpers.
#[derive(Clone, Copy)]
pub(crate) struct Crew<'a> {
    shared: Option<&'a ()>,
}

impl Crew<'_> {
    /// Only the caller.
    pub(crate) fn alone() -> Self {
        Crew { shared: None }
    }

    /// Runs `work` once for each block in `0..blocks` and returns when all are done. Blocks run in any order and at
    /// the same time: what a block writes must be its own.
    pub(crate) fn run(&self, blocks: usize, work: &(dyn Fn(usize) + Sync)) {
        for block in 0..blocks {
            work(block);
        }
    }
}
