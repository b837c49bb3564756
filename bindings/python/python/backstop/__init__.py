"""backstop: 3D rigid-body physics.

SI units, y up. Vectors are anything that yields three numbers, rotations are unit quaternions x, y, z, w.
"""

from . import lab
from ._native import (
    Body,
    Contact,
    Error,
    Joint,
    Material,
    Motor,
    RayHit,
    Scene,
    Shape,
    Snapshot,
    World,
    __version__,
    scene_names,
)

__all__ = [
    "Body",
    "Contact",
    "Error",
    "Joint",
    "Material",
    "Motor",
    "RayHit",
    "Scene",
    "Shape",
    "Snapshot",
    "World",
    "__version__",
    "lab",
    "scene_names",
]
