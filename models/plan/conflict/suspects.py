"""The groups about what an operator has locked: a few, among which most contradictions of entries and runs lie."""

from __future__ import annotations

from collections.abc import Sequence

from kerfwise.encoder.facts.facts import Facts
from kerfwise.rules.by_kind import by_kind
from kerfwise.rules.registry import RULES
from kerfwise.rules.stating.places import ends_of

from .group import Group, contours_of

LAST = frozenset(name for name, rule in RULES.items() if rule.relaxed_last)
"""Rules that give way only where all others together do not help, such as locks."""


def suspects(facts: Facts, groups: Sequence[Group]) -> list[int]:
    """Numbers of the groups that are about locked contours, and about what is cut in one go with them, only.

    A place is about the contour that it is asked of, and about no other. Empty where nothing is locked.
    """
    contour_of = [c.contour for c in facts.candidates]
    of_contours = [_about(facts, group, contour_of) for group in groups]
    locked = {k for group, of in zip(groups, of_contours, strict=True) if group.about.rule in LAST for k in of}
    runs = [set(s.contours) for s in by_kind(s for group in groups for s in group.statements).contiguous]
    near = locked.union(*(run for run in runs if run & locked))
    return [k for k, of in enumerate(of_contours) if of and of <= near]


def _about(facts: Facts, group: Group, contour_of: Sequence[int]) -> set[int]:
    ends = [ends_of(s, facts.n) for s in by_kind(group.statements).at_least]
    if ends and all(ends):
        return {found[0][0] for found in ends}
    return contours_of(group, contour_of)
