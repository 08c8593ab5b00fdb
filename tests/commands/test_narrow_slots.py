"""Slots narrower than the kerf, by the command line: opened by slits where the profile says so, else refused."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from kerfwise import load_profile
from kerfwise.tests.commands.run_cli import Ended, kerfwise
from kerfwise.tests.paper import pages_of
from kerfwise.tests.tools.amount import rows
from kerfwise.tests.tools.shipped import PROFILES

PROFILE = Path(__file__).parents[2] / "examples" / "profiles" / "narrow-slots.yaml"
Row = list[list[float]]


def slotted(x: float, y: float, width_mm: float, depth_mm: float) -> Row:
    """A plate of 100 x 120 mm with a slot in the middle of its upper side."""
    left, right, top, low = x + 50 - width_mm / 2, x + 50 + width_mm / 2, y + 120, y + 120 - depth_mm
    return [[x, y], [x + 100, y], [x + 100, top], [right, top], [right, low], [left, low],
            [left, top], [x, top]]  # fmt: skip


RELIEF = [[30, 30], [130, 30], [130, 60], [60, 60], [60, 54], [59, 54], [59, 130], [30, 130]]
ROUND = [[30, 30], [130, 30], [130, 130], [30, 130]]
HOLE = [[50, 50], [80, 50], [80, 64.5], [110, 64.5], [110, 65.5], [80, 65.5], [80, 80], [50, 80]]
TWO = [[30, 30], [130, 30], [130, 150], [100.5, 150], [100.5, 70], [99.5, 70], [99.5, 150], [60.7, 150], [60.7, 140],
       [59.3, 140], [59.3, 150], [30, 150]]  # fmt: skip
BENT = [[30, 30], [130, 30], [130, 150], [80.5, 150], [80.5, 121], [100, 121], [100, 120], [79.5, 120], [79.5, 150],
        [30, 150]]  # fmt: skip

LEANING = [
    [30, 30],
    [130, 30],
    [130, 150],
    [80.5774, 150],
    [60.433, 115.109],
    [59.567, 115.609],
    [79.4226, 150],
    [30, 150],
]
"""A slot 40 mm deep that leans by 30°."""

OPENED: dict[str, tuple[list[dict[str, Any]], list[tuple[str, float]]]] = {
    "0.5 mm wide, 80 mm deep": ([{"id": "A", "outer": slotted(30, 30, 0.5, 80)}], [("A.slit1", 0.5)]),
    "1 mm wide, 80 mm deep": ([{"id": "A", "outer": slotted(30, 30, 1.0, 80)}], [("A.slit1", 0.25)]),
    "1.4 mm wide, 80 mm deep": ([{"id": "A", "outer": slotted(30, 30, 1.4, 80)}], [("A.slit1", 0.05)]),
    "leaning": ([{"id": "A", "outer": LEANING}], [("A.slit1", 0.25)]),
    "a bend relief": ([{"id": "A", "outer": RELIEF}], [("A.slit1", 0.25)]),
    "in a hole": ([{"id": "A", "outer": ROUND, "holes": [HOLE]}], [("A.slit1", 0.25)]),
    "two of them": ([{"id": "A", "outer": TWO}], [("A.slit1", 0.25), ("A.slit2", 0.05)]),
    "two parts": (
        [{"id": "A", "outer": slotted(30, 30, 1.0, 80)}, {"id": "B", "outer": slotted(140, 30, 1.0, 40)}],
        [("A.slit1", 0.25), ("B.slit1", 0.25)],
    ),
}


def nest_file(folder: Path, parts: list[dict[str, Any]]) -> Path:
    nest = {"format": "kerfwise-nest/1", "units": "mm", "sheet": {"width": 300, "height": 200}, "parts": parts}
    (folder / "nest.json").write_text(json.dumps(nest), encoding="utf-8")
    return folder / "nest.json"


def solve(nest: Path, *words: str | Path) -> Ended:
    folder = nest.parent
    return kerfwise(
        "solve", nest, "-p", PROFILE, "-o", folder / "nest.nc", "--plan", folder / "nest.plan.json", "--work", "1",
        "--conflict-picture", folder / "c.svg", *words,
    )  # fmt: skip


@pytest.mark.parametrize("case", OPENED)
def test_a_slit_opens_the_slot_before_its_contour_and_says_what_that_costs(tmp_path: Path, case: str) -> None:
    """Each program is burnt by the simulation, too: nothing more is lost, and the slots are open to their end."""
    parts, slits = OPENED[case]
    nest = nest_file(tmp_path, parts)
    done = solve(nest)
    assert done.code == 0, done.err
    plan = json.loads((tmp_path / "nest.plan.json").read_text(encoding="utf-8"))
    order = {cut["contour"]: cut["order"] for cut in plan["cuts"]}
    for name, loss_mm in slits:
        (cut,) = (cut for cut in plan["cuts"] if cut["contour"] == name)
        of = name.replace("slit1", "hole1") if case == "in a hole" else name.partition(".")[0] + ".outer"
        assert cut["kind"] == "slit"
        assert order[name] < order[of]
        assert f"the part loses {loss_mm:.2f} mm at each side (cuts.narrow: slit)" in cut["because"][0]
        assert f"warning: {name} opens a slot of {of} at (" in done.out
        assert f"the part loses {loss_mm:.2f} mm at each side" in done.out
    program = (tmp_path / "nest.nc").read_text(encoding="utf-8")
    assert f"(NARROW SLOTS OPENED BY ONE PASS {len(slits)})" in program
    for file in ("nest.nc", "nest.plan.json"):
        checked = kerfwise("check", nest, tmp_path / file, "-p", PROFILE)
        assert checked.code == 0, checked.out
        assert "opens a slot of" in checked.out


def test_a_deep_slot_is_a_question(tmp_path: Path) -> None:
    nest = nest_file(tmp_path, [{"id": "A", "outer": slotted(30, 30, 1.0, 80)}])
    asked = kerfwise("solve", nest, "-o", tmp_path / "nest.nc")
    assert (asked.code, asked.out) == (3, "")
    assert (
        "narrow: the kerf of 1.5 mm does not enter a deep slot, notch or neck: A.outer, slot, notch or neck at "
        "(80.0, 150.0), 1.00 mm wide and 80.0 mm deep: what should be done?"
    ) in asked.err
    for how, said in (("slit", "opens a slot"), ("leave", "is cut straight across")):
        done = kerfwise("solve", nest, "-o", tmp_path / "nest.nc", "--answer", f"narrow={how}", "--work", "0.1")
        assert (done.code, said in done.out) == (0, True), done.err
        assert kerfwise("check", nest, tmp_path / "nest.nc").code == 0  # the job file has the answer
    assert kerfwise("solve", nest, "--answer", "narrow=refuse").code == 2


def test_a_profile_that_refuses_names_the_slot_and_the_keys(tmp_path: Path) -> None:
    nest = nest_file(tmp_path, [{"id": "A", "outer": slotted(30, 30, 1.0, 80)}])
    done = kerfwise("solve", nest, "-o", tmp_path / "nest.nc", "--set", "cuts.narrow=refuse")
    assert done.code == 2
    assert (
        "A.outer: a kerf of 1.5 mm does not enter the slot, notch or neck at (80.0, 150.0), 1.00 mm wide and 80.0 mm "
        "deep; one pass along the middle opens it (cuts.narrow: slit), or change the drawing; `cuts.narrow: leave` "
        "(the torch cuts straight across) frees it"
    ) in done.err


@pytest.mark.parametrize("how", ["leave", "slit"])
def test_what_the_message_names_frees_the_nest(tmp_path: Path, how: str) -> None:
    nest = nest_file(tmp_path, [{"id": "A", "outer": slotted(30, 30, 1.0, 80)}])
    done = kerfwise("solve", nest, "-o", tmp_path / "nest.nc", "--set", f"cuts.narrow={how}", "--work", "1")
    assert done.code == 0, done.err
    assert ("opens a slot" if how == "slit" else "is cut straight across") in done.out


def test_bend_reliefs_are_cut_straight_across_and_listed(tmp_path: Path) -> None:
    """Two reliefs of 1 x 1 mm beside the bend of a bracket, as sheet metal programs draw them."""
    bracket = [[30, 30], [130, 30], [130, 60], [129, 60], [129, 61], [130, 61], [130, 90], [30, 90], [30, 61], [31, 61],
               [31, 60], [30, 60]]  # fmt: skip
    nest = nest_file(tmp_path, [{"id": "A", "outer": bracket}])
    out, plan = tmp_path / "nest.nc", tmp_path / "nest.plan.json"
    done = kerfwise("solve", nest, "-o", out, "--plan", plan, "--work", "1")
    assert done.code == 0, done.err
    assert "warning: 2 slots, notches or necks narrower than the kerf are cut straight across, up to 0." in done.out
    (cut,) = json.loads(plan.read_text(encoding="utf-8"))["cuts"]
    (left, one), (right, other) = sorted(cut["across"])
    assert [left, right, one, other] == pytest.approx([30, 130, 60.5, 60.5], abs=0.1)
    drawn = tmp_path / "nest.svg"
    assert kerfwise("plot", nest, plan, "-o", drawn).code == 0
    assert drawn.read_text(encoding="utf-8").count("#e8590c") == 2  # those of the layer, and of the key
    paper = tmp_path / "sheet.pdf"
    assert kerfwise("sheet", nest, plan, "--program", out, "-o", paper).code == 0
    assert "2 slots narrower than the kerf (crosses): A.outer at (" in pages_of(paper)[0].text
    assert (
        "A.outer is cut straight across what is narrower than the kerf of 1.5 mm: slot, notch or neck at"
        in cut["because"][0]
    )
    assert "(SLOTS AND NOTCHES NARROWER THAN THE KERF, CUT ACROSS 2)" in out.read_text(encoding="utf-8")
    for file in (out, plan):
        assert kerfwise("check", nest, file).code == 0
    refused = kerfwise("check", nest, out, "--set", "cuts.narrow=refuse")
    assert refused.code == 1
    assert "features-kept" in refused.out


GUSSET = {"id": "gusset", "outer": [[30, 30], [230, 30], [230, 60], [60, 180], [30, 180]],
          "holes": [[[60, 60], [150, 60], [60, 150]]]}  # fmt: skip


@pytest.mark.parametrize("profile", PROFILES)
def test_a_triangular_window_is_cut_by_every_profile(tmp_path: Path, profile: str) -> None:
    """Its corners of 45° keep what a round kerf leaves: that is told, and no fault."""
    nest = nest_file(tmp_path, [GUSSET])
    done = kerfwise("solve", nest, "-p", profile, "-o", tmp_path / "nest.nc", "--work", "1")
    assert done.code == 0, done.err
    kerf_mm = load_profile(profile).material.kerf_mm
    kept_mm = kerf_mm / 2 * (1 / math.sin(math.radians(45) / 2) - 1)
    assert f"warning: 2 corners keep up to {kept_mm:.2f} mm that a round kerf does not reach: gusset.hole1" in done.out
    assert kerfwise("check", nest, tmp_path / "nest.nc", "-p", profile).code == 0


def test_a_plant_may_limit_what_is_left_of_corners(tmp_path: Path) -> None:
    nest = nest_file(tmp_path, [GUSSET])
    done = kerfwise("solve", nest, "-o", tmp_path / "nest.nc", "--set", "corners.leave=0.3 mm")
    assert done.code == 2
    assert "which keeps 1.21 mm" in done.err
    assert "`corners.leave: 1.21 mm` frees it" in done.err
    assert kerfwise("solve", nest, "-o", tmp_path / "nest.nc", "--set", "corners.leave=1.21 mm").code == 0
    refused = kerfwise("check", nest, tmp_path / "nest.nc", "--set", "corners.leave=0.3 mm")
    assert "the profile allows 0.3 mm of a corner (corners.leave)" in refused.out
    assert refused.code == 1


def test_a_profile_that_refuses_does_not_pass_a_program_with_slits(tmp_path: Path) -> None:
    nest = nest_file(tmp_path, [{"id": "A", "outer": slotted(30, 30, 1.0, 80)}])
    assert solve(nest).code == 0
    checked = kerfwise("check", nest, tmp_path / "nest.nc")
    assert checked.code == 1
    assert "FAILED: 3 hard rules broken: every-contour-once, features-kept, no-gouging" in checked.out


def test_a_slot_with_a_bend_is_refused_with_place_width_and_why(tmp_path: Path) -> None:
    done = solve(nest_file(tmp_path, [{"id": "A", "outer": BENT}]))
    assert done.code == 2
    assert (
        "A.outer: a kerf of 1.5 mm does not enter the slot, notch or neck at (80.0, 150.0), 1.00 mm wide and 30.0 mm "
        "deep; no slit opens it: it forks or bends: one pass would leave some of it; change the drawing; "
        "`cuts.narrow: leave` (the torch cuts straight across) frees it"
    ) in done.err


def test_a_slot_without_room_for_a_pierce_before_it_is_refused_with_why(tmp_path: Path) -> None:
    """The neighbour stands 2.4 mm before the mouth."""
    wall = [[30, 152.4], [130, 152.4], [130, 180], [30, 180]]
    done = solve(nest_file(tmp_path, [{"id": "A", "outer": slotted(30, 30, 1.0, 80)}, {"id": "B", "outer": wall}]))
    assert done.code == 2
    assert (
        "A.outer: the slot with its mouth at (80.0, 150.6) cannot be opened by a slit: the waste before it has no room "
        "for a pierce"
    ) in done.err


STOPS = [
    (old, upto, again) for old in ("nest.nc", "nest.plan.json") for upto, again in ((1, False), (1, True), (2, False))
]
QUICK = (("nest.nc", 1, True), ("nest.plan.json", 2, False))
"""By program and by plan, a cut made again and a later stop: these always run."""


@pytest.mark.parametrize(
    ("old", "upto", "again"),
    rows(sorted(STOPS, key=lambda stop: stop not in QUICK), len(QUICK)),
)
def test_work_with_slits_goes_on_after_a_stop(tmp_path: Path, old: str, upto: int, again: bool) -> None:
    nest = nest_file(tmp_path, OPENED["two of them"][0])
    assert solve(nest).code == 0
    words = ["--lock-from", str(tmp_path / old), "--upto", str(upto), *(["--redo-last"] if again else [])]
    done = solve(nest, *words, "-o", tmp_path / "rest.nc", "--plan", tmp_path / "rest.plan.json")
    assert done.code == 0, done.err + done.out
    for file in ("rest.nc", "rest.plan.json"):
        checked = kerfwise("check", nest, tmp_path / file, "-p", PROFILE)
        assert checked.code == 0, checked.out


def test_explain_says_what_a_slit_is_for(tmp_path: Path) -> None:
    nest = nest_file(tmp_path, OPENED["1 mm wide, 80 mm deep"][0])
    assert solve(nest).code == 0
    told = kerfwise("explain", nest, tmp_path / "nest.plan.json", "A.slit1", "-p", PROFILE)
    assert "A.slit1 opens the slot of A.outer at (80.0, 150.0), 1.00 mm wide and 80.0 mm deep, in one pass" in told.out
    assert "it opens a slot beside metal that cutting A.outer frees" in told.out


def test_pictures_name_slits_in_their_key(tmp_path: Path) -> None:
    nest = nest_file(tmp_path, OPENED["1 mm wide, 80 mm deep"][0])
    assert solve(nest, "--picture", tmp_path / "nest.svg").code == 0
    assert "slit along a narrow slot" in (tmp_path / "nest.svg").read_text(encoding="utf-8")
