"""What the simulation can find wrong with a program."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from kerfwise.tests.metal.arcs import Point

Kind = Literal[
    "part-eroded",
    "left-uncut",
    "feature-lost",
    "part-not-free",
    "part-not-held",
    "bridge-cut",
    "mark-not-made",
    "hole-not-small",
    "pierce-over-void",
    "lead-over-void",
    "pierce-in-part",
    "not-pierced",
    "pierce-unused",
    "off-sheet",
    "loose-part-burnt",
    "loose-waste-burnt",
    "cut-twice",
    "resumed-wrong",
]
KINDS: tuple[Kind, ...] = get_args(Kind)
"""Every kind, in the order of reports."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One fault: its kind, the cut (0: none in particular), contours, place (mm), and how large it is, in `unit`."""

    kind: Kind
    cut: int
    contours: tuple[str, ...]
    place: Point
    size: float
    unit: str
    text: str

    def __str__(self) -> str:
        """One line, as a report prints it."""
        at = f"cut {self.cut}, " if self.cut else ""
        size = f"{self.size:.2f} {self.unit}" if self.unit else ""
        where = f"at ({self.place[0]:.2f}, {self.place[1]:.2f})"
        return f"{self.kind}: {at}{' and '.join(self.contours)} {where}: {self.text} {size}".rstrip()
