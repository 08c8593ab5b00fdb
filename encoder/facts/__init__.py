"""What rules may know of a nest: computed once; `export` writes it as JSON for people and as MiniZinc data."""

from .compute import compute_facts
from .facts import FactOptions, Facts

__all__ = ["FactOptions", "Facts", "compute_facts"]
