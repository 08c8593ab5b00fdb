"""Why a contour of a plan is cut where it is, then, and so."""

from .alternatives import PositionCosts, TriedOrder, try_order
from .context import PlanContext, make_context
from .explain import Explanation, as_text, expect_planned, explain, explained, explanation_as_json

__all__ = [
    "Explanation",
    "PlanContext",
    "PositionCosts",
    "TriedOrder",
    "as_text",
    "expect_planned",
    "explain",
    "explained",
    "explanation_as_json",
    "make_context",
    "try_order",
]
