"""Contact problems and methods, and the trade of speed for accuracy."""

import math
from pathlib import Path

import backstop
import numpy as np
import pytest
from backstop import Scene, Shape, World, lab

EXACT = ["lemke", "dantzig", "keller", "murty", "block-pivoting", "newton-min"]


def test_methods_find_the_solution_of_a_complementarity_problem() -> None:
    # z = (1/3, 1/3), w = 0.
    problem = lab.Problem.lcp([[2, 1], [1, 2]], [-1, -1])
    names = [name for name, _ in lab.methods()]
    assert set(EXACT) <= set(names)
    for name in EXACT + ["pgs", "apgd", "admm"]:
        found = lab.solve(problem, name)
        assert found.status == "solved", name
        assert found.r == pytest.approx([1 / 3, 1 / 3], abs=1e-8), name


def test_a_sliding_point_gets_coulombs_friction() -> None:
    # A point of 1 kg comes down at 1 m/s and slides at 10 m/s along x.
    problem = lab.Problem.contacts(np.eye(3), [-1.0, 10.0, 0.0], [0.5])
    found = lab.solve(problem, "gs-cone")
    assert found.status == "solved" and found.residual <= 1e-10
    assert found.r == pytest.approx([1.0, -0.5, 0.0], abs=1e-8)
    assert problem.mu == [0.5] and len(problem) == 3
    assert problem.w @ found.r + problem.q == pytest.approx([0.0, 9.5, 0.0], abs=1e-8)


def test_the_contacts_of_a_step_as_a_problem() -> None:
    world = World()
    world.add_body("static", shapes=[Shape.plane()])
    box = world.add_body(position=(0, 0.5, 0), shapes=[Shape.box((0.5, 0.5, 0.5))])
    with pytest.raises(backstop.Error, match="observe"):
        world.contact_problem()
    world.step(1 / 60, steps=60)
    world.observe(True)
    world.step(1 / 60)
    problem = world.contact_problem()
    assert len(problem) == 12 and problem.mu == pytest.approx([0.6] * 4)
    found = lab.solve(problem, "gs-cone")
    # All four points together bear the weight for a step.
    assert found.r[::3].sum() == pytest.approx(world.mass(box) * 9.81 / 60, rel=0.05)


def test_problems_are_read_from_files_and_refused_with_a_reason(tmp_path: Path) -> None:
    file = tmp_path / "problem.dat"
    file.write_text("nonsense")
    with pytest.raises(backstop.Error, match="line 1"):
        lab.Problem.load(file)
    with pytest.raises(FileNotFoundError):
        lab.Problem.load(tmp_path / "none.dat")
    with pytest.raises(ValueError, match="square"):
        lab.Problem.lcp([[1, 2, 3], [4, 5, 6]], [1, 2])
    with pytest.raises(backstop.Error, match="finite"):
        lab.Problem.lcp([[math.nan]], [1])
    with pytest.raises(backstop.Error, match="no method `lemk`"):
        lab.solve(lab.Problem.lcp([[1]], [1]), "lemk")


def test_more_substeps_cost_more_and_err_less() -> None:
    scene = Scene.builtin("tower_2")
    rows = lab.trade(scene, 0.5, reference_hz=480, hz=[60], substeps=[1, 8], iterations=[1],
                     friction=["point"], continuous=["discrete"])
    # The default comes first, then the grid.
    assert [row["substeps"] for row in rows] == [4, 1, 8]
    assert all(row["cost_us"] > 0 and math.isfinite(row["errors"]["trajectory"]) for row in rows)
    assert "60 Hz" in rows[0]["name"]
    with pytest.raises(TypeError, match="no axis `colour`"):
        lab.trade(scene, colour=["red"])
