"""A beam over ideals: the exact dynamic program cut short, as wide as time and memory allow."""

from .beam import Outcome, beam
from .takes import applies

__all__ = ["Outcome", "applies", "beam"]
