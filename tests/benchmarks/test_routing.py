"""The page of the routing benchmarks."""

from __future__ import annotations

import sys
from dataclasses import replace
from itertools import pairwise, permutations
from pathlib import Path

import numpy as np
import pytest

import kerfwise
from kerfwise.apps.bench.bench import BenchJob, BenchResult, BestKnown
from kerfwise.benchmarks import routing
from kerfwise.benchmarks.routing import Kept, Limits, Run, page, run_set, with_proven
from kerfwise.benchmarks.varied import as_text, home_of, main, varied
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.routing import Instance, judge_tour, read_instance, solve_instance
from kerfwise.tests.tools.amount import few

ROUTING = Path(kerfwise.__file__).parent / "examples" / "routing"


@pytest.mark.slow
def test_a_page_of_two_instances(tmp_path: Path) -> None:
    best = BestKnown({("routing", "nine"): 1169.0, ("routing", "twelve"): 390.0})
    limits = Limits(30.0, 1, (("routing", 1.0),), only=("routing/nine", "*/tw*"), together=True)
    runs = run_set("routing in 1 s", ROUTING, best, 1.0, limits, Kept())
    remarks = tmp_path / "remarks.md"
    remarks.write_text("## Remarks\n\nNone.\n", encoding="utf-8")
    made = tmp_path / "made.md"
    made.write_text("## Made\n\nNone either.\n", encoding="utf-8")
    text = page(runs, limits, [remarks, made])
    assert "| nine | 1169 | 1169 | +0.00% | yes |  |" in text
    assert "| routing in 1 s | twelve | 397 | 390 | +1.79% | yes |" in text, "a best known that is too good is no match"
    assert "2 runs, 2 feasible, 2 proven, at or under best known 1 of 2" in text
    assert "--time-limit 30 --seed 1 --also routing=1 --only routing/nine --only */tw* --together --remarks" in text
    assert " --remarks remarks.md made.md\n" in text
    assert "\n\n## Remarks\n\nNone.\n\n## Made\n\nNone either.\n\n## routing in 1 s\n" in text


def test_a_page_by_work_and_a_proven_cost_for_one_that_is_not_published() -> None:
    short, long = (
        Run(name, result(cost, proven), None) for name, cost, proven in (("1", 12.0, False), ("30", 10.0, True))
    )
    other = Run("30", replace(result(5.0, False), instance="other", bound=4.0), None)
    runs = with_proven([short, long, other])
    assert [run.best for run in runs] == [10.0, 10.0, None]
    text = page(runs, Limits(30.0, 2, by_work=True))
    assert "--work 30 --seed 2\n" in text
    assert "| 1 | one | 12 | 10 | +20.00% |" in text, "it is worse than what the other run proved"
    assert "| other | 5 |  |  | ≥ 4 | +25.0% | 1.0 | 2.0 | 3 |" in text
    assert "at most 25.0% above what is proven" in text


def test_where_results_are_of_several_commits_each_set_says_which() -> None:
    runs = [Run(name, result(1.0, True), None, commit) for name, commit in (("a", "1234"), ("b", "5678"))]
    limits = Limits(1.0, 1, by_work=True)
    assert "\n## a\n\nAt commit 1234.\n\n| instance" in page(runs, limits)
    assert "\n## b\n\nAt commit 5678.\n\n| instance" in page(runs, limits)
    assert "At commit" not in page(runs[:1], limits)


def test_patterns_choose_instances() -> None:
    limits = Limits(1.0, 1, only=("soplib/R.*.1", "cnc/*"))
    named = {name: limits.wanted(Path(name)) for name in ("soplib/R.200.100.1.sop", "cnc/a.pcglns.gz")}
    assert all(named.values())
    assert not any(limits.wanted(Path(name)) for name in ("soplib/R.200.100.15.sop.gz", "tsp/a.sop", "cnc/readme.md"))
    assert Limits(1.0, 1).wanted(Path("tsp/a.sop"))


def result(cost: float, proven: bool) -> BenchResult:
    return BenchResult("one", "portfolio", cost, cost if proven else None, proven, True, 1.0, 3.0, (), processor_s=2.0)


def test_what_is_kept_is_not_run_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    limits, best = Limits(2.0, 1, by_work=True), BestKnown({})
    jobs: list[BenchJob] = []

    def ran(job: BenchJob) -> BenchResult:
        jobs.append(job)
        return result(7.0, True)

    monkeypatch.setattr(routing, "measure", ran)
    first, again = (run_set("two", ROUTING, best, 2.0, limits, Kept(tmp_path / "kept")) for _ in range(2))
    assert len(jobs) == len(first) == 2
    assert first == again
    assert first[0].commit
    run_set("two", ROUTING, best, 3.0, limits, Kept(tmp_path / "kept"))
    assert len(jobs) == 4, "another limit is another run"


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
