//! A step asks the pool for help and does not wait for it.

#![cfg(feature = "parallel")]

mod common;

use backstop::scene::builtin;
use backstop::{Settings, World};
use std::sync::mpsc::{Receiver, Sender, channel};

fn world(threads: usize) -> World {
    let mut scene = builtin::pile();
    scene.bodies.truncate(5 + 300);
    let (world, bodies) = common::world_of(&scene, Settings { threads, ..Settings::default() });
    assert!(bodies.len() > 200, "enough for threads");
    world
}

/// Keeps a thread of a pool until it hears that it may go.
fn occupy(arrived: Sender<()>, go: Receiver<()>) {
    arrived.send(()).unwrap();
    let _ = go.recv();
}

/// All threads of the global pool are taken by jobs that wait until the steps are done. With a caller that is moved into the pool,
/// or that waits for helpers who have not begun, this test never ends.
#[test]
fn a_step_ends_while_the_pool_is_taken() {
    rayon::ThreadPoolBuilder::new().num_threads(2).build_global().unwrap();
    let (arrived, all_there) = channel();
    let waiting: Vec<Sender<()>> = (0..2)
        .map(|_| {
            let (go, told) = channel();
            let arrived = arrived.clone();
            rayon::spawn(move || occupy(arrived, told));
            go
        })
        .collect();
    (0..2).for_each(|_| all_there.recv().unwrap());
    let mut world_of_two = world(2);
    common::steps(&mut world_of_two, 60, 1.0 / 60.0);
    // Those that were asked for come when there is nothing to do any more, also for a world that is gone.
    let mut alone = world(1);
    common::steps(&mut alone, 60, 1.0 / 60.0);
    assert_eq!(world_of_two.hash(), alone.hash());
    let mut gone = world(2);
    common::steps(&mut gone, 3, 1.0 / 60.0);
    drop(gone);
    waiting.into_iter().for_each(|go| go.send(()).unwrap());
    // And for one that goes on.
    common::steps(&mut world_of_two, 60, 1.0 / 60.0);
    common::steps(&mut alone, 60, 1.0 / 60.0);
    assert_eq!(world_of_two.hash(), alone.hash());

    // On a thread of a pool of two, whose other thread is taken.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let (arrived, is_there) = channel();
    let (go, told) = channel();
    pool.spawn(move || occupy(arrived, told));
    is_there.recv().unwrap();
    let inside = pool.install(|| {
        let mut inside = world(2);
        common::steps(&mut inside, 120, 1.0 / 60.0);
        inside.hash()
    });
    go.send(()).unwrap();
    assert_eq!(inside, alone.hash());
}
