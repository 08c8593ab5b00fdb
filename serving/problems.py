"""What is wrong with a drawing that cannot be cut, and where, so that it can be drawn."""

from __future__ import annotations

import re
from typing import Any

from kerfwise.encoder.readers.read import BrokenNest
from kerfwise.encoder.shown import shown
from kerfwise.postproc.report import Spot, draw

_AT = re.compile(r"\((-?\d+(?:\.\d+)?(?:e-?\d+)?), (-?\d+(?:\.\d+)?(?:e-?\d+)?)\)")


def problems_of(broken: BrokenNest) -> dict[str, Any]:
    """A line each with the contours and points that it names, and the drawing with the wrong contours in red (SVG)."""
    spot = Spot(frozenset(broken.wrong), shown(broken.message)) if broken.wrong else None
    lines = [broken.message, *broken.details]
    return {
        "lines": [
            {
                "text": shown(text),
                "contours": [name for name in broken.wrong if re.search(rf"(?<!\S){re.escape(name)}(?![\w.])", text)],
                "at": [[float(x), float(y)] for x, y in _AT.findall(text)],
            }
            for text in lines
        ],
        "picture": draw(broken.nest, None, ".svg", spot=spot).decode("utf-8"),
    }
