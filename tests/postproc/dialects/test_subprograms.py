"""Paths of copies are written once, as subprograms: LinuxCNC calls them, and the check reads them back."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.dialects import Dialect, load_dialect
from kerfwise.postproc.dialects.dialect import Subprogram
from kerfwise.postproc.dialects.load import new_dialect_text
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_program, held_to_plan
from kerfwise.postproc.verdict.dialect_read_back import trusted_dialect
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.options.yaml_positions import with_value
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.postproc.dialects import reading
from kerfwise.tests.postproc.plans import cut_of, plan_of, profile

PITCH_MM = 81.2345
"""Copies that lie no whole number of steps apart."""


def copies() -> Nest:
    """Six plates with a hole, and one that is alone."""
    made = [
        part(f"A{k}", rect(20 + PITCH_MM * k, 20.00005, 60, 50), [circle(50 + PITCH_MM * k, 45, 12)]) for k in range(6)
    ]
    return nest(540, 160, *made, part("B", rect(20, 90, 80, 50)))


def shop(folder: Path, like: str, **more: str) -> Profile:
    """A machine whose dialect writes subprograms."""
    text = new_dialect_text("shop", like)
    for key, value in {"subprogram": "{first: 101}", **more}.items():
        text = with_value(text, [key], value)
    (folder / "shop.yaml").write_text(text)
    made = reading.with_dialect(profile(), str(folder / "shop.yaml"))
    trusted_dialect(made)
    return made


def planned(plant: Profile) -> tuple[Plan, Nest, str]:
    drawn = copies()
    order = sorted(drawn.contours, key=lambda contour: (contour.id[0], contour.id[1], contour.kind == "outer"))
    cuts = [cut_of(contour, 0.1, "cw" if contour.kind == "outer" else "ccw") for contour in order]
    plan = plan_of(drawn, cuts, plant)
    return plan, drawn, write_program(plan, drawn, plant)


def plain(dialect: Dialect) -> Dialect:
    return dataclasses.replace(dialect, subprogram=None)


@pytest.mark.linuxcnc
@pytest.mark.parametrize(
    "more",
    [{}, {"modal": "true"}, {"arc_centre": "radius"}, {"decimals": "3"}, {"newline": "crlf"}],
    ids=lambda more: " ".join(more) or "as it is",
)
def test_linuxcnc_and_the_check_make_the_same_of_it(more: dict[str, str], tmp_path: Path) -> None:
    plant = shop(tmp_path, "linuxcnc", **more)
    plan, drawn, text = planned(plant)
    dialect = load_dialect(plant.machine.dialect)
    assert len(re.findall(r"M98 P", text)) == 12
    assert re.findall(r"^O(\d+)", text, re.MULTILINE) == ["101", "102"]
    assert len(text) < 0.7 * len(write_program(plan, drawn, plant, plain(dialect)))
    for heard in (reading.of_linuxcnc(text, "linuxcnc"), reading.of_check(text, drawn, plant)):
        found = reading.differences(plan, drawn, plant, heard)
        assert found.within(0.005 + 2 * dialect.step_mm, 0.2), found
    result = check_program(drawn, text, plant, plan=plan)
    assert not held_to_plan(result, drawn, text, plan, plant).broken()


def test_what_is_wrong_in_a_subprogram_is_told_with_its_line(tmp_path: Path) -> None:
    plant = shop(tmp_path, "linuxcnc")
    plan, drawn, text = planned(plant)
    bent = re.sub(r"(O101\n(?:.*\n)*?.*G3 X)(-?\d)", lambda m: f"{m[1]}9{m[2]}", text, count=1)
    assert bent != text
    with pytest.raises(InputError) as caught:
        check_program(drawn, bent, plant)
    line = bent.split("\n")[(caught.value.line or 0) - 1]
    assert "G3 X9" in line
    called = re.sub(r"M98 P102", "M98 P101", text, count=1)
    assert check_program(drawn, called, plant, plan=plan).broken()


def test_fanuc_writes_them_behind_its_end_and_within_its_frame(tmp_path: Path) -> None:
    plant = reading.with_dialect(profile(), "fanuc")
    plan, drawn, text = planned(plant)
    rows = [re.sub(r"^N\d+ ", "", row) for row in text.strip().split("\n")]
    assert (rows[0], rows[1], rows[-1], rows[-2]) == ("%", "O1000", "%", "M99")
    assert rows.index("M30") < rows.index("O9001") < rows.index("O9002")
    assert "O1000" in text.split("\n")
    assert not check_program(drawn, text, plant, plan=plan).broken()


def test_a_word_that_calls_nothing_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"subprogram: a path that is called"):
        shop(tmp_path, "linuxcnc", subprogram='{call: "M98 P{sub}", begin: "O1{sub}"}')
    with pytest.raises(InputError, match=r"subprogram: a path that is called"):
        shop(tmp_path, "linuxcnc", subprogram="{stepwise: G90, from_zero: G91}")
    with pytest.raises(InputError, match="counts from where it begins"):
        shop(tmp_path, "burny", subprogram="{}")
    assert Subprogram().call == "M98 P{sub}"
