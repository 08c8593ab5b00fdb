"""What rules may know of a nest: computed once, written to JSON for people and to MiniZinc data."""

from .compute import compute_facts
from .facts import FactOptions, Facts
from .write_dzn import facts_dzn
from .write_json import facts_json

__all__ = ["FactOptions", "Facts", "compute_facts", "facts_dzn", "facts_json"]
