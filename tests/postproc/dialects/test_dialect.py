"""Dialects are data: every shipped file loads, and a damaged one is answered with its line."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import jsonschema
import pytest
import yaml

from kerfwise import InputError
from kerfwise.postproc import dialects
from kerfwise.postproc.check.reader.controls import CONTROLS
from kerfwise.postproc.dialects import ControlName, LineNumbers, dialect_names, dialect_text, load_dialect
from kerfwise.postproc.dialects.load import schema_text
from kerfwise.rules.options.option import options_of
from kerfwise.rules.profile.plant_sections import DialectName, Machine

FOLDER = Path(dialects.__file__).parent


@pytest.mark.parametrize("name", dialect_names())
def test_every_shipped_dialect_loads_under_its_own_name(name: str) -> None:
    assert load_dialect(name).name == name


def test_qtplasmac_as_documented() -> None:
    dialect = load_dialect("linuxcnc-qtplasmac")
    assert (dialect.torch_on, dialect.torch_off, dialect.mark_on) == (("M3 $0 S1",), ("M5 $0",), ("M3 $1 S1",))
    assert dialect.line_numbers == LineNumbers(10, 10)
    assert dialect.max_line == 250
    assert dialect.footer[-1] == "M2"


def test_unknown_name_is_answered_with_the_nearest() -> None:
    with pytest.raises(InputError, match="unknown dialect 'linuxcnc-plasmac': did you mean 'linuxcnc-qtplasmac'"):
        load_dialect("linuxcnc-plasmac")


def shop(tmp_path: Path, old: str, new: str) -> str:
    text = (FOLDER / "linuxcnc-qtplasmac.yaml").read_text()
    assert old in text
    (tmp_path / "shop.yaml").write_text(text.replace(old, new))
    return str(tmp_path / "shop.yaml")


def test_a_plant_brings_its_own(tmp_path: Path) -> None:
    file = shop(tmp_path, "{start: 10, step: 10}", "null")
    assert load_dialect(file).line_numbers is None


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("torch_on: M3", "torchon: M3", r"shop.yaml:\d+:1: unknown key 'torchon': did you mean 'torch_on'"),
        ("dwell: G4 P{seconds}\n", "", "lacks dwell$"),
        ("decimals: 4", "decimals: four", r":39:11: decimals: expected a whole number from 0 to 6, got 'four'"),
        ("decimals: 4", "decimals: yes", "expected a whole number from 0 to 6, got 'yes'"),
        ("pierce_dwell: machine", "pierce_dwell: never", "pierce_dwell: expected one of machine, program, got 'never'"),
        (
            "{start: 10, step: 10}",
            "{start: 10}",
            r"line_numbers: expected \{start: 10, step: 10\}, with highest: 9999 .*",
        ),
        (
            "processes: [plasma]",
            "processes: [lasers]",
            "processes: expected a list of plasma, oxyfuel, laser, water-jet",
        ),
        ("processes: [plasma]", "processes: [[plasma]]", "processes: expected a list of plasma"),
        ("decimals: 4", "decimals: !!int x", r":39:11: decimals: expected a whole number from 0 to 6"),
        ("decimals: 4", "decimals: 2001-99-99", r":39:11: decimals: expected a whole number from 0 to 6"),
        (
            "control: linuxcnc-qtplasmac",
            "control: cnc",
            "control: expected one of linuxcnc-qtplasmac, linuxcnc, grbl, eia, burny, essi, essi-radius, got 'cnc'",
        ),
        (
            "  marks:",
            "  mark:",
            "assumes: expected lists of comments under plasma, oxyfuel, laser, water-jet, marks, torches, bevels or b",
        ),
        (
            "mark_off: M5 $1",
            "mark_off: M5 $1\ntorch_select: M64 P{output}",
            "torch_select and torch_deselect: expected",
        ),
        ("feed: F{mm_min}", "feed: F{inch_min}", r"feed: expected one \{mm_min\}"),
        ("feed: F{mm_min}", "feed: F{mm_min:.0f}", r"feed: expected one \{mm_min\} or .*, and no other brace"),
        (
            "dwell: G4 P{seconds}",
            "dwell: G4 P{seconds!r}",
            r"dwell: expected a line of text, with no braces but \{seconds\}, \{milliseconds\}",
        ),
        ("comment: ({text})", "comment: '({text}) {'", r"comment: expected one \{text\}, and no other brace"),
        ("comment: ({text})", "comment: '({text.__class__})'", r"comment: expected one \{text\}, and no other brace"),
        ("decimals: 4", "decimals: 30", r":\d+:11: decimals: expected a whole number from 0 to 6, got '30'"),
        ("torch_off: M5 $0", 'torch_off: "M5 $0\\nM3 $0 S1"', r"torch_off: expected one line of text"),
        ("torch_off: M5 $0", "torch_off: []", r"torch_off: expected a block or a list of one or more blocks, each"),
        ("torch_on: M3 $0 S1", "torch_on: [M3 $0 S1, {dwell: 1}]", r"torch_on: expected a line of text"),
        ("mark_off: M5 $1", "mark_off: null", "mark_on and mark_off: expected blocks for both, or null for both"),
        ("max_line: 250", "max_line: 20", "max_line: expected a whole number from 80 to 252, got '20'"),
        ("  - G21", "  - [", "not YAML"),
    ],
)
def test_a_damaged_file_is_answered_with_its_line(tmp_path: Path, old: str, new: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        load_dialect(shop(tmp_path, old, new))


def test_no_file_and_no_dialect(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot read the dialect: No such file"):
        load_dialect(str(tmp_path / "none.yaml"))
    (tmp_path / "list.yaml").write_text("- a\n")
    with pytest.raises(InputError, match="not a dialect"):
        load_dialect(str(tmp_path / "list.yaml"))


def test_dialects_may_name_each_control_that_the_check_reads() -> None:
    missing, unread = set(CONTROLS) - set(get_args(ControlName)), set(get_args(ControlName)) - set(CONTROLS)
    assert not missing, f"postproc/dialects/dialect.py, ControlName: {missing}"
    assert not unread, f"postproc/check/reader/controls.py, CONTROLS: {unread}"


def test_profiles_may_name_each_dialect() -> None:
    (kind,) = (option.kind for option in options_of(Machine) if option.name == "dialect")
    assert isinstance(kind, DialectName)
    missing, gone = set(dialect_names()) - set(kind.words), set(kind.words) - set(dialect_names())
    assert not missing, f"rules/profile/plant_sections.py, Machine.dialect: {missing}"
    assert not gone, f"rules/profile/plant_sections.py names what postproc/dialects has not: {gone}"


@pytest.mark.parametrize("name", dialect_names())
def test_the_published_schema_takes_each_dialect(name: str) -> None:
    jsonschema.Draft202012Validator(yaml.safe_load(schema_text())).validate(yaml.safe_load(dialect_text(name)))


def test_the_published_schema_is_up_to_date() -> None:
    published = FOLDER / "dialect.schema.json"
    assert published.read_text(encoding="utf-8") == schema_text(), "run python -m kerfwise.postproc.dialects.load"
