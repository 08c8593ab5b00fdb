"""What a program or its plan states of itself, its time and whether it is kept, held against what the check finds.

The sum of times is made here from what the reader found: lines and arcs at their F words, waits, and ways without torch
at the profile's travel. Nothing of it is shared with the clock that plans and programs are timed with.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import compress

import numpy as np
import shapely

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check.reader.program import Burn, NcProgram
from kerfwise.rules.plan_state import PlanState
from kerfwise.rules.profile.technique import Technique
from kerfwise.rules.profile.values import ProfileValues

from .feeds import longest_dwell_s, slow_at_corners
from .plan_conformance import end_of
from .small_features import Shares
from .torch_run import TorchRun, tolerance_mm

SHARE, _ROUNDED_S = 0.05, 1.0
"""How far apart the times may be: a share of the sum, and the whole second that a header rounds up to."""
_CUT_ROUNDED_S = 0.05
"""The same of a single cut, and of the way to it."""
_STATE = re.compile(r"STATE (?P<state>KEPT|BROKEN|KEPT BUT FOR (?P<count>\d{1,6}) PLACES?)", re.IGNORECASE)
_STATE_COMMENT = re.compile(rf"(?m)^([^\n(;]*[(;] *){_STATE.pattern}(?=[) ]*$)", re.IGNORECASE)
_STATED = re.compile(r"ESTIMATED TIME (?P<h>\d{1,6}) H (?P<min>\d\d) MIN (?P<s>\d\d) S", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class SummedTime:
    """How long a program takes, s: by its words alone, and the least and most by the profile's time model.

    With `constant` the three are one. With `blocks` cuts take as long as at the feed of the law. With `acceleration`
    words are the least, and at the most the machine stops at the end of every line and arc.
    """

    words_s: float
    least_s: float
    most_s: float


def stated_time_s(comments: Iterable[str]) -> float | None:
    """The time that a program's header states, s; None where there is none.

    Examples
    --------
    >>> stated_time_s(["CONTOURS 2, PIERCES 2", "ESTIMATED TIME 1 H 13 MIN 04 S"])
    4384.0
    """
    found = next(filter(None, map(_STATED.fullmatch, comments)), None)
    return None if found is None else 3600.0 * int(found["h"]) + 60.0 * int(found["min"]) + int(found["s"])


def summed_time(program: NcProgram, profile: ProfileValues) -> SummedTime:
    """The time of a program, as it says itself how fast it moves and how long it waits."""
    machine, time = profile.machine, profile.time
    burns = program.burns
    cut_s = math.fsum(_moving_s(burn) for burn in burns if burn.tool == 0)
    marked_s = math.fsum(_moving_s(burn) for burn in burns if burn.tool != 0)
    waits_s = math.fsum(burn.wait_s + burn.held_s + burn.pierce_s + burn.paused_s for burn in burns)
    ways_mm = [*(way for burn in burns for way in burn.travels_mm), *program.homing_mm]
    idle_s = math.fsum(ways_mm) / machine.travel_mm_s
    words_s = cut_s + marked_s + waits_s + idle_s
    if time.model == "blocks" and time.feed_by_blocks is not None:
        by_law_s = words_s - cut_s + cut_s * machine.cut_feed_mm_s / time.feed_by_blocks.mm_s(program.blocks)
        return SummedTime(words_s, by_law_s, by_law_s)
    if time.model == "acceleration":
        a = time.acceleration_mm_s2
        stops_s = waits_s + math.fsum(_to_rest_s(way, machine.travel_mm_s, a) for way in ways_mm)
        stops_s += math.fsum(
            _to_rest_s(move.length_mm, min(feed, math.sqrt(a * move.radius_mm)), a)
            for burn in burns
            for move, feed in zip(burn.path.segments, burn.step_feeds_mm_s, strict=False)
        )
        return SummedTime(words_s, words_s, max(words_s, stops_s))
    return SummedTime(words_s, words_s, words_s)


def wrong_times(program: NcProgram, profile: ProfileValues, planned_s: float | None = None) -> Iterator[str]:
    """A warning where the header's time, or the plan's, is not within 5 % of what the program's words come to."""
    stated = {"the program": stated_time_s(program.comments), "the plan": planned_s}
    if all(said_s is None for said_s in stated.values()):
        return
    found = summed_time(program, profile)
    for who, said_s in stated.items():
        if said_s is None:
            continue
        low = said_s < found.least_s * (1 - SHARE) - _ROUNDED_S
        if low or said_s > found.most_s * (1 + SHARE) + _ROUNDED_S:
            right_s = found.least_s if low else found.most_s
            by = f"feeds, waits and ways come to {found.words_s:.1f} s"
            if right_s != found.words_s:
                by += f", to {right_s:.1f} s {'' if low else 'at the most '}by the time model {profile.time.model}"
            yield f"{who} says that it takes {said_s:.1f} s, which is too {'short' if low else 'long'}: its {by}"


# Begin and end of each cut that a plan states, held against the lengths of its cuts and ways at the profile's feeds.


@dataclass(frozen=True, eq=False)
class CutTimes:
    """How long each cut, and each way, of a plan may take by the lengths that the check finds.

    `shares` are the least and the greatest share of the cut feed in small holes, `blocks` the lines of the program, for
    a law of feeds; it takes `total_s`. Cuts at the positions `unpierced` begin in an older kerf.
    """

    nest: Nest
    cuts: CutSequence
    profile: Technique
    shares: Mapping[str, Shares]
    unpierced: Collection[int]
    blocks: int
    total_s: float

    def wrong(self, runs: Sequence[TorchRun]) -> Iterator[str]:
        """A sentence for each cut, hole and way whose time is not within 5 % of what it comes to."""
        of_cut, begun = {run.position: run for run in runs}, (run for run in runs if not run.position)
        pierced, at, now = self.cuts.pierced, self.cuts.home, 0.0
        leans = {c.id for c in (self.nest.drawn or self.nest).contours if c.bevelled}
        loose = False  # where bevels and blocks of torches end nobody follows here
        for position, cut in self.cuts.new_burns:
            run = of_cut.get(position) if self.cuts.finishes(position, cut) else next(begun, None)
            if cut.torch > 1:
                continue
            for hole in pierced.pop(position, ()):
                yield from self._way(f"the hole of {hole.contour}", hole.start_s - now, math.dist(at, hole.at))
                yield from self._beyond(f"the hole of {hole.contour}", hole.end_s - hole.start_s, *self._stands(True))
                at, now = hole.at, hole.end_s
            name = f"cut {position} of {cut.contour}"
            if not loose:
                yield from self._way(name, cut.start_s - now, 0.0 if cut.linked else math.dist(at, cut.pierce))
            loose = cut.contour in leans
            if run is not None and not loose:
                yield from self._cut(name, cut, run, position not in self.unpierced and cut.pierce in self._in_metal)
            at, now = end_of(self.nest, cut), cut.end_s
        if not loose:
            yield from self._way("the machine's home", self.total_s - now, math.dist(at, self.cuts.home))

    def _stands(self, pierced: bool, marks: bool = False) -> tuple[float, float]:
        """The least and the most that a tool stands before it moves, s."""
        machine = self.profile.machine
        if marks:
            return machine.mark_time_s, machine.mark_time_s
        least_s = machine.pierce_time_s if pierced else min(machine.at_hole_s, machine.unpierced_s)
        return least_s, machine.pierce_time_s if pierced else max(machine.pierce_time_s, machine.unpierced_s)

    def _cut(self, name: str, cut: Cut, run: TorchRun, pierced: bool) -> Iterator[str]:
        machine, time = self.profile.machine, self.profile.time
        feed = machine.mark_feed_mm_s if run.marks else machine.cut_feed_mm_s
        if time.model == "blocks" and time.feed_by_blocks is not None and not run.marks:
            feed = time.feed_by_blocks.mm_s(self.blocks)
        low, high = (1.0, 1.0) if run.marks else self.shares.get(cut.contour, (1.0, 1.0))
        if not run.marks and slow_at_corners(self.profile):
            low *= self.profile.corners.corner_feed
        whole_mm = run.loop.length + math.fsum(lead.length for lead in run.leads)
        most_s = whole_mm / (feed * low)
        if time.model == "acceleration":
            most_s += self._stops_s(cut, feed * low)
        stands = (0.0, 0.0) if cut.linked else self._stands(pierced, run.marks)
        says_s = cut.end_s - cut.start_s
        yield from self._beyond(name, says_s, stands[0] + run.length_mm / (feed * high), stands[1] + most_s)

    @cached_property
    def _in_metal(self) -> set[Point]:
        """Where cuts begin in the metal of the sheet, which they pierce but in older kerfs."""
        if self.profile.cuts.pierce_pass is not None:
            return set()
        inner = shapely.buffer(shapely.make_valid(self.nest.sheet.polygon), -tolerance_mm())
        points = [cut.pierce for _, cut in self.cuts.new_burns]
        return set(compress(points, shapely.contains_xy(inner, np.array(points).reshape(-1, 2)).tolist()))

    @cached_property
    def _longest_dwell_s(self) -> float:
        return longest_dwell_s(self.profile)

    def _stops_s(self, cut: Cut, feed_mm_s: float) -> float:
        """How much longer a cut takes at the most where the torch speeds up and stops on every line and arc."""
        a, half_mm = self.profile.time.acceleration_mm_s2, self.profile.material.kerf_mm / 2
        own = self.nest.contour(cut.contour).curve.segments
        moves = [*own, *(s for lead in (cut.lead_in, cut.lead_out) if lead is not None for s in lead.segments)]
        tops = [(s.length_mm, min(feed_mm_s, math.sqrt(a * max(s.radius_mm - half_mm, half_mm)))) for s in moves]
        tops += [(math.pi * half_mm, min(feed_mm_s, math.sqrt(a * half_mm)))] * len(own)
        return math.fsum(_to_rest_s(mm, top, a) - mm / feed_mm_s for mm, top in tops)

    def _way(self, name: str, says_s: float, way_mm: float) -> Iterator[str]:
        least_s = way_mm / self.profile.machine.travel_mm_s
        most_s = least_s + self._longest_dwell_s
        if self.profile.time.model == "acceleration":
            most_s += self.profile.machine.travel_mm_s / self.profile.time.acceleration_mm_s2 * 2
        yield from self._beyond(f"the way to {name}", says_s, least_s, most_s)

    def _beyond(self, name: str, says_s: float, least_s: float, most_s: float) -> Iterator[str]:
        low = says_s < least_s * (1 - SHARE) - _CUT_ROUNDED_S
        if low or says_s > most_s * (1 + SHARE) + _CUT_ROUNDED_S:
            right = f"{least_s:.1f} s at the least" if low else f"{most_s:.1f} s at the most"
            yield f"the plan says that {name} takes {says_s:.1f} s, and by its length it takes {right}"


def _moving_s(burn: Burn) -> float:
    """How long a tool moves along its lines and arcs at their feeds, s."""
    pairs = zip(burn.path.segments, burn.step_feeds_mm_s, strict=False)
    return math.fsum(move.length_mm / feed for move, feed in pairs)


def _to_rest_s(length_mm: float, top_mm_s: float, acceleration_mm_s2: float) -> float:
    """The time over a length from rest to rest, s.

    Examples
    --------
    >>> round(_to_rest_s(100, 100, 1000), 3), round(_to_rest_s(4, 100, 1000), 4)
    (1.1, 0.1265)
    """
    if length_mm * acceleration_mm_s2 >= top_mm_s**2:
        return length_mm / top_mm_s + top_mm_s / acceleration_mm_s2
    return 2 * math.sqrt(length_mm / acceleration_mm_s2)


def wrong_state(comments: Iterable[str], found: PlanState) -> Iterator[str]:
    """A warning where a program's header says that more of the rules is kept than the check finds.

    Examples
    --------
    >>> list(wrong_state(["STATE KEPT"], PlanState("kept"))), list(wrong_state(["CONTOURS 2"], PlanState("broken")))
    ([], [])
    """
    match = next(filter(None, map(_STATE.fullmatch, comments)), None)
    if match is None:
        return
    count = math.inf if match["state"].upper() == "BROKEN" else int(match["count"] or 0)
    if (math.inf if found.kind == "broken" else found.count) > count:
        yield f"the program says of itself that it is {match['state'].lower()}, and the check finds: {found.words()}"


def with_state(text: str, state: PlanState) -> str:
    r"""A program whose header says this state in the place of the one that it says.

    Examples
    --------
    >>> with_state("(STATE KEPT)\nG21\n", PlanState("broken")), with_state("; STATE BROKEN\n", PlanState("kept"))
    ('(STATE BROKEN)\nG21\n', '; STATE KEPT\n')
    """
    return _STATE_COMMENT.sub(rf"\1STATE {state.short().upper()}", text, count=1)
