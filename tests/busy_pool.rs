//! A step asks the pool for help and does not wait for it.

mod common;

use backstop::{Settings, World};
use backstop_scene::builtin;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Mutex, PoisonError};

fn world(threads: usize) -> World {
    let mut scene = builtin::pile();
    scene.bodies.truncate(5 + 300);
    let (world, bodies) = common::world_of(&scene, Settings::default().with_threads(threads));
    assert!(bodies.len() > 200, "enough for threads");
    world
}

/// Threads of a pool that wait until they are let go.
#[derive(Default)]
struct Taken(Mutex<Vec<Sender<()>>>);

impl Taken {
    /// Takes one more thread; `spawn` hands a job to the pool.
    fn take(&self, spawn: impl FnOnce(Box<dyn FnOnce() + Send>)) {
        let (arrived, is_there) = channel();
        let (go, told): (_, Receiver<()>) = channel();
        spawn(Box::new(move || {
            arrived.send(()).unwrap();
            // Until `go` is dropped.
            let _ = told.recv();
        }));
        is_there.recv().unwrap();
        self.0.lock().unwrap().push(go);
    }

    fn release(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }
}

/// Runs `steps`, some 120 of them, and fails if they need a thread that is taken. As they would wait for ever
/// then, another thread takes as many steps alone, thirty times over, and releases the pool if they are not
/// done by that: so the limit is one of work and not of time.
fn without_the_pool<R>(taken: &Taken, steps: impl FnOnce() -> R) -> R {
    let done = AtomicBool::new(false);
    let (result, waited) = std::thread::scope(|scope| {
        let watch = scope.spawn(|| {
            let mut alone = world(1);
            for _ in 0..30 * 120 {
                if done.load(Ordering::Relaxed) {
                    return false;
                }
                common::steps(&mut alone, 1, 1.0 / 60.0);
            }
            taken.release();
            true
        });
        let result = steps();
        done.store(true, Ordering::Relaxed);
        (result, watch.join().unwrap())
    });
    assert!(!waited, "the steps were not done before threads of the pool were free");
    result
}

/// All threads of the global pool are taken until the steps are done. A caller that is moved into the pool,
/// or that waits for helpers which have not begun, needs one of them.
#[test]
fn a_step_ends_while_the_pool_is_taken() {
    rayon::ThreadPoolBuilder::new().num_threads(2).build_global().unwrap();
    let taken = Taken::default();
    (0..2).for_each(|_| taken.take(rayon::spawn));
    let mut world_of_two = world(2);
    let mut alone = world(1);
    common::steps(&mut alone, 60, 1.0 / 60.0);
    without_the_pool(&taken, || {
        common::steps(&mut world_of_two, 60, 1.0 / 60.0);
        let mut gone = world(2);
        common::steps(&mut gone, 60, 1.0 / 60.0);
    });
    assert_eq!(world_of_two.state_hash(), alone.state_hash());
    // Those that were asked for come now, when there is nothing to do any more: for a world that is gone, and
    // for one that goes on.
    taken.release();
    common::steps(&mut world_of_two, 60, 1.0 / 60.0);
    common::steps(&mut alone, 60, 1.0 / 60.0);
    assert_eq!(world_of_two.state_hash(), alone.state_hash());

    // On a thread of a pool of two, whose other thread is taken.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let taken = Taken::default();
    taken.take(|job| pool.spawn(job));
    let inside = || {
        let mut inside = world(2);
        common::steps(&mut inside, 120, 1.0 / 60.0);
        inside.state_hash()
    };
    assert_eq!(without_the_pool(&taken, || pool.install(inside)), alone.state_hash());
    taken.release();
}
