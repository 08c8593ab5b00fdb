"""The four figures of Pristupov 2016 and the answers of its text."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import kerfwise
from kerfwise import Nest
from kerfwise.rule_kit import Facts
from kerfwise.tests.encoder.facts import pristupov


def facts_of(sheet: Nest, tmp_path: Path) -> Facts:
    """Those of the sheet, cut from the left."""
    profile = tmp_path / "left.yaml"
    profile.write_text("rules: {start-side: {strength: hard, side: left}}\n")
    return kerfwise.facts(sheet, profile)


def pairs(facts: Facts, relation: str) -> set[tuple[str, str]]:
    """The pairs of a relation by contour id."""
    ids = [c.id for c in facts.nest.contours]
    return {(ids[a], ids[b]) for a, b in getattr(facts, relation).tolist()}


def before(facts: Facts) -> set[tuple[str, str]]:
    """All (before, after) that containment, level and hull ask for together."""
    inside_first = {(b, a) for a, b in pairs(facts, "contains")}
    return inside_first | pairs(facts, "level_ahead") | pairs(facts, "in_hull")


def admissible(facts: Facts, cut: tuple[str, ...]) -> set[str]:
    """The uncut contours all of whose predecessors are cut."""
    ids = {c.id for c in facts.nest.contours} - set(cut)
    return ids - {after for first, after in before(facts) if first in ids}


def test_figure_1_nested_contours_have_one_order(tmp_path: Path) -> None:
    facts = facts_of(pristupov.figure_1(), tmp_path)
    order, cut = pristupov.FIGURE_1_ORDER, ()
    for contour in order:
        assert admissible(facts, cut) == {contour}
        cut = (*cut, contour)
    assert {(b, a) for a, b in pairwise(order)} <= pairs(facts, "contains")


def test_figure_2a_the_island_goes_before_the_part_that_closes_the_ring(tmp_path: Path) -> None:
    assert pristupov.FIGURE_2A_FIRST in pairs(facts_of(pristupov.figure_2a(), tmp_path), "level_ahead")


def test_figure_2b_the_island_goes_before_the_part_around_it(tmp_path: Path) -> None:
    assert pairs(facts_of(pristupov.figure_2b(), tmp_path), "in_hull") == {pristupov.FIGURE_2B_FIRST}


def test_figure_3_only_contours_2_and_3_are_admissible(tmp_path: Path) -> None:
    facts = facts_of(pristupov.figure_3(), tmp_path)
    assert admissible(facts, pristupov.FIGURE_3_CUT) == set(pristupov.FIGURE_3_ADMISSIBLE)
    assert {j for j, i in pairs(facts, "level_ahead") if i == "5.outer"} == set(pristupov.FIGURE_3_IN_SHADOW_OF_5)
    assert not pairs(facts, "in_hull")


def test_figure_4_the_massive_part_is_cut_last(tmp_path: Path) -> None:
    facts = facts_of(pristupov.figure_4(), tmp_path)
    assert pairs(facts, "in_hull") == {("1.outer", "3.outer"), ("2.outer", "3.outer")}
    assert admissible(facts, ("1.outer", "2.outer")) == {pristupov.FIGURE_4_LAST}
    assert pristupov.FIGURE_4_LAST not in admissible(facts, ("1.outer",)) | admissible(facts, ("2.outer",))
