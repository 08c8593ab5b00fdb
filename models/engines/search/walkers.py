"""Which walkers suit a problem."""

from __future__ import annotations

from .annealing_walker import AnnealingWalker
from .lin_kernighan import ChainedWalker, chained
from .structs import for_kernels
from .tables import SearchTables
from .walker import Walker


def make_walkers(fields: SearchTables, seed: int, count: int, chains: bool = True) -> list[Walker]:
    """So many walkers over a problem, each with random numbers of its own; they go by chains if asked and suited."""
    if chains and chained(fields):
        return [ChainedWalker(fields, (seed, k)) for k in range(count)]
    tables = for_kernels(fields)
    return [AnnealingWalker(tables, fields, (seed, k)) for k in range(count)]


def make_walker_like(like: Walker, fields: SearchTables, seed: tuple[int, ...]) -> Walker:
    """A walker of the same kind over another problem, with the same temperatures."""
    if isinstance(like, ChainedWalker):
        return ChainedWalker(fields, seed, like)
    return AnnealingWalker(for_kernels(fields), fields, seed, like)
