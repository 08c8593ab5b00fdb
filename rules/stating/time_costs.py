"""What the way a contour is cut adds to the program's time: a pierce that an edge start saves, and longer leads."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from kerfwise.rules.statements import About, Forbid

if TYPE_CHECKING:
    from kerfwise.encoder.candidates.candidate import Candidate
    from kerfwise.encoder.facts.facts import Facts
    from kerfwise.encoder.nest import Contour
    from kerfwise.rules.profile.profile import Profile

_LEAST_S = 1e-3


def slower_ways(facts: Facts, profile: Profile) -> Iterator[Forbid]:
    """Each candidate that takes longer than the quickest of its contour, at the price of the seconds it adds.

    Together with idle travel this is all of T = L_on / V_on + L_off / V_off + N · t (Tavaeva and Petunin) that a plan
    decides: the contours themselves are cut in any case. At the feeds that are set, whatever the time model.
    """
    if not profile.objective.time:
        return
    seconds = [_seconds(c, facts.nest.contours[c.contour], profile) for c in facts.candidates]
    quickest: dict[int, float] = {}
    for candidate, s in zip(facts.candidates, seconds, strict=True):
        quickest[candidate.contour] = min(s, quickest.get(candidate.contour, s))
    for number, candidate in enumerate(facts.candidates):
        more = seconds[number] - quickest[candidate.contour]
        if more >= _LEAST_S:
            name = facts.nest.contours[candidate.contour].id
            sentence = f"{name} takes {more:.2f} s more to cut this way than the quickest way"
            yield Forbid(number, About("objective", (name,), sentence), more * profile.objective.time)


def _seconds(candidate: Candidate, contour: Contour, profile: Profile) -> float:
    machine = profile.machine
    if contour.kind == "mark":
        return machine.mark_time_s + candidate.cut_mm / machine.mark_feed_mm_s
    feed_mm_s = machine.cut_feed_mm_s * contour.feed_share
    start_s = machine.edge_preheat_s if candidate.edge_start else machine.pierce_time_s
    return start_s + candidate.cut_mm / feed_mm_s
