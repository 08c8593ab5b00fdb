"""The last answers about orders, kept as long as the orders live: each round of a solve asks for the same again."""

from __future__ import annotations

import hashlib
import weakref
from typing import Any, Generic, TypeVar

from kerfwise.arrays import Bools

AnswerT = TypeVar("AnswerT")


class LastOf(Generic[AnswerT]):
    """The last answer, and that about the largest array, each kept no longer than its array; nothing is to be changed.

    Of a problem in zones the small problems of every zone come between two questions about the whole.

    Examples
    --------
    >>> import numpy as np
    >>> last, orders = LastOf[str](), np.zeros((2, 2), dtype=np.bool_)
    >>> last.keep(orders, b"as asked", "none")
    >>> last.known(orders, b"as asked"), last.known(orders, b"otherwise"), last.known(orders.copy(), b"as asked")
    ('none', None, None)
    """

    def __init__(self) -> None:
        self._kept: list[tuple[weakref.ref[Bools], bytes, AnswerT]] = []

    def known(self, of: Bools, asked: bytes) -> AnswerT | None:
        """The answer, if the same was asked of the same array and is kept."""
        return next((answer for array, what, answer in self._kept if array() is of and what == asked), None)

    def keep(self, of: Bools, asked: bytes, answer: AnswerT) -> None:
        """Keep an answer until the next, or, if it is about the largest array, as long as there is no larger one."""
        living = [kept for kept in self._kept if kept[0]() is not None and kept[0]() is not of]
        largest = max(living, key=_size, default=None)
        self._kept = [(weakref.ref(of, self._forget), asked, answer)]
        if largest is not None and _size(largest) > of.size:
            self._kept.append(largest)

    def _forget(self, gone: weakref.ref[Bools]) -> None:
        self._kept = [kept for kept in self._kept if kept[0] is not gone]


def _size(kept: tuple[weakref.ref[Bools], bytes, Any]) -> int:
    array = kept[0]()
    return 0 if array is None else array.size


def digest(*arrays: Any) -> bytes:
    """What tells arrays apart, without keeping them."""
    told = hashlib.sha256()
    for array in arrays:
        told.update(repr((array.shape, array.dtype.str)).encode())
        told.update(array.tobytes())
    return told.digest()
