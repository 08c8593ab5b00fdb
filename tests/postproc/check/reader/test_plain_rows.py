"""Rows that are plain are read in ways of their own, which tell what the way for all rows does."""

from __future__ import annotations

from dataclasses import fields

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.check.reader.comments import row_of
from kerfwise.postproc.check.reader.controls import CONTROLS
from kerfwise.postproc.check.reader.plain_rows import PlainRows
from kerfwise.postproc.check.reader.reader import read_nc
from kerfwise.postproc.check.reader.words import block_of, plain_move
from kerfwise.tests.tools.amount import examples

NUMBERS = st.one_of(
    st.floats(-2e6, 2e6).map(lambda x: f"{x:.4f}"),
    st.sampled_from(["0", "-0", "7", "-12.5", "+3", ".5", "5.", "1 2", "1e3", "1234567", "--1", "", "0.1234567891"]),
)
WORDS = st.tuples(st.sampled_from("XYIJFRP"), NUMBERS).map("".join)
ROWS = st.builds(
    lambda number, motion, words, between: number + between.join([motion, *words]),
    st.sampled_from(["", "N10 ", "N10", "N1234567890 ", "n5 ", " "]),
    st.sampled_from(["G0", "G1", "G2", "G3", "G01", "G4", "g1", "M5", "G1.0", ""]),
    st.lists(WORDS, max_size=5),
    st.sampled_from([" ", " ", " ", "", "  ", "\t"]),
)


@given(ROWS)
def test_a_plain_move_is_the_same_block(text: str) -> None:
    found = plain_move(text, 7)
    if found is not None:
        assert found == block_of(row_of(text, 7), 7)


@pytest.mark.parametrize("text", ["G0 X1 Y2", "N10 G1 X-1.5 F2500", "N9 G2 X1 Y2 I0.5 J-0.5", "G3 I1", "G1"])
def test_usual_moves_are_plain(text: str) -> None:
    assert plain_move(text, 3) == block_of(row_of(text, 3), 3)


@pytest.mark.parametrize(
    "text", ["G1 Y2 X1", "G1X1", "G1 X1 (there)", "G1 X1 Z2", "G1 X1 X2", "G1 X1234567", "G1 X1 M5", "g1 x1", "G1 F-1"]
)
def test_all_others_are_left(text: str) -> None:
    assert plain_move(text, 1) is None


@pytest.mark.parametrize(("row", "says"), [("G1 X2 P3", "P without a word"), ("G0 X1 I1", "I without a word")])
def test_words_that_conflict_are_refused_however_often_others_were_not(row: str, says: str) -> None:
    moves = "\n".join(["G21 G90", "G0 X5 Y5", "M3 $0 S1", "G1 X15 F600", *["G1 X16 Y1", "G2 X16 Y1 I1 J0"] * 3])
    with pytest.raises(InputError, match=says) as caught:
        read_nc(f"{moves}\n{row}\nM5 $0\nM2\n")
    assert caught.value.line == moves.count("\n") + 2


SWITCHES = {
    "linuxcnc-qtplasmac": [("M3 $0 S1", "M5 $0"), ("M3 $2 S1", "M5 $2")],
    "linuxcnc": [("M3 S1", "M5"), ("M64 P0", "M65 P0")],
    "eia": [("M7", "M8"), ("M9", "M10")],
    "grbl": [("M3 S900", "M5"), ("M4 S300", "S0")],
    "burny": [("M4", "M3")],
}
TOP = {
    "linuxcnc-qtplasmac": ["G0 X1 Y1", "G21 G90 G17 G40 G94 G91.1", "G64 P0.05"],
    "linuxcnc": ["G21 G90 G17 G40 G94 G91.1", "G64 P0.05"],
    "eia": ["G21 G90 G40"],
    "grbl": ["G21 G90 G17 G40 G94"],
    "burny": ["P1", "G71 G90 G40"],
}
ODD = [
    "G20", "G21", "G91", "G90", "G90.1", "G91.1", "G64 P9", "G64 P0.05", "G4 P0.5", "(CUT 1)", "F900", "M68 E3 Q50",
    "G1 X1", "Y5", "G2 X9 Y9 I1 J0", "G2 X9 Y9", "G1 X5 Y5 I1 J1", "G1 X5 Y5 F0", "G1 X5 Y5 F0.5", "G0 X5 Y5 F700",
    "G1 X1234567 Y1", "G1 X1 Y1 P2", "G0 X1 Y1 (there)", "G3 X5.0001 Y5 I0 J0.00001", "g1 x3 y4", "%", "M0",
    "N7 M3 $0 S1", "M5 $0", "M3 $0", "M3 $0 S0", "M5 $0 (off)", "(MARK  2 a=b)", "(CUT 3 (x))", "(CUT 3", "M5 $1",
]  # fmt: skip
STEPS = st.tuples(
    st.sampled_from(["on", "G0", "off", "G1", "G1", "G2", "G3", "odd", "cut", "cut", "cut"]),
    st.sampled_from([-40.0, -2.5, 0.0, 5.0, 7.1234]),
    st.sampled_from([-20.0, 0.0, 0.0001, 10.0]),
    st.integers(0, 100),
)


def program_of(control: str, steps: list[tuple[str, float, float, int]], said: int) -> str:
    """Rows that are mostly right: arcs end where they should, if they begin where the rows before lead."""
    rows, (x, y) = TOP[control][: len(TOP[control]) - said], (0.0, 0.0)
    on, off = SWITCHES[control][0]
    for kind, a, b, k in steps:
        feed = " F600" if k % 3 == 0 else ""
        on, off = SWITCHES[control][k % len(SWITCHES[control])] if k > 90 else (on, off)
        if kind in ("G2", "G3"):
            turn = 1 if kind == "G3" else -1
            i, j = a, b
            x, y = x + i + turn * j, y + j - turn * i
            rows.append(f"{kind} X{x:.4f} Y{y:.4f} I{i:.4f} J{j:.4f}{feed}")
        elif kind in ("G0", "G1", "cut"):
            x, y = x + a, y + b
            rows += [off, f"(CUT {k} P{k}.outer ZONE 1 )", f"G0 X{x + b:.4f} Y{y:.4f}", on] if kind == "cut" else []
            rows.append(f"G0 X{x:.4f} Y{y:.4f}" if kind == "G0" else f"N{k} G1 X{x:.4f} Y{y:.4f}{feed}")
        else:
            rows.append({"on": on, "off": off}.get(kind) or ODD[k % len(ODD)])
    return "\n".join([*rows, off, "M30", ""])


def told(program: str, control: str) -> str:
    """All that is read of a program, or why it is refused."""
    try:
        read = read_nc(program, control=CONTROLS[control], tab_mm=6.0)
    except InputError as error:
        return str(error)
    burns = [(*(getattr(b, f.name) for f in fields(b) if f.name != "path"), b.path.as_rows()) for b in read.burns]
    return repr((burns, [getattr(read, f.name) for f in fields(read) if f.name != "burns"]))


@given(st.sampled_from(sorted(SWITCHES)), st.lists(STEPS, max_size=25), st.sampled_from([0, 0, 0, 1]))
@examples(300)
def test_plain_rows_do_what_their_blocks_do(
    control: str, steps: list[tuple[str, float, float, int]], said: int
) -> None:
    program = program_of(control, steps, said)
    found = told(program, control)
    with pytest.MonkeyPatch.context() as by_blocks:
        by_blocks.setattr(PlainRows, "run", lambda moves, row, line: False)
        assert told(program, control) == found
