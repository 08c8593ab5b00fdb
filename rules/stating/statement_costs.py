"""What statements cost: a rule's price, links, the time that ways to cut add, parts that wait, open common cuts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from kerfwise.rules.statements import About, AtLeast, Before, Forbid, Link, Precede, Statement

if TYPE_CHECKING:
    from kerfwise.encoder.candidates.candidate import Candidate
    from kerfwise.encoder.facts.facts import Facts
    from kerfwise.encoder.nest import Contour, Part
    from kerfwise.rules.profile.technique import Technique


def soften(statements: Iterable[Statement], weight: float) -> Iterator[Statement]:
    """The statements at a price, in their order; what its author wants weighed by itself keeps its own weight.

    Examples
    --------
    >>> from kerfwise.rules.statements import About, Precede
    >>> about = About("r", (), "")
    >>> [s.weight for s in soften([Precede(0, 1, about), Precede(1, 2, about, 5.0)], 25.0)]
    [25.0, 5.0]
    """
    for statement in statements:
        yield statement if statement.weight is not None else replace(statement, weight=weight)


# What it is worth to go on from one contour to the next with the torch on: a pierce and a lead-in less, waste more.

LINKS = "links"
"""What these statements come from: no rule, but the profile's `cuts.links`."""


def link_offers(facts: Facts, profile: Technique) -> Iterator[Link]:
    """Each link of the facts that takes less time than a pierce would, but for those that a lock rules out.

    A link costs its time at the feed of the contour that it leads to, less the pierce and the lead-in that it saves.
    """
    price, machine, law = price_of_second(profile), profile.machine, profile.time.feed_by_blocks
    fastest = machine.cut_feed_mm_s
    if profile.time.model == "blocks" and law is not None:
        fastest = max(fastest, law.fastest_mm_s)  # lags in seconds are kept at the fastest feed, and so at any
    unlinked = {lock.contour for lock in profile.locks if lock.linked is False}
    for link in facts.links:
        first = facts.candidates[link.reach[0]]
        leave = facts.candidates[link.leave[0]]
        contour, before = facts.nest.contours[first.contour], facts.nest.contours[leave.contour]
        if contour.id in unlinked:
            continue
        saved_s = start_s(first, contour, profile) + lead_in_s(first, contour, profile)
        more_s = link.length_mm / (machine.cut_feed_mm_s * contour.feed_share) - saved_s
        idle_mm = max(math.dist(leave.end, facts.candidates[c].pierce) for c in link.reach)
        if more_s < idle_mm / machine.travel_mm_s:
            sentence = f"from {before.id} to {contour.id} the torch may stay on for {link.length_mm:.1f} mm of waste"
            about = About(LINKS, (before.id, contour.id), sentence)
            lead_mm = 0.0 if first.lead_in is None else first.lead_in.length_mm
            burnt_s = (link.length_mm - lead_mm) / (fastest * contour.feed_share)
            seconds = burnt_s - start_s(first, contour, profile)
            yield Link(link.leave, link.reach, link.path, about, more_s * price, seconds)


# What the way a contour is cut adds to the program's time: a pierce that an edge start saves, and longer leads.

_LEAST_S = 1e-3


def slower_ways(facts: Facts, profile: Technique) -> Iterator[Forbid]:
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


def price_of_second(profile: Technique) -> float:
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


def counts_time(profile: Technique) -> bool:
    """Whether pierces, leads and lengths of cuts are at stake, so that a plan's cost is its time."""
    return profile.link_options() is not None or profile.common_options() is not None


def start_s(candidate: Candidate, contour: Contour, profile: Technique) -> float:
    """Time until the torch moves."""
    machine = profile.machine
    if contour.kind == "mark":
        return machine.mark_time_s
    return machine.unpierced_s if candidate.unpierced else machine.pierce_time_s


def lead_in_s(candidate: Candidate, contour: Contour, profile: Technique) -> float:
    """Time along the lead-in."""
    return 0.0 if candidate.lead_in is None else candidate.lead_in.length_mm / _feed_mm_s(contour, profile)


def _feed_mm_s(contour: Contour, profile: Technique) -> float:
    machine = profile.machine
    return machine.mark_feed_mm_s if contour.kind == "mark" else machine.cut_feed_mm_s * contour.feed_share


def _seconds(candidate: Candidate, contour: Contour, profile: Technique, bare: bool = False) -> float:
    """Time to cut a contour this way; `bare` without start, leads and overcut."""
    leads_mm = sum(lead.length_mm for lead in (candidate.lead_in, candidate.lead_out) if lead is not None)
    run_mm = candidate.cut_mm
    if candidate.out or candidate.still_in:  # else all ways of a contour have the same corners
        run_mm += candidate.at_corners_mm(contour)
    if bare:
        return (run_mm - leads_mm) / _feed_mm_s(contour, profile)
    return start_s(candidate, contour, profile) + run_mm / _feed_mm_s(contour, profile)


# What it costs that a part waits: weighted completion, for parts that are due earlier or of a higher priority.

COMPLETION = "objective.completion"
"""What these statements come from: no rule, but the profile's `objective.completion`."""
MOST_PAIRS = 5000
"""From so many pairs on, whole parts are counted in place of their contours."""


def late_parts(facts: Facts, profile: Technique) -> Iterator[Precede]:
    """For each part that others may wait for: what is cut before it is out costs the seconds that it takes.

    The sum over all of them is the weighted completion time, Σ w · C, without leads and travel: w is the price times
    the number of classes of parts that may wait longer, and C counts what was cut before the part is out.
    """
    price = profile.objective.completion
    ranks = classes(facts.nest.parts) if price else {}
    rush = [part for part in facts.nest.parts if ranks.get(part.id)]
    if not rush:
        return
    index = facts.nest.index
    taken = {c.id: _alone_s(c, profile) for c in facts.nest.contours}
    if len(rush) * facts.n > MOST_PAIRS:
        taken = {part.outer.id: sum(taken[c.id] for c in part) for part in facts.nest.parts}
    for part in rush:
        mine, own = part.outer.id, {c.id for c in part}
        for other, seconds in taken.items():
            weight = price * ranks[part.id] * seconds
            if other not in own and weight > 0:
                sentence = f"{mine} waits {seconds:.1f} s for {other}, and parts of its class are wanted sooner"
                yield Precede(index[mine], index[other], About(COMPLETION, (mine, other), sentence), weight)


def classes(parts: Sequence[Part]) -> dict[str, int]:
    """For each part the number of classes that may wait longer: a lower number of `priority` first, then `due`.

    Examples
    --------
    >>> from kerfwise.rules.case import part, rect
    >>> parts = [part(name, rect(0, 0, 9, 9)) for name in "ABC"]
    >>> parts[1].attributes.update(due="2026-12-24")
    >>> classes(parts)
    {'A': 0, 'B': 1, 'C': 0}
    """
    keys = {part.id: _class_of(part) for part in parts}
    order = sorted(set(keys.values()))
    return {name: len(order) - 1 - order.index(key) for name, key in keys.items()}


def _class_of(part: Part) -> tuple[float, str]:
    priority, due = part.attributes.get("priority"), part.attributes.get("due")
    number = isinstance(priority, int | float) and not isinstance(priority, bool)
    return (float(str(priority)) if number else math.inf), (due if isinstance(due, str) else "9999")


def _alone_s(contour: Contour, profile: Technique) -> float:
    """What a contour takes by itself, without leads and travel."""
    start = profile.machine.mark_time_s if contour.kind == "mark" else profile.machine.pierce_time_s
    return start + (contour.curve.length_mm + contour.corner_mm) / _feed_mm_s(contour, profile)


# Which way round a contour with common edges is open: that depends on which of its neighbours are out.

COMMON = "common-cuts"
"""What these statements come from: no rule, but the profile's `cuts.common`."""


STRETCHES = "stretches"
"""What the orders come from that a way along stretches makes: no rule, but the profile's `cuts`."""


def begun_first(facts: Facts) -> Iterator[Precede]:
    """Each way along stretches of contours is cut before what it leaves of them.

    One that holds its part by a last stretch comes before every last stretch of that kind in its zone.
    """
    contours, index = facts.nest.contours, facts.nest.index
    held = [way for way in facts.nest.stretches if way.holds]
    for way in held:
        others = (stretch.contour for one in held if one is not way for stretch in one.along)
        for other in dict.fromkeys(name for name in others if name in index):
            one, last = index[way.id], index[other]
            if facts.zone[one] == facts.zone[last]:
                sentence = f"{way.id} is cut before {other}: last stretches come when all of the zone hang by theirs"
                yield Precede(one, last, About(STRETCHES, (contours[one].id, other), sentence))
    for way in facts.nest.stretches:
        for name in dict.fromkeys(stretch.contour for stretch in way.along):
            if name in facts.nest.index:
                sentence = f"{way.id} is cut before {name}: it begins {name}, which is cut along what is left"
                number = facts.nest.index[way.id]
                yield Precede(number, facts.nest.index[name], About(STRETCHES, (way.id, name), sentence))


def open_ways(facts: Facts) -> Iterator[AtLeast]:
    """For each candidate of a contour with common edges: its neighbours are out, or still in, as it asks.

    Ways along stretches of it always are, see `begun_first`.
    """
    index, gone = facts.nest.index, {cut.contour for cut in facts.already_cut}
    gone |= {way.id for way in facts.nest.stretches}
    gone |= set() if facts.past is None else {cut.way for _, cut in facts.past.already.begun}
    for number, candidate in enumerate(facts.candidates):
        if not candidate.out and not candidate.still_in:
            continue
        contour = candidate.contour
        before = [index[name] for name in candidate.out if name not in gone]
        after = [index[name] for name in candidate.still_in if name not in gone]
        literals = (*(Before(k, contour) for k in before), *(Before(contour, k) for k in after))
        never = any(name in gone for name in candidate.still_in)
        bound = len(literals) + never
        if bound:
            about = _about(facts.nest.contours[contour].id, candidate)
            yield AtLeast(literals, (1,) * len(literals), bound, about, when=number)


def _about(name: str, candidate: Candidate) -> About:
    neighbours = (*candidate.out, *candidate.still_in)
    phrases = [f"{_listed(candidate.out)} out" if candidate.out else ""]
    phrases += [f"{_listed(candidate.still_in)} still in" if candidate.still_in else ""]
    way = "along what is left of it" if candidate.span is not None else "all round"
    return About(COMMON, (name, *neighbours), f"{name} is cut {way} with {' and '.join(filter(None, phrases))}")


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(names)
