"""When the hard rules cannot all hold: which contradict each other, and what should give way."""

from .conflict import Conflict, find_conflict, state_relaxed, without_cycles
from .groups import NotAnswered

__all__ = ["Conflict", "NotAnswered", "find_conflict", "state_relaxed", "without_cycles"]
