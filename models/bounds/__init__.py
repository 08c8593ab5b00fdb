"""Bounds on what every plan costs, from a state on or from the start."""

from .completion import Completion, complete
from .flow import FlowBound, flow_bound

__all__ = ["Completion", "FlowBound", "complete", "flow_bound"]
