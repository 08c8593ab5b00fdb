"""What a bound by flows takes, in deterministic seconds."""

from __future__ import annotations

MOST_SITES, MOST_CONTOURS = 9000, 1500
"""With more sites contours stand for all of theirs; with more contours there is no bound (it takes too long)."""
SETTING_OUT = 0.75
"""Share of the work that may go before the first bound; where it takes more, contours stand for all of their sites."""

ROWS_PER_S = 1e7
"""Rows times rounds of the simplex method that a second is counted for, where there are half as many cuts as contours
or more."""
PRIMAL = 0.4
"""Share of that which a round of the primal simplex method takes."""
FREE = 0.2
"""Share of either which a round takes without cuts."""
LOOKED_PER_S = 4e7
"""Moves that a look at all goes through."""
MADE_PER_S = 1e7
"""Moves whose costs are worked out, and that are gone through for the first ones."""


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
