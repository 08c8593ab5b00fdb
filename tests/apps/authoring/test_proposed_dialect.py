"""A dialect is told from programs that were written in another: what it writes is what they hold."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

import pytest

from kerfwise.apps.authoring.proposed_dialect import propose_dialect, try_proposal
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.dialects import load_dialect
from kerfwise.postproc.dialects.load import new_dialect_text, parse_dialect
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.dialect_read_back import read_back
from kerfwise.rules.options.yaml_positions import with_value
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.postproc.dialects import reading
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile

CASES: dict[str, tuple[str, dict[str, str]]] = {
    "linuxcnc": ("linuxcnc", {}),
    "qtplasmac": ("linuxcnc-qtplasmac", {}),
    "eia": ("eia", {}),
    "line ends of Windows": ("eia", {"newline": "crlf"}),
    "inches": ("eia", {"header": "[G20, G90, G40]", "units": "inch"}),
    "modal words": ("eia", {"modal": "true"}),
    "modal motion": ("linuxcnc", {"modal": "[motion]"}),
    "a frame and a number": (
        "linuxcnc",
        {
            "header": "['%', 'O{program}', G21, G64 P0.05, G90 G17 G40 G49 G80 G91.1 G94]",
            "program": "{number: 12, digits: 4}",
        },
    ),
    "process words": ("eia", {"header": "[G21, G90, G40, G59 V502 F34]"}),
    "an output": ("linuxcnc", {"torch_on": "[M62 P3, M3 S1, '{dwell}', M63 P3]", "also": "['M62 P3', 'M63 P3']"}),
    "a rest": ("linuxcnc", {"torch_off": "[M5, G4 P0.6]"}),
    "a comma": ("eia", {"decimal": "','"}),
    "all decimals": ("eia", {"trailing_zeros": "true", "decimals": "3"}),
    "points": ("eia", {"whole_point": "true", "feed_decimals": "0"}),
    "no blanks": ("eia", {"blanks": "false"}),
    "other numbers": ("eia", {"line_numbers": "{start: 5, step: 5, highest: 95}"}),
    "no numbers": ("eia", {"line_numbers": "null"}),
    "radii": ("eia", {"arc_centre": "radius"}),
    "absolute centres": (
        "linuxcnc",
        {"arc_centre": "absolute", "header": "[G21, G64 P0.05, G90 G17 G40 G49 G80 G90.1 G94]"},
    ),
    "semicolons": ("eia", {"comment": "'; {text}'"}),
    "kerf by the control": ("eia", {"kerf": "control"}),
    "kerf by a word": ("linuxcnc", {"kerf": '{left: "G41.1 D{kerf}", right: "G42.1 D{kerf}"}'}),
}


def programs(like: str, changes: dict[str, str]) -> tuple[list[str], Nest, Profile]:
    """Two programs of unmarked parts in a dialect: all parts, and two of them."""
    text = new_dialect_text("shop", like)
    for key, value in changes.items():
        text = with_value(text, [key], value)
    dialect, plant = parse_dialect(text, "shop.yaml"), reading.with_dialect(profile(), like)
    bare = dataclasses.replace(plate(), parts=tuple(dataclasses.replace(part, marks=()) for part in plate().parts))
    fewer = dataclasses.replace(bare, parts=bare.parts[:2])
    made = []
    for nest in (bare, fewer):
        cuts = [cut for cut in good_cuts(plate()) if cut.contour in nest.index]
        made.append(write_program(plan_of(nest, cuts, plant), nest, plant, dialect))
    return made, bare, plant


def blocks(text: str) -> list[str]:
    """Its rows without comments."""
    return [row for row in text.replace("\r", "").split("\n") if not re.match(r"[(;]", row)]


@pytest.mark.parametrize("name", CASES)
def test_what_is_told_writes_the_same_program(name: str) -> None:
    like, changes = CASES[name]
    olds, nest, plant = programs(like, changes)
    told = try_proposal(propose_dialect(olds), "told", ["a.nc", "b.nc"])
    assert "does not read it back" not in told, told
    dialect = parse_dialect(told, "told.yaml")
    read_back(dialect, "told")
    cuts = [cut for cut in good_cuts(plate()) if cut.contour in nest.index]
    again = write_program(plan_of(nest, cuts, plant), nest, plant, dialect)
    assert ("\r\n" in again) == ("\r\n" in olds[0])
    assert blocks(again) == blocks(olds[0])


def test_what_could_not_be_told_is_said() -> None:
    olds, *_ = programs("eia", {})
    made = propose_dialect([olds[0].replace("G21", "").replace(" M07\n", " M77\nN9 M07\n", 3)])
    assert [text for text in made.unsure if "starts are otherwise (M77 / M07)" in text]
    assert [text for text in made.unsure if "do not say their units" in text]


def test_a_program_without_travel_tells_nothing() -> None:
    with pytest.raises(InputError, match="nothing can be told"):
        propose_dialect(["71\n81\n+100+50\n0\n"])


def test_the_command_writes_it_and_says_what_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name, text in zip("ab", programs("eia", {})[0], strict=True):
        Path(f"{name}.nc").write_text(text)
    ended = kerfwise("dialects", "new", "shop", "--from", "a.nc", "b.nc")
    assert (ended.code, load_dialect("shop.yaml").control) == (0, "eia")
    assert "Told from a.nc and b.nc" in ended.out
    assert "nothing is marked in these programs" in ended.out
    Path("plant.yaml").write_text("based_on: plasma-carbon-steel\nmachine: {dialect: shop.yaml}\n")
    assert kerfwise("profile", "check", "plant.yaml").code == 0
    assert kerfwise("dialects", "new", "other").code == 2
    assert kerfwise("dialects", "new", "other", "--from", "none.nc").code == 2
