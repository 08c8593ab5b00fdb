"""Two steps that share nothing they write, side by side: most of both is done by a library that lets Python go on.

GEOS finishes the preparation of a geometry at the first question to it: both steps must not ask the same prepared one.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

OneT = TypeVar("OneT")
OtherT = TypeVar("OtherT")

MANY = 2000
"""Of fewer, the second half is done as soon as a thread has set out."""


def side_by_side(one: Callable[[], OneT], other: Callable[[], OtherT], pays: bool = True) -> tuple[OneT, OtherT]:
    """Both answers; `other` is found in a thread of its own where that `pays`.

    Where both fail, the error is that of `one`.

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


def in_halves(step: Callable[[slice], OneT], count: int, many: int = MANY) -> tuple[OneT, ...]:
    """What a step makes of all `count` things, or of two halves of them side by side, the first ones first.

    Examples
    --------
    >>> in_halves(lambda some: "abcde"[some], 5), in_halves(lambda some: "abcde"[some], 5, many=4)
    (('abcde',), ('ab', 'cde'))
    """
    if count < many:
        return (step(slice(0, count)),)
    middle = count // 2
    return side_by_side(lambda: step(slice(0, middle)), lambda: step(slice(middle, count)))
