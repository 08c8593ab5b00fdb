"""What rules may know of a nest: computed once, written to JSON for people and to MiniZinc data."""

from .compute import compute_facts
from .export import facts_dzn, facts_json
from .facts import FactOptions, Facts

__all__ = ["FactOptions", "Facts", "compute_facts", "facts_dzn", "facts_json"]
