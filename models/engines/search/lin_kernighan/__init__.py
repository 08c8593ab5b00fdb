"""Chains of exchanges for sparse orders: each step breaks an arc that costs too much and makes two near ones.

Lin and Kernighan (1973), with steps that turn no stretch round (Kanellakis and Papadimitriou 1980), and kicks between.
"""

from __future__ import annotations

from .tables import chained
from .walker import ChainedWalker

__all__ = ["ChainedWalker", "chained"]
