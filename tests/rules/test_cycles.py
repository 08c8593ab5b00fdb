"""Which orders lie on cycles, contours that are cut together counting as one."""

from __future__ import annotations

from kerfwise.rules.cycles import components, contracted, excusable, path
from kerfwise.rules.excuses import excused_pairs
from kerfwise.rules.lock import Lock
from kerfwise.rules.option import NoOptions
from kerfwise.rules.profile import Profile
from kerfwise.rules.sections import RuleSetting, default_settings
from kerfwise.tests.nests import nest, part, rect
from kerfwise.tests.rules.case import in_order
from kerfwise.tests.rules.hooks import HOOKS


def test_links_off_the_cycle_are_none() -> None:
    assert components([(0, 1), (1, 2), (2, 0), (2, 3)]) == [[0, 1, 2]]
    assert components([(0, 1), (1, 2)]) == []
    assert components([]) == []


def test_contours_cut_together_are_one_node() -> None:
    # 1 after 0 and before 3, where 0 and 3 belong to one run: no contour can come between them.
    pairs = [(0, 1), (1, 3)]
    assert components(contracted(4, pairs, [])) == []
    assert components(contracted(4, pairs, [(0, 3)])) == [[0, 1]]


def test_runs_that_share_a_contour_are_one_run() -> None:
    assert components(contracted(4, [(0, 1), (1, 3)], [(0, 2), (2, 3)])) == [[0, 1]]


def test_cycle_within_a_run_is_found() -> None:
    assert components(contracted(2, [(0, 1), (1, 0)], [(0, 1)])) == [[0, 1]]


def test_path_is_the_shortest() -> None:
    links = [(0, 1), (1, 2), (2, 3), (0, 3)]
    assert path(links, range(4), 0, 3) == [3]
    assert path(links, range(3), 0, 3) == [0, 1, 2]
    assert path(links, range(4), 3, 0) is None


def test_order_of_a_binding_rule_is_never_excusable() -> None:
    asked = {"inner-before-outer": [("A", "B")], "hull-before": [("B", "A")], "level-ahead": [("A", "B")]}
    assert excusable(asked) == {("B", "A")}


def test_order_off_every_cycle_is_not_excusable() -> None:
    assert excusable({"hull-before": [("A", "B"), ("B", "C")]}) == set()


def test_runs_make_a_cycle_excusable() -> None:
    asked = {"hull-before": [("P.outer", "Q.outer"), ("Q.outer", "P.hole1")]}
    assert excusable(asked) == set()
    assert excusable(asked, [("P.hole1", "P.outer")]) == {("P.outer", "Q.outer"), ("Q.outer", "P.hole1")}


def test_hooks_excuse_each_other() -> None:
    """Each lies in the hull of the other; from the left A is ahead of B besides."""
    cuts = in_order(HOOKS, "A.outer B.outer", "left")
    assert excused_pairs(HOOKS, cuts, Profile("plant")) == {("A.outer", "B.outer"), ("B.outer", "A.outer")}


def test_soft_rules_excuse_nothing() -> None:
    rules = default_settings() | {"hull-before": RuleSetting("soft", 10.0, NoOptions())}
    cuts = in_order(HOOKS, "A.outer B.outer", "left")
    assert excused_pairs(HOOKS, cuts, Profile("plant", rules=rules)) == set()


def test_lock_against_a_rule_excuses_the_rule_only() -> None:
    profile = Profile("plant", locks=(Lock(contour="B.outer", before="A.outer"),))
    cuts = in_order(HOOKS, "B.outer A.outer", "left")
    assert excused_pairs(HOOKS, cuts, profile) == {("A.outer", "B.outer")}


def test_fixed_zones_excuse_a_rule_against_them() -> None:
    row = nest(300, 100, part("A", rect(10, 10, 80, 80)), part("B", rect(110, 10, 80, 80)))
    cuts = in_order(row, "B.outer A.outer", "left", zones={"B": 1, "A": 2})
    assert excused_pairs(row, cuts, Profile("plant")) == {("A.outer", "B.outer")}
