"""Which scrap lines bound the largest piece of the skeleton, and which bound one piece together."""

from __future__ import annotations

import json

import numpy as np

from kerfwise.encoder.already_cut import AlreadyCut
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.facts.compute import compute_facts, remaining_facts
from kerfwise.encoder.facts.export import facts_json
from kerfwise.encoder.facts.facts import Column, FactOptions
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import Rows, nest, part, rect
from kerfwise.rules.catalogue.scrap_last.skeleton import skeleton_of
from kerfwise.rules.judging.holding import bounding

A = part("A", rect(400, 50, 100, 100))


def found(*scrap: Rows) -> tuple[list[str], set[tuple[str, str]]]:
    made = nest(1000, 200, A, scrap=scrap)
    framing, pairs = (column.values.tolist() for column in skeleton_of(made, FactOptions()).values())
    ids = [c.id for c in made.contours]
    beside = {(ids[a], ids[b]) for a, b in pairs}
    framed = [name for name, is_framed in zip(ids, framing, strict=True) if is_framed]
    assert bounding(made, 1.5) == (set(framed), beside), "the check measures the same in its own way"
    return framed, beside


def test_without_lines_there_is_nothing() -> None:
    assert found() == ([], set())


def test_lines_to_a_part_bound_the_frame_where_each_leaves_it_whole() -> None:
    """The part's own kerf joins them: left and right of it are two pieces."""
    framed, beside = found([(450, 0), (450, 48.5)], [(450, 151.5), (450, 200)])
    assert framed == ["scrap1", "scrap2"]
    assert beside == {("scrap1", "scrap2"), ("scrap2", "scrap1")}


def test_a_line_that_ends_short_of_the_part_cuts_nothing_off() -> None:
    framed, _ = found([(450, 0), (450, 45)], [(450, 151.5), (450, 200)], [(900, 0), (900, 200)])
    assert framed == ["scrap1", "scrap2", "scrap3"]


def test_a_branch_bounds_no_more_than_the_pieces_at_its_sides() -> None:
    framed, beside = found([(200, 0), (200, 200)], [(0, 100), (200, 100)])
    assert framed == ["scrap1"]
    assert beside == {("scrap1", "scrap2"), ("scrap2", "scrap1")}
    assert found([(200, 0), (200, 200)], [(0, 100), (200.9, 100)]) == (framed, beside)


def test_of_pieces_as_large_the_lowest_and_leftmost_is_the_frame() -> None:
    framed, _ = found([(250, 0), (250, 200)], [(750, 0), (750, 200)])
    made = nest(900, 200, scrap=[[(300, 0), (300, 200)], [(600, 0), (600, 200)]])
    assert framed == ["scrap1", "scrap2"]
    assert skeleton_of(made, FactOptions())["scrap_framed"].values.tolist() == [True, False]


def test_facts_of_one_rule_go_where_its_contours_go() -> None:
    """They are in the text of facts, and have the numbers of what is left after a stop."""
    made = nest(300, 100, *(part(name, rect(10 + 90 * k, 10, 60, 60)) for k, name in enumerate("ABC")))

    def own(drawn: Nest, options: FactOptions) -> dict[str, Column]:
        numbers = np.arange(len(drawn.contours))
        return {"place": Column(numbers), "next": Column(np.column_stack([numbers[:-1], numbers[1:]]), pairs=True)}

    facts = compute_facts(made, FactOptions(columns=(own,)))
    rows = json.loads(facts_json(facts))["contours"]
    assert [(row["place"], row["next"]) for row in rows] == [(0, ["B.outer"]), (1, ["C.outer"]), (2, [])]
    left = remaining_facts(facts, AlreadyCut((Cut("A.outer", (10, 10), "cw", (5, 10)),)))
    assert left.column("place").tolist() == [1, 2]
    assert left.column("next").tolist() == [[0, 1]]
