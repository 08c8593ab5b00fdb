"""Locks in one line of text."""

from __future__ import annotations

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.errors import InputError
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.overrides import lines_of, read_lock

READ = {
    "P2 first": Lock(contour="P2", position="first"),
    "#7 last": Lock(contour="#7", position="last"),
    "P2.outer 5th": Lock(contour="P2.outer", position=5),
    "P3 after P2.outer": Lock(contour="P2.outer", before="P3"),
    "P2.outer entry (10, -2.5)": Lock(contour="P2.outer", entry=(10.0, -2.5)),
    "P2.outer entry at [10,20]": Lock(contour="P2.outer", entry=(10.0, 20.0)),
    "P2.outer cw": Lock(contour="P2.outer", direction="cw"),
    "no link P2.outer": Lock(contour="P2.outer", linked=False),
    "P2.outer linked false": Lock(contour="P2.outer", linked=False),
    "no tab P2": Lock(contour="P2", tab="off"),
    "P2 tab off": Lock(contour="P2", tab="off"),
    "P2 tab (5, 0)": Lock(contour="P2", tab=(5.0, 0.0)),
    "P2 in zone 3": Lock(part="P2", zone=3),
    '"last one" before "the first"': Lock(contour="last one", before="the first"),
    '"3"" pipe" before """"': Lock(contour='3" pipe', before='"'),
    '5" first': Lock(contour='5"', position="first"),
    "P1.outer before P2.outer": Lock(contour="P1.outer", before="P2.outer"),
    "  part#1.outer   before  part#2.hole1 ": Lock(contour="part#1.outer", before="part#2.hole1"),
    "P1.outer position first": Lock(contour="P1.outer", position="first"),
    "P1.outer position 12": Lock(contour="P1.outer", position=12),
    "P1.outer entry [10, 20.5]": Lock(contour="P1.outer", entry=(10.0, 20.5)),
    "P1.outer direction ccw": Lock(contour="P1.outer", direction="ccw"),
    "P1 zone 2": Lock(part="P1", zone=2),
    "a part of two words zone 1": Lock(part="a part of two words", zone=1),
    "{contour: P1.outer, position: last, direction: cw}": Lock(contour="P1.outer", position="last", direction="cw"),
}
WRONG = {
    "P2 frist": "'frist': did you mean 'first'\\? expected ID before ID",
    "P2 befor P3": "'befor': did you mean 'before'",
    "P2 soon": "'soon' decides nothing: expected ID before ID",
    "P2 first now": "nothing more was expected after 'first', got 'now'",
    "P2 before": "expected a contour, a part or #7 after 'before'",
    "P2 position": "expected first, last or a position counted from 1 after 'position'",
    "P2 entry 3 4": r"expected a point such as \(10, 20\) after 'entry', got '3 4'",
    "P2 entry (3)": r"entry: expected a point \[x, y\] in mm",
    "P2 linked true": "a link can be ruled out, not asked for",
    "P2 0th": "'0th'",
    "P2 in zone two": "zone: expected a whole number of at least 1, got 'two'",
    "no link": "expected ID before ID",
    "": "expected ID before ID",
    "P1.outer": "expected ID before ID",
    "P1.outer position soon": "position: expected first, last or a position counted from 1, got 'soon'",
    "P1.outer entry [1]": r"entry: expected a point \[x, y\] in mm",
    "P1.outer direction left": "direction: expected one of cw, ccw",
    "P1 zone 0": "zone: expected a whole number of at least 1",
    "P1.outer before P1.outer": "P1.outer cannot be cut before itself",
    "{contur: P1.outer}": "unknown key 'contur': did you mean 'contour'",
    "{contour: P1.outer": "not YAML",
}


@pytest.mark.parametrize("text", READ)
def test_read(text: str) -> None:
    assert read_lock(text) == READ[text]
    assert read_lock(text).because == "locked by the operator"


@pytest.mark.parametrize("text", WRONG)
def test_refused_with_the_text(text: str) -> None:
    with pytest.raises(InputError, match=WRONG[text]) as caught:
        read_lock(text)
    assert str(caught.value).startswith(f"lock {text!r}: ")


NAMES = st.one_of(
    st.from_regex(r"P[0-9]{1,2}\.(outer|hole[1-9]|mark1)", fullmatch=True),
    st.from_regex(r"#[1-9][0-9]?", fullmatch=True),
    st.sampled_from(["part#1.outer", "A+B", "last", "no", "first one", "in zone 2", "2nd", "(x)", "Träger (x).outer",
                     "a  b", "{x}", "no link"]),
    st.text(st.characters(exclude_categories=("Cs",)), min_size=1, max_size=12),
    st.text('"\\ ab(', min_size=1, max_size=8),
).filter(str.strip)  # fmt: skip
COORDINATES = st.floats(-1e5, 1e5).map(lambda value: round(value, 3))
POINTS = st.tuples(COORDINATES, COORDINATES)
ONE = st.one_of(
    st.builds(Lock, contour=NAMES, position=st.one_of(st.sampled_from(["first", "last"]), st.integers(1, 10**8))),
    st.builds(Lock, contour=NAMES, before=NAMES).filter(lambda lock: lock.contour != lock.before),
    st.builds(Lock, contour=NAMES, entry=POINTS),
    st.builds(Lock, contour=NAMES, direction=st.sampled_from(["cw", "ccw"])),
    st.builds(Lock, contour=NAMES, linked=st.just(False)),
    st.builds(Lock, contour=NAMES, tab=st.one_of(st.just("off"), POINTS)),
    st.builds(Lock, part=NAMES, zone=st.integers(1, 999)),
)


@given(ONE)
def test_what_is_written_is_read_again(lock: Lock) -> None:
    [line] = lines_of(lock)
    assert read_lock(line) == lock


@given(st.text(max_size=40))
def test_no_line_breaks_the_parser(text: str) -> None:
    with contextlib.suppress(InputError):
        assert read_lock(text).wrong() is None
