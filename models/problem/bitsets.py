"""Sets of contours as rows of 64-bit words: contour i is bit i % 64 of word i // 64."""

from __future__ import annotations

import hashlib
import weakref
from collections.abc import Sequence
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools
from kerfwise.models.jit import KERNEL, inner

Masks = NDArray[np.uint64]

LOW = np.uint64(63)
ONE = np.uint64(1)

ROWS_AT_ONCE = 512
"""Rows of a matrix of all pairs of contours that are looked at together: all of it again would be large."""


def words(n: int) -> int:
    """Words that a set of n contours takes."""
    return max(1, -(-n // 64))


def masks_of(sets: Sequence[Sequence[int]], n: int) -> Masks:
    """Sets of contours as rows of words, (len(sets), words).

    Examples
    --------
    >>> masks_of([(0, 2), (64,)], 65).tolist()
    [[5, 0], [0, 1]]
    """
    masks = np.zeros((len(sets), words(n)), dtype=np.uint64)
    for row, members in zip(masks, sets, strict=True):
        for k in members:
            row[k // 64] |= np.uint64(1 << k % 64)
    return masks


def bits_of(masks: Masks, n: int) -> Bools:
    """Which of n contours are in each of some sets, (len(masks), n).

    Examples
    --------
    >>> bits_of(masks_of([(0, 2), (64,)], 65), 65).nonzero()[1].tolist()
    [0, 2, 64]
    """
    octets = np.ascontiguousarray(masks, dtype="<u8").view(np.uint8)
    bits: Bools = np.unpackbits(octets, axis=1, count=n, bitorder="little").view(np.bool_)
    return bits


@inner(**KERNEL)
def bit_number(bit: np.uint64) -> int:  # pragma: no cover - compiled
    """The number of the only bit that is set."""
    number = 0
    if bit & np.uint64(0xFFFFFFFF00000000):
        number += 32
    if bit & np.uint64(0xFFFF0000FFFF0000):
        number += 16
    if bit & np.uint64(0xFF00FF00FF00FF00):
        number += 8
    if bit & np.uint64(0xF0F0F0F0F0F0F0F0):
        number += 4
    if bit & np.uint64(0xCCCCCCCCCCCCCCCC):
        number += 2
    if bit & np.uint64(0xAAAAAAAAAAAAAAAA):
        number += 1
    return number


@inner(**KERNEL)
def missing(wanted: Masks, mask: Masks) -> bool:  # pragma: no cover - compiled
    """Whether some of the wanted contours are not in the set."""
    for w in range(len(wanted)):  # noqa: SIM110 - numba has no generators here
        if wanted[w] & ~mask[w]:
            return True
    return False


@inner(**KERNEL)
def has(mask: Masks, k: int) -> bool:  # pragma: no cover - compiled
    """Whether contour k is in the set."""
    return bool(mask[k >> 6] >> (np.uint64(k) & LOW) & ONE)


# The last answers about orders, kept as long as the orders live: each round of a solve asks for the same again.

AnswerT = TypeVar("AnswerT")


class LastAnswer(Generic[AnswerT]):
    """The last answer, and that about the largest array, each kept no longer than its array; nothing is to be changed.

    Of a problem in zones the small problems of every zone come between two questions about the whole.

    Examples
    --------
    >>> import numpy as np
    >>> last, orders = LastAnswer[str](), np.zeros((2, 2), dtype=np.bool_)
    >>> last.keep(orders, b"as asked", "none")
    >>> last.known(orders, b"as asked"), last.known(orders, b"otherwise"), last.known(orders.copy(), b"as asked")
    ('none', None, None)
    """

    def __init__(self) -> None:
        self._kept: list[tuple[weakref.ref[Bools], bytes, AnswerT]] = []

    def known(self, of: Bools, key: bytes) -> AnswerT | None:
        """The answer, if the same was asked of the same array and is kept."""
        return next((answer for array, what, answer in self._kept if array() is of and what == key), None)

    def keep(self, of: Bools, key: bytes, answer: AnswerT) -> None:
        """Keep an answer until the next, or, if it is about the largest array, as long as there is no larger one."""
        living = [kept for kept in self._kept if kept[0]() is not None and kept[0]() is not of]
        largest = max(living, key=_size, default=None)
        self._kept = [(weakref.ref(of, self._forget), key, answer)]
        if largest is not None and _size(largest) > of.size:
            self._kept.append(largest)

    def _forget(self, gone: weakref.ref[Bools]) -> None:
        self._kept = [kept for kept in self._kept if kept[0] is not gone]


def _size(kept: tuple[weakref.ref[Bools], bytes, Any]) -> int:
    array = kept[0]()
    return 0 if array is None else array.size


def digest(*arrays: Any) -> bytes:
    """What tells arrays apart, without keeping them."""
    sha = hashlib.sha256()
    for array in arrays:
        sha.update(repr((array.shape, array.dtype.str)).encode())
        sha.update(array.tobytes())
    return sha.digest()
