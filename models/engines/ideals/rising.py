"""What plans that are looked for may cost: little at first, as the less it is the fewer states are gone through."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import log

from .budget import TooLarge

NEAR, WIDER, FAR_OVER = 0.005, 1.6, 0.1
"""By what share of the bound a plan may be dearer that is looked for first, how many times as much next (`wider`, where
that is given), and from what share on limits rise by what sweeps take."""
DEARER, LITTLE = 4.0, 0.002
"""How many times as much work as the last one the next sweep may take where limits are far; less than that share of
what is left says nothing of the next."""


def rising(least: float, known: int | None, left: Callable[[], float], wider: float = WIDER) -> Iterator[int | None]:
    """Limits from little more than the `least` on; at last as much as a plan that is `known`, None where none is.

    `left` is the work that is left when it is called: what a sweep takes rises about as a power of its limit, so that
    the last two say how far the next may reach. Where limits drop next to nothing, it is to the known plan.

    Examples
    --------
    >>> plenty = lambda: 1e9
    >>> list(rising(1000.0, 1020, plenty)), list(rising(1000.0, 1002, plenty)), list(rising(1000.0, None, plenty))
    ([1005, 1008, 1012, 1020], [1002], [None])
    """
    over, step, before = NEAR * least, NEAR * least, 0.0
    while known is not None and over >= 1 and least + over < known:
        had = left()
        yield int(least + over)
        taken = had - left()
        near = over < FAR_OVER * least / wider
        if near or before <= 0.0 or taken < LITTLE * had:
            step = (wider - 1.0) * over
        else:
            times = log(max(1.0, taken / before)) / step  # of the work, a unit of the limit more
            if times * (known - least - over) <= log(DEARER):
                break
            step = log(DEARER) / times
        step = max(step, 1.0)  # limits are whole numbers: none comes twice
        over, before = over + step, taken
    yield known


SOON, FIRST, TWICE, ENDS = 0.0005, 0.002, 2.0, 0.8
"""By what shares of the bound a plan may be dearer that is looked for first where every sweep is to come to its end,
how many times as much next, and what share of the work that is left a sweep may take."""
ONE_GO, LEAST_STEP = 1.5, 0.1
"""How many steps it may be to the known plan for the next sweep to go that far, and the least step, as a share of what
was gone so far."""


def ending(least: float, known: int, left: Callable[[], float]) -> Iterator[int]:
    """Limits as `rising` gives them, but such that the sweep to each will end with the work that is left.

    The first is next to the `least` itself, as plans may cost no more. What a sweep takes rises about as a power of its
    limit.

    Raises
    ------
    TooLarge
        Where no sweep that says more would end.
    """
    over, step, before = FIRST * least, FIRST * least, 0.0
    if least + over < known:
        yield int(least + SOON * least)
    while least + over < known:
        had = left()
        yield int(least + over)
        taken = max(had - left(), LITTLE * had)
        times = log(max(1.01, taken / before)) / step if before > 0.0 else log(DEARER) / over
        room = log(max(1e-9, ENDS * left() / taken)) / times
        step = min(log(DEARER) / times, TWICE * over, room)
        to_known = known - least - over
        if to_known <= min(room, ONE_GO * step):
            break
        if step < LEAST_STEP * over:
            raise TooLarge
        over, before = over + step, taken
    yield known
