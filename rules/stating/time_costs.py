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
    price = price_of_second(profile)
    if not price:
        return
    linked = counts_time(profile)  # then it counts what a pierce takes, each lead, and what is left of an outline
    seconds = [_seconds(c, facts.nest.contours[c.contour], profile) for c in facts.candidates]
    quickest: dict[int, float] = {}
    for candidate, s in zip(facts.candidates, seconds, strict=True):
        bare_s = _seconds(candidate, facts.nest.contours[candidate.contour], profile, bare=True) if linked else s
        quickest[candidate.contour] = min(bare_s, quickest.get(candidate.contour, bare_s))
    than = "the quickest way" if not linked else "its outline alone" if profile.common_options() is None else "at best"
    for number, candidate in enumerate(facts.candidates):
        more = seconds[number] - quickest[candidate.contour]
        if more >= _LEAST_S:
            name = facts.nest.contours[candidate.contour].id
            sentence = f"{name} takes {more:.2f} s more to cut this way than {than}"
            yield Forbid(number, About("objective", (name,), sentence), more * price)


def price_of_second(profile: Profile) -> float:
    """What a second costs beside idle travel, mm: as the profile says; with links or common cuts all time counts.

    It counts as idle travel does, then.

    Examples
    --------
    >>> from kerfwise.rules.profile.load import load_profile
    >>> price_of_second(load_profile())
    0.0
    """
    if not counts_time(profile):
        return profile.objective.time
    return profile.objective.time + profile.objective.idle * profile.machine.travel_mm_s


def counts_time(profile: Profile) -> bool:
    """Whether pierces, leads and lengths of cuts are at stake, so that a plan's cost is its time."""
    return profile.link_options() is not None or profile.common_options() is not None


def start_s(candidate: Candidate, contour: Contour, profile: Profile) -> float:
    """Time until the torch moves."""
    machine = profile.machine
    if contour.kind == "mark":
        return machine.mark_time_s
    return machine.unpierced_s if candidate.unpierced else machine.pierce_time_s


def lead_in_s(candidate: Candidate, contour: Contour, profile: Profile) -> float:
    """Time along the lead-in."""
    return 0.0 if candidate.lead_in is None else candidate.lead_in.length_mm / _feed_mm_s(contour, profile)


def _feed_mm_s(contour: Contour, profile: Profile) -> float:
    machine = profile.machine
    return machine.mark_feed_mm_s if contour.kind == "mark" else machine.cut_feed_mm_s * contour.feed_share


def _seconds(candidate: Candidate, contour: Contour, profile: Profile, bare: bool = False) -> float:
    """Time to cut a contour this way; `bare` without start, leads and overcut."""
    leads_mm = sum(lead.length_mm for lead in (candidate.lead_in, candidate.lead_out) if lead is not None)
    run_mm = candidate.cut_mm
    if candidate.out or candidate.still_in:  # else all ways of a contour have the same corners
        run_mm += candidate.at_corners_mm(contour)
    if bare:
        return (run_mm - leads_mm) / _feed_mm_s(contour, profile)
    return start_s(candidate, contour, profile) + run_mm / _feed_mm_s(contour, profile)
