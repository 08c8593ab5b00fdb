"""What a move is said to do before it is dropped, against the check: every move of small nests."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from kerfwise.apps.viewer.serve.plan_request import PlanRequest, request_inputs
from kerfwise.apps.viewer.serve.query_worker import Desk
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs.explainer import Explainer, Mover
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.request import options_for
from kerfwise.models.engines.solution import Solution
from kerfwise.models.plan.explain.explain import difference
from kerfwise.models.plan.make_plan import make_plan
from kerfwise.pipeline import plan_nest
from kerfwise.postproc.clock import with_times
from kerfwise.postproc.verdict.check_plan import check_plan
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.statements import EXEMPTION_MM

ROW = nest(
    400, 140, part("A", rect(20, 20, 80, 80), [rect(50, 50, 20, 20)]), part("B", rect(130, 20, 80, 80)),
    part("C", rect(240, 20, 80, 80)), part("D", circle(355, 60, 25)),
)  # fmt: skip
HOOK = nest(
    300, 300, part("U", [[40, 40], [240, 40], [240, 90], [90, 90], [90, 190], [240, 190], [240, 240], [40, 240]]),
    part("I", rect(130, 120, 60, 40)), part("Z", circle(265, 265, 15)), part("M", rect(255, 40, 30, 150)),
)  # fmt: skip


def explainer(plate: Nest, *locks: Lock) -> Explainer:
    profile = load_profile()
    given = Inputs(plate, replace(profile, locks=locks))
    done = plan_nest(given, options_for(plate, given.profile, work=1.0))
    return Explainer(done.given, done.made.plan, done.facts)


def lawful_by_the_check(of: Explainer, candidates: Sequence[int]) -> bool:
    """Whether the check, which knows geometry alone, passes a plan with these cuts in this order."""
    solution = Solution(tuple(candidates), 0.0, None, "feasible", "search", "", 0.0)
    plan = make_plan(of.facts, of.profile, of.stated, solution, "search", 1)
    plan = with_times(plan, of.facts.whole_nest, of.profile)
    verdict = check_plan(of.facts.whole_nest, plan, of.profile)
    return not [name for name in verdict.broken() if name in of.profile.settings()]


@pytest.mark.parametrize("plate", [ROW, HOOK], ids=["row", "hook"])
def test_every_move_is_judged_as_the_check_judges_it(plate: Nest) -> None:
    of = explainer(plate)
    mover, setting = Mover(of), of.setting
    lawful = unlawful = 0
    for name in [contour.id for contour in plate.contours]:
        for place in range(1, len(plate.contours) + 1):
            moved, route = mover.move([name], place)
            if moved.lawful:
                lawful += 1
                assert lawful_by_the_check(of, [int(setting.problem.site_candidate[s]) for s in route]), moved
            else:
                unlawful += 1
                rest = [c for c in setting.candidates if of.facts.candidates[c].contour != plate.index[name]]
                (own,) = set(setting.candidates) - set(rest)
                assert not lawful_by_the_check(of, [*rest[: place - 1], own, *rest[place - 1 :]]), moved
    assert lawful >= len(plate.contours)  # where it is, it may stay
    assert unlawful > 0


def test_a_part_moves_with_all_its_contours() -> None:
    moved, _ = Mover(explainer(HOOK)).move(["I.outer"], 1)
    assert moved.lawful or moved.breaks
    of = explainer(ROW)
    moved, _ = Mover(of).move(["A.outer", "A.hole1"], 3)
    assert moved.contours == ("A.hole1", "A.outer")
    assert moved.breaks[0].rule == "level-ahead"
    assert moved.sentence.startswith(
        "A.hole1 and 1 more cannot be cut as number 3: level-ahead: A.outer is cut before "
    )


def test_where_it_is_it_costs_nothing_and_other_places_more() -> None:
    of = explainer(HOOK)
    mover = Mover(of)
    for place, contour in enumerate(of.setting.order, 1):
        for look in (False, True):
            moved, _ = mover.move([of.setting.name(contour)], place, look=look)
            assert (moved.lawful, moved.more_mm) == (True, pytest.approx(0, abs=1e-3))
    assert of.plan.solve.status == "optimal"
    others = [mover.move([c.id], k)[0].more_mm for c in HOOK.contours for k in range(1, 5)]
    assert all(more is None or more >= -1e-3 for more in others)  # no move betters a plan that is proven


def test_a_lock_that_the_move_takes_the_place_of_does_not_count() -> None:
    lock = Lock(contour="D.outer", position=5)
    of = explainer(ROW, lock)
    mover = Mover(of)
    assert mover.move(["D.outer"], 4)[0].breaks
    rules = {about.rule for about in mover.move(["D.outer"], 4)[0].breaks}
    assert "locks" in rules
    without = {about.rule for about in mover.move(["D.outer"], 4, [lock.because])[0].breaks}
    assert "locks" not in without


def test_orders_leave_room_for_a_place_or_not() -> None:
    """A hole comes before its part whatever the others do; where others only stand in the way, there is room."""
    mover = Mover(explainer(ROW))
    order = [contour.id for contour in ROW.contours]
    room = {(name, place): mover.has_room([name], place) for name in order for place in range(1, len(order) + 1)}
    assert not room["A.outer", 1]
    assert not room["A.hole1", len(order)]
    assert all(mover.has_room([name], place) for name, place in room if mover.move([name], place)[0].lawful)


@pytest.mark.parametrize(("names", "place", "said"), [
    (["Q"], 1, "unknown contour 'Q'"), (["A.outer"], 0, "expected one from 1 to 5"), (["A.outer"], 6, "place 6"),
])  # fmt: skip
def test_what_there_is_not_is_said(names: list[str], place: int, said: str) -> None:
    with pytest.raises(InputError, match=said):
        Mover(explainer(ROW)).move(names, place)


def test_a_move_that_a_hard_rule_does_not_outlive_names_the_rule(tmp_path: Path) -> None:
    """It is lawful, for the rule allows excuses, and dear; it is told in amber, as rules that yield to a lock are."""
    file = tmp_path / "plate.json"
    file.write_text(json.dumps(make_sheet(1, 16)), encoding="utf-8")
    wanted = PlanRequest(str(file))
    given = request_inputs(wanted)
    plan = plan_nest(given, options_for(given.nest, given.profile, work=0.2)).made.plan
    desk, last = Desk(), len(plan.cuts)
    told = {cut.cut.contour: desk.move(wanted, plan.to_json(), [cut.cut.contour], last) for cut in plan.cuts}
    rigid = {name for name, one in told.items() if one["gives_way"] == ["part-rigidity"]}
    assert rigid
    for one in told.values():
        if one["lawful"]:
            assert (one["how"], one["gives_way"] != []) == (
                ("gives way", True) if one["more_mm"] > 1e5 else ("goes", False)
            )
    assert "1 more excuse from hard rules" in told[rigid.pop()]["text"]
    assert difference(round((EXEMPTION_MM + 445.3) * 1000)) == "1 more excuse from hard rules, 445.3 mm more"
    assert difference(round(-2000 * EXEMPTION_MM)) == "2 fewer excuses from hard rules, as long"
