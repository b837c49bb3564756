"""Other threads of Python run while a world steps."""

import threading
import time

import pytest
from backstop import Scene, World


def test_python_runs_while_a_world_steps() -> None:
    world = World.from_scene(Scene.builtin("large_pyramid"))
    started, took = threading.Event(), []

    def step() -> None:
        started.set()
        start = time.perf_counter()
        world.step(1 / 60, steps=20)
        took.append(time.perf_counter() - start)

    thread = threading.Thread(target=step)
    thread.start()
    started.wait()
    ran, last, refused = 0.0, time.perf_counter(), 0
    while not took:
        now = time.perf_counter()
        # Time in which this thread did not get on counts little.
        ran += min(now - last, 0.005)
        last = now
        try:
            world.energy()
        except RuntimeError:
            refused += 1
    thread.join()
    # With the interpreter's lock held, this thread would have stood still for all of the call.
    assert ran > 0.1 * took[0], (ran, took)
    # The world that steps refuses calls from here.
    assert refused > 0
    assert world.energy() == pytest.approx(world.energy())


def test_two_worlds_step_in_two_threads_to_the_same_bits() -> None:
    worlds = [World.from_scene(Scene.builtin("ragdoll_wall")) for _ in range(3)]
    threads = [threading.Thread(target=world.step, args=(1 / 60, 60)) for world in worlds[:2]]
    for thread in threads:
        thread.start()
    worlds[2].step(1 / 60, steps=60)
    for thread in threads:
        thread.join()
    assert len({world.state_hash() for world in worlds}) == 1
