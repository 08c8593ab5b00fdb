"""The exact simulation against a second one, of pixels: no buffers, no overlays, only distances."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from numpy.typing import NDArray
from scipy import ndimage

from kerfwise import Nest
from kerfwise.tests.metal.burns import burns_of
from kerfwise.tests.metal.drawing import drawing_of
from kerfwise.tests.metal.hand_made import CUTS, KERF_MM, A, around, program, sheet, straight, with_cut
from kerfwise.tests.metal.pieces import Pieces
from kerfwise.tests.metal.program import read_program
from kerfwise.tests.metal.simulate import simulate

PIXEL_MM = 0.1
CASES = {
    "faultless": program(),
    "into the part": with_cut("A.outer", around(20, 20, 50, 50, (14, 45), off=0.5)),
    "not closed": with_cut("A.outer", [*A[:-2], "G1 X19 Y41", "M5 $0"]),
    "hole after its part": program((n, dict(CUTS)[n]) for n in ("B.mark1", "A.outer", "A.hole1", "B.outer")),
    "across everything": program([*CUTS, ("A.outer", straight((5, 5), (160, 90)))]),
    "the sheet in two": program([("A.outer", straight((80, -5), (80, 105)))]),
}


def burnt(nest: Nest, text: str) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Which pixels burn, and the middles of all pixels, array (height, width, 2)."""
    x0, y0, x1, y1 = nest.sheet.bounds
    xs, ys = (np.arange(a + PIXEL_MM / 2, b, PIXEL_MM) for a, b in ((x0, x1), (y0, y1)))
    middles = np.stack(np.meshgrid(xs, ys), axis=-1)
    burns = np.zeros(middles.shape[:2], dtype=bool)
    for path in (p for p in read_program(text).paths if p.burns):
        for a, b in zip(path.points, path.points[1:], strict=False):
            rows, columns = (
                slice(*np.searchsorted(axis, [min(a[d], b[d]) - KERF_MM, max(a[d], b[d]) + KERF_MM]))
                for d, axis in ((1, ys), (0, xs))
            )
            near = middles[rows, columns]
            along = np.clip(((near - a) @ (b - a)) / max((b - a) @ (b - a), 1e-12), 0, 1)
            burns[rows, columns] |= np.linalg.norm(near - a - along[..., None] * (b - a), axis=-1) < KERF_MM / 2
    return burns, middles


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_pixels_burn_the_same_metal(name: str) -> None:
    nest, text = sheet(), CASES[name]
    burns, middles = burnt(nest, text)
    drawing = drawing_of(nest)
    pieces = Pieces(drawing.sheet)
    made = burns_of(read_program(text).paths, drawing, KERF_MM)
    for burn in made:
        pieces.burn(burn.kerf(KERF_MM / 2))
    edge_mm = sum(burn.line.length for burn in made) * 2
    metal_mm2 = float((~burns).sum()) * PIXEL_MM**2
    left = [*pieces.held, *pieces.loose]
    assert sum(p.area for p in left) == pytest.approx(metal_mm2, abs=edge_mm * PIXEL_MM / 10)
    labels, count = ndimage.label(~burns)
    sizes = ndimage.sum_labels(~burns, labels, range(1, count + 1)) * PIXEL_MM**2
    assert sorted(s for s in sizes if s > 1) == pytest.approx(sorted(p.area for p in left), rel=0.01, abs=1)
    for part, area in drawing.parts.items():
        lost = float((burns & shapely.contains_xy(area, middles[..., 0], middles[..., 1])).sum()) * PIXEL_MM**2
        found = [f for f in simulate(nest, text, KERF_MM) if f.kind == "part-eroded" and f.contours[1].startswith(part)]
        told = sum(float(f.text.split()[0]) for f in found)
        assert told == pytest.approx(lost, rel=0.05, abs=1.5)


def test_pieces_of_a_sheet_in_two_hold_by_their_border() -> None:
    drawing, pieces = drawing_of(sheet()), Pieces(drawing_of(sheet()).sheet)
    for burn in burns_of(read_program(CASES["the sheet in two"]).paths, drawing, KERF_MM):
        pieces.burn(burn.kerf(KERF_MM / 2))
    assert [round(p.area) for p in pieces.held] == [119 * 100, 79 * 100]
    assert pieces.loose == []
