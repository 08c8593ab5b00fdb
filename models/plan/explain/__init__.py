"""Why a contour of a plan is cut where it is, then, and so."""

from .explain import Explanation, explain
from .words import as_text, explanation_as_json

__all__ = ["Explanation", "as_text", "explain", "explanation_as_json"]
