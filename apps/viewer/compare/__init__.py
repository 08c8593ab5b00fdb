"""Two ways to cut one nest, side by side."""

from .comparison import Comparison, compare
from .sides import Side, SideAsked, expect_two, pair_of, side_of

__all__ = ["Comparison", "Side", "SideAsked", "compare", "expect_two", "pair_of", "side_of"]
