"""What it is worth to go on from one contour to the next with the torch on: a pierce and a lead-in less, waste more."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from kerfwise.rules.statements import About, Link

from .time_costs import lead_in_s, price_of_second, start_s

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts
    from kerfwise.rules.profile.profile import Profile

LINKS = "links"
"""What these statements come from: no rule, but the profile's `cuts.links`."""


def link_offers(facts: Facts, profile: Profile) -> Iterator[Link]:
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
