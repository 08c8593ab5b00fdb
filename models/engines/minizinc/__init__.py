"""The MiniZinc engine: the rules stated once more, over facts, as rule authors read and edit them."""

from .engine import solve_minizinc

__all__ = ["solve_minizinc"]
