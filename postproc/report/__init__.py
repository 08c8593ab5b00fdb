"""Pictures of nests and plans."""

from .picture import Spot
from .plot import PAGE, draw, expect_picture, plot, plot_spot

__all__ = ["PAGE", "Spot", "draw", "expect_picture", "plot", "plot_spot"]
