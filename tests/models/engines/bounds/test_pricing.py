"""Costs in narrow numbers: a bound is no higher for it, and what is paid is summed exactly."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from kerfwise.models.engines.bounds import flow_bound, move_costs
from kerfwise.models.engines.bounds.inequalities import Inequalities
from kerfwise.models.engines.bounds.network import Multipliers, kinds, network_of, whole
from kerfwise.models.engines.deadline import Deadline
from kerfwise.tests.models.brute import cheapest
from kerfwise.tests.models.problems import problem, scattered


@pytest.mark.parametrize("seed", range(4))
def test_a_bound_by_narrow_numbers_holds(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    tiny = scattered(seed, contours=5, sites=2, pairs=seed)
    best = cheapest(tiny)
    assert best is not None
    wide = flow_bound(tiny, best, Deadline(5.0)).bound
    monkeypatch.setattr(move_costs, "WIDE", 0)
    assert 0.99 * wide < flow_bound(tiny, best, Deadline(5.0)).bound <= best.cost


def test_narrow_numbers_are_rounded_down(monkeypatch: pytest.MonkeyPatch) -> None:
    tiny = problem([[(20_000.123 + 0.001 * k, 0.0)] for k in range(5)])  # more than 2 ** 24 µm from home
    best = cheapest(tiny)
    assert best is not None
    wide = network_of(tiny, best.route, 10**15, 3000).cost
    monkeypatch.setattr(move_costs, "WIDE", 0)
    narrow = network_of(tiny, best.route, 10**15, 3000).cost
    assert narrow.dtype == np.float32
    assert (narrow.astype(np.float64) <= wide).all()
    assert (narrow.astype(np.float64) < wide).any()


def test_what_is_paid_is_summed_exactly() -> None:
    random = np.random.default_rng(1)
    tail, head = random.random((2, 200, 30)) < 0.5
    asked = Inequalities(tail, head, np.zeros_like(tail), np.ones(200), csr_matrix((200, 0)))
    given = Multipliers(np.zeros(30), random.random(200) * 1e7, asked)
    paid = whole(given, 24).paid
    assert (paid <= given.paid).all()
    assert (paid >= given.paid - 1e9 * 2.0**-20).all()
    narrow = (tail.T * paid.astype(np.float32)) @ head.astype(np.float32)
    assert (narrow == (tail.T * paid) @ head.astype(np.float64)).all()


def test_sites_that_lie_on_the_same_sides_are_of_one_kind() -> None:
    sides = np.random.default_rng(1).random((11, 9)) < 0.5
    sides[:, [3, 7]] = sides[:, [0]]
    first, kind = kinds(sides)
    assert (sides[:, first][:, kind] == sides).all()
    assert kind[0] == kind[3] == kind[7]
    assert len(first) == len({tuple(column) for column in sides.T.tolist()})
    first, kind = kinds(sides[:0])
    assert (len(first), kind.tolist()) == (1, [0] * 9)
