"""Methods of contact resolution side by side, and speed against accuracy."""

from ._native import Problem, Solution, methods, solve, trade

__all__ = ["Problem", "Solution", "methods", "solve", "trade"]
