"""Whether the check's reader and a control make the same of a program."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import chain, pairwise
from typing import Literal

import numpy as np
import shapely

from kerfwise import InputError
from kerfwise.jobs.inputs import decoded
from kerfwise.postproc.check.reader.controls import CONTROLS
from kerfwise.postproc.check.reader.program import NcProgram
from kerfwise.postproc.check.reader.rs274 import read_nc
from kerfwise.tests.fuzz import control as controls
from kerfwise.tests.tools import canon

TOLERANCE_MM = 0.001
PRINTED_MM = {False: 1e-4, True: 2.54e-3}
"""The last digit that rs274 prints, by whether the program counts in inches somewhere."""
STRICT = ("not supported here", "is not UTF-8")
"""What our reader says where it may be stricter than the control."""
Kind = Literal[
    "same", "same, at fault", "both refuse", "refused as not supported", "stricter", "stricter in silence", "differs"
]
BAD: tuple[Kind, ...] = ("stricter in silence", "differs")
_TORCH = ("is started while", "rapid with the torch on", "ends with the torch on", "started while")
_NOT_STARTED = "QtPlasmaC starts no tool"


@dataclass(frozen=True, slots=True)
class Verdict:
    """How the two compare, and in what they differ."""

    kind: Kind
    text: str = ""


def judge(program: bytes, control: str, stricter: bool = False) -> Verdict:
    """Let both read a program.

    What our reader refuses as not supported it may refuse whatever the control does: only with `stricter` the control
    is asked all the same, to tell apart where both refuse.
    """
    try:
        ours = read_nc(decoded(program, "p.ngc"), control=CONTROLS[control])
    except InputError as error:
        said = any(words in str(error) for words in STRICT)
        if said and not stricter:
            return Verdict("refused as not supported", str(error))
        theirs = controls.run(program, control)
        if theirs.error is not None:
            return Verdict("both refuse", f"{error} / {theirs.error}")
        return Verdict("stricter" if said else "stricter in silence", str(error))
    theirs = controls.run(program, control)
    faults = [fault.text for fault in ours.faults if fault.rule == "torch-off-travel" or _NOT_STARTED in fault.text]
    if theirs.error is not None:
        refused = "the filter finds errors" in theirs.error and any(_NOT_STARTED in text for text in faults)
        return Verdict("same, at fault") if refused else Verdict("differs", f"the control refuses it: {theirs.error}")
    warned = [text for text in theirs.warnings if any(words in text for words in _TORCH)]
    if others := [text for text in theirs.warnings if text not in warned and "arc sweep" not in text]:
        return Verdict("differs", others[0])
    if warned and not (faults or ours.hot_rapids):
        return Verdict("differs", warned[0])
    if faults or ours.hot_rapids:  # the check fails the program
        return Verdict("same, at fault")
    different = _different(ours, theirs, any(code in program.upper() for code in (b"G20", b"G 20", b"G020")))
    return Verdict("differs", different) if different else Verdict("same")


def _different(ours: NcProgram, theirs: canon.Run, inches: bool) -> str:
    """In what the two runs of a program differ; nothing, if they do not."""
    near = TOLERANCE_MM + 2 * controls.CHORD_MM + 3 * PRINTED_MM[inches] + theirs.arc_mismatch_mm
    if [b.tool for b in ours.burns] != [b.tool for b in theirs.burns]:
        return f"tools {[b.tool for b in ours.burns]} here, {[b.tool for b in theirs.burns]} there"
    for burn, other in zip(ours.burns, theirs.burns, strict=True):
        path = [tuple(row[:2]) for row in burn.path.as_rows()]
        if burn.path.segments:
            path = [(x, y) for x, y in burn.path.flatten(controls.CHORD_MM).tolist()]
        if (apart := _apart_mm(path, other.points)) > near:
            return f"line {burn.line}: the burns are {apart:.4f} mm apart"
        if abs(burn.path.length_mm - other.length_mm) > near * (2 + len(path)):
            return f"line {burn.line}: the burn is {burn.path.length_mm:.4f} mm here, {other.length_mm:.4f} mm there"
        feeds = sorted({round(feed, 1) for feed in other.feeds_mm_min})
        mine = sorted({round(feed * 60, 1) for feed in burn.feeds_mm_s})
        if len(feeds) != len(mine) or any(abs(a - b) > 0.2 for a, b in zip(feeds, mine, strict=True)):
            return f"line {burn.line}: feeds {mine} here, {feeds} there"
    if math.dist(ours.end, theirs.position) > near:
        return f"ends at {ours.end} here, {theirs.position} there"
    travel_mm = math.fsum(math.dist(a, b) for way in theirs.ways for a, b in pairwise(way))
    if abs(ours.idle_mm - travel_mm) > near * (2 + len(ours.rapids) + sum(map(len, theirs.ways))):
        return f"travels {ours.idle_mm:.4f} mm here, {travel_mm:.4f} mm there"
    ways = shapely.MultiLineString(theirs.ways) if theirs.ways else shapely.Point(0, 0)
    lengths = [*chain.from_iterable(burn.travels_mm for burn in ours.burns), *ours.homing_mm]
    ends = [end for (_, end), length in zip(ours.rapids, lengths, strict=True) if length > near]
    off_mm = shapely.distance(ways, shapely.points(ends)).max() if ends else 0.0
    if off_mm > near:
        return f"a travel ends {off_mm:.4f} mm off every way that the control travels"
    last = [fault.text for fault in ours.faults if fault.rule == "pierce-delay"]
    waits_s = math.fsum(b.pierce_s + b.paused_s + b.wait_s for b in ours.burns)
    if not last and abs(waits_s - theirs.dwell_s) > 1e-3:
        return f"waits {waits_s:g} s here, {theirs.dwell_s:g} s there"
    return ""


def _apart_mm(one: list[canon.Point], other: list[canon.Point]) -> float:
    """How far two chains of points are apart at most, in their order as far as that shows: ends and both ways."""
    ends = max(math.dist(one[0], other[0]), math.dist(one[-1], other[-1]))
    if len(one) < 2 or len(other) < 2:
        return max(ends, max(math.dist(a, one[0]) for a in other), max(math.dist(a, other[0]) for a in one))
    a, b = shapely.LineString(one), shapely.LineString(other)
    there = shapely.distance(a, shapely.points(np.array(other))).max()
    back = shapely.distance(b, shapely.points(np.array(one))).max()
    middles = math.dist(*(line.interpolate(0.5, normalized=True).coords[0] for line in (a, b)))
    far = max(ends, float(there), float(back))
    return max(far, middles) if middles > 10 * far + 0.05 else far
