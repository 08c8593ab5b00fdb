"""Scrap lines at random, of which each can be cut."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely

from kerfwise import Nest
from kerfwise.encoder.candidates.build import scrap_problems as beside_kerfs
from kerfwise.encoder.nest import as_scrap
from kerfwise.encoder.scrap import skeleton
from kerfwise.encoder.validate import scrap_problems
from kerfwise.rule_kit import Curve

TRIES = 30
SHORTEST_MM = 5.0
"""Lines are longer."""


def with_lines(rng: np.random.Generator, drawn: Nest, most: int, kerf_mm: float) -> Nest | None:
    """The nest with up to so many scrap lines where straight lines across the sheet meet metal; None if none can be."""
    x0, y0, x1, y1 = drawn.sheet.bounds
    metal = skeleton(drawn.sheet.polygon, [part.outer.polygon for part in drawn.parts], kerf_mm + 0.01)
    made = drawn
    for _ in range(TRIES):
        across, at = rng.random() < 0.5, float(rng.uniform(0.1, 0.9))
        x, y = x0 + at * (x1 - x0), y0 + at * (y1 - y0)
        line = shapely.LineString([(x0, y), (x1, y)] if across else [(x, y0), (x, y1)])
        spans = [span for span in shapely.get_parts(shapely.intersection(metal, line)) if span.length > SHORTEST_MM]
        for k in rng.permutation(len(spans)).tolist():
            one = Curve.of([(float(x), float(y)) for x, y in shapely.get_coordinates(spans[k])], closed=False)
            more = replace(made, scrap=as_scrap([*(c.curve for c in made.scrap), one]))
            if not scrap_problems(more.scrap, more.parts, more.sheet) and not beside_kerfs(more, kerf_mm):
                made = more
            if len(made.scrap) == most:
                return made
    return made if made.scrap else None
