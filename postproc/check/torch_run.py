"""One torch-on path, taken apart: lead-in, once round, lead-out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely import ops

from kerfwise.encoder.cut import Tab
from kerfwise.encoder.geometry.curve import Curve, lines_of
from kerfwise.encoder.nest import Contour

from .covering.free import at_tabs
from .covering.intervals import minus

_CHORD_MM = 0.005


@dataclass(frozen=True, eq=False, slots=True)
class TorchRun:
    """What the torch does between on and off.

    `position` counts cuts from 1; `where` says where a person finds it ("cut 3" or "line 40"). `loop` is the path
    around the contour; `marks` says that another tool than the torch was on. A `linked` run follows the one before it
    with the torch on: its lead-in is the link. The loop of a `partial` one is not all of its contour's ring. Over the
    stretches of its loop that `unlit` names, as wide as that, the torch is off. A run `between_tabs` is partial for
    that alone: together with the others of its contour it goes all round, but for the tabs. The loop surely lies within
    the tolerance of the line that it `follows`; None where that is not known.
    """

    position: int
    where: str
    contour: Contour | None
    lead_in: shapely.LineString | None
    loop: shapely.LineString
    lead_out: shapely.LineString | None
    marks: bool = False
    linked: bool = False
    partial: bool = False
    unlit: tuple[Tab, ...] = ()
    between_tabs: bool = False
    follows: shapely.LineString | None = None

    @property
    def name(self) -> str:
        """The contour's id, or a stand-in where the path matches none."""
        return self.contour.id if self.contour is not None else "an unknown path"

    @property
    def leads(self) -> tuple[shapely.LineString, ...]:
        """Lead-in and lead-out, where there are any."""
        return tuple(lead for lead in (self.lead_in, self.lead_out) if lead is not None)

    @property
    def length_mm(self) -> float:
        """Torch-on length, mm."""
        off_mm = sum(tab.width_mm for tab in self.unlit)
        return float(self.loop.length + sum(lead.length for lead in self.leads)) - off_mm

    @property
    def lit(self) -> tuple[TorchRun, ...]:
        """The run as it burns: a run for each stretch between two tabs, the leads with the first and the last.

        None where tabs are as wide as all of its loop.
        """
        if not self.unlit:
            return (self,)
        length_mm = float(self.loop.length)
        off = at_tabs(self.loop, self.unlit, 0.0)
        begin_mm = 0.0 if self.lead_in is None else float(self.loop.project(shapely.get_point(self.lead_in, -1)))
        on = [(low, high) for low, high in minus(np.array([[0.0, length_mm]]), off).tolist() if high - low > 1e-6]
        if not on:
            return ()
        pieces = [ops.substring(self.loop, low, high) for low, high in on]
        first = next((k for k, (low, high) in enumerate(on) if low - 1e-6 <= begin_mm <= high + 1e-6), 0)
        lit = replace(self, lead_in=None, lead_out=None, partial=True, linked=True, unlit=())
        made = [replace(lit, loop=piece, between_tabs=not self.partial) for piece in pieces]
        made[first] = replace(made[first], lead_in=self.lead_in, linked=self.linked)
        made = [*made[first:], *made[:first]]
        made[-1] = replace(made[-1], lead_out=self.lead_out)
        return tuple(made)


def every_line_of(paths: Sequence[Curve | None]) -> list[shapely.LineString | None]:
    """As `line_of` of each, in less time."""
    found: list[shapely.LineString | None] = [None] * len(paths)
    known = {k: path for k, path in enumerate(paths) if path is not None and path.segments}
    for k, line in zip(known, lines_of(list(known.values()), _CHORD_MM), strict=True):
        found[k] = line
    return found


def line_of(path: Curve | None) -> shapely.LineString | None:
    """An open path as a line; None for one that goes nowhere."""
    return path.line(_CHORD_MM) if path is not None and path.segments else None
