"""Two ways to cut one nest, side by side."""

from .comparison import Comparison, compare
from .side import Side, SideAsked, side_of

__all__ = ["Comparison", "Side", "SideAsked", "compare", "side_of"]
