"""The nests that the page is timed with: whole, in an order with times."""

from __future__ import annotations

import pytest

from kerfwise.benchmarks.page import nest_of, plan_of
from kerfwise.postproc.report import draw


def test_made_nests_and_their_order() -> None:
    nest = nest_of(115)
    plan = plan_of(nest)
    assert sorted(p.cut.contour for p in plan.cuts) == sorted(nest.index)
    ends = [p.cut.end_s for p in plan.cuts]
    assert ends == sorted(ends)
    assert plan.totals.time_s == pytest.approx(ends[-1])
    holes = {p.cut.contour: k for k, p in enumerate(plan.cuts)}
    assert all(holes[hole.id] < holes[part.outer.id] for part in nest.parts for hole in part.holes)
    assert draw(nest, plan, ".html").startswith(b"<!DOCTYPE html>")
