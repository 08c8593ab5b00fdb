"""What it takes an engine to make its tables, or its model, of a problem: before that it finds and proves nothing.

Deterministic seconds, worked out from sizes alone: measured on nests of 60 to 308 contours and on routing instances of
17 to 699.
"""

from __future__ import annotations

import numpy as np

from kerfwise.models.problem.problem import Problem

MAX_ARCS = 80_000
"""Arcs between sites above which CP-SAT's smaller model, of pairs of contours, gives the better bound for the same work
(measured on plates of 115, 308 contours)."""
ROWS_PER_S, MOVES_PER_S = 8e6, 2e7
"""Crossings that are put in order, and moves that are priced, in a second."""
ARCS_LISTED_PER_S, ARCS_PER_S, PAIRS_PER_S = 1e6, 1e5, 2.5e4
"""Arcs between sites that CP-SAT's model is made of: listed with their prices, and made, presolved and begun with; and
pairs of contours that may follow each other, of which there are orders and arcs."""
BYTES_A_ROW = 60
"""What every crossing takes in the tables of the search, and of a beam or of windows after it, while they are made."""


def crossed_bytes(problem: Problem) -> int:
    """What crossings take, with the tables that any engine makes of them: large nests without zones have millions."""
    return problem.crossings.nbytes + BYTES_A_ROW * len(problem.crossings)


def windows_s(problem: Problem) -> float:
    """Of the windows of a plan."""
    return len(problem.crossings) / ROWS_PER_S


def beam_s(problem: Problem) -> float:
    """Of a beam."""
    return len(problem.crossings) / ROWS_PER_S + (problem.m + 1) ** 2 / MOVES_PER_S


def count_site_arcs(problem: Problem) -> int:
    """How many arcs between sites there are at most, home's included."""
    sites = np.append(np.diff(problem.first), 1)
    return int(sites @ problem.followers().weighed(sites))


def cpsat_s(problem: Problem) -> float:
    """Of CP-SAT's model."""
    arcs, pairs = count_site_arcs(problem), int(problem.followers().weighed(np.ones(problem.n + 1, np.int64)).sum())
    listed_s = arcs / ARCS_LISTED_PER_S + len(problem.crossings) / ROWS_PER_S
    if arcs > MAX_ARCS:
        return listed_s + (0.0 if pairs > MAX_ARCS else pairs / PAIRS_PER_S)
    return listed_s + arcs / ARCS_PER_S + pairs / PAIRS_PER_S
