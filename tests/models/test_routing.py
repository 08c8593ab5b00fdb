"""Routing instances: read, posed as problems, solved, and judged."""

from __future__ import annotations

import gzip
import math
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise, permutations, product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import kerfwise
from kerfwise import InputError
from kerfwise.arrays import Ints
from kerfwise.models import routing
from kerfwise.models.engines import Engine, member_of
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.routing import Instance, judge_tour, read_instance, solve_instance, way_through
from kerfwise.rule_kit import Point
from kerfwise.tests.tools.amount import examples

EXAMPLES = Path(kerfwise.__file__).parent / "examples" / "routing"

PCGLNS = """\
NAME : tiny
TYPE : PCGLNS
DIMENSION : 5
GTSP_SETS : 3
EDGE_WEIGHT_TYPE : EXPLICIT
EDGE_WEIGHT_FORMAT : FULL_MATRIX
EDGE_WEIGHT_SECTION
0 5 9 4 8
5 0 0 -1 -1
9 0 0 -1 -1
4 1 7 0 0
8 6 2 0 0
GTSP_SET_SECTION
1 1 -1
2 2 3 -1
3 4 5 -1
GTSP_SET_ORDERING
3 2 -1
START_GROUP_SECTION
1
EOF
"""
SOP = """\
NAME: four
TYPE: SOP
DIMENSION: 4
EDGE_WEIGHT_TYPE: EXPLICIT
EDGE_WEIGHT_FORMAT: FULL_MATRIX
EDGE_WEIGHT_SECTION
4
0 1 5 1000000
-1 0 -1 3
-1 2 0 4
-1 -1 -1 0
EOF
"""


def written(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.write_text(text)
    return path


def every_tour(instance: Instance) -> list[int]:
    """Costs of all lawful tours, by the judge."""
    home = next(k for k, members in enumerate(instance.clusters) if instance.start in members)
    rest = [members for k, members in enumerate(instance.clusters) if k != home]
    costs = []
    for order in permutations(rest):
        for vertices in product(*order):
            cost, fault = judge_tour(instance, [v + 1 for v in (instance.start, *vertices)])
            if not fault:
                costs.append(cost)
    return costs


def test_generalised_instance(tmp_path: Path) -> None:
    tiny = read_instance(written(tmp_path, "tiny.pcglns", PCGLNS))
    assert tiny.clusters == ((0,), (1, 2), (3, 4))
    assert tiny.orders.tolist() == [[0, 1], [0, 2], [2, 1]]
    assert (tiny.start, tiny.closed, tiny.name) == (0, True, "tiny")
    assert judge_tour(tiny, (1, 4, 2)) == (4 + 1 + 5, "")
    assert judge_tour(tiny, (1, 2, 4))[1] == "cluster 3 must come before cluster 2"
    assert judge_tour(tiny, (4, 1, 2))[1] == "the tour does not begin at vertex 1"
    assert judge_tour(tiny, (1, 2, 3))[1] == "a cluster is not visited once"
    assert judge_tour(tiny, (1, 2, 9))[1] == "there is no such vertex"


def test_sequential_instance(tmp_path: Path) -> None:
    four = read_instance(written(tmp_path, "four.sop", SOP))
    assert four.orders.tolist() == [[0, 1], [0, 2], [0, 3], [1, 3], [2, 1], [2, 3]]
    assert not four.closed
    assert judge_tour(four, (1, 3, 2, 4)) == (5 + 2 + 3, "")
    assert solve_instance(four, SolveOptions(work=0.1)).tour == (1, 3, 2, 4)


def test_gzipped_is_the_same(tmp_path: Path) -> None:
    packed = tmp_path / "four.sop.gz"
    packed.write_bytes(gzip.compress(SOP.encode()))
    assert (read_instance(packed).cost == read_instance(written(tmp_path, "four.sop", SOP)).cost).all()


def test_the_problem_costs_what_the_judge_says(tmp_path: Path) -> None:
    """In the problem the start is home, and an open tour comes home for nothing."""
    tiny = read_instance(written(tmp_path, "tiny.pcglns", PCGLNS))
    assert tiny.problem.before.tolist() == [[False, False], [True, False]]
    for route in ((2, 0), (3, 0), (2, 1), (3, 1)):
        assert judge_tour(tiny, tiny.tour(route)) == (route_cost(tiny.problem, route), "")
    four = read_instance(written(tmp_path, "four.sop", SOP))
    assert route_cost(four.problem, (1, 0, 2)) == 10


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["portfolio", "search", "ideals", "cp-sat-alone"])
def test_every_engine_finds_the_best_of_all_tours(engine: Engine) -> None:
    nine = read_instance(EXAMPLES / "nine.pcglns")
    few = Instance("few", nine.cost, *_part(nine, 6), start=nine.start, closed=True)
    answer = solve_instance(few, SolveOptions(work=0.5, member=member_of(engine)))
    assert answer.cost == min(every_tour(few))
    assert judge_tour(few, answer.tour) == (answer.cost, "")
    assert answer.proven == (engine != "search")


def _part(instance: Instance, count: int) -> tuple[tuple[tuple[int, ...], ...], Ints]:
    """The first clusters alone, with their orders."""
    return instance.clusters[:count], instance.orders[instance.orders.max(axis=1) < count]


def test_a_circle_of_orders_is_found_where_there_is_one() -> None:
    rng = np.random.default_rng(1)
    circles = 0
    for _ in range(200):
        orders = np.unique(rng.integers(0, 7, (rng.integers(1, 12), 2)), axis=0)
        circle = routing._circle(orders, 7)
        sorter = TopologicalSorter({b: set(orders[orders[:, 1] == b, 0].tolist()) for b in range(7)})
        try:
            sorter.prepare()
            assert circle == []
        except CycleError:
            circles += 1
            assert len(circle) > 1
            assert circle[0] == circle[-1]
            assert {*pairwise(circle)} <= {(a, b) for a, b in orders.tolist()}
    assert 20 < circles < 180


def test_a_row_that_lists_too_much_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(routing, "LONGEST_ROW", 30)
    with pytest.raises(InputError, match="section GTSP_SET_ORDERING: a line of 31 characters: at most 30 are read"):
        read_instance(written(tmp_path, "tiny.pcglns", PCGLNS.replace("3 2 -1\nSTART", f"3 2{' 2' * 14}\nSTART")))


def test_orders_that_leave_no_tour_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"the orders contradict each other: [23], [23], [23]$"):
        read_instance(written(tmp_path, "tiny.pcglns", PCGLNS.replace("3 2 -1\nSTART", "3 2 -1\n2 3 -1\nSTART")))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("DIMENSION : 5", "DIMENSION : five", "DIMENSION"),
        ("DIMENSION : 5", "DIMENSION : 6", "6 × 6 weights were expected, 25 are there"),
        ("0 5 9 4 8", "0 5 9 4 x", "whole numbers"),
        ("GTSP_SET_SECTION\n1 1 -1\n2 2 3 -1\n3 4 5 -1\n", "", "GTSP_SET_SECTION is missing"),
        ("3 4 5 -1", "3 4 -1", "every vertex 1 to 5 must be in one set"),
        ("3 2 -1\nSTART", "3 7 -1\nSTART", "names a set that there is not"),
        ("START_GROUP_SECTION\n1", "START_GROUP_SECTION\n2", "the start group has 2 vertices"),
        ("START_GROUP_SECTION\n1", "START_GROUP_SECTION\n9", "the number of one set"),
    ],
)
def test_a_broken_file_is_named_with_its_fault(tmp_path: Path, old: str, new: str, said: str) -> None:
    path = written(tmp_path, "tiny.pcglns", PCGLNS.replace(old, new, 1))
    with pytest.raises(InputError, match=said) as caught:
        read_instance(path)
    assert str(caught.value).startswith(str(path))


def test_what_is_no_instance_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\*.pcglns or \*.sop"):
        read_instance(tmp_path / "nest.json")
    (tmp_path / "four.sop.gz").write_bytes(b"not gzip")
    with pytest.raises(InputError, match="cannot be read"):
        read_instance(tmp_path / "four.sop.gz")


def test_shipped_examples() -> None:
    assert np.diff(read_instance(EXAMPLES / "nine.pcglns").problem.first).tolist() == [3, 2, 3, 2, 3, 2, 3, 2]
    assert read_instance(EXAMPLES / "twelve.sop").problem.n == 11


def test_a_small_file_that_unpacks_to_a_huge_one_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kerfwise.models.routing.MOST_BYTES", 1_000_000)
    bomb = tmp_path / "bomb.sop.gz"
    bomb.write_bytes(gzip.compress(b"0 " * 600_000))
    with pytest.raises(InputError, match=r"bomb\.sop\.gz: holds over 1 MB of text"):
        read_instance(bomb)


def test_a_matrix_is_split_into_words_a_little_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """240 MB of ones in a gzip of half a megabyte took 2.7 GB of memory."""
    lines = ["12 345", "6 7890123", "", " 4\t5 ", "99999999"]
    for at_once in range(1, 30):
        monkeypatch.setattr(routing, "WORDS_AT_ONCE", at_once)
        split = [words for words in routing._words(lines) if words]
        assert [word for words in split for word in words] == " ".join(lines).split()
        assert max(len(words) for words in split) <= at_once + 8
        numbers, so_many = routing._numbers(lines, 3)
        assert (numbers.tolist(), so_many) == ([12, 345, 6], 7)


PLACE = st.tuples(st.integers(0, 60), st.integers(0, 60)).map(lambda at: (float(at[0]), float(at[1])))


def length_mm(points: list[Point], order: list[int], start: Point, end: Point) -> float:
    return sum(math.dist(a, b) for a, b in pairwise([start, *(points[k] for k in order), end]))


@given(points=st.lists(PLACE, max_size=5, unique=True), start=PLACE, end=PLACE)
@examples(25)
def test_it_is_the_shortest(points: list[Point], start: Point, end: Point) -> None:
    order = way_through(points, start, end, SolveOptions(work=0.1))
    assert sorted(order) == list(range(len(points)))
    best = min(length_mm(points, list(other), start, end) for other in permutations(range(len(points))))
    assert length_mm(points, order, start, end) <= best + 0.01


def test_many_points_are_taken_in_strips(monkeypatch: pytest.MonkeyPatch) -> None:
    points = [(float(10 * (k % 6)), float(10 * (k // 6))) for k in range(18)]
    monkeypatch.setattr(routing, "MOST_AT_ONCE", 6)
    order = way_through(points, (60.0, 0.0), (0.0, 0.0), SolveOptions(work=0.1))
    assert sorted(order) == list(range(18))
    columns = [{points[k][0] for k in order[at : at + 6]} for at in (0, 6, 12)]
    assert columns == [{50.0, 40.0}, {30.0, 20.0}, {10.0, 0.0}]
