"""Plans are read back to the byte; a damaged one is refused with the place, and nothing else comes out."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise import InputError, read_plan
from kerfwise.jobs.display import proof_of, summary_lines
from kerfwise.models.plan.plan import Dropped
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile
from kerfwise.tests.tools.amount import examples

PLATE = plate()
TEXT = plan_of(PLATE, good_cuts(PLATE), profile()).to_json()


def damaged(folder: Path, change: Callable[[dict[str, Any]], object]) -> str:
    data = json.loads(TEXT)
    change(data)
    path = folder / "plan.json"
    path.write_text(json.dumps(data, indent=1))
    with pytest.raises(InputError) as error:
        read_plan(path)
    return str(error.value).removeprefix(str(path))


def test_there_and_back(tmp_path: Path) -> None:
    (tmp_path / "plan.json").write_text("\ufeff" + TEXT)
    assert read_plan(tmp_path / "plan.json").to_json() == TEXT


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda d: d["cuts"][2].update(entry=[1]), "cuts 3, entry: a list of 1 given, expected at least 2"),
        (lambda d: d["cuts"][2].update(entry=[1, float("nan")]), 'cuts 3, entry 2: "NaN" given, expected a number'),
        (lambda d: d["cuts"][0].update(pierce=[1e9, 0]), "cuts 1, pierce 1: 1000000000.0 given, expected at most"),
        (lambda d: d["cuts"][0].update(contour=["A"]), 'cuts 1, contour: ["A"] given, expected a text'),
        (lambda d: d["cuts"][0].update(zone=None), "cuts 1, zone: null given, expected a whole number"),
        (lambda d: d["cuts"][0].update(start_s="soon"), 'cuts 1, start_s: "soon" given, expected a number'),
        (lambda d: d["cuts"][0].update(direction="left"), 'cuts 1, direction: "left" given, expected one of cw, ccw'),
        (lambda d: d["cuts"][1].pop("lead_in"), "cuts 2: 'lead_in' missing"),
        (lambda d: d["cuts"][1].update(lead_in=[[0, 0], []]), "cuts 2, lead_in 2: nothing in it"),
        (
            lambda d: d["cuts"][1].update(lead_out=[[0, 0], [9, 0]] * 80),
            "the plan is damaged: its lead_out crosses or touches itself more than 10000 times",
        ),
        (
            lambda d: d["cuts"][1].update(lead_out=[[30, 30, 1e6], [31, 31]]),
            "the plan is damaged: its lead_out is 2221.44 m long: no torch runs so",
        ),
        (lambda d: d["cuts"][1].update(excused=[1]), "cuts 2, excused 1: 1 given, expected a text"),
        (lambda d: d["cuts"][1].update(order=1), "not count 1, 2, 3 …: 2 is missing, and 1 is there 2 times"),
        (lambda d: d["cuts"].pop(0), "the order of its cuts does not count 1, 2, 3 …: 1 is missing"),
        (
            lambda d: d["solve"].update(objective=900.0, bound=1e6, gap=0.0),
            "its bound, 1e+06 mm, is over its objective, 900 mm",
        ),
        (
            lambda d: d["solve"].update(objective=900.0, bound=450.0, gap=0.1),
            "its gap is 0.1, and its objective and bound make 0.5",
        ),
        (lambda d: d.update(cuts={}), "cuts: an object given, expected a list"),
        (lambda d: d.update(nest=[]), "nest: [] given, expected an object"),
        (lambda d: d["totals"].update(cut_mm=None), "totals, cut_mm: null given, expected a number"),
        (lambda d: d["solve"].update(status="good"), 'solve, status: "good" given, expected one of optimal, feasible'),
        (lambda d: d["solve"].update(bound="low"), 'solve, bound: "low" given, expected a number or null'),
        (lambda d: d.update(start_side="up"), 'start_side: "up" given, expected one of left, right, bottom, top'),
    ],
)
def test_what_does_not_fit_is_named_with_its_place(
    change: Callable[[dict[str, Any]], object], said: str, tmp_path: Path
) -> None:
    message = damaged(tmp_path, change)
    assert said in message
    assert "the plan is damaged: " in message


def test_brackets_thousands_deep(tmp_path: Path) -> None:
    (tmp_path / "deep.plan.json").write_text("[" * 100_000)
    with pytest.raises(InputError, match="not a plan: brackets in brackets, thousands deep"):
        read_plan(tmp_path / "deep.plan.json")


def test_the_line_is_told(tmp_path: Path) -> None:
    assert damaged(tmp_path, lambda d: d.update(start_side="up")).startswith(":11:16: the plan is damaged: start_side")


VALUES = st.sampled_from([None, True, -1, 0.5, 1e308, float("nan"), "", "x", [], {}, [1], [[0, 0]], {"a": 1}, 10**30])


@pytest.mark.slow
@examples(300)
@given(st.data())
def test_any_value_in_any_place(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    plan = json.loads(TEXT)
    at: Any = plan
    while isinstance(at, dict | list) and at:
        key = data.draw(st.sampled_from(list(at) if isinstance(at, dict) else list(range(len(at)))))
        if not isinstance(at[key], dict | list) or data.draw(st.integers(0, 4)) == 0:
            at[key] = data.draw(VALUES)
            break
        at = at[key]
    path = tmp_path_factory.getbasetemp() / "any.plan.json"
    path.write_text(json.dumps(plan))
    with contextlib.suppress(InputError):
        read_plan(path).to_json()


@pytest.mark.parametrize(
    ("excuses", "objective", "bound", "gap"),
    [(1, 1_010_000.0, 1_009_000.0, 0.1), (1, 1_010_000.0, 900.0, None), (0, 10_000.0, 9_000.0, None)],
)
def test_a_gap_without_the_weight_of_excuses_is_stated_where_it_says_more(
    excuses: int, objective: float, bound: float, gap: float | None
) -> None:
    made = plan_of(PLATE, good_cuts(PLATE), profile())
    solve = replace(made.solve, objective=objective, bound=bound, gap=(objective - bound) / objective, excuses=excuses)
    stated = json.loads(replace(made, solve=solve).to_json())["solve"]
    assert stated.get("gap_without_excuses") == gap


@pytest.mark.parametrize(
    ("excuses", "bound", "said"),
    [
        (1, 1_009_000.0, "no plan with these zones and entries has fewer excuses; besides, gap 10.00% (bound 9.000 m)"),
        (
            1,
            1_000_000.0,
            "no plan with these zones and entries has fewer excuses; of what it costs besides nothing is proven",
        ),
        (1, 990_000.0, "nothing is proven: plans with fewer excuses are not ruled out"),
        (0, 909_000.0, "gap 10.00% (bound 909.000 m, for these zones and entries)"),
    ],
)
def test_what_is_proven_is_said_of_excuses_and_of_the_rest(excuses: int, bound: float, said: str) -> None:
    made = plan_of(PLATE, good_cuts(PLATE), profile())
    solve = replace(made.solve, objective=1_010_000.0, bound=bound, gap=1 - bound / 1_010_000.0, excuses=excuses)
    assert proof_of(replace(made, solve=replace(solve, status="feasible"))) == said


def test_orders_that_are_dropped_for_one_reason_are_one_line() -> None:
    orders = [Dropped("level-ahead", (f"P{k}.outer", "Q.outer"), "sum: own:rush") for k in range(1, 87)]
    others = [Dropped("hull-before", ("A.outer", "B.outer"), "cycle: …"), Dropped("no-tip-travel", (), "not priced: …")]
    lines = summary_lines(replace(plan_of(PLATE, good_cuts(PLATE), profile()), dropped=(*orders, *others)))
    assert lines[-3:] == [
        "dropped: 86 orders of level-ahead, P1.outer before Q.outer, P2.outer before Q.outer, P3.outer before "
        "Q.outer and 83 more; sum: own:rush",
        "dropped: A.outer before B.outer (hull-before), cycle: …",
        "no-tip-travel, not priced: …",
    ]
