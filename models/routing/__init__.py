"""Routing instances of the field: sequential ordering and its generalised form, read, solved, judged."""

from .instance import Instance
from .judge import judge_tour
from .read import is_instance, read_instance
from .solve import Answer, solve_instance

__all__ = ["Answer", "Instance", "is_instance", "judge_tour", "read_instance", "solve_instance"]
