"""Why parts are held by tabs, in a sentence for each."""

from __future__ import annotations

from kerfwise.encoder.facts.facts import Facts
from kerfwise.rules.profile.profile import Profile


def tabs_because(facts: Facts, profile: Profile) -> dict[str, str]:
    """For every contour with tabs how many hold its part, how wide they are, and why."""
    asked, part_of = profile.tabs(), facts.nest.part_of
    told: dict[str, str] = {}
    for candidate in facts.candidates:
        contour = facts.nest.contours[candidate.contour]
        if candidate.tabs and contour.id not in told:
            tabs = "a tab" if len(candidate.tabs) == 1 else f"{len(candidate.tabs)} tabs"
            why = None if asked is None else asked.reason(part_of[contour.part])
            width = f"{candidate.tabs[0].width_mm:g} mm"
            told[contour.id] = f"{contour.part} is held by {tabs} of {width}: {why or 'the cut was begun so'}"
    return told
