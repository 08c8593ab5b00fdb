"""The lines that the torch's centre must follow."""

import math

import pytest

from kerfwise.postproc.check.torch_run import torch_rings
from kerfwise.rules.case import circle, part, rect

PART = part("P", rect(0, 0, 100, 50), [circle(30, 25, 10)], [[(60, 10), (90, 10)]])
BY_KIND = {contour.kind: contour for contour in PART}


@pytest.mark.parametrize(
    ("kind", "side", "length_mm"),
    [
        ("outer", "right", 300 + 2 * math.pi),
        ("outer", "wrong", 292),
        ("outer", "on", 300),
        ("hole", "right", 18 * math.pi),
        ("hole", "wrong", 22 * math.pi),
        ("mark", "right", 30),
    ],
)
def test_lengths(kind: str, side: str, length_mm: float) -> None:
    ring = torch_rings([BY_KIND[kind]], 2.0, side)[0]  # type: ignore[index, arg-type]
    assert ring is not None
    assert ring.length == pytest.approx(length_mm, rel=1e-3)


def test_a_hole_no_wider_than_the_kerf_leaves_nothing() -> None:
    assert torch_rings([BY_KIND["hole"]], 20.5) == [None]


def test_of_a_hole_that_falls_apart_the_larger_piece() -> None:
    dumbbell = [
        (0, 0),
        (20, 0),
        (20, 9),
        (40, 9),
        (40, 0),
        (70, 0),
        (70, 20),
        (40, 20),
        (40, 11),
        (20, 11),
        (20, 20),
        (0, 20),
    ]
    ring = torch_rings([part("P", rect(-5, -5, 90, 40), [dumbbell]).holes[0]], 4.0)[0]
    assert ring is not None
    assert ring.bounds[1:] == pytest.approx((2, 68, 18))
