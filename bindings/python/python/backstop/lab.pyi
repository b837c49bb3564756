from os import PathLike
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import Scene

__all__ = ["Problem", "Solution", "methods", "solve", "trade"]

@final
class Problem:
    @staticmethod
    def contacts(w: ArrayLike, q: ArrayLike, mu: list[float]) -> Problem: ...
    @staticmethod
    def lcp(m: ArrayLike, q: ArrayLike) -> Problem: ...
    @staticmethod
    def load(path: str | PathLike[str]) -> Problem: ...
    @property
    def w(self) -> NDArray[np.float64]: ...
    @property
    def q(self) -> NDArray[np.float64]: ...
    @property
    def mu(self) -> list[float]: ...
    def __len__(self) -> int: ...

@final
class Solution:
    @property
    def status(self) -> str: ...
    @property
    def iterations(self) -> int: ...
    @property
    def pivots(self) -> int: ...
    @property
    def residual(self) -> float: ...
    @property
    def seconds(self) -> float: ...
    @property
    def r(self) -> NDArray[np.float64]: ...

def methods() -> list[tuple[str, str]]: ...
def solve(
    problem: Problem,
    method: str,
    *,
    tolerance: float = 1e-10,
    iterations: int = 10_000,
    friction: str = "cone",
    relaxation: float = 1.3,
) -> Solution: ...
def trade(
    scene: Scene, seconds: float = 1.0, *, reference_hz: int = 1920, **axes: Any
) -> list[dict[str, Any]]: ...
