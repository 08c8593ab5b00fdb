"""Figures 1–4 of Pristupov 2016: the rules give the orders that his text gives."""

from __future__ import annotations

from itertools import permutations

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import cut
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.registry import RULES
from kerfwise.rules.statements import Precede
from kerfwise.rules.stating.state_rules import state_rules
from kerfwise.tests.encoder.facts import pristupov

ORDER_RULES = ("inner-before-outer", "level-ahead", "hull-before")


def admitted(sheet: Nest) -> list[tuple[str, ...]]:
    """All orders that break none of his three rules, started from the left."""
    cuts = [cut(sheet, c.id) for c in sheet.contours]
    return [
        tuple(c.contour for c in order)
        for order in permutations(cuts)
        if not any(
            RULES[rule].violations(sheet, CutSequence(order, "left"), RULES[rule].Options()) for rule in ORDER_RULES
        )
    ]


def test_figure_1_has_one_order_from_the_inside_out() -> None:
    assert admitted(pristupov.figure_1()) == [pristupov.FIGURE_1_ORDER]


def test_figure_2a_leaves_no_island_among_parts() -> None:
    first, then = pristupov.FIGURE_2A_FIRST
    orders = admitted(pristupov.figure_2a())
    assert orders
    assert all(order.index(first) < order.index(then) for order in orders)


def test_figure_2b_leaves_no_island_in_a_hook() -> None:
    sheet = pristupov.figure_2b()
    rule = RULES["hull-before"]
    assert rule.pairs(sheet, CutSequence(()), rule.Options()) == [pristupov.FIGURE_2B_FIRST]
    assert admitted(sheet) == [pristupov.FIGURE_2B_FIRST]


def test_figure_3_after_contour_1_admits_2_and_3_only() -> None:
    orders = [order for order in admitted(pristupov.figure_3()) if order[:1] == pristupov.FIGURE_3_CUT]
    assert {order[1] for order in orders} == set(pristupov.FIGURE_3_ADMISSIBLE)


def test_figure_3_says_why_5_waits_for_3() -> None:
    sheet = pristupov.figure_3()
    profile = Profile("plant")
    stated = state_rules(compute_facts(sheet, profile.fact_options(), ()), profile)
    about = [s.about for s in stated.statements if isinstance(s, Precede) and s.about.contours[1] == "5.outer"]
    assert {a.contours[0] for a in about if a.rule == "level-ahead"} == set(pristupov.FIGURE_3_IN_SHADOW_OF_5)
    assert (
        "3.outer is cut before 5.outer: it lies between 5.outer and the left side, where cutting starts, and would be "
        "left on an island behind the torch"
    ) in {a.sentence for a in about}


def test_figure_4_cuts_the_massive_part_last() -> None:
    orders = admitted(pristupov.figure_4())
    assert orders
    assert {order[-1] for order in orders} == {pristupov.FIGURE_4_LAST}
