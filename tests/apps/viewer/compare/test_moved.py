"""Which cuts differ between two orders of the same contours."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

from hypothesis import given
from hypothesis import strategies as st

from kerfwise.apps.viewer.compare.comparison import _pays
from kerfwise.apps.viewer.compare.differences import cut_pairs, longest_rising
from kerfwise.encoder.cut import Tab
from kerfwise.postproc.check.result import Excused, Judgement
from kerfwise.rule_kit import Cut, CutSequence, Violation


def cut(name: str, x: float = 0.0) -> Cut:
    return Cut(name, (x, 0.0), "ccw", (x, -5.0))


def order(*names: str) -> CutSequence:
    return CutSequence(tuple(map(cut, names)))


def test_one_cut_that_is_made_last_is_all_that_moved() -> None:
    pairs = cut_pairs(order("A", "B", "C", "D"), order("B", "C", "D", "A"))
    assert [(p.contour, p.a, p.b) for p in pairs if p.moved] == [("A", 1, 4)]
    assert [p.contour for p in pairs if not p.same] == ["A"]


def test_entries_directions_and_links_are_told_of_cuts_that_stay() -> None:
    first = order("A", "B", "C", "D")
    a, b, c, d = first
    second = CutSequence((replace(a, entry=(3.0, 4.0)), replace(b, direction="cw"), replace(c, linked=True), d))
    assert [p.told for p in cut_pairs(first, second)] == [
        "entry 5.0 mm away", "other way round", "linked in one only", "",
    ]  # fmt: skip


def test_leads_and_tabs_are_told_of_cuts_with_the_same_entry() -> None:
    first = order("A", "B", "C", "D")
    a, b, c, d = first
    tab = Tab((10.0, 0.0), 0.5)
    second = CutSequence(
        (replace(a, pierce=(0.0, -7.0)), replace(b, tabs=(tab,)), replace(c, tabs=(tab,), pierce=(2.0, -5.0)), d)
    )
    assert [p.told for p in cut_pairs(first, second)] == ["another lead", "other tabs", "another lead, other tabs", ""]
    held = CutSequence((replace(b, tabs=(tab, Tab((90.0, 0.0), 0.5))),))
    turned = CutSequence((replace(b, tabs=(Tab((90.0, 0.0), 0.5), tab)),))
    wider = CutSequence((replace(b, tabs=(tab, Tab((90.0, 0.0), 0.8))),))
    assert [cut_pairs(held, other)[0].told for other in (turned, wider)] == ["", "other tabs"]


def test_a_contour_that_one_side_cuts_twice_is_no_same_cut() -> None:
    pairs = cut_pairs(order("A", "B"), order("A", "B", "A"))
    assert [(p.contour, p.a, p.b, p.told) for p in pairs if not p.same] == [("A", None, 3, "in B only")]


def test_what_only_one_side_cuts() -> None:
    pairs = cut_pairs(order("A", "B"), order("B", "C"))
    assert [(p.contour, p.told) for p in pairs] == [("A", "in A only"), ("B", ""), ("C", "in B only")]


def test_an_entry_that_decimals_moved_is_the_same() -> None:
    assert all(p.same for p in cut_pairs(CutSequence((cut("A", 1.0),)), CutSequence((cut("A", 1.0004),))))


@given(st.permutations(list(range(6))))
def test_no_longer_row_rises(numbers: list[int]) -> None:
    found = longest_rising(numbers)
    rising = [row for k in range(7) for row in combinations(numbers, k) if list(row) == sorted(row)]
    assert tuple(found) in rising
    assert len(found) == max(map(len, rising))


@given(st.permutations([f"C{k}" for k in range(7)]))
def test_cuts_that_did_not_move_follow_each_other_alike(names: list[str]) -> None:
    first, second = order(*sorted(names)), order(*names)
    pairs = cut_pairs(first, second)
    kept = {pair.contour for pair in pairs if not pair.moved}
    assert [n for n in sorted(names) if n in kept] == [n for n in names if n in kept]
    assert [(p.a, p.b) for p in pairs] == [
        (sorted(names).index(p.contour) + 1, names.index(p.contour) + 1) for p in pairs
    ]


def test_what_is_not_kept_is_told_as_what_it_is() -> None:
    """A rule that a planner has relaxed is not one that excuses itself."""
    broken = Violation("level-ahead", ("A.outer", "B.outer"), "A.outer before B.outer")
    unkept = tuple(Excused(broken, "why", how) for how in ("relaxed", "excused", "relaxed"))
    judged = Judgement("level-ahead", "hard", "A part …", excused=unkept)
    assert _pays(judged, None).told == "hard, kept but for 2 relaxed, 1 excused"
