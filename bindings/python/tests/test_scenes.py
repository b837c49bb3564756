"""Scenes, snapshots, and the bits of other languages."""

import re
from pathlib import Path

import backstop
import pytest
from backstop import Scene, Shape, Snapshot, World

ROOT = Path(__file__).parents[3]


def pinned() -> dict[str, tuple[int, int]]:
    """Steps and hashes by the names of scenes, from the Rust example that asserts them on every processor."""
    text = (ROOT / "examples/same_bits.rs").read_text()
    rows = re.findall(r'\("(\w+)", (\d+), 0x([0-9A-F_]+)\)', text)
    return {name: (int(steps), int(bits.replace("_", ""), 16)) for name, steps, bits in rows}


@pytest.mark.parametrize("scene, pin", [("talk", "talk"), ("bullets_box", "bullets")])
def test_scenes_end_with_the_bits_that_rust_pins(scene: str, pin: str) -> None:
    steps, bits = pinned()[pin]
    world = World.from_scene(Scene.builtin(scene))
    world.step(1 / 60, steps=steps)
    assert world.state_hash() == bits


def test_threads_of_the_engine_change_no_bit() -> None:
    steps, bits = pinned()["bullets"]
    world = World.from_scene(Scene.builtin("bullets_box"), threads=2)
    world.step(1 / 60, steps=steps)
    assert world.state_hash() == bits


def test_a_scene_from_a_file() -> None:
    scene = Scene.load(ROOT / "scenes/tower.gltf")
    world = World.from_scene(scene, sleeping=True)
    assert len(world) == len(scene.body_names) > 2
    assert world.settings()["gravity"] == pytest.approx(scene.gravity)
    world.step(1 / 60, steps=10)
    other = World()
    assert len(other.add_scene(scene)) == len(world)
    with pytest.raises(backstop.Error, match="nothing.glb"):
        Scene.load("nothing.glb")
    with pytest.raises(backstop.Error, match="no builtin scene `towr`"):
        Scene.builtin("towr")
    assert "ragdolls" in backstop.scene_names()


def test_a_scene_is_written_and_read(tmp_path: Path) -> None:
    scene = Scene.builtin("ragdoll_wall")
    scene.save(tmp_path / "wall.glb")
    again = Scene.load(tmp_path / "wall.glb")
    assert (len(again.body_names), again.joint_count) == (len(scene.body_names), scene.joint_count)


def test_a_world_goes_back_to_a_snapshot_and_on_to_the_same_bits() -> None:
    world = World()
    world.add_body("static", shapes=[Shape.plane()])
    balls = [world.add_body(position=(0.1 * i, 1 + i, 0), shapes=[Shape.sphere(0.4)]) for i in range(5)]
    world.step(1 / 60, steps=30)
    saved = world.snapshot()
    world.step(1 / 60, steps=30)
    bits, positions = world.state_hash(), world.positions()
    world.remove_body(balls[2])
    world.restore(saved)
    assert world.bodies[3] == balls[2]
    world.step(1 / 60, steps=30)
    assert world.state_hash() == bits and (world.positions() == positions).all()
    # Also in another world, by way of bytes.
    other = World()
    other.restore(Snapshot.from_bytes(saved.to_bytes()))
    other.step(1 / 60, steps=30)
    assert other.state_hash() == bits and len(other) == 6
    with pytest.raises(backstop.Error):
        Snapshot.from_bytes(b"nothing")
