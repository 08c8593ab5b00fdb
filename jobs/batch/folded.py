"""Long refusals told in short: the first few of what is listed, and how many more there are."""

from __future__ import annotations

from dataclasses import dataclass

MOST = 3
"""So many of a list are told; a list that is one longer is told as a whole."""
_ITEM = "  - "


@dataclass(frozen=True, slots=True)
class Folded:
    """What is said of a nest in two pieces: what is told at once, and the lines that are folded away."""

    told: str
    rest: tuple[str, ...] = ()

    @property
    def more(self) -> str:
        """How many of the list are folded away; "" where none is."""
        return f"… and {sum(line.startswith(_ITEM) for line in self.rest)} more" if self.rest else ""


def folded(told: str) -> Folded:
    """What is said of a nest, the list in it cut short.

    A list is of lines that begin with `  - `; lines below one that begin otherwise belong to it.

    Examples
    --------
    >>> short = folded("5 problems" + "".join(f"\\n  - P{k} is open" for k in range(5)))
    >>> short.told.count("is open"), short.more
    (3, '… and 2 more')
    >>> folded("it is open").more
    ''
    """
    lines = told.split("\n")
    items = [k for k, line in enumerate(lines) if line.startswith(_ITEM)]
    if len(items) <= MOST + 1:
        return Folded(told)
    return Folded("\n".join(lines[: items[MOST]]), tuple(lines[items[MOST] :]))
