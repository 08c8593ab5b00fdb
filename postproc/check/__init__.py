"""The independent check of plans and programs."""

from .check import check_cuts, check_program
from .relaxed import Relaxed
from .report import report
from .result import CheckResult, Excused, Judgement, Measured
from .totals import Claims

__all__ = [
    "CheckResult",
    "Claims",
    "Excused",
    "Judgement",
    "Measured",
    "Relaxed",
    "check_cuts",
    "check_program",
    "report",
]
