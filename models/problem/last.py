"""The last answers about orders, kept as long as the orders live: each round of a solve asks for the same again."""

from __future__ import annotations

import hashlib
import weakref
from typing import Any, Generic, TypeVar

from kerfwise.arrays import Bools

AnswerT = TypeVar("AnswerT")


class LastOf(Generic[AnswerT]):
    """The last answer about an array, which is kept no longer than the array; neither is to be changed.

    Examples
    --------
    >>> import numpy as np
    >>> last, orders = LastOf[str](), np.zeros((2, 2), dtype=np.bool_)
    >>> last.keep(orders, b"as asked", "none")
    >>> last.known(orders, b"as asked"), last.known(orders, b"otherwise"), last.known(orders.copy(), b"as asked")
    ('none', None, None)
    """

    def __init__(self) -> None:
        self._last: tuple[weakref.ref[Bools], bytes, AnswerT] | None = None

    def known(self, of: Bools, asked: bytes) -> AnswerT | None:
        """The answer, if the same was asked of the same array last."""
        last = self._last
        return last[2] if last is not None and last[0]() is of and last[1] == asked else None

    def keep(self, of: Bools, asked: bytes, answer: AnswerT) -> None:
        """Keep an answer until the next, or as long as the array lives."""
        self._last = (weakref.ref(of, self._forget), asked, answer)

    def _forget(self, gone: weakref.ref[Bools]) -> None:
        last = self._last
        if last is not None and last[0] is gone:
            self._last = None


def digest(*arrays: Any) -> bytes:
    """What tells arrays apart, without keeping them."""
    told = hashlib.sha256()
    for array in arrays:
        told.update(repr((array.shape, array.dtype.str)).encode())
        told.update(array.tobytes())
    return told.digest()
