"""When the hard rules cannot all hold: which contradict each other, and what should give way."""

from .conflict import Conflict, find_conflict, state_relaxed
from .purse import NotAnswered, Purse

__all__ = ["Conflict", "NotAnswered", "Purse", "find_conflict", "state_relaxed"]
