"""Benchmarks: engines run on nests and on the field's routing instances, measured and judged."""

from .best_known import BestKnown, read_best_known
from .measure import Job, Result, measure
from .table import as_json, gap_to, head, line, totals

__all__ = ["BestKnown", "Job", "Result", "as_json", "gap_to", "head", "line", "measure", "read_best_known", "totals"]
