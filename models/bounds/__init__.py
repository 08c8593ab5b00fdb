"""Bounds on what every plan costs, from a state on or from the start."""

from .completion import Completion, complete
from .root import root_bound

__all__ = ["Completion", "complete", "root_bound"]
