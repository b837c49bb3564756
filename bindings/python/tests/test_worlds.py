"""Bodies under gravity, against mechanics."""

import math

import backstop
import numpy as np
import pytest
from backstop import Material, Shape, World

G = 9.81


def test_free_fall_has_the_speed_and_the_path_of_galilei() -> None:
    world = World()
    ball = world.add_body(position=(0, 100, 0), shapes=[Shape.sphere(0.5)])
    world.step(1 / 60, steps=60)
    assert world.velocity(ball)[1] == pytest.approx(-G, rel=1e-5)
    # A substep of 1/240 s moves by the speed at its end: by g t h / 2 too far.
    assert world.position(ball)[1] == pytest.approx(100 - G / 2, abs=G / 480 + 1e-4)


def test_a_ball_comes_back_with_the_share_of_its_speed_that_the_material_says() -> None:
    rubber = Material(restitution=0.5)
    world = World()
    world.add_body("static", shapes=[Shape.plane(material=rubber)])
    ball = world.add_body(position=(0, 2.5, 0), shapes=[Shape.sphere(0.5, material=rubber)])
    heights = np.empty((240, 2, 3))
    world.step(1 / 120, steps=240, out=heights)
    height = heights[:, 1, 1]
    lowest = int(np.argmin(height[:120]))
    # It falls by 2 m, and rises to a quarter of that.
    assert height[lowest:].max() - 0.5 == pytest.approx(0.25 * 2.0, rel=0.03)
    assert world.mass(ball) == pytest.approx(1000 * math.pi / 6, rel=1e-5)


@pytest.mark.parametrize("friction, slides", [(0.5, True), (0.7, False)])
def test_a_box_slips_at_the_angle_of_friction(friction: float, slides: bool) -> None:
    # 30 degrees: tan is 0.577.
    turn = (0, 0, math.sin(math.pi / 12), math.cos(math.pi / 12))
    rough = Material(friction=friction)
    world = World()
    world.add_body("static", rotation=turn, shapes=[Shape.box((20, 0.5, 20), material=rough)])
    up = np.array((-math.sin(math.pi / 6), math.cos(math.pi / 6), 0))
    cube = Shape.box((0.5, 0.5, 0.5), material=rough)
    box = world.add_body(position=1.0 * up, rotation=turn, shapes=[cube])
    world.step(1 / 60, steps=60)
    speed = np.linalg.norm(world.velocity(box))
    expected = (math.sin(math.pi / 6) - friction * math.cos(math.pi / 6)) * G if slides else 0.0
    assert speed == pytest.approx(expected, abs=0.005 * G)


def test_every_shape_rests_on_the_ground() -> None:
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * 0.4
    shapes = [
        (Shape.sphere(0.4), "sphere"),
        (Shape.box((0.4, 0.4, 0.4)), "box"),
        (Shape.capsule(0.3, 0.4), "capsule"),
        (Shape.cylinder(0.4, 0.4), "cylinder"),
        (Shape.cone(0.4, 0.4), "cone"),
        (Shape.hull(corners), "hull"),
    ]
    floor = [(-9.0, 0.0, -9.0), (9.0, 0.0, -9.0), (9.0, 0.0, 9.0), (-9.0, 0.0, 9.0)]
    grounds = [
        (Shape.plane(), (0, 0, 0)),
        (Shape.mesh(floor, np.array([(0, 2, 1), (0, 3, 2)])), (0, 0, 0)),
        (Shape.height_field(np.zeros((19, 19)), (1.0, 1.0)), (-9, 0, -9)),
    ]
    for ground, place in grounds:
        world = World()
        world.add_body("static", place, shapes=[ground])
        for index, (shape, _) in enumerate(shapes):
            world.add_body(position=(2 * index - 5, 0.8, 0), shapes=[shape])
        world.step(1 / 60, steps=180)
        heights = world.positions()[1:, 1]
        assert np.all(heights > 0.38) and np.all(heights < 0.75), (ground, heights)
        assert len(world.contacts()) >= len(shapes)


def test_a_given_mass_takes_the_place_of_densities() -> None:
    world = World(gravity=(0, 0, 0))
    box = world.add_body(shapes=[Shape.box((0.5, 0.5, 0.5))], mass=3.0)
    assert world.mass(box) == pytest.approx(3.0)
    world.apply_impulse(box, (6.0, 0, 0))
    assert world.velocity(box)[0] == pytest.approx(2.0)
    # A cube of side 1 has the moment m / 6: an impulse of 1 N s with the lever 0.5 m turns it at 1 rad/s.
    world.apply_impulse(box, (0, 0, 1.0), point=(-0.5, 0, 0))
    assert world.angular_velocity(box)[1] == pytest.approx(1.0)
    world.add_force(box, (3.0, 0, 0))
    world.step(0.1)
    assert world.velocity(box)[0] == pytest.approx(2.1)


def test_a_resting_body_is_borne_by_its_contacts() -> None:
    world = World(substeps=4)
    world.add_body("static", shapes=[Shape.plane()])
    box = world.add_body(position=(0, 0.5, 0), shapes=[Shape.box((0.5, 0.5, 0.5))])
    world.step(1 / 60, steps=120)
    (contact,) = world.contacts(box)
    assert contact.bodies[0] == box and len(contact.points) == 4
    assert contact.normal == pytest.approx((0, -1, 0), abs=1e-3)
    # The impulse of one of four substeps.
    assert sum(contact.impulses) == pytest.approx(1000 * G / 240, rel=0.02)


def test_rays_meet_what_is_in_their_way() -> None:
    world = World()
    ground = world.add_body("static", shapes=[Shape.plane()])
    ball = world.add_body("static", position=(0, 5, 0), shapes=[Shape.sphere(1.0)])
    hit = world.cast_ray((0, 10, 0), (0, -20, 0))
    assert hit is not None and hit.body == ball
    assert hit.fraction == pytest.approx(0.2) and hit.point == pytest.approx((0, 6, 0))
    below = world.cast_ray((0, 10, 0), (0, -20, 0), exclude=ball)
    assert below is not None and below.body == ground
    assert world.cast_ray((0, 10, 0), (0, 1, 0)) is None
    found = world.cast_rays([(0, 10, 0), (3, 10, 0), (3, 10, 0)], [(0, -20, 0), (0, -20, 0), (0, 5, 0)])
    assert found[:2] == pytest.approx((0.2, 0.5)) and math.isinf(found[2])


def test_settings_have_the_names_of_the_engine() -> None:
    world = World(gravity=np.array((0, -1.62, 0)), substeps=8, sleeping=True)
    assert world.settings()["gravity"] == pytest.approx((0, -1.62, 0), rel=1e-6)
    world.set_settings(substeps=2)
    assert world.settings()["substeps"] == 2 and world.settings()["sleeping"] is True
    assert Material(friction=0.3).fields()["static_friction"] == pytest.approx(0.3)


def test_what_the_engine_refuses_is_an_exception_with_its_reason() -> None:
    with pytest.raises(TypeError, match="no setting `substep`"):
        World(substep=3)
    with pytest.raises(backstop.Error, match="substeps must be in 1..=64, but is 0"):
        World(substeps=0)
    with pytest.raises(TypeError, match="unknown field `frction`"):
        Material(frction=0.3)
    with pytest.raises(TypeError, match="no field `colour`"):
        Shape.sphere(1.0, colour="red")
    with pytest.raises(backstop.Error):
        Shape.sphere(-1.0)
    with pytest.raises(TypeError):
        World().add_body("still")
    with pytest.raises(ValueError, match="3 numbers"):
        World().add_body(position=(1, 2))
    world = World()
    with pytest.raises(backstop.Error, match="must be finite"):
        world.add_body(position=(math.nan, 0, 0))
    with pytest.raises(backstop.Error, match="only be on a static or kinematic body"):
        world.add_body(shapes=[Shape.plane()])
    with pytest.raises(backstop.Error):
        world.step(math.inf)
    gone = world.add_body(shapes=[Shape.sphere(1.0)])
    world.remove_body(gone)
    with pytest.raises(backstop.Error, match="stale"):
        world.position(gone)
    assert issubclass(backstop.Error, ValueError) and len(world) == 0


def test_reports_are_dictionaries() -> None:
    world = World()
    world.add_body("static", shapes=[Shape.plane()])
    world.add_body(position=(0, 0.5, 0), shapes=[Shape.box((0.5, 0.5, 0.5))])
    world.step(1 / 60)
    assert world.report()["manifolds"] == 1 and world.report()["times"]["step"] > 0
    assert sum(bytes["reserved"] for bytes in world.memory().values()) > 1000
