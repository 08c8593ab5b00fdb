"""Whatever the nest and the options: pierces lie clear in waste, and leads cut into nothing."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import assume, given

from kerfwise.encoder.candidates import Candidate, LeadOptions, build_candidates
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.torch_path import compensated
from kerfwise.rules.case import nest, part, rect
from kerfwise.tests.encoder.candidates.lead_nests import lead_nests, lead_options
from kerfwise.tests.encoder.narrow_shapes import lost_features
from kerfwise.tests.tools.amount import examples

CHORD_MM = 0.001


class Judge:
    """Says what is wrong with candidates, by plain geometry."""

    def __init__(self, plate: Nest, options: LeadOptions) -> None:
        self.plate, self.options = plate, options
        self.lines = {c.id: c.curve.line(CHORD_MM) for c in plate.contours}
        self.areas = {c.id: c.curve.polygon(CHORD_MM) for c in plate.contours}
        self.metal = shapely.union_all(
            [
                self.areas[p.outer.id].difference(shapely.union_all([self.areas[h.id] for h in p.holes]))
                for p in plate.parts
            ]
        )
        self.inner_metal = self.metal.buffer(-0.01)

    def faults(self, candidate: Candidate) -> list[str]:
        found = []
        kind = self.plate.contours[candidate.contour].kind
        name = self.plate.contours[candidate.contour].id
        pierce, sheet = shapely.Point(candidate.pierce), self.plate.sheet.polygon
        if candidate.edge_start:
            if sheet.intersects(pierce) or sheet.distance(pierce) > max(self.options.kerf_mm, 1.0) + 1e-6:
                found.append("an edge start begins just outside the sheet")
        else:
            clearance_mm = max(self.options.pierce_clearance_mm, self.options.kerf_mm / 2) - 1e-3
            if not sheet.contains(pierce) or sheet.exterior.distance(pierce) < clearance_mm:
                found.append("the pierce is too near the edge")
            if min(line.distance(pierce) for line in self.lines.values()) < clearance_mm:
                found.append("the pierce is too near a contour")
        if self.metal.intersects(pierce):
            found.append("the pierce is on a part")
        if self.areas[name].contains(pierce) != (kind == "hole"):
            found.append("the pierce is on the wrong side")
        for lead in (candidate.lead_in, candidate.lead_out):
            assert lead is not None
            path = lead.line(CHORD_MM) if lead.segments else shapely.Point(lead.vertices[0, :2])
            for other, line in self.lines.items():
                wanted_mm = self.options.kerf_mm / 2 - (0.02 if other == name else 1e-3)
                if path.distance(line) < wanted_mm:
                    found.append(f"a lead cuts into {other}")
            if self.inner_metal.intersects(path):
                found.append("a lead runs on a part")
        return found


def joined_up(plate: Nest, options: LeadOptions, candidate: Candidate) -> None:
    """Lead-in and lead-out meet on the compensated path, beside the entry."""
    contour = plate.contours[candidate.contour]
    assert candidate.lead_in is not None
    assert candidate.lead_out is not None
    first, join = candidate.lead_in.vertices[0, :2], candidate.lead_in.vertices[-1, :2]
    assert first == pytest.approx(candidate.pierce)
    assert candidate.lead_out.vertices[0, :2] == pytest.approx(join, abs=1e-6)
    assert candidate.lead_out.vertices[-1, :2] == pytest.approx(candidate.end)
    path = compensated(contour, options.kerf_mm)
    assert path.project(join)[1] < 1e-6
    assert math.dist(join, candidate.entry) == pytest.approx(options.kerf_mm / 2, abs=0.011)
    assert contour.curve.point_at(candidate.entry_mm) == pytest.approx(candidate.entry, abs=1e-6)
    length_mm = path.length_mm + candidate.lead_in.length_mm + candidate.lead_out.length_mm
    assert candidate.cut_mm == pytest.approx(length_mm)


@pytest.mark.slow
@examples(60)
@given(lead_nests(), lead_options())
def test_every_candidate_is_lawful(plate: Nest, options: LeadOptions) -> None:
    try:
        for contour in plate.contours:
            compensated(contour, options.kerf_mm)
    except InputError:
        assume(False)
    assume(not lost_features(plate.contours, options.kerf_mm))
    found = build_candidates(plate, options)
    assert {c.contour for c in found} == set(range(len(plate.contours)))
    per_contour = np.bincount([c.contour for c in found if not c.edge_start])
    assert per_contour.max() <= 2 * options.entries
    judge = Judge(plate, options)
    for candidate in found:
        assert judge.faults(candidate) == []
        joined_up(plate, options, candidate)


def test_the_judge_can_say_no() -> None:
    plate = nest(200, 200, part("A", rect(50, 50, 40, 40)), part("B", rect(93, 50, 40, 40)))
    wide, narrow = LeadOptions(pierce_clearance_mm=1.2, kerf_mm=2.0), LeadOptions(pierce_clearance_mm=0.2, kerf_mm=0.1)
    found = build_candidates(plate, narrow)
    said = {fault for candidate in found for fault in Judge(plate, wide).faults(candidate)}
    assert said == {"the pierce is too near a contour", "a lead cuts into A.outer", "a lead cuts into B.outer"}
