"""Layers made by whole arrays, held against the kernels: the same numbers in the same places, layer after layer."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given

from kerfwise.models.engines.ideals import STAGES, lattice, prove, sets, swept_by_arrays
from kerfwise.models.engines.ideals.stretches import NARROW
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem, SoftGroup
from kerfwise.tests.models.engines.ideals.chains import chains
from kerfwise.tests.models.problems import ABOUT, problems, scattered
from kerfwise.tests.tools.amount import examples

NEW_VALUES, LIVING = 16, 17
"""Which of its arguments a sweep writes to."""


class Both:
    """Stands for `suited`: runs the kernel and its twin by arrays, and asserts that they say the same."""

    def __init__(self) -> None:
        self.calls = 0

    def __call__(self, kernel: Any, steps: float, by_arrays: Any = None, most: float = 0.0) -> Callable[..., Any]:
        return kernel if by_arrays is None else lambda *asked: self._run(kernel, by_arrays, asked)

    def _run(self, kernel: Any, by_arrays: Any, asked: tuple[Any, ...]) -> Any:
        self.calls += 1
        if kernel is not lattice.sweep:
            said = kernel(*asked)
            _same(by_arrays(*asked), said)
            return said
        twin = list(asked)
        twin[NEW_VALUES], twin[LIVING] = asked[NEW_VALUES].copy(), asked[LIVING].copy()
        by_arrays(*twin)
        kernel(*asked)
        _same((twin[NEW_VALUES], twin[LIVING]), (asked[NEW_VALUES], asked[LIVING]))
        return None


def _same(one: tuple[Any, ...], other: tuple[Any, ...]) -> None:
    assert len(one) == len(other)
    for mine, theirs in zip(one, other, strict=True):
        assert np.asarray(mine).dtype == np.asarray(theirs).dtype
        np.testing.assert_array_equal(mine, theirs)


def _judged(asked: Problem, known: Incumbent | None = None, stages: tuple[float, ...] = STAGES) -> Incumbent | None:
    """The best route, by kernels that are held against their twins."""
    judge = Both()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lattice, "suited", judge)
        patch.setattr(sets, "suited", judge)
        patch.setattr(lattice, "A_SHARE", math.inf)  # a layer is one span, so that all of it is written
        proof = prove(asked, known, work=10, stages=stages)
    assert proof is not None
    assert judge.calls >= 4 * len(proof.incumbent.route if proof.incumbent else ())
    return proof.incumbent


@examples(30)
@given(problems())
def test_whatever_a_problem_holds_layers_are_the_same(drawn: Problem) -> None:
    """With conditions, groups, crossings, links and blocks; once again with costs that need wide numbers."""
    tiny = replace(drawn, general=(), lags=tuple(lag for lag in drawn.lags if lag.cuts <= 1 and not lag.seconds))
    for asked in (tiny, replace(tiny, site_cost=tiny.site_cost + NARROW)):
        _judged(asked)


@pytest.mark.parametrize("crossed", [False, True])
def test_with_a_bound_by_walks_they_are_the_same(crossed: bool) -> None:
    """Contours that remember their neighbours, in blocks, with moves that cross and groups that should stay whole."""
    asked = scattered(3, 10, 3, pairs=6, blocks=[(2, 3, 4), (7, 8)])
    if crossed:
        rng = np.random.default_rng(5)
        rows = np.unique(np.column_stack([rng.integers(0, asked.m, (90, 2)), rng.integers(0, asked.n, 90)]), axis=0)
        leave, reach, over = rows.T
        crossings = Crossings(leave, reach, over, np.full(len(rows), 30_000), np.zeros(len(rows), dtype=np.int64))
        asked = replace(asked, crossings=crossings, soft_groups=(SoftGroup((0, 1, 5), 20_000, ABOUT),))
    best = _judged(asked, stages=())
    assert best is not None
    again = _judged(asked, Incumbent(best.route, best.cost + 50_000))
    assert again is not None
    assert again.cost == best.cost == route_cost(asked, best.route)


def test_sets_of_more_contours_than_a_word_has_bits_are_the_same() -> None:
    assert _judged(chains(2, 35)) is not None


def test_states_of_more_additions_than_are_done_together_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(swept_by_arrays, "AT_ONCE", 7)
    assert _judged(scattered(4, 8, 3, pairs=4)) is not None
