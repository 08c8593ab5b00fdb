"""The independent check of plans and programs."""

from .check import check_cuts, check_program
from .heating import Heating, Thermometer
from .judged_cuts import JudgedCuts
from .judgement import Excused, Judgement
from .planned import Planned
from .relaxed import Relaxed
from .result import CheckResult, Measured, report
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
