"""One torch-on path, where its centre must run, and what every program must keep, whatever the profile says."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np
import shapely
from shapely import ops

from kerfwise.encoder.cut import Tab
from kerfwise.encoder.geometry.curve import Curve, lines_of, polygons_of
from kerfwise.encoder.geometry.tolerances import tolerance_mm as _tolerance_mm
from kerfwise.encoder.nest import Contour, Nest, cached_with_nest
from kerfwise.rules.judging.violation import Violation

from .result import Judgement
from .ring_coverage import difference, tab_intervals

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

    def wrong(self, rule: str, text: str, *contours: str) -> Violation:
        """What is wrong with it, behind where it is; these contours are named, else its own."""
        named = contours or (() if self.contour is None else (self.contour.id,))
        return Violation(rule, named, f"{self.where}: {text}", (self.position,) if self.position else ())

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
        off = tab_intervals(self.loop, self.unlit, 0.0)
        begin_mm = 0.0 if self.lead_in is None else float(self.loop.project(shapely.get_point(self.lead_in, -1)))
        on = [(low, high) for low, high in difference(np.array([[0.0, length_mm]]), off).tolist() if high - low > 1e-6]
        if not on:
            return ()
        pieces = [ops.substring(self.loop, low, high) for low, high in on]
        first = next((k for k, (low, high) in enumerate(on) if low - 1e-6 <= begin_mm <= high + 1e-6), 0)
        lit = replace(self, lead_in=None, lead_out=None, partial=True, linked=True, unlit=())
        runs = [replace(lit, loop=piece, between_tabs=not self.partial) for piece in pieces]
        runs[first] = replace(runs[first], lead_in=self.lead_in, linked=self.linked)
        runs = [*runs[first:], *runs[:first]]
        runs[-1] = replace(runs[-1], lead_out=self.lead_out)
        return tuple(runs)


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


# Where the torch's centre must run: each contour grown or shrunk by half the kerf, made here by shapely alone.

Side = Literal["right", "wrong", "on"]
Ring: TypeAlias = shapely.LinearRing | shapely.LineString
_RING_CHORD_MM = 0.005


def torch_rings(contours: Sequence[Contour], kerf_mm: float, side: Side = "right") -> list[Ring | None]:
    """The line the torch's centre follows around each contour; None where the kerf leaves nothing.

    "right" is half the kerf outside an outer contour and inside a hole, "wrong" the other way round, "on" the contour
    itself. Marks, slits and scrap lines are their own lines. Chords lie within 0.006 mm of the true curve.

    Examples
    --------
    >>> from kerfwise.encoder.geometry.curve import Curve
    >>> hole = Contour("P.hole1", "P", "hole", Curve.of([(0, 0), (10, 0), (10, 10), (0, 10)]))
    >>> torch_rings([hole], 2.0)[0].length
    32.0
    """
    half = {"right": kerf_mm / 2, "wrong": -kerf_mm / 2, "on": 0.0}[side]
    rings: list[Ring | None] = [
        None if contour.encloses and half else contour.curve.line(_RING_CHORD_MM) for contour in contours
    ]
    beside = [k for k, ring in enumerate(rings) if ring is None]
    if not beside:
        return rings
    areas = shapely.make_valid(polygons_of([contours[k].curve for k in beside], _RING_CHORD_MM))
    by_mm = [half if contours[k].kind == "outer" else -half for k in beside]
    pieces, of = shapely.get_parts(shapely.buffer(areas, by_mm, quad_segs=16), return_index=True)
    sizes = shapely.area(pieces)
    by_size = np.lexsort((np.arange(len(of)), -sizes, of))
    largest = by_size[np.flatnonzero(np.diff(of[by_size], prepend=-1))]
    largest = largest[sizes[largest] > 0]
    for k, ring in zip(of[largest].tolist(), shapely.get_exterior_ring(pieces[largest]), strict=True):
        rings[beside[k]] = ring
    return rings


@cached_with_nest(most=1)
def rings_of(nest: Nest, kerf_mm: float) -> tuple[Ring | None, ...]:
    """The right ring of every contour of a nest; kept with it, for a plan and its program."""
    return tuple(torch_rings(nest.contours, kerf_mm))


_WRITTEN, _RETOLD = "KERFWISE FOR ", "TOLD FROM AN OLDER PROGRAM"
_STEP_MM: ContextVar[float] = ContextVar("step_mm", default=0.0)


def tolerance_mm(kerf_mm: float = 0.0) -> float:
    """How far a torch path may be from where it belongs at this kerf, or at the steps that its control counts in.

    Examples
    --------
    >>> tolerance_mm(1.5)
    0.05
    >>> with in_steps_of(0.1):
    ...     tolerance_mm(1.5)
    0.1
    """
    return max(_tolerance_mm(kerf_mm), _STEP_MM.get())


def step_mm() -> float:
    """The least step that the control of what is judged counts in, 0 where no digit is missed."""
    return _STEP_MM.get()


def written_from_profile(comments: Iterable[str]) -> bool:
    """Whether a program says that kerfwise wrote all of it: from a plan and a profile, not from an older program.

    Examples
    --------
    >>> written_from_profile(["KERFWISE FOR LINUXCNC", "NEST a.dxf SHA256 0123"])
    True
    """
    upper = [text.upper() for text in comments]
    return any(text.startswith(_WRITTEN) for text in upper) and not any(_RETOLD in text for text in upper)


@contextmanager
def in_steps_of(step_mm: float) -> Iterator[None]:
    """What is judged meanwhile was written in whole steps: no path is nearer than half a step's diagonal, 0.71 steps.

    The rest of a step is for chords. Steps finer than the tolerance change nothing.
    """
    before = _STEP_MM.set(step_mm)
    try:
        yield
    finally:
        _STEP_MM.reset(before)


SENTENCES = {
    "every-contour-once": "Every contour of the nest is cut exactly once, and nothing else is.",
    "tabs": "Every contour is left uncut at its tabs.",
    "bridges": "Parts that bridges join stay one piece: the outline is theirs, and no kerf enters a strip.",
    "edge-loss": "Parts that touch lose half a kerf along the edges that do, no more, and nothing else.",
    "pierce-pass": "Each cut begins at a hole of its pierce pass, within 0.05 mm, and no hole is left over.",
    "torches": "What torches cut together is the same cut, shifted by what the profile has them apart.",
    "bevels": "Each bevel is cut on all of its face; no pass enters a part at any depth, or leaves the sheet.",
    "burnt-twice": "No stretch of a contour is burnt again, but for overcuts, leads and whole rounds a kerf apart.",
    "links": "The torch stays on from one contour to the next only where the profile allows it, off older kerfs.",
    "loose-metal": "Nothing is cut in metal that has come loose, part or waste, whatever has cut it off.",
    "scrap-pieces": "The skeleton's largest piece is cut into pieces no larger than asked for, and its remnant saved.",
    "follows-plan": "The program makes the cuts of its plan, in their order, at their entries, the same way round.",
    "small-holes": "Holes too small to be cut have their middle marked or are left out, as the profile says.",
    "contour-geometry": "The torch follows each contour, kerf allowed for, within 0.05 mm, and its leads join there.",
    "features-kept": "The kerf reaches every stretch of a contour, but for what a round kerf leaves of inner corners.",
    "kerf-side": "The kerf lies outside outer contours and inside holes.",
    "torch-off-travel": "The torch is off on every rapid.",
    "program-state": "The program says in what units and how it moves, and starts its tools with S1 or their power.",
    "feeds": "The torch moves at the profile's feeds, slower in small holes and at corners, and travels by rapids.",
    "pierce-delay": "The torch stands at each pierce for the profile's time; elsewhere only off, to let metal cool.",
    "returns-home": "The torch ends where it starts, at the machine's home.",
    "on-sheet": "The torch burns only over the sheet, but for the run-up of an edge start.",
    "edge-start": "The torch begins off the sheet only where edge starts are allowed, at an edge that is stated.",
    "within-travel": "The torch stays within the machine's travel.",
    "no-gouging": "The kerf of no cut, its leads included, enters the metal of a part by more than 0.05 mm.",
    "totals": "The totals, lengths and times that the plan states are those of its cuts.",
    "claims": "Each hard rule holds in the plan where the plan says so.",
}


def judgement(rule_id: str, violations: Iterable[Violation], unjudged: str | None = None) -> Judgement:
    """The judgement on one of these rules; all are hard."""
    return Judgement(rule_id, "hard", SENTENCES[rule_id], tuple(violations), unjudged=unjudged)
