"""Words that mean something else on another control: each would cut air or metal without a word."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from kerfwise import InputError
from kerfwise.postproc.check.reader import controls
from kerfwise.postproc.check.reader.controls import CONTROLS
from kerfwise.postproc.check.reader.own_words import control_for
from kerfwise.postproc.check.reader.program import NcProgram
from kerfwise.postproc.check.reader.rs274 import read_nc
from kerfwise.postproc.dialects import load_dialect
from kerfwise.postproc.dialects.blocks import Also

GRBL_HEAD = "G21\nG90 G17 G40 G94\n"
EIA_HEAD = "G21\nG90\nG40\n"
BURNY_HEAD = "%\nP00000001\nG71\nG90\nG40\n"


def grbl(body: str) -> NcProgram:
    return read_nc(f"{GRBL_HEAD}{body}\nM2\n", control=CONTROLS["grbl"])


def eia(body: str) -> NcProgram:
    return read_nc(f"{EIA_HEAD}{body}\nM02\n", control=CONTROLS["eia"])


def burny(body: str) -> NcProgram:
    return read_nc(f"{BURNY_HEAD}{body}\nM30\n", control=CONTROLS["burny"])


PIERCED = "G0 X5 Y5\nG1 F600\nM3 S1000\nG4 P0.3\nM4 S800\nG1 X15 F600\nM5"


def test_a_pierce_under_grbl_is_burnt_by_m3_with_g1_in_force() -> None:
    program = grbl(PIERCED)
    (burn,) = program.burns
    assert (burn.tool, burn.pierce_s, burn.wait_s, burn.path.length_mm) == (0, 0.3, 0.0, 10.0)
    assert program.faults == program.hot_rapids == program.slow_travel == ()


@pytest.mark.parametrize(
    "body",
    [
        "G0 X5 Y5\nM4 S800\nG4 P0.3\nG1 X15 F600\nM5",  # M4 is dark at rest
        "G0 X5 Y5\nM3 S1000\nG4 P0.3\nG1 X15 F600\nM5",  # and M3 is, where G0 is in force
        "G0 X5 Y5\nM3 S1000\nG4 P0.3\nM4 S800\nG1 X15 F600\nM5",
    ],
)
def test_what_pierces_nothing_under_grbl(body: str) -> None:
    (burn,) = grbl(body).burns
    assert (burn.pierce_s, burn.wait_s) == (0.0, 0.3)


def test_the_beam_is_dark_in_g0_and_lit_again_by_the_next_move_at_a_feed() -> None:
    program = grbl("G0 X5 Y5\nM4 S800\nG1 X15 F600\nG0 X40\nG1 X50\nM5")
    assert [burn.path.length_mm for burn in program.burns] == [10.0, 10.0]
    assert program.hot_rapids == ()
    assert program.idle_mm == pytest.approx(5 * 2**0.5 + 25)


def test_power_nothing_is_off_and_little_power_marks() -> None:
    program = grbl("G0 X5 Y5\nM4 S800\nG1 X15 F600\nG1 X20 S0\nG1 X30 S800\nM5\nG0 X0\nM4 S200\nG1 X9\nM5")
    assert [(burn.tool, burn.path.length_mm) for burn in program.burns] == [(0, 10.0), (0, 10.0), (1, 9.0)]
    assert [stretch.length_mm for stretch in program.slow_travel] == [5.0]


def test_a_beam_without_power_is_told() -> None:
    (fault,) = grbl("G0 X5 Y5\nM4\nG1 X15 F600\nM5").faults
    assert "lights nothing" in fault.text


def test_a_beam_left_on_at_the_end_is_told() -> None:
    assert any("ends with the torch on" in fault.text for fault in grbl("G0 X5 Y5\nM4 S800\nG1 X15 F600").faults)


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("(WAIT!)\nG0 X1", r"'!' \(U\+0021\), which the control takes for a command"),
        ("(part?)\nG0 X1", "takes for a command wherever it stands"),
        ("(P1~2)\nG0 X1", "takes for a command wherever it stands"),
        ("(Plaque é)\nG0 X1", r"U\+00E9"),
        ("G64 P0.05", "G64 is not understood"),
        ("G90.1", r"G90\.1 is not understood"),
        ("M68 E3 Q0", "M68 is not understood"),
        ("G0 X1 (" + "A" * 130 + ")", "more than 127 are not supported"),
        ("G1 X" + "1" * 5 + "." + "2" * 30 + " Y" + "1" * 5 + "." + "3" * 40, "GRBL in laser mode takes 79"),
        ("M3 $0 S1", r"\$"),
        ("G4 S0.5", "G4 without its time: expected P and seconds"),  # Marlin's seconds; its P are milliseconds
        ("M4 I S800", "cannot read 'IS800'"),  # and its power in line
    ],
)
def test_grbl_refuses(body: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        grbl(body)


def test_eia_cuts_by_m07_and_marks_by_m09() -> None:
    body = "G00 X5 Y5\nM07\nG01 X15 F600\nM08\nG00 X0 Y0\nM09\nG01 X3\nM10"
    assert [(burn.tool, burn.path.length_mm) for burn in eia(body).burns] == [(0, 10.0), (1, 3.0)]


def test_eia_marks_by_m07_where_a_process_that_marks_is_selected() -> None:
    body = "M36 T3\nM37 T2\nG00 X5 Y5\nM07\nG01 X15 F600\nM08\nM36 T1\nG00 X0 Y0\nM07\nG01 X3\nM08"
    assert [(burn.tool, burn.path.length_mm) for burn in eia(body).burns] == [(1, 10.0), (0, 3.0)]
    (fault, *_) = eia("G00 X5 Y5\nM07\nM36 T3\nG01 X15 F600\nM08\nM36 T1\nM08").faults
    assert "selects another process while a tool is on" in fault.text


@pytest.mark.parametrize(
    ("read", "cut", "words"),
    [(eia, "M07\n{}G01 X15 F600\n{}M08\n", ("M50", "M51")), (burny, "M4\n{}X15 F600\n{}M3\n", ("M14", "M15"))],
)
def test_height_control_that_a_cut_stops_is_started_again(
    read: Callable[[str], NcProgram], cut: str, words: tuple[str, str]
) -> None:
    """Else the torch stands at one height over all the rest of a sheet that warps."""
    off, on = (f"{word}\n" for word in words)

    def told(first: str, then: str, before: str = "", second: str = "") -> list[str]:
        travel = "G00 X5 Y5\n" if read is eia else "X5 Y5\n"
        return [fault.text for fault in read(before + travel + cut.format(first, then) + cut.format(second, "")).faults]

    assert told(on, off, off, on) == []  # on once the pierce is done, off before the end
    assert told(off, on) == told(on, "", off) == told("", "", off) == []
    assert [text.partition(", stopped in")[0] for text in told(off, "")] == ["tool $0 burns without height control"]


def test_what_switches_for_a_family_does_not_for_another_control() -> None:
    """On a Fanuc-like control M8 starts a coolant and M7 another, and M5 puts the torch out."""
    body = "%\nO1000\nG21\nG90 G17 G40 G94\nG00 X5. Y5.\nM3\nG01 X15. F600.\nM5\n{}M30\n%\n"
    control = control_for(load_dialect("fanuc"))
    assert [burn.path.length_mm for burn in read_nc(body.format(""), control=control).burns] == [10.0]
    for known, other in (("M3", "M7"), ("M3", "M15"), ("M5", "M8"), ("M5", "M16")):
        with pytest.raises(InputError, match=rf"{other} is not understood, .* name it under also if it neither"):
            read_nc(body.format("").replace(known + "\n", other + "\n"), control=control)
    for word in ("M36 T3", "G59 V502 F34", "M19", "M08", "M9"):
        with pytest.raises(InputError, match=r"not understood|is not supported here"):
            read_nc(body.format(word + "\n"), control=control)
    called = control_for(replace(load_dialect("fanuc"), title="Fanuc 0i, M8 and M7 for oil"))
    with pytest.raises(InputError, match="M8 is not understood"):
        read_nc(body.format("M8\n"), control=called)
    coolant = replace(load_dialect("fanuc"), also=(*load_dialect("fanuc").also, Also("M8")))
    assert len(read_nc(body.format("M8\n"), control=control_for(coolant)).burns) == 1


@pytest.mark.parametrize(
    ("dialect", "foreign"), [("marlin", ("M48", "M53", "M68 E3 Q50")), ("mach", ("M53", "M67 E3 Q50"))]
)
def test_words_of_a_family_are_none_of_a_control_like_it(dialect: str, foreign: tuple[str, ...]) -> None:
    """M48 has Marlin probe, and M67 has QtPlasmaC alone change its feed."""
    body = "G21\nG90\n{}\nG0 X5 Y5\nM5\nM2\n"
    control = control_for(load_dialect(dialect))
    assert len(read_nc(body.format("M8"), control=control).rapids) == 1
    for words in foreign:
        with pytest.raises(InputError, match=r"is not understood, .* its dialect has no such word"):
            read_nc(body.format(words), control=control)


def test_eia_has_one_torch_burn_alone() -> None:
    body = "{}\nG00 X5 Y5\nM07\nG01 X15 F600\nM08"
    assert [burn.torches for burn in eia(body.format("M37 T1\nM38 T2")).burns] == [()]
    (fault,) = eia(body.format("M38 T1")).faults
    assert "M38 T1 deselects the first torch" in fault.text
    for words in ("M37 T2", "M37 T20", "M37", "M37 T0"):
        with pytest.raises(InputError, match=r"is for another torch, the profile has one|M37 without T"):
            eia(body.format(words))


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("G00 X5 Y5\nM3 S1", "M3 is not understood"),  # spindle words of others
        ("G00 X5 Y5\nM04", "M04 is not understood"),  # Phoenix maps a whole program, or none of it
        ("G00 X5 Y5\nM06", "M06 is not understood"),
        ("M36", "M36 without T"),
        ("G04 S0.5", "S without a word that uses it|S without"),  # Marlin's seconds
        ("M65", "it loads another program"),
        ("G41\nM07", "the control would shift the path by its own kerf"),
        ("G04 P0.5", "the time of a wait is given by X"),
        ("G64 P0.05", "G64 is not understood"),
        ("G04 X0.5 Y1", "a wait .* and a move in one block"),
    ],
)
def test_eia_refuses(body: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        eia(body)


def test_a_wait_of_eia_is_no_move() -> None:
    program = eia("G00 X5 Y5\nG04 X2.5\nM07\nG01 X15 F600\nM08")
    (burn,) = program.burns
    assert (burn.wait_s, burn.path.length_mm) == (2.5, 10.0)


def test_burny_lights_by_m04_and_stops_by_m03() -> None:
    program = burny("X5 Y5\nM04\nX15 F600\nG02 X15 Y25 I15 J15\nX5\nM03\nX0 Y0")
    (burn,) = program.burns
    assert burn.path.length_mm == pytest.approx(20 + 10 * 3.14159265, abs=1e-6)
    assert program.idle_mm == pytest.approx(5 * 2**0.5 + (5**2 + 25**2) ** 0.5)


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("(A COMMENT)", "a comment, which Burny does not know"),
        ("G01 X5", "G01 is not understood"),
        ("G21", "G21 is not understood"),
        ("M5", "M5 is not understood"),
        ("G04 P1", "P without a word"),
    ],
)
def test_burny_refuses(body: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        burny(body)


def test_a_program_for_one_control_is_no_program_for_another() -> None:
    """M4 lights a Burny's torch and M3 puts it out; LinuxCNC has it the other way round, or refuses."""
    text = "G21 G90 G17 G40 G91.1 G94 G64 P0.05\nG0 X5 Y5\nM4\nG1 X15 F600\nM3\nM2\n"
    with pytest.raises(InputError, match="M4 is not understood"):
        read_nc(text, control=CONTROLS["linuxcnc"])


def read(text: str) -> tuple[controls.Row | None, tuple[str, int | None] | None]:
    try:
        return controls.row_of(text, 7), None
    except InputError as error:
        return None, (error.message, error.column)


@given(st.text("gGxX10.-\t ()%;ä\x7f\x0b", max_size=12))
@example("g1 x 10.5")
@example(" \t")
@example("")
def test_both_ways_read_the_same(text: str) -> None:
    at_once = read(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(controls, "_COMMENTED", re.compile(""))
        assert read(text) == at_once
