"""Bytes of the arrays that something holds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass

import numpy as np
from scipy.sparse import csr_matrix


def held(thing: object) -> int:
    """Bytes of all arrays that a thing of named fields holds, each counted once.

    Examples
    --------
    >>> some = np.zeros(10)
    >>> held((some, [some[2:], np.zeros(2, np.int8)]))
    82
    """
    seen: dict[int, int] = {}
    for array in _arrays(thing, set()):
        whole = array
        while isinstance(whole.base, np.ndarray):
            whole = whole.base
        seen[id(whole)] = whole.nbytes
    return sum(seen.values())


def _arrays(thing: object, known: set[int]) -> Iterator[np.ndarray]:
    if isinstance(thing, np.ndarray):
        yield thing
    elif isinstance(thing, csr_matrix):
        yield from (thing.data, thing.indices, thing.indptr)
    elif id(thing) not in known:
        known.add(id(thing))
        inner: list[object] = []
        if is_dataclass(thing):
            inner = [getattr(thing, field.name) for field in fields(thing)]
        elif isinstance(thing, list | tuple):
            inner = list(thing)
        elif hasattr(thing, "__dict__"):
            inner = list(vars(thing).values())
        for one in inner:
            yield from _arrays(one, known)
