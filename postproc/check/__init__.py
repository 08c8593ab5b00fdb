"""The independent check of plans and programs."""

from .check import check_cuts, check_program
from .heating import Heating, Thermometer
from .judged_cuts import JudgedCuts
from .planned import Planned
from .relaxed import Relaxed
from .report import report
from .result import CheckResult, Excused, Judgement, Measured
from .totals import Claims

__all__ = [
    "CheckResult",
    "Claims",
    "Excused",
    "Heating",
    "JudgedCuts",
    "Judgement",
    "Measured",
    "Planned",
    "Relaxed",
    "Thermometer",
    "check_cuts",
    "check_program",
    "report",
]
