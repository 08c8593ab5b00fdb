"""A QR code as squares of a scene."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

import numpy as np

from .colours import INK
from .scene import Item, Shape, Style


def qr_items(text: str, x: float, y: float, size: float) -> Iterator[Item]:
    """The code of a text, `size` wide, with its corner at the page's (x, y): a bar for each run of dark squares.

    The white margin that readers ask for is left around it by whoever sets it.
    """
    import segno  # by whoever wants a work sheet only

    rows = segno.make_qr(text, error="m").matrix
    module = size / len(rows)
    bars = []
    for k, row in enumerate(rows):
        at = 0
        for dark, run in groupby(row):
            length = len(list(run))
            if dark:
                left, top = x + at * module, y + k * module
                right, low = left + length * module, top + module
                bars.append(np.array([(left, top), (right, top), (right, low), (left, low)]))
            at += length
    yield Shape(tuple(bars), Style(fill=INK))
