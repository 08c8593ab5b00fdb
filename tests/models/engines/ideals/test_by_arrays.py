"""Layers made by whole arrays, held against the kernels: the same numbers in the same places, layer after layer."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings

from kerfwise.models.engines.ideals import by_arrays, lattice, prove, sets
from kerfwise.models.engines.ideals.stretches.stretch_tables import NARROW
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.tests.models.engines.ideals.chains import chains
from kerfwise.tests.models.problems import problems, scattered


class Both:
    """Stands for `suited`: runs the kernel and its twin by arrays, and asserts that they say the same."""

    def __init__(self) -> None:
        self.swept = 0

    def __call__(self, kernel: Any, steps: float, twin: Any = None, most: float = 0.0) -> Callable[..., Any]:
        return kernel if twin is None else lambda *given: self._run(kernel, twin, given)

    def _run(self, kernel: Any, twin: Any, given: tuple[Any, ...]) -> Any:
        self.swept += kernel is lattice.sweep
        copies = [_copied(one) for one in given]
        other = twin(*copies)
        one = kernel(*given)
        if twin is sets.grow_by_arrays:
            assert int(given[5][1]) == int(copies[5][1])
            _same(*(_made(layer, int(given[5][1])) for layer in (given[3], copies[3])))
        elif one is None:
            _same(*(row[-1 if kernel is lattice.arrange else 2] for row in (given, copies)))
        else:
            assert one == other
        return one


def _copied(given: Any) -> Any:
    """With arrays of its own, as the twin writes to them."""
    fields = getattr(given, "fields", given)
    if isinstance(fields, tuple) and hasattr(fields, "_fields"):
        return type(fields)(*map(_copied, fields))
    return given.copy() if isinstance(given, np.ndarray) else given


def _made(layer: sets.Layer, count: int) -> tuple[Any, ...]:
    return tuple(array[:count] for array in layer[:5]) + tuple(layer[5:])


def _same(one: Any, other: Any) -> None:
    for mine, other_one in zip(getattr(one, "fields", one), other, strict=True):
        np.testing.assert_array_equal(mine, other_one)


def _judged(problem: Problem, known: Incumbent | None = None) -> Incumbent | None:
    """The best route, by kernels that are held against their twins."""
    both = Both()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lattice, "suited", both)
        patch.setattr(sets, "suited", both)
        patch.setattr(lattice, "A_SHARE", math.inf)  # a layer is one span, so that all of it is written
        proof = prove(problem, known, lattice.Deadline(10.0), stages=())
    assert proof is not None
    assert problem.soft_groups or proof.incumbent is None or both.swept >= problem.n  # bans may end it before
    return proof.incumbent


@settings(max_examples=30, deadline=None)
@given(problems())
def test_whatever_a_problem_holds_layers_are_the_same(drawn: Problem) -> None:
    """With conditions, crossings, links and blocks; once again with costs that need wide numbers."""
    tiny = replace(drawn, general=(), lags=tuple(lag for lag in drawn.lags if lag.cuts <= 1 and not lag.seconds))
    for problem in (tiny, replace(tiny, site_cost=tiny.site_cost + NARROW)):
        _judged(problem)


def test_in_blocks_and_with_a_known_plan_they_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(by_arrays, "SWEPT_AT_ONCE", 7)
    problem = scattered(3, 10, 3, pairs=6, blocks=[(2, 3, 4), (7, 8)])
    best = _judged(problem)
    assert best is not None
    again = _judged(problem, Incumbent(best.route, best.cost + 50_000))
    assert again is not None
    assert again.cost == best.cost == route_cost(problem, best.route)


def test_sets_of_more_contours_than_a_word_has_bits_are_the_same() -> None:
    assert _judged(chains(2, 35)) is not None
