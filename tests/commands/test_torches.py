"""Several torches by the command line: plans, programs, damaged ones, and what is refused."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from kerfwise import load_profile, read_nest, read_plan
from kerfwise.tests.commands.run_cli import Ended, kerfwise
from kerfwise.tests.metal.plant import plant
from kerfwise.tests.metal.simulate import by_kind, simulate
from kerfwise.tests.tools import canon
from kerfwise.tests.tools.amount import full

STEP = 150


def box(x: float, y: float, wide: float, high: float) -> list[list[float]]:
    return [[x, y], [x + wide, y], [x + wide, y + high], [x, y + high]]


def part(name: str, x: float, y: float, hole: bool = False) -> dict[str, Any]:
    return {"id": name, "outer": box(x, y, 100, 80), "holes": [box(x + 35, y + 25, 30, 30)] if hole else []}


COPIES = [
    part("A", 20, 20, hole=True),
    part("B", 140, 20),
    part("C", 20, 20 + STEP, hole=True),
    part("D", 140, 20 + STEP),
]
SINGLE = {"id": "S", "outer": box(260, 20, 60, 60)}


def nest_file(folder: Path, parts: list[dict[str, Any]] | None = None, **more: Any) -> Path:
    parts = [*COPIES, SINGLE] if parts is None else parts
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": 360, "height": 280}, "parts": parts, **more}
    (folder / "nest.json").write_text(json.dumps(nest), encoding="utf-8")
    return folder / "nest.json"


def plant_file(
    folder: Path, count: int = 2, spacing: float = STEP, axis: str = "y", text: str = "", dialect: str = "linuxcnc"
) -> Path:
    torches = f"torches: {{count: {count}, spacing: {spacing} mm, axis: {axis}}}"
    machine = f"machine: {{dialect: {dialect}, {torches}}}"
    (folder / "plant.yaml").write_text(f"based_on: plasma-carbon-steel\n{machine}\n{text}", encoding="utf-8")
    return folder / "plant.yaml"


def solve(nest: Path, *words: object) -> Ended:
    folder = nest.parent
    files = ("-o", folder / "nest.nc", "--plan", folder / "nest.plan.json")
    return kerfwise("solve", nest, "-p", folder / "plant.yaml", *files, "--work", "1", *words)


def check(folder: Path, made: str = "nest.nc") -> Ended:
    return kerfwise("check", folder / "nest.json", folder / made, "-p", folder / "plant.yaml")


def planned(folder: Path, parts: list[dict[str, Any]] | None = None, **profile: Any) -> tuple[dict[str, Any], str]:
    plant_file(folder, **profile)
    nest = nest_file(folder, parts)
    done = solve(nest)
    assert done.code == 0, done.err + done.out
    plan = json.loads((folder / "nest.plan.json").read_text(encoding="utf-8"))
    return plan, (folder / "nest.nc").read_text(encoding="utf-8")


def broken(done: Ended) -> set[str]:
    return set(re.findall(r"^broken\s+hard (\S+)", done.out, re.MULTILINE))


@pytest.mark.slow
@pytest.mark.linuxcnc
def test_copies_are_cut_together(tmp_path: Path) -> None:
    """The simulation burns it besides; LinuxCNC's interpreter reads the first torch's path."""
    plan, text = planned(tmp_path)
    schema = json.loads((Path(__file__).parents[2] / "models/plan/plan.schema.json").read_text(encoding="utf-8"))
    Draft202012Validator(schema).validate(plan)
    pairs = {cut["contour"]: cut["together"] for cut in plan["cuts"] if cut.get("torch")}
    assert pairs == {"C.hole1": "A.hole1", "C.outer": "A.outer", "D.outer": "B.outer"}
    cuts = {cut["contour"]: cut for cut in plan["cuts"]}
    for other, first in pairs.items():
        one, two = cuts[first], cuts[other]
        assert two["order"] == one["order"] + 1
        assert (two["start_s"], two["end_s"]) == (one["start_s"], one["end_s"])
        assert two["pierce"] == pytest.approx([one["pierce"][0], one["pierce"][1] + STEP])
        assert two["because"] == [f"cut by torch 2, (0, {STEP}) mm from the first, together with {first}"]
    ran = canon.run(text)
    first_mm = sum(cut["length_mm"] for cut in plan["cuts"] if "torch" not in cut)
    assert sum(burn.length_mm for burn in ran.cuts) == pytest.approx(first_mm, abs=0.1)
    assert plan["totals"]["cut_mm"] == pytest.approx(sum(cut["length_mm"] for cut in plan["cuts"]), abs=0.01)
    assert ran.idle_mm == pytest.approx(plan["totals"]["idle_mm"], abs=0.1)
    assert plan["totals"]["pierces"] == 7
    assert check(tmp_path).code == check(tmp_path, "nest.plan.json").code == 0
    told = kerfwise(
        "explain", tmp_path / "nest.json", tmp_path / "nest.plan.json", "A.outer", "-p", tmp_path / "plant.yaml"
    )
    assert told.code == 0, told.err
    told = kerfwise(
        "explain", tmp_path / "nest.json", tmp_path / "nest.plan.json", "C.outer", "-p", tmp_path / "plant.yaml"
    )
    assert (told.code, "ask about A.outer" in told.err) == (2, True)


def test_two_torches_take_less_time_than_one(tmp_path: Path) -> None:
    two, _ = planned(tmp_path, COPIES)
    one, text = planned(tmp_path, COPIES, count=1)
    assert two["solve"]["status"] == one["solve"]["status"] == "optimal"
    assert two["totals"]["cut_mm"] == pytest.approx(one["totals"]["cut_mm"], rel=0.05)
    assert two["totals"]["time_s"] < 0.6 * one["totals"]["time_s"]
    assert "M64" not in text
    assert "TORCH" not in text


def test_off_by_default(tmp_path: Path) -> None:
    _, one = planned(tmp_path, count=1)
    (tmp_path / "plant.yaml").write_text("based_on: plasma-carbon-steel\nmachine: {dialect: linuxcnc}\n")
    assert solve(tmp_path / "nest.json").code == 0
    plain = (tmp_path / "nest.nc").read_text(encoding="utf-8")
    assert [line for line in one.split("\n") if "PROFILE" not in line] == [
        line for line in plain.split("\n") if "PROFILE" not in line
    ]


def test_three_torches_cut_rows_of_four(tmp_path: Path) -> None:
    """Three at once, then the fourth alone: no cuts are fewer."""
    row = [part(f"P{k}", 60 + 120 * k, 60) for k in range(4)]
    plant_file(tmp_path, count=3, spacing=120, axis="x", dialect="eia")
    nest = nest_file(tmp_path, row, sheet={"width": 600, "height": 200})
    done = solve(nest)
    assert done.code == 0, done.err + done.out
    plan = json.loads((tmp_path / "nest.plan.json").read_text(encoding="utf-8"))
    assert sorted(cut.get("torch", 1) for cut in plan["cuts"]) == [1, 1, 2, 3]
    text = (tmp_path / "nest.nc").read_text(encoding="utf-8")
    assert re.findall(r"^N\d+ (M3[78] T\d)$", text, re.MULTILINE) in (
        ["M37 T2", "M37 T3", "M38 T2", "M38 T3"],
        ["M38 T2", "M38 T3", "M37 T2", "M37 T3"],
    )


def damaged(folder: Path, old: str, new: str, count: int = 1) -> Ended:
    text = (folder / "nest.nc").read_text(encoding="utf-8")
    assert old in text
    (folder / "damaged.nc").write_text(text.replace(old, new, count), encoding="utf-8")
    return check(folder, "damaged.nc")


def metal(folder: Path) -> dict[str, int]:
    profile = load_profile(folder / "plant.yaml")
    text = (folder / "damaged.nc").read_text(encoding="utf-8")
    return by_kind(simulate(profile.as_cut(read_nest(folder / "nest.json")), text, **plant(profile)))


def test_a_torch_that_is_not_selected_cuts_nothing(tmp_path: Path) -> None:
    planned(tmp_path)
    done = damaged(tmp_path, "M64 P1", "")
    assert {"every-contour-once", "program-state"} <= broken(done)
    assert "it is said whether torch 2 burns too" in done.out
    assert "C.outer is not cut" in done.out
    assert "left-uncut" in metal(tmp_path)


def test_a_torch_that_stays_selected_is_found(tmp_path: Path) -> None:
    """Beside the part that has no copy it burns metal of nobody's: another part, or waste for nothing."""
    plan, text = planned(tmp_path)
    single = next(cut for cut in plan["cuts"] if cut["contour"] == "S.outer")
    assert single["order"] == len(plan["cuts"]), "the case is of a part that comes last"
    assert text.count("M65 P1") == 1
    done = damaged(tmp_path, "M65 P1", "")
    assert "torch 2 burns along no contour of the nest" in done.out
    assert "every-contour-once" in broken(done)


def test_a_program_leaves_the_first_torch_alone_for_the_next(tmp_path: Path) -> None:
    _, text = planned(tmp_path, COPIES)
    after = text[text.rindex("M64 P1") :]
    assert after.index("M5") < after.index("M65 P1") < after.index("M2")
    (tmp_path / "damaged.nc").write_text(text.replace(after, after.replace("M65 P1", "")), encoding="utf-8")
    done = check(tmp_path, "damaged.nc")
    assert broken(done) == {"program-state"}
    assert "the program ends with torch 2 selected" in done.out


@pytest.mark.slow
def test_a_torch_lit_over_another_part_is_found(tmp_path: Path) -> None:
    """D stands 10 mm off: the torch that is not to burn would burn it."""
    parts = [COPIES[0], COPIES[1], COPIES[2], part("D", 150, 20 + STEP)]
    planned(tmp_path, parts)
    text = (tmp_path / "nest.nc").read_text(encoding="utf-8")
    (tmp_path / "damaged.nc").write_text(text.replace("M65 P1", "M64 P1"), encoding="utf-8")
    assert {"every-contour-once", "no-gouging"} <= broken(check(tmp_path, "damaged.nc"))
    assert metal(tmp_path)["part-eroded"]


@pytest.mark.slow
@pytest.mark.parametrize("spacing", [STEP - 1, STEP + 0.2])
def test_torches_that_stand_elsewhere_are_found(tmp_path: Path, spacing: float) -> None:
    planned(tmp_path)
    plant_file(tmp_path, spacing=spacing)
    done = check(tmp_path)
    assert {"torches", "every-contour-once"} <= broken(done) or {"torches", "contour-geometry"} <= broken(done)
    assert f"the profile has 2 {spacing:g} mm apart along Y" in done.out
    done = check(tmp_path, "nest.plan.json")
    assert "torches" in broken(done)
    assert f"is not the cut of A.outer shifted by (0, {spacing:g})" in done.out


def test_a_program_says_for_which_torches_it_is(tmp_path: Path) -> None:
    planned(tmp_path)
    done = damaged(tmp_path, "TORCHES 2, 150 MM APART ALONG Y", "TORCHES 2, 200 MM APART ALONG Y")
    assert broken(done) == {"torches"}


@pytest.mark.slow
@pytest.mark.parametrize("dialect", ["linuxcnc", "eia"])
def test_a_program_that_does_not_say_for_which_torches_it_is(tmp_path: Path, dialect: str) -> None:
    """How far apart they stand nobody sees in it; its plan says so, too."""
    planned(tmp_path, COPIES, dialect=dialect)
    done = damaged(tmp_path, "(TORCHES 2, 150 MM APART ALONG Y)\n", "")
    assert broken(done) == {"torches"}
    assert (
        "torch 2 burns too, and no comment says how far it is from the first: expected (TORCHES 2, 150 MM" in done.out
    )
    files = (tmp_path / "nest.json", tmp_path / "damaged.nc", "-p", tmp_path / "plant.yaml")
    assert kerfwise("check", *files, "--plan", tmp_path / "nest.plan.json").code == 0


def test_a_program_of_several_torches_under_a_profile_of_one(tmp_path: Path) -> None:
    """EIA's words for stations are taken from any program: what selects a second torch is refused, with its line."""
    _, text = planned(tmp_path, COPIES, dialect="eia")
    plant_file(tmp_path, count=1, dialect="eia")
    line = 1 + next(k for k, row in enumerate(text.split("\n")) if row.endswith("M37 T2"))
    done = check(tmp_path)
    assert (done.code, f"nest.nc:{line}:" in done.err) == (2, True), done.err
    assert "M37 T2 is for another torch, the profile has one torch: expected T up to T1" in done.err
    done = damaged(tmp_path, "M37 T2\n", "M38 T2\n")
    assert {"torches", "every-contour-once"} <= broken(done)
    assert "the program is for 2 torches 150 mm apart along Y, the profile has one" in done.out


def test_torches_are_not_selected_while_one_burns(tmp_path: Path) -> None:
    _, text = planned(tmp_path)
    line = next(line for line in text.split("\n") if "G1 " in line)
    done = damaged(tmp_path, line, f"{line}\nM65 P1")
    assert "program-state" in broken(done)


@pytest.mark.parametrize(
    ("key", "value", "says"),
    [
        ("torch", 3, "is made by torch 3, the profile has 2 torches"),
        full("together", "B.outer", "does not follow B.outer, with which it is made"),
        ("together", "nobody", "which torch 1 does not cut"),
        full("start_s", 0.0, "has other times than A.outer"),
        ("pierce", [20.0, 140.0], "is not the cut of A.outer shifted by (0, 150)"),
    ],
)
def test_damaged_plans_are_found(tmp_path: Path, key: str, value: Any, says: str) -> None:
    plan, _ = planned(tmp_path)
    row = next(cut for cut in plan["cuts"] if cut["contour"] == "C.outer")
    row[key] = value
    (tmp_path / "damaged.plan.json").write_text(json.dumps(plan), encoding="utf-8")
    done = check(tmp_path, "damaged.plan.json")
    assert "torches" in broken(done)
    assert says in done.out


def test_what_is_cut_at_once_does_not_hold_each_other(tmp_path: Path) -> None:
    """Beside the sheet's edge A has nothing to end along but B, which is out at that very time."""
    plant_file(tmp_path, spacing=90)
    done = solve(nest_file(tmp_path, [part("A", 20, 20), part("B", 20, 110)]))
    assert done.code == 2
    assert "no two parts of the nest can be cut together by the hard rules (A.outer" in done.err


def test_the_check_thinks_neither_the_first(tmp_path: Path) -> None:
    planned(tmp_path, COPIES)
    cuts = read_plan(tmp_path / "nest.plan.json").sequence()
    turned = [cut.contour for cut in cuts.turned(1)]
    assert turned != [cut.contour for cut in cuts]
    for k in range(0, len(turned), 2):
        assert turned[k : k + 2] == [cuts[k + 1].contour, cuts[k].contour]
    assert list(cuts.moments().values()) == [1, 1, 2, 2, 3, 3]


REFUSED = [
    ({"spacing": 77}, "no part of nest.json has a copy 77 mm along y from it"),
    ({"spacing": 0}, "machine.torches.spacing: 2 torches stand apart"),
    ({"dialect": "linuxcnc-qtplasmac"}, "has no words for a second torch"),
    ({"text": "cuts: {links: {longest: 30 mm}}\n"}, "links are not planned together with several torches"),
    (
        {"text": "cuts: {common: {shortest: 20 mm, good_side: any}}\n"},
        "common cuts are not planned together with several torches",
    ),
    ({"text": "cuts: {pierce_pass: zone}\n"}, "a pierce pass is not planned together with several torches"),
    ({"text": "rules: {t-max: hard}\n"}, "t-max simulates one torch"),
    ({"text": "rules: {zone-order: {zone_heat: 100 kJ}}\n"}, "the heat of zones is counted for one torch"),
    (
        {"text": "locks:\n  - {contour: A.outer, position: first}\n  - {contour: D.outer, before: S.outer}\n"},
        "all parts that torches could cut together have locks of an order or a place, and are cut one by one",
    ),
]


@pytest.mark.parametrize(("profile", "says"), REFUSED)
def test_what_does_not_go_together_is_refused(tmp_path: Path, profile: dict[str, Any], says: str) -> None:
    plant_file(tmp_path, **profile)
    done = solve(nest_file(tmp_path))
    assert (done.code, done.out) == (2, "")
    assert says in done.err
    assert done.err.count("kerfwise:") == 1
    assert not (tmp_path / "nest.nc").exists()


@pytest.mark.slow
def test_commands_that_know_one_torch_say_so(tmp_path: Path) -> None:
    planned(tmp_path)
    nest, where = tmp_path / "nest.json", ("-p", tmp_path / "plant.yaml")
    for words in (
        ("solve", nest, *where, "-o", tmp_path / "x.nc", "--engine", "minizinc"),
        ("solve", nest, *where, "-o", tmp_path / "x.nc", "--lock-from", tmp_path / "nest.plan.json", "--upto", "2"),
        ("solve", nest, *where, "-o", tmp_path / "x.nc", "--dxf", tmp_path / "x.dxf"),
        ("resequence", tmp_path / "nest.nc", *where, "-o", tmp_path / "x.nc"),
    ):
        done = kerfwise(*words)
        assert (done.code, "knows one torch" in done.err) == (2, True), done.err + done.out
        line = next(k for k, row in enumerate(where[1].read_text().splitlines(), 1) if "torches" in row)
        assert "--dxf" in words or f"{where[1]}:{line}:" in done.err, done.err
    stopped = kerfwise(
        "solve", nest, "-o", tmp_path / "x.nc", "--lock-from", tmp_path / "nest.plan.json", "--upto", "2"
    )
    assert stopped.code == 2
    assert "nest.plan.json: a program that goes on after a stop knows one torch, and the plan" in stopped.err
    assert not (tmp_path / "x.nc").exists()


@pytest.mark.slow
def test_heat_and_distortion_know_them(tmp_path: Path) -> None:
    """By the plan as by its program; a copy that is cut at the same time is as hot, and one torch leaves less."""
    planned(tmp_path)
    nest, where = tmp_path / "nest.json", ("-p", tmp_path / "plant.yaml", "--json")
    found = [json.loads(kerfwise("heat", nest, tmp_path / made, *where).out) for made in ("nest.plan.json", "nest.nc")]
    peaks = [{part["part"]: part["peak_c"] for part in one["parts"]} for one in found]
    assert peaks[0] == pytest.approx(peaks[1], abs=1.0)
    assert peaks[0]["A"] == pytest.approx(peaks[0]["C"], abs=1.0)
    assert min(peaks[0].values()) > 60, "all of them are cut"
    off = [
        json.loads(kerfwise("distort", nest, tmp_path / made, *where, "--grid", "20").out)
        for made in ("nest.plan.json", "nest.nc")
    ]
    errors = [{part["part"]: part["max_mm"] for part in one["parts"]} for one in off]
    assert errors[0] == pytest.approx(errors[1], abs=0.002)
    assert min(errors[0].values()) > 0.005, "all of them are cut"


@pytest.mark.slow
def test_picture_work_sheet_times_and_facts_know_them(tmp_path: Path) -> None:
    plan, _ = planned(tmp_path)
    nest, where = tmp_path / "nest.json", ("-p", tmp_path / "plant.yaml")
    drawn = kerfwise("plot", nest, tmp_path / "nest.plan.json", "-o", tmp_path / "p.svg")
    assert drawn.code == 0, drawn.err
    assert "of a further torch, at once" in (tmp_path / "p.svg").read_text(encoding="utf-8")
    for made in ("nest.nc", "nest.plan.json"):
        timed = kerfwise("time", nest, tmp_path / made, *where, "--json")
        assert json.loads(timed.out)["total_s"] == pytest.approx(plan["totals"]["time_s"], abs=0.1)
    facts = kerfwise("facts", nest, *where)
    assert facts.out.count(".outer") >= 5
