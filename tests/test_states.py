"""A plan is kept, kept but for some places, or broken, and everything that speaks of it says the same."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

import kerfwise
from kerfwise import load_profile, read_plan
from kerfwise.apps.batch.result import row_of
from kerfwise.apps.viewer.compare.comparison import proofs
from kerfwise.apps.viewer.page.page_data import page_data
from kerfwise.apps.work_sheets.work_sheet import facts_of_sheet, work_sheet
from kerfwise.jobs.inputs import Inputs
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan
from kerfwise.rules.plan_state import Place, PlanState
from kerfwise.tests.commands.run_cli import kerfwise as command_line

PLAIN = {"A": (20, 20), "B": (140, 20)}
CLASH = "locks:\n  - {contour: A.outer, before: B.outer}\n  - {contour: B.outer, before: A.outer}\n"


def _written(folder: Path, wide: float, places: dict[str, tuple[float, float]]) -> Path:
    parts = [
        {"id": name, "outer": [[x, y], [x + 80, y], [x + 80, y + 80], [x, y + 80]]} for name, (x, y) in places.items()
    ]
    file = folder / "nest.json"
    sheet = {"width": wide, "height": 120}
    file.write_text(json.dumps({"format": "kerfwise-nest/1", "sheet": sheet, "parts": parts}))
    return file


CASES = {  # what is cut, the profile, further options, and the state in short, in words, and how each place came about
    "kept": (240, PLAIN, "", [], "kept", "ok: every hard rule holds", []),
    "excused": (
        100, {"P": (10, 20)}, "", [],
        "kept but for 1 place", "ok, but 1 place is not kept: 1 excused (part-rigidity: P.outer)", ["excused"],
    ),
    "relaxed": (
        240, PLAIN, CLASH, ["--relax"], "kept but for 2 places",
        "ok, but 2 places are not kept: 1 relaxed (locks: A.outer and B.outer), 1 dropped (level-ahead: A.outer and B",
        ["relaxed", "dropped"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_all_say_the_same(case: str, tmp_path: Path) -> None:
    wide, places, profile, options, short, words, how = CASES[case]
    nest = _written(tmp_path, wide, places)
    (plant := tmp_path / "plant.yaml").write_text(profile or "name: plant\n")
    program, made = tmp_path / "nest.nc", tmp_path / "nest.plan.json"
    of = [nest, "-p", plant]

    solved = command_line("solve", *of, "--work", 1, *options, "-o", program, "--plan", made)
    assert solved.code == 0, solved.err
    last = solved.out.splitlines()[-2]
    assert last.startswith(words)
    for file in (made, program):
        checked = command_line("check", *of, file)
        assert (checked.code, checked.out.splitlines()[-1]) == (0, last)
    assert ("every hard rule holds" in solved.out) == (short == "kept")

    stated = json.loads(made.read_text())["state"]
    assert (stated["kind"], stated["count"]) == (short.partition(" for ")[0] + (" for" if how else ""), len(how))
    assert sorted(place["how"] for place in stated["places"]) == sorted(how)
    assert f"(STATE {short.upper()})" in program.read_text()

    result = kerfwise.solve(nest, plant, work=1, relax=bool(options))
    assert (result.state.words(), result.state.as_json()) == (last, stated)
    assert result.verdict.state == result.plan.state
    assert str(result).splitlines()[-1] == last
    assert result.plan.to_json() == made.read_text()

    given, plan = Inputs(result.nest, result.profile), read_plan(made)
    assert plan.state == result.state
    assert write_program(plan, result.nest, result.profile) == program.read_text()
    (side,) = page_data(given, plan, heat=False, detail="none")["sides"]
    assert (side["ok"], side["state"]["short"], side["state"]["told"]) == (True, short, last)
    assert dict(facts_of_sheet(work_sheet(given, plan, program)))["state"].startswith(f"{short}: ")

    compared = kerfwise.compare(nest, made, made, profile=plant)
    assert compared.as_json()["a"]["state"] == stated
    assert (f"A: {last}" in proofs(compared)) == (short != "kept")

    out = tmp_path / "out"
    batch = command_line("batch", nest, "-p", plant, "-o", out, "--work", 1, *options)
    assert batch.code == 0, batch.err
    (record,) = out.rglob("*.batch.json")
    row = row_of(json.loads(record.read_text()))
    assert row is not None
    assert row.figures is not None
    assert (row.figures.state, len(row.figures.excuses)) == (short, len(how))
    assert (f": {short}" in batch.out) == (short != "kept")
    assert (f">{short}<" in (out / "index.html").read_text()) == (short != "kept")
    assert f",{short}," in (out / "index.csv").read_text()


def test_a_broken_plan_is_never_green(tmp_path: Path) -> None:
    sheet = _written(tmp_path, 240, PLAIN)
    result = kerfwise.solve(sheet, work=1)
    nest, plan = result.nest, result.plan
    turned = replace(plan.cuts[0], cut=replace(plan.cuts[0].cut, direction="ccw"))
    broken = replace(plan, cuts=(turned, *plan.cuts[1:]), rules=())
    found = check_plan(nest, broken, load_profile())
    assert found.state.kind == "broken"
    assert {place.rule for place in found.state.places} == set(found.broken())
    (made := tmp_path / "broken.plan.json").write_text(broken.to_json())
    ended = command_line("check", sheet, made)
    assert ended.code == 1
    assert ended.out.splitlines()[-1].startswith("FAILED: ")
    assert "every hard rule holds" not in ended.out
    (side,) = page_data(Inputs(nest, load_profile()), broken, heat=False, detail="none")["sides"]
    assert (side["ok"], side["state"]["kind"]) == (False, "broken")
    refused = replace(result, verdict=found)
    assert not refused.ok
    assert refused.state.kind == "broken"
    assert "every hard rule holds" not in str(refused)
    with pytest.raises(kerfwise.RulesConflict, match="nothing was written"):
        refused.save(tmp_path / "none")


def test_a_plan_of_before_has_the_state_of_its_rules(tmp_path: Path) -> None:
    result = kerfwise.solve(_written(tmp_path, 100, {"P": (10, 20)}), work=1)
    data = json.loads(result.plan.to_json())
    del data["state"]
    (old := tmp_path / "old.plan.json").write_text(json.dumps(data))
    read = read_plan(old)
    assert read.state is None
    assert read.stated == result.state
    assert "STATE" not in write_program(read, result.nest, result.profile)


def test_many_places_are_counted() -> None:
    places = [Place("dropped", "level-ahead", (f"A{k}", f"B{k}"), "cycle") for k in range(9)]
    state = PlanState.of([*places, Place("excused", "no-islands", ("C",), "thin")])
    assert state.words() == (
        "ok, but 10 places are not kept: 1 excused (no-islands: C), 9 dropped (level-ahead: "
        + "; ".join(f"A{k} and B{k}" for k in range(6))
        + " and 3 more)"
    )
    assert PlanState.of_json(state.as_json()) == state
    assert state.for_operator().startswith("kept but for 10 places: ")


def test_the_operator_is_told_in_words_of_the_shop() -> None:
    place = Place("excused", "part-rigidity", ("P3.outer",), "thin")
    told = [PlanState("kept").for_operator(), PlanState.of([place]).for_operator(), PlanState("broken").for_operator()]
    assert told == [
        "kept: cut it as the program says",
        "kept but for 1 place: metal may move or tip there, stand by when these are cut: P3.outer",
        "broken: do not cut this sheet",
    ]
