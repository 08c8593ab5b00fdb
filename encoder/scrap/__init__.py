"""Lines in the skeleton that the tool makes itself: a grid, and what saves a remnant."""

from .made import Remnant, remnant_of, with_scrap

__all__ = ["Remnant", "remnant_of", "with_scrap"]
