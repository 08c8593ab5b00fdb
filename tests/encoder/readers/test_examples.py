"""The nests of `examples/nests`, each as JSON with flattened arcs and as DXF with bulges."""

import math
from pathlib import Path

import pytest

import kerfwise
from kerfwise import read_nest

NESTS = Path(kerfwise.__file__).parent / "examples" / "nests"


@pytest.mark.parametrize(
    ("name", "parts", "contours", "size"), [("e1x_6", 8, 16, (700, 300)), ("s8877", 16, 31, (8000, 2000))]
)
def test_both_formats_give_the_same_nest(name: str, parts: int, contours: int, size: tuple[float, float]) -> None:
    flat, round_ = (read_nest(NESTS / f"{name}{suffix}") for suffix in (".json", ".dxf"))
    for nest in (flat, round_):
        assert (len(nest.parts), len(nest.contours)) == (parts, contours)
        assert nest.sheet.bounds == (0, 0, *size)
        assert nest.notes == ()
    assert any(s.is_arc for c in round_.contours for s in c.curve.segments)

    for one in flat.contours:
        x, y = one.polygon.centroid.coords[0]
        twins = [
            other
            for other in round_.contours
            if other.kind == one.kind
            and math.dist(other.polygon.centroid.coords[0], (x, y)) < 0.1
            and abs(other.polygon.area - one.polygon.area) <= 0.1 * one.curve.length_mm  # chords within 0.1 mm
        ]
        assert len(twins) == 1
