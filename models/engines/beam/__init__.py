"""A beam over ideals: the exact dynamic program cut short, as wide as time and memory allow."""

from .applicability import unfit
from .beam import BeamResult, beam

__all__ = ["BeamResult", "beam", "unfit"]
