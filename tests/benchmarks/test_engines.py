"""What members bring: leaving one out does, and is undone; what that changes is told."""

from __future__ import annotations

import numpy as np
import pytest

from kerfwise.benchmarks.engines import MEMBERS, NESTS, Row, effect, page, problems, replaced, with_parts, without
from kerfwise.benchmarks.sparse_orders import FAMILIES, Family, by_search, made
from kerfwise.benchmarks.tuning import numbers
from kerfwise.models.engines import portfolio, tuning
from kerfwise.models.engines.search import searcher
from kerfwise.tests.models.engines.test_tuning import TABLE, constants
from kerfwise.tests.models.problems import scattered

WHOLE = Row(1000, 900, True, "search", "flow", ("flows",))


def test_a_member_that_is_left_out_is_back_afterwards() -> None:
    steps, regional = portfolio.STEPS, searcher.regional
    with replaced(MEMBERS["regions"].place, lambda _: MEMBERS["regions"].instead):
        assert searcher.regional is MEMBERS["regions"].instead
    with replaced(MEMBERS["proof"].place, lambda _: MEMBERS["proof"].instead):
        assert MEMBERS["proof"].instead in [step.suits for step in portfolio.STEPS]
    assert searcher.regional is regional
    assert steps == portfolio.STEPS


def test_parts_are_noted_and_what_is_left_out_has_none() -> None:
    many = scattered(1, contours=40, sites=1)
    assert "merging" in with_parts(many, 0.05).part
    assert without("merging", many, 0.05).cost is not None
    assert with_parts(scattered(2, contours=6, sites=2), 0.5).part == ()


def test_what_is_lost_and_what_is_won_is_told() -> None:
    assert effect(WHOLE, WHOLE) == ("", "")
    assert effect(WHOLE, Row(1010, 909, False, "search", "")) == ("cost +1.0%, not proven", "bound +1.0%")
    assert effect(WHOLE, Row(None, 0, False, "", "")) == ("no cost, no bound, not proven", "")


def test_the_page_has_a_line_for_every_member_and_every_problem() -> None:
    text = page({"plate 16, 1": WHOLE, "plate 16, 1|flows": Row(1000, 800, False, "search", "")}, "", 8.0)
    assert all(f"| {name} | " in text for name in MEMBERS)
    assert "plate 16, 1: bound -11.1%, not proven" in text
    assert all(f"nest {name}" in problems(None) for name in NESTS)


def test_the_benchmark_knows_each_number() -> None:
    known = {name for name, _ in numbers()}
    assert known == set(constants(TABLE.read_text(encoding="utf-8")))
    assert all(hasattr(tuning, name) for name in known)


def test_equal_seeds_make_equal_instances_and_others_do_not() -> None:
    family = Family(60, share=0.02)
    one, same, other = made(family, 1), made(family, 1), made(family, 2)
    assert np.array_equal(one.cost, same.cost)
    assert np.array_equal(one.orders, same.orders)
    assert not np.array_equal(one.orders, other.orders)
    assert len({str(each) for each in FAMILIES}) == len(FAMILIES)


def test_pairs_are_as_many_as_asked_for_and_share_no_contour() -> None:
    family = Family(50, pairs=20)
    inner = [(a, b) for a, b in made(family, 3).orders.tolist() if a != 0 and b != 51]
    assert len(inner) == 20
    assert len({contour for order in inner for contour in order}) == 40


@pytest.mark.full
def test_chains_and_annealing_are_both_run() -> None:
    instance = made(Family(60, share=0.01), 1)
    annealed, chained = (by_search(instance, 0.05, chains) for chains in (False, True))
    assert chained < annealed
