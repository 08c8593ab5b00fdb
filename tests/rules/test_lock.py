"""Locks that name what the nest does not have."""

from __future__ import annotations

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.lock import Lock, check_locks
from kerfwise.rules.options.yaml_positions import Place

ROW = nest(300, 100, part("P1", rect(10, 10, 60, 80)), part("P2", rect(80, 10, 60, 80)))


@pytest.mark.parametrize(
    ("lock", "message"),
    [
        (
            Lock(contour="P1.outr", position="first", place=Place("plant.yaml", 4, 5)),
            "plant.yaml:4:5: lock: unknown contour 'P1.outr': did you mean 'P1.outer'? (valid: P1.outer, P2.outer)",
        ),
        (
            Lock(contour="P1.outer", before="P3.outer"),
            "lock: unknown contour 'P3.outer': did you mean 'P2.outer'? (valid: P1.outer, P2.outer)",
        ),
        (Lock(part="Q", zone=1), "lock: unknown part 'Q' (valid: P1, P2)"),
        (Lock(contour="P1.outer", position=3), "lock: position 3, but the nest has 2 contours only"),
    ],
)
def test_wrong_lock(lock: Lock, message: str) -> None:
    with pytest.raises(InputError) as caught:
        check_locks((lock,), ROW)
    assert str(caught.value) == message


def test_good_locks() -> None:
    check_locks((Lock(contour="P1.outer", before="P2.outer", position=2), Lock(part="P2", zone=9)), ROW)
