"""Statements made up for tests: facts of a row of parts, what can be said of them, and whether it can all hold."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

from hypothesis import strategies as st

from kerfwise import RulesConflict
from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.facts import compute_facts
from kerfwise.models.plan.conflict.groups import CanClash
from kerfwise.models.problem.compile import make_problem
from kerfwise.rule_kit import (
    About,
    AtLeast,
    Before,
    Contiguous,
    FactOptions,
    Facts,
    Forbid,
    Lag,
    LeadOptions,
    NoGood,
    Pick,
    Precede,
    nest,
    part,
    rect,
)
from kerfwise.tests.models.brute import lawful

RULES = ("level-ahead", "no-islands", "locks", "inner-before-outer")


@cache
def row(parts: int = 4) -> Facts:
    """Parts in a row, two candidates each."""
    plate = nest(60 * parts + 20, 80, *(part(f"P{k}", rect(20 + 60 * k, 20, 40, 40)) for k in range(parts)))
    leads = LeadOptions(entries=2, edge_start=False, directions={"outer": ("cw",), "hole": ("cw",), "mark": ("cw",)})
    facts = compute_facts(plate, FactOptions(), build_candidates(plate, leads))
    assert len(facts.candidates) == 2 * parts
    return facts


def can_hold(facts: Facts, statements: Iterable[CanClash]) -> bool:
    """Whether some order and entries keep all statements, by trying every one."""
    try:
        problem = make_problem(facts, tuple(statements), (0.0, 0.0))
    except RulesConflict:
        return False
    return next(lawful(problem), None) is not None


@st.composite
def statements(draw: st.DrawFn, n: int = 4, most: int = 6) -> list[CanClash]:
    """A few hard statements, each with a sentence of its own; runs do not overlap."""
    made: list[CanClash] = []
    order = draw(st.permutations(range(n)))
    runs = [tuple(order[:2]), tuple(order[2:])]
    for k in range(draw(st.integers(1, most))):
        about = About(draw(st.sampled_from(RULES)), (), f"statement {k}")
        i, j = draw(st.permutations(range(n)))[:2]
        candidate = draw(st.integers(0, 2 * n - 1))
        match draw(st.sampled_from(["precede", "forbid", "at least", "together", "lag", "no-good", "place"])):
            case "place":
                others = [k for k in range(n) if k != i]
                early = draw(st.booleans())
                ends = tuple(Before(k, i) if early else Before(i, k) for k in others)
                made.append(AtLeast(ends, (1,) * (n - 1), draw(st.integers(0, n)), about))
            case "forbid":
                made.append(Forbid(candidate, about))
            case "at least":
                literals = tuple(draw(st.lists(_literals(n), max_size=3)))
                weights = tuple(draw(st.integers(-1, 2)) for _ in literals)
                when = draw(st.one_of(st.none(), st.just(candidate)))
                made.append(AtLeast(literals, weights, draw(st.integers(-1, 3)), about, when))
            case "together" if runs:
                made.append(Contiguous(runs.pop(), about))
            case "lag":
                made.append(Lag(i, j, about, cuts=draw(st.integers(1, 3))))
            case "no-good":
                sets = draw(st.permutations(range(n)))
                made.append(NoGood(frozenset(sets[:2]), frozenset(sets[2:]), about))
            case _:
                made.append(Precede(i, j, about))
    return made


def _literals(n: int) -> st.SearchStrategy[Before | Pick]:
    contour = st.integers(0, n - 1)
    return st.one_of(st.builds(Before, contour, contour), st.builds(Pick, st.integers(0, 2 * n - 1)))
