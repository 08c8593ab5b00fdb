"""Cuts for a flow between the cheapest one and those before it (Ben-Ameur and Neto 2007).

The cheapest flow is a corner of what the program allows, and cuts chosen by a corner often cut off little else.
A flow inside breaks fewer inequalities; those that it does break, and the cheapest one as well, cut deep.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kerfwise.arrays import Bools, Floats

from .inequalities import Inequalities
from .least_cuts import Flow
from .separation import Separation

STEP = 0.4
"""How far it goes from where it was towards the cheapest flow each time."""
LITTLE = 1e-3
"""Less than so much along a move is none of it."""
LEAST = 0.02
"""What the cheapest flow must be missing of an inequality."""


class Between:
    """Looks for inequalities that a flow on the way to the cheapest one breaks.

    Moves come behind those of before; where some are dropped, `keep` is told.
    """

    def __init__(self, separation: Separation) -> None:
        self._separation = separation
        self._amount: Floats | None = None
        self._beside: Floats = np.zeros(0)

    def uses(self, moves: int) -> Bools:
        """Which of the first so many moves the flow inside has, (moves,)."""
        used = np.zeros(moves, dtype=np.bool_)
        if self._amount is not None:
            used[: len(self._amount)] = self._amount >= LITTLE
        return used

    def keep(self, kept: Bools) -> None:
        """Go on with these of the moves."""
        if self._amount is not None:
            self._amount = self._amount[kept[: len(self._amount)]]

    def broken(self, cheapest: Flow, beside: Floats, go: Callable[[], bool]) -> Inequalities:
        """Inequalities that the cheapest flow breaks; `beside` are the columns beside its moves."""
        if self._amount is None:
            self._amount, self._beside = cheapest.amount, beside
            return self._separation.broken(cheapest, beside, go)
        amount = np.zeros_like(cheapest.amount)
        amount[: len(self._amount)] = (1 - STEP) * self._amount
        self._amount, self._beside = amount + STEP * cheapest.amount, STEP * beside + (1 - STEP) * self._beside
        inside = Flow(cheapest.leave, cheapest.reach, np.where(self._amount < LITTLE, 0.0, self._amount))
        found = self._separation.broken(inside, self._beside, go)
        some = np.flatnonzero(cheapest.amount)
        comes_to = found.across(cheapest.leave[some], cheapest.reach[some]) @ cheapest.amount[some]
        cuts = found.only(comes_to + found.beside @ beside < found.least - LEAST)
        if len(cuts) or not go():
            return cuts
        self._amount = None
        return self.broken(cheapest, beside, go)
