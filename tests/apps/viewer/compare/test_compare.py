"""kerfwise compare: plans, programs, profiles and rules side by side."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from kerfwise.rule_kit import rect
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.nest_file import nest_file


@pytest.fixture
def sheet() -> Path:
    """Three squares in a row, the middle one with a hole."""
    holes = {1: [rect(160, 40, 40, 40)]}
    rows = [{"id": f"P{k}", "outer": rect(20 + 120 * k, 20, 100, 100), "holes": holes.get(k, [])} for k in range(3)]
    return nest_file("sheet.json", rows)


def solved(sheet: Path, *options: object) -> Path:
    assert kerfwise("solve", sheet, "--work", 1, "-o", "a.nc", "--plan", "a.plan.json", *options).code == 0
    return Path("a.plan.json")


def turned_round(plan: Path) -> Path:
    """The same plan with its first cut made last: no zone, lead or entry is touched."""
    data = json.loads(plan.read_text())
    cuts = [*data["cuts"][1:], data["cuts"][0]]
    data["cuts"] = [cut | {"order": k} for k, cut in enumerate(cuts, 1)]
    Path("b.plan.json").write_text(json.dumps(data))
    return Path("b.plan.json")


def test_a_program_and_its_plan_make_the_same_cuts(sheet: Path) -> None:
    plan = solved(sheet)
    ended = kerfwise("compare", sheet, "a.nc", plan)
    assert ended.code == 0
    assert "A: a.nc (program, profile plasma-carbon-steel)" in ended.out
    assert "4 cuts, none differs" in ended.out
    assert "A: a program states no proof" in ended.out
    assert ended.out.rstrip().endswith("both make the same cuts in the same order")
    data = json.loads(kerfwise("compare", sheet, "a.nc", plan, "--json").out)
    assert data["changed"] == []
    assert data["figures"]["idle_mm"]["a"] == pytest.approx(data["figures"]["idle_mm"]["b"], abs=0.01)
    assert data["figures"]["objective_mm"]["a"] is None


def test_a_plan_in_another_order_says_what_moved_and_which_rules_pay(sheet: Path) -> None:
    plan = solved(sheet)
    other = turned_round(plan)
    first = json.loads(plan.read_text())["cuts"][0]["contour"]
    ended = kerfwise("compare", sheet, plan, other, "--json")
    assert ended.code == 0
    data = json.loads(ended.out)
    assert [(c["contour"], c["position_a"], c["position_b"], c["moved"]) for c in data["changed"]] == [
        (first, 1, 4, True)
    ]
    assert (data["a"]["ok"], data["b"]["ok"]) == (True, False)
    assert data["b"]["broken"]
    rules = {rule["id"]: rule for rule in data["rules"]}
    assert all(rules[name]["b"]["verdict"] == "broken" for name in data["b"]["broken"])
    assert "B: the check refuses it: " in kerfwise("compare", sheet, plan, other).out


def test_without_a_rule_both_are_planned_and_drawn(sheet: Path) -> None:
    solved(sheet)
    ended = kerfwise(
        "compare", sheet, "--work", 1, "--without", "level-ahead", "-o", "both.svg", "-o", "both.html", "-o", "both.png"
    )
    assert ended.code == 0
    assert ended.out.splitlines()[1].startswith("B: without level-ahead (planned now")
    assert ["level-ahead", "hard,", "holds", "off", "changed"] in [line.split() for line in ended.out.splitlines()]
    assert ended.out.rstrip().endswith("written: both.svg, both.html, both.png")
    drawn = ElementTree.fromstring(Path("both.svg").read_text())
    texts = [element.text or "" for element in drawn.iter("{http://www.w3.org/2000/svg}text")]
    assert any(text.startswith("A: by profile") for text in texts)
    assert "B: without level-ahead" in texts
    page = Path("both.html").read_text().partition('id="data">')[2].partition("</script>")[0]
    compared = json.loads(page)["comparison"]
    assert [row[0] for row in compared["rules"]].count("level-ahead") == 1
    assert compared["figures"][0][0] == "torch on"
    assert Path("both.png").read_bytes().startswith(b"\x89PNG")


def test_proven_is_said_of_what_is_proven_only(sheet: Path) -> None:
    plan = solved(sheet)
    out = kerfwise(
        "compare", sheet, "--work", 1, "--with", "hull-before=soft", "--without", "level-ahead", "--json"
    ).out
    data = json.loads(out)
    assert (data["a"]["status"], data["b"]["status"]) == ("optimal", "optimal")
    text = json.loads(plan.read_text())
    text["solve"] |= {"status": "feasible", "bound": None, "gap": None}
    Path("c.plan.json").write_text(json.dumps(text))
    ended = kerfwise("compare", sheet, turned_round(plan), "c.plan.json")
    assert "B: no bound is proven" in ended.out
    assert "B is not proven optimal: the difference is between these two" in ended.out


def test_two_profiles_judge_each_side_by_its_own(sheet: Path) -> None:
    Path("wide.yaml").write_text("name: slow\nbased_on: plasma-carbon-steel\nmachine: {cut_feed: 1000 mm/min}\n")
    plan = solved(sheet)
    ended = kerfwise("compare", sheet, plan, plan, "-p", "plasma-carbon-steel", "-p", "wide.yaml", "--json")
    assert ended.code == 0
    figures = json.loads(ended.out)["figures"]
    assert figures["cut_s"]["b"] > 2 * figures["cut_s"]["a"]
    assert figures["idle_mm"]["a"] == figures["idle_mm"]["b"]
    assert "B: the profile is not the one the plan was made with" in ended.err
    assert len(set(ended.err.splitlines())) == len(ended.err.splitlines()), "nothing is said twice"


def test_a_plan_of_another_nest_is_one_message(sheet: Path) -> None:
    plan = solved(sheet)
    nest_file("other.json", [{"id": "Q", "outer": rect(20, 20, 100, 100)}])
    for made in (plan, Path("a.nc")):
        ended = kerfwise("compare", "other.json", made, made)
        assert ended.code == 2
        (line,) = ended.err.splitlines()
        assert line.startswith(f"kerfwise: {made}: the ")
        assert "another nest" in line


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ([], "nothing to compare"),
        (["a.plan.json", "a.plan.json", "--without", "level-ahead"], "leave B out"),
        (["--without", "level-ahead", "--with", "level-ahead"], "to be on and off"),
        (["--without", "level-ahed"], "--without level-ahed: unknown rule 'level-ahed': did you mean 'level-ahead'?"),
        (["--with", "level-ahead=strong"], "a rule is on as hard or soft"),
        (["-p", "water-jet", "-p", "water-jet", "-p", "water-jet"], "two at the most"),
        (["a.plan.json", "-o", "x.txt"], "a comparison is written as .svg, .png, .html, .pdf"),
        (["a.plan.json", "-o", "a.plan.json"], "is written as"),
        (["gone.nc", "gone.nc"], "gone.nc: cannot read the program"),
    ],
)
def test_what_cannot_be_compared(sheet: Path, options: list[str], said: str) -> None:
    solved(sheet)
    ended = kerfwise("compare", sheet, *options)
    assert (ended.code, said in ended.err) == (2, True), ended.err


def test_heat_and_cost_stand_side_by_side(sheet: Path) -> None:
    Path("priced.yaml").write_text("based_on: plasma-carbon-steel\nprices: {machine_hour: 80, gas_hour: 12}\n")
    plan = solved(sheet)
    ended = kerfwise(
        "compare", sheet, "a.nc", plan, "-p", "plasma-carbon-steel", "-p", "priced.yaml", "--heat", "--json"
    )
    assert ended.code == 0, ended.err
    figures = json.loads(ended.out)["figures"]
    assert figures["peak_c"]["a"] == pytest.approx(figures["peak_c"]["b"], abs=0.5)
    assert figures["cost"]["a"] is None
    parts = sum(figures[f"cost_{name}"]["b"] for name in ("machine", "gas"))
    assert figures["cost"]["b"] == pytest.approx(parts, abs=1e-3)
    assert figures["cost"]["currency"] == "EUR"
    assert "peak_c" not in json.loads(kerfwise("compare", sheet, "a.nc", plan, "--json").out)["figures"]


def test_a_side_without_a_plan_is_named(sheet: Path) -> None:
    locks = "[{contour: P0.outer, before: P1.outer}, {contour: P1.outer, before: P0.outer}]"
    Path("no.yaml").write_text(f"based_on: plasma-carbon-steel\nlocks: {locks}\n")
    ended = kerfwise("compare", sheet, "--work", 1, "-p", "plasma-carbon-steel", "-p", "no.yaml", "-o", "both.svg")
    assert ended.code == 1
    assert "kerfwise: B, by profile no: " in ended.err
    assert not Path("both.svg").exists()
