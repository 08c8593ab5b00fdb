"""CP-SAT: carries every statement, improves on a known route and proves bounds."""

from .outcome import Outcome
from .solve import solve_cpsat

__all__ = ["Outcome", "solve_cpsat"]
