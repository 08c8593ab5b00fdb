"""Steps that make millions of objects, none of which go round in circles, are not searched for circles meanwhile.

Python looks through young objects twice while they grow old, and through all objects each time there are a quarter more
of them. On a large nest that is a tenth and more of the time that facts, statements, a problem and the check take.
"""

from __future__ import annotations

import gc
import threading
from collections.abc import Iterator
from contextlib import contextmanager

SELDOM = 2_000_000
"""So many more objects come before the young ones are looked through."""
NEVER = 1_000_000_000
"""So many collections of the middle generation come before one of all."""
MANY = 100_000
"""With fewer young objects at its end a block leaves them to the usual looks, which do not take long."""
_lock = threading.Lock()
_usual: list[tuple[int, int, int]] = []
"""What the thresholds were before each of the blocks that are open."""
_unseen = _all = 0
"""How many objects blocks have made old since the last look of their own through all, and how many there were then."""


@contextmanager
def few_collections(seldom: int = SELDOM) -> Iterator[None]:
    """A block in which few objects are looked through; also a decorator. Blocks may lie in each other.

    What was made in it counts as old afterwards, if it is much: circles among that are found by the next look through
    all objects, at the latest when there are twice as many as at the last one.

    Parameters
    ----------
    seldom
        So many more objects come before the young ones are looked through; that of the outermost block holds.

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
        _usual.append((first, second, third))
        if len(_usual) == 1:
            gc.set_threshold(max(first, seldom) if first else 0, second, NEVER)
    try:
        yield
    finally:
        with _lock:
            usual = _usual.pop()
            if not _usual:
                _grown_old()
                gc.set_threshold(*usual)


def _grown_old() -> None:
    """All objects count as old, none of them looked through; seldom all are, as circles among them are lost memory."""
    global _unseen, _all
    young = gc.get_count()[0]
    if young < MANY or gc.get_freeze_count():  # what others have put aside stays there
        return
    _unseen += young
    due = gc.isenabled() and _unseen > max(SELDOM, _all)
    if due:
        gc.collect()
    gc.freeze()
    if due:
        _unseen, _all = 0, gc.get_freeze_count()
    gc.unfreeze()
