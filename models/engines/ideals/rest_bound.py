"""What a plan still costs at least after a state of a sweep, as its inner loops read it."""

from __future__ import annotations

from typing import NamedTuple

from kerfwise.arrays import Floats, Ints
from kerfwise.models.kernels import inner
from kerfwise.models.problem.bits import Masks, has


class RestBound(NamedTuple):
    """What a plan still costs after a state at least: `to_go[A, c]` at column c, and `price` for contours not out.

    Bit b of A says that neighbour b of the last contour is not out; `near[i, b]` is that neighbour of contour i, -1
    where it is out already or there is none, -2 where it comes after the stretch. `later` is added to all.
    """

    to_go: Floats
    near: Ints
    price: Floats
    later: float


@inner(nogil=True)
def still_to_come(rest: RestBound, mask: Masks) -> float:  # pragma: no cover - compiled
    """What contours that are not out still cost by their prices."""
    to_come = rest.later
    for i in range(len(rest.price)):
        if not has(mask, i):
            to_come += rest.price[i]
    return to_come


@inner(nogil=True)
def near_left(rest: RestBound, mask: Masks, i: int) -> int:  # pragma: no cover - compiled
    """Which neighbours of contour i are not out once it is, as bits."""
    free = 0
    for b in range(rest.near.shape[1]):
        other = rest.near[i, b]
        if other == -2 or (other >= 0 and other != i and not has(mask, other)):
            free |= 1 << b
    return free
