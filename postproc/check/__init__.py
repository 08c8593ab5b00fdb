"""The independent check of plans and programs."""

from .check import Besides, check_cuts, check_program
from .feeds import Heating, Thermometer
from .plan_conformance import Claims, PlanClaims
from .result import CheckResult, Excused, JudgedCuts, Judgement, Measured, RelaxedStatement, report

__all__ = [
    "Besides",
    "CheckResult",
    "Claims",
    "Excused",
    "Heating",
    "JudgedCuts",
    "Judgement",
    "Measured",
    "PlanClaims",
    "RelaxedStatement",
    "Thermometer",
    "check_cuts",
    "check_program",
    "report",
]
