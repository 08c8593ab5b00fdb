"""Engines are not begun where their tables alone take longer than what is left, but where nothing else finds a plan."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kerfwise.models.engines import cpsat, solution
from kerfwise.models.engines.ideals import Count
from kerfwise.models.engines.portfolio import run_portfolio, swept_at_once
from kerfwise.models.engines.shared_state import Run
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.problem.crossings import Crossings
from kerfwise.tests.models.problems import scattered


class _Begun(Exception):
    """CP-SAT was begun."""


@pytest.fixture(autouse=True)
def _never_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    def begun(*_: object) -> None:
        raise _Begun

    monkeypatch.setattr(cpsat, "solve_cpsat", begun, raising=False)


@pytest.mark.slow
def test_cp_sat_is_not_begun_with_less_than_its_model_takes() -> None:
    many = scattered(1, contours=45, sites=1)
    options = SolveOptions(work=0.2)
    known = run_portfolio(many, options)
    assert known.incumbent is not None
    assert "cp-sat: not begun, its tables alone take longer than what is left for it" in known.notes


@pytest.mark.slow
def test_cp_sat_is_begun_with_more_than_its_model_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solution, "cpsat_s", lambda _: 0.0)
    options = SolveOptions(work=0.2)
    with pytest.raises(_Begun):
        run_portfolio(scattered(1, contours=45, sites=1), options)


def test_cp_sat_that_was_asked_for_is_begun_with_any_work() -> None:
    options = SolveOptions(work=0.001, member="cp-sat")
    with pytest.raises(_Begun):
        run_portfolio(scattered(1, contours=45, sites=1), options)


def test_what_it_takes_grows_with_what_is_made() -> None:
    few, many = scattered(1, contours=8, sites=2), scattered(1, contours=8, sites=4)
    assert solution.cpsat_s(few) < solution.cpsat_s(many)
    crossed = replace(few, crossings=Crossings(*(np.zeros(1000, dtype=np.int64) for _ in range(5))))
    assert solution.cpsat_s(crossed) > solution.cpsat_s(replace(few, crossings=Crossings()))


@pytest.mark.parametrize(("longest", "entries", "at_once"), [(30, 18e6, False), (69, 18e6, True), (69, 28e6, False)])
def test_a_sweep_of_many_contours_may_take_longer_before_any_search(
    longest: int, entries: float, at_once: bool
) -> None:
    run = Run(scattered(1, contours=8, sites=1), SolveOptions(work=30.0))
    run.count = Count(1, longest, 10**6, int(entries), 10**6, 0.0, True)
    assert swept_at_once(run) == at_once
