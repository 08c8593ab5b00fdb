"""What a bound by flows takes, in deterministic seconds."""

from __future__ import annotations

ROWS_PER_S = 1e7
"""Rows times rounds of the simplex method that a second is counted for, where there are half as many cuts as contours
or more."""
FREE = 0.2
"""Share of that which a round takes without cuts."""
PRODUCTS_PER_S, BESIDE = 2.5e10, 650
"""Of multipliers above 0 and moves, in the same way; and so many multipliers take as long as all else with a move."""
MADE_PER_S = 1e7
"""Moves whose costs are worked out, and that are gone through for the first ones."""


def round_s(contours: int, sites: int, cuts: int) -> float:
    """What a round of the simplex method takes in a program with so many cuts."""
    return (contours + sites + 2 + cuts) * min(1.0, FREE + cuts / (2 * contours)) / ROWS_PER_S


def look_s(moves: int, paying: int) -> float:
    """What a look at so many moves takes, where so many multipliers of cuts are above 0."""
    return (paying + BESIDE) * moves / PRODUCTS_PER_S


def made_s(moves: int) -> float:
    """What it takes to work out what so many moves cost."""
    return moves / MADE_PER_S


def sets_out_s(contours: int, sites: int) -> float:
    """About how many deterministic seconds the first bound takes, that of a program without cuts.

    Such a program takes about three rounds of the simplex method for every site, twice, and two looks at all moves.
    """
    rows = contours + sites
    return made_s(sites**2) + 2 * look_s(sites**2, 0) + 6 * sites * rows * FREE / ROWS_PER_S
