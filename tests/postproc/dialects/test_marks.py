"""What marks: by little power, by another pen, or by the words of a plant where nobody has published any."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
import yaml

from kerfwise.tests.commands.run_cli import kerfwise

NEST = {
    "format": "kerfwise-nest/1", "units": "mm", "sheet": {"width": 400, "height": 200},
    "parts": [
        {"id": "A", "outer": [[30, 30], [150, 30], [150, 120], [30, 120]], "marks": [[[40, 40], [60, 40]]]},
        {"id": "B", "outer": [[200, 30], [320, 30], [320, 120], [200, 120]], "marks": [[[220, 50], [240, 50]]]},
    ],
}  # fmt: skip
pytestmark = pytest.mark.scrap("the simulation of the metal reads words of LinuxCNC only")
WITHOUT = [
    line.split()[0]
    for line in kerfwise("dialects").out.splitlines()
    if line[:1].isalpha() and line.endswith("; marks no")
]
PLASMA = "based_on: plasma-carbon-steel\nmachine: {dialect: NAME}\n"
LASER = "based_on: laser-st10kp-2mm\nmachine: {dialect: NAME, accept_dialect: true}\n"


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("nest.json").write_text(json.dumps(NEST))


def solved(dialect: str, profile: str = PLASMA) -> str:
    """The program in a dialect, found good by the check."""
    Path("plant.yaml").write_text(profile.replace("NAME", dialect))
    words = ("nest.json", "-p", "plant.yaml", "-o", "a.nc", "--plan", "a.json", "--work", 0.1)
    ended = kerfwise("solve", *words)
    assert ended.code == 0, ended.err
    assert kerfwise("check", "nest.json", "a.nc", "-p", "plant.yaml", "--plan", "a.json").code == 0
    return Path("a.nc").read_text()


def says(damaged: str) -> str:
    """What the check has against a program in the place of the last one."""
    Path("b.nc").write_text(damaged)
    ended = kerfwise("check", "nest.json", "b.nc", "-p", "plant.yaml", "--plan", "a.json")
    assert ended.code != 0
    return ended.out + ended.err


def test_there_are_few_that_have_none() -> None:
    assert WITHOUT == ["burny", "fanuc", "mach", "sinumerik"]


@pytest.mark.parametrize("name", WITHOUT)
def test_who_has_no_words_says_why_and_a_copy_that_states_them_marks(name: str) -> None:
    Path("plant.yaml").write_text(
        f"based_on: plasma-carbon-steel\nmachine: {{dialect: {name}, accept_dialect: true}}\n"
    )
    refused = kerfwise("solve", "nest.json", "-p", "plant.yaml", "-o", "a.nc")
    assert refused.code == 2
    why = str(yaml.safe_load(kerfwise("dialects", "show", name).out)["no_marking"])
    assert why.split(":")[0] in refused.err
    on, off, means = re.search(r"mark_on: (.*), mark_off: (.*), reads: (\{.*\}\})\)", refused.err).groups()  # type: ignore[union-attr]
    copy = yaml.safe_load(kerfwise("dialects", "show", name).out) | {"name": "mine", "mark_on": on, "mark_off": off}
    copy.pop("builders_choice", None)
    reads = copy.setdefault("reads", {})
    reads["means"] = {**reads.get("means", {}), **yaml.safe_load(means)["means"]}
    Path("mine.yaml").write_text(yaml.safe_dump(copy, sort_keys=False))
    text = solved("mine.yaml")
    assert len(re.findall(rf"^(?:N\d+ )?{on}$", text, re.MULTILINE)) == 2
    assert "tool" in says(re.sub(rf"^(?:N\d+ )?{off}\n", "", text, count=1, flags=re.MULTILINE))


def test_marlins_beam_marks_with_little_power() -> None:
    text = solved("marlin", LASER)
    assert [int(power) for power in re.findall(r"^M3 S(\d+)$", text, re.MULTILINE)] == [50, 50, 255, 255]
    assert "marks with S60" in says(text.replace("M3 S50", "M3 S60", 1))
    assert "A.mark1" in says(text.replace("M3 S50", "M3 S255", 1))
    assert "every-contour-once" in says(text.replace("M3 S255", "M3 S50", 1))


def test_hpgls_second_pen_marks() -> None:
    text = solved("hpgl", LASER)
    assert re.findall(r"^SP\d;$", text, re.MULTILINE) == ["SP2;", "SP1;", "SP0;"]
    assert "A.mark1" in says(text.replace("SP2;\n", "SP1;\n", 1))
    assert "every-contour-once" in says(text.replace("SP1;\n", "", 1))
