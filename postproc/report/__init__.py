"""Pictures of nests and plans."""

from .picture import Spot
from .plot import draw, expect_picture, plot, plot_spot

__all__ = ["Spot", "draw", "expect_picture", "plot", "plot_spot"]
