"""Joints, limits and motors, against mechanics."""

import math
from typing import Any

import backstop
import numpy as np
import pytest
from backstop import Joint, Motor, Shape, World

G = 9.81


def door(world: World, **fields: Any) -> Joint:
    """A slab that hangs on a vertical hinge at the origin, without gravity about it."""
    post = world.add_body("static")
    slab = world.add_body(position=(0.5, 0, 0), shapes=[Shape.box((0.5, 1.0, 0.05))])
    return world.add_hinge((post, slab), (0, 0, 0), (0, 1, 0), **fields)


def test_a_pendulum_has_the_period_of_huygens() -> None:
    world = World(substeps=8)
    post = world.add_body("static", position=(0, 0, 0))
    start, length, radius = 0.05, 1.0, 0.1
    place = (length * math.sin(start), -length * math.cos(start), 0)
    ball = world.add_body(position=place, shapes=[Shape.sphere(radius)])
    world.add_hinge((post, ball), (0, 0, 0), (0, 0, 1))
    dt, steps = 1 / 240, 2400
    path = np.empty((steps, 2, 3))
    world.step(dt, steps=steps, out=path)
    x = path[:, 1, 0]
    crossings = np.nonzero((x[:-1] > 0) & (x[1:] <= 0))[0]
    period = (crossings[-1] - crossings[0]) * dt / (len(crossings) - 1)
    # About its hinge a ball has the moment m (l² + 2/5 r²); the amplitude adds a share of start² / 16.
    expected = 2 * math.pi * math.sqrt((length**2 + 0.4 * radius**2) / (G * length)) * (1 + start**2 / 16)
    assert period == pytest.approx(expected, rel=2e-3)
    assert np.linalg.norm(path[:, 1], axis=1) == pytest.approx(length, abs=1e-3)


def test_a_motor_turns_a_hinge_until_its_limit() -> None:
    world = World()
    hinge = door(world, limits=(-0.1, 1.5), motor=Motor.velocity(1.0, 500.0))
    world.step(1 / 60, steps=60)
    assert world.joint_velocity(hinge) == pytest.approx(1.0, abs=0.01)
    # A slab of 200 kg and 1 m turns about its edge with 66.8 kg m²: 500 N m take 0.134 s to its speed.
    assert world.joint_position(hinge) == pytest.approx(1.0 - 66.8 / (2 * 500), abs=0.005)
    world.step(1 / 60, steps=120)
    assert world.joint_position(hinge) == pytest.approx(1.5, abs=0.01)
    world.set_motor(hinge, Motor.position(0.5, 2.0))
    world.step(1 / 60, steps=240)
    assert world.joint_position(hinge) == pytest.approx(0.5, abs=0.01)
    world.set_limits(hinge, 0.8, 1.0)
    world.step(1 / 60, steps=240)
    assert world.joint_position(hinge) == pytest.approx(0.8, abs=0.02)
    world.set_motor(hinge, None)


def test_a_slider_moves_along_its_axis_alone() -> None:
    world = World()
    post = world.add_body("static")
    box = world.add_body(position=(0, 3, 0), shapes=[Shape.box((0.5, 0.5, 0.5))])
    slider = world.add_slider((post, box), (0, 3, 0), (0, 1, 0), limits=(-2.0, 2.0))
    world.step(1 / 60, steps=300)
    assert world.position(box) == pytest.approx((0, 1, 0), abs=0.01)
    assert world.joint_position(slider) == pytest.approx(-2.0, abs=0.01)
    force, _ = world.joint_force(slider)
    assert np.linalg.norm(force) == pytest.approx(1000 * G, rel=0.02)


def test_a_ball_joint_keeps_its_point_and_its_cone() -> None:
    world = World()
    post = world.add_body("static")
    rod = world.add_body(position=(0.5, 0, 0), shapes=[Shape.box((0.5, 0.05, 0.05))])
    world.add_ball((post, rod), (0, 0, 0), axis=(1, 0, 0), swing=0.5)
    world.step(1 / 60, steps=300)
    x, y, z = world.position(rod)
    assert math.dist((x, y, z), (0, 0, 0)) == pytest.approx(0.5, abs=1e-3)
    assert math.atan2(-y, math.hypot(x, z)) == pytest.approx(0.5, abs=0.02)


def test_a_rope_holds_and_a_weak_weld_breaks() -> None:
    world = World()
    post = world.add_body("static", position=(0, 5, 0))
    ball = world.add_body(position=(0, 4, 0), shapes=[Shape.sphere(0.2)], mass=2.0)
    rope = world.add_distance((post, ball), ((0, 5, 0), (0, 4, 0)), 0.0, 3.0)
    world.step(1 / 60, steps=300)
    assert world.position(ball)[1] == pytest.approx(2.0, abs=0.01)
    assert world.joint_position(rope) == pytest.approx(3.0, abs=0.01)
    other = world.add_body(position=(5, 4, 0), shapes=[Shape.sphere(0.2)], mass=2.0)
    strong = world.add_fixed((post, other), (5, 4, 0))
    world.step(1 / 60, steps=30)
    assert world.has_joint(strong) and world.position(other)[1] == pytest.approx(4.0, abs=0.01)
    world.remove_joint(strong)
    weak = world.add_fixed((post, other), (5, 4, 0), break_force=1.0)
    world.step(1 / 60, steps=30)
    assert not world.has_joint(weak)
    with pytest.raises(backstop.Error, match="stale"):
        world.remove_joint(weak)
    with pytest.raises(TypeError, match="no axis"):
        world.set_limits(rope, 0.0, 1.0)
