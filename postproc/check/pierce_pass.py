"""Pierce passes: each cut begins at a hole pierced before, in the pass of its zone, and no hole is left over."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby

import numpy as np
import shapely

from kerfwise.encoder.cut import Cut, CutSequence, Pierce
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.rules.judging.kerf_starts import in_older_kerfs
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import Violation

from .program_rules import tolerance_mm

_RULE = "pierce-pass"


def named(pierces: Sequence[Pierce], cuts: Sequence[Cut]) -> tuple[Pierce, ...]:
    """The holes, each with the contour of the cut after it that begins there; of several the first."""
    told, taken = [], set[int]()
    for pierce, near in zip(pierces, _near([p.at for p in pierces], [cut.pierce for cut in cuts]), strict=True):
        later = (k for k in near if k >= pierce.before - 1 and k not in taken and not cuts[k].linked)
        found = next(later, None)
        taken |= set() if found is None else {found}
        told.append(replace(pierce, contour="" if found is None else cuts[found].contour))
    return tuple(told)


def not_of_a_pass(nest: Nest, cuts: CutSequence, profile: Profile) -> Iterator[Violation]:
    """What is wrong with the passes that the profile asks for: holes missing, left over, late, or in no metal."""
    passes = list(_passes(nest, cuts, profile))
    holes, left = cuts.pierces, dict.fromkeys(range(len(cuts.pierces)))
    at_cut = _near([cut.pierce for cut in cuts], [hole.at for hole in holes])
    for begins, group in passes:
        first = group[0]
        for k in group:
            cut = cuts[k - 1]
            number = next((h for h in at_cut[k - 1] if h in left), None)
            if number is None:
                text = f"cut {k} of {cut.contour} begins at {_at(cut.pierce)}, where no hole was pierced before"
                yield Violation(_RULE, (cut.contour,), text, (k,))
                continue
            del left[number]
            own = holes[number]
            if own.contour not in ("", cut.contour):
                text = f"cut {k} of {cut.contour} begins at the hole at {_at(own.at)}, said to be of {own.contour}"
                yield Violation(_RULE, (cut.contour,), text, (k,))
            if own.before > first:
                text = f"the hole of {cut.contour} (cut {k}) is pierced after cut {first}, the first of its pass"
                yield Violation(_RULE, (cut.contour,), text, (k,))
            elif own.before < begins:
                text = f"the hole of {cut.contour} (cut {k}) is pierced before cut {own.before}, with another zone"
                yield Violation(_RULE, (cut.contour,), text, (k,))
    for hole in (holes[h] for h in left):
        yield Violation(_RULE, (), f"no cut begins at the hole that is pierced at {_at(hole.at)}", (hole.before,))
    yield from _in_no_metal(nest, cuts)


def _passes(nest: Nest, cuts: CutSequence, profile: Profile) -> Iterator[tuple[int, list[int]]]:
    """The first position of each zone, and those of its cuts that begin at holes. Without zones all are of one.

    What is linked, marked, or cuts up the skeleton pierces nothing; nor does what begins off the sheet, or in the kerf
    of an older cut.
    """
    in_kerfs = in_older_kerfs(nest, cuts, profile.material.kerf_mm) if profile.common_options() else ()
    sheet = shapely.buffer(shapely.make_valid(nest.sheet.polygon), -tolerance_mm())
    rows = [(k, cut) for k, cut in enumerate(cuts, 1) if k > cuts.made]
    whole = profile.cuts.pierce_pass == "sheet"
    for _, group in groupby(rows, key=lambda row: 0 if whole else row[1].zone):
        zone = list(group)
        pierced = [
            k
            for k, cut in zone
            if not cut.linked
            and k not in in_kerfs
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


def _near(points: Sequence[Point], others: Sequence[Point]) -> list[list[int]]:
    """For each point the numbers of those others that are at the same place, in order."""
    found: list[list[int]] = [[] for _ in points]
    if points and others:
        tree = shapely.STRtree(shapely.points(np.array(others)))
        rows, near = tree.query(shapely.points(np.array(points)), "dwithin", distance=tolerance_mm())
        for k, other in sorted(zip(rows.tolist(), near.tolist(), strict=True)):
            found[k].append(other)
    return found


def _at(point: tuple[float, float]) -> str:
    return f"({point[0]:z.2f}, {point[1]:z.2f})"
