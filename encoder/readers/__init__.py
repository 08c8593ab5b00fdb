"""Nest files become nests: kerfwise-nest JSON, DXF and SVG."""

from .options import ReadOptions
from .read import read_nest

__all__ = ["ReadOptions", "read_nest"]
