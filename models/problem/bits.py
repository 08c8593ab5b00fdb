"""Sets of contours as rows of 64-bit words: contour i is bit i % 64 of word i // 64."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools
from kerfwise.models.kernels import inner

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


@inner(nogil=True)
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


@inner(nogil=True)
def missing(wanted: Masks, mask: Masks) -> bool:  # pragma: no cover - compiled
    """Whether some of the wanted contours are not in the set."""
    for w in range(len(wanted)):  # noqa: SIM110 - numba has no generators here
        if wanted[w] & ~mask[w]:
            return True
    return False


@inner(nogil=True)
def has(mask: Masks, k: int) -> bool:  # pragma: no cover - compiled
    """Whether contour k is in the set."""
    return bool(mask[k >> 6] >> (np.uint64(k) & LOW) & ONE)
