"""Refusals for want of room: one message, grouped, and what it says to change is enough."""

from __future__ import annotations

import json
import re
from collections import Counter
from pathlib import Path

import pytest
import yaml
from hypothesis import HealthCheck, given
from hypothesis import strategies as st

import kerfwise as package
from kerfwise import InputError, load_profile, read_nest
from kerfwise.rule_kit import circle, rect
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.tools.amount import examples

Section = dict[str, object]


def written(folder: Path, parts: list[dict[str, object]], size: tuple[float, float] = (700, 400)) -> Path:
    """A nest file."""
    nest = {"format": "kerfwise-nest/1", "units": "mm", "sheet": {"width": size[0], "height": size[1]}, "parts": parts}
    file = folder / "nest.json"
    file.write_text(json.dumps(nest), encoding="utf-8")
    return file


def plant(folder: Path, **sections: Section) -> Path:
    """A profile for plasma with these sections."""
    file = folder / "plant.yaml"
    file.write_text(yaml.safe_dump({"based_on": "plasma-carbon-steel", **sections}), encoding="utf-8")
    return file


def advised(profile: Path, advice: str) -> Path:
    """The profile with `rules.pierce.clearance: 1.48 mm` and the like done."""
    data = yaml.safe_load(profile.read_text(encoding="utf-8"))
    path, _, value = advice.partition(": ")
    *above, last = path.split(".")
    inner = data
    for key in above:
        inner = inner.setdefault(key, {})
    inner[last] = value
    file = profile.with_name("advised.yaml")
    file.write_text(yaml.safe_dump(data), encoding="utf-8")
    return file


def perforated(across_mm: float, count: int = 112) -> list[dict[str, object]]:
    """A plate with so many holes in rows of 14, and a part with a hole of 30 mm."""
    holes = [circle(40 + 25 * (k % 14), 40 + 25 * (k // 14), across_mm / 2) for k in range(count)]
    return [
        {"id": "P1", "outer": rect(15, 15, 380, 230), "holes": holes},
        {"id": "P2", "outer": rect(450, 30, 100, 100), "holes": [circle(500, 80, 15)]},
    ]


@pytest.mark.full
@pytest.mark.slow
def test_a_plate_of_112_holes_is_refused_in_one_line_and_freed_by_what_it_says(tmp_path: Path) -> None:
    nest = written(tmp_path, perforated(2.96))
    profile = plant(tmp_path, small_holes={"min_hole": "2 mm", "under": "refuse"})
    ended = kerfwise("solve", nest, "-p", profile, "-o", tmp_path / "out.nc")
    assert ended.code == 2
    assert ended.err == (
        f"kerfwise: {nest}: 112 contours of the nest cannot be cut as the options ask; "
        "`rules.pierce.clearance: 1.48 mm`, or `small_holes.under: spot` frees all of them\n"
        "  - 112 holes (P1.hole1, P1.hole2, P1.hole3 and 109 more): `rules.pierce.clearance: 1.48 mm`, or "
        "`small_holes.under: spot` frees them; such as P1.hole1 at (38.5, 40.0): the best spot for a pierce near it is "
        "1.48 mm from P1.hole1, rules.pierce.clearance asks for 1.5 mm\n"
    )
    spotted = advised(profile, "small_holes.under: spot")
    ended = kerfwise("solve", nest, "-p", spotted, "-o", tmp_path / "out.nc", "--work", 1)
    assert ended.code == 0
    assert "112 small holes are not cut but marked at the middle (small_holes.under: spot): P1.hole1," in ended.out
    assert (tmp_path / "out.nc").read_text(encoding="utf-8").count("M3 $1 S1") == 112
    assert kerfwise("check", nest, tmp_path / "out.nc", "-p", spotted).code == 0


def test_one_tiny_hole_is_told_with_the_option_that_frees_it(tmp_path: Path) -> None:
    nest = written(tmp_path, perforated(4, count=1))
    ended = kerfwise("solve", nest, "-o", tmp_path / "out.nc", "--set", "small_holes.under=refuse")
    assert ended.code == 2
    assert ended.err.splitlines()[1:] == [
        "  - P1.hole1 is 4.00 mm across, less than small_holes.min_hole, 6 mm; `small_holes.under: spot`, or "
        "`small_holes.min_hole: 4 mm` frees it"
    ]


def test_small_holes_are_a_question_with_counts(tmp_path: Path) -> None:
    drawn = perforated(4, count=3)
    holes = drawn[0]["holes"]
    assert isinstance(holes, list)
    holes.append([[20, 120, 1], [20.13, 120, 1]])
    nest, out = written(tmp_path, drawn), tmp_path / "out.nc"
    ended = kerfwise("solve", nest, "-o", out)
    assert (ended.code, ended.out) == (3, "")
    assert ended.err.splitlines()[1:-1] == [
        "  1. small-holes: 4 holes are too small to be cut: 1 no wider than the kerf of 1.5 mm (0.13 mm across: "
        "P1.hole4); 3 under small_holes.min_hole, 6 mm (4.00 mm across: P1.hole1, P1.hole2, P1.hole3): "
        "what should be done?",
        "      --answer small-holes=spot     4 holes marked at the middle",
        "      --answer small-holes=skip     4 holes left out",
        "      --answer small-holes=cut      3 holes cut anyway, 1 left out",
        "      --answer small-holes=refuse   not cut: the nest is refused, to be drawn otherwise",
    ]
    for answer, made in (("spot", {"mark": 4}), ("skip", {}), ("cut", {"hole": 3})):
        plan = tmp_path / f"{answer}.json"
        answered = ("--plan", plan, "--answer", f"small-holes={answer}", "--work", "0.1")
        assert kerfwise("solve", nest, "-o", out, *answered).code == 0
        kinds = Counter(cut["kind"] for cut in json.loads(plan.read_text(encoding="utf-8"))["cuts"])
        assert kinds == {**made, "hole": made.get("hole", 0) + 1, "outer": 2}  # those of the second part
        assert kerfwise("check", nest, plan).code == 0  # the job file has the answer
    refused = kerfwise("solve", nest, "-o", out, "--answer", "small-holes=refuse")
    assert refused.code == 2
    wrong = kerfwise("solve", nest, "-o", out, "--answer", "small-holes=drill")
    assert (wrong.code, "expected skip, spot, cut, refuse" in wrong.err) == (2, True)


def test_what_is_left_out_has_its_reason_where_it_is_asked_for(tmp_path: Path) -> None:
    nest, out, plan = written(tmp_path, perforated(4, count=2)), tmp_path / "out.nc", tmp_path / "out.json"
    profile = plant(tmp_path, small_holes={"under": "skip"})
    assert kerfwise("solve", nest, "-p", profile, "-o", out, "--plan", plan, "--work", 1).code == 0
    asked = kerfwise("explain", nest, plan, "P1.hole1", "-p", profile)
    assert asked.code == 2
    assert "P1.hole1 is not in the plan: P1.hole1 is 4.00 mm across, less than small_holes.min_hole, 6 mm" in asked.err
    for verb in (["time", nest, out], ["check", nest, plan], ["heat", nest, plan]):
        assert kerfwise(*verb, "-p", profile).code == 0
    locked = plant(tmp_path, small_holes={"under": "skip"})
    locked.write_text(locked.read_text() + "locks:\n- {contour: P1.hole1, position: first}\n", encoding="utf-8")
    ended = kerfwise("solve", nest, "-p", locked, "-o", out)
    assert ended.code == 2
    assert "lock: P1.hole1 is left out as a small hole (small_holes.under: skip)" in ended.err


def test_a_spot_explains_itself(tmp_path: Path) -> None:
    nest, out, plan = written(tmp_path, perforated(4, count=2)), tmp_path / "out.nc", tmp_path / "out.json"
    profile = plant(tmp_path, small_holes={"under": "spot"})
    assert kerfwise("solve", nest, "-p", profile, "-o", out, "--plan", plan, "--work", 1).code == 0
    asked = kerfwise("explain", nest, plan, "P1.hole1", "-p", profile)
    assert asked.code == 0
    assert "P1.hole1 is 4.00 mm across, less than small_holes.min_hole, 6 mm: it is marked at its middle" in asked.out
    assert kerfwise("plot", nest, plan, "-o", tmp_path / "out.svg", "-p", profile).code == 0


shapes = st.one_of(
    st.tuples(st.just("circle"), st.floats(0.8, 12)),
    st.tuples(st.just("square"), st.floats(0.8, 12)),
    st.tuples(st.just("slot"), st.floats(0.8, 12)),
)


def drawn(shape: str, mm: float, x: float, y: float) -> object:
    """A hole of that width about a point."""
    if shape == "circle":
        return circle(x, y, mm / 2)
    return rect(x - mm / 2, y - mm / 2, mm if shape == "square" else 3 * mm, mm)


@st.composite
def tight(draw: st.DrawFn) -> tuple[list[dict[str, object]], dict[str, Section]]:
    """A plate of small holes, often with a part in a frame that fits closely, and a profile of some strictness."""
    holes = [drawn(*draw(shapes), 45 + 50 * k, 45) for k in range(draw(st.integers(1, 5)))]
    parts: list[dict[str, object]] = [{"id": "P1", "outer": rect(20, 20, 320, 60), "holes": holes}]
    if draw(st.booleans()):
        gap = draw(st.floats(1.6, 6))
        parts.append({"id": "H", "outer": rect(20, 120, 120, 120), "holes": [rect(35, 135, 90, 90)]})
        parts.append({"id": "G", "outer": rect(35 + gap, 135 + gap, 90 - 2 * gap, 90 - 2 * gap)})
    holes_section: Section = {"min_hole": draw(st.sampled_from(["0 mm", "2 mm", "1 × thickness"]))}
    clearance = draw(st.sampled_from([1.0, 1.5, 2.5]))
    leads: Section = {
        "lead_in_min": f"{draw(st.sampled_from([0.3, 0.5, 2.0]))} mm", "lead": draw(st.sampled_from(["line", "arc"]))
    }  # fmt: skip
    return parts, {"small_holes": holes_section, "leads": leads, "rules": {"pierce": {"clearance": f"{clearance} mm"}}}


def named(line: str) -> set[str]:
    """The contours that a line of a refusal is about, as far as it names them."""
    listed = re.match(r"  - \d+ (?:holes|contours) \(([^)]*)\)", line)
    return set(re.findall(r"\w+\.(?:hole\d+|outer)", listed[1] if listed else line)[: None if listed else 1])


def too_small(text: str) -> int:
    """How many holes a question says are too small."""
    counted = re.search(r"(\d+) holes? (?:is|are) too small", text)
    return int(counted[1]) if counted else 0


def refused(nest: Path, profile: Path) -> str | None:
    """Why a nest cannot be cut by a profile, None if it can."""
    plant = load_profile(profile)
    try:
        package.facts(read_nest(nest, plant), plant)
    except InputError as error:
        return str(error)
    return None


@pytest.mark.slow
@examples(15, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(tight())
def test_every_option_that_is_said_to_free_all_does(
    tmp_path: Path, made: tuple[list[dict[str, object]], dict[str, Section]]
) -> None:
    parts, sections = made
    nest, profile = written(tmp_path, parts), plant(tmp_path, **sections)
    message = refused(nest, profile)
    if message is None:
        return
    head, *lines = message.splitlines()
    said = head if "frees all of them" in head else lines[0] if len(lines) == 1 else ""
    for advice in re.findall(r"`([^`]+)`", said):
        assert refused(nest, advised(profile, advice)) is None, advice


@pytest.mark.slow
@examples(8, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(tight())
def test_every_option_that_is_said_to_free_a_group_leaves_others_only(
    tmp_path: Path, made: tuple[list[dict[str, object]], dict[str, Section]]
) -> None:
    parts, sections = made
    nest, profile = written(tmp_path, parts), plant(tmp_path, **sections)
    message = refused(nest, profile)
    if message is None or len(message.splitlines()) < 3:
        return
    for line in message.splitlines()[1:]:
        for advice in re.findall(r"`([^`]+)`", line):
            left = refused(nest, advised(profile, advice)) or ""
            if "would have some of them cut" in line:
                assert too_small(left) < too_small(line), (advice, left)
                continue
            assert not named(line) & {name for other in left.splitlines()[1:] for name in named(other)}, (advice, left)


@pytest.mark.slow
@pytest.mark.parametrize("advice", ["rules.pierce.clearance: 1.48 mm", "small_holes.under: skip"])
def test_a_nest_solves_after_the_advice(advice: str, tmp_path: Path) -> None:
    nest = written(tmp_path, perforated(2.96, count=6))
    profile = advised(plant(tmp_path, small_holes={"min_hole": "2 mm"}), advice)
    assert kerfwise("solve", nest, "-p", profile, "-o", tmp_path / "out.nc", "--work", 1).code == 0
