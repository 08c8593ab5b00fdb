"""Small nests built by hand, under the name that the tests know them by."""

from kerfwise.encoder.by_hand import Rows, circle, nest, part, rect

__all__ = ["Rows", "circle", "nest", "part", "rect"]
