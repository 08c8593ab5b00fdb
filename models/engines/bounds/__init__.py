"""Bounds on what every plan costs, from a state on or from the start."""

from .completion import Completion, complete
from .flow import MOST_SITES, FlowBound, flow_bound

__all__ = ["MOST_SITES", "Completion", "FlowBound", "complete", "flow_bound"]
