"""Short names for arrays, and what numpy lacks: runs end to end, different numbers, near points, work in halves."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields
from typing import TYPE_CHECKING, Any, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

# Short names for the arrays that the whole project passes around.

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Int32s = NDArray[np.int32]
Int16s = NDArray[np.int16]
Float32s = NDArray[np.float32]


NumberT = TypeVar("NumberT", bound=np.generic)


def unique(numbers: NDArray[NumberT]) -> NDArray[NumberT]:
    """The numbers (k,) in rising order, each once.

    Numpy sorts where it is to count them; else it looks by hash, which takes ten times as long for many.

    Examples
    --------
    >>> unique(np.array([3, 1, 3])).tolist()
    [1, 3]
    """
    once: NDArray[NumberT] = np.unique(numbers, return_counts=True)[0]
    return once


def unique_pairs(pairs: NDArray[np.int64]) -> NDArray[np.int64]:
    """The rows (k, 2) of whole numbers, none below 0, in rising order, each once.

    Examples
    --------
    >>> unique_pairs(np.array([[2, 0], [1, 5], [2, 0]])).tolist()
    [[1, 5], [2, 0]]
    """
    over = int(pairs[:, 1].max(initial=0)) + 1
    return np.column_stack(np.divmod(unique(pairs[:, 0] * over + pairs[:, 1]), over))


class Rows:
    """Arrays of a dataclass that belong together row by row, and other such groups among them."""

    __slots__ = ()

    def _columns(self) -> Iterator[Any]:
        return (getattr(self, field.name) for field in fields(self))  # type: ignore[arg-type]

    def __len__(self) -> int:
        return len(next(self._columns()))

    def take(self, rows: Bools | Ints) -> Self:
        """Some of the rows."""
        return type(self)(*(c.take(rows) if isinstance(c, Rows) else c[rows] for c in self._columns()))

    @classmethod
    def joined(cls, several: Sequence[Self]) -> Self:
        """All rows of several, of one at the least, in order."""
        columns = zip(*(one._columns() for one in several), strict=True)
        return cls(*(type(c[0]).joined(c) if isinstance(c[0], Rows) else np.concatenate(c) for c in columns))


# Runs of consecutive numbers laid end to end: how a list of (where, how many) becomes an index array.


def concat_ranges(first: Ints, count: Ints) -> Ints:
    """The numbers first[k] … first[k] + count[k] - 1 of every k, one run after the other.

    Examples
    --------
    >>> concat_ranges(np.array([10, 3]), np.array([3, 2])).tolist()
    [10, 11, 12, 3, 4]
    """
    before = np.cumsum(count) - count
    return np.repeat(first - before, count) + np.arange(int(count.sum()))


def point_tree(points: Floats, leafsize: int = 16) -> cKDTree:
    """A k-d tree of points (k, d); scipy.spatial is loaded with the first one, as most runs need none.

    Examples
    --------
    >>> point_tree(np.array([[0.0, 0.0], [3.0, 4.0]])).query([[3.0, 5.0]])[1].tolist()
    [1]
    """
    from scipy.spatial import cKDTree

    return cKDTree(points, leafsize)


# Two steps that share nothing they write, side by side: most of both is done by a library that lets Python go on.
#
# GEOS finishes the preparation of a geometry at the first question to it: both steps must not ask the same prepared
# one.

OneT = TypeVar("OneT")
OtherT = TypeVar("OtherT")

MANY = 2000
"""Of fewer, the second half is done as soon as a thread has set out."""


def in_parallel(one: Callable[[], OneT], other: Callable[[], OtherT], pays: bool = True) -> tuple[OneT, OtherT]:
    """Both answers; `other` is found in a thread of its own where that `pays`.

    Where both fail, the error is that of `one`.

    Examples
    --------
    >>> in_parallel(lambda: 1, lambda: "two")
    (1, 'two')
    """
    if not pays:
        return one(), other()
    with ThreadPoolExecutor(1) as thread:
        beside = thread.submit(other)
        return one(), beside.result()


def split_in_halves(step: Callable[[slice], OneT], count: int, many: int = MANY) -> tuple[OneT, ...]:
    """What a step makes of all `count` things, or of two halves of them side by side, the first ones first.

    Examples
    --------
    >>> split_in_halves(lambda some: "abcde"[some], 5), split_in_halves(lambda some: "abcde"[some], 5, many=4)
    (('abcde',), ('ab', 'cde'))
    """
    if count < many:
        return (step(slice(0, count)),)
    middle = count // 2
    return in_parallel(lambda: step(slice(0, middle)), lambda: step(slice(middle, count)))
