"""A beam over ideals: the exact dynamic program cut short, as wide as time and memory allow."""

from .beam_search import BeamResult, beam, unfit

__all__ = ["BeamResult", "beam", "unfit"]
