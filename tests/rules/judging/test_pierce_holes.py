"""Holes of a pierce pass: leads keep off those of other cuts, and holes off each other, as stated and as judged."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kerfwise.encoder.candidates.older_kerfs import OlderKerfs
from kerfwise.encoder.cut import Cut, CutSequence, Pierce
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.jobs.request import facts_of
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.judging.pierces import leads_over_holes
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.statements import AtLeast, Pick

PLATE = nest(300, 140, part("A", rect(20, 20, 100, 100)), part("B", rect(140, 20, 100, 100)))
LEAD = Curve.of([(130.0, 60.0), (120.75, 60.0)], closed=False)
A = Cut("A.outer", (120.0, 60.0), "cw", (130.0, 60.0), LEAD)


def told(b_at: tuple[float, float], before: int = 1, a_first: bool = True) -> list[str]:
    b = Cut("B.outer", (140.0, 60.0), "cw", b_at, Curve.of([b_at, (139.25, b_at[1])], closed=False))
    holes = (Pierce("A.outer", A.pierce, 1), Pierce("B.outer", b_at, before))
    cuts = CutSequence((A, b) if a_first else (b, A), pierces=holes)
    return [text for _, _, text in leads_over_holes(PLATE, cuts, 1.5, 0.5)]


def test_a_lead_may_not_cross_the_hole_of_another() -> None:
    assert told((133.0, 60.0)) == []
    assert set(told((127.0, 60.3))) == {
        "the lead-in of A.outer (cut 1) crosses the hole pierced for B.outer",
        "the lead-in of B.outer (cut 2) crosses the hole pierced for A.outer",
    }
    assert told((127.0, 60.3), before=2) == ["the lead-in of B.outer (cut 2) crosses the hole pierced for A.outer"]
    assert len(told((127.0, 60.3), a_first=False)) == 2


def test_holes_keep_apart() -> None:
    (text,) = told((131.5, 60.0))
    assert text == "the hole at (131.50, 60.00) is pierced 0.75 mm from another, less than 1.25 mm"
    assert told((132.0, 60.0)) == []


@pytest.fixture(scope="module")
def facts(tmp_path_factory: pytest.TempPathFactory) -> Facts:
    """Facts in which the lead of A's first candidate runs over the pierce of B's first."""
    file = Path(tmp_path_factory.mktemp("plant"), "plant.yaml")
    file.write_text("machine: {pierce_dwell: program}\ncuts: {pierce_pass: zone}\n", encoding="utf-8")
    made = facts_of(PLATE, load_profile(file))
    a, b = (next(k for k, c in enumerate(made.candidates) if c.contour == number) for number in (0, 1))
    lead = made.candidates[a].lead_in
    assert lead is not None
    candidates = list(made.candidates)
    candidates[b] = replace(candidates[b], pierce=lead.point_at(lead.length_mm / 2))
    older = OlderKerfs(np.empty((0, 2), dtype=np.int64), np.array([[a, b]]))
    return replace(made, candidates=tuple(candidates), older_kerfs=older)


@pytest.mark.parametrize(("mode", "zones", "expected"), [("zone", 1, 1), ("sheet", 2, 1), ("zone", 2, 0), (None, 1, 0)])
def test_both_are_not_used_in_one_pass(facts: Facts, mode: str | None, zones: int, expected: int) -> None:
    zone = np.array([1, zones])
    given = replace(facts, zone=zone, options=replace(facts.options, pierce_pass=mode))
    pierce = load_profile().rulebook()["pierce"]
    stated = [s for s in pierce.statements(given, pierce.Options()) if isinstance(s, AtLeast)]
    of_holes = [s for s in stated if s.literals == (Pick(given.older_kerfs.leads[0, 1]),)]
    assert len(of_holes) == expected
    for statement in of_holes:
        assert (statement.when, statement.weights, statement.bound) == (given.older_kerfs.leads[0, 0], (-1,), 0)
