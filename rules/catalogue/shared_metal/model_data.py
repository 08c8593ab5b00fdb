"""The Python side of `shared_metal.mzn`."""

from __future__ import annotations

import numpy as np
import shapely

from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.tolerances import UM_PER_MM, tolerance_mm
from kerfwise.encoder.minizinc_data import Fields, numbers, numbers_from_1
from kerfwise.rules.catalogue.shared_metal import SharedMetalOptions
from kerfwise.rules.minizinc.twin import Twin, TwinCase

FINE_MM = 0.002
"""Chords lie this close to contours whose gaps are measured."""


class SharedMetalTwin(Twin[SharedMetalOptions]):
    """Contours that are nearer than the kerf."""

    def data(self, case: TwinCase, options: SharedMetalOptions) -> Fields:
        near = same_waste(case.facts, options.kerf_mm)
        return [
            ("n_shared_near", str(len(near))),
            ("shared_one", numbers_from_1(i for i, _, _ in near)),
            ("shared_other", numbers_from_1(j for _, j, _ in near)),
            ("shared_gap_um", numbers(gap_um for _, _, gap_um in near)),
            ("shared_least_um", str(round((options.kerf_mm - tolerance_mm(options.kerf_mm)) * UM_PER_MM))),
        ]


def same_waste(facts: Facts, kerf_mm: float) -> list[tuple[int, int, int]]:
    """Contours of different parts that bound waste towards each other, at most a kerf apart, and the gap, µm.

    A line that the nest gives to two parts stands for both.
    """
    cut = [(k, c) for k, c in enumerate(facts.nest.contours) if c.encloses]
    inside = {(int(i), int(j)) for i, j in facts.contains}
    lines = np.array([shapely.LinearRing(c.curve.flatten(FINE_MM)) for _, c in cut], dtype=object)
    one, other = shapely.STRtree(lines).query(lines, "dwithin", distance=kerf_mm)
    found = []
    for x, y in sorted(zip(one[one < other].tolist(), other[one < other].tolist(), strict=True)):
        (i, a), (j, b) = cut[x], cut[y]
        apart = a.kind == b.kind == "outer" and not {(i, j), (j, i)} & inside
        guest = (a.kind == "hole" and (i, j) in inside) or (b.kind == "hole" and (j, i) in inside)
        if a.part != b.part and (apart or guest):
            found.append((i, j, round(float(shapely.distance(lines[x], lines[y])) * UM_PER_MM)))
    number = facts.nest.index
    return found + [(number[note.contours[1]], number[note.contours[1]], 0) for note in facts.nest.notes if note.common]
