"""Locked positions of any nest: a plan keeps them and passes the check, whatever level-ahead and hull-before ask."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import kerfwise
from kerfwise import InputError, Lock, Nest, RulesConflict, load_profile
from kerfwise.rule_kit import nest, part, rect
from kerfwise.tests.encoder.facts.random_nests import nests
from kerfwise.tests.tools.amount import examples


@pytest.mark.slow
@given(nest=nests(), data=st.data())
@examples(15)
def test_a_locked_position_is_kept_and_passes_the_check(nest: Nest, data: st.DataObject) -> None:
    assume(len(nest.parts) > 1)
    ids = [c.id for c in nest.contours]
    chosen = data.draw(st.lists(st.sampled_from(ids), min_size=1, max_size=2, unique=True))
    at = data.draw(st.lists(st.integers(1, len(ids)), min_size=len(chosen), max_size=len(chosen), unique=True))
    profile = load_profile()
    locks = tuple(Lock(contour=name, position=place) for name, place in zip(chosen, at, strict=True))
    profile = replace(profile, locks=locks)
    try:
        kerfwise.facts(nest, profile)
    except InputError:
        assume(False)
    try:
        made = kerfwise.solve(nest, profile, work=2)
    except RulesConflict:
        conflict = kerfwise.conflict(nest, profile)
        assert conflict is not None
        firm = {about.rule for about in conflict.clash}
        assert not firm & {"level-ahead", "hull-before"}, "\n".join(conflict.lines())
        return
    assert made.verdict.ok, str(made.verdict)
    assert [made.plan.cuts[place - 1].cut.contour for place in at] == chosen


def test_marks_that_come_first_leave_no_room_either() -> None:
    """Three marks before everything, and the channel locked as cut 4: its guest, first otherwise, has to wait."""
    channel = [(1, 1), (41, 1), (41, 11), (11, 11), (11, 31), (41, 31), (41, 41), (1, 41)]
    marked = [
        part(f"M{k}", rect(361, 1 + 120 * k, 40, 40), (), [[(366, 6 + 120 * k), (391, 21 + 120 * k)]]) for k in range(3)
    ]
    row = nest(480, 360, part("C", channel), part("G", rect(16, 16, 10, 10)), *marked)
    profile = replace(load_profile(), locks=(Lock(contour="C.outer", position=4),))
    made = kerfwise.solve(row, profile, work=2)
    assert made.verdict.ok, str(made.verdict)
    assert [e.violation.contours for j in made.verdict.rules for e in j.excused] == [("G.outer", "C.outer")]
