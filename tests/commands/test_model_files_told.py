"""Mistakes in plants' model files are told with file, line and contours, and what cannot hold can be relaxed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.tools.amount import full

pytestmark = pytest.mark.minizinc

RULES_OFF = [
    "level-ahead",
    "hull-before",
    "zone-order",
    "heat-lag",
    "no-islands",
    "no-narrow-strips",
    "no-tip-travel",
    "part-rigidity",
    "part-contiguous",
]


@pytest.fixture(autouse=True)
def in_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is written without a name lies there."""
    monkeypatch.chdir(tmp_path)


def box(name: str, x: float, y: float, w: float, h: float, **attributes: object) -> dict[str, object]:
    return {"id": name, "outer": [[x, y], [x + w, y], [x + w, y + h], [x, y + h]], **attributes}


NEST = [
    box("A", 30, 30, 120, 120, order=17, lot=1),
    box("B", 180, 30, 120, 120, order=17, lot=2),
    box("C", 330, 30, 200, 40, order=18, lot=1),
    box("E", 30, 200, 140, 140, order=19, lot=2),
]
EARLY = """% early17: order 17 is out within the first 40 % of the cutting
% Dispatch: the truck leaves at noon.
int: early17_share; % default 40: percent of all cutting, by length
array[int] of var bool: early17_holds =
  [100 * (contour_length[i] + sum(j in CONTOUR where j != i)(contour_length[j] * bool2int(before(j, i))))
     <= early17_share * sum(contour_length)
   | i in CONTOUR where attribute_order[i] = 17 /\\ kind[i] = OUTER];
"""
SAYS = """array[int] of string: early17_says =
  [contour_id[i] ++ " of order 17 is out early" | i in CONTOUR where attribute_order[i] = 17 /\\ kind[i] = OUTER];
"""


def plant(folder: Path, name: str, text: str, rules: str = "") -> tuple[Path, Path]:
    """A nest and a profile with one model file."""
    nest, profile = folder / "nest.json", folder / "plant.yaml"
    sheet = {"width": 600, "height": 400}
    made = {"format": "kerfwise-nest/1", "units": "mm", "sheet": sheet, "parts": NEST}
    nest.write_text(json.dumps(made), encoding="utf-8")
    (folder / f"{name}.mzn").write_text(text, encoding="utf-8")
    off = "".join(f"  {rule}: off\n" for rule in RULES_OFF if not rules.strip().startswith(rule))
    profile.write_text(
        f"based_on: plasma-carbon-steel\nmodels: [{name}.mzn]\nleads: {{entries: 2}}\nrules:\n{off}{rules}",
        encoding="utf-8",
    )
    return nest, profile


@pytest.mark.parametrize("text", [EARLY, EARLY + SAYS], ids=["without sentences", "with sentences"])
def test_what_can_hold_in_no_order_is_relaxed(text: str, tmp_path: Path) -> None:
    nest, profile = plant(tmp_path, "early17", text, "  early17: {share: 10}\n")
    done = kerfwise("solve", nest, "-p", profile, "--work", "1")
    assert done.code == 1
    assert "element 1 of the file's array can hold in no order" in done.err
    assert "A.outer" in done.err
    assert "early17.mzn:4" in done.err
    assert "relax early17: 2 statements about A.outer, B.outer" in done.err
    done = kerfwise("solve", nest, "-p", profile, "--work", "1", "--relax", "-o", tmp_path / "nest.nc")
    assert done.code == 0, done.err
    assert "warning: relaxed: early17 about A.outer\n" in done.out
    assert "ok, but 2 places are not kept: 2 relaxed (early17: A.outer; B.outer)" in done.out
    done = kerfwise("check", nest, tmp_path / "nest.nc", "-p", profile)
    assert done.code == 0
    assert "2 relaxed (early17: A.outer; B.outer)" in done.out


@pytest.mark.parametrize(
    ("condition", "relaxed"),
    [
        ("before(i, j) | i, j in CONTOUR where contour_area[i] >= contour_area[j]", "A.outer; A.outer and B.outer"),
        full("directly_before(i, i) | i in CONTOUR where kind[i] = OUTER", "A.outer; B.outer"),
        ("position[i] <= 1 | i in CONTOUR where attribute_order[i] = 17", ""),
        full("position[i] > n_contours | i in CONTOUR where attribute_lot[i] = 2", "B.outer; E.outer"),
        ("cuts_between(i, j) >= 9 | i in CONTOUR, j in CONTOUR where i < j", "A.outer and B.outer"),
        ("position[1] div 0 <= 3", "1 relaxed (never: the sheet)"),
        full("sum(c in CANDIDATE where cand_y[c] < 0)(bool2int(picked(c))) >= 2", "1 relaxed (never: the sheet)"),
        ("sum(c in CANDIDATE where cand_y[c] > 0)(bool2int(picked(c))) <= 2", "1 relaxed (never: "),
    ],
)
def test_siblings_of_it(condition: str, relaxed: str, tmp_path: Path) -> None:
    nest, profile = plant(
        tmp_path, "never", f"% never: never\n% x\narray[int] of var bool: never_holds = [{condition}];\n"
    )
    refused = kerfwise("solve", nest, "-p", profile, "--work", "1")
    assert refused.code == 1
    assert "never" in refused.err
    assert "Traceback" not in refused.err
    done = kerfwise("solve", nest, "-p", profile, "--work", "1", "--relax", "-o", "nest.nc")
    assert done.code == 0, done.err
    assert "relaxed" in done.out
    assert relaxed in done.out
    assert "about \n" not in done.out
    assert kerfwise("check", nest, "nest.nc", "-p", profile).out.endswith(done.out.splitlines()[-2] + "\n")


def test_a_contour_that_stands_for_both_is_named(tmp_path: Path) -> None:
    where = "attribute_lot[i] = attribute_lot[j]"
    text = f"array[int] of var bool: same_holds =\n  [before(i, j) | i, j in CONTOUR where {where}];\n"
    nest, profile = plant(tmp_path, "same", "% same: lots in one go\n% x\n" + text)
    done = kerfwise("solve", nest, "-p", profile, "--work", "1")
    assert done.code == 1
    assert "where both contours are A.outer (write `where i != j`): Lots in one go (same.mzn:3)" in done.err


@pytest.mark.parametrize(
    "condition",
    [
        "[0.5 * position[2] <= 1.7]",
        "[position[i] * 0.25 <= 0.9 | i in CONTOUR where kind[i] = OUTER]",
        "[sum(j in CONTOUR where j != i)(0.1 * bool2int(before(j, i))) <= 0.15 | i in CONTOUR]",
        "[int2float(position[1]) / 3.0 <= 0.5]",
    ],
)
def test_fractions_are_told_with_what_to_write(condition: str, tmp_path: Path) -> None:
    text = f"% part1: x\n% y\n\narray[int] of var bool: part1_holds = {condition};\n"
    nest, profile = plant(tmp_path, "part1", text)
    done = kerfwise("solve", nest, "-p", profile, "--work", "1")
    assert done.code == 2
    assert (
        "part1.mzn:4: rule part1: it counts in fractions, and rules count in whole numbers: multiply both" in done.err
    )
    assert done.err.count("\n") == 1


@pytest.mark.parametrize(
    ("word", "meant"), [("prio", ""), ("ordr", "; did you mean order?"), ("Lott", "; did you mean lot?")]
)
def test_an_attribute_that_no_part_has_is_told(word: str, meant: str, tmp_path: Path) -> None:
    text = f"array[int] of var bool: att_holds = [before(i, j) | i, j in CONTOUR where attribute_{word}[i] = 1];\n"
    nest, profile = plant(tmp_path, "att", text)
    done = kerfwise("solve", nest, "-p", profile, "--work", "1")
    assert done.code == 0
    told = f"rule att has nothing to say here: no part of this nest has the attribute {word} (att.mzn:1), "
    assert f"{told}its parts have lot, order{meant}\n" in done.out
    text = text.replace("where ", f"where has_attribute_{word}[i] /\\ ")
    nest, profile = plant(tmp_path, "att", text)
    assert "no part of this nest" not in kerfwise("solve", nest, "-p", profile, "--work", "1").out


def test_a_file_in_a_shipped_rules_place_may_have_a_parameter_of_its_own(tmp_path: Path) -> None:
    text = """% hull-before: a part in the concavity of another is cut before it, unless it is small
% Pristupov 2016, fig. 4.
int: hull_before_least; % default 1000: parts smaller than this are let be, mm2
array[int] of var bool: hull_before_holds =
  [before(j, i) | i, j in CONTOUR where in_hull[j, i] /\\ contour_area[j] > hull_before_least];
"""
    nest, profile = plant(tmp_path, "hull_before", text, "  hull-before: {strength: hard, least: 500}\n")
    assert kerfwise("profile", "check", profile).code == 0
    done = kerfwise("solve", nest, "-p", profile, "--work", "1")
    assert done.code == 0, done.err
    nest, profile = plant(tmp_path, "hull_before", text, "  hull-before: {strength: hard, last: 500}\n")
    done = kerfwise("profile", "check", profile)
    assert done.code == 2
    assert "did you mean least?" in done.err or "'least'" in done.err


def test_a_shipped_text_is_copied_to_begin_with(tmp_path: Path) -> None:
    done = kerfwise("rules", "new", "hull-before", "--like", "hull-before", "-o", tmp_path / "plant")
    assert done.code == 0, done.err
    assert (tmp_path / "plant" / "hull_before.mzn").read_text(encoding="utf-8").startswith("% hull-before: ")
    assert kerfwise("rules", "new", "my-hull", "--like", "hull-before", "-o", tmp_path / "plant").code == 0
    assert "my_hull_holds" in (tmp_path / "plant" / "my_hull.mzn").read_text(encoding="utf-8")
    again = kerfwise("rules", "new", "my-hull", "--like", "hull-before", "-o", tmp_path / "plant")
    assert again.code == 2
    assert "the file is there already" in again.err
    for like, why in (
        ("hull-befor", "did you mean 'hull-before'?"),
        ("no-narrow-strips", "strips are found in whole orders"),
        ("part-rigidity", "which only that rule is given: copy it under its own name"),
    ):
        refused = kerfwise("rules", "new", "mine", "--like", like, "-o", tmp_path / "plant")
        assert refused.code == 2
        assert why in refused.err
    assert not (tmp_path / "plant" / "mine.mzn").exists()


BEFORE = """% most17: of all pairs of one part of order 17 and one of 18, two in three have that of 17 first
% Dispatch: the truck leaves at noon.
array[int] of var bool: most17_holds =
  [3 * sum(i, j in CONTOUR where attribute_order[i] = 17 /\\ attribute_order[j] = 18)(bool2int(before(i, j)))
     >= 2 * sum(i, j in CONTOUR where attribute_order[i] = 17 /\\ attribute_order[j] = 18)(1)];
"""


@pytest.mark.parametrize(
    ("name", "text", "rules", "further"),
    [
        ("early17", EARLY, "  early17: {share: 40}\n", []),
        full("early17", EARLY, "  early17: {share: 60}\n", ["--relax"]),
        full("most17", BEFORE, "", []),
        ("most17", BEFORE, "", ["--relax"]),
    ],
)
def test_zones_yield_to_a_hard_rule_over_sums(
    name: str, text: str, rules: str, further: list[str], tmp_path: Path
) -> None:
    """The parts of order 17 lie in the last zone; without zones there is a plan, and so there is with them."""
    nest, profile = plant(tmp_path, name, text, rules)
    parts = [
        box(f"P{3 * c + r}", 20 + c * 120, 20 + r * 120, 100, 100, order=17 if c > 5 else 18)
        for c in range(8)
        for r in range(3)
    ]
    sheet = {"width": 1000, "height": 400}
    made = {"format": "kerfwise-nest/1", "units": "mm", "sheet": sheet, "parts": parts}
    nest.write_text(json.dumps(made), encoding="utf-8")
    zoned = profile.read_text(encoding="utf-8").replace(
        "zone-order: off", "zone-order: {strength: hard, zone_contours: 6}"
    )
    profile.write_text(zoned, encoding="utf-8")
    done = kerfwise("solve", nest, "-p", profile, "--work", "0.5", *further)
    assert done.code == 0, done.err
    assert "relaxed" not in done.out
    plan = json.loads((tmp_path / "nest.plan.json").read_text(encoding="utf-8"))
    assert max(cut["zone"] for cut in plan["cuts"]) > 1
    assert kerfwise("check", nest, tmp_path / "nest.nc", "-p", profile).code == 0


SOON = """% soon: lot 1 of order 17 is out within the first 60 % of the time, on thick plate
% Dispatch: the truck leaves at noon.
array[int] of var bool: soon_holds =
  [10 * (cut_ms[i] + sum(j in CONTOUR where j != i)(cut_ms[j] * bool2int(before(j, i)))) <= 6 * sum(cut_ms)
   | i in CONTOUR where attribute_order[i] = 17 /\\ attribute_lot[i] = 1 /\\ sheet_thickness >= 500
     /\\ sheet_material = "S235" /\\ cutting_process = "plasma" /\\ part_weight[i] > 300];
"""


def test_a_file_reads_times_and_the_plate(tmp_path: Path) -> None:
    """Part A, of 0.7 kg, is cut last without the rule, and so on thin plate."""
    nest, profile = plant(tmp_path, "soon", SOON)
    places = {}
    for thickness in ("6 mm", "2 mm"):
        done = kerfwise("solve", nest, "-p", profile, "--work", "1", "--set", f"material.thickness={thickness}")
        assert done.code == 0, done.err
        assert "ok: every hard rule holds" in done.out
        plan = json.loads((tmp_path / "nest.plan.json").read_text(encoding="utf-8"))
        places[thickness] = [cut["contour"] for cut in plan["cuts"]].index("A.outer")
    assert places["2 mm"] == 3
    assert places["6 mm"] < 3
