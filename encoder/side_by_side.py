"""Two steps that share nothing they write, side by side: most of both is done by a library that lets Python go on."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

OneT = TypeVar("OneT")
OtherT = TypeVar("OtherT")


def side_by_side(one: Callable[[], OneT], other: Callable[[], OtherT], pays: bool = True) -> tuple[OneT, OtherT]:
    """Both answers; `other` is found in a thread of its own where that `pays`.

    Where both fail, the error is that of `one`. Geometry that is prepared must not be asked by both: GEOS finishes its
    preparation at the first question, in whichever thread.

    Examples
    --------
    >>> side_by_side(lambda: 1, lambda: "two")
    (1, 'two')
    """
    if not pays:
        return one(), other()
    with ThreadPoolExecutor(1) as thread:
        beside = thread.submit(other)
        return one(), beside.result()
