"""Arrays: rows, copies, and arrays of the caller."""

import numpy as np
import pytest
from backstop import Shape, World


def balls(count: int) -> World:
    world = World()
    for index in range(count):
        world.add_body(position=(2.0 * index, 10.0, 0.0), shapes=[Shape.sphere(0.5)])
    return world


def test_a_row_is_a_body_in_the_order_of_addition() -> None:
    world = balls(4)
    first, second, *_ = world.bodies
    assert world.positions().shape == (4, 3) and world.positions().dtype == np.float64
    assert world.rotations().shape == (4, 4) and world.rotations().dtype == np.float32
    assert world.rotations()[0] == pytest.approx((0, 0, 0, 1))
    world.set_velocity(second, (1, 2, 3), (4, 5, 6))
    assert world.velocities()[1] == pytest.approx((1, 2, 3))
    assert world.angular_velocities()[1] == pytest.approx((4, 5, 6))
    world.remove_body(first)
    assert world.positions()[:, 0] == pytest.approx((2, 4, 6))
    world.add_body("static", position=(9, 0, 0))
    assert world.positions()[:, 0] == pytest.approx((2, 4, 6, 9))


def test_arrays_are_copies() -> None:
    world = balls(1)
    before = world.positions()
    world.step(1 / 60, steps=30)
    assert before[0, 1] == 10.0 and world.positions()[0, 1] < 9.0
    before[:] = 0.0
    assert world.positions()[0, 1] != 0.0


def test_an_array_of_the_caller_is_filled_and_returned() -> None:
    world = balls(3)
    out = np.empty((3, 3))
    assert world.positions(out=out) is out
    assert np.array_equal(out, world.positions())
    # Columns of a larger array need not be contiguous.
    wide = np.zeros((3, 6))
    world.positions(out=wide[:, ::2])
    assert np.array_equal(wide[:, ::2], out) and not wide[:, 1::2].any()


def test_a_step_fills_an_array_with_each_of_its_steps() -> None:
    world, alone = balls(2), balls(2)
    out = np.empty((10, 2, 3))
    world.step(1 / 60, steps=10, out=out)
    for positions in out:
        alone.step(1 / 60)
        assert np.array_equal(positions, alone.positions())


def test_arrays_of_another_shape_or_type_are_refused_before_anything_moves() -> None:
    world = balls(2)
    with pytest.raises(ValueError, match=r"has the shape \[10, 3, 3\] and needs \[10, 2, 3\]"):
        world.step(1 / 60, steps=10, out=np.empty((10, 3, 3)))
    with pytest.raises(TypeError):
        world.step(1 / 60, steps=10, out=np.empty((10, 2, 3), dtype=np.float32))
    with pytest.raises(TypeError):
        world.positions(out=np.empty((2, 3), dtype=np.int32))
    frozen = np.empty((2, 3))
    frozen.flags.writeable = False
    with pytest.raises(TypeError, match="not writeable"):
        world.positions(out=frozen)
    assert world.positions()[0, 1] == 10.0
