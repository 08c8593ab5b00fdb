"""The portfolio: search finds, the ideals prove where they fit, CP-SAT carries what a state cannot hold."""

from .order import run_portfolio

__all__ = ["run_portfolio"]
