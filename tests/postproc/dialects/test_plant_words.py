"""What plants change in a shipped dialect: each is planned, written, read back by the check and by LinuxCNC."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.check.reader.own_words import control_for
from kerfwise.postproc.check.reader.rs274 import read_nc
from kerfwise.postproc.dialects import load_dialect
from kerfwise.postproc.dialects.load import new_dialect_text
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.postproc.verdict.dialect_read_back import trusted_dialect
from kerfwise.rules.options.yaml_positions import with_value
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.postproc.dialects import reading
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate

CASES: dict[str, tuple[str, dict[str, str]]] = {
    "line ends of Windows": ("eia", {"newline": "crlf"}),
    "line ends of Windows, GRBL": ("grbl", {"newline": "crlf"}),
    "process words": ("eia", {"header": "[G21, G90, G40, G59 V502 F34, G59 V503 F1.08]"}),
    "inches by the scale": ("eia", {"header": "[G20, G90, G40]", "scale": "0.0393700787"}),
    "inches": ("linuxcnc", {"header": "[G20, G64 P0.0019, G90 G17 G40 G49 G80 G91.1 G94]", "units": "inch"}),
    "inches, the feed too": (
        "eia",
        {"header": "[G20, G90, G40]", "units": "inch", "feed": "F{in_min}", "decimals": "5"},
    ),
    "an analogue power": ("linuxcnc", {"torch_on": "[M67 E0 Q100, M3 S1, '{dwell}']"}),
    "an analogue power of the marks": ("linuxcnc", {"mark_on": "[M68 E1 Q20, M64 P0]"}),
    "a halt for the operator": ("linuxcnc", {"torch_on": "[M3 S1, M0]"}),
    "words that change": ("eia", {"modal": "true"}),
    "words that change, LinuxCNC": ("linuxcnc", {"modal": "true"}),
    "motion words that change": ("grbl", {"modal": "[motion]"}),
    "a frame": ("eia", {"header": "['%', G21, G90, G40]", "footer": "[M02]"}),
    "a frame at both ends": (
        "linuxcnc",
        {"header": "['%', G21, G64 P0.05, G90 G17 G40 G49 G80 G91.1 G94]", "footer": "[M5, '%']"},
    ),
    "a number of its own": ("eia", {"header": "['%', O1234, G21, G90, G40]"}),
    "a halt where a mark starts": ("eia", {"mark_on": "[M09, M00]", "torch_on": "[M01, M07]"}),
    "a material": (
        "linuxcnc-qtplasmac",
        {
            "header": "[G21, M190 P1, M66 P3 L3 Q1, G64 P0.05, G90 G17 G40 G49 G80 G91.1 G94, M68 E3 Q0]",
            "also": "['M190 P{n}', M66 P3 L3 Q1]",
        },
    ),
    "inches, GRBL": (
        "grbl",
        {"header": "[G20, G90 G17 G40 G49 G80 G94, M5 S0]", "scale": "0.0393700787", "decimals": "5"},
    ),
    "words that change, QtPlasmaC": ("linuxcnc-qtplasmac", {"modal": "true"}),
    "words that change, GRBL": ("grbl", {"modal": "true"}),
    "a number": (
        "linuxcnc",
        {
            "header": "['O{program}', G21, G64 P0.05, G90 G17 G40 G49 G80 G91.1 G94]",
            "program": "{number: 12, digits: 4}",
        },
    ),
    "a marker that is off": ("eia", {"torch_on": "[M14, M07]"}),
    "a preheat": ("eia", {"torch_on": "[M14, G04 X0.3, M07]"}),
    "words besides": ("eia", {"torch_on": "[M02 T1, M07 HS]", "also": "[M02 T1]"}),
    "outputs around a cut": (
        "linuxcnc",
        {
            "torch_on": "[M62 P3, M3 S1, '{dwell}', M63 P3, M100 P2.5]",
            "also": "['M62 P{n}', M63 P3, {words: 'M100 P{n}', where: on}]",
        },
    ),
    "outputs around holes and marks": (
        "linuxcnc",
        {
            "around": "{hole: {before: M64 P5}, outer: {after: [M65 P5, M66 P1 L0]}, mark: {before: M190 P2}}",
            "also": "['M64 P5', 'M65 P5', M66 P1 L0, M190 P2]",
        },
    ),
    "messages and halts": (
        "linuxcnc",
        {"around": "{outer: {before: ['(MSG, NOW THE OUTLINES)', M0]}, hole: {before: '(MSG, A HOLE)', after: M1}}"},
    ),
    "chords for arcs": ("linuxcnc", {"arc_centre": "none", "chord": "0.005 mm"}),
    "whole numbers with a point": ("eia", {"whole_point": "true"}),
    "all their decimals": ("eia", {"trailing_zeros": "true", "decimals": "3"}),
    "padded digits": ("eia", {"whole_digits": "4"}),
    "two decimals": ("eia", {"decimals": "2", "trailing_zeros": "true"}),
    "a decimal comma": ("eia", {"decimal": "','"}),
    "no blanks": ("linuxcnc", {"blanks": "false"}),
    "numbers that start again": ("eia", {"line_numbers": "{start: 5, step: 5, highest: 60}"}),
    "arcs by radius": ("eia", {"arc_centre": "radius"}),
    "arcs of less than 100 mm": ("eia", {"greatest_radius": "5 mm"}),
    "comments behind a star": ("eia", {"comment": "'* {text}'"}),
    "comments behind a semicolon": ("eia", {"comment": "'; {text}'"}),
    "travel at a feed": ("linuxcnc", {"rapid": "'G1 F6000 X{x} Y{y}'"}),
    "torch words of its own": (
        "eia",
        {"torch_on": "M70", "torch_off": "M71", "reads": "{title: Umbra 7, means: {M70: M07, M71: M08}}"},
    ),
    "waits in milliseconds": ("linuxcnc", {"dwell": "G4 P{milliseconds}", "reads": "{dwell: {letter: P, unit: ms}}"}),
    "hundredths": ("eia", {"scale": "100", "decimals": "0", "reads": "{step: 0.01}", "feed_decimals": "0"}),
}


_RULES = """\
rules: {heat-lag: off, no-narrow-strips: off, no-tip-travel: off, part-rigidity: off, start-side: off, pierce: off}
"""
"""Plans that are made by hand have none of these in mind."""


def shop(folder: Path, like: str, changes: dict[str, str]) -> Profile:
    """A profile whose machine has the dialect `like` with other values."""
    text = new_dialect_text("shop", like)
    for key, value in changes.items():
        text = with_value(text, [key], value)
    (folder / "shop.yaml").write_text(text)
    process = load_dialect(like).processes[0]
    base = "laser-wood" if process == "laser" else "plasma-carbon-steel"
    (folder / "plant.yaml").write_text(
        f"based_on: {base}\nmachine: {{dialect: shop.yaml, cut_feed: 2500 mm/min, mark_feed: 3000 mm/min}}\n{_RULES}"
    )
    return load_profile(folder / "plant.yaml")


def in_words_of_linuxcnc(text: str, like: str, changes: dict[str, str]) -> str:
    """The program with the plant's words put back into those that LinuxCNC knows; lengths and arcs stay as they are."""
    rows = text.replace("\r\n", "\n")
    if "decimal" in changes:
        rows = re.sub(r"(?<=[0-9]),(?=[0-9])", ".", rows)
    if "comment" in changes:
        rows = re.sub(r"^[*].*$", "", rows, flags=re.MULTILINE)
    if changes.get("blanks") == "false":
        rows = re.sub(r"^(N\d+)", r"\1 ", rows, flags=re.MULTILINE)
    if "step" in changes.get("reads", ""):
        rows = re.sub(r"(?<![A-Z(])([XYIJ])(-?\d+)(?=[ \n])", lambda m: f"{m[1]}{int(m[2]) / 100:.2f}", rows)
    for own, known in (("M70", "M07"), ("M71", "M08"), ("M07 HS", "M07")):
        rows = rows.replace(f" {own}\n", f" {known}\n")
    rows = re.sub(
        r"^N\d+ (?:G59 V.*|M02 T1|M14|M6[236] P.*|M6[45] P5|M1[09]0 P.*|M66 .*|M0|M1|M00|M01)$",
        "",
        rows,
        flags=re.MULTILINE,
    )
    if "milliseconds" in changes.get("dwell", ""):
        rows = re.sub(r"G4 P(\d+)", lambda m: f"G4 P{int(m[1]) / 1000}", rows)
    return rows if like.startswith("linuxcnc") else rows.removeprefix("%\n").replace("O1234\n", "")


@pytest.mark.linuxcnc
@pytest.mark.parametrize("name", CASES)
def test_what_a_plant_changes_is_written_and_read_by_others(name: str, tmp_path: Path) -> None:
    like, changes = CASES[name]
    profile = shop(tmp_path, like, changes)
    dialect, nest = trusted_dialect(profile), plate()
    plan = plan_of(nest, good_cuts(nest), profile)
    text = write_program(plan, nest, profile)
    near_mm = 0.01 + dialect.step_mm
    for heard in (
        reading.of_check(text, nest, profile),
        reading.of_linuxcnc(in_words_of_linuxcnc(text, like, changes), dialect.control, tabs="rapid" in changes),
    ):
        found = reading.differences(plan, nest, profile, heard)
        if "rapid" in changes:  # it is no idle travel to rs274
            found = dataclasses.replace(found, idle_mm=0.0)
        assert found.within(near_mm, 0.1 + 20 * dialect.step_mm), found
    assert not (result := check_program(nest, text, profile)).broken(), str(result)


def test_a_word_of_the_control_is_not_harmless(tmp_path: Path) -> None:
    for word, why in {
        "M07": "has a meaning of its own", "M2": "ends the program", "G91": "has a meaning", "G1 X{n}": "names a place",
        "F{n}": "has a meaning of its own",
    }.items():  # fmt: skip
        with pytest.raises(InputError, match=why) as error:
            trusted_dialect(shop(tmp_path, "eia", {"also": f"['{word}']"}))
        assert error.value.file == str(tmp_path / "shop.yaml")
        assert error.value.line is not None


def test_numbers_of_essi_may_be_harmless_too(tmp_path: Path) -> None:
    unmarked = dataclasses.replace(plate(), parts=tuple(dataclasses.replace(p, marks=()) for p in plate().parts))
    profile = shop(tmp_path, "essi", {"torch_on": "[6, '225+40', 53]", "also": "['225+{n}']"})
    trusted_dialect(profile)
    plan = plan_of(unmarked, [cut for cut in good_cuts(plate()) if cut.contour in unmarked.index], profile)
    text = write_program(plan, unmarked, profile)
    assert text.count("225+40\n") == len(plan.cuts)
    assert not check_program(unmarked, text, profile, plan=plan).broken()
    with pytest.raises(InputError, match="225"):
        trusted_dialect(shop(tmp_path, "essi", {"torch_on": "[6, '225+40', 53]"}))
    for word in ("53", "39+{n}", "+100+100"):
        with pytest.raises(InputError, match="also: "):
            trusted_dialect(shop(tmp_path, "essi", {"also": f"['{word}']"}))


def test_a_word_where_it_may_not_stand_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="may only stand before the first cut"):
        trusted_dialect(shop(tmp_path, "eia", {"torch_off": "[M08, M210]", "also": "[{words: M210, where: header}]"}))
    with pytest.raises(InputError, match="may only stand with the torch on"):
        trusted_dialect(shop(tmp_path, "eia", {"torch_on": "[M210, M07]", "also": "[{words: M210, where: on}]"}))


def test_an_unknown_word_is_told_with_what_settles_it(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"torch_on: 'M210' cannot be read: .* is named under also"):
        trusted_dialect(shop(tmp_path, "eia", {"torch_on": "[M210, M07]"}))


def test_a_halt_in_the_middle_of_a_cut_stays_a_fault(tmp_path: Path) -> None:
    control = control_for(trusted_dialect(shop(tmp_path, "linuxcnc", {"torch_on": "[M3 S1, M0]"})))
    assert control.halts_lit
    head = "G21\nG64 P0.05\nG90 G17 G40 G49 G80 G91.1 G94\nG0 X1 Y1\nM3 S1\n"
    assert read_nc(f"{head}M0\nG1 X9 F600\nM5\nM2\n", control=control).faults == ()
    (fault,) = read_nc(f"{head}G1 X9 F600\nM0\nG1 X20\nM5\nM2\n", control=control).faults
    assert "M0 halts" in fault.text


def test_the_scale_says_what_is_a_cut(tmp_path: Path) -> None:
    changes = {"powers": "{cut: 90, pierce: 100, mark: 20, full: 100}"}
    profile = shop(tmp_path, "grbl", changes)
    nest = plate()
    plan = plan_of(nest, good_cuts(nest), profile)
    assert "M4 S90" in (text := write_program(plan, nest, profile))
    assert not check_program(nest, text, profile).broken()


def test_a_dialect_stands_beside_its_profile(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert trusted_dialect(shop(tmp_path, "eia", {"newline": "crlf"})).newline == "crlf"


def test_a_preheat_longer_than_the_pierce_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"pierce_time: it is 0\.5 s, and the dialect 'shop' waits 30 s by itself"):
        trusted_dialect(shop(tmp_path, "eia", {"torch_on": "[G04 X30, M07]"}))


def test_what_the_chart_says_is_written(tmp_path: Path) -> None:
    profile = shop(tmp_path, "eia", {"header": "[G21, G90, G40, '{process}', 'G43 X{kerf}']", "also": "['G43 X{n}']"})
    with pytest.raises(InputError, match=r"material.process: the dialect 'shop' writes it \(header: \{process\}\)"):
        trusted_dialect(profile)


def test_the_rows_words_are_written(tmp_path: Path) -> None:
    shop(tmp_path, "eia", {"header": "[G21, G90, G40, '{process}']"})
    (tmp_path / "chart.csv").write_text(
        "material,thickness,kerf,feed,process\nS235,6 mm,1.5 mm,2500 mm/min,G59 V502 F34; G59 V504 F130\n"
    )
    (tmp_path / "plant.yaml").write_text(
        "based_on: plasma-carbon-steel\nmachine: {dialect: shop.yaml}\nmaterial: {chart: chart.csv, thickness: 6 mm}\n"
        + _RULES
    )
    profile, nest = load_profile(tmp_path / "plant.yaml"), plate()
    trusted_dialect(profile)
    text = write_program(plan_of(nest, good_cuts(nest), profile), nest, profile)
    assert "N40 G59 V502 F34\nN50 G59 V504 F130\n" in text
    assert not check_program(nest, text, profile).broken()
