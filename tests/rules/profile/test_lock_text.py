"""Locks in one line of text."""

from __future__ import annotations

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.lock_text import read_lock

READ = {
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
