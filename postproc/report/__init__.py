"""Pictures of nests and plans."""

from .picture import Spot
from .plot import draw, plot, plot_spot

__all__ = ["Spot", "draw", "plot", "plot_spot"]
