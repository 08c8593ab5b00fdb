"""Pierce passes: each cut begins at a hole pierced before, in the pass of its zone, and no hole is left over."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby

import numpy as np
import shapely

from kerfwise.encoder.cut import Cut, CutSequence, Pierce
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import Violation

from .program_rules import tolerance_mm

_RULE = "pierce-pass"
NEAR_MM = 0.05
"""How far from its hole a cut may begin."""


def named(pierces: Sequence[Pierce], cuts: Sequence[Cut]) -> tuple[Pierce, ...]:
    """The holes, each with the contour of the cut after it that begins there; of several the first."""
    told, taken = [], set[int]()
    for pierce in pierces:
        later = (k for k in range(max(pierce.before - 1, 0), len(cuts)) if k not in taken and not cuts[k].linked)
        found = next((k for k in later if _begins(cuts[k], pierce)), None)
        taken |= set() if found is None else {found}
        told.append(replace(pierce, contour="" if found is None else cuts[found].contour))
    return tuple(told)


def not_of_a_pass(nest: Nest, cuts: CutSequence, profile: Profile) -> Iterator[Violation]:
    """What is wrong with the passes that the profile asks for: holes missing, left over, late, or in no metal."""
    passes = list(_passes(nest, cuts, profile))
    holes = list(cuts.pierces)
    for begins, group in passes:
        first = group[0]
        for k in group:
            cut = cuts[k - 1]
            own = next((hole for hole in holes if _begins(cut, hole)), None)
            if own is None:
                text = f"cut {k} of {cut.contour} begins at {_at(cut.pierce)}, where no hole was pierced before"
                yield Violation(_RULE, (cut.contour,), text, (k,))
                continue
            holes.remove(own)
            if own.before > first:
                text = f"the hole of {cut.contour} (cut {k}) is pierced after cut {first}, the first of its pass"
                yield Violation(_RULE, (cut.contour,), text, (k,))
            elif own.before < begins:
                text = f"the hole of {cut.contour} (cut {k}) is pierced before cut {own.before}, with another zone"
                yield Violation(_RULE, (cut.contour,), text, (k,))
    for hole in holes:
        yield Violation(_RULE, (), f"no cut begins at the hole that is pierced at {_at(hole.at)}", (hole.before,))
    yield from _in_no_metal(nest, cuts)


def _passes(nest: Nest, cuts: CutSequence, profile: Profile) -> Iterator[tuple[int, list[int]]]:
    """The first position of each zone, and those of its cuts that begin at holes. Without zones all are of one.

    What is linked, marked, or cuts up the skeleton pierces nothing; nor does what begins off the sheet.
    """
    sheet = shapely.buffer(shapely.make_valid(nest.sheet.polygon), -tolerance_mm())
    rows = [(k, cut) for k, cut in enumerate(cuts, 1) if k > cuts.made]
    whole = profile.cuts.pierce_pass == "sheet"
    for _, group in groupby(rows, key=lambda row: 0 if whole else row[1].zone):
        zone = list(group)
        pierced = [
            k
            for k, cut in zone
            if not cut.linked
            and (cut.contour not in nest.index or nest.contour(cut.contour).shapes_part)
            and shapely.contains_xy(sheet, *cut.pierce)
        ]
        if pierced:
            yield zone[0][0], pierced


def _in_no_metal(nest: Nest, cuts: CutSequence) -> Iterator[Violation]:
    """Holes that are pierced in a piece that was cut out before: the inside of a contour that is out."""
    if not cuts.pierces:
        return
    rings = [
        (k, contour)
        for k, cut in enumerate(cuts, 1)
        if cut.contour in nest.index and (contour := nest.contour(cut.contour)).encloses
    ]
    points = shapely.points(np.array([hole.at for hole in cuts.pierces]))
    tree = shapely.STRtree([contour.polygon for _, contour in rings])
    for h, r in sorted(zip(*(row.tolist() for row in tree.query(points, "within")), strict=True)):
        hole, (k, contour) = cuts.pierces[h], rings[r]
        if k < hole.before:
            text = f"the hole at {_at(hole.at)} is pierced in {contour.id}, which is cut out as cut {k}"
            yield Violation(_RULE, (contour.id,), text, (k,))


def _begins(cut: Cut, hole: Pierce) -> bool:
    return math.dist(cut.pierce, hole.at) <= max(NEAR_MM, tolerance_mm())


def _at(point: tuple[float, float]) -> str:
    return f"({point[0]:z.2f}, {point[1]:z.2f})"
