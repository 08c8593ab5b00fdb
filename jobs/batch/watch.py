"""New files as they arrive: a folder is looked at again and again, and a file read once nobody writes it any more.

Looking again works on every file system. Systems tell of changes on a share of another machine seldom or never, and
that is where nests come from.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path

LOOK_S = 1.0
"""How long between one look and the next."""
SETTLED_S = 2.0
"""So long a file must have kept its size and time before it is read."""

Stand = tuple[int, int]
"""Size in bytes and time of the last change, ns."""


def stand_of(file: Path) -> Stand | None:
    """How a file stands now; None where there is none."""
    with contextlib.suppress(OSError, ValueError):
        found = file.stat()
        return found.st_size, found.st_mtime_ns
    return None


@dataclass(slots=True)
class Settling:
    """Which files nobody writes any more, by what was seen of them before.

    Examples
    --------
    >>> settling = Settling()
    >>> stands = {Path("a.dxf"): (10, 1)}
    >>> [[file.name for file in settling.settled(stands, now_s)] for now_s in (0.0, 1.0, 2.5)]
    [[], [], ['a.dxf']]
    """

    _seen: dict[Path, tuple[Stand, float]] = field(default_factory=dict)

    def settled(self, stands: dict[Path, Stand], now_s: float) -> dict[Path, Stand]:
        """Of the files that there are, those that have stood as they do for `SETTLED_S`, each with how it stands."""
        before, self._seen = self._seen, {}
        for file, stand in stands.items():
            known = before.get(file)
            self._seen[file] = known if known is not None and known[0] == stand else (stand, now_s)
        return {file: stand for file, (stand, since_s) in self._seen.items() if now_s - since_s >= SETTLED_S}


def watch(
    files: Callable[[], Iterable[Path]],
    arrived: Callable[[frozenset[Path]], object],
    *,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> None:
    """Call `arrived` with all files that are settled, each time that one of them is new, changed or gone.

    One that is being written again counts as it was until it is settled. It ends with what `arrived` or `sleep`
    raises, such as KeyboardInterrupt.
    """
    settling = Settling()
    done: dict[Path, Stand] = {}
    while True:
        stands = {file: stand for file in files() if (stand := stand_of(file)) is not None}
        settled = settling.settled(stands, clock())
        known = {file: stand for file, stand in done.items() if file in stands} | settled
        if known != done:
            arrived(frozenset(settled))
            done = known
        sleep(LOOK_S)
