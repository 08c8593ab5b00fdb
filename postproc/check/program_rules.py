"""What every program must keep, whatever the profile says; each id with its sentence."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from kerfwise.encoder.tolerance import TOLERANCE_MM as TOLERANCE_MM
from kerfwise.encoder.tolerance import tolerance_mm as _tolerance_mm
from kerfwise.rules.rule import Violation

from .judgement import Judgement

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
    said = [text.upper() for text in comments]
    return any(text.startswith(_WRITTEN) for text in said) and not any(_RETOLD in text for text in said)


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
