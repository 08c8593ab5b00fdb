"""Why a contour of a plan is cut where it is, then, and so."""

from .along import Along
from .explain import expect_planned, explain, explained
from .lawful import TriedOrder, try_order
from .setting import Setting, make_setting
from .words import Explanation, as_text, explanation_as_json

__all__ = [
    "Along",
    "Explanation",
    "Setting",
    "TriedOrder",
    "as_text",
    "expect_planned",
    "explain",
    "explained",
    "explanation_as_json",
    "make_setting",
    "try_order",
]
