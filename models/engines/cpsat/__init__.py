"""CP-SAT: carries every statement, improves on a known route and proves bounds."""

from .outcome import CpsatOutcome
from .solve import solve_cpsat

__all__ = ["CpsatOutcome", "solve_cpsat"]
