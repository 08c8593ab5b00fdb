"""Rows that are plain moves are read in a way of their own, which tells what the way for all rows does."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.check.reader.comments import row_of
from kerfwise.postproc.check.reader.reader import read_nc
from kerfwise.postproc.check.reader.words import block_of, plain_move

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
