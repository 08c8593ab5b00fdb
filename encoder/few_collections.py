"""Steps that make millions of objects, none of which go round in circles, are not searched for circles meanwhile.

Python looks through all objects each time there are a quarter more of them, which is a tenth of the time that facts,
statements, a problem and the check of a large nest take. Young objects are still looked through.
"""

from __future__ import annotations

import gc
import threading
from collections.abc import Iterator
from contextlib import contextmanager

NEVER = 1_000_000_000
"""So many collections of the middle generation come before one of all."""
_lock = threading.Lock()
_usual: list[int] = []
"""What the threshold was before each of the blocks that are open."""


@contextmanager
def few_collections() -> Iterator[None]:
    """A block in which not all objects are looked through; also a decorator. Blocks may lie in each other.

    Examples
    --------
    >>> usual = gc.get_threshold()
    >>> with few_collections():
    ...     gc.get_threshold()[2] == NEVER
    True
    >>> gc.get_threshold() == usual
    True
    """
    with _lock:
        first, second, third = gc.get_threshold()
        _usual.append(_usual[0] if _usual else third)
        gc.set_threshold(first, second, NEVER)
    try:
        yield
    finally:
        with _lock:
            usual = _usual.pop()
            if not _usual:
                gc.set_threshold(*gc.get_threshold()[:2], usual)
