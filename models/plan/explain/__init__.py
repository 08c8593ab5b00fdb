"""Why a contour of a plan is cut where it is, then, and so."""

from .explain import Explanation, explain
from .words import as_json, as_text

__all__ = ["Explanation", "as_json", "as_text", "explain"]
