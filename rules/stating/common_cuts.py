"""Which way round a contour with common edges is open: that depends on which of its neighbours are out."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from kerfwise.rules.statements import About, AtLeast, Before

if TYPE_CHECKING:
    from kerfwise.encoder.candidates.candidate import Candidate
    from kerfwise.encoder.facts.facts import Facts

COMMON = "common-cuts"
"""What these statements come from: no rule, but the profile's `cuts.common`."""


def open_ways(facts: Facts) -> Iterator[AtLeast]:
    """For each candidate of a contour with common edges: its neighbours are out, or still in, as it asks."""
    index, gone = facts.nest.index, {cut.contour for cut in facts.already_cut}
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
    asked = [f"{_listed(candidate.out)} out" if candidate.out else ""]
    asked += [f"{_listed(candidate.still_in)} still in" if candidate.still_in else ""]
    way = "along what is left of it" if candidate.span is not None else "all round"
    return About(COMMON, (name, *neighbours), f"{name} is cut {way} with {' and '.join(filter(None, asked))}")


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(names)
