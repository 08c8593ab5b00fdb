"""Benchmarks: engines run on nests and on the field's routing instances, measured and judged."""

from .best_known import BestKnown, read_best_known
from .measure import BenchJob, BenchResult, measure
from .table import gap_to, head, line, results_as_json, results_in_all

__all__ = [
    "BenchJob",
    "BenchResult",
    "BestKnown",
    "gap_to",
    "head",
    "line",
    "measure",
    "read_best_known",
    "results_as_json",
    "results_in_all",
]
