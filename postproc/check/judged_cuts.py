"""Cuts that were judged already: a program is written from a plan, and the rules say of both the same."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from kerfwise.encoder.cut import Cut, CutSequence, Pierce
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.profile import Profile

from .judgement import Judgement
from .relaxed import Relaxed

SAME = 1e-3
"""Millimetres and seconds that two cuts may differ by and be the same: what a program's decimals make of a plan's."""

DRIFT = 1e-7
"""Share of a time that it may be off besides: what the same decimals add up to over thousands of cuts."""

MIDWAY_MM = 3e-3
"""The same of the middle of a lead's arc: programs have a line for an arc that rises less."""


@dataclass(frozen=True, eq=False, slots=True)
class JudgedCuts:
    """The judgements of a profile's rules on cuts, and by what they were judged."""

    nest: Nest
    cuts: CutSequence
    profile: Profile
    relaxed: tuple[Relaxed, ...]
    rules: tuple[Judgement, ...]

    def known(
        self, nest: Nest, cuts: CutSequence, profile: Profile, relaxed: Sequence[Relaxed]
    ) -> tuple[Judgement, ...] | None:
        """The judgements on other cuts, where these are the same; None where they are not, or were measured hot."""
        alike = nest is self.nest and profile == self.profile and tuple(relaxed) == self.relaxed
        return self.rules if alike and same(self.cuts, cuts) else None


def same(one: CutSequence, other: CutSequence) -> bool:
    """Whether two sequences say the same of every cut, rounding aside, and nobody has measured temperatures."""
    measured = (one.hot_spots, other.hot_spots) != (None, None)
    if measured or one.begun or other.begun or (one.start_side, one.made) != (other.start_side, other.made):
        return False
    if len(one) != len(other) or not _near(one.home, other.home) or len(one.pierces) != len(other.pierces):
        return False
    cuts_alike = all(map(_same_cut, one, other)) and _same_times(one, other)
    return cuts_alike and all(map(_same_hole, one.pierces, other.pierces))


def _same_hole(one: Pierce, other: Pierce) -> bool:
    return (one.contour, one.before) == (other.contour, other.before) and _near(one.at, other.at)


def _same_times(one: CutSequence, other: CutSequence) -> bool:
    """Whether each cut takes as long, as long after the one before, and both get to it at the same time."""
    times = np.array([[(cut.start_s, cut.end_s) for cut in cuts] for cuts in (one, other)]).reshape(2, -1)
    off_s = np.abs(np.diff(times, axis=0))
    steps_off_s = np.abs(np.diff(np.diff(times, axis=1), axis=0))
    return bool((off_s <= SAME + DRIFT * np.abs(times[0])).all() and (steps_off_s <= SAME).all())


def _same_cut(one: Cut, other: Cut) -> bool:
    return (
        _words(one) == _words(other)
        and _near(_numbers(one), _numbers(other))
        and _same_lead(one.lead_in, other.lead_in)
        and _same_lead(one.lead_out, other.lead_out)
    )


def _words(cut: Cut) -> tuple[object, ...]:
    return cut.contour, cut.direction, cut.zone, cut.excused, cut.linked, cut.span, cut.tabs, cut.torch, cut.together


def _numbers(cut: Cut) -> list[float]:
    return [*cut.entry, *cut.pierce]


def _same_lead(one: Curve | None, other: Curve | None) -> bool:
    """Two leads by their ends and by how far their arcs stand off; one that goes nowhere is none."""
    first, second = _stretches(one), _stretches(other)
    return len(first) == len(second) and all(
        _near(a[:4], b[:4]) and _near(a[4:], b[4:], MIDWAY_MM) for a, b in zip(first, second, strict=True)
    )


def _stretches(lead: Curve | None) -> list[list[float]]:
    """Ends of every line or arc of a lead, and the point of it that is midway."""
    if lead is None:
        return []
    return [
        [ax, ay, bx, by, (ax + bx + bulge * (by - ay)) / 2, (ay + by - bulge * (bx - ax)) / 2]
        for (ax, ay, bulge), (bx, by, _) in pairwise(lead.vertices.tolist())
        if abs(bx - ax) + abs(by - ay) > SAME
    ]


def _near(one: Sequence[float], other: Sequence[float], by: float = SAME) -> bool:
    return all(abs(a - b) <= by for a, b in zip(one, other, strict=True))
