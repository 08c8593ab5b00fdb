"""The search: an anytime ruin and recreate, seeded and deterministic, that finds good lawful routes fast."""

from .searcher import Searcher

__all__ = ["Searcher"]
