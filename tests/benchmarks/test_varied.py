"""Varied nests: other orders, the same arcs, read as they were written; a cost that is proven is the least."""

from __future__ import annotations

import sys
from itertools import pairwise, permutations
from pathlib import Path

import numpy as np
import pytest

import kerfwise
from kerfwise.benchmarks.varied import as_text, home_of, main, varied
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.routing import Instance, judge_tour, read_instance, solve_instance
from kerfwise.tests.tools.amount import few

NINE = Path(kerfwise.__file__).parent / "examples" / "routing" / "nine.pcglns"


def test_orders_are_removed_halved_and_turned_round() -> None:
    nine = read_instance(NINE)
    home = nine.clusters.index(next(members for members in nine.clusters if nine.start in members))
    own, none, half, turned = (
        {(a, b) for a, b in each.orders.tolist() if a != home} for each in (nine, *varied(nine, 1))
    )
    assert none == set()
    assert half < own
    assert turned == {(b, a) for a, b in own}


def test_what_is_written_is_read_as_it_was_meant(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "nine.pcglns").write_bytes(NINE.read_bytes())
    monkeypatch.setattr(sys, "argv", ["varied", str(tmp_path / "in"), str(tmp_path / "out")])
    main()
    for each in varied(read_instance(NINE), 1):
        read = read_instance(tmp_path / "out" / f"{each.name}.pcglns")
        assert (read.name, read.clusters, read.start, read.closed) == (each.name, each.clusters, each.start, True)
        assert read.orders.tolist() == each.orders.tolist()
        dearest = int(each.cost.max())
        assert np.array_equal(read.cost, np.where(each.cost < 0, dearest, each.cost))


@pytest.mark.slow
@pytest.mark.parametrize("which", few(range(3)))
def test_a_proven_cost_is_the_least_of_all_tours(which: int, tmp_path: Path) -> None:
    path = tmp_path / "each.pcglns"
    path.write_text(as_text(list(varied(read_instance(NINE), 1))[which]), encoding="utf-8")
    instance = read_instance(path)
    answer = solve_instance(instance, SolveOptions(work=1.0))
    assert answer.proven
    assert answer.cost == judge_tour(instance, answer.tour)[0] == least(instance)


def least(instance: Instance) -> int:
    """The cheapest tour: every order of the clusters, the best vertices of each by the shortest way through."""
    home = home_of(instance)
    rest = [k for k in range(len(instance.clusters)) if k != home]
    pairs = [(a, b) for a, b in instance.orders.tolist() if a != home]
    best = np.inf
    for order in permutations(rest):
        place = {k: at for at, k in enumerate(order)}
        if any(place[a] > place[b] for a, b in pairs):
            continue
        reach = instance.cost[instance.start, list(instance.clusters[order[0]])].astype(np.float64)
        for here, there in pairwise(order):
            arcs = instance.cost[np.ix_(instance.clusters[here], instance.clusters[there])]
            reach = (reach[:, None] + arcs).min(axis=0)
        best = min(best, float((reach + instance.cost[list(instance.clusters[order[-1]]), instance.start]).min()))
    return int(best)
