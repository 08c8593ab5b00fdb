"""Candidates that become one site are those that nothing tells apart, looked at one by one."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.simplify import sites_of
from kerfwise.rules.statements import AtLeast, Before, Enough, Link, Literal, Pick
from kerfwise.tests.models.problems import ABOUT

COUNT = 7
NUMBER = st.integers(0, COUNT - 1)
POINT = st.tuples(st.sampled_from([0.0, -0.0, 0.1, 0.1 + 1e-17, 0.3]), st.just(1.5))


def candidates(places: list[tuple[int, Any, Any]]) -> list[Any]:
    ordered = sorted(places, key=lambda place: place[0])
    return [SimpleNamespace(contour=contour, pierce=pierce, end=end) for contour, pierce, end in ordered]


PLACES = st.lists(st.tuples(st.integers(0, 1), POINT, POINT), min_size=COUNT, max_size=COUNT).map(candidates)
CONDITIONS = st.lists(st.builds(lambda c, cost: Condition(0, (1,), (1,), 1, ABOUT, c, cost), NUMBER, st.integers(0, 1)))
LITERAL: st.SearchStrategy[Literal] = st.one_of(st.builds(Pick, NUMBER), st.just(Before(0, 1)))
WITHIN = st.builds(lambda literal: Enough((literal,), (1,), 1), LITERAL)
GENERAL = st.lists(
    st.builds(lambda x, when: AtLeast((x,), (1,), 1, ABOUT, when), LITERAL | WITHIN, st.none() | NUMBER), max_size=2
)
LINKS = st.lists(st.builds(lambda a, b: Link((a,), (b,), ((0, 0), (1, 0)), ABOUT, 1.0), NUMBER, NUMBER), max_size=2)


def picked(literal: Literal) -> set[int]:
    if isinstance(literal, Enough):
        return set().union(*map(picked, literal.literals))
    return {literal.c} if isinstance(literal, Pick) else set()


def one_by_one(
    some: list[Any], allowed: Any, costs: Any, conditions: list[Condition], general: list[AtLeast], links: list[Link]
) -> tuple[list[int], list[int]]:
    site, stands_for, keys = [-1] * len(some), list[int](), list[object]()
    for c, candidate in enumerate(some):
        if allowed[c]:
            key = (
                candidate.contour,
                candidate.pierce,
                candidate.end,
                costs[c],
                [(k.members, k.weights, k.bound, k.cost) for k in conditions if k.when == c],
                [k for k, s in enumerate(general) if s.when == c or c in set().union(*map(picked, s.literals))],
                [(k, c in link.leave, c in link.reach) for k, link in enumerate(links) if c in link.leave + link.reach],
            )
            if key not in keys:
                keys.append(key)
                stands_for.append(c)
            site[c] = keys.index(key)
    return site, stands_for


@given(
    PLACES,
    st.lists(st.booleans(), min_size=COUNT, max_size=COUNT),
    st.lists(st.sampled_from([0, 0, 0, 5]), min_size=COUNT, max_size=COUNT),
    CONDITIONS,
    GENERAL,
    LINKS,
)
def test_sites_are_those_told_apart_one_by_one(
    some: list[Any],
    allowed: list[bool],
    costs: list[int],
    conditions: list[Condition],
    general: list[AtLeast],
    links: list[Link],
) -> None:
    site, stands_for = sites_of(some, np.array(allowed), np.array(costs), conditions, general, links)
    assert (site.tolist(), stands_for.tolist()) == one_by_one(some, allowed, costs, conditions, general, links)


def test_of_no_candidates_there_are_no_sites() -> None:
    site, stands_for = sites_of([], np.zeros(0, dtype=np.bool_), np.zeros(0, dtype=np.int64), [], [])
    assert (len(site), len(stands_for)) == (0, 0)
