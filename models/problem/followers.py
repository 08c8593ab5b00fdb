"""Which contour may directly follow which, kept as bits: of 10,000 contours 12.5 MB."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Ints


@dataclass(frozen=True, eq=False, slots=True)
class Followers:
    """Of n contours and home, which is number n: row i of `bits` are those that may directly follow i.

    Examples
    --------
    >>> followers = Followers.of(np.array([[False, True], [True, False]]))
    >>> len(followers), followers[0].tolist(), followers.ahead_of(0).tolist(), followers.at([0, 1], [1, 1]).tolist()
    (2, [False, True], [False, True], [True, False])
    """

    bits: NDArray[np.uint8]

    @staticmethod
    def of(lawful: Bools) -> Followers:
        """Of a matrix."""
        return Followers(np.packbits(lawful, axis=1, bitorder="little"))

    def __len__(self) -> int:
        return len(self.bits)

    def __getitem__(self, i: int) -> Bools:
        """Which may follow i, (n + 1,)."""
        row = np.unpackbits(self.bits[i], count=len(self), bitorder="little")
        return row.view(np.bool_)

    def ahead_of(self, j: int) -> Bools:
        """Which j may follow, (n + 1,)."""
        return np.asarray(self.bits[:, j >> 3] >> np.uint8(j & 7) & np.uint8(1)).view(np.bool_)

    def at(self, one: Ints | list[int], other: Ints | list[int]) -> Bools:
        """Whether `other[k]` may follow `one[k]`, (k,)."""
        i, j = np.asarray(one, dtype=np.int64), np.asarray(other, dtype=np.int64)
        return np.asarray(self.bits[i, j >> 3] >> (j & 7).astype(np.uint8) & np.uint8(1)).view(np.bool_)

    def weighed(self, weights: Ints) -> Ints:
        """What the weights (n + 1,) of those that may follow each come to, (n + 1,), without the matrix.

        Examples
        --------
        >>> Followers.of(np.array([[False, True], [True, True]])).weighed(np.array([5, 2])).tolist()
        [2, 7]
        """
        found = np.zeros(len(self), dtype=np.int64)
        for weight in np.unique(weights).tolist():
            alike = np.packbits(weights == weight, bitorder="little")
            found += weight * np.bitwise_count(self.bits & alike).sum(axis=1, dtype=np.int64)
        return found

    def whole(self) -> Bools:
        """As a matrix (n + 1, n + 1): large."""
        return np.unpackbits(self.bits, axis=1, count=len(self), bitorder="little").view(np.bool_)
