"""What a program or its plan states of itself, its time and whether it is kept, held against what the check finds.

The sum of times is made here from what the reader found: lines and arcs at their F words, waits, and ways without torch
at the profile's travel. Nothing of it is shared with the clock that plans and programs are timed with.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from kerfwise.postproc.check.reader.program import Burn, NcProgram
from kerfwise.rules.plan_state import PlanState
from kerfwise.rules.profile.values import ProfileValues

SHARE, _ROUNDED_S = 0.05, 1.0
"""How far apart the times may be: a share of the sum, and the whole second that a header rounds up to."""
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
