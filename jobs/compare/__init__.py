"""Two ways to cut one nest, side by side."""

from .files import Comparison, compare
from .pair import expect_two, pair_of
from .side import Side, SideAsked, side_of

__all__ = ["Comparison", "Side", "SideAsked", "compare", "expect_two", "pair_of", "side_of"]
