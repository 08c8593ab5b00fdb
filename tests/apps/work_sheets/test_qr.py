"""The squares of a QR code are those of the library's matrix."""

from __future__ import annotations

import numpy as np
import segno

from kerfwise.postproc.report.scene import Shape


def test_the_bars_cover_the_dark_squares_and_no_others() -> None:
    from kerfwise.apps.work_sheets.paper import qr_items

    text, size = "SHA256 " + "0123456789ABCDEF" * 4, 78.0
    matrix = np.array(segno.make_qr(text, error="m").matrix, dtype=bool)
    drawn = np.zeros_like(matrix)
    (shape,) = qr_items(text, 10.0, 20.0, size)
    assert isinstance(shape, Shape)
    module = size / len(matrix)
    for bar in shape.lines:
        (x0, y0), (x1, y1) = bar.min(axis=0), bar.max(axis=0)
        columns = slice(round((x0 - 10) / module), round((x1 - 10) / module))
        rows = slice(round((y0 - 20) / module), round((y1 - 20) / module))
        assert not drawn[rows, columns].any()
        drawn[rows, columns] = True
    assert np.array_equal(drawn, matrix)
