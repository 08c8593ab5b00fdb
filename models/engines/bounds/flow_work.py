"""What a bound by flows takes, in deterministic seconds."""

from __future__ import annotations

from kerfwise.models.engines.tuning import FLOWS_ROWS_PER_S as ROWS_PER_S
from kerfwise.models.engines.tuning import FREE, LOOKED_PER_S, MADE_PER_S


def round_s(contours: int, sites: int, cuts: int) -> float:
    """What a round of the simplex method takes in a program of so many sites that do not rest, with so many cuts."""
    return (contours + sites + 2 + cuts) * min(1.0, FREE + cuts / (2 * contours)) / ROWS_PER_S


def look_s(moves: int) -> float:
    """What a look at so many moves takes."""
    return moves / LOOKED_PER_S


def made_s(moves: int) -> float:
    """What it takes to work out what so many moves cost."""
    return moves / MADE_PER_S


def sets_out_s(contours: int, sites: int) -> float:
    """About how many deterministic seconds the first bound takes, that of a program without cuts.

    Such a program takes about three rounds of the simplex method for every site, twice, and two looks at all moves.
    """
    rows = contours + sites
    return made_s(sites**2) + 2 * look_s(sites**2) + 6 * sites * rows * FREE / ROWS_PER_S
