"""Routing instances of the field: sequential ordering and its generalised form, read, posed as a problem, judged."""

from .instance import Instance
from .judge import judge_tour
from .read import read_instance

__all__ = ["Instance", "judge_tour", "read_instance"]
