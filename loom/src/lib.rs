//! A model check of the block scheduler: loom runs each case below in every order of events that the memory
//! model allows, up to a bound of preemptions where it is said, and keeps track of who may read and write
//! what. The file that is checked is the engine's own, with loom's atomics in the place of the standard
//! library's.
//!
//! Each block writes a cell of its own without synchronisation, and the caller reads all cells when `run` has
//! returned. So loom reports a block that is not done by then, or done twice, or whose writes the caller need
//! not see; and, as the work pointer is such a cell too, a helper that reads it while the caller may write. A
//! thread that waits for ever exceeds loom's limit of events, which is a failure too.

#![cfg(test)]

#[path = "../../src/threads/stage.rs"]
mod stage;
mod sync;

use loom::cell::UnsafeCell;
use loom::thread::{self, JoinHandle};
use stage::{End, Quit, Stage};
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Checks `case` with so many preemptions at most, of threads that did not wait, or `LOOM_MAX_PREEMPTIONS`;
/// prints the number of its executions.
fn check(name: &str, preemptions: usize, case: impl Fn() + Send + Sync + 'static) {
    let executions = Arc::new(AtomicUsize::new(0));
    let counted = executions.clone();
    let mut builder = loom::model::Builder::new();
    builder.preemption_bound.get_or_insert(preemptions);
    builder.check(move || {
        counted.fetch_add(1, Relaxed);
        case();
    });
    println!("{name}: {} executions", executions.load(Relaxed));
}

/// How often each block of a stage ran.
struct Counts(Vec<UnsafeCell<u32>>);

// SAFETY: loom reports accesses of two threads to a cell that nothing orders.
unsafe impl Sync for Counts {}

impl Counts {
    fn new(blocks: usize) -> Self {
        Counts((0..blocks).map(|_| UnsafeCell::new(0)).collect())
    }

    fn add(&self, block: usize) {
        // SAFETY: as above; loom stops the case before a race.
        self.0[block].with_mut(|count| unsafe { *count += 1 });
    }

    fn get(&self) -> Vec<u32> {
        // SAFETY: as above.
        self.0.iter().map(|cell| cell.with(|count| unsafe { *count })).collect()
    }
}

fn run(stage: &Stage, blocks: usize) {
    let counts = Counts::new(blocks);
    stage.run(blocks, &|block| counts.add(block));
    assert_eq!(counts.get(), vec![1; blocks]);
}

/// The name of a helper's thread.
const HELPER: &str = "helper";

/// Threads in the place of the pool's. All go on when the case is over.
#[derive(Default)]
struct Helpers(RefCell<Vec<JoinHandle<()>>>);

impl Helpers {
    fn spawn(&self, stage: &Arc<Stage>, number: usize) {
        let stage = stage.clone();
        let thread = thread::Builder::new().name(HELPER.into()).spawn(move || stage.answer(number));
        self.0.borrow_mut().push(thread.unwrap());
    }
}

impl Drop for Helpers {
    fn drop(&mut self) {
        self.0.borrow().iter().for_each(|helper| helper.thread().unpark());
    }
}

/// A step from outside of the pool, as `with_crew` does it.
fn step(stage: &Arc<Stage>, helping: usize, helpers: &Helpers, stages: impl FnOnce()) {
    stage.open();
    let _quit = Quit { stage, wait: false };
    stage.call(helping, |number| helpers.spawn(stage, number));
    stages();
}

/// The stages have as many blocks each: a helper that slept through one meets the same ticket in the next.
#[test]
fn two_stages_with_one_helper() {
    check("two stages of two blocks, one helper", 3, || {
        let stage = Arc::new(Stage::default());
        step(&stage, 1, &Helpers::default(), || [2, 2].iter().for_each(|&blocks| run(&stage, blocks)));
    });
    check("stages of three and two blocks, one helper", 3, || {
        let stage = Arc::new(Stage::default());
        step(&stage, 1, &Helpers::default(), || [3, 2].iter().for_each(|&blocks| run(&stage, blocks)));
    });
}

#[test]
fn two_stages_with_two_helpers() {
    check("two stages of two blocks, two helpers", 2, || {
        let stage = Arc::new(Stage::default());
        step(&stage, 2, &Helpers::default(), || [2, 2].iter().for_each(|&blocks| run(&stage, blocks)));
    });
}

/// A helper of the first step may arrive, or go on, in the second, or when the world is gone.
#[test]
fn two_steps_whose_helpers_come_late() {
    check("two steps, one helper each", 3, || {
        let (stage, helpers) = (Arc::new(Stage::default()), Helpers::default());
        step(&stage, 1, &helpers, || run(&stage, 2));
        step(&stage, 1, &helpers, || run(&stage, 2));
        drop(stage);
    });
}

/// On a thread of the pool the stage lies on the caller's stack, and whoever arrived has left before `join`
/// looks for it.
#[test]
fn a_step_on_a_thread_of_the_pool() {
    check("on a thread of the pool, one helper", 3, || {
        let stage = Arc::new(Stage::default());
        let helper = stage.clone();
        thread::spawn(move || helper.help(End::Back));
        let quit = Quit { stage: &stage, wait: true };
        run(&stage, 2);
        run(&stage, 2);
        drop(quit);
    });
}

/// Whoever runs the block that panics, the caller hears of it, no other block runs twice or late, and the
/// next step, after the world was restored, knows nothing of it.
#[test]
fn a_panic_reaches_the_caller() {
    for bad in [vec![0], vec![1], vec![0, 1]] {
        check(&format!("panic in {bad:?} of two blocks"), 3, move || {
            let (stage, helpers) = (Arc::new(Stage::default()), Helpers::default());
            let counts = Counts::new(2);
            let work = |block: usize| {
                counts.add(block);
                if bad.contains(&block) {
                    resume_unwind(Box::new("bad block"));
                }
            };
            let all = || step(&stage, 1, &helpers, || stage.run(2, &work));
            let payload = catch_unwind(AssertUnwindSafe(all)).expect_err("no panic");
            match payload.downcast_ref::<&str>() {
                Some(&"bad block") => {}
                _ => resume_unwind(payload),
            }
            // What nobody had claimed when the caller panicked is given up.
            let counts = counts.get();
            assert!(counts.iter().all(|&count| count <= 1) && bad.iter().any(|&block| counts[block] == 1));
            step(&stage, 1, &helpers, || run(&stage, 2));
        });
    }
}
