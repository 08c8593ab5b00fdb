"""How long cuts and moves take, for the clock of a model."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.models.problem.problem import Problem

from .arcs import ArcLiterals


def counts_seconds(problem: Problem) -> bool:
    """Whether a statement counts seconds, so that a clock is needed."""
    return any(lag.seconds > 0 for lag in problem.lags)


def cuts_ms(problem: Problem) -> Ints:
    """Time of the cut of every site."""
    return problem.pace.cut_ms if len(problem.pace.cut_ms) else np.zeros(problem.m, dtype=np.int64)


def moves_ms(problem: Problem, arcs: ArcLiterals) -> Ints:
    """Time of the idle travel along every arc; along a link there is none."""
    idle = problem.pace.move_ms(problem.ends()[arcs.tail], problem.pierces()[arcs.head])
    return np.where(problem.links.rows_of(arcs.tail, arcs.head) >= 0, 0, idle)


def linked_ms(problem: Problem, arcs: ArcLiterals) -> list[list[tuple[int, int]]]:
    """For every contour the links that lead to it, as arcs, and by how much each makes its cut longer."""
    row = problem.links.rows_of(arcs.tail, arcs.head)
    found: list[list[tuple[int, int]]] = [[] for _ in range(problem.n)]
    for arc in np.flatnonzero(row >= 0).tolist():
        found[int(problem.site_contour[arcs.head[arc]])].append((arc, int(problem.links.ms[row[arc]])))
    return found


def longest_ms(problem: Problem, arcs: ArcLiterals) -> int:
    """No plan takes longer than the longest cuts and the longest moves together."""
    cuts = np.maximum.reduceat(cuts_ms(problem), problem.first[:-1])
    burnt = problem.n * int(problem.links.ms.max(initial=0))
    return int(cuts.sum()) + burnt + (problem.n + 1) * int(moves_ms(problem, arcs).max(initial=0))
