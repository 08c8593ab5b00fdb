"""Plain ways to choose an order, for comparison: at random, and by the temperature of the sheet at that moment."""

from collections.abc import Mapping
from typing import Literal

Strategy = Literal["ours", "shortest", "random", "realtime"]
STRATEGIES: Mapping[Strategy, str] = {
    "ours": "everything the profile asks, as cheap as can be found",
    "shortest": "the shortest idle travel that keeps the hard rules",
    "random": "any order that keeps the hard rules",
    "realtime": "each next contour by the temperature of the sheet at that moment (Verkhoturov et al.)",
}
"""Name of a strategy → what it does."""
