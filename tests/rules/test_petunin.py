"""What Petunin 2009 says of his figure 1, by the statements of part-rigidity and by its geometry."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import pytest

from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.cut import Cut, CutSequence, Direction
from kerfwise.encoder.facts import FactOptions, compute_facts
from kerfwise.rules.catalogue.part_rigidity import PartRigidity, PartRigidityOptions
from kerfwise.rules.statements import AtLeast, Before
from kerfwise.tests.rules.petunin import ABC, BEGIN, CBA, FIGURE_1, Answers

RULE, OPTIONS = PartRigidity(), PartRigidityOptions()
WAYS: tuple[Direction, ...] = ("cw", "ccw")


def candidates() -> list[Candidate]:
    """Every point of every part, each way round."""
    return [
        Candidate(k, contour.curve.project(entry)[0], entry, way, entry, None, None, entry, 0.0)
        for k, contour in enumerate(FIGURE_1.contours)
        for entry in BEGIN[contour.part].values()
        for way in WAYS
    ]


FACTS = compute_facts(FIGURE_1, FactOptions(), candidates())
HARD = [s for s in RULE.statements(FACTS, OPTIONS) if s.weight is None]


def named(c: int) -> tuple[str, int, Direction]:
    """Part, point and direction of a candidate."""
    candidate = FACTS.candidates[c]
    part = FIGURE_1.contours[candidate.contour].part
    point = next(number for number, entry in BEGIN[part].items() if entry == candidate.entry)
    return part, point, candidate.direction


def holds(statement: AtLeast, order: Sequence[str]) -> bool:
    at = {FIGURE_1.index[f"{part}.outer"]: k for k, part in enumerate(order)}
    truth = [isinstance(literal, Before) and at[literal.i] < at[literal.j] for literal in statement.literals]
    return sum(w for w, true in zip(statement.weights, truth, strict=True) if true) >= statement.bound


def told_by_statements(order: Sequence[str]) -> Answers:
    found = _none(order)
    broken = {s.when for s in HARD if not holds(s, order)}
    for c in range(len(FACTS.candidates)):
        part, point, way = named(c)
        if c not in broken:
            found[part][point].add(way)
    return found


def told_by_geometry(order: Sequence[str]) -> Answers:
    found = _none(order)
    for part in order:
        for point, entry in BEGIN[part].items():
            for way in WAYS:
                cuts = tuple(
                    Cut(f"{p}.outer", *((entry, way) if p == part else ((0.0, 0.0), "cw")), (0.0, 0.0)) for p in order
                )
                broken = RULE.violations(FIGURE_1, CutSequence(cuts), OPTIONS)
                if f"{part}.outer" not in {v.contours[0] for v in broken}:
                    found[part][point].add(way)
    return found


def _none(order: Sequence[str]) -> dict[str, dict[int, set[Direction]]]:
    return {part: {point: set() for point in BEGIN[part]} for part in order}


@pytest.mark.parametrize(("order", "answers"), [("ABC", ABC), ("CBA", CBA)])
def test_figure_1(order: str, answers: Answers) -> None:
    assert told_by_statements(order) == answers
    assert told_by_geometry(order) == answers


def test_all_one_way_round() -> None:
    """Clockwise throughout 1, 4 and 7 are the points to take; counter-clockwise 4, 7 and 8, or 4, 6 and 8."""
    told = told_by_statements("ABC")
    assert (1, 4, 7) in routes(told, "cw")
    assert {(4, 7, 8), (4, 6, 8)} <= set(routes(told, "ccw"))


def routes(answers: Answers, way: str) -> Iterator[tuple[int, ...]]:
    a, b, c = ([point for point, ways in answers[part].items() if way in ways] for part in "ABC")
    return ((i, j, k) for i in a for j in b for k in c)


def test_other_shares_give_other_answers() -> None:
    """The comparison can fail: with more asked of the end, point 4 is no longer good for both ways."""
    strict = PartRigidityOptions(rigid_min=0.95)
    cuts = CutSequence(tuple(Cut(f"{p}.outer", (110.0, 310.0), "cw", (0.0, 0.0)) for p in "ABC"))
    assert "A.outer" in {v.contours[0] for v in RULE.violations(FIGURE_1, cuts, strict)}
    assert "A.outer" not in {v.contours[0] for v in RULE.violations(FIGURE_1, cuts, OPTIONS)}


def test_candidates_beyond_help_are_told_apart() -> None:
    assert list(RULE.exempt(FACTS, OPTIONS)) == []
    assert {named(s.when)[0] for s in HARD if s.when is not None} == {"A", "B", "C"}
